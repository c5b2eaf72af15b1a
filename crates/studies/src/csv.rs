//! Results as tables of numbers.

use asperity_simulate::ErrorBudget;
use std::path::Path;

use asperity_io::{CsvField as Field, WriteError, write_csv};
use asperity_tally::{
    BatchStatistics, Estimate, HemisphereGrid, History, Layout, OrderClass, Share,
};

use crate::models::ModelOutcome;
use crate::part::Part;
use crate::verify::CaseOutcome;

/// histogram.csv, theta.csv and in_plane.csv.
pub(crate) fn write_tables(
    folder: &Path,
    layout: &Layout,
    (statistics, errors, rays): (&BatchStatistics, &ErrorBudget, u64),
    models: &[ModelOutcome],
) -> Result<(), WriteError> {
    write_histogram(folder, layout, (statistics, errors), rays)?;
    write_theta(folder, layout, (statistics, errors))?;
    write_in_plane(folder, layout, (statistics, errors), models)
}

/// Columns that say where the error of `flux` comes from.
const ERRORS: [&str; 3] = ["flux_se_rays", "flux_se_surfaces", "flux_mesh"];

/// The fields of [`ERRORS`] for an entry of the layout.
fn errors_of(errors: &ErrorBudget, entry: usize) -> [Field<'static>; 3] {
    let errors = errors.errors(entry);
    [errors.rays, errors.surfaces, errors.mesh].map(Field::from)
}

/// A mean and its error as two fields.
pub(crate) fn fields<'a>(estimate: Estimate) -> [Field<'a>; 2] {
    [estimate.mean.into(), estimate.se.into()]
}

/// Columns that say which bin a row is about.
pub(crate) const PLACE: [&str; 5] = [
    "side",
    "theta_min_deg",
    "theta_max_deg",
    "phi_min_deg",
    "phi_max_deg",
];

/// The fields of [`PLACE`] for bin `i`, its edges exact in degrees.
pub(crate) fn place(grid: &HemisphereGrid, i: usize) -> Vec<Field<'static>> {
    let side = grid.bin(i).side;
    let theta = grid.theta_edges_deg(side);
    let phi = grid.phi_edges_deg();
    let (ring, sector) = ((i / grid.n_phi()) % grid.n_theta(), i % grid.n_phi());
    vec![
        side.to_string().into(),
        theta[ring].into(),
        theta[ring + 1].into(),
        phi[sector].into(),
        phi[sector + 1].into(),
    ]
}

/// Columns of what light did that was scattered inside a medium never, once and more often.
fn history_header(layout: &Layout) -> Vec<String> {
    History::ALL
        .iter()
        .filter(|_| layout.has_histories())
        .flat_map(|history| {
            let name = format!("flux_{}", history.name());
            [name.clone(), format!("{name}_se")]
        })
        .collect()
}

/// The fields of [`history_header`], by the entry of each history.
fn of_histories(
    layout: &Layout,
    statistics: &BatchStatistics,
    entry: impl Fn(History) -> usize,
) -> Vec<Field<'static>> {
    History::ALL
        .into_iter()
        .filter(|_| layout.has_histories())
        .flat_map(|history| fields(statistics.estimate(entry(history))))
        .collect()
}

fn write_histogram(
    folder: &Path,
    layout: &Layout,
    (statistics, errors): (&BatchStatistics, &ErrorBudget),
    rays: u64,
) -> Result<(), WriteError> {
    let mut header = PLACE.to_vec();
    header.extend([
        "solid_angle_sr",
        "flux",
        "flux_se",
        "intensity",
        "bsdf",
        "bsdf_se",
        "rays",
        "flux_single",
        "flux_single_se",
        "flux_multiple",
        "flux_multiple_se",
    ]);
    let histories = history_header(layout);
    header.extend(histories.iter().map(String::as_str));
    header.extend(ERRORS);
    let grid = layout.grid();
    let rows = layout.asked_bins().map(|i| {
        let bin = grid.bin(i);
        let [single, multiple, total] =
            Share::ALL.map(|share| statistics.estimate(layout.bins(share).start + i));
        let hits: f64 = [Share::Single, Share::Multiple]
            .map(|share| statistics.means()[layout.hits(share).start + i])
            .iter()
            .sum();
        let projected = bin.solid_angle * bin.mean_abs_cos();
        let mut row = place(&grid, i);
        row.extend([
            bin.solid_angle.into(),
            total.mean.into(),
            total.se.into(),
            (total.mean / bin.solid_angle).into(),
            (total.mean / projected).into(),
            total.se.map(|se| se / projected).into(),
            count_of_rays(hits * rays as f64),
        ]);
        row.extend(fields(single));
        row.extend(fields(multiple));
        row.extend(of_histories(layout, statistics, |history| {
            layout.history_bins(history).start + i
        }));
        row.extend(errors_of(errors, layout.bins(Share::Total).start + i));
        row
    });
    write_csv(folder.join("histogram.csv"), &header, rows)
}

/// A number of rays that was kept per incident ray: whole but for rounding, unless a ring's rays were
/// spread over its bins.
fn count_of_rays(count: f64) -> Field<'static> {
    let whole = count.round();
    if (count - whole).abs() <= 1e-9 * whole {
        (whole as u64).into()
    } else {
        count.into()
    }
}

fn order_header() -> Vec<String> {
    ["order_1", "order_2", "order_3", "order_4_and_above"]
        .iter()
        .flat_map(|name| [format!("flux_{name}"), format!("flux_{name}_se")])
        .collect()
}

fn write_theta(
    folder: &Path,
    layout: &Layout,
    (statistics, errors): (&BatchStatistics, &ErrorBudget),
) -> Result<(), WriteError> {
    let orders = order_header();
    let mut header = vec!["side", "theta_min_deg", "theta_max_deg", "flux", "flux_se"];
    let histories = history_header(layout);
    header.extend(orders.iter().chain(&histories).map(String::as_str));
    header.extend(ERRORS);
    let mut rows = Vec::new();
    for side in layout.sides() {
        let edges = layout.grid().theta_edges_deg(side);
        for ring in 0..layout.grid().n_theta() {
            let of = |class| statistics.estimate(layout.rings(side, class).start + ring);
            let mut row: Vec<Field<'_>> = vec![
                side.to_string().into(),
                edges[ring].into(),
                edges[ring + 1].into(),
            ];
            row.extend(fields(of(OrderClass::All)));
            row.extend(
                OrderClass::ALL[..4]
                    .iter()
                    .flat_map(|&class| fields(of(class))),
            );
            row.extend(of_histories(layout, statistics, |history| {
                layout.history_rings(side, history).start + ring
            }));
            let entry = layout.rings(side, OrderClass::All).start + ring;
            row.extend(errors_of(errors, entry));
            rows.push(row);
        }
    }
    write_csv(folder.join("theta.csv"), &header, rows)
}

fn write_in_plane(
    folder: &Path,
    layout: &Layout,
    (statistics, errors): (&BatchStatistics, &ErrorBudget),
    models: &[ModelOutcome],
) -> Result<(), WriteError> {
    let orders = order_header();
    let of_models: Vec<String> = models
        .iter()
        .flat_map(|m| {
            let name = format!("intensity_{}", m.model.name().replace('-', "_"));
            let error = (!m.expectation.is_exact()).then(|| format!("{name}_se"));
            std::iter::once(name).chain(error)
        })
        .collect();
    let mut header = vec![
        "side",
        "theta_min_deg",
        "theta_max_deg",
        "solid_angle_sr",
        "flux",
        "flux_se",
        "intensity",
        "intensity_se",
    ];
    let histories = history_header(layout);
    let columns = orders.iter().chain(&histories).chain(&of_models);
    header.extend(columns.map(String::as_str));
    header.extend(ERRORS);
    let mut rows = Vec::new();
    for side in layout.sides() {
        for i in 0..layout.in_plane_len() {
            let of = |class| statistics.estimate(layout.in_plane(side, class).start + i);
            let [from, to] = layout.in_plane_edges_deg(i);
            let solid_angle = layout.in_plane_solid_angle(i);
            let all = of(OrderClass::All);
            let mut row: Vec<Field<'_>> = vec![
                side.to_string().into(),
                from.into(),
                to.into(),
                solid_angle.into(),
            ];
            row.extend(fields(all));
            row.push((all.mean / solid_angle).into());
            row.push(all.se.map(|se| se / solid_angle).into());
            row.extend(
                OrderClass::ALL[..4]
                    .iter()
                    .flat_map(|&class| fields(of(class))),
            );
            row.extend(of_histories(layout, statistics, |history| {
                layout.history_in_plane(side, history).start + i
            }));
            let entry = layout.in_plane(side, OrderClass::All).start + i;
            for model in models {
                let flux = model.expectation.statistics().estimate(entry);
                row.push((flux.mean / solid_angle).into());
                if !model.expectation.is_exact() {
                    row.push(flux.se.map(|se| se / solid_angle).into());
                }
            }
            row.extend(errors_of(errors, entry));
            rows.push(row);
        }
    }
    write_csv(folder.join("in_plane.csv"), &header, rows)
}

/// comparison.csv: bin by bin, every part of the explicit light beside every model that describes it.
pub(crate) fn write_comparison(
    folder: &Path,
    layout: &Layout,
    case: &CaseOutcome,
) -> Result<(), WriteError> {
    if case.models.is_empty() {
        return Ok(());
    }
    let shown = |part: &Part| match part {
        Part::Inside(_) => layout.has_histories(),
        // Beside a medium, models say nothing of what the surface does alone.
        Part::Orders(share) => *share == Share::Total || !layout.has_histories(),
    };
    let parts: Vec<Part> = Part::COMPARED.into_iter().filter(shown).collect();
    let claimed = |part| {
        let described = move |m: &&ModelOutcome| m.describes(part);
        case.models.iter().filter(described)
    };
    let mut header: Vec<String> = PLACE.map(str::to_owned).to_vec();
    for &part in &parts {
        let name = format!("flux_{}", part.key());
        header.extend([name.clone(), format!("{name}_se")]);
        let of_part = match part {
            Part::Orders(Share::Single) => String::new(),
            _ => format!("{}_", part.key()),
        };
        for model in claimed(part) {
            let name = model.model.name().replace('-', "_");
            header.extend(["flux", "z", "tested"].map(|what| format!("{what}_{of_part}{name}")));
        }
    }
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let grid = layout.grid();
    let rows = layout.asked_bins().enumerate().map(|(compared, i)| {
        let mut row = place(&grid, i);
        for &part in &parts {
            row.extend(fields(
                case.statistics.estimate(part.bins(layout).start + i),
            ));
            for model in claimed(part).filter_map(|model| model.compared(part)) {
                let bin = &model.comparison.bins[compared];
                row.extend([bin.model.into(), bin.z.into(), u64::from(bin.tested).into()]);
            }
        }
        row
    });
    write_csv(folder.join("comparison.csv"), &header, rows)
}
