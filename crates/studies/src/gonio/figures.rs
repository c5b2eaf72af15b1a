//! The plots of a measurement: a matrix of hemispheres, and for each polar angle its light by component.

use std::borrow::Cow;

use asperity_simulate::{Observer, short};

use asperity_plot::{
    Figure, Hemisphere, Hemispheres, InPlaneCurves, PlotError, Point, ProfileComponent,
    ProfileGrid, Series, SharedColours,
};
use asperity_surface::LengthUnit;
use asperity_tally::{Component, Side, TallySpec, is_of_few_rays};
use rayon::prelude::*;

use super::components::{component_names, components as components_of};
use super::config::PlotScale;
use super::distinction::Distinction;
use super::distinction::labelled;
use super::outcome::{Direction, GonioOutcome};
use super::sample::Sample;
use super::tables::projected_in_plane;
use crate::output::{Place, over, projected_solid_angle};
use crate::report::disc_bins::{disc_bins, disc_edges};
use crate::report::effort::effort;
use crate::report::error::ReportError;
use crate::report::figures::{least_seen, mean_angle_deg, plot_side, save_unless};

/// Rows of a matrix.
#[derive(Clone, Copy)]
enum Rows {
    Thetas,
    Phis,
}

/// Names of all plots, of which some may show nothing and are not drawn.
pub(super) fn names(spec: &TallySpec, thetas: &[f64]) -> Vec<String> {
    let of_side = |side: Side| {
        let of_theta = move |theta: &f64| {
            let theta = short(*theta);
            ["components", "profiles", "lobe"].map(|kind| format!("{kind}_theta{theta}_{side}"))
        };
        let matrix = std::iter::once(format!("matrix_{side}"));
        matrix.chain(thetas.iter().flat_map(of_theta))
    };
    spec.sides().flat_map(of_side).collect()
}

/// Draws all plots into `plots` until the run gives up, and returns the number of those that are left out.
pub(super) fn draw(
    plots: &Place<'_>,
    outcome: &GonioOutcome,
    observer: &dyn Observer,
) -> Result<usize, ReportError> {
    let shown: Vec<Side> = outcome
        .spec()
        .sides()
        .filter(|&side| outcome.directions().any(|one| leaves(&one, side)))
        .collect();
    type Job<'a> = (
        String,
        Box<dyn Fn() -> Result<Figure, PlotError> + Send + Sync + 'a>,
    );
    let mut jobs: Vec<Job<'_>> = Vec::new();
    for side in shown {
        let matrix = move || matrix(outcome, side).draw();
        jobs.push((format!("matrix_{side}"), Box::new(matrix)));
        for (number, theta) in outcome.thetas.iter().enumerate() {
            let any = |setting| outcome.direction(setting, number, 0).outcome.is_some();
            if !(0..outcome.settings().len()).any(any) {
                continue;
            }
            let theta = short(*theta);
            let components = move || components(outcome, side, number).draw();
            jobs.push((
                format!("components_theta{theta}_{side}"),
                Box::new(components),
            ));
            let profiles = move || profiles(outcome, side, number).draw();
            jobs.push((format!("profiles_theta{theta}_{side}"), Box::new(profiles)));
            let lobe = move || lobe(outcome, side, number).draw();
            jobs.push((format!("lobe_theta{theta}_{side}"), Box::new(lobe)));
        }
    }
    jobs.into_par_iter()
        .map(|(name, figure)| save_unless(observer, &[plots], &name, || figure().map(Some)))
        .try_reduce(|| 0, |a, b| Ok(a + b))
}

/// Returns `true` if any light of a direction left on `side`.
fn leaves(direction: &Direction<'_>, side: Side) -> bool {
    let flux = direction.flux(Component::All, side);
    flux.is_some_and(|flux| flux.estimate().mean != 0.0)
}

pub(super) fn quantity(side: Side) -> &'static str {
    match side {
        Side::Reflected => "BRDF",
        Side::Transmitted => "BTDF",
    }
}

/// Description that all discs share.
fn subtitle(outcome: &GonioOutcome, more: &str) -> String {
    let name = outcome.sample.map(|sample| sample.name.clone());
    let common = Distinction::of(outcome.settings()).common;
    let work = outcome
        .directions()
        .filter_map(|one| Some(&one.outcome?.work));
    let work = work.map(|work| [work.realisations, work.rays]);
    let effort = effort(work, " per direction", outcome.config.run.seed);
    // Terrain has compass directions.
    let is_terrain =
        |sample: &&Sample| matches!(sample.unit, LengthUnit::Metre | LengthUnit::Kilometre);
    let compass = outcome
        .sample
        .filter(is_terrain)
        .map(|sample| match sample.y_is_north {
            true => "azimuth 0° is east, 90° north".to_owned(),
            false => "azimuth 0° is east, 90° south".to_owned(),
        });
    let words = name.into_iter().chain([common, effort, more.to_owned()]);
    let words = words.chain(compass);
    words
        .filter(|w| !w.is_empty())
        .collect::<Vec<_>>()
        .join("; ")
}

/// Names of the columns: the settings, told apart.
fn columns(outcome: &GonioOutcome) -> (String, Vec<String>) {
    let Distinction { title, labels, .. } = Distinction::of(outcome.settings());
    // A letter alone is no heading.
    let title = match title.as_str() {
        "s" => "smoothness s".to_owned(),
        "n" => "refractive index n".to_owned(),
        "g" => "mean cosine of scattering g".to_owned(),
        _ => title,
    };
    (title, labels)
}

fn matrix(outcome: &GonioOutcome, side: Side) -> Hemispheres {
    let rows = match (outcome.thetas.len(), outcome.phis.len()) {
        (1, several) if several > 1 => Rows::Phis,
        _ => Rows::Thetas,
    };
    let (row_title, angles, more) = match rows {
        Rows::Phis => (
            "azimuth of the light φᵢ",
            &outcome.phis,
            format!("θᵢ = {}°", short(outcome.thetas[0])),
        ),
        Rows::Thetas if outcome.phis.len() > 1 => (
            "angle of incidence θᵢ",
            &outcome.thetas,
            format!("φᵢ = {}°", short(outcome.phis[0])),
        ),
        Rows::Thetas => ("angle of incidence θᵢ", &outcome.thetas, String::new()),
    };
    let (column_title, columns) = columns(outcome);
    let cells = (0..angles.len()).flat_map(|row| {
        (0..columns.len()).map(move |setting| {
            let direction = match rows {
                Rows::Thetas => outcome.direction(setting, row, 0),
                Rows::Phis => outcome.direction(setting, 0, row),
            };
            hemisphere(&direction, side, Component::All)
        })
    });
    let (what, letter) = match side {
        Side::Reflected => ("Reflected light by angle of incidence", "R"),
        Side::Transmitted => ("Transmitted light by angle of incidence", "T"),
    };
    Hemispheres {
        title: what.to_owned(),
        subtitle: subtitle(
            outcome,
            &[
                more,
                format!("{letter}: fraction of the incident light that leaves on this side"),
            ]
            .into_iter()
            .filter(|w| !w.is_empty())
            .collect::<Vec<_>>()
            .join("; "),
        ),
        quantity: quantity(side).to_owned(),
        side: plot_side(side),
        row_title: row_title.to_owned(),
        column_title,
        rows: angles
            .iter()
            .map(|angle| format!("{}°", short(*angle)))
            .collect(),
        colours: match outcome.config.output.scale {
            PlotScale::Common => SharedColours::Common,
            PlotScale::Rows => SharedColours::Rows,
        },
        cells: cells.collect(),
        columns,
    }
}

fn components(outcome: &GonioOutcome, side: Side, theta: usize) -> Hemispheres {
    let (column_title, columns) = columns(outcome);
    let cells = components_of(outcome.spec()).flat_map(|component| {
        (0..columns.len())
            .map(move |setting| hemisphere(&outcome.direction(setting, theta, 0), side, component))
    });
    Hemispheres {
        title: format!(
            "{} light by component, θᵢ = {}°",
            word(side),
            short(outcome.thetas[theta])
        ),
        subtitle: subtitle(outcome, meaning(outcome.spec())),
        quantity: quantity(side).to_owned(),
        side: plot_side(side),
        row_title: String::new(),
        column_title,
        rows: component_names(outcome.spec())
            .into_iter()
            .map(Cow::into_owned)
            .collect(),
        colours: SharedColours::Rows,
        cells: cells.collect(),
        columns,
    }
}

fn profiles(outcome: &GonioOutcome, side: Side, theta: usize) -> ProfileGrid {
    let spec = outcome.spec();
    let Distinction { title, labels, .. } = Distinction::of(outcome.settings());
    let points = |component: Component, setting: usize| -> Vec<Point> {
        let direction = outcome.direction(setting, theta, 0);
        let spec = &direction.spec;
        let point = |i: usize| {
            let flux = direction.in_plane(component, side, i)?;
            let bsdf = over(flux, projected_in_plane(spec, side, i));
            let angle = mean_angle_deg(spec.in_plane_filter(side).theta_deg(i));
            Some(Point::with_error(angle, bsdf.mean, bsdf.se))
        };
        (0..spec.in_plane_len()).filter_map(point).collect()
    };
    let incidence = outcome.direction(0, theta, 0).case.light.incidence;
    // Retroreflection exists only on the side of incidence; a medium has no straight continuation.
    let (light_deg, mirror_deg) = match side {
        Side::Reflected => (Some(-incidence.theta_deg()), Some(incidence.theta_deg())),
        Side::Transmitted => (None, None),
    };
    ProfileGrid {
        title: format!(
            "{} light in the plane of incidence, θᵢ = {}°",
            word(side),
            short(outcome.thetas[theta])
        ),
        subtitle: subtitle(outcome, meaning(spec)),
        quantity: quantity(side).to_owned(),
        panels: labels.iter().map(|label| labelled(&title, label)).collect(),
        light_deg,
        mirror_deg,
        components: components_of(spec)
            .map(|component| ProfileComponent {
                name: component.name().into_owned(),
                points: (0..labels.len())
                    .map(|setting| points(component, setting))
                    .collect(),
            })
            .collect(),
    }
}

/// All light in the plane of incidence: linear about the peak, and logarithmic.
fn lobe(outcome: &GonioOutcome, side: Side, theta: usize) -> InPlaneCurves {
    let Distinction { title, labels, .. } = Distinction::of(outcome.settings());
    let series = labels.iter().enumerate().map(|(setting, label)| {
        let direction = outcome.direction(setting, theta, 0);
        let filter = direction.spec.in_plane_filter(side);
        let point = |i: usize| {
            let flux = direction.in_plane(Component::All, side, i)?;
            let weighted = over(flux, filter.solid_angle(i));
            Some(Point {
                x_range: Some(filter.theta_deg(i)),
                ..Point::with_error(
                    mean_angle_deg(filter.theta_deg(i)),
                    weighted.mean,
                    weighted.se,
                )
            })
        };
        let name = match label.is_empty() {
            true => "all light".to_owned(),
            false => labelled(&title, label),
        };
        let points = (0..filter.len()).filter_map(point).collect();
        Series::explicit(name, setting, plot_side(side), points)
    });
    let lobes = outcome.direction(0, theta, 0).lobes();
    InPlaneCurves {
        title: format!(
            "{} light in the plane of incidence, θᵢ = {}°: cosine-weighted BSDF",
            word(side),
            short(outcome.thetas[theta])
        ),
        subtitle: subtitle(outcome, ""),
        side: plot_side(side),
        flat_direction_deg: lobes.iter().find_map(|lobe| lobe.angle_to_normal_deg(side)),
        least: (0..labels.len())
            .filter_map(|setting| least_seen(outcome.direction(setting, theta, 0).outcome?, side))
            .reduce(f64::min),
        series: series.collect(),
    }
}

fn word(side: Side) -> &'static str {
    match side {
        Side::Reflected => "Reflected",
        Side::Transmitted => "Transmitted",
    }
}

/// Meanings of the names of components.
fn meaning(spec: &TallySpec) -> &'static str {
    if spec.has_medium() {
        "components by number of scattering events inside the medium"
    } else {
        "components by number of interactions with the surface"
    }
}

/// The BSDF of one component of one direction, ring by ring from the normal of `side`.
fn hemisphere(direction: &Direction<'_>, side: Side, component: Component) -> Option<Hemisphere> {
    let spec = &direction.spec;
    let bsdf = |bin| {
        let flux = direction.bin(component, bin)?;
        Some(flux.mean / projected_solid_angle(&spec.grid(), bin))
    };
    let fraction = direction.flux(component, side)?.estimate().mean;
    let letter = match side {
        Side::Reflected => "R",
        Side::Transmitted => "T",
    };
    let incidence = direction.case.light.incidence;
    Some(Hemisphere {
        bins: disc_edges(spec, side),
        values: disc_bins(spec, side)
            .map(|bin| bsdf(bin).map(Some))
            .collect::<Option<_>>()?,
        few_rays: (disc_bins(spec, side).enumerate())
            .filter(|(_, bin)| direction.bin(component, *bin).is_some_and(is_of_few_rays))
            .map(|(place, _)| place)
            .collect(),
        light_deg: (!incidence.is_vertical()).then(|| incidence.phi_deg()),
        note: format!("{letter} = {}", percent(fraction)),
    })
}

/// A fraction of the light, to three digits.
fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    let digits = if percent.abs() >= 10.0 { 1 } else { 2 };
    format!("{percent:.digits$} %")
}
