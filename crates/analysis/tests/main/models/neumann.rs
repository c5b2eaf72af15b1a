//! Reflection under Neumann's denominator: what it is, and what it loses.

use std::f64::consts::PI;

use asperity_analysis::{BsdfModel, bin_fluxes, hemispherical_energy};
use asperity_optics::{Material, dielectric, from_spherical};
use asperity_tally::{HemisphereGrid, Sides};
use glam::DVec3;

use crate::common::{closed_form, correlated};

const NEUMANN: [&str; 2] = ["cook-torrance-neumann", "cook-torrance-neumann-smith"];
/// Models with both cosines in the denominator.
const BOTH_COSINES: [&str; 2] = ["v-cavity", "smith-separable"];

fn light(theta_deg: f64) -> DVec3 {
    from_spherical(theta_deg.to_radians(), PI)
}

fn reflected(model: &dyn BsdfModel, theta_deg: f64) -> f64 {
    hemispherical_energy(model, light(theta_deg)).reflected
}

#[test]
fn neumann_differs_by_the_smaller_cosine() {
    // f max(ci, co) = f' ci co: a few roundings.
    for material in [Material::Mirror, Material::dielectric(1.0 / 1.5).unwrap()] {
        for (name, other) in NEUMANN.into_iter().zip(BOTH_COSINES) {
            let (model, other) = (
                closed_form(name, 1.0, material),
                closed_form(other, 1.0, material),
            );
            for (a, b) in [
                ((0.2, 1.0), (1.4, 3.0)),
                ((1.5, 0.0), (0.9, 2.5)),
                ((0.6, 0.0), (0.6, 3.0)),
            ] {
                let (wi, wo) = (from_spherical(a.0, a.1), from_spherical(b.0, b.1));
                let (f, g) = (model.bsdf(wi, wo), other.bsdf(wi, wo));
                assert!(g > 0.0);
                assert!(
                    (f * wi.z.max(wo.z) / (g * wi.z * wo.z) - 1.0).abs() < 1e-14,
                    "{name}"
                );
            }
        }
    }
}

#[test]
fn neumann_describes_reflection_alone() {
    for name in NEUMANN {
        let model = closed_form(name, 1.0, Material::dielectric(1.5).unwrap());
        assert_eq!(model.sides(), Sides::Reflected);
        let wi = light(40.0);
        assert_eq!(model.bsdf(wi, from_spherical(2.8, 0.1)), 0.0);
        let energy = hemispherical_energy(model.as_ref(), wi);
        assert!(energy.transmitted == 0.0 && energy.reflected > 0.0);
        let grid = HemisphereGrid::default();
        let fluxes = bin_fluxes(model.as_ref(), wi, &grid);
        assert!(
            fluxes[grid.bins_per_side()..]
                .iter()
                .all(|&flux| flux == 0.0)
        );
    }
}

#[test]
fn neumann_is_reciprocal() {
    for name in NEUMANN {
        for material in [Material::Mirror, Material::conductor(0.21, 3.272).unwrap()] {
            let model = correlated(name, 0.3, material);
            for (a, b) in [
                ((0.3, 0.0), (1.0, 2.0)),
                ((1.2, 5.0), (0.1, 3.0)),
                ((1.5, 1.0), (1.45, 4.0)),
            ] {
                let (wi, wo) = (from_spherical(a.0, a.1), from_spherical(b.0, b.1));
                let (f, g) = (model.bsdf(wi, wo), model.bsdf(wo, wi));
                assert!(f > 0.0 && (f / g - 1.0).abs() < 1e-13, "{name} {f} {g}");
            }
        }
    }
}

#[test]
fn a_nearly_smooth_surface_reflects_too_little_by_the_cosine_of_incidence() {
    // A facet of slope p within the plane of incidence changes co by 2 p sin(theta): to first order
    // the mean of min(ci, co) is ci - E|p| sin(theta), E|p| = sqrt(2 / pi) sqrt(2) / s. The next order, of slope
    // variance 2 / s^2, has coefficients of some ten.
    for name in NEUMANN {
        for s in [500.0, 2000.0] {
            let model = closed_form(name, s, Material::dielectric(1.5).unwrap());
            for theta in [0.0, 30.0, 60.0] {
                let (sin, cos) = f64::to_radians(theta).sin_cos();
                let flat = dielectric(cos, 1.5).reflected;
                let found = reflected(model.as_ref(), theta) / flat;
                let expected = cos - 2.0 / PI.sqrt() / s * sin;
                assert!(
                    (found - expected).abs() < 20.0 / (s * s),
                    "{name} {s} {theta} {found} {expected}"
                );
            }
        }
    }
}

/// With grooves and with Smith's attenuation.
const MIRROR: [[f64; 5]; 2] = [
    [
        0.470_247_27,
        0.482_082_14,
        0.390_558_44,
        0.161_101_44,
        0.017_325_379,
    ],
    [
        0.481_709_12,
        0.490_534_49,
        0.386_360_35,
        0.157_590_86,
        0.016_572_266,
    ],
];

#[test]
fn a_mirror_loses_most_of_its_light_at_grazing() {
    // s = 3 at 0, 30, 60, 80 and 89 deg; what it should reflect at all orders is 1. From the density by
    // midpoints of 1500 x 750 cells over slopes, by another program: the edges cross cells, which
    // costs up to 6e-5 at grazing.
    for (name, expected) in NEUMANN.into_iter().zip(MIRROR) {
        let model = closed_form(name, 3.0, Material::Mirror);
        for (theta, expected) in [0.0, 30.0, 60.0, 80.0, 89.0].into_iter().zip(expected) {
            let found = reflected(model.as_ref(), theta);
            assert!(
                (found / expected - 1.0).abs() < 1e-4,
                "{name} {theta} {found}"
            );
        }
    }
}
