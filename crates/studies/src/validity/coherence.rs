//! Coherence: phase and coherent fraction of each component of the light.

use asperity_optics::Bottom;
use asperity_simulate::{BottomSurface, Case};
use asperity_tracer::HalfSpace;
use serde::Serialize;

use crate::surface_lengths::SurfaceLengths;

/// Value from which on numbers say nothing more, as those of terrain in light.
pub(super) const BEYOND_DOUBT: f64 = 1e4;

/// Phase of a component of the light, and as much of it as stays coherent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coherence {
    /// Root mean square phase difference of light from different points, radians.
    pub phase_parameter: f64,
    /// Fraction of the component that stays coherent: `exp(-phase^2)` of a Gaussian surface, and that of the heights of any other.
    pub coherent_fraction: f64,
}

/// Coherence of light from different points of a surface, by component.
pub(super) struct Components {
    pub(super) reflected: Coherence,
    pub(super) transmitted: Option<Coherence>,
    pub(super) by_bottom: Option<Coherence>,
}

impl Components {
    /// `k`: wave number in the medium above.
    pub(super) fn of(
        top: &SurfaceLengths,
        bottom: Option<&SurfaceLengths>,
        case: &Case,
        k: f64,
    ) -> Self {
        let incidence = case.light.incidence;
        let sigma = top.sigma;
        // Equal indices deflect nothing
        let transmitting = case.material.transmitting_index();
        let index = transmitting.filter(|&eta| eta != 1.0 || case.layer.is_some());
        let (n_i, n_t) = match (case.light.from, transmitting) {
            (HalfSpace::Above, _) => (1.0, index),
            // Indices are relative to the medium below
            (HalfSpace::Below, Some(eta)) => (1.0 / eta, index.map(|_| 1.0)),
            (HalfSpace::Below, None) => (1.0, None),
        };
        let along = n_i * incidence.theta().sin();
        let across = n_i * incidence.theta().cos();
        // n cos(theta) beyond; `None` where all light is reflected
        let beyond = |n: f64| (n > along).then(|| (n * n - along * along).sqrt());
        let of_top = |per_height: f64| top.coherent_fraction(k * per_height);
        let by_top = |per_height: f64| coherence(k * sigma * per_height.abs(), of_top(per_height));
        let mut found = Self {
            reflected: by_top(2.0 * across),
            transmitted: None,
            by_bottom: None,
        };
        let Some((n_t, inside)) = n_t.and_then(|n| Some((n, beyond(n)?))) else {
            return found;
        };
        let step = inside - across;
        let Some(below) = case.layer else {
            found.transmitted = Some(by_top(step));
            return found;
        };
        let Some(end) = below.layer.end() else {
            found.transmitted = below.layer.transmits().then(|| by_top(step));
            return found;
        };
        // The bottom, and the correlation of its heights with those above where light arrives
        let is_same = bottom.is_none() && below.bottom == BottomSurface::Same;
        let bottom = bottom.or((below.bottom != BottomSurface::Flat).then_some(top));
        let bottom_sigma = bottom.map_or(0.0, |bottom| bottom.sigma);
        let of_bottom =
            |per_height: f64| bottom.map_or(1.0, |bottom| bottom.coherent_fraction(k * per_height));
        let shift = end.thickness * along / inside;
        let correlation = |times: f64| {
            let tau = top.tau.filter(|_| shift > 0.0);
            tau.map_or(1.0, |tau| (-(times * shift / tau).powi(2)).exp())
        };
        let common = if is_same { correlation(1.0) } else { 0.0 };
        let is_gaussian = [Some(top), bottom]
            .iter()
            .flatten()
            .all(|one| one.heights.is_empty());
        let of_both = |square: f64, fraction: f64| {
            let phase = k * square.max(0.0).sqrt();
            // Gaussian heights need no more than their correlation
            coherence(
                phase,
                if is_gaussian {
                    (-phase * phase).exp()
                } else {
                    fraction
                },
            )
        };
        let through = |second: f64| {
            let squares = (sigma * step).powi(2) + (bottom_sigma * second).powi(2);
            of_both(
                squares + 2.0 * common * sigma * step * bottom_sigma * second,
                between(
                    of_top(step) * of_bottom(second),
                    of_top(step + second),
                    common,
                ),
            )
        };
        found.transmitted = match end.bottom {
            Bottom::Open => Some(by_top(step)),
            Bottom::Interface { eta } => beyond(n_t * eta).map(|out| through(out - inside)),
            _ => None,
        };
        let reflects = match end.bottom {
            Bottom::Mirror => true,
            Bottom::Interface { eta } => eta != 1.0,
            _ => false,
        };
        found.by_bottom = reflects.then(|| {
            let twice = (sigma * step).powi(2) * (2.0 + 2.0 * correlation(2.0));
            let by_bottom = (2.0 * inside * bottom_sigma).powi(2);
            let of_twice = between(of_top(step).powi(2), of_top(2.0 * step), correlation(2.0));
            of_both(
                twice + by_bottom - 8.0 * common * sigma * step * inside * bottom_sigma,
                between(
                    of_twice * of_bottom(2.0 * inside),
                    of_top(2.0 * (step - inside)),
                    common,
                ),
            )
        });
        found
    }
}

/// A component of this root mean square phase. No heights are known to a fraction of a wavelength that is so much smaller.
fn coherence(phase: f64, fraction: f64) -> Coherence {
    Coherence {
        phase_parameter: phase,
        coherent_fraction: if phase > BEYOND_DOUBT { 0.0 } else { fraction },
    }
}

/// Coherent fraction of light that meets two heights of this correlation, by those of independent and of equal heights; exact for
/// Gaussian ones.
fn between(independent: f64, equal: f64, correlation: f64) -> f64 {
    independent.powf(1.0 - correlation) * equal.powf(correlation)
}
