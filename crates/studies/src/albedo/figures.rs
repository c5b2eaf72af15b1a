//! Figures: albedos over the cosine of incidence, a curve per roughness, next to single scattering.

use asperity_plot::{Colour, Curve, CurveAxis, Curves, Figure, Point, Style};
use asperity_simulate::short;
use asperity_tally::{Estimate, Side};

use super::config::AlbedoSlopes;
use super::outcome::{AlbedoOutcome, AlbedoPoint};
use crate::report::effort::effort;
use crate::report::error::ReportError;

/// Quantity plotted.
#[derive(Clone, Copy)]
pub(super) enum ShownLight {
    /// Reflected light.
    Reflected,
    /// Reflected and transmitted light together.
    Both,
}

impl ShownLight {
    /// All.
    pub(super) const ALL: [Self; 2] = [Self::Reflected, Self::Both];

    /// Name of its figure of a material, which is numbered if there are several.
    pub(super) fn name(self, material: usize, materials: usize) -> String {
        let name = match self {
            Self::Reflected => "reflected",
            Self::Both => "total",
        };
        match materials {
            1 => name.to_owned(),
            _ => format!("{name}_{material}"),
        }
    }

    const fn sides(self) -> &'static [Side] {
        match self {
            Self::Reflected => &[Side::Reflected],
            Self::Both => &Side::BOTH,
        }
    }

    /// The light of all orders. Errors of both sides add at most.
    fn all(self, point: &AlbedoPoint<'_>) -> Option<Estimate> {
        let mut fluxes = self.sides().iter().map(|side| point.flux(*side));
        let first = fluxes.next()??;
        fluxes.try_fold(first, |sum, flux| {
            let flux = flux?;
            Some(Estimate {
                mean: sum.mean + flux.mean,
                se: sum.se.zip(flux.se).map(|(a, b)| a + b),
            })
        })
    }

    fn single(self, point: &AlbedoPoint<'_>) -> f64 {
        self.sides().iter().map(|side| point.single(*side)).sum()
    }
}

/// The figure of a material; `None` where nothing is transmitted and both sides are to be shown.
pub(super) fn figure(
    outcome: &AlbedoOutcome<'_>,
    material: usize,
    light: ShownLight,
) -> Result<Option<Figure>, ReportError> {
    if light.sides().len() > outcome.sides(material).len() {
        return Ok(None);
    }
    let axes = outcome.axes;
    let mut by_cosine: Vec<usize> = (0..axes.cosines.len()).collect();
    by_cosine.sort_by(|&a, &b| axes.cosines[a].total_cmp(&axes.cosines[b]));
    let last = (axes.alphas.len() - 1).max(1) as f64;
    let curves = axes.alphas.iter().enumerate().flat_map(|(i, alpha)| {
        let colour = Colour::Ramp(i as f64 / last);
        let points: Vec<AlbedoPoint<'_>> = by_cosine
            .iter()
            .map(|&cos| outcome.point(material, i, cos))
            .collect();
        let all = points.iter().filter_map(|point| {
            let flux = light.all(point)?;
            Some(Point::with_error(point.cos, flux.mean, flux.se))
        });
        let single = points
            .iter()
            .map(|point| Point::exact(point.cos, light.single(point)));
        [
            Curve {
                name: String::new(),
                colour,
                style: Style::Line(1),
                points: single.collect(),
            },
            Curve {
                name: format!("α = {}", short(*alpha)),
                colour,
                style: Style::Joined(0),
                points: all.collect(),
            },
        ]
    });
    let work = outcome
        .points()
        .filter_map(|point| Some(&point.outcome?.work));
    let work = work.map(|work| [work.realisations, work.rays]);
    let work: Vec<[u64; 2]> = work.collect();
    let slopes = match outcome.config.albedo.slopes {
        AlbedoSlopes::Gaussian => "Gaussian slopes",
        AlbedoSlopes::Ggx => "GGX slopes",
    };
    let figure = Curves {
        title: match light {
            ShownLight::Reflected => "Directional albedo, reflected".to_owned(),
            ShownLight::Both => "Directional albedo, reflected and transmitted".to_owned(),
        },
        subtitle: format!(
            "{}, {slopes}; {}",
            outcome.material(material),
            effort(work.into_iter(), " per point", outcome.config.run.seed)
        ),
        x: CurveAxis {
            label: "cosine of incidence".to_owned(),
            range: Some([0.0, 1.0]),
        },
        y: CurveAxis {
            label: "fraction of the incident light".to_owned(),
            range: None,
        },
        log_from: None,
        curves: curves.collect(),
        notes: vec![
            "Points: all orders, explicit surfaces.".to_owned(),
            "Dashed: single scattering, Smith's model.".to_owned(),
        ],
    };
    Ok(Some(figure.draw()?))
}
