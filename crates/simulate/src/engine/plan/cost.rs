//! Cost: the time that cases are expected to take, before anything is traced, and their division among shards.
//!
//! Of a target error nothing is known before the pilot run; cases then count as with the default number of rays.

use super::pilot::{RAY_NS, SEGMENT_NS, cost_of_surface_ns};
use crate::engine::prepare::case_run::CaseRun;
use crate::engine::trace::joint::may_join;
use crate::engine::trace::stage::SurfacePlan;
use crate::input::case::Case;
use crate::input::settings::Settings;
use crate::input::share::{Division, MAX_UNDIVIDED};
use crate::input::surface_source::SurfaceSource;

/// Expected times of the cases of a group, in seconds of one thread. Surfaces that they share are divided among them.
pub(crate) fn case_seconds(
    source: &SurfaceSource,
    cases: &[CaseRun],
    plan: SurfacePlan,
) -> Vec<f64> {
    let of_surface = match source {
        SurfaceSource::Random(surfaces) => cost_of_surface_ns(surfaces),
        SurfaceSource::Given(_) | SurfaceSource::Described(_) => 0.0,
    };
    let of_surfaces = of_surface * plan.surfaces as f64 / cases.len() as f64;
    let of_case =
        |run: &CaseRun| 1e-9 * (of_surfaces + plan.rays as f64 * cost_of_ray_ns(&run.case));
    cases.iter().map(of_case).collect()
}

/// Segments of a path over a surface of slope zero, and those that a root mean square slope of one adds, of materials that transmit light and
/// of others. By the counts of 60 cases from `s = 0.5` to 8 and 0 to 80 degrees; smooth surfaces, on which most segments need no search, take
/// up to half as many.
const SEGMENTS_OF_TRANSMITTING: [f64; 2] = [1.2, 3.6];
const SEGMENTS_OF_OPAQUE: [f64; 2] = [1.3, 1.0];

/// Slope of a surface whose slopes are not known before it is traced.
const USUAL_SLOPE: f64 = 0.5;

/// Expected time of a ray with the paths that begin with it, in nanoseconds.
fn cost_of_ray_ns(case: &Case) -> f64 {
    let slope = match &case.surface {
        SurfaceSource::Random(surfaces) => {
            let [xx, _, yy] = surfaces.recipe().slope_covariance();
            (0.5 * (xx + yy)).sqrt()
        }
        SurfaceSource::Given(_) | SurfaceSource::Described(_) => USUAL_SLOPE,
    };
    let [flat, by_slope] = match case.material.transmitting_index() {
        Some(_) => SEGMENTS_OF_TRANSMITTING,
        None => SEGMENTS_OF_OPAQUE,
    };
    let interfaces = (1 + case.layers.len()) as f64;
    RAY_NS + SEGMENT_NS * interfaces * (flat + by_slope * slope)
}

/// Gives each case of each group its slice of the share of a division.
///
/// Cases of a group share its surfaces, so that they are divided alike, surface by surface. Where each of them is small beside a share, and its
/// effort does not depend on the others, they are divided case by case instead. Blocks of rays on a given surface are divided case by case too,
/// but for cases that are traced together.
///
/// `planned`: surfaces and rays of each case on a source.
pub(crate) fn divide(
    groups: &mut [(SurfaceSource, Vec<CaseRun>)],
    planned: impl Fn(&SurfaceSource) -> SurfacePlan,
    settings: &Settings,
    division: &Division,
) {
    let share = division.share;
    if share.is_whole() {
        return;
    }
    let all: usize = groups.iter().map(|(_, cases)| cases.len()).sum();
    let seconds = groups.iter().map(|(source, cases)| {
        let expected = case_seconds(source, cases, planned(source)).into_iter();
        let of_plan = |run: &CaseRun| division.seconds.get(run.number).copied();
        let is_planned = division.seconds.len() == all;
        let pairs = expected.zip(cases);
        let seconds = pairs.map(|(expected, run)| match is_planned {
            true => of_plan(run).unwrap_or(expected),
            false => expected,
        });
        seconds.collect::<Vec<f64>>()
    });
    let seconds: Vec<Vec<f64>> = seconds.collect();
    let most = MAX_UNDIVIDED * seconds.iter().flatten().sum::<f64>() / share.of() as f64;
    let mut bundles: Vec<Vec<usize>> = Vec::new();
    let mut costs = Vec::new();
    for ((source, cases), seconds) in groups.iter().zip(&seconds) {
        let has_ray_blocks = source.shapes().len() == 1 && settings.regions.is_none();
        let are_small = seconds.iter().all(|one| *one <= most) && settings.target().is_none();
        let of_group = bundles.len();
        for (i, run) in cases.iter().enumerate() {
            let belongs = |bundle: &&mut Vec<usize>| match has_ray_blocks {
                true => may_join(&cases[bundle[0]].case, &run.case),
                false => !are_small,
            };
            match bundles[of_group..].iter_mut().find(belongs) {
                Some(bundle) => bundle.push(i),
                None => bundles.push(vec![i]),
            }
        }
        let of_bundle = |bundle: &Vec<usize>| bundle.iter().map(|&i| seconds[i]).sum::<f64>();
        costs.extend(bundles[of_group..].iter().map(of_bundle));
    }
    let mut slices = bundles.iter().zip(share.slices(&costs));
    for (_, cases) in groups {
        let mut left = cases.len();
        while left > 0
            && let Some((bundle, slice)) = slices.next()
        {
            bundle.iter().for_each(|&i| cases[i].slice = slice);
            left -= bundle.len();
        }
    }
}
