//! The plots of a run, as SVG and PNG.

use std::path::Path;

use asperity_analysis::{BsdfModel, in_plane_flux};
use asperity_io::{check_ending, write_bytes};
use asperity_numerics::elementary::{cos, sin};
use asperity_optics::Incidence;
use asperity_plot::{
    Figure, HeightMapFigure, InPlaneCurves, Point, PolarLobes, Series, Side as PlotSide,
    Sides as PlotSides,
};
use asperity_simulate::{Observer, Outcome};
use asperity_surface::HeightField;
use asperity_tally::{Component, Side, TallyResult, TallySpec, TallyStatistics};
use rayon::prelude::*;

use crate::comparison::models::ModelOutcome;
use crate::config::case_model::CaseModel;
use crate::output::{Place, figure_files};
use crate::report::energies::recorded_orders;
use crate::report::error::ReportError;
use crate::report::shown_case::ShownCase;

/// Degrees between the points of a model's line.
const LINE_STEP_DEG: f64 = 0.5;
/// Points of a model's line from one bin of unequal width to the next.
const STEPS_PER_BIN: u32 = 4;

/// Writes a figure as SVG and PNG under `name` into each of the places.
pub(crate) fn save(places: &[&Place<'_>], name: &str, figure: &Figure) -> Result<(), ReportError> {
    let [svg, png] = figure_files(name);
    let write = |file: &str, bytes: &[u8]| -> Result<(), ReportError> {
        for place in places {
            write_bytes(place.claim(file)?, bytes)?;
        }
        Ok(())
    };
    let (svg, png) = rayon::join(
        || write(&svg, figure.svg()?.as_bytes()),
        || write(&png, &figure.png()?),
    );
    svg.and(png)
}

/// Writes a figure to `path`, as SVG or PNG by its ending.
pub(crate) fn write_by_ending(path: &Path, figure: &Figure) -> Result<(), ReportError> {
    let bytes = match check_ending(path, "plots", &["svg", "png"])? {
        "svg" => figure.svg()?.into_bytes(),
        _ => figure.png()?,
    };
    Ok(write_bytes(path, &bytes)?)
}

/// Draws a figure, if there is one, and writes it, unless the run gives up. Returns the number of figures that are left out.
pub(crate) fn save_unless<E>(
    observer: &dyn Observer,
    places: &[&Place<'_>],
    name: &str,
    draw: impl FnOnce() -> Result<Option<Figure>, E>,
) -> Result<usize, ReportError>
where
    ReportError: From<E>,
{
    if observer.gives_up_first() {
        return Ok(1);
    }
    if let Some(figure) = draw()? {
        save(places, name, &figure)?;
    }
    Ok(0)
}

/// The figure of a height map.
///
/// # Errors
/// [`asperity_plot::PlotError`] if it cannot be drawn.
pub(crate) fn height_map_figure(
    field: &HeightField,
    name: &str,
    y_up: bool,
) -> Result<Figure, asperity_plot::PlotError> {
    let [dx, dy] = field.spacing();
    HeightMapFigure {
        title: name.to_owned(),
        subtitle: format!("{} border", field.border()),
        heights: field.heights(),
        shape: field.shape(),
        spacing: [dy, dx],
        unit: field.unit().symbol().to_owned(),
        y_up,
    }
    .draw()
}

/// height_map, the same in each of the places.
pub(crate) fn height_map(
    places: &[&Place<'_>],
    field: &HeightField,
    name: &str,
) -> Result<(), ReportError> {
    save(
        places,
        "height_map",
        &height_map_figure(field, name, false)?,
    )
}

/// lobes, in_plane_reflected and in_plane_transmitted.
pub(crate) fn lobes_and_curves(place: &Place<'_>, case: &ShownCase<'_>) -> Result<(), ReportError> {
    let transmits = case.case().transmits();
    let spec = case.spec();
    let leaves = |side| side == Side::Reflected || transmits;
    let sides: Vec<Side> = spec.sides().filter(|&side| leaves(side)).collect();
    let mut subtitle = case.subtitle();
    for side in Side::BOTH {
        if leaves(side) && !spec.records(side) {
            subtitle.push_str(&format!("; {side} light not recorded"));
        }
    }
    let series: Vec<Series> = sides
        .iter()
        .flat_map(|&side| series_of(case, side))
        .collect();
    let lobes = PolarLobes {
        title: "Scattered light in the plane of incidence: cosine-weighted BSDF".to_owned(),
        subtitle,
        theta_i_deg: case.incidence().theta_deg(),
        sides: match sides.as_slice() {
            [Side::Reflected] => PlotSides::Reflected,
            [Side::Transmitted] => PlotSides::Transmitted,
            _ => PlotSides::Both,
        },
        flat_reflection_deg: case.flat_direction(Side::Reflected),
        flat_refraction_deg: case.flat_direction(Side::Transmitted),
        series: series.clone(),
    };
    let draw_lobes = || save(&[place], "lobes", &lobes.draw()?);
    let draw_curves = |&side: &Side| {
        let curves = InPlaneCurves {
            title: match side {
                Side::Reflected => {
                    "Reflected light in the plane of incidence: cosine-weighted BSDF"
                }
                Side::Transmitted => {
                    "Transmitted light in the plane of incidence: cosine-weighted BSDF"
                }
            }
            .to_owned(),
            subtitle: case.subtitle(),
            side: plot_side(side),
            flat_direction_deg: case.flat_direction(side),
            least: least_seen(case.outcome, side),
            series: series.clone(),
        };
        save(&[place], &format!("in_plane_{side}"), &curves.draw()?)
    };
    let (lobes, curves) = rayon::join(draw_lobes, || sides.par_iter().try_for_each(draw_curves));
    lobes.and(curves)
}

/// The side as figures name it.
pub(crate) const fn plot_side(side: Side) -> PlotSide {
    match side {
        Side::Reflected => PlotSide::Reflected,
        Side::Transmitted => PlotSide::Transmitted,
    }
}

/// Models in the order of their looks, which new ones at the end leave as they are.
const LOOKS: [&str; 17] = [
    "xu-sun",
    "xu-sun-mc",
    "xu-sun-mc-smith",
    "smith",
    "smith-separable",
    "ggx",
    "ggx-separable",
    "smith-slopes",
    "heitz",
    "heitz-ggx",
    "heitz-polarised",
    "v-cavity",
    "cook-torrance-neumann",
    "cook-torrance-neumann-smith",
    "oren-nayar",
    "hanrahan-krueger",
    "flat-layer",
];

/// Number of a model in figures, which gives it its colour, dashes and marker, whichever models are drawn or known.
fn model_number(name: &str) -> usize {
    let place = LOOKS.iter().position(|known| *known == name);
    place.unwrap_or(LOOKS.len())
}

/// Colour of a model in all figures, as in `#0072B2`.
#[must_use]
pub fn model_colour(name: &str) -> String {
    asperity_plot::model_colour(model_number(name))
}

/// Explicit points, of all recorded light, and of light scattered once or by how often it was scattered
/// inside a medium, and the models' lines, in 1/sr.
fn series_of(case: &ShownCase<'_>, side: Side) -> Vec<Series> {
    let (spec, statistics) = (case.spec(), &case.outcome.statistics);
    let explicit = |name: &str, component: Component| {
        let points = in_plane_points(statistics, side, component);
        let name = format!("explicit, {name}");
        Series::explicit(name, component.place(), plot_side(side), points)
    };
    let seen = |component| statistics.means().flux(side, component) != 0.0;
    let mut series = vec![explicit(&recorded_orders(case.max_order), Component::All)];
    for &component in spec.components() {
        if seen(component) {
            series.push(explicit(&component.label(), component));
        }
    }
    // Without multiple scattering both are the same, and one would hide the other.
    let single_is_all = !seen(Component::Multiple);
    if spec.components().is_empty() && !single_is_all {
        series.push(explicit(&Component::Single.label(), Component::Single));
    }
    for model in case
        .models()
        .iter()
        .filter(|m| m.model.sides().includes(side))
    {
        let (name, judged) = (model.model.name(), model.judged_component());
        let label = match judged.is_of_medium() {
            true => format!("{name}, {}", judged.short_label()),
            false => name.to_owned(),
        };
        let component = match judged {
            Component::Single if single_is_all => 0,
            _ => judged.place(),
        };
        let points = model_points(case, model, side);
        let line = Series::model(label, model_number(name), plot_side(side), points);
        series.push(line.of_component(component));
    }
    series
}

/// The line of a model: its density averaged over a sliding bin where it has one, and its bins otherwise.
fn model_points(case: &ShownCase<'_>, model: &ModelOutcome, side: Side) -> Vec<Point> {
    let density = model.model.density();
    // A histogram of slopes has a jump at every cell, which bins average.
    let Some(density) = density.filter(|density| density.tabulated().is_none()) else {
        let component = match model.model {
            CaseModel::Surface(_) => Component::All,
            CaseModel::Layer(_) => model.judged_component(),
        };
        return model_bins(model, side, component);
    };
    let mut points = density_line(density, case.incidence(), case.spec(), side);
    if model.judged_component() == Component::All {
        let multiple = multiple_line(model, side);
        for point in &mut points {
            point.y += between(&multiple, point.x);
        }
    }
    points
}

/// Expectation of a model for light scattered more often than once, bin by bin.
fn multiple_line(model: &ModelOutcome, side: Side) -> Vec<Point> {
    let [mut all, single] =
        [Component::All, Component::Single].map(|component| model_bins(model, side, component));
    for (all, single) in all.iter_mut().zip(&single) {
        all.y -= single.y;
    }
    all
}

/// The value at an angle between points in the order of their angles; beyond the ends that of the last.
fn between(points: &[Point], theta_deg: f64) -> f64 {
    let after = points.partition_point(|point| point.x < theta_deg);
    match (after.checked_sub(1).map(|i| points[i]), points.get(after)) {
        (Some(a), Some(b)) => a.y + (theta_deg - a.x) / (b.x - a.x) * (b.y - a.y),
        (Some(end), None) => end.y,
        (None, end) => end.map_or(0.0, |end| end.y),
    }
}

/// A model bin by bin. Its line needs no horizontal bars.
fn model_bins(model: &ModelOutcome, side: Side, component: Component) -> Vec<Point> {
    let mut points = in_plane_points(model.expectation.statistics(), side, component);
    for point in &mut points {
        point.x_range = None;
    }
    points
}

/// Cosine-weighted BSDF of a component in the plane of incidence, bin by bin.
pub(crate) fn in_plane_points(
    statistics: &TallyStatistics,
    side: Side,
    component: Component,
) -> Vec<Point> {
    let view = statistics.in_plane(side, component);
    let filter = view.filter();
    let point = |(i, flux): (usize, asperity_tally::Estimate)| {
        let solid_angle = filter.solid_angle(i);
        Point {
            x: mean_angle_deg(filter.theta_deg(i)),
            y: flux.mean / solid_angle,
            se: flux.se.map(|se| se / solid_angle),
            x_range: Some(filter.theta_deg(i)),
        }
    };
    view.iter().enumerate().map(point).collect()
}

/// The least cosine-weighted BSDF in the plane of incidence that rays have shown: that of a bin which a ray at least is expected to
/// have left to, 1/sr; `None` without rays.
pub(crate) fn least_seen(outcome: &Outcome, side: Side) -> Option<f64> {
    let statistics = &outcome.statistics;
    let one_ray = statistics.means().flux(side, Component::All) / outcome.work.rays as f64;
    let view = statistics.in_plane(side, Component::All);
    let seen = view
        .iter()
        .enumerate()
        .filter(|(_, flux)| flux.mean >= one_ray);
    let bsdf = seen.map(|(i, flux)| flux.mean / view.filter().solid_angle(i));
    bsdf.reduce(f64::min)
}

/// Solid angle per azimuth between the normal and a signed angle, radians; negative of negative angles.
fn cap(angle: f64) -> f64 {
    2.0 * sin(0.5 * angle).powi(2) * angle.signum()
}

/// Mean angle to the normal, signed degrees, over the solid angle of a bin of the in-plane slice: the angle to which its mean
/// belongs. Next to the normal it lies well away from the middle of the bin.
pub(crate) fn mean_angle_deg(ends: [f64; 2]) -> f64 {
    let [from, to] = ends.map(f64::to_radians);
    let moment = |angle: f64| sin(angle.abs()) - angle.abs() * cos(angle);
    ((moment(to) - moment(from)) / (cap(to) - cap(from))).to_degrees()
}

/// A model averaged over a bin that slides along the angle: what the points of its bins estimate.
fn density_line(
    model: &dyn BsdfModel,
    incidence: Incidence,
    spec: &TallySpec,
    side: Side,
) -> Vec<Point> {
    sliding_bins(spec, side)
        .into_par_iter()
        .map(|(theta_deg, width)| {
            let from = (theta_deg - 0.5 * width).max(-90.0).to_radians();
            let to = (theta_deg + 0.5 * width).min(90.0).to_radians();
            let half_width = spec.in_plane_half_width();
            let flux = in_plane_flux(model, incidence, half_width, side, [from, to]);
            // The slice's solid angle on both sides of the normal.
            let solid_angle = 2.0 * spec.in_plane_half_width() * (cap(to) - cap(from));
            let ends = [from.to_degrees(), to.to_degrees()];
            Point::exact(mean_angle_deg(ends), flux / solid_angle)
        })
        .collect()
}

/// Places and widths, degrees, of a bin that slides along the signed angle in small steps: of equal bins their width, of others that
/// of the bin in the middle of each and in proportion between them.
fn sliding_bins(spec: &TallySpec, side: Side) -> Vec<(f64, f64)> {
    let filter = spec.in_plane_filter(side);
    if spec.grid().has_equal_angles() {
        let width = 90.0 / spec.grid().n_theta() as f64;
        let steps = (90.0 / LINE_STEP_DEG) as i32;
        let places = (-steps..=steps).map(|i| f64::from(i) * LINE_STEP_DEG);
        return places.map(|theta_deg| (theta_deg, width)).collect();
    }
    let bin = |i: usize| {
        let [from, to] = filter.theta_deg(i);
        (filter.centre_deg(i), to - from)
    };
    let last = filter.len() - 1;
    let places = (0..last).flat_map(|i| {
        let ((a, width_a), (b, width_b)) = (bin(i), bin(i + 1));
        (0..STEPS_PER_BIN).map(move |step| {
            let t = f64::from(step) / f64::from(STEPS_PER_BIN);
            (a + t * (b - a), width_a + t * (width_b - width_a))
        })
    });
    places.chain([bin(last)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_analysis::{FlatLayers, MODEL_NAMES};

    #[test]
    fn every_model_has_a_look_of_its_own() {
        let mut names: Vec<&str> = MODEL_NAMES
            .iter()
            .chain(&FlatLayers::NAMES)
            .copied()
            .collect();
        let mut looks = LOOKS.to_vec();
        names.sort_unstable();
        looks.sort_unstable();
        assert_eq!(names, looks);
    }

    #[test]
    fn bins_stand_at_the_mean_angle_of_their_solid_angle() {
        let near = |ends, expected: f64| (mean_angle_deg(ends) - expected).abs() < 1e-3;
        // Next to the normal the solid angle of a slice grows with the angle: two thirds of the width.
        assert!(near([0.0, 3.0], 2.0) && near([-3.0, 0.0], -2.0));
        assert!(near([-2.0, 2.0], 0.0));
        assert!(near([59.9, 60.1], 60.0));
    }
}
