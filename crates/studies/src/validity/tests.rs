//! Validity of geometric optics: exact answers, bottoms, words.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_simulate::{BottomSurface, Case, Light, SurfaceSource};
use asperity_surface::{HeightField, LengthUnit};
use asperity_tally::{HemisphereGrid, TallySpec};
use asperity_tracer::HalfSpace;

use super::coherence::Coherence;
use super::judgement::{LARGE, Validity};
use super::words::wavelength_warnings;
use crate::surface_lengths::SurfaceLengths;

fn case(material: Material, theta: f64) -> Case {
    let field = waves(1.0, LengthUnit::Arbitrary);
    let surface = SurfaceSource::height_field(field);
    let light = Light::from_above(Incidence::from_degrees(theta.to_degrees(), 0.0).unwrap());
    Case::new(surface, material, light)
}

fn spec() -> TallySpec {
    TallySpec::new(HemisphereGrid::default(), TallySpec::DEFAULT_HALF_WIDTH).unwrap()
}

fn of_field(field: &HeightField, theta: f64, wavelength_nm: Option<f64>) -> Option<Validity> {
    let lengths = SurfaceLengths::of_field(field);
    Validity::new(
        &lengths,
        None,
        &case(Material::Mirror, theta),
        &spec(),
        wavelength_nm,
    )
}

/// A surface of this height in micrometres, with the lengths of gentle bumps, and light of 550 nm.
fn of_case(sigma: f64, case: &Case) -> Validity {
    let lengths = SurfaceLengths {
        sigma,
        tau: Some(50.0),
        curvature: Some(1e-4),
        unit: LengthUnit::Micrometre,
        heights: Arc::default(),
    };
    Validity::new(&lengths, None, case, &spec(), None).unwrap()
}

#[test]
fn each_side_has_its_own_phase() {
    let glass = Material::Dielectric { eta: 1.5 };
    let found = of_case(0.135, &case(glass, 0.0));
    // Heights of 0.135 um: 3.08 rad of reflected light, and half an index step of transmitted light
    let transmitted = found.transmitted.unwrap();
    let phase = 2.0 * PI * 0.135 * 0.5 / 0.55;
    assert!((transmitted.phase_parameter - phase).abs() < 1e-12);
    assert!((transmitted.coherent_fraction - (-phase * phase).exp()).abs() < 1e-12);
    let reflected = found.reflected.unwrap();
    assert!((reflected.phase_parameter - 4.0 * PI * 0.135 / 0.55).abs() < 1e-12);
    assert_eq!(found.holds, Some(false));
    let text = found.to_string();
    assert!(text.contains("% of transmitted light coherent"), "{text}");
    // Opaque surfaces are judged by reflected light
    let mirror = of_case(0.135, &case(Material::Mirror, 0.0));
    assert_eq!((mirror.holds, mirror.transmitted), (Some(true), None));
    // At 60 degrees: n_t cos(theta_t) = sqrt(1.5^2 - 3/4)
    let found = of_case(0.3, &case(glass, PI / 3.0)).transmitted.unwrap();
    let phase = 2.0 * PI * 0.3 * (1.5_f64.sqrt() - 0.5) / 0.55;
    assert!((found.phase_parameter / phase - 1.0).abs() < 1e-12);
    // Total reflection leaves no side to judge
    let out = Material::Dielectric { eta: 1.0 / 1.5 };
    assert_eq!(of_case(0.3, &case(out, 1.0)).transmitted, None);
    // From below indices are relative to the medium below
    let mut below = case(out, 0.0);
    below.light.from = HalfSpace::Below;
    let found = of_case(0.135, &below);
    let reflected = found.reflected.unwrap();
    assert!((reflected.phase_parameter - 1.5 * 4.0 * PI * 0.135 / 0.55).abs() < 1e-12);
    assert!(
        (found.transmitted.unwrap().phase_parameter - transmitted.phase_parameter).abs() < 1e-12
    );
}

/// Water above shortens the wavelength, and all lengths are judged by it.
#[test]
fn lengths_are_judged_by_the_wavelength_in_the_medium_above() {
    let bare = case(Material::Mirror, 0.0);
    let mut wet = bare.clone();
    wet.at.index_above = Some(1.33);
    let found = |case| of_case(0.135, case);
    let phase = |case| found(case).reflected.unwrap().phase_parameter;
    assert!((phase(&wet) / phase(&bare) - 1.33).abs() < 1e-12);
    assert_eq!(found(&wet).wavelength_nm, found(&bare).wavelength_nm);
}

#[test]
fn the_bottom_of_a_layer_adds_to_the_phase_of_what_passes_it() {
    let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic);
    let of_thickness = |thickness: f64, bottom: BottomSurface| {
        let end = Bottom::interface(1.0 / 1.5);
        let layer = Layer::slab(clear.clone().unwrap(), thickness, end).unwrap();
        let mut case = case(Material::Dielectric { eta: 1.5 }, 0.0);
        case.layers = vec![layer.on(bottom)];
        of_case(0.2, &case)
    };
    let window = |bottom| of_thickness(1e-3, bottom);
    let k = 2.0 * PI * 0.2 / 0.55;
    let transmitted = |found: Validity| found.transmitted.unwrap().phase_parameter / k;
    let by_bottom = |found: Validity| found.reflected_by_bottom.unwrap().phase_parameter / k;
    let flat = window(BottomSurface::Flat);
    assert!((transmitted(flat) - 0.5).abs() < 1e-12 && (by_bottom(flat) - 1.0).abs() < 1e-12);
    // Faces of one shape shift no phase between points, and reflect as the shape itself
    let same = window(BottomSurface::Same);
    assert!(transmitted(same) < 1e-6 && (by_bottom(same) - 2.0).abs() < 1e-12);
    // On the way between them diffraction makes the phase of the light another: after a depth of k tau^2 / 2, half of it
    let depth = 0.5 * (TAU * 1.5 / 0.55) * 50.0 * 50.0;
    let deep = of_thickness(depth, BottomSurface::Same);
    assert!((transmitted(deep) - 0.5).abs() < 1e-12, "{deep:?}");
    let thick = of_thickness(1e9, BottomSurface::Same);
    assert!((transmitted(thick) - 0.5_f64.sqrt()).abs() < 1e-6);
    let independent = window(BottomSurface::Independent);
    assert!((transmitted(independent) - 0.5_f64.sqrt()).abs() < 1e-12);
    assert!((by_bottom(independent) - 10_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn wavelengths_without_effect_or_of_another_unit_are_told() {
    let found = |nanometres, unit| wavelength_warnings(Some(nanometres), false, unit).join(" ");
    assert!(found(633.0, LengthUnit::Arbitrary).contains("has no effect"));
    assert!(found(633_000.0, LengthUnit::Micrometre).contains("far from visible light"));
    assert_eq!(found(633.0, LengthUnit::Metre), "");
    let gold = wavelength_warnings(Some(633.0), true, LengthUnit::Arbitrary);
    assert!(
        gold.join(" ").contains("so that they cannot be compared"),
        "{gold:?}"
    );
    assert!(wavelength_warnings(None, false, LengthUnit::Arbitrary).is_empty());
}

/// Waves of amplitude `a` and period 32 along x, spacing 1.
fn waves(a: f64, unit: LengthUnit) -> HeightField {
    let heights = (0..64 * 64).map(|k| a * (TAU * f64::from(k % 64) / 32.0).sin());
    let field = HeightField::new(heights.collect(), [64, 64], [1.0, 1.0]).unwrap();
    field.with_unit(unit)
}

#[test]
fn numbers_follow_from_lengths_and_angle() {
    let theta = 60_f64.to_radians();
    // An amplitude of which hardly any light stays coherent
    let found = of_field(&waves(2.19, LengthUnit::Micrometre), theta, Some(500.0));
    let found = found.unwrap();
    // sigma = 2.19 um / sqrt 2, lambda = 0.5 um
    let sigma = 2.19 / 2_f64.sqrt();
    let rayleigh = 4.0 * PI * sigma * 0.5 / 0.5;
    let reflected = found.reflected.unwrap();
    assert!((reflected.phase_parameter / rayleigh - 1.0).abs() < 1e-12);
    // Second differences of a sine: 2 (1 - cos k) of it
    let curvature = sigma * 2.0 * (1.0 - (TAU / 32.0).cos());
    let radius = 0.125 / (curvature * 0.5);
    let ratio = found.curvature_radius_over_wavelength.unwrap() / radius;
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    assert!(found.holds == Some(true) && !found.wavelength_is_assumed);
    assert!(found.to_string().starts_with("lengths are large"));
}

/// V grooves of a height of half a wavelength at normal incidence and of their period, and the same in glass.
#[test]
fn heights_that_are_not_gaussian_tell_what_stays_coherent() {
    let sinc = |half: f64| (half.sin() / half).powi(2);
    let ridge = |i: i32| f64::from((i % 256 - 128).abs()) / 128.0;
    let field = |height: f64| {
        let heights = (0..16 * 512).map(|i| height * ridge(i)).collect();
        let field = HeightField::new(heights, [16, 512], [1.0, 1.0]).unwrap();
        SurfaceLengths::of_field(&field.with_unit(LengthUnit::Micrometre))
    };
    let found = |lengths: &SurfaceLengths, bottom, case: &Case| {
        Validity::new(lengths, bottom, case, &spec(), Some(600.0)).unwrap()
    };
    let near = |one: Option<Coherence>, exact: f64| {
        let fraction = one.unwrap().coherent_fraction;
        assert!((fraction - exact).abs() < 1e-4, "{fraction} {exact}");
    };
    let grooves = field(0.15);
    near(
        found(&grooves, None, &case(Material::Mirror, 0.0)).reflected,
        sinc(PI / 2.0),
    );
    // Phases of three and a half turns: 0.8 % of a sinc; of 13 and a half, with large lengths, nothing
    let high = found(&field(1.05), None, &case(Material::Mirror, 0.0));
    near(high.reflected, sinc(3.5 * PI));
    // Glass, at 60 degrees
    let glass = Material::Dielectric { eta: 1.5 };
    let k = TAU / 0.6;
    let step = 1.5_f64.sqrt() - 0.5;
    near(
        found(&grooves, None, &case(glass, PI / 3.0)).transmitted,
        sinc(0.5 * k * step * 0.15),
    );

    // Two faces of independent grooves, and of one shape at normal incidence
    let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic);
    let end = Bottom::interface(1.0 / 1.5);
    let mut window = case(glass, 0.0);
    let mut with = |bottom, of_file| {
        let layer = Layer::slab(clear.clone().unwrap(), 4.0, end).unwrap();
        window.layers = vec![layer.on(bottom)];
        found(&grooves, of_file, &window)
    };
    let one = sinc(0.25 * k * 0.15);
    let apart = with(BottomSurface::Independent, None);
    near(apart.transmitted, one * one);
    near(
        apart.reflected_by_bottom,
        sinc(0.5 * k * 0.15) * sinc(1.5 * k * 0.15),
    );
    let same = with(BottomSurface::Same, None);
    near(same.transmitted, 1.0);
    near(same.reflected_by_bottom, sinc(k * 0.15));
    let flat = with(BottomSurface::Flat, None);
    near(flat.transmitted, one);
    let other = field(0.4);
    near(
        with(BottomSurface::Flat, Some(&other)).transmitted,
        one * sinc(0.25 * k * 0.4),
    );
}

#[test]
fn a_coherent_part_makes_large_lengths_doubtful() {
    // A sine of two turns on either side of the mean
    let found = of_field(&waves(1.0, LengthUnit::Micrometre), PI / 3.0, Some(500.0)).unwrap();
    assert!(found.least() > LARGE && found.holds == Some(false));
    let fraction = found.reflected.unwrap().coherent_fraction;
    let exact = asperity_numerics::elementary::j0(4.0 * PI).powi(2);
    assert!((fraction - exact).abs() < 1e-3, "{fraction} {exact}");
    let text = found.to_string();
    assert!(text.contains("although all lengths are large"), "{text}");
    let warned = format!("up to {:.1} % of the reflected light", 100.0 * exact);
    assert!(found.first_lines_at_most().unwrap().contains(&warned));
    // Hills against light: level land at some height is known to no wavelength
    let steps = (0..64 * 64).map(|i| f64::from(i % 64 / 32)).collect();
    let hills = HeightField::new(steps, [64, 64], [1.0, 1.0]).unwrap();
    let hills = of_field(&hills.with_unit(LengthUnit::Metre), 0.0, None).unwrap();
    assert_eq!(hills.reflected.unwrap().coherent_fraction, 0.0);
}

#[test]
fn unknown_lengths_leave_the_verdict_open_unless_a_known_one_fails() {
    let of_sigma = |sigma| {
        let lengths = SurfaceLengths {
            sigma,
            tau: None,
            curvature: None,
            unit: LengthUnit::Metre,
            heights: Arc::default(),
        };
        Validity::new(&lengths, None, &case(Material::Mirror, 0.0), &spec(), None).unwrap()
    };
    let high = of_sigma(37.365_127_3);
    assert_eq!(high.holds, None);
    let text = high.to_string();
    assert!(text.contains("its height alone is judged"), "{text}");
    assert!(!text.contains("lengths are large"), "{text}");
    // Hills against light: no number says anything, and nobody has asked
    assert!(!text.contains("lambda") && high.note().is_none(), "{text}");
    let shallow = of_sigma(1e-9);
    assert_eq!(shallow.holds, Some(false));
    assert!(shallow.to_string().contains("doubtful"));
}

#[test]
fn shallow_surfaces_are_doubtful_and_unknown_units_are_not_judged() {
    let shallow = of_field(&waves(0.02, LengthUnit::Micrometre), 0.0, None).unwrap();
    assert!(shallow.holds == Some(false) && shallow.wavelength_is_assumed);
    let reflected = shallow.reflected.unwrap();
    let phase = reflected.phase_parameter;
    // A sine of amplitude 2^(1/2) sigma
    let exact = asperity_numerics::elementary::j0(2_f64.sqrt() * phase).powi(2);
    assert!((reflected.coherent_fraction - exact).abs() < 1e-3);
    let text = shallow.to_string();
    assert!(
        text.contains("doubtful") && text.contains("550 nm, assumed"),
        "{text}"
    );
    assert!(text.contains("% of reflected light coherent"), "{text}");
    assert_eq!(
        of_field(&waves(1.0, LengthUnit::Arbitrary), 0.0, None),
        None
    );
    assert_eq!(of_field(&waves(0.0, LengthUnit::Metre), 0.0, None), None);
    // The same lengths in another unit
    let metres = HeightField::new(
        waves(0.02, LengthUnit::Metre)
            .heights()
            .iter()
            .map(|h| h * 1e-6)
            .collect(),
        [64, 64],
        [1e-6, 1e-6],
    );
    let metres = metres.unwrap().with_unit(LengthUnit::Metre);
    let same = of_field(&metres, 0.0, None).unwrap();
    let same = same.reflected.unwrap().phase_parameter;
    assert!((same / phase - 1.0).abs() < 1e-12);
}
