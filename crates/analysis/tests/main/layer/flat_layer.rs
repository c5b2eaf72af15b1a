//! A medium between flat faces: limits, sums and symmetries of its closed forms.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity_analysis::{FlatLayers, LayerPaths};
use asperity_optics::{
    Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction, dielectric,
    from_spherical,
};
use asperity_tally::{
    Azimuth, Component, HemisphereGrid, MAX_LISTED_ORDER, Side, Sides, TallyResult, TallySpec,
    TallyValues,
};
use glam::DVec3;

const BOTH: [LayerPaths; 2] = LayerPaths::ALL;

fn medium(albedo: f64, g: f64) -> ParticipatingMedium {
    let phase = PhaseFunction::henyey_greenstein(g).unwrap();
    ParticipatingMedium::from_mean_free_path(1.0, albedo, phase).unwrap()
}

/// Optical thickness is the thickness.
fn slab(albedo: f64, g: f64, tau: f64, bottom: Bottom) -> Layer {
    Layer::slab(medium(albedo, g), tau, bottom).unwrap()
}

fn model(eta: f64, layer: &Layer, paths: LayerPaths) -> FlatLayers {
    FlatLayers::new(Material::Dielectric { eta }, &[*layer], paths).unwrap()
}

fn degrees(theta: f64, phi: f64) -> DVec3 {
    from_spherical(theta.to_radians(), phi.to_radians())
}

fn light(theta: f64) -> Incidence {
    Incidence::from_degrees(theta, 0.0).unwrap()
}

fn spec(n_theta: usize, n_phi: usize, half_width: f64) -> TallySpec {
    let grid = HemisphereGrid::new(n_theta, n_phi).unwrap();
    TallySpec::new(grid, half_width).unwrap().with_medium()
}

/// The tally of light in the plane of azimuth zero.
fn tally(model: &FlatLayers, theta: f64, spec: &TallySpec) -> TallyValues {
    model.tally(light(theta), spec, Azimuth::From(PI))
}

fn fluxes_of(model: &FlatLayers, theta: f64, component: Component) -> [f64; 2] {
    let tally = tally(model, theta, &spec(6, 4, 0.1));
    Side::BOTH.map(|side| tally.flux(side, component))
}

#[test]
fn hanrahan_krueger_agrees_with_the_equations_of_the_paper() {
    // Eqs. 20 and 21 and the first-order transmitted radiance, computed apart in angles within the layer.
    let layer = slab(0.9, 0.3, 0.1, Bottom::interface(1.0 / 1.5));
    let model = model(1.5, &layer, LayerPaths::HanrahanKrueger);
    let wi = degrees(30.0, 0.0);
    for (theta, phi, expected) in [
        (45.0, 180.0, 0.0015583406857313682),
        (60.0, 90.0, 0.001518990769615514),
        (135.0, 180.0, 0.008114635744529896),
        // As steep as it entered: cos theta_i = cos theta_t.
        (150.0, 180.0, 0.007849640489273014),
        (105.0, 0.0, 0.003665182808610311),
    ] {
        let f = model.bsdf(wi, degrees(theta, phi));
        assert!((f / expected - 1.0).abs() < 1e-12, "{theta} {phi} {f}");
    }
    let beams = model.unscattered(wi);
    assert!((beams[0].flux - 0.04152262597582152).abs() < 1e-15);
    assert!((beams[1].flux - 0.8262278781720569).abs() < 1e-15);
    // Between parallel faces light leaves as it came.
    assert!((beams[1].wo + wi).length() < 1e-15);
}

#[test]
fn a_matched_half_space_gives_lommel_and_seeliger() {
    let layer = Layer::half_space(medium(0.7, 0.0));
    for paths in BOTH {
        let model = model(1.0, &layer, paths);
        for (theta_i, theta_o) in [(0.0, 0.0), (30.0, 70.0), (85.0, 89.9)] {
            let (wi, wo) = (degrees(theta_i, 0.0), degrees(theta_o, 50.0));
            let expected = 0.7 / (4.0 * PI) / (wi.z + wo.z);
            assert!((model.bsdf(wi, wo) / expected - 1.0).abs() < 1e-14);
        }
        assert_eq!(model.bsdf(degrees(30.0, 0.0), -DVec3::Z), 0.0);
    }
}

#[test]
fn thick_slabs_agree_with_half_spaces_for_any_bottom() {
    let endless = Layer::half_space(medium(0.8, 0.4));
    for bottom in [
        Bottom::Open,
        Bottom::ABSORBING,
        Bottom::MIRROR,
        Bottom::interface(0.6),
    ] {
        let thick = slab(0.8, 0.4, 60.0, bottom);
        let [a, b] = [&endless, &thick].map(|layer| model(1.4, layer, LayerPaths::All));
        for theta in [0.0, 40.0, 88.0] {
            let wo = degrees(theta, 100.0);
            let wi = degrees(20.0, 0.0);
            assert!((b.bsdf(wi, wo) / a.bsdf(wi, wo) - 1.0).abs() < 1e-15);
            assert!(b.bsdf(wi, -wo) < 1e-15);
        }
    }
}

#[test]
fn both_models_agree_without_inner_reflection() {
    for layer in [
        Layer::half_space(medium(0.8, 0.4)),
        slab(0.8, 0.4, 0.3, Bottom::ABSORBING),
    ] {
        let [letter, exact] = BOTH.map(|paths| model(1.5, &layer, paths));
        for theta in [0.0, 30.0, 80.0] {
            let (wi, wo) = (degrees(50.0, 0.0), degrees(theta, 70.0));
            assert!((letter.bsdf(wi, wo) / exact.bsdf(wi, wo) - 1.0).abs() < 1e-15);
        }
    }
    let [letter, exact] = BOTH.map(|paths| model(1.5, &slab(0.8, 0.4, 0.3, Bottom::Open), paths));
    let (wi, wo) = (degrees(50.0, 0.0), degrees(110.0, 70.0));
    assert!(exact.bsdf(wi, wo) > 1.01 * letter.bsdf(wi, wo));
}

#[test]
fn the_layer_is_reciprocal() {
    // Upside down: the top becomes the bottom.
    for (eta, beyond) in [(1.5, 1.0 / 1.5), (1.5, 0.9), (0.8, 1.3), (1.2, 1.0)] {
        let there = slab(0.9, 0.6, 0.5, Bottom::interface(beyond));
        let back = slab(0.9, 0.6, 0.5, Bottom::interface(1.0 / eta));
        for paths in BOTH {
            let (there, back) = (model(eta, &there, paths), model(1.0 / beyond, &back, paths));
            for (theta_i, theta_o, phi) in [(10.0, 40.0, 30.0), (40.0, 20.0, 170.0)] {
                let (wi, wr) = (degrees(theta_i, 0.0), degrees(theta_o, phi));
                let forth = there.bsdf(wi, wr);
                assert!(forth > 0.0);
                assert!((there.bsdf(wr, wi) / forth - 1.0).abs() < 1e-13);
                // f(wi, wo) / n_o^2 = f(wo, wi) / n_i^2 with n_o / n_i = eta beyond.
                let mirrored = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
                let wt = mirrored(wr);
                let forth = there.bsdf(wi, wt) / (eta * beyond).powi(2);
                let return_way = back.bsdf(mirrored(wt), mirrored(wi));
                assert!(forth > 0.0);
                assert!(
                    (return_way / forth - 1.0).abs() < 1e-13,
                    "{eta} {beyond} {paths:?}"
                );
            }
        }
    }
}

#[test]
fn a_clear_plate_transmits_like_two_faces() {
    // Without a medium the reflectances of two equal faces sum to 2 R / (1 + R): Stokes 1862.
    let phase = PhaseFunction::Isotropic;
    let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, phase).unwrap();
    let eta: f64 = 1.5;
    let layer = Layer::slab(clear, 1.0, Bottom::interface(1.0 / eta)).unwrap();
    let model = model(eta, &layer, LayerPaths::All);
    for theta in [0.0, 40.0, 80.0, 89.99] {
        let wi = degrees(theta, 10.0);
        let r = dielectric(wi.z, eta).reflected;
        let [reflected, transmitted] = [0, 1].map(|i| model.unscattered(wi)[i].flux);
        // Seen from within, the cosine outside magnifies the rounding of that inside by eta^2 / cos, and dR /
        // dcos is at most about 4 eta.
        let rounding = 8.0 * eta.powi(3) / wi.z * f64::EPSILON;
        assert!(
            (reflected - 2.0 * r / (1.0 + r)).abs() < 2.0 * rounding,
            "{theta}"
        );
        assert!((reflected + transmitted - 1.0).abs() < 1e-12);
        // In orders 1, 3, 5 ... and 2, 4, 6 ...
        let spec = spec(6, 4, 0.1);
        let tally = tally(&model, theta, &spec);
        let t = 1.0 - r;
        for (side, order, expected) in [
            (Side::Reflected, 1, r),
            (Side::Reflected, 3, t * t * r),
            (Side::Reflected, 5, t * t * r.powi(3)),
            (Side::Transmitted, 2, t * t),
            (Side::Transmitted, 4, t * t * r * r),
        ] {
            assert!((tally[spec.order_entry(side, order)] - expected).abs() < 4.0 * rounding);
        }
        let orders = |side| (1..=MAX_LISTED_ORDER).map(move |order| spec.order_entry(side, order));
        let sum: f64 = Side::BOTH
            .into_iter()
            .flat_map(orders)
            .map(|i| tally[i])
            .sum();
        assert!((sum - 1.0).abs() < 1e-12, "{theta}: {sum}");
    }
    // An endless clear medium is its face alone.
    let half = self::model(eta, &Layer::half_space(clear), LayerPaths::All);
    let beams = half.unscattered(degrees(40.0, 0.0));
    let r = dielectric(40_f64.to_radians().cos(), eta).reflected;
    assert!((beams[0].flux - r).abs() < 1e-15 && (beams[1].flux - (1.0 - r)).abs() < 1e-15);
}

#[test]
fn light_returned_by_a_mirror_is_the_sum_over_its_reflections() {
    let (eta, tau): (f64, f64) = (1.5, 0.4);
    let model = model(eta, &slab(0.5, 0.0, tau, Bottom::MIRROR), LayerPaths::All);
    for theta in [20.0, 85.0] {
        let wi = degrees(theta, 0.0);
        let face = dielectric(wi.z, eta);
        let (r, t) = (face.reflected, face.transmitted);
        let there_and_back = (-2.0 * tau / face.cos_theta_t).exp();
        let bounces = (0..60).map(|k| t * t * there_and_back.powi(k + 1) * r.powi(k));
        let expected = r + bounces.sum::<f64>();
        let [beam] = model.unscattered(wi)[..] else {
            panic!("nothing passes a mirror");
        };
        assert!((beam.flux / expected - 1.0).abs() < 1e-13, "{theta}");
    }
}

#[test]
fn thin_plates_release_scattered_light_within_the_escape_cone() {
    // To first order in tau, light crosses the medium on 1 / mu_i free paths (1 + R + R^2 ...) T = 1 times,
    // and of what is scattered evenly the fraction 1 - sqrt(1 - 1/eta^2) lies in the two cones that the faces let
    // through sooner or later; the rest is caught. The next order is tau / mu, mu > 0.74 all over.
    let eta: f64 = 1.5;
    for tau in [1e-3, 1e-5] {
        let layer = slab(1.0, 0.0, tau, Bottom::interface(1.0 / eta));
        let model = model(eta, &layer, LayerPaths::All);
        for theta in [0.0_f64, 50.0] {
            let mu = (1.0 - (theta.to_radians().sin() / eta).powi(2)).sqrt();
            let expected = tau / mu * (1.0 - (1.0 - 1.0 / (eta * eta)).sqrt());
            let [reflected, transmitted] = fluxes_of(&model, theta, Component::ScatteredOnce);
            let ratio = (reflected + transmitted) / expected;
            println!("tau {tau} theta {theta}: {ratio}");
            assert!((ratio - 1.0).abs() < 4.0 * tau, "{ratio}");
            // Evenly scattered light leaves on both sides alike.
            assert!((reflected / transmitted - 1.0).abs() < 4.0 * tau);
        }
    }
    // Matched and open, everything gets out but what grazes: tau (ln(1 / tau) + 1) of it is met again.
    let tau = 1e-4;
    let model = model(
        1.0,
        &slab(1.0, 0.5, tau, Bottom::Open),
        LayerPaths::HanrahanKrueger,
    );
    let once = fluxes_of(&model, 60.0, Component::ScatteredOnce);
    let ratio = (once[0] + once[1]) / (tau / 0.5);
    println!("matched: {ratio}");
    assert!((ratio - 1.0).abs() < tau * (1.0 - tau.ln()) + 2.0 * tau);
}

#[test]
fn values_are_finite_at_critical_angles_at_grazing_and_without_thickness() {
    let bottoms = [
        Bottom::Open,
        Bottom::ABSORBING,
        Bottom::MIRROR,
        Bottom::interface(0.5),
        Bottom::interface(1.8),
    ];
    for eta in [0.5, 1.0, 1.5] {
        for tau in [1e-300, 1e-12, 1.0, 1e4] {
            for bottom in bottoms {
                let model = model(eta, &slab(1.0, 0.9, tau, bottom), LayerPaths::All);
                for theta_i in [0.0, 29.999_999_999_999_99, 30.0, 60.0, 89.999_999_999] {
                    let wi = degrees(theta_i, 0.0);
                    let flux: f64 = model.unscattered(wi).iter().map(|beam| beam.flux).sum();
                    assert!(
                        (0.0..=1.0 + 1e-12).contains(&flux),
                        "{eta} {tau} {bottom:?} {flux}"
                    );
                    for theta_o in [
                        0.0,
                        30.0,
                        60.0,
                        89.999_999_999,
                        90.000_000_001,
                        150.0,
                        180.0,
                    ] {
                        let f = model.bsdf(wi, degrees(theta_o, 180.0));
                        assert!(f.is_finite() && f >= 0.0, "{eta} {tau} {bottom:?} {f}");
                    }
                }
            }
        }
    }
}

#[test]
fn light_beyond_the_critical_angle_neither_enters_nor_leaves() {
    let layer = slab(1.0, 0.0, 1.0, Bottom::interface(1.8));
    let model = model(0.8, &layer, LayerPaths::All);
    let critical = 0.8_f64.asin().to_degrees();
    let wi = degrees(critical + 0.1, 0.0);
    assert_eq!(model.unscattered(wi).len(), 1);
    assert_eq!(model.unscattered(wi)[0].flux, 1.0);
    assert_eq!(model.bsdf(wi, DVec3::Z), 0.0);
    let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic);
    let plate = Layer::slab(clear.unwrap(), 1.0, Bottom::interface(1.8)).unwrap();
    for paths in BOTH {
        let plate = self::model(0.8, &plate, paths);
        assert_eq!(plate.unscattered(wi)[0].flux, 1.0);
        assert_eq!(
            fluxes_of(&plate, critical + 0.1, Component::Unscattered),
            [1.0, 0.0]
        );
    }
    let wi = degrees(20.0, 0.0);
    assert!(model.bsdf(wi, degrees(critical - 0.1, 0.0)) > 0.0);
    assert_eq!(model.bsdf(wi, degrees(critical + 0.1, 0.0)), 0.0);
    // Into the denser medium below, none leaves flatter than its own critical angle.
    let critical = 180.0 - (1_f64 / 1.8).asin().to_degrees();
    assert!(model.bsdf(wi, degrees(critical + 0.1, 0.0)) > 0.0);
    assert_eq!(model.bsdf(wi, degrees(critical - 0.1, 0.0)), 0.0);
}

#[test]
fn tallies_of_different_grids_agree_and_components_add_up() {
    let cases = [
        (1.5, 0.99, 0.2, Bottom::interface(1.0 / 1.5)),
        (1.5, -0.9, 0.2, Bottom::MIRROR),
        (0.7, 0.5, 1e-3, Bottom::interface(2.0)),
        (1.0, 0.0, 1e-6, Bottom::Open),
        (1.4, 0.8, 2.0, Bottom::Open),
    ];
    let coarse = spec(1, 1, FRAC_PI_2);
    let fine = spec(9, 12, FRAC_PI_2);
    for (eta, g, tau, bottom) in cases {
        let model = model(eta, &slab(0.9, g, tau, bottom), LayerPaths::All);
        let (one, many) = (tally(&model, 25.0, &coarse), tally(&model, 25.0, &fine));
        for side in Side::BOTH {
            for component in [Component::Unscattered, Component::ScatteredOnce] {
                let a = one.flux(side, component);
                let b = many.flux(side, component);
                assert!((a - b).abs() < 1e-11, "{eta} {bottom:?} {side} {a} {b}");
                let rings: f64 = many.rings(side, component).iter().sum();
                let profile: f64 = many.in_plane(side, component).iter().sum();
                // A slice of half a turn to both sides is everything.
                assert!((rings - b).abs() < 1e-11 && (profile - b).abs() < 1e-11);
            }
            let all = many.flux(side, Component::All);
            let total: f64 = Component::BINS
                .map(|component| many.bins(side, component).iter().sum::<f64>())
                .into_iter()
                .sum();
            assert!((0.5 * total - all).abs() < 1e-11);
            let first = many.order(side, 1);
            assert!((first + many.flux(side, Component::Multiple) - all).abs() < 1e-11);
            let rings: f64 = many.rings(side, Component::Single).iter().sum();
            assert!((rings - first).abs() < 1e-11);
        }
    }
}

#[test]
fn unrecorded_sides_and_azimuths_stay_empty() {
    let model = model(1.5, &slab(0.9, 0.5, 0.3, Bottom::Open), LayerPaths::All);
    let reflected = spec(3, 4, 0.1).with_sides(Sides::Reflected);
    let tally = tally(&model, 30.0, &reflected);
    assert!(tally.budget().reflected > 0.0 && tally.budget().transmitted == 0.0);
    assert_eq!(tally.flux(Side::Transmitted, Component::ScatteredOnce), 0.0);
    assert!(
        tally.budget().not_recorded > 0.5,
        "the unscattered light, which would have gone there"
    );
    // From straight above, all bins of a ring hold the same.
    let spec = spec(3, 4, 0.1);
    let tally = model.tally(light(0.0), &spec, Azimuth::Free);
    for ring in tally[spec.grid_entries(Component::Unscattered)].chunks(4) {
        assert!(ring.iter().all(|flux| flux == &ring[0]));
    }
    for ring in tally[spec.grid_entries(Component::ScatteredOnce)].chunks(4) {
        assert!(ring.iter().all(|flux| (flux - ring[0]).abs() < 1e-15));
    }
}

#[test]
fn layers_without_a_model_are_refused() {
    let refusal = |paths, eta: f64, bottom| {
        let layer = slab(0.5, 0.0, 1.0, bottom);
        let error = FlatLayers::new(Material::Dielectric { eta }, &[layer], paths).unwrap_err();
        error.to_string()
    };
    let white = Bottom::lambertian(1.0);
    for paths in LayerPaths::ALL {
        assert!(refusal(paths, 1.5, white).contains("Lambertian"));
        assert!(refusal(paths, -1.0, Bottom::Open).contains("eta is -1"));
    }
    let mirror = refusal(LayerPaths::HanrahanKrueger, 1.5, Bottom::MIRROR);
    assert!(mirror.contains("use flat-layer"));
}

#[test]
fn layer_models_have_the_names_that_find_them() {
    for name in FlatLayers::NAMES {
        assert_eq!(LayerPaths::by_name(name).map(LayerPaths::name), Some(name));
    }
    assert_eq!(LayerPaths::by_name("kubelka-munk"), None);
}
