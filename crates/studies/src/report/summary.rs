//! summary.json: totals, orders, event paths and work.

use asperity_simulate::{Outcome, Stopping, SummaryWork};
use asperity_tally::{
    Component, MAX_LISTED_ORDER, MAX_LISTED_PATH, Side, TallyResult, TallyStatistics,
};
use serde::{Serialize, Serializer};

use crate::config::lobes::BinnedLobe;
use crate::output::{BySide, EstimateWithLimit, Head};
use crate::report::flux_basis::FluxBasis;
use crate::report::polarised::polarised_json;
use crate::validity::Validity;

#[derive(Clone, Debug, Serialize)]
struct Energy {
    /// `None` on a side that is not recorded.
    #[serde(flatten)]
    sides: BySide<Option<EstimateWithLimit>>,
    absorbed: EstimateWithLimit,
    truncated: EstimateWithLimit,
    lost: EstimateWithLimit,
    /// The part of truncated that left an open patch sideways.
    left_patch: EstimateWithLimit,
    /// The part of truncated that went to a side that is not recorded.
    not_recorded: EstimateWithLimit,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Order {
    order: usize,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    and_above: bool,
    #[serde(flatten)]
    flux: EstimateWithLimit,
}

#[derive(Clone, Debug, Serialize)]
struct Path {
    events: String,
    side: Side,
    #[serde(flatten)]
    flux: EstimateWithLimit,
}

#[derive(Clone, Debug, Serialize)]
struct Inside {
    scatterings: Component,
    side: Side,
    #[serde(flatten)]
    flux: EstimateWithLimit,
}

/// The contents of summary.json.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    #[serde(flatten)]
    head: Head,
    /// The answer in at most five lines.
    pub(crate) headline: Vec<String>,
    /// Surface, material and light in words.
    label: String,
    config: serde_json::Value,
    seed: u64,
    /// Source of the standard errors: `surfaces` or `ray blocks`.
    errors_from: &'static str,
    batches: u64,
    energy: Energy,
    error_budget: serde_json::Value,
    /// `None` on a side that is not recorded.
    orders: BySide<Option<Vec<Order>>>,
    paths: Vec<Path>,
    /// By how often light was scattered inside a medium, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    components: Option<Vec<Inside>>,
    /// Quantities that instruments near the specular direction read.
    pub(crate) appearance: serde_json::Map<String, serde_json::Value>,
    /// Quantities of polarised light, under a key of their own.
    #[serde(flatten)]
    polarised: Option<serde_json::Map<String, serde_json::Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) comparison: Option<serde_json::Value>,
    pub(crate) columns: serde_json::Value,
    pub(crate) warnings: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stopping: Option<Stopping>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) validity: Option<Validity>,
    /// Lobes of single scattering next to the bins that hold their middles.
    pub(crate) lobes: Vec<BinnedLobe>,
    /// Bound on the difference of the fluxes, where nothing was traced.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviation_bound: Option<f64>,
    #[serde(serialize_with = "side_by_side")]
    work: SummaryWork,
}

/// Writes the work with what depends on the machine next to the rest.
fn side_by_side<S: Serializer>(work: &SummaryWork, serializer: S) -> Result<S::Ok, S::Error> {
    const KEYS: [&str; 23] = [
        "realisations",
        "rays",
        "segments",
        "segments_skipped",
        "segments_skipped_nearby",
        "branches_not_recorded",
        "scatterings",
        "most_scatterings",
        "accelerator",
        "instructions",
        "estimator",
        "control_variate",
        "slope_control",
        "folded",
        "branching",
        "roulette",
        "starts",
        "sampling",
        "generate_seconds",
        "build_seconds",
        "trace_seconds",
        "seconds",
        "threads",
    ];
    let all = serde_json::json!(work);
    let value = |key: &str| all.get(key).or_else(|| all["machine"].get(key));
    serializer.collect_map(KEYS.iter().filter_map(|key| Some((key, value(key)?))))
}

impl Summary {
    /// Summary of an outcome, without headline, comparison, appearance, columns, lobes, warnings and validity.
    #[must_use]
    pub(crate) fn new(
        command: &'static str,
        config: serde_json::Value,
        outcome: &Outcome,
        stopping: Option<&Stopping>,
    ) -> Self {
        let statistics = &outcome.statistics;
        let spec = statistics.spec();
        let support = FluxBasis::of(outcome);
        let energy = |side| {
            let recorded = spec.records(side);
            recorded.then(|| support.flux(side, statistics.flux(side, Component::All)))
        };
        let orders = |side| {
            let recorded = spec.records(side);
            recorded.then(|| orders(statistics, &support, side))
        };
        let budget = statistics.budget();
        Self {
            head: Head::of(command),
            headline: Vec::new(),
            label: outcome.case.label(),
            config,
            seed: outcome.seed,
            errors_from: outcome.errors_from.name(),
            batches: statistics.batches(),
            energy: Energy {
                sides: BySide::of(energy),
                absorbed: support.absorbed(budget.absorbed),
                truncated: support.ended(budget.truncated),
                lost: support.ended(budget.lost),
                left_patch: support.ended(budget.left_patch),
                not_recorded: support.ended(budget.not_recorded),
            },
            error_budget: outcome.errors.to_json(statistics.means()),
            orders: BySide::of(orders),
            paths: paths(statistics, &support),
            components: spec
                .has_medium()
                .then(|| of_components(statistics, &support)),
            appearance: serde_json::Map::new(),
            polarised: polarised_json(statistics)
                .map(|(key, value)| serde_json::Map::from_iter([(key.to_owned(), value)])),
            comparison: None,
            columns: serde_json::Value::Null,
            warnings: Vec::new(),
            stopping: stopping.map(|stopping| Stopping {
                // They are among those of the run.
                warnings: Vec::new(),
                ..stopping.clone()
            }),
            validity: None,
            lobes: Vec::new(),
            deviation_bound: outcome.deviation_bound,
            work: outcome.work.clone(),
        }
    }
}

/// Fluxes by order of scattering, up to the last one that was seen.
pub(crate) fn orders(statistics: &TallyStatistics, support: &FluxBasis, side: Side) -> Vec<Order> {
    let mut orders: Vec<Order> = (1..)
        .zip(statistics.orders(side))
        .map(|(order, flux)| Order {
            order,
            and_above: order == MAX_LISTED_ORDER,
            flux: support.flux(side, flux),
        })
        .collect();
    let seen = orders
        .iter()
        .rposition(|order| order.flux.estimate().mean != 0.0);
    orders.truncate(seen.map_or(0, |last| last + 1));
    orders
}

/// Fluxes of the components that are recorded in addition to the orders.
fn of_components(statistics: &TallyStatistics, support: &FluxBasis) -> Vec<Inside> {
    let spec = statistics.spec();
    let of_side = |side| {
        let components = spec.components().iter();
        components.map(move |&component| Inside {
            scatterings: component,
            side,
            flux: support.flux(side, statistics.flux(side, component)),
        })
    };
    spec.sides().flat_map(of_side).collect()
}

/// Fluxes by event path, those that were seen, the strongest first.
fn paths(statistics: &TallyStatistics, support: &FluxBasis) -> Vec<Path> {
    let spec = statistics.spec();
    let mut found: Vec<Path> = Vec::new();
    for side in spec.sides() {
        let listed = spec
            .listed_paths()
            .map(|path| (path.to_string(), statistics.event_path(side, path)));
        let longer = format!("longer than {MAX_LISTED_PATH}");
        for (events, flux) in listed.chain([(longer, statistics.longer_paths(side))]) {
            if flux.mean != 0.0 {
                let flux = support.flux(side, flux);
                found.push(Path { events, side, flux });
            }
        }
    }
    let mean = |path: &Path| path.flux.estimate().mean;
    found.sort_by(|a, b| mean(b).total_cmp(&mean(a)));
    found
}
