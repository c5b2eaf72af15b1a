//! Groups: which settings go together, which exclude each other, and which need others.

use crate::settings::group::{A_FILE, Group, group, kind, variant};

/// Name of the variant of random surfaces.
pub(in crate::settings) const RANDOM_SURFACES: &str = "random surfaces";

/// Random and given surfaces.
pub(in crate::settings) const RANDOM_OR_GIVEN: Group = group(&[
    variant(RANDOM_SURFACES)
        .by(&["surface.*", "-surface.cells"])
        .takes(&["run.realisations", "medium.bottom_surface=independent"]),
    variant("a given surface")
        .by(&["measured.file"])
        .takes(&["measured.*", "-measured.flat"]),
    variant("a flat surface").by(&["measured.flat"]),
])
.keeping_defaults();

/// All groups. An earlier one is checked first.
pub(in crate::settings) static GROUPS: &[Group] = &[
    // Surfaces
    RANDOM_OR_GIVEN,
    group(&[
        variant("a flat surface").by(&["measured.flat"]),
        variant("a surface that is not flat").takes(&["run.refine"]),
    ]),
    group(&[
        variant("smoothness").by(&["surface.smoothness"]),
        variant("sigma").by(&["surface.sigma"]),
        variant("ggx_alpha").by(&["surface.ggx_alpha"]),
    ]),
    group(&[
        variant("slopes of a file").by(&["surface.slopes_of"]),
        variant("Gaussian slopes").by(&[
            "surface.smoothness",
            "surface.smoothness_y",
            "surface.azimuth",
        ]),
    ]),
    // Structures
    group(&[
        variant("surfaces without a structure")
            .by(&["surface.smoothness"])
            .takes(&[
                "surface.heights",
                "surface.skewness",
                "surface.kurtosis",
                "surface.slopes!gaussian",
            ])
            .otherwise(),
        variant("a structure").by(&["surface.structure"]).takes(&[
            "surface.depth",
            "surface.width",
            "surface.scratch_length",
            "surface.density",
            "surface.edge_radius",
            "surface.randomness",
            "surface.arrangement",
            "surface.spread",
        ]),
    ]),
    kind(
        "surface.structure",
        &[
            variant("pits").takes(SEGMENTS),
            variant("caps").takes(SEGMENTS),
            variant("v-grooves").takes(&["surface.edge_radius", "surface.randomness"]),
            variant("sine-grooves").takes(&["surface.randomness"]),
            variant("blazed-grooves").takes(&["surface.edge_radius", "surface.randomness"]),
            variant("scratches").takes(&[
                "surface.scratch_length",
                "surface.density",
                "surface.edge_radius",
                "surface.randomness",
                "surface.spread",
            ]),
            variant("cracks").takes(&["surface.density", "surface.edge_radius"]),
            variant("pyramids").takes(PYRAMIDS),
            variant("inverted-pyramids").takes(PYRAMIDS),
        ],
    ),
    group(&[
        variant("roughness on top of a structure, which sigma gives")
            .by(&["surface.sigma"])
            .takes(&[
                "surface.tau",
                "surface.tau_y",
                "surface.psd!gaussian",
                "surface.second_sigma",
                "surface.second_tau",
            ]),
        variant("a structure alone").otherwise(),
    ])
    .within("surface.structure"),
    // Spectra, heights and slopes
    kind(
        "surface.psd",
        &[
            variant("gaussian").takes(LENGTHS).otherwise(),
            variant("exponential")
                .takes(LENGTHS)
                .needs(&["surface.cut_off"]),
            variant("matern")
                .takes(&["surface.tau", "surface.tau_y", "surface.cut_off"])
                .needs(&["surface.nu"]),
            variant("power-law").takes(&["surface.tau_y"]).needs(&[
                "surface.hurst",
                "surface.roll_off",
                "surface.cut_off",
            ]),
            variant(A_FILE).without_default(&["surface.smoothness"]),
        ],
    ),
    group(&[variant("the spacing of a height map")
        .by(&["surface.psd=like:"])
        .without_default(&["surface.spacing"])]),
    group(&[variant("a second scale")
        .by(SECOND_SCALE)
        .needs(SECOND_SCALE)]),
    group(&[
        variant("heights").by(&["surface.heights"]),
        variant("skewness and kurtosis").by(&["surface.skewness", "surface.kurtosis"]),
    ]),
    kind(
        "surface.slopes",
        &[
            variant("gaussian")
                .takes(&[
                    "surface.second_sigma",
                    "surface.second_tau",
                    "surface.heights!gaussian",
                    "surface.skewness",
                    "surface.kurtosis",
                ])
                .otherwise(),
            variant("ggx")
                .takes(&["surface.amplitude_ratio"])
                .needs(&["surface.ggx_alpha"]),
        ],
    ),
    group(&[
        variant("size").by(&["surface.size"]),
        variant("length").by(&["surface.length"]),
    ]),
    group(&[
        variant("subdivide").by(&["mesh.subdivide"]),
        variant("deviation").by(&["mesh.deviation"]),
    ]),
    kind(
        "surface.cells",
        &[
            variant("auto").otherwise(),
            variant("flat"),
            variant("smooth").takes(&["mesh.subdivide", "mesh.deviation"]),
        ],
    ),
    group(&[
        variant("an angle of repose")
            .by(&["erosion.repose"])
            .takes(&["erosion.slip_steps"]),
        variant("surfaces that do not slip").otherwise(),
    ])
    .keeping_defaults(),
    kind(
        "camera.projection",
        &[
            variant("pinhole").takes(&["camera.fov"]).otherwise(),
            variant("orthographic"),
        ],
    )
    .keeping_defaults(),
    // Materials and media
    kind(
        "material.kind",
        &[
            variant("dielectric").takes(&["material.eta"]).otherwise(),
            variant("conductor").needs(&["material.eta", "material.kappa"]),
            variant("mirror"),
            variant("lambertian").needs(&["material.reflectance"]),
        ],
    ),
    group(&[
        variant("mean_free_path and albedo")
            .by(&["medium.mean_free_path", "medium.albedo"])
            .needs(&["medium.mean_free_path", "medium.albedo"]),
        variant("absorption and scattering").by(&["medium.absorption", "medium.scattering"]),
    ])
    .within("medium.*")
    .one_of_them("a medium"),
    kind(
        "medium.phase",
        &[
            variant("isotropic"),
            variant("henyey-greenstein").needs(&["medium.g"]),
            variant("rayleigh"),
        ],
    ),
    group(&[
        variant("a medium with a thickness")
            .by(&["medium.thickness"])
            .takes(&[
                "medium.bottom",
                "medium.bottom_eta",
                "medium.bottom_reflectance",
                "medium.bottom_surface!flat",
            ]),
        variant("one without end").otherwise(),
    ])
    .within("medium.*"),
    kind(
        "medium.bottom",
        &[
            variant("interface")
                .takes(&["medium.bottom_eta", "medium.bottom_surface!flat"])
                .otherwise(),
            variant("lambertian")
                .takes(&["medium.bottom_reflectance", "medium.bottom_surface!flat"]),
            variant("absorbing").takes(&["medium.bottom_surface!flat"]),
            variant("mirror").takes(&["medium.bottom_surface!flat"]),
            variant("open"),
        ],
    ),
    // Light, effort and results
    group(&[
        variant("theta and phi").by(&["light.theta", "light.phi"]),
        variant("directions").by(&["light.directions"]),
    ]),
    group(&[
        variant("numbers of surfaces and rays").by(&["run.realisations", "run.rays"]),
        variant("a target error")
            .by(&["run.target_error"])
            .takes(&["run.of"]),
    ])
    .keeping_defaults(),
    group(&[
        variant("bins").by(&["run.bins", "results.json"]),
        variant("directions").by(&["model.step", "model.sphere"]),
    ]),
    group(&[
        variant("quiet").by(&["program.quiet"]),
        variant("verbose").by(&["program.verbose"]),
    ]),
];

const LENGTHS: &[&str] = &["surface.tau", "surface.tau_y"];
const SECOND_SCALE: &[&str] = &["surface.second_sigma", "surface.second_tau"];
const PYRAMIDS: &[&str] = &[
    "surface.density",
    "surface.randomness",
    "surface.arrangement",
];
const SEGMENTS: &[&str] = &[
    "surface.density",
    "surface.edge_radius",
    "surface.randomness",
    "surface.arrangement",
];
