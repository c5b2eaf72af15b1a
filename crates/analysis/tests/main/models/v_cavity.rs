//! V-shaped grooves followed ray by ray: points, lines of sight and Fresnel terms, and nothing of the
//! model's attenuation.

use std::f64::consts::TAU;

use asperity_analysis::{
    SlopeCovariance, VCavity, bin_fluxes, chi_squared_survival, hemispherical_energy,
};
use asperity_optics::{Material, from_spherical, reflect, refract};
use asperity_tally::{HemisphereGrid, Side};
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::closed_form;

/// Returns `true` if the line from the side `m` of a groove along `w` leaves the groove. It begins at depth `d` below
/// the opening on the side of `w` (0 at the rim, 1 at the bottom).
///
/// In a plane across the groove its sides meet at the bottom, and the rims are at the same height: the
/// line has to reach the height of the opening before it has crossed to the other rim.
fn leaves(w: DVec3, m: DVec3, d: f64) -> bool {
    let across = m.truncate().normalize();
    let (width, depth) = (m.z, (1.0 - m.z * m.z).sqrt());
    let (rate, climb) = (w.truncate().dot(across), w.z.abs());
    // From x = -(1 - d) width to the rim at +width, from d depth below the opening up to it.
    rate <= 0.0 || (2.0 - d) * width * climb >= rate * d * depth
}

/// Fluxes into bins by points in grooves: their means and the squares of their errors.
fn traced(
    slopes: &SlopeCovariance,
    eta: f64,
    wi: DVec3,
    grid: &HemisphereGrid,
    rays: u32,
) -> [Vec<f64>; 2] {
    let material = Material::dielectric(eta).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    let (mut sums, mut squares) = (vec![0.0; grid.len()], vec![0.0; grid.len()]);
    let long = slopes.xx().sqrt();
    let incline = slopes.xy() / slopes.xx();
    let rest = (slopes.yy() - incline * slopes.xy()).sqrt();
    for _ in 0..rays {
        let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
        let z = radius * DVec2::from_angle(TAU * rng.random::<f64>());
        let slope = DVec2::new(long * z.x, incline * long * z.x + rest * z.y);
        let m = (-slope).extend(1.0).normalize();
        // A point of the side evenly over its length: depth below the rims above.
        let d = rng.random::<f64>();
        let cos_theta_i = wi.dot(m);
        if cos_theta_i <= 0.0 || !leaves(wi, m, d) {
            continue;
        }
        let weight = cos_theta_i / (m.z * wi.z);
        let fresnel = material.fresnel(cos_theta_i.min(1.0));
        let up = reflect(wi, m);
        let mut add = |side: Side, wo: DVec3, flux: f64| {
            let bin = grid.index_of(side, wo);
            sums[bin] += flux;
            squares[bin] += flux * flux;
        };
        if up.z > 0.0 && leaves(up, m, d) {
            add(Side::Reflected, up, weight * fresnel.reflected);
        }
        if fresnel.transmitted > 0.0 {
            let down = refract(wi, m, eta, fresnel.cos_theta_t);
            // From below the rims are the bottoms, and the side faces the other way.
            if down.z < 0.0 && leaves(down, DVec3::new(-m.x, -m.y, m.z), 1.0 - d) {
                add(Side::Transmitted, down, weight * fresnel.transmitted);
            }
        }
    }
    let n = f64::from(rays);
    let means: Vec<f64> = sums.iter().map(|sum| sum / n).collect();
    let errors = squares
        .iter()
        .zip(&means)
        .map(|(sq, mean)| (sq / n - mean * mean) / n)
        .collect();
    [means, errors]
}

#[test]
fn rays_traced_through_grooves_agree_with_the_bsdf() {
    let grid = HemisphereGrid::new(6, 8).unwrap();
    let rays = 150_000;
    let turned = SlopeCovariance::new(0.8, 0.3, 0.3).unwrap();
    // Three tests: Sidak's level for 1e-3 together.
    for (slopes, eta, theta) in [
        (SlopeCovariance::isotropic(1.0).unwrap(), 1.4, 60.0),
        (turned, 1.4, 40.0),
        (turned, 1.0 / 1.4, 65.0),
    ] {
        let wi = from_spherical(f64::to_radians(theta), 0.4);
        let model = VCavity::new(slopes, Material::dielectric(eta).unwrap()).unwrap();
        let exact = bin_fluxes(&model, wi, &grid);
        let [means, errors] = traced(&slopes, eta, wi, &grid, rays);
        let (mut chi_squared, mut bins) = (0.0, 0);
        for ((mean, error), exact) in means.iter().zip(&errors).zip(&exact) {
            // The square of the mean of a bin is that of its error times the number of its rays, or less.
            if *mean > 0.0 && mean * mean > 300.0 * error {
                chi_squared += (mean - exact) * (mean - exact) / error;
                bins += 1;
            }
        }
        let p = chi_squared_survival(chi_squared, bins);
        println!("theta {theta} eta {eta:.3}: chi^2 {chi_squared:.1} in {bins} bins, p {p:.4}");
        assert!(bins > 30 && p > 3.3e-4, "p {p} in {bins}");
    }
}

#[test]
fn mirror_energy_is_the_light_that_misses_the_other_side() {
    // One less what is lost, by midpoints over 600 x 600 slopes and closed thresholds: the fraction of a side that is
    // lit, less the part of it from which light goes down or meets the other side. Edges cross cells: 1e-4.
    for s in [0.7, 2.0] {
        for theta in [0.0, 40.0, 75.0] {
            let wi = from_spherical(f64::to_radians(theta), 0.0);
            let (n, reach) = (600, 6.0);
            let (mut lit, mut lost) = (0.0, 0.0);
            for i in 0..n {
                for j in 0..n {
                    let at = |k: i32| (2.0 * (f64::from(k) + 0.5) / f64::from(n) - 1.0) * reach;
                    let (a, b) = (at(i), at(j));
                    let m = DVec3::new(2.0 * a / s, 2.0 * b / s, 1.0).normalize();
                    let area = 4.0 * reach * reach / f64::from(n * n) / std::f64::consts::PI
                        * (-a * a - b * b).exp();
                    let facing = wi.dot(m) / (m.z * wi.z);
                    if facing <= 0.0 {
                        continue;
                    }
                    let fraction = deepest(wi, m);
                    let up = reflect(wi, m);
                    let kept = if up.z > 0.0 { deepest(up, m) } else { 0.0 };
                    lit += area * facing * fraction;
                    lost += area * facing * (fraction - kept).max(0.0);
                }
            }
            let model = closed_form("v-cavity", s, Material::Mirror);
            let found = hemispherical_energy(model.as_ref(), wi).reflected;
            println!("s {s} theta {theta}: lit {lit:.5}, kept {found:.5}");
            assert!((lit - 1.0).abs() < 3e-4, "{lit}");
            assert!(
                (found - (1.0 - lost)).abs() < 5e-4,
                "{found} {}",
                1.0 - lost
            );
        }
    }
}

/// The depth down to which lines along `w` leave, by halving.
fn deepest(w: DVec3, m: DVec3) -> f64 {
    if leaves(w, m, 1.0) {
        return 1.0;
    }
    let (mut free, mut blocked) = (0.0, 1.0);
    for _ in 0..30 {
        let d = 0.5 * (free + blocked);
        if leaves(w, m, d) {
            free = d
        } else {
            blocked = d
        }
    }
    free
}
