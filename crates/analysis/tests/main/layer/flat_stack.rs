//! Stacks of flat layers: sums, symmetries and limits of their closed forms.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity_analysis::{FlatLayers, LayerPaths};
use asperity_optics::{
    Bottom, Film, Films, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction,
    dielectric, from_spherical,
};
use asperity_tally::{
    Azimuth, Component, Event, EventPath, HemisphereGrid, MAX_LISTED_ORDER, Side, TallyResult,
    TallySpec, TallyValues,
};
use glam::DVec3;

/// A layer whose optical thickness is `tau`, on a face of index `beyond` to what is below.
fn slab(albedo: f64, g: f64, tau: f64, bottom: Bottom) -> Layer {
    let phase = PhaseFunction::henyey_greenstein(g).unwrap();
    let medium = match tau {
        0.0 => ParticipatingMedium::from_coefficients(0.0, 0.0, phase),
        _ => ParticipatingMedium::from_mean_free_path(1.0, albedo, phase),
    };
    Layer::slab(medium.unwrap(), if tau > 0.0 { tau } else { 1.0 }, bottom).unwrap()
}

/// Layers of these indices, from the medium above to that below.
fn stack(indices: &[f64], [albedo, g, tau]: [f64; 3], paths: LayerPaths) -> FlatLayers {
    let faces: Vec<f64> = indices.windows(2).map(|pair| pair[1] / pair[0]).collect();
    let layers: Vec<Layer> = faces[1..]
        .iter()
        .map(|eta| slab(albedo, g, tau, Bottom::interface(*eta)))
        .collect();
    FlatLayers::new(Material::Dielectric { eta: faces[0] }, &layers, paths).unwrap()
}

fn clear(indices: &[f64]) -> FlatLayers {
    stack(indices, [0.0; 3], LayerPaths::All)
}

fn degrees(theta: f64, phi: f64) -> DVec3 {
    from_spherical(theta.to_radians(), phi.to_radians())
}

fn spec(n_theta: usize, n_phi: usize) -> TallySpec {
    let grid = HemisphereGrid::new(n_theta, n_phi).unwrap();
    TallySpec::new(grid, FRAC_PI_2).unwrap().with_medium()
}

fn tally(model: &FlatLayers, theta: f64, spec: &TallySpec) -> TallyValues {
    let light = Incidence::from_degrees(theta, 0.0).unwrap();
    model.tally(light, spec, Azimuth::From(PI))
}

/// Reflected and transmitted flux of unscattered light.
fn unscattered(model: &FlatLayers, wi: DVec3) -> [f64; 2] {
    let flux = |side| {
        let beams = model.unscattered(wi).into_iter();
        beams
            .filter(|beam| beam.side == side)
            .map(|beam| beam.flux)
            .sum()
    };
    Side::BOTH.map(flux)
}

#[test]
fn layers_of_one_medium_are_one_layer() {
    for bottom in [
        Bottom::interface(1.0 / 1.5),
        Bottom::Open,
        Bottom::MIRROR,
        Bottom::interface(1.3),
    ] {
        for paths in LayerPaths::ALL {
            if bottom == Bottom::MIRROR && paths == LayerPaths::HanrahanKrueger {
                continue;
            }
            let top = Material::Dielectric { eta: 1.5 };
            let matched = Bottom::interface(1.0);
            let one = FlatLayers::new(top, &[slab(0.9, 0.4, 1.3, bottom)], paths).unwrap();
            let parts = [
                (0.2, matched),
                (0.7, matched),
                (1e-3, matched),
                (0.399, bottom),
            ];
            let parts = parts.map(|(tau, bottom)| slab(0.9, 0.4, tau, bottom));
            let many = FlatLayers::new(top, &parts, paths).unwrap();
            assert!((many.optical_thickness() - 1.3).abs() < 1e-15);
            for theta_i in [0.0, 20.0, 60.0, 89.0] {
                let wi = degrees(theta_i, 0.0);
                let [a, b] = [&one, &many].map(|model| unscattered(model, wi));
                for (a, b) in a.iter().zip(b) {
                    assert!((a - b).abs() < 1e-14, "{bottom:?} {paths:?} {theta_i}");
                }
                for (theta_o, phi) in [
                    (0.0, 0.0),
                    (20.0, 180.0),
                    (70.0, 50.0),
                    (120.0, 10.0),
                    (170.0, 180.0),
                ] {
                    let wo = degrees(theta_o, phi);
                    let [a, b] = [&one, &many].map(|model| model.bsdf(wi, wo));
                    assert!(
                        (a - b).abs() <= 1e-12 * a,
                        "{bottom:?} {paths:?} {theta_i} {theta_o}"
                    );
                }
            }
            // Components as well, except for the interactions with the faces between
            let spec = spec(3, 4);
            let [a, b] = [&one, &many].map(|model| tally(model, 35.0, &spec));
            for side in Side::BOTH {
                for component in [
                    Component::Unscattered,
                    Component::ScatteredOnce,
                    Component::All,
                ] {
                    let error = (a.flux(side, component) - b.flux(side, component)).abs();
                    assert!(error < 1e-12, "{side} {component} {error:e}");
                }
            }
        }
    }
}

/// Fresnel's reflectance as textbooks have it, s and p averaged.
fn reflectance(above: f64, below: f64, across: f64) -> f64 {
    let [c, t] = [above, below].map(|n| (1.0 - (across / n).powi(2)).sqrt());
    let s = (above * c - below * t) / (above * c + below * t);
    let p = (below * c - above * t) / (below * c + above * t);
    0.5 * (s * s + p * p)
}

#[test]
fn clear_stacks_are_the_series_of_their_faces() {
    let indices = [1.0, 1.5, 1.9, 1.2, 1.1];
    let model = clear(&indices);
    for theta in [0.0_f64, 30.0, 75.0, 89.0] {
        let across = theta.to_radians().sin();
        let faces: Vec<f64> = indices
            .windows(2)
            .map(|pair| reflectance(pair[0], pair[1], across))
            .collect();
        // Light that bounces between the faces, until next to nothing is left inside
        let mut inside = vec![[0.0; 2]; indices.len()];
        inside[0][0] = 1.0;
        let [mut reflected, mut transmitted] = [0.0; 2];
        for _ in 0..2000 {
            let mut next = vec![[0.0; 2]; indices.len()];
            for (face, r) in faces.iter().enumerate() {
                let [down, up] = [inside[face][0], inside[face + 1][1]];
                next[face][1] += down * r + up * (1.0 - r);
                next[face + 1][0] += up * r + down * (1.0 - r);
            }
            reflected += next[0][1];
            transmitted += next[indices.len() - 1][0];
            next[0] = [0.0; 2];
            next[indices.len() - 1] = [0.0; 2];
            inside = next;
        }
        let found = unscattered(&model, degrees(theta, 40.0));
        // Reflectances here lose the digits of the cosine
        let rounding = 1e-13 / theta.to_radians().cos();
        assert!(
            (found[0] - reflected).abs() < rounding,
            "{theta}: {found:?} {reflected}"
        );
        assert!(
            (found[1] - transmitted).abs() < rounding,
            "{theta}: {found:?} {transmitted}"
        );
        // Path by path
        let spec = spec(6, 4);
        let tally = tally(&model, theta, &spec);
        let t: Vec<f64> = faces.iter().map(|r| 1.0 - r).collect();
        for (side, events, expected) in [
            (Side::Reflected, "R", faces[0]),
            (Side::Reflected, "TRT", t[0] * t[0] * faces[1]),
            (Side::Reflected, "TTRTT", (t[0] * t[1]).powi(2) * faces[2]),
            (
                Side::Reflected,
                "TRRRT",
                t[0] * t[0] * faces[1].powi(2) * faces[0],
            ),
            (Side::Reflected, "TT", 0.0),
            (Side::Transmitted, "TTTT", t.iter().product()),
            (
                Side::Transmitted,
                "TRRTTT",
                t.iter().product::<f64>() * faces[1] * faces[0],
            ),
            (
                Side::Transmitted,
                "TTRRTT",
                t.iter().product::<f64>() * faces[2] * faces[1],
            ),
        ] {
            let path = events.chars().fold(EventPath::default(), |path, event| {
                path.then(if event == 'T' {
                    Event::Transmission
                } else {
                    Event::Reflection
                })
            });
            let found = tally[spec.event_path_entry(side, path)];
            assert!(
                (found - expected).abs() < rounding,
                "{theta} {events}: {found} {expected}"
            );
        }
        let orders = |side| (1..=MAX_LISTED_ORDER).map(move |order| spec.order_entry(side, order));
        let sides = Side::BOTH.into_iter();
        let sum: f64 = sides.flat_map(orders).map(|entry| tally[entry]).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{theta}: {sum}");
    }
}

#[test]
fn clear_stacks_lose_no_light() {
    // Down to total reflection at a face inside, at the last one, and at grazing
    let many: Vec<f64> = (0..30).map(|i| 1.0 + 0.4 * f64::from(i % 3)).collect();
    for indices in [
        &[1.0, 1.5, 0.8, 1.5, 1.0][..],
        &[1.0, 1.5, 0.7],
        &[1.3, 1.0, 1.3],
        &many,
    ] {
        let model = clear(indices);
        let critical = |n: f64| (n / indices[0]).min(1.0).asin().to_degrees();
        let least = critical(indices.iter().copied().fold(f64::INFINITY, f64::min));
        let mut angles = vec![0.0, 45.0, 80.0, 89.999_999_999];
        if least < 90.0 {
            angles.extend([least - 1e-9, least, least + 1e-9]);
        }
        for theta in angles {
            let [r, t] = unscattered(&model, degrees(theta, 0.0));
            assert!((r + t - 1.0).abs() < 1e-12, "{indices:?} {theta}: {r} {t}");
            assert!(
                theta <= least + 1e-10 || t == 0.0,
                "{indices:?} {theta}: {t}"
            );
        }
    }
}

#[test]
fn stacks_are_reciprocal() {
    let indices = [1.0, 1.5, 1.2, 1.8, 1.3];
    let reversed: Vec<f64> = indices.iter().rev().map(|n| n / 1.3).collect();
    let mirrored = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
    for paths in LayerPaths::ALL {
        let [there, back] = [&indices[..], &reversed].map(|n| stack(n, [0.9, 0.6, 0.5], paths));
        for (theta_i, theta_o, phi) in [(10.0, 40.0, 30.0), (40.0, 20.0, 170.0), (80.0, 5.0, 0.0)] {
            let (wi, wr) = (degrees(theta_i, 0.0), degrees(theta_o, phi));
            let forth = there.bsdf(wi, wr);
            assert!(forth > 0.0 && (there.bsdf(wr, wi) / forth - 1.0).abs() < 1e-13);
            let wt = mirrored(wr);
            let forth = there.bsdf(wi, wt) / 1.3_f64.powi(2);
            let return_way = back.bsdf(mirrored(wt), mirrored(wi));
            assert!(
                forth > 0.0 && (return_way / forth - 1.0).abs() < 1e-12,
                "{paths:?}"
            );
        }
        let [forth, return_way] = [
            (&there, 30.0_f64),
            (&back, (30_f64.to_radians().sin() / 1.3).asin().to_degrees()),
        ]
        .map(|(model, theta)| unscattered(model, degrees(theta, 0.0))[1]);
        assert!((return_way / forth - 1.0).abs() < 1e-13, "{paths:?}");
    }
}

#[test]
fn a_thick_lowest_layer_is_a_half_space() {
    let upper = slab(0.9, 0.5, 0.4, Bottom::interface(0.9));
    let medium = slab(0.8, -0.3, 1.0, Bottom::Open).medium();
    let top = Material::Dielectric { eta: 1.5 };
    let [thick, endless] = [
        slab(0.8, -0.3, 60.0, Bottom::MIRROR),
        Layer::half_space(medium),
    ]
    .map(|lower| FlatLayers::new(top, &[upper, lower], LayerPaths::All).unwrap());
    for theta in [0.0, 40.0, 88.0] {
        let (wi, wo) = (degrees(20.0, 0.0), degrees(theta, 100.0));
        assert!((thick.bsdf(wi, wo) / endless.bsdf(wi, wo) - 1.0).abs() < 1e-15);
    }
    assert_eq!(endless.optical_thickness(), f64::INFINITY);
    assert_eq!(unscattered(&endless, degrees(20.0, 0.0))[1], 0.0);
}

#[test]
fn values_of_stacks_are_finite_at_every_critical_angle_and_thickness() {
    for indices in [
        [1.0, 1.5, 0.5, 1.5, 1.0],
        [1.0, 0.5, 1.0, 0.5, 1.8],
        [1.0, 2.0, 1.0, 1.0, 0.5],
    ] {
        for tau in [0.0, 1e-300, 1e-12, 1.0, 1e4] {
            for paths in LayerPaths::ALL {
                let model = stack(&indices, [1.0, 0.9, tau], paths);
                for theta_i in [0.0, 29.999_999_999_999_99, 30.0, 60.0, 89.999_999_999] {
                    let wi = degrees(theta_i, 0.0);
                    let [r, t] = unscattered(&model, wi);
                    assert!(
                        (0.0..=1.0 + 1e-12).contains(&(r + t)),
                        "{indices:?} {tau} {r} {t}"
                    );
                    for theta_o in [0.0, 30.0, 89.999_999_999, 90.000_000_001, 150.0, 180.0] {
                        let f = model.bsdf(wi, degrees(theta_o, 180.0));
                        assert!(f.is_finite() && f >= 0.0, "{indices:?} {tau} {f}");
                    }
                }
            }
        }
    }
}

#[test]
fn tallies_of_stacks_agree_on_different_grids() {
    let (coarse, fine) = (spec(1, 1), spec(9, 12));
    for (indices, g, tau) in [
        ([1.0, 1.5, 1.1, 1.0], 0.99, 0.2),
        ([1.0, 0.7, 1.4, 2.0], 0.5, 1e-3),
    ] {
        for paths in LayerPaths::ALL {
            let model = stack(&indices, [0.9, g, tau], paths);
            let (one, many) = (tally(&model, 25.0, &coarse), tally(&model, 25.0, &fine));
            for side in Side::BOTH {
                for component in [Component::Unscattered, Component::ScatteredOnce] {
                    let [a, b] = [&one, &many].map(|tally| tally.flux(side, component));
                    let rings: f64 = many.rings(side, component).iter().sum();
                    let profile: f64 = many.in_plane(side, component).iter().sum();
                    for sum in [a, rings, profile] {
                        assert!(
                            (sum - b).abs() < 1e-11,
                            "{indices:?} {side} {component} {sum} {b}"
                        );
                    }
                }
            }
        }
    }
}

/// Each layer has one path without inner reflection, of two more faces than the layer above.
#[test]
fn hanrahan_krueger_has_light_of_each_layer_in_an_order_of_its_own() {
    let spec = spec(6, 8);
    let indices = [1.0, 1.5, 1.3, 1.6, 1.0];
    let model = stack(&indices, [0.9, 0.3, 0.2], LayerPaths::HanrahanKrueger);
    let found = tally(&model, 20.0, &spec);
    let once = found.flux(Side::Reflected, Component::ScatteredOnce);
    let orders = [2, 4, 6].map(|order| found[spec.order_entry(Side::Reflected, order)]);
    assert!(
        orders.is_sorted_by(|upper, lower| upper > lower),
        "{orders:?}"
    );
    assert!((orders.iter().sum::<f64>() - once).abs() < 1e-15);
    let rings = |component| found.rings(Side::Reflected, component).iter().sum::<f64>();
    let [.., and_above] = Component::ORDERS;
    assert!((rings(Component::Order(2)) - orders[0]).abs() < 1e-15);
    assert!((rings(and_above) - orders[1] - orders[2]).abs() < 1e-15);
    // Straight through all faces, scattered once or never
    let through = found[spec.order_entry(Side::Transmitted, 4)];
    assert!((through - found.flux(Side::Transmitted, Component::All)).abs() < 1e-15);
    // The uppermost layer alone, over what lets its light out
    let first = slab(0.9, 0.3, 0.2, Bottom::ABSORBING);
    let top = Material::Dielectric { eta: 1.5 };
    let alone = FlatLayers::new(top, &[first], LayerPaths::HanrahanKrueger).unwrap();
    let alone = tally(&alone, 20.0, &spec).flux(Side::Reflected, Component::ScatteredOnce);
    assert!((alone / orders[0] - 1.0).abs() < 1e-12);
}

#[test]
fn coated_faces_reflect_from_either_side_as_their_films_do() {
    let film =
        |eta: f64, kappa: f64, phase: f64| Films::new(&[Film { eta, kappa, phase }]).unwrap();
    let top = Material::coated(film(1.38, 0.0, 1.1), 1.5, 0.0).unwrap();
    // A clear film, and one that absorbs, whose sides reflect differently
    for kappa in [0.0, 0.4] {
        let inner = Material::coated(film(1.9, kappa, 0.9), 1.2, 0.0).unwrap();
        let layers = [
            slab(0.9, 0.3, 0.3, Bottom::Face(inner)),
            slab(0.8, 0.0, 0.4, Bottom::MIRROR),
        ];
        let model = FlatLayers::new(top, &layers, LayerPaths::All).unwrap();
        let wi = degrees(35.0, 0.0);
        let outer = top.fresnel(wi.z);
        let met = inner.fresnel(outer.cos_theta_t);
        let from_below = inner.reversed().fresnel(met.cos_theta_t);
        let [a, b] =
            [0.3 / outer.cos_theta_t, 0.4 / met.cos_theta_t].map(|tau: f64| (-2.0 * tau).exp());
        let below = met.reflected + met.transmitted.powi(2) * b / (1.0 - from_below.reflected * b);
        let inside = outer.reflected
            + outer.transmitted.powi(2) * a * below / (1.0 - outer.reflected * a * below);
        let [found, through] = unscattered(&model, wi);
        assert!(
            (found - inside).abs() < 1e-14 && through == 0.0,
            "{kappa}: {found} {inside}"
        );
        let there = model.bsdf(wi, degrees(10.0, 50.0));
        let back = model.bsdf(degrees(10.0, 50.0), wi);
        assert!(there > 0.0 && (there / back - 1.0).abs() < 1e-13);
        // As the lowest face, from both sides
        let plate = FlatLayers::new(
            top,
            &[slab(0.9, 0.3, 0.3, Bottom::Face(inner))],
            LayerPaths::All,
        )
        .unwrap();
        let turned = slab(0.9, 0.3, 0.3, Bottom::Face(top.reversed()));
        let turned = FlatLayers::new(inner.reversed(), &[turned], LayerPaths::All).unwrap();
        let wo = degrees(140.0, 60.0);
        let mirrored = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
        let n = 1.5_f64 * 1.2;
        let there = plate.bsdf(wi, wo) / (n * n);
        let back = turned.bsdf(mirrored(wo), mirrored(wi));
        assert!(
            there > 0.0 && (there / back - 1.0).abs() < 1e-13,
            "{kappa}: {there} {back}"
        );
    }
}

#[test]
fn coated_faces_at_their_critical_angle_have_finite_fluxes() {
    let film = Film {
        eta: 1.9,
        kappa: 0.0,
        phase: 0.9,
    };
    let beyond = Material::coated(Films::new(&[film]).unwrap(), 0.5, 0.0).unwrap();
    let layers = [
        slab(1.0, 0.3, 0.3, Bottom::Face(beyond)),
        slab(1.0, 0.0, 0.4, Bottom::interface(2.0)),
    ];
    let top = Material::Dielectric { eta: 1.5 };
    let model = FlatLayers::new(top, &layers, LayerPaths::All).unwrap();
    let critical = 0.75_f64.asin().to_degrees();
    for e in [-1e-7, -1e-14, 0.0, 1e-14, 1e-7] {
        let spec = spec(3, 4);
        let tally = tally(&model, critical + e, &spec);
        let all = Side::BOTH.map(|side| tally.flux(side, Component::All));
        let orders = Side::BOTH.map(|side| tally[spec.order_entry(side, 3)]);
        for flux in [all, orders].concat() {
            assert!((0.0..=1.0).contains(&flux), "{e:e}: {flux}");
        }
    }
}

#[test]
fn layers_that_no_light_enters_are_refused() {
    let refusal =
        |top, layers: &[Layer], paths| FlatLayers::new(top, layers, paths).unwrap_err().to_string();
    let glass = Material::Dielectric { eta: 1.5 };
    let lower = slab(0.5, 0.0, 1.0, Bottom::Open);
    for paths in LayerPaths::ALL {
        for bottom in [Bottom::Open, Bottom::ABSORBING, Bottom::MIRROR] {
            let said = refusal(glass, &[slab(0.5, 0.0, 1.0, bottom), lower], paths);
            assert!(said.contains("above layer 2"), "{said}");
        }
        let said = refusal(glass, &[Layer::half_space(lower.medium()), lower], paths);
        assert!(said.contains("above layer 2"), "{said}");
        let said = refusal(Material::Mirror, &[lower], paths);
        assert!(said.contains("above layer 1"), "{said}");
        let lambertian = slab(0.5, 0.0, 1.0, Bottom::lambertian(0.5));
        let upper = slab(0.5, 0.0, 1.0, Bottom::interface(1.1));
        assert!(refusal(glass, &[upper, lambertian], paths).contains("Lambertian"));
    }
    let metal = Bottom::Face(Material::conductor(0.2, 3.0).unwrap());
    let said = refusal(
        glass,
        &[slab(0.5, 0.0, 1.0, metal)],
        LayerPaths::HanrahanKrueger,
    );
    assert!(said.contains("use flat-layer"), "{said}");
    // A metal reflects what an absorbing bottom would take
    let model = FlatLayers::new(glass, &[slab(0.5, 0.0, 1.0, metal)], LayerPaths::All).unwrap();
    let r = dielectric(1.0, 1.5).reflected;
    let metal = Material::conductor(0.2, 3.0)
        .unwrap()
        .fresnel(1.0)
        .reflected;
    let returned = (-2.0_f64).exp() * metal;
    let expected = r + (1.0 - r).powi(2) * returned / (1.0 - r * returned);
    assert!((unscattered(&model, DVec3::Z)[0] - expected).abs() < 1e-15);
}
