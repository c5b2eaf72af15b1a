//! The plots of Mueller matrices: 4 x 4 panels over the signed angle, and 4 x 4 discs over the hemisphere.

use asperity_plot::{
    AngleGrid, AnglePanel, Colour, Curve, CurveAxis, Figure, Hemisphere, Hemispheres, PlotError,
    Point, SharedColours, Style,
};
use asperity_tally::{
    Component, Measure, Polarimetry, Side, TallyResult, TallySpec, TallyStatistics, is_of_few_rays,
};
use rayon::prelude::*;

use crate::output::{Place, over, projected_solid_angle};
use crate::report::disc_bins::{disc_bins, disc_edges};
use crate::report::energies::recorded_orders;
use crate::report::error::ReportError;
use crate::report::figures::{in_plane_points, mean_angle_deg, plot_side, save};
use crate::report::polarised::elements;
use crate::report::shown_case::ShownCase;

/// Axes s and p of all matrices.
const AXES: &str = "s along z × k, p = k × s (docs, polarisation)";
/// Largest standard error of an element that a curve shows: half of the largest element.
const MOST_ERROR: f64 = 0.5;
/// End of the axis of elements: points at -1 and 1 are seen whole.
const ELEMENT_END: f64 = 1.08;
/// Light scattered once.
const SINGLE: Component = Component::ORDERS[0];
/// The Stokes parameters, in the order of rows and columns.
const STOKES: [&str; 4] = ["I", "Q", "U", "V"];

/// Names of the plots of such a spec, of which some may have nothing to show and are not drawn.
pub(crate) fn polarised_figures(spec: &TallySpec) -> Vec<String> {
    match spec.polarimetry() {
        Polarimetry::Mueller => spec.sides().flat_map(names).collect(),
        Polarimetry::Nothing | Polarimetry::Averaging => Vec::new(),
    }
}

/// Names of the panels and of the discs of a side.
fn names(side: Side) -> [String; 2] {
    [
        format!("mueller_in_plane_{side}"),
        format!("mueller_{side}"),
    ]
}

/// Draws the Mueller matrices of each side that light leaves to, if they are kept.
pub(crate) fn draw_polarised(place: &Place<'_>, case: &ShownCase<'_>) -> Result<(), ReportError> {
    let statistics = &case.outcome.statistics;
    let spec = statistics.spec();
    if spec.polarimetry() != Polarimetry::Mueller {
        return Ok(());
    }
    let lit = |side: &Side| statistics.means().flux(*side, Component::All) != 0.0;
    let sides: Vec<Side> = spec.sides().filter(lit).collect();
    sides.into_par_iter().try_for_each(|side| {
        let [panels, discs] = names(side);
        let draw = |name: &str, figure: Result<Figure, PlotError>| save(&[place], name, &figure?);
        let (panels, discs) = rayon::join(
            || draw(&panels, in_plane(case, side).draw()),
            || draw(&discs, hemispheres(case, side).draw()),
        );
        panels.and(discs)
    })
}

/// Title of a figure of `side`.
fn title(side: Side, what: &str) -> String {
    let word = match side {
        Side::Reflected => "reflected",
        Side::Transmitted => "transmitted",
    };
    format!("Mueller matrix of {word} light {what}")
}

fn subtitle(case: &ShownCase<'_>) -> String {
    format!("{}; {AXES}", case.subtitle())
}

/// Panels in the plane of incidence: the BSDF of unpolarised light, then the elements over it.
fn in_plane(case: &ShownCase<'_>, side: Side) -> AngleGrid {
    let statistics = &case.outcome.statistics;
    let mut shown = vec![(Component::All, recorded_orders(case.max_order))];
    let seen = |component| statistics.means().flux(side, component) != 0.0;
    // Without multiple scattering both are the same, and one would hide the other.
    if seen(SINGLE) && seen(Component::Multiple) {
        shown.push((SINGLE, "single scattering".to_owned()));
    }
    let curves = |points: &dyn Fn(Component) -> Vec<Point>| {
        let curve = |(i, (component, name)): (usize, &(Component, String))| Curve {
            name: format!("explicit, {name}"),
            colour: Colour::Component(i),
            style: if i == 0 {
                Style::Points(0)
            } else {
                Style::Hollow(i)
            },
            points: points(*component),
        };
        shown.iter().enumerate().map(curve).collect()
    };
    let unpolarised = AnglePanel {
        name: "m00, unpolarised light".to_owned(),
        y: CurveAxis {
            label: "f |cos θₒ| (1/sr)".to_owned(),
            range: None,
        },
        curves: curves(&|component| without_widths(in_plane_points(statistics, side, component))),
    };
    let panels = elements().map(|element| AnglePanel {
        name: name(element),
        y: CurveAxis {
            label: "over m00".to_owned(),
            range: Some([-ELEMENT_END, ELEMENT_END]),
        },
        curves: curves(&|component| element_points(statistics, side, component, element)),
    });
    AngleGrid {
        title: title(side, "in the plane of incidence"),
        subtitle: subtitle(case),
        side: plot_side(side),
        flat_direction_deg: case.flat_direction(side),
        columns: STOKES.len(),
        panels: [unpolarised].into_iter().chain(panels).collect(),
        notes: vec![format!(
            "Elements are left out where no light leaves or their standard error exceeds {MOST_ERROR}."
        )],
    }
}

/// These points without horizontal bars.
fn without_widths(mut points: Vec<Point>) -> Vec<Point> {
    for point in &mut points {
        point.x_range = None;
    }
    points
}

/// An element over the first, bin by bin of the in-plane slice, where it is known.
fn element_points(
    statistics: &TallyStatistics,
    side: Side,
    component: Component,
    [row, column]: [usize; 2],
) -> Vec<Point> {
    let spec = statistics.spec();
    let filter = spec.in_plane_filter(side);
    let entries = spec.in_plane_entries(side, component);
    let point = |i: usize| {
        let measure = Measure::Element { row, column };
        let element = statistics.over_flux(entries.get(i), measure)?;
        let known = element.se.is_none_or(|se| se <= MOST_ERROR);
        known.then(|| {
            Point::with_error(
                mean_angle_deg(filter.theta_deg(i)),
                element.mean,
                element.se,
            )
        })
    };
    (0..filter.len()).filter_map(point).collect()
}

/// Discs over the hemisphere: the BSDF of unpolarised light, then the elements over it.
fn hemispheres(case: &ShownCase<'_>, side: Side) -> Hemispheres {
    let statistics = &case.outcome.statistics;
    let spec = statistics.spec();
    let entries = spec.grid_entries(Component::All);
    let vertical = case.incidence().is_vertical();
    let few_rays: Vec<usize> = (disc_bins(spec, side).enumerate())
        .filter(|(_, bin)| is_of_few_rays(statistics.at(entries.get(*bin))))
        .map(|(place, _)| place)
        .collect();
    let disc = |name: String, value: &dyn Fn(usize) -> Option<f64>| {
        Some(Hemisphere {
            bins: disc_edges(spec, side),
            values: disc_bins(spec, side).map(value).collect(),
            few_rays: few_rays.clone(),
            light_deg: (!vertical).then(|| case.incidence().phi_deg()),
            note: name,
        })
    };
    let bsdf = |bin| {
        let flux = statistics.at(entries.get(bin));
        let bsdf = over(flux, projected_solid_angle(&spec.grid(), bin));
        (flux.mean != 0.0).then_some(bsdf.mean)
    };
    let ratios = elements().map(|[row, column]| {
        let measure = Measure::Element { row, column };
        disc(name([row, column]), &|bin| {
            let element = statistics.over_flux(entries.get(bin), measure)?;
            Some(element.mean)
        })
    });
    let first = disc("m00".to_owned(), &bsdf);
    Hemispheres {
        title: title(side, "over the hemisphere"),
        subtitle: subtitle(case),
        quantity: match side {
            Side::Reflected => "m00: BRDF of unpolarised light",
            Side::Transmitted => "m00: BTDF of unpolarised light",
        }
        .to_owned(),
        side: plot_side(side),
        row_title: "Stokes parameter of the light that leaves".to_owned(),
        column_title: "Stokes parameter of the incident light".to_owned(),
        rows: STOKES.map(str::to_owned).to_vec(),
        columns: STOKES.map(str::to_owned).to_vec(),
        colours: SharedColours::OverFirst {
            name: "m01 to m33, over m00",
        },
        cells: [first].into_iter().chain(ratios).collect(),
    }
}

/// Name of an element.
fn name([row, column]: [usize; 2]) -> String {
    format!("m{row}{column}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_tally::HemisphereGrid;

    #[test]
    fn only_kept_matrices_of_recorded_sides_are_drawn() {
        let spec = TallySpec::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
        assert!(polarised_figures(&spec).is_empty());
        let averaging = spec.with_polarimetry(Polarimetry::Averaging);
        assert!(polarised_figures(&averaging).is_empty());
        let kept = spec.with_polarimetry(Polarimetry::Mueller);
        let names = [
            "mueller_in_plane_reflected",
            "mueller_reflected",
            "mueller_in_plane_transmitted",
            "mueller_transmitted",
        ];
        assert_eq!(polarised_figures(&kept), names);
    }
}
