//! Polarised light on its way: flat surfaces to rounding, symmetries of Mueller matrices, and what averaging changes.

use asperity_optics::{Incidence, Material, PolarisedFresnel};
use asperity_surface::{Border, HeightField};
use asperity_tally::{
    Component, Entry, Measure, Side, TallyResult, TallySpec, TallyStatistics, TallyValues,
};
use asperity_tracer::{
    AcceleratorKind, Branching, BuildAccelerator, HalfSpace, Illumination, PathSettings,
    PathStream, Polarisation, Surface, Tracer,
};

use num_complex::Complex64;

use crate::common::{rugged, waves};

/// A surface and the light on it.
struct Scene<'a> {
    surface: &'a Surface,
    material: Material,
    incident: HalfSpace,
    light: Illumination,
    settings: PathSettings,
}

impl<'a> Scene<'a> {
    fn new(surface: &'a Surface, material: Material, theta_deg: f64, phi_deg: f64) -> Self {
        let incidence = Incidence::from_degrees(theta_deg, phi_deg).unwrap();
        Self {
            surface,
            material,
            incident: HalfSpace::Above,
            light: Illumination::new(incidence, false),
            settings: PathSettings::default(),
        }
    }

    fn spec(&self) -> TallySpec {
        let polarimetry = self.settings.polarisation().polarimetry();
        TallySpec::default().with_polarimetry(polarimetry)
    }

    fn batch(&self, strata: u32, first: u64) -> TallyValues {
        let accelerator = self.surface.accelerator(AcceleratorKind::Auto).unwrap();
        let tracer = Tracer::new(
            self.surface,
            &*accelerator,
            self.material,
            self.incident,
            self.settings,
        );
        let stream = PathStream::new(1, 0).from_path(first);
        tracer
            .batch(&self.light, strata, self.spec(), None, stream)
            .0
    }

    fn batches(&self, count: u64, strata: u32) -> TallyStatistics {
        let mut statistics = TallyStatistics::new(self.spec());
        for batch in 0..count {
            let rays = u64::from(strata * strata);
            statistics.push(&self.batch(strata, batch * rays));
        }
        statistics
    }
}

fn mueller() -> PathSettings {
    PathSettings::default().with_polarisation(Polarisation::Mueller)
}

/// The matrix in the place of a flux entry.
fn matrix(values: &TallyValues, flux: Entry) -> [[f64; 4]; 4] {
    let spec = *values.spec();
    let element = |row: usize, column: usize| {
        let measure = Measure::Element { row, column };
        values[spec.measure_entry(flux, measure).unwrap()]
    };
    [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| element(row, column)))
}

fn flat() -> Surface {
    Surface::new(HeightField::new(vec![0.0; 64], [8, 8], [1.0, 1.0]).unwrap())
}

#[test]
fn a_flat_surface_has_the_matrices_of_its_facet() {
    let surface = flat();
    let glass = Material::dielectric(1.5).unwrap();
    let dense = Material::dielectric(1.0 / 1.5).unwrap();
    let gold = Material::conductor(0.43, 2.455).unwrap();
    for material in [glass, dense, gold, Material::Mirror] {
        for incident in [HalfSpace::Above, HalfSpace::Below] {
            for theta in [0.0_f64, 20.0, 50.0, 56.309_932_474_020_21, 80.0] {
                // The axes of a vertical ray are those of one that travels towards +x.
                let scene = Scene {
                    incident,
                    settings: mueller(),
                    ..Scene::new(
                        &surface,
                        material,
                        theta,
                        if theta == 0.0 { 180.0 } else { 25.0 },
                    )
                };
                let found = scene.batch(2, 0);
                let PolarisedFresnel {
                    reflected,
                    transmitted,
                    ..
                } = material.polarised_fresnel(theta.to_radians().cos());
                for (side, facet) in Side::BOTH.into_iter().zip([reflected, transmitted]) {
                    let found = matrix(&found, found.spec().flux_entry(side, Component::All));
                    let expected = [
                        [facet.m00, facet.m01, 0.0, 0.0],
                        [facet.m01, facet.m00, 0.0, 0.0],
                        [0.0, 0.0, facet.m22, facet.m23],
                        [0.0, 0.0, -facet.m23, facet.m22],
                    ];
                    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                        assert!(
                            (found - expected).abs() < 1e-14,
                            "{material:?} {incident:?} {theta} {side}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_kept_changes_no_flux() {
    let surface = Surface::new(waves(32, 1.5, 4));
    let glass = Material::dielectric(1.5).unwrap();
    for branching in [Branching::Split, Branching::Pick] {
        let fluxes = |polarisation| {
            let settings = PathSettings::new(branching, 0.05, 30).unwrap();
            let scene = Scene {
                settings: settings.with_polarisation(polarisation),
                ..Scene::new(&surface, glass, 40.0, 25.0)
            };
            let values = scene.batch(30, 0);
            let kept = TallySpec::default().len();
            values.iter().take(kept).copied().collect::<Vec<f64>>()
        };
        let tracked = fluxes(Polarisation::Tracked);
        assert_eq!(tracked, fluxes(Polarisation::Both));
        assert_eq!(tracked, fluxes(Polarisation::Mueller));
        assert_ne!(tracked, fluxes(Polarisation::Averaged));
    }
}

/// Returns `true` if a matrix takes every physical Stokes vector to one, and is a sum of paths: the coherency matrix is
/// positive semidefinite, by its Cholesky decomposition (Cloude 1989).
fn is_physical(m: [[f64; 4]; 4]) -> bool {
    let (o, l, i) = (Complex64::ZERO, Complex64::ONE, Complex64::I);
    let pauli = [
        [[l, o], [o, l]],
        [[l, o], [o, -l]],
        [[o, l], [l, o]],
        [[o, -i], [i, o]],
    ];
    // Sum of m_rc pauli_r x pauli_c*, which is 2 vec(J) vec(J)* for one path of Jones matrix J.
    let coherency = |row: usize, column: usize| -> Complex64 {
        let [a, b, c, d] = [row / 2, row % 2, column / 2, column % 2];
        let terms =
            (0..16).map(|n| m[n / 4][n % 4] * pauli[n / 4][a][c] * pauli[n % 4][b][d].conj());
        terms.sum()
    };
    let floor = 1e-9 * m[0][0];
    let mut factor = [[Complex64::ZERO; 4]; 4];
    for i in 0..4 {
        for j in 0..=i {
            let known: Complex64 = (0..j).map(|k| factor[i][k] * factor[j][k].conj()).sum();
            let entry = coherency(i, j) + if i == j { floor } else { 0.0 };
            let rest = entry - known;
            factor[i][j] = if i == j {
                if rest.re <= 0.0 {
                    return false;
                }
                rest.re.sqrt().into()
            } else {
                rest / factor[j][j]
            };
        }
    }
    true
}

#[test]
fn matrices_of_all_bins_are_physical() {
    let flip = |m: [[f64; 4]; 4]| {
        let signs = [1.0, 1.0, 1.0, -1.0];
        [0, 1, 2, 3].map(|i: usize| [0, 1, 2, 3].map(|j: usize| m[i][j] * signs[j]))
    };
    let mut flipped = 0;
    for (border, material) in [
        (Border::Periodic, Material::dielectric(1.5).unwrap()),
        (Border::Mirrored, Material::dielectric(1.0 / 1.5).unwrap()),
        (Border::Open, Material::conductor(0.43, 2.455).unwrap()),
    ] {
        let surface = rugged(12, 12, 1.0, 5, border);
        let scene = Scene {
            settings: mueller(),
            ..Scene::new(&surface, material, 50.0, 25.0)
        };
        let found = scene.batch(60, 0);
        for side in Side::BOTH {
            for flux in found.spec().bin_entries(side, Component::All).iter() {
                let m = matrix(&found, flux);
                if m[0][0] > 0.0 {
                    assert!(is_physical(m), "{border} {side} {m:?}");
                    // With the wrong sign of V of the incident light alone, no optical element has such a matrix.
                    flipped += usize::from(!is_physical(flip(m)));
                }
            }
        }
    }
    assert!(flipped > 100, "{flipped}");
}

#[test]
fn the_paired_difference_is_that_of_two_runs() {
    let surface = Surface::new(waves(48, 2.5, 4));
    let glass = Material::dielectric(1.5).unwrap();
    let run = |polarisation| {
        let scene = Scene {
            settings: PathSettings::default().with_polarisation(polarisation),
            ..Scene::new(&surface, glass, 30.0, 25.0)
        };
        scene.batches(60, 40)
    };
    let [both, averaged] = [Polarisation::Both, Polarisation::Averaged].map(run);
    let spec = *both.spec();
    for order in Component::ORDERS.into_iter().chain([Component::All]) {
        let flux = spec.flux_entry(Side::Reflected, order);
        let paired = both.at(spec.measure_entry(flux, Measure::Averaging).unwrap());
        let [a, b] = [both.at(flux), averaged.at(flux)];
        let se = a.se.unwrap().hypot(b.se.unwrap());
        let z = (paired.mean - (a.mean - b.mean)) / se;
        if order == Component::Order(1) {
            // The first facet divides unpolarised light, to rounding.
            assert_eq!(paired.mean, 0.0);
            continue;
        }
        println!("{order}: {paired:?}, z {z:.2}");
        assert!(z.abs() < 4.0, "{order}");
        assert!(
            paired.mean > 20.0 * paired.se.unwrap(),
            "{order}: {paired:?}"
        );
        if order == Component::All {
            assert!(paired.se.unwrap() < 0.3 * se, "the difference is paired");
        }
    }
}

/// z of all elements of two matrices with enough light, for all light and each order.
fn assert_alike(a: &TallyStatistics, b: &TallyStatistics) {
    let spec = *a.spec();
    let mut squares = 0.0;
    let mut count = 0.0;
    for side in Side::BOTH {
        let rings = spec.ring_entries(side, Component::All).iter();
        let orders = Component::ORDERS.map(|order| spec.flux_entry(side, order));
        let in_plane = spec.in_plane_entries(side, Component::All).iter();
        for flux in rings.chain(orders).chain(in_plane) {
            if a.at(flux).mean < 1e-3 {
                continue;
            }
            for row in 0..4 {
                for column in 0..4 {
                    let measure = Measure::Element { row, column };
                    let entry = spec.measure_entry(flux, measure).unwrap();
                    let (a, b) = (a.at(entry), b.at(entry));
                    if a.se == Some(0.0) && b.se == Some(0.0) {
                        continue;
                    }
                    let z = (a.mean - b.mean) / a.se.unwrap().hypot(b.se.unwrap());
                    assert!(z.abs() < 5.2, "{side} {row}{column} {a:?} {b:?}: {z}");
                    squares += z * z;
                    count += 1.0;
                }
            }
        }
    }
    println!("chi-squared over {count}: {:.3}", squares / count);
    // Both start in the same places, so that they have some noise in common.
    assert!(count > 300.0 && squares / count < 1.3);
}

#[test]
fn a_mirrored_tile_and_its_images_written_out_give_the_same_matrices() {
    // Sums of a row and of a column, so that cells are plane and it does not matter which diagonal divides them.
    let rough = rugged(9, 8, 1.0, 5, Border::Periodic).into_field();
    let [ny, nx] = rough.shape();
    let sum = |i: usize| 1.2 * (rough.heights()[i % nx] + rough.heights()[i / nx * nx]);
    let field = HeightField::new((0..ny * nx).map(sum).collect(), [ny, nx], [1.0, 1.0]).unwrap();
    let tile = Surface::new(field.clone().with_border(Border::Mirrored));
    // Samples lie on the border of a mirrored tile, so that images share them.
    let mirror = |i: usize, n: usize| {
        let period = 2 * (n - 1);
        let i = i % period;
        i.min(period - i)
    };
    let (wide, high) = (2 * (nx - 1), 2 * (ny - 1));
    let heights = (0..high * wide)
        .map(|i| field.heights()[mirror(i / wide, ny) * nx + mirror(i % wide, nx)])
        .collect();
    let written = HeightField::new(heights, [high, wide], field.spacing()).unwrap();
    let written = Surface::new(written);
    let dense = Material::dielectric(1.0 / 1.5).unwrap();
    let run = |surface| {
        let scene = Scene {
            settings: mueller(),
            ..Scene::new(surface, dense, 40.0, 25.0)
        };
        scene.batches(60, 40)
    };
    assert_alike(&run(&tile), &run(&written));
}

#[test]
fn light_from_below_is_light_from_above_on_the_surface_turned_over() {
    let field = rugged(12, 12, 1.2, 5, Border::Periodic).into_field();
    let surface = Surface::new(field.clone());
    let turned = field.heights().iter().map(|h| -h).collect();
    let turned = Surface::new(HeightField::new(turned, field.shape(), field.spacing()).unwrap());
    for material in [
        Material::dielectric(1.5).unwrap(),
        Material::dielectric(1.0 / 1.5).unwrap(),
        Material::conductor(0.43, 2.455).unwrap(),
    ] {
        let run = |surface, incident| {
            let scene = Scene {
                incident,
                settings: mueller(),
                ..Scene::new(surface, material, 40.0, 25.0)
            };
            scene.batch(40, 0)
        };
        let below = run(&surface, HalfSpace::Below);
        let above = run(&turned, HalfSpace::Above);
        for (a, b) in below.iter().zip(&above) {
            assert!((a - b).abs() < 1e-12, "{material:?} {a} {b}");
        }
    }
}

#[test]
fn vertical_light_of_any_azimuth_turns_the_axes_with_the_exit() {
    let surface = rugged(12, 12, 1.2, 5, Border::Periodic);
    let glass = Material::dielectric(1.5).unwrap();
    let incidence = Incidence::from_degrees(0.0, 180.0).unwrap();
    let scene = Scene {
        light: Illumination::new(incidence, true),
        settings: mueller(),
        ..Scene::new(&surface, glass, 0.0, 180.0)
    };
    let found = scene.batches(60, 40);
    let spec = *found.spec();
    let n_phi = spec.grid().n_phi();
    let mut squares = 0.0;
    let mut count = 0.0;
    for side in Side::BOTH {
        let bins = spec.bin_entries(side, Component::All);
        for i in 0..bins.len() {
            // A quarter of a turn further on the axes of the incident light are turned: its Q and U have the other sign.
            let quarter = i - i % n_phi + (i + n_phi / 4) % n_phi;
            let entries = [i, quarter].map(|i| bins.get(i));
            let rays = entries.map(|entry| found.means()[entry] * 60.0 * 1600.0);
            if rays[0] < 200.0 || rays[1] < 200.0 {
                continue;
            }
            for (row, column, sign) in [
                (1, 0, 1.0),
                (0, 1, -1.0),
                (1, 1, -1.0),
                (2, 2, -1.0),
                (3, 3, 1.0),
            ] {
                let measure = Measure::Element { row, column };
                let [a, b] =
                    entries.map(|flux| found.at(spec.measure_entry(flux, measure).unwrap()));
                let z = (a.mean - sign * b.mean) / a.se.unwrap().hypot(b.se.unwrap());
                squares += z * z;
                count += 1.0;
                assert!(z.abs() < 5.2, "{side} {i} {row}{column} {a:?} {b:?}: {z}");
            }
        }
    }
    println!("chi-squared over {count}: {:.3}", squares / count);
    assert!(count > 300.0 && (squares / count - 1.0).abs() < 0.2);

    // Exits that are vertical have axes of their own, which do not turn with the azimuth.
    let flat = flat();
    let level = |any_azimuth| {
        let scene = Scene {
            light: Illumination::new(incidence, any_azimuth),
            settings: mueller(),
            ..Scene::new(&flat, glass, 0.0, 180.0)
        };
        let values = scene.batch(4, 0);
        matrix(
            &values,
            values.spec().flux_entry(Side::Reflected, Component::All),
        )
    };
    for (a, b) in level(true)
        .iter()
        .flatten()
        .zip(level(false).iter().flatten())
    {
        assert!((a - b).abs() < 1e-14, "{a} {b}");
    }
}
