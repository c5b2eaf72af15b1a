//! Pilot: plans the effort that an error takes, from what a short run on a few surfaces shows.
//!
//! The variance of a result from `N` surfaces of `n` rays each is `(v_s + v_r / n) / N`, with the
//! variance `v_s` between surfaces and `v_r` of rays on their surface. It takes the time
//! `N (c_s + n c_r)`, which is least for a given variance at `n = sqrt(v_r c_s / (v_s c_r))`. A pilot run
//! gives the variances: tallies of surfaces scatter by `v_s + v_r / n`, ray blocks within them by `v_r`
//! alone. Strata make rays scatter less than `1 / n` promises, so that plans are rather too long than too
//! short.
//!
//! The surfaces of the pilot run are none of those of the result. Costs are counted, not measured, so
//! that the same seed plans the same on any machine.

use asperity_tally::{Entry, TallyValues};
use asperity_tracer::Work;

use crate::engine::reduce::tallies::CaseTallies;
use crate::engine::trace::stage::{PILOT_BLOCKS, SurfacePlan};
use crate::errors::convergence::Convergence;
use crate::input::cells::Cells;
use crate::input::random_surfaces::RandomSurfaces;
use crate::input::target::{Target, ratio};
use crate::output::stopping::PilotFigures;

/// Number of the first surface of a pilot run; those of results end far before.
pub(crate) const FIRST: u64 = 1 << 40;

/// Surfaces of the pilot run: their variance is known to a half. For as many rays in all, fewer surfaces take less time, and the noise of
/// their rays hides less of that variance.
pub(crate) const PLAN: SurfacePlan = SurfacePlan {
    surfaces: 8,
    rays: 8 << 12,
};

/// Rays of the pilot run on one surface, in blocks of 64 strata along a side.
pub(crate) const PLAN_ON_ONE: SurfacePlan = SurfacePlan {
    surfaces: 1,
    rays: PILOT_BLOCKS * 64 * 64,
};

/// Nanoseconds that a cell takes to be drawn and built into the pyramid: processor time of one thread on
/// a machine with AVX-512 (EPYC 9005), from surfaces of 64 x 64 to 512 x 512. What counts is its ratio to those below, which were
/// measured on the same machine from `s = 0.5` to 8, and hold to about a quarter: the optimum is flat.
const CELL_NS: f64 = 23.0;

/// Nanoseconds of a smooth cell, whose bounds take longer.
const SMOOTH_CELL_NS: f64 = 66.0;

/// Nanoseconds of overhead per surface and case: streams, tallies, their sums, saving them.
const SURFACE_NS: f64 = 800_000.0;

/// Nanoseconds that a segment takes to be searched, with what happens at its end.
pub(super) const SEGMENT_NS: f64 = 250.0;

/// Nanoseconds that a segment takes of which slopes tell that it meets nothing.
const SKIPPED_NS: f64 = 40.0;

/// Nanoseconds of overhead per ray, without its segments.
pub(super) const RAY_NS: f64 = 60.0;

/// Fewest and most rays of a surface: two blocks of eight by eight; beyond the most they cost so much
/// more than the surface that there is nothing to save.
const RAYS_OF_SURFACE: [f64; 2] = [128.0, 67_108_864.0];

/// Least cost of the rays of a surface, as a fraction of the cost of the surface: where it takes fewer, a few more are
/// as good as given.
const LEAST_COST_OF_RAYS: f64 = 0.1;

/// Fewest surfaces of a result: with eight, an error is itself known to a quarter.
const FEWEST: f64 = 8.0;

/// Variance is planned to lie so far below that of the target, since variances of a pilot run are
/// uncertain themselves.
const MARGIN: f64 = 1.1;

/// Variance between surfaces is taken to be at least its own standard error, or this part of the scatter if that is less. Bins of surfaces
/// of default size have 2 to 15 % of it from `s = 0.5` to 2, which a pilot run can hardly tell from none.
const LEAST_OF_SURFACES: f64 = 0.03;

/// Figures of one case by a pilot run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Figures {
    pub(crate) figures: PilotFigures,
    /// Rays in all below which a single one is more than the target.
    fewest_rays: f64,
}

/// Planned effort of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlannedEffort {
    pub(crate) surfaces: u64,
    pub(crate) rays_per_surface: u64,
    /// The error to be expected of it, of the most demanding case.
    pub(crate) expected: f64,
}

impl PlannedEffort {
    pub(crate) const fn plan(&self) -> SurfacePlan {
        SurfacePlan {
            surfaces: self.surfaces,
            rays: self.surfaces.saturating_mul(self.rays_per_surface),
        }
    }
}

/// Tallies of one case by the pilot run, at its spacing and, if there is such a grid, at twice that.
pub(crate) struct PilotRun<'a> {
    pub(crate) fine: &'a CaseTallies,
    pub(crate) coarse: Option<&'a CaseTallies>,
    /// Counted cost of drawing and building a surface, in nanoseconds.
    pub(crate) cost_of_surface_ns: f64,
}

impl Figures {
    /// From what the pilot run found.
    pub(crate) fn new(target: Target, run: &PilotRun<'_>) -> Self {
        let PilotRun {
            fine,
            coarse,
            cost_of_surface_ns,
        } = *run;
        let entries = target.of().entries(fine.ray_squares.spec());
        let [mut scatter, mut of_rays, mut square] = [0.0; 3];
        let n = fine.surfaces.len() as f64;
        let rays = fine.work.rays as f64 / n;
        for &i in &entries {
            let [mean, variance] = mean_and_variance(fine.surfaces.iter().map(|r| r[i]));
            scatter += variance;
            of_rays += fine.ray_squares[i] / n;
            square += mean * mean;
        }
        // The noise of the means adds to their squares.
        let norm = target.of().norm((square - scatter / n).max(0.5 * square));
        let least = scatter_error(&entries, &fine.surfaces).min(LEAST_OF_SURFACES * scatter);
        let of_surfaces = (scatter - of_rays).max(least);
        let work = &fine.work;
        let relative = |square: f64| ratio(square, norm * norm);
        Self {
            figures: PilotFigures {
                realisations: fine.surfaces.len() as u64,
                rays: work.rays,
                variance_of_surfaces: relative(of_surfaces),
                variance_of_rays: relative(of_rays * rays),
                cost_of_surface_ns,
                cost_of_ray_ns: cost_of_ray_ns(work),
                mesh_difference: coarse
                    .map(|coarse| ratio(difference(&entries, fine, coarse), norm)),
            },
            fewest_rays: ratio(1.0, norm) / target.error(),
        }
    }

    /// The effort that brings the error of a case to `error` in the least time. `surface_cost`: how much
    /// more a surface costs than in the pilot run; `most`: surfaces that results have room for.
    pub(crate) fn effort(&self, error: f64, surface_cost: f64, most: u64) -> PlannedEffort {
        let PilotFigures {
            variance_of_surfaces: v_s,
            variance_of_rays: v_r,
            cost_of_surface_ns: c_s,
            cost_of_ray_ns: c_r,
            ..
        } = self.figures;
        let c_s = c_s * surface_cost;
        let [fewest_rays, most_rays] = RAYS_OF_SURFACE;
        let least_rays = (LEAST_COST_OF_RAYS * c_s / c_r).clamp(fewest_rays, most_rays);
        let best = (v_r * c_s / (v_s * c_r)).sqrt();
        // Nothing scatters at all: as few as may be.
        let best = if best.is_nan() { least_rays } else { best };
        let mut rays = best.clamp(least_rays, most_rays);
        let wanted = error * error / MARGIN;
        let surfaces_for = |rays: f64| (v_s + v_r / rays) / wanted;
        let mut surfaces = surfaces_for(rays).ceil();
        let bounded = surfaces.clamp(FEWEST.min(most as f64), most as f64);
        if bounded != surfaces {
            // With more or fewer surfaces than are best, rays make up for them.
            surfaces = bounded;
            let left = surfaces * wanted - v_s;
            // Where surfaces alone scatter more than that, no number of rays does.
            if left > 0.0 {
                rays = v_r / left;
            }
        }
        rays = rays.max(self.fewest_rays / surfaces);
        let rays = rays.clamp(least_rays, most_rays);
        PlannedEffort {
            surfaces: surfaces as u64,
            rays_per_surface: rays.ceil() as u64,
            expected: ((v_s + v_r / rays) / surfaces).sqrt(),
        }
    }

    /// Error of a mesh whose spacing is `scale` times that of the pilot run's.
    pub(crate) fn mesh_error(&self, scale: f64, convergence: Convergence) -> Option<f64> {
        let difference = self.figures.mesh_difference?;
        Some(convergence.remaining_at(scale) * difference)
    }
}

/// Counted cost of drawing and building one of these surfaces, in nanoseconds.
pub(crate) fn cost_of_surface_ns(surfaces: &RandomSurfaces) -> f64 {
    let of_cell = match surfaces.cells() {
        Cells::Flat => CELL_NS,
        Cells::Smooth => SMOOTH_CELL_NS,
    };
    let cells: usize = surfaces.shape().iter().product();
    of_cell * cells as f64 + SURFACE_NS
}

/// Counted cost of a ray with the paths that begin with it, on average over this work, in nanoseconds.
pub(crate) fn cost_of_ray_ns(work: &Work) -> f64 {
    let per_ray = |count: u64| count as f64 / work.rays as f64;
    RAY_NS + SEGMENT_NS * per_ray(work.segments) + SKIPPED_NS * per_ray(work.segments_skipped)
}

/// Counted cost of cases that share these surfaces, at the spacing of the pilot run, in nanoseconds.
pub(crate) fn cost_of_all(cases: &[Figures], surfaces: u64, rays_per_surface: u64) -> f64 {
    let of_surface = cases.first().map_or(0.0, |c| c.figures.cost_of_surface_ns);
    let of_ray: f64 = cases.iter().map(|c| c.figures.cost_of_ray_ns).sum();
    surfaces as f64 * (of_surface + rays_per_surface as f64 * of_ray)
}

/// The effort that serves all cases that share surfaces: for the rays of the most demanding one, as many
/// surfaces as all of them need.
pub(crate) fn plan(cases: &[Figures], error: f64, scale: f64, most: u64) -> Option<PlannedEffort> {
    let cost = 1.0 / (scale * scale);
    let total = |effort: &PlannedEffort| effort.plan().rays;
    cases
        .iter()
        .map(|figures| figures.effort(error, cost, most))
        .reduce(|a, b| {
            let demanding = if total(&b) > total(&a) { b } else { a };
            PlannedEffort {
                surfaces: a.surfaces.max(b.surfaces),
                expected: a.expected.max(b.expected),
                ..demanding
            }
        })
}

/// Difference of results on the same surfaces with twice the spacing: the root of the sum of
/// squares, to which noise is counted that may hide more.
fn difference(entries: &[Entry], fine: &CaseTallies, coarse: &CaseTallies) -> f64 {
    let n = fine.surfaces.len().min(coarse.surfaces.len()) as f64;
    let [mut squares, mut noise, mut noise_squares] = [0.0; 3];
    for &i in entries {
        let pairs = fine.surfaces.iter().zip(&coarse.surfaces);
        let [mean, variance] = mean_and_variance(pairs.map(|(fine, coarse)| coarse[i] - fine[i]));
        squares += mean * mean;
        noise += variance / n;
        noise_squares += (variance / n).powi(2);
    }
    // The sum of squared normal errors scatters by the root of twice the sum of their squared variances.
    ((squares - noise).max(0.0) + 2.0 * (2.0 * noise_squares).sqrt()).sqrt()
}

/// Standard error of the scatter of records: of the sum of the variances of `entries` over surfaces.
///
/// With the covariance `C` of the entries and normal records, its square is `2 tr(C^2) / (n - 1)`. Of the sample covariance `S`,
/// `tr(S^2)` is `tr(C^2) n / (n - 1) + tr(C)^2 / (n - 1)` on average. Both traces follow from the products of records with each other.
fn scatter_error(entries: &[Entry], records: &[TallyValues]) -> f64 {
    let n = records.len() as f64;
    let centred: Vec<Vec<f64>> = {
        let mean = |i: &Entry| records.iter().map(|record| record[*i]).sum::<f64>() / n;
        let means: Vec<f64> = entries.iter().map(mean).collect();
        let less_mean = |record: &TallyValues| {
            let values = entries.iter().zip(&means);
            values.map(|(&i, mean)| record[i] - mean).collect()
        };
        records.iter().map(less_mean).collect()
    };
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let [mut trace, mut trace_of_square] = [0.0; 2];
    for (r, a) in centred.iter().enumerate() {
        trace += product(a, a) / (n - 1.0);
        for b in &centred[..=r] {
            let of_pair = (product(a, b) / (n - 1.0)).powi(2);
            trace_of_square += if std::ptr::eq(a, b) {
                of_pair
            } else {
                2.0 * of_pair
            };
        }
    }
    let of_expected = (trace_of_square - trace * trace / (n - 1.0)).max(0.0) * (n - 1.0) / n;
    (2.0 * of_expected / (n - 1.0)).sqrt()
}

fn mean_and_variance(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares: f64 = values.map(|x| (x - mean).powi(2)).sum();
    [mean, if n > 1.0 { squares / (n - 1.0) } else { 0.0 }]
}

#[cfg(test)]
pub(crate) mod tests {
    use asperity_tally::TallySpec;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    pub(crate) fn figures(v_s: f64, v_r: f64, mesh: Option<f64>) -> Figures {
        Figures {
            figures: PilotFigures {
                realisations: 16,
                rays: 1,
                variance_of_surfaces: v_s,
                variance_of_rays: v_r,
                cost_of_surface_ns: 1e6,
                cost_of_ray_ns: 100.0,
                mesh_difference: mesh,
            },
            fewest_rays: 0.0,
        }
    }

    #[test]
    fn no_other_division_reaches_the_error_in_less_time() {
        let (v_s, v_r) = (1e-4, 1.0);
        let error = 1e-3;
        let effort = figures(v_s, v_r, None).effort(error, 1.0, 1 << 20);
        let n = effort.rays_per_surface as f64;
        let variance = (v_s + v_r / n) / effort.surfaces as f64;
        assert!(variance <= error * error && variance > 0.7 * error * error);
        let time = |n: f64| (v_s + v_r / n) * (1e6 + 100.0 * n);
        assert!(time(n) < time(1.2 * n) && time(n) < time(n / 1.2), "{n}");
    }

    /// The relative error from `k` independent entries of equal variance is `sqrt(2 / ((n - 1) k))`.
    #[test]
    fn the_error_of_the_scatter_falls_with_the_number_of_independent_entries() {
        let spec = TallySpec::default();
        let bins = spec.recorded_entries(asperity_tally::Component::All);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for (k, copies) in [(1, 1), (20, 1), (200, 1), (20, 10)] {
            let entries: Vec<Entry> = bins.iter().take(k * copies).collect();
            let runs = 200;
            let mean: f64 = (0..runs)
                .map(|_| {
                    let record = |_| {
                        let mut record = TallyValues::zeros(spec);
                        for same in entries.chunks(copies) {
                            // Twelve uniform numbers are nearly normal.
                            let value: f64 = (0..12).map(|_| rng.random::<f64>()).sum();
                            same.iter().for_each(|&i| record[i] = value);
                        }
                        record
                    };
                    let records: Vec<TallyValues> = (0..16).map(record).collect();
                    (scatter_error(&entries, &records) / (k * copies) as f64).powi(2)
                })
                .sum::<f64>()
                / f64::from(runs);
            let expected = 2.0 / (15.0 * k as f64);
            println!("{k} x {copies}: {mean:.3e}, expected {expected:.3e}");
            assert!((mean / expected - 1.0).abs() < 0.3, "{k} {copies}");
        }
    }

    #[test]
    fn few_surfaces_get_more_rays_and_many_are_never_more_than_allowed() {
        let easy = figures(1e-12, 1.0, None).effort(1e-3, 1.0, 1 << 20);
        assert_eq!(easy.surfaces, 8);
        assert!(
            (1.2e5..1.7e5).contains(&(easy.rays_per_surface as f64)),
            "{easy:?}"
        );
        let hard = figures(1.0, 1.0, None).effort(1e-3, 1.0, 100);
        // A hundred surfaces cannot do it, and rays do not help.
        assert_eq!(hard.surfaces, 100);
        assert!(hard.rays_per_surface < 1_000_000, "{hard:?}");
        assert!((0.1..0.2).contains(&hard.expected), "{hard:?}");
        let exact = figures(0.0, 0.0, None).effort(1e-3, 1.0, 100);
        assert_eq!([exact.surfaces, exact.rays_per_surface], [8, 1000]);
    }
}
