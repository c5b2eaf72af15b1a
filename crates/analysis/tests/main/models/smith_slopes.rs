//! Smith's model of a slope table, against that of Gaussian slopes, sums over facets, and energy.

use std::sync::Arc;
use std::time::Instant;

use asperity_analysis::{
    Beckmann, BsdfModel, Masking, SamplingEffort, ScatteringModel, SlopeCovariance,
    SlopeDistribution, SlopeGrid, SlopeMixture, SlopeTable, Smith, SmithSlopes, bin_fluxes, expect,
    flux_into, hemispherical_energy, in_plane_flux, region_influence,
};
use asperity_optics::{Incidence, Material, from_spherical, reflect};
use asperity_tally::{
    Azimuth, Component, HemisphereGrid, Side, TallyResult, TallySpec, TallyValues,
};
use glam::DVec3;

const DEVIATION: f64 = 0.3;

/// Gaussian slopes in even cells, `per` per deviation; the masses are exact.
fn gaussian(per: usize) -> SlopeTable {
    let reach = 6 * per as i32;
    let edges: Vec<f64> = (-reach..=reach)
        .map(|i| DEVIATION * f64::from(i) / per as f64)
        .collect();
    let below =
        |s: f64| 0.5 * asperity_numerics::elementary::erfc(-s / (DEVIATION * 2.0_f64.sqrt()));
    let masses: Vec<f64> = edges
        .windows(2)
        .map(|pair| below(pair[1]) - below(pair[0]))
        .collect();
    let weights: Vec<f64> = masses
        .iter()
        .flat_map(|y| masses.iter().map(move |x| x * y))
        .collect();
    SlopeTable::new(SlopeGrid::new([edges.clone(), edges]).unwrap(), &weights).unwrap()
}

fn covariance() -> SlopeCovariance {
    SlopeCovariance::new(DEVIATION * DEVIATION, DEVIATION * DEVIATION, 0.0).unwrap()
}

fn model_of(table: SlopeTable, material: Material) -> SmithSlopes {
    let [xx, xy, yy] = table.second_moments();
    let slopes = SlopeDistribution::Table {
        table: Arc::new(table),
        covariance: SlopeCovariance::new(xx, yy, xy).unwrap(),
    };
    SmithSlopes::new(slopes, material).unwrap()
}

fn expected(model: &dyn ScatteringModel, light: Incidence, spec: &TallySpec) -> TallyValues {
    let effort = SamplingEffort {
        rays: 0,
        batches: 1,
        seed: 0,
    };
    let found = expect(model, light, spec, Azimuth::From(0.0), effort);
    assert!(found.is_exact());
    found.tallies()[0].clone()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    0.5 * a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>()
}

/// A table widens the variance by `h^2 / 6`, `1 / (6 n^2)` of it for `n` cells per deviation. The total variation between Gaussian
/// densities whose variances differ by the small part `e` along both axes is `e / 2.72`, half the mean of `|1 - r^2 / 2|` times `e`; within a
/// cell the density differs by up to `h p' / 2`, which bins of many cells average.
#[test]
fn a_table_of_gaussian_slopes_scatters_as_smith_does() {
    let glass = Material::dielectric(1.5).unwrap();
    let spec = TallySpec::new(HemisphereGrid::new(9, 12).unwrap(), 0.2).unwrap();
    for theta in [0.0, 35.0, 70.0] {
        let light = Incidence::from_degrees(theta, 20.0).unwrap();
        let smith = Smith::new(covariance(), glass, Masking::HeightCorrelated).unwrap();
        let exact = expected(&smith, light, &spec);
        let mut found = Vec::new();
        for per in [8, 16] {
            let begin = Instant::now();
            let tally = expected(&model_of(gaussian(per), glass), light, &spec);
            let all = spec.grid_entries(Component::Single);
            let off = distance(&tally[all], &exact[all]);
            let sides = [Side::Reflected, Side::Transmitted];
            let flux = sides.map(|side| {
                let [a, b] = [&tally, &exact].map(|t| t.flux(side, Component::Single));
                (a - b).abs()
            });
            let in_plane = sides
                .map(|side| {
                    let entries = spec.in_plane_entries(side, Component::Single);
                    distance(&tally[entries], &exact[entries])
                })
                .iter()
                .sum::<f64>();
            println!(
                "theta {theta}, {per} per deviation: bins {off:.1e}, fluxes {flux:?}, in plane {in_plane:.1e}, {:.2} s",
                begin.elapsed().as_secs_f64()
            );
            let widened = 1.0 / (6.0 * (per * per) as f64);
            assert!(off < 3.0 * widened / 2.72, "{theta} {per}: {off}");
            assert!(flux.iter().all(|off| *off < widened), "{flux:?}");
            assert!(in_plane < widened, "{in_plane}");
            found.push(off);
        }
        // The error falls with the square of the cells.
        assert!(found[1] < found[0] / 2.5, "{found:?}");
    }
}

/// All functions that integrate a model do so for tables, with the same result.
#[test]
fn bins_ranges_and_energies_agree() {
    let glass = Material::dielectric(1.0 / 1.5).unwrap();
    let model = model_of(gaussian(4), glass);
    let light = Incidence::from_degrees(40.0, 10.0).unwrap();
    let (grid, half_width) = (HemisphereGrid::new(6, 8).unwrap(), 0.15);
    let spec = TallySpec::new(grid, half_width).unwrap();
    let tally = expected(&model, light, &spec);
    let bins = bin_fluxes(&model, light.wi(), &grid);
    let of_tally = &tally[spec.grid_entries(Component::Single)];
    // Cells of a quarter of the deviation are divided at other edges for each: the reflectance and the masking of the middle of a cell, or of
    // its parts, differ by a 24th of the square of a quarter, times second derivatives.
    let same = |a: f64, b: f64| (a - b).abs() < 0.5 / (24.0 * 16.0) * b + 2e-6;
    for (a, b) in bins.iter().zip(of_tally) {
        assert!(same(*a, *b), "{a} {b}");
    }
    let bin = grid.bin(8);
    let alone = flux_into(&model, light.wi(), bin.side, bin.theta, bin.phi);
    assert!(same(alone, bins[8]) && alone > 1e-4, "{alone}");
    let energy = hemispherical_energy(&model, light.wi());
    let sum: f64 = bins[..grid.bins_per_side()].iter().sum();
    assert!(same(energy.reflected, sum));
    let filter = spec.in_plane_filter(Side::Reflected);
    let entries = spec.in_plane_entries(Side::Reflected, Component::Single);
    for i in 4..filter.len() - 1 {
        let angles = filter.theta_deg(i).map(f64::to_radians);
        let flux = in_plane_flux(&model, light, half_width, Side::Reflected, angles);
        assert!(same(flux, tally[entries.get(i)]));
    }
}

/// Slopes of a mirror: 60 facets, sorted into bins one by one. Cells of a sixteenth of the spread, or 2 degrees of light, stay within
/// one bin for most facets.
#[test]
fn a_table_of_facets_mirrors_as_its_facets_do() {
    let slopes: Vec<[f64; 2]> = (0..600)
        .map(|i| {
            let u = f64::from(i) / 600.0;
            [
                0.6 * (u - 0.5) + 0.1 * (40.0 * u).sin(),
                0.2 * (90.0 * u).cos(),
            ]
        })
        .collect();
    let mean = [0, 1].map(|k| slopes.iter().map(|s| s[k]).sum::<f64>() / 600.0);
    let model = model_of(SlopeTable::of_slopes(&slopes).unwrap(), Material::Mirror);
    let light = Incidence::from_degrees(30.0, 0.0).unwrap();
    let wi = light.wi();
    let spec = TallySpec::new(HemisphereGrid::new(6, 6).unwrap(), 0.2).unwrap();
    let tally = expected(&model, light, &spec);
    let mut expected = vec![0.0; spec.grid().len()];
    let lambda = |w: DVec3| model.slopes().lambda(w);
    for s in &slopes {
        let m = DVec3::new(mean[0] - s[0], mean[1] - s[1], 1.0).normalize();
        let wo = reflect(wi, m);
        let weight = wi.dot(m) / (m.z * wi.z) / 600.0;
        if weight > 0.0 && wo.z > 0.0 {
            expected[spec.grid().index_of(Side::Reflected, wo)] +=
                weight / (1.0 + lambda(wi) + lambda(wo));
        }
    }
    let off = distance(&tally[spec.grid_entries(Component::Single)], &expected);
    let sum: f64 = expected.iter().sum();
    let flux = tally.flux(Side::Reflected, Component::Single);
    println!("total variation {off}, {flux} of {sum}");
    assert!((flux - sum).abs() < 1e-3 && off < 0.02);
}

/// Grooves send vertical light along the edges between bins, at azimuths of 90 and 270 degrees: all of it counts on the side where rays in that
/// direction are counted.
#[test]
fn light_on_the_edge_of_bins_is_in_the_bin_of_its_rays() {
    let slopes = [[0.0, 0.25], [0.0, -0.25]];
    let grooves = SlopeTable::of_slopes(&slopes).unwrap();
    let model = model_of(grooves, Material::Mirror);
    let grid = HemisphereGrid::new(9, 36).unwrap();
    let bins = bin_fluxes(&model, DVec3::Z, &grid);
    let of_sector = |sector: usize| (0..9).map(|ring| bins[36 * ring + sector]).sum::<f64>();
    for [sx, sy] in slopes {
        let wo = reflect(DVec3::Z, DVec3::new(-sx, -sy, 1.0).normalize());
        let sector = grid.index_of(Side::Reflected, wo) % 36;
        let edge = if sy < 0.0 { 9 } else { 27 };
        assert!([edge - 1, edge].contains(&sector));
        let [before, after] = [of_sector(edge - 1), of_sector(edge)];
        println!("{before} {after}");
        let [there, beside] = if sector == edge {
            [after, before]
        } else {
            [before, after]
        };
        assert!(there > 0.4 && beside == 0.0);
    }
}

/// Reciprocity of the density, also of skewed slopes: `f(wi, wo) = f(wo, wi)` for reflection.
#[test]
fn skewed_tables_are_reciprocal() {
    let slopes: Vec<[f64; 2]> = (0..10_000)
        .map(|i| {
            let [u, v] = [i % 100, i / 100].map(|k| f64::from(k) / 100.0);
            [0.9 * u * u - 0.3, 0.6 * (v - 0.4) * (1.5 - u)]
        })
        .collect();
    let model = model_of(SlopeTable::of_slopes(&slopes).unwrap(), Material::Mirror);
    for theta in [0.2, 0.9, 1.1] {
        for s in [[0.1, 0.1], [-0.2, 0.15], [0.2, -0.1]] {
            let m = DVec3::new(-s[0], -s[1], 1.0).normalize();
            let wi = from_spherical(theta, 0.3);
            let wo = reflect(wi, m);
            let (f, g) = (model.bsdf(wi, wo), model.bsdf(wo, wi));
            assert!(f > 0.0 && (f - g).abs() <= 1e-12 * f, "{f} {g}");
        }
    }
}

/// Gaussian slopes need no table.
#[test]
fn gaussian_slopes_are_those_of_smith() {
    let glass = Material::dielectric(1.5).unwrap();
    let slopes = SlopeCovariance::new(0.2, 0.05, 0.03).unwrap();
    let wi = from_spherical(0.6, 0.1);
    let [a, b]: [Box<dyn BsdfModel>; 2] = [
        Box::new(SmithSlopes::new(slopes.into(), glass).unwrap()),
        Box::new(Smith::new(slopes, glass, Masking::HeightCorrelated).unwrap()),
    ];
    for wo in [from_spherical(0.5, 3.0), from_spherical(2.8, 2.0)] {
        assert_eq!(a.bsdf(wi, wo), b.bsdf(wi, wo));
    }
    assert_eq!(
        Beckmann::new(slopes).lambda(DVec3::Y),
        a.slopes().lambda(DVec3::Y)
    );
}

/// Regions of two kinds of slopes: what each explains is the difference of the tallies that the model has of it and of the whole, to first order
/// in the difference of the regions; and sums up to zero.
/// The parts of a mixture add to the model in every direction, and its bins to its energy by integrals over slopes; against a table of the same
/// slopes in narrow cells.
#[test]
fn the_model_of_a_mixture_is_the_sum_of_its_parts() {
    let base = SlopeCovariance::new(0.02, 0.03, 0.01).unwrap();
    let mixture = SlopeMixture::scaled(&base, &[[1.0, 0.6], [4.0, 0.3], [12.0, 0.1]]).unwrap();
    let distribution = SlopeDistribution::Mixture {
        covariance: mixture.covariance().unwrap(),
        mixture: Arc::new(mixture.clone()),
    };
    let glass = Material::dielectric(1.5).unwrap();
    let model = SmithSlopes::new(distribution, glass).unwrap();
    let wi = from_spherical(0.9, 0.3);
    for wo in [(0.4, 2.8), (1.2, 3.4), (2.7, 3.0), (2.2, 3.9)] {
        let wo = from_spherical(wo.0, wo.1);
        let parts: f64 = model.parts().iter().map(|part| part.bsdf(wi, wo)).sum();
        assert!((parts / model.bsdf(wi, wo) - 1.0).abs() < 1e-12);
    }
    let grid = HemisphereGrid::new(6, 12).unwrap();
    let bins = bin_fluxes(&model, wi, &grid);
    let energy = hemispherical_energy(&model, wi);
    let sums = [&bins[..72], &bins[72..]].map(|side| side.iter().sum::<f64>());
    assert!((sums[0] / energy.reflected - 1.0).abs() < 1e-8);
    assert!((sums[1] / energy.transmitted - 1.0).abs() < 1e-8);
    let incidence = Incidence::from_degrees(0.9_f64.to_degrees(), 0.3_f64.to_degrees()).unwrap();
    let slice = [0.2, 0.7];
    let whole = in_plane_flux(&model, incidence, 0.1, Side::Reflected, slice);
    let of_part =
        |part: &&dyn BsdfModel| in_plane_flux(*part, incidence, 0.1, Side::Reflected, slice);
    let parts: f64 = model.parts().iter().map(of_part).sum();
    assert!(whole > 1e-4 && (parts / whole - 1.0).abs() < 1e-12);

    // Cells of 0.01: variances rise by a sixth of their square, 1e-3 of the smallest
    let edges: Vec<f64> = (-300..=300).map(|i| 0.01 * f64::from(i)).collect();
    let middle = |i: usize| 0.5 * (edges[i] + edges[i + 1]);
    let density = |x: f64, y: f64| {
        let m = DVec3::new(-x, -y, 1.0).normalize();
        mixture.d(m) * m.z.powi(4)
    };
    let rows = (0..600).flat_map(|iy| (0..600).map(move |ix| (ix, iy)));
    let weights: Vec<f64> = rows
        .map(|(ix, iy)| density(middle(ix), middle(iy)))
        .collect();
    let table = SlopeTable::new(SlopeGrid::new([edges.clone(), edges]).unwrap(), &weights).unwrap();
    let tabulated = bin_fluxes(&model_of(table, glass), wi, &grid);
    let off = distance(&bins, &tabulated);
    println!("{off:e}");
    assert!(off < 1e-4, "{off}");
}

#[test]
fn regions_explain_what_their_slopes_change() {
    let whole = gaussian(8);
    let grid = whole.grid();
    let tilt = |sign: f64| -> Vec<f64> {
        let middle = |cell: usize| {
            let [nx, _] = grid.size();
            let edges = &grid.edges()[0];
            let middle = |i: usize| 0.5 * (edges[i] + edges[i + 1]) / DEVIATION;
            [middle(cell % nx), middle(cell / nx)]
        };
        let weight = |(cell, mass): (usize, &f64)| {
            let [x, y] = middle(cell);
            // Steeper, or gentler
            mass * (1.0 + sign * 0.02 * (x * x + y * y - 2.0))
        };
        whole
            .masses()
            .iter()
            .enumerate()
            .map(|pair| weight(pair).max(0.0))
            .collect()
    };
    let regions: Vec<Vec<f64>> = [1.0, -1.0, -1.0, 1.0].map(tilt).to_vec();
    let glass = Material::dielectric(1.5).unwrap();
    let light = Incidence::from_degrees(50.0, 0.0).unwrap();
    let spec = TallySpec::new(HemisphereGrid::new(6, 8).unwrap(), 0.2).unwrap();
    let found = region_influence(&whole, &regions, glass, light, &spec).unwrap();
    let all = spec.grid_entries(Component::Single);
    let steep = model_of(SlopeTable::new(grid.clone(), &regions[0]).unwrap(), glass);
    let base = expected(&model_of(whole.clone(), glass), light, &spec);
    let of_steep = expected(&steep, light, &spec);
    let change: Vec<f64> = of_steep[all]
        .iter()
        .zip(&base[all])
        .map(|(a, b)| a - b)
        .collect();
    let size = change.iter().map(|x| x.abs()).sum::<f64>();
    let off = distance(&found[0][all], &change) * 2.0;
    println!("changes of {size}, wrong by {off}");
    assert!(size > 1e-3 && off < 0.05 * size);
    for entry in spec.entries() {
        let sum: f64 = found.iter().map(|tally| tally[entry]).sum();
        assert!(sum.abs() < 1e-12);
    }
}
