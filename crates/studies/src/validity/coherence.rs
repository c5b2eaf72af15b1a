//! Coherence: phase and coherent fraction of each component of the light.

use asperity_numerics::elementary::{cos, exp, pow, sin};
use asperity_optics::{Bottom, BottomSurface, Layer, Material};
use asperity_simulate::Case;
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
#[derive(Default)]
pub(super) struct Components {
    /// `None` of a flat first face.
    pub(super) reflected: Option<Coherence>,
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
        let lowest = case.layers.last().and_then(Layer::end);
        let shape = lowest.map_or(BottomSurface::Flat, |end| end.shape);
        let is_same = bottom.is_none() && shape == BottomSurface::Same;
        let bottom = bottom.or((shape != BottomSurface::Flat).then_some(top));
        // In the order in which the light meets them
        let (first, second) = match case.is_turned_over() {
            false => (Some(top), bottom),
            true => (bottom, Some(top)),
        };
        let Some((material, layers)) = case.towards_light() else {
            return Self::default();
        };
        let sigma_of = |face: Option<&SurfaceLengths>| face.map_or(0.0, |face| face.sigma);
        let (sigma, bottom_sigma) = (sigma_of(first), sigma_of(second));
        let fraction = |face: Option<&SurfaceLengths>, per_height: f64| {
            face.map_or(1.0, |face| face.coherent_fraction(k * per_height))
        };
        // Equal indices deflect nothing
        let transmitting = material.transmitting_index();
        let index = transmitting.filter(|&eta| eta != 1.0 || !layers.is_empty());
        let (n_i, n_t) = match (case.light.from, transmitting) {
            // Indices are relative to the medium below
            (HalfSpace::Below, Some(eta)) if layers.is_empty() => (1.0 / eta, index.map(|_| 1.0)),
            (HalfSpace::Below, None) => (1.0, None),
            _ => {
                let above = index_of_light(case);
                (above, index.map(|eta| above * eta))
            }
        };
        let along = n_i * sin(incidence.theta());
        let across = n_i * cos(incidence.theta());
        // n cos(theta) beyond; `None` where all light is reflected
        let beyond = |n: f64| (n > along).then(|| (n * n - along * along).sqrt());
        let of_top = |per_height: f64| fraction(first, per_height);
        let by_top = |per_height: f64| coherence(k * sigma * per_height.abs(), of_top(per_height));
        let mut found = Self {
            reflected: first.map(|_| by_top(2.0 * across)),
            ..Self::default()
        };
        let Some((n_t, inside)) = n_t.and_then(|n| Some((n, beyond(n)?))) else {
            return found;
        };
        let step = inside - across;
        let layer = match layers.as_slice() {
            [] => {
                found.transmitted = Some(by_top(step));
                return found;
            }
            [layer] => layer,
            // Phases behind further faces are not known
            _ => return found,
        };
        let Some(end) = layer.end() else {
            found.transmitted = layer.transmits().then(|| by_top(step));
            return found;
        };
        // The correlation of the phase of light from the first face, where it arrives, with heights of the second
        let of_bottom = |per_height: f64| fraction(second, per_height);
        let shift = end.thickness * along / inside;
        let correlation = |times: f64| {
            top.tau.map_or(1.0, |tau| {
                let shifted = exp(-(times * shift / tau).powi(2));
                // Diffraction: mean of cos(q^2 d / 2 k) over a Gaussian spectrum of wave vectors q
                let spread = 2.0 * times * end.thickness / (k * n_t * tau * tau);
                shifted / (1.0 + spread * spread)
            })
        };
        let common = if is_same { correlation(1.0) } else { 0.0 };
        let is_gaussian = [first, second]
            .iter()
            .flatten()
            .all(|one| one.heights.is_empty());
        let of_both = |square: f64, fraction: f64| {
            let phase = k * square.max(0.0).sqrt();
            // Gaussian heights need no more than their correlation
            coherence(
                phase,
                if is_gaussian {
                    exp(-phase * phase)
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
            bottom => {
                let index = bottom.index_beyond();
                index.and_then(|eta| Some(through(beyond(n_t * eta)? - inside)))
            }
        };
        let reflects = match end.bottom.material() {
            Material::Dielectric { eta } => eta != 1.0,
            Material::Lambertian { .. } => false,
            _ => true,
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

/// Index of the medium that the light comes from, relative to the medium above.
fn index_of_light(case: &Case) -> f64 {
    if !case.is_turned_over() {
        return 1.0;
    }
    let bottoms = case.layers.iter().filter_map(Layer::end);
    let steps = bottoms.filter_map(|end| end.bottom.index_beyond());
    case.material.transmitting_index().unwrap_or(1.0) * steps.product::<f64>()
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
    pow(independent, 1.0 - correlation) * pow(equal, correlation)
}
