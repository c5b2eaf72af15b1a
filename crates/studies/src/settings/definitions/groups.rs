//! Groups: which settings go together, which exclude each other, and which need others.

use crate::settings::group::{A_FILE, Group, NAMED, group, group_by, variant};

/// Name of the variant of random surfaces.
pub(in crate::settings) const RANDOM_SURFACES: &str = "random surfaces";

/// Random and given surfaces.
pub(in crate::settings) const RANDOM_OR_GIVEN: Group = group(&[
    variant(RANDOM_SURFACES)
        .when(&["surface.*", "-surface.cells"])
        .allows(&["run.realisations", "medium.bottom_surface=independent"])
        .by_default(),
    variant("a given surface")
        .when(&["measured.file"])
        .allows(&[
            "measured.*",
            "-measured.flat",
            "light.sun_elevation",
            "light.sun_azimuth",
            "medium.bottom_surface!flat",
            "-medium.bottom_surface=same",
            "-medium.bottom_surface=independent",
        ]),
    variant("a flat surface").when(&["measured.flat"]).allows(&[
        "medium.bottom_surface!flat",
        "-medium.bottom_surface=same",
        "-medium.bottom_surface=independent",
    ]),
])
.keeps_all_defaults();

/// All groups. An earlier one is checked first.
pub(in crate::settings) static GROUPS: &[Group] = &[
    // Surfaces
    RANDOM_OR_GIVEN,
    group(&[
        variant("a flat surface").when(&["measured.flat"]),
        variant("a rough surface").allows(&[
            "run.refine",
            "compare.models!none",
            "surface.cells=smooth",
        ]),
    ])
    .keeps_all_defaults(),
    group(&[
        variant("slopes of a file").when(&["surface.slopes_of"]),
        variant("slopes by numbers").when(&[
            "surface.smoothness",
            "surface.smoothness_y",
            "surface.ggx_alpha",
            "surface.azimuth",
        ]),
    ]),
    // Structures
    group(&[
        variant("surfaces without a structure")
            .when(&["surface.smoothness"])
            .allows(&[
                "surface.heights",
                "surface.skewness",
                "surface.kurtosis",
                "surface.slopes!gaussian",
            ])
            .by_default(),
        variant("a structure")
            .when(&["surface.structure"])
            .allows(&[
                "surface.depth",
                "surface.width",
                "surface.scratch_length",
                "surface.density",
                "surface.edge_radius",
                "surface.randomness",
                "surface.arrangement",
                "surface.spread",
            ]),
    ])
    .advice("roughness on top of a structure is given by sigma and tau"),
    group(&[
        variant("smoothness").when(&["surface.smoothness", "surface.smoothness_y"]),
        variant("sigma").when(&["surface.sigma"]),
        variant("ggx_alpha")
            .when(&["surface.ggx_alpha"])
            .allows(&["surface.slopes!gaussian", "surface.amplitude_ratio"]),
    ]),
    group_by(
        "surface.structure",
        &[
            variant("pits").allows(SEGMENTS),
            variant("caps").allows(SEGMENTS),
            variant("v-grooves").allows(&["surface.edge_radius", "surface.randomness"]),
            variant("sine-grooves").allows(&["surface.randomness"]),
            variant("blazed-grooves").allows(&["surface.edge_radius", "surface.randomness"]),
            variant("scratches").allows(&[
                "surface.scratch_length",
                "surface.density",
                "surface.edge_radius",
                "surface.randomness",
                "surface.spread",
            ]),
            variant("cracks").allows(&["surface.density", "surface.edge_radius"]),
            variant("pyramids").allows(PYRAMIDS),
            variant("inverted-pyramids").allows(PYRAMIDS),
        ],
    ),
    group(&[
        variant("roughness on top of a structure")
            .when(&["surface.sigma"])
            .allows(&[
                "surface.tau",
                "surface.tau_y",
                "surface.psd!gaussian",
                "surface.second_sigma",
                "surface.second_tau",
            ]),
        variant("a structure alone").by_default(),
    ])
    .only_with("surface.structure"),
    // Spectra, heights and slopes
    group_by(
        "surface.psd",
        &[
            variant("gaussian").allows(LENGTHS).by_default(),
            variant("exponential")
                .allows(LENGTHS)
                .needs(&["surface.cut_off"]),
            variant("matern")
                .allows(&["surface.tau", "surface.tau_y", "surface.cut_off"])
                .needs(&["surface.nu"]),
            variant("power-law").allows(&["surface.tau_y"]).needs(&[
                "surface.hurst",
                "surface.roll_off",
                "surface.cut_off",
            ]),
            variant(A_FILE).without_default_of(&["surface.smoothness"]),
        ],
    ),
    group(&[variant("the spacing of a height map")
        .when(&["surface.psd=like:"])
        .without_default_of(&["surface.spacing"])]),
    group(&[variant("a second scale")
        .when(SECOND_SCALE)
        .needs(SECOND_SCALE)]),
    group(&[
        variant("heights").when(&["surface.heights"]),
        variant("skewness and kurtosis").when(&["surface.skewness", "surface.kurtosis"]),
    ]),
    group_by(
        "surface.slopes",
        &[
            variant("gaussian")
                .allows(&[
                    "surface.second_sigma",
                    "surface.second_tau",
                    "surface.heights!gaussian",
                    "surface.skewness",
                    "surface.kurtosis",
                ])
                .by_default(),
            variant("ggx")
                .allows(&["surface.amplitude_ratio"])
                .needs(&["surface.ggx_alpha"]),
        ],
    ),
    group(&[
        variant("size").when(&["surface.size"]),
        variant("length").when(&["surface.length"]),
    ]),
    group(&[
        variant("several surfaces")
            .when(&["run.realisations"])
            .allows(&["generate.format"]),
        variant("one surface").by_default(),
    ])
    .only_with("generate.*")
    .keeps_all_defaults(),
    group(&[
        variant("subdivide").when(&["mesh.subdivide"]),
        variant("deviation").when(&["mesh.deviation"]),
    ]),
    group_by(
        "surface.cells",
        &[
            variant("auto").by_default(),
            variant("flat"),
            variant("smooth").allows(&["mesh.subdivide", "mesh.deviation"]),
        ],
    ),
    group(&[
        variant("an angle of repose")
            .when(&["surface.repose"])
            .allows(&["surface.slip_steps"]),
        variant("surfaces that do not slip").by_default(),
    ])
    .keeps_all_defaults(),
    group(&[
        variant("an angle of repose")
            .when(&["measured.repose"])
            .allows(&["measured.slip_steps"]),
        variant("surfaces that do not slip").by_default(),
    ])
    .keeps_all_defaults(),
    group_by(
        "camera.projection",
        &[
            variant("pinhole").allows(&["camera.fov"]).by_default(),
            variant("orthographic"),
        ],
    )
    .keeps_all_defaults(),
    // Materials and media
    group_by(
        "material.kind",
        &[
            variant("dielectric").allows(&["material.eta"]).by_default(),
            variant("conductor").needs(&["material.eta", "material.kappa"]),
            variant("mirror"),
            variant("lambertian").needs(&["material.reflectance"]),
            variant(NAMED).allows(&["material.above", "material.film", "material.kappa"]),
        ],
    ),
    group(&[
        variant("mean_free_path and albedo")
            .when(&["medium.mean_free_path", "medium.albedo"])
            .needs(&["medium.mean_free_path", "medium.albedo"]),
        variant("absorption and scattering").when(&["medium.absorption", "medium.scattering"]),
    ])
    .only_with("medium.*"),
    group(&[
        variant("a medium that absorbs or scatters")
            .when(&[
                "medium.mean_free_path",
                "medium.absorption!0",
                "medium.scattering!0",
            ])
            .allows(&["medium.thickness", "medium.phase", "medium.g"]),
        variant("a medium that neither absorbs nor scatters")
            .needs(&["medium.thickness"])
            .by_default(),
    ])
    .only_with("medium.*"),
    group_by(
        "medium.phase",
        &[
            variant("isotropic"),
            variant("henyey-greenstein").needs(&["medium.g"]),
            variant("rayleigh"),
        ],
    ),
    group(&[
        variant("a medium with a thickness")
            .when(&["medium.thickness"])
            .allows(&[
                "medium.bottom",
                "medium.bottom_eta",
                "medium.bottom_material",
                "medium.bottom_film",
                "medium.bottom_reflectance",
                "medium.bottom_surface!flat",
                "medium.layer",
            ]),
        variant("one without end").by_default(),
    ])
    .only_with("medium.*"),
    group_by(
        "medium.bottom",
        &[
            variant("interface")
                .allows(&[
                    "medium.bottom_eta",
                    "medium.bottom_material",
                    "medium.bottom_film",
                    "medium.bottom_surface!flat",
                ])
                .by_default(),
            variant("lambertian")
                .allows(&["medium.bottom_reflectance", "medium.bottom_surface!flat"]),
            variant("absorbing").allows(&["medium.bottom_surface!flat"]),
            variant("mirror").allows(&["medium.bottom_surface!flat"]),
            variant("open"),
        ],
    ),
    group(&[
        variant("the index beyond the bottom").when(&["medium.bottom_eta"]),
        variant("the material beyond the bottom").when(&["medium.bottom_material"]),
    ]),
    // Light, effort and results
    group(&[
        variant("theta and phi").when(&["light.theta", "light.phi"]),
        variant("directions").when(&["light.directions"]),
    ]),
    group(&[
        variant("cosines").when(&["albedo.cosines"]),
        variant("cos").when(&["albedo.cos"]),
    ]),
    group(&[
        variant("a light whose shadow is measured")
            .when(&["shadow.theta"])
            .allows(&["shadow.phi"]),
        variant("the sun, whose shadow is measured")
            .when(&["shadow.sun_elevation", "shadow.sun_azimuth"])
            .needs(&["shadow.sun_elevation", "shadow.sun_azimuth"]),
        variant("no light").by_default(),
    ])
    .keeps_all_defaults(),
    group(&[
        variant("theta and phi").when(&["light.theta", "light.phi", "light.directions"]),
        variant("elevation and azimuth of the sun")
            .when(&["light.sun_elevation", "light.sun_azimuth"])
            .needs(&["light.sun_elevation", "light.sun_azimuth"]),
    ])
    .keeps_all_defaults(),
    group(&[
        variant("sun_theta and sun_phi").when(&["lights.sun_theta", "lights.sun_phi"]),
        variant("elevation and azimuth of the sun")
            .when(&["lights.sun_elevation", "lights.sun_azimuth"])
            .needs(&["lights.sun_elevation", "lights.sun_azimuth"]),
    ])
    .keeps_all_defaults(),
    group(&[
        variant("a sun of radiance 0").when(&["lights.sun=0"]),
        variant("a sun that shines").allows(&[
            "lights.sun_theta",
            "lights.sun_phi",
            "lights.sun_elevation",
            "lights.sun_azimuth",
            "lights.sun_radius",
            "lights.patch",
        ]),
    ])
    .keeps_all_defaults(),
    group(&[
        variant("numbers of surfaces and rays")
            .when(&["run.realisations", "run.rays"])
            .by_default(),
        variant("a target error")
            .when(&["run.target_error"])
            .allows(&["run.of"]),
    ])
    .keeps_all_defaults(),
    group(&[
        variant("bins").when(&["run.bins", "results.json"]),
        variant("directions").when(&["model.step", "model.sphere"]),
    ]),
    group_by(
        "export.format",
        &[
            variant("netcdf"),
            variant("klems"),
            variant("tensor-tree"),
            variant("rgl"),
            variant("rgl-rgb"),
            variant("pbsdf"),
            variant("zemax").allows(&["export.side"]),
            variant("fit"),
            variant("ssdd"),
        ],
    ),
    group(&[
        variant("quiet").when(&["program.quiet"]),
        variant("verbose").when(&["program.verbose"]),
    ]),
];

/// Settings whose values hold for one value of another, which stands first: a layer with another value of that clears them.
pub(in crate::settings) static HELD_BY: &[(&str, &[&str])] = &[
    ("measured.file", &["measured.*"]),
    ("material.kind", &["material.eta", "material.kappa"]),
    ("surface.sigma", &["output.models_at_sigma"]),
    ("light.theta", &["output.over_sigma_at_theta"]),
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
