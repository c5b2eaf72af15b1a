//! Known paths: flat surfaces, and media without contrast, on which the path of every ray is known.

use asperity_optics::{Incidence, Material, dielectric};
use asperity_surface::{Border, HeightField};
use asperity_tally::{Component, HemisphereGrid, Side, TallyResult, TallySpec};
use asperity_tracer::{
    BruteForce, HalfSpace, Illumination, MeshBvh, PathSettings, PathStream, Surface, Tracer,
};
use glam::DVec3;

use super::{GLASS, glass};
use crate::common::{Run, rugged};

#[test]
fn flat_surface_gives_exact_fresnel_and_snell() {
    let spec = TallySpec::new(HemisphereGrid::new(90, 360).unwrap(), 0.1).unwrap();
    for border in [Border::Periodic, Border::Mirrored] {
        let surface = flat(border);
        let bvh = MeshBvh::build(&surface).unwrap();
        for (eta, theta_deg, phi_deg) in [
            (1.5, 0.0, 0.0),
            (1.5, 30.5, 70.5),
            (1.5, 89.9, 180.5),
            (1.0 / 1.5, 40.5, 10.5),
            (1.0 / 1.5, 60.5, 200.5),
            (1.0, 45.5, 300.5),
        ] {
            let material = Material::dielectric(eta).unwrap();
            let run = Run {
                theta_deg,
                phi_deg,
                spec,
                ..Run::new(&surface, &bvh, material)
            };
            let (statistics, _) = run.go(2, 4);
            let fresnel = dielectric(f64::to_radians(theta_deg).cos(), eta);
            let values = statistics.means();
            // The normal is exact, so only the cosine is rounded; grazing magnifies it by 1/cos.
            let tolerance = 1e-12;
            assert!((values.budget().reflected - fresnel.reflected).abs() < tolerance);
            assert!((values.budget().transmitted - fresnel.transmitted).abs() < tolerance);
            assert_eq!(values.budget().lost, 0.0);
            // All light of a side lies in the one bin that Snell's law names.
            let (sin_phi, cos_phi) = (phi_deg + 180.0).to_radians().sin_cos();
            let bin_of = |side, sin: f64, z: f64| {
                let wo = DVec3::new(sin * cos_phi, sin * sin_phi, z);
                spec.grid_entries(Component::Single)
                    .get(spec.grid().index_of(side, wo))
            };
            let (sin_theta_i, cos_theta_i) = f64::to_radians(theta_deg).sin_cos();
            let mirrored = bin_of(Side::Reflected, sin_theta_i, cos_theta_i);
            assert!((values[mirrored] - fresnel.reflected).abs() < tolerance);
            if fresnel.transmitted > 0.0 {
                let sin_theta_t = sin_theta_i / eta;
                let z = -(1.0 - sin_theta_t * sin_theta_t).sqrt();
                let refracted = bin_of(Side::Transmitted, sin_theta_t, z);
                assert!((values[refracted] - fresnel.transmitted).abs() < tolerance);
            }
        }
    }
}

#[test]
fn light_of_any_azimuth_is_turned_back_to_the_plane_of_incidence() {
    // On a flat surface every ray leaves in its own plane of incidence: turned back, all leave in one
    // bin, and in the forward half of the in-plane profile.
    let surface = flat(Border::Periodic);
    let spec = TallySpec::default();
    let tracer = Tracer::new(
        &surface,
        &BruteForce,
        glass(),
        HalfSpace::Above,
        PathSettings::default(),
    );
    for (theta_deg, phi_deg) in [(32.0, 3.0), (47.0, 101.0), (62.0, 305.0)] {
        let incidence = Incidence::from_degrees(theta_deg, phi_deg).unwrap();
        let expected = dielectric(incidence.theta().cos(), GLASS).reflected;
        for any_azimuth in [false, true] {
            let (values, _) = tracer.batch(
                &Illumination::new(incidence, any_azimuth),
                6,
                spec,
                None,
                PathStream::new(5, 0),
            );
            let (sin_phi, cos_phi) = (incidence.phi() + std::f64::consts::PI).sin_cos();
            let (sin, cos) = incidence.theta().sin_cos();
            let wo = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
            let bin = spec
                .grid_entries(Component::All)
                .get(spec.grid().index_of(Side::Reflected, wo));
            assert!(
                (values[bin] - expected).abs() < 1e-12,
                "{theta_deg} {phi_deg} {any_azimuth}"
            );
            let profile = spec.in_plane_entries(Side::Reflected, Component::All);
            let forward_bin = profile.get(18 + (theta_deg / 5.0) as usize);
            assert!((values[forward_bin] - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn matched_indices_let_light_go_straight_through_any_surface() {
    let surface = rugged(12, 10, 2.0, 3, Border::Periodic);
    let bvh = MeshBvh::build(&surface).unwrap();
    let material = Material::dielectric(1.0).unwrap();
    let run = Run {
        theta_deg: 52.0,
        phi_deg: 15.0,
        ..Run::new(&surface, &bvh, material)
    };
    let (statistics, _) = run.go(4, 8);
    let spec = run.spec;
    let wo = -Incidence::from_degrees(52.0, 15.0).unwrap().wi();
    let bin = spec
        .grid_entries(Component::All)
        .get(spec.grid().index_of(Side::Transmitted, wo));
    assert!((statistics.means()[bin] - 1.0).abs() < 1e-12);
}

fn flat(border: Border) -> Surface {
    let field = HeightField::new(vec![3.0; 12], [3, 4], [0.5, 2.0]).unwrap();
    Surface::new(field.with_border(border))
}
