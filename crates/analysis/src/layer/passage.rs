//! Passage: light of one direction outside, on its way through the faces of flat layers.
//!
//! Light of one direction reaches every layer in one direction and its mirror image. Reflectances of what lies beyond a
//! face follow from the far end, face by face, and the fluxes in the layers then from the near end. A face reflects `r`, from
//! its far side `r'`, and transmits `t`; behind it lies a layer of transmittance `a = exp(-tau / mu)`, behind which all reflects
//! `R_beyond`:
//!
//! ```text
//! x = a^2 R_beyond,  o = 1 - r' x
//! R = r + t^2 x / o                reflectance of the face and all beyond
//! D = t / o,  U = D a R_beyond     in the layer, per flux on the face: behind it, and back from the next
//! ```

use std::ops::Range;

use asperity_numerics::elementary::{exp, exp_m1};
use asperity_optics::{Material, PhaseFunction};
use asperity_tally::Side;
use glam::DVec3;

use super::depth::{against, along};
use super::flat_layers::{FlatLayers, LayerPaths};

/// Fractions of the light that meets a face, from the side of the passage or from the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceFractions {
    pub(super) reflected: f64,
    pub(super) transmitted: f64,
    absorbed: f64,
}

/// A face, as a passage meets it.
#[derive(Clone, Copy, Debug)]
pub(super) struct MetFace {
    pub(super) near: FaceFractions,
    /// For light on its way back.
    pub(super) far: FaceFractions,
}

/// Light in one layer, per flux outside; all zero where it does not get.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Inside {
    /// Cosine of the angle to the normal.
    pub(super) mu: f64,
    /// Flux that goes down, below the upper face.
    pub(super) down: f64,
    /// Flux that goes up, above the lower face.
    pub(super) up: f64,
}

impl Inside {
    /// Transmittance of a layer of optical thickness `tau`.
    pub(super) fn attenuation(&self, tau: f64) -> f64 {
        exp(-tau / self.mu)
    }
}

/// Light from one direction outside; of light that leaves, the reversed path.
#[derive(Clone, Debug)]
pub(super) struct Passage {
    /// Faces in the order in which they are met, up to the first that lets none through.
    pub(super) faces: Vec<MetFace>,
    /// Light in every layer, from above.
    pub(super) layers: Vec<Inside>,
    /// Fraction that leaves where it came from.
    pub(super) reflected: f64,
    /// Fraction that leaves on the other side.
    pub(super) transmitted: f64,
    /// Cosine there, if any leaves.
    pub(super) mu_beyond: Option<f64>,
}

impl MetFace {
    /// A face met at the cosine `mu`, and the cosine behind it if it lets light through.
    fn new(material: Material, mu: f64) -> (Self, Option<f64>) {
        let fractions = |material: Material, mu| {
            let fresnel = material.fresnel(mu);
            let transmits = material.transmitting_index().is_some();
            let fractions = FaceFractions {
                reflected: fresnel.reflected,
                transmitted: if transmits { fresnel.transmitted } else { 0.0 },
                absorbed: material.absorbed(&fresnel),
            };
            (fractions, fresnel.cos_theta_t)
        };
        let (mut near, mu_behind) = fractions(material, mu);
        let mu_behind = Some(mu_behind).filter(|mu| near.transmitted > 0.0 && *mu > 0.0);
        if mu_behind.is_none() {
            near.transmitted = 0.0;
        }
        let far = match mu_behind {
            // Without absorption both sides reflect alike (Stokes)
            Some(mu) if near.absorbed > 0.0 => FaceFractions {
                transmitted: near.transmitted,
                ..fractions(material.reversed(), mu).0
            },
            _ => near,
        };
        (Self { near, far }, mu_behind)
    }
}

impl Passage {
    /// Light outside on `side` at the cosine `c > 0`.
    pub(super) fn new(stack: &FlatLayers, side: Side, c: f64) -> Self {
        let n = stack.media.len();
        let from_above = side == Side::Reflected;
        let number = |i| if from_above { i } else { n - 1 - i };

        // Follow the direction from face to face
        let mut faces = Vec::with_capacity(n + 1);
        let mut layers = vec![Inside::default(); n];
        let mut mu = Some(c.min(1.0));
        for i in 0..=n {
            let Some(c) = mu else { break };
            let face = match from_above {
                true => stack.faces[i],
                false => stack.faces[n - i].reversed(),
            };
            let (face, behind) = MetFace::new(face, c);
            faces.push(face);
            mu = behind;
            if let (true, Some(mu)) = (i < n, mu) {
                layers[number(i)].mu = mu;
            }
        }

        // Add the layers up from the far end: what is reflected of the light that meets a face, and what is not
        let last = faces[faces.len() - 1];
        let mut reflected = last.near.reflected;
        let mut lost = last.near.transmitted + last.near.absorbed;
        let mut entering = vec![(0.0, 0.0); faces.len() - 1];
        for (i, entering) in entering.iter_mut().enumerate().rev() {
            let MetFace { near, far } = faces[i];
            if stack.paths == LayerPaths::HanrahanKrueger {
                *entering = (near.transmitted, 0.0);
                reflected = near.reflected;
                continue;
            }
            let path = stack.media[number(i)].tau / layers[number(i)].mu;
            let returned = reflected * exp(-2.0 * path);
            // One less it, without cancellation where little is lost
            let kept = lost - reflected * exp_m1(-2.0 * path);
            let series = far.transmitted + far.absorbed + far.reflected * kept;
            let passes = near.transmitted / series;
            *entering = (passes, reflected * exp(-path));
            reflected = near.reflected + near.transmitted * passes * returned;
            lost = near.absorbed + passes * (kept + far.absorbed * returned);
        }

        // Let the light in from the near end
        let mut flux = 1.0;
        for (i, (passes, back)) in entering.into_iter().enumerate() {
            let layer = &mut layers[number(i)];
            flux *= passes;
            [layer.down, layer.up] = match from_above {
                true => [flux, flux * back],
                false => [flux * back, flux],
            };
            flux *= layer.attenuation(stack.media[number(i)].tau);
        }
        let reaches_end = faces.len() == n + 1;
        Self {
            transmitted: if reaches_end {
                flux * faces[n].near.transmitted
            } else {
                0.0
            },
            mu_beyond: mu.filter(|_| reaches_end),
            reflected,
            faces,
            layers,
        }
    }

    /// Incident light from `wi` with `z > 0`.
    pub(super) fn of_incident(stack: &FlatLayers, wi: DVec3) -> Self {
        Self::new(stack, Side::Reflected, wi.z)
    }
}

/// Light scattered once that leaves in directions of one polar angle, by the layers that scatter it.
#[derive(Clone, Debug, Default)]
pub(super) struct Leaving {
    layers: Vec<LeavingLayer>,
}

/// Light of one layer.
#[derive(Clone, Copy, Debug)]
struct LeavingLayer {
    phase: PhaseFunction,
    /// Product of the horizontal components inside, before and after scattering, over those outside.
    horizontal: f64,
    /// Product of the cosines inside.
    vertical: f64,
    /// Factor of the phase function from down to up and from up to down.
    turned: f64,
    /// Factor of the phase function from down to down and from up to up.
    kept: f64,
}

impl FlatLayers {
    /// Light scattered in layers of these numbers that leaves on `side` at the cosine `c > 0` outside.
    pub(super) fn leave(
        &self,
        incident: &Passage,
        numbers: Range<usize>,
        side: Side,
        c: f64,
    ) -> Leaving {
        let index_outside = match side {
            Side::Reflected => Some(1.0),
            Side::Transmitted => self.index_beyond(),
        };
        let Some(index_outside) = index_outside else {
            return Leaving::default();
        };
        let leaving = Passage::new(self, side, c);
        let of_layer = |number: usize| {
            let medium = &self.media[number];
            let [before, after] = [incident, &leaving].map(|passage| passage.layers[number]);
            let is_dark = [before, after]
                .iter()
                .any(|light| light.down + light.up == 0.0);
            if medium.albedo == 0.0 || is_dark {
                return None;
            }
            let index = self.indices[number + 1];
            let ratio = index_outside / index;
            let scale = medium.albedo * ratio * ratio;
            // The reversed path that goes down is light that goes up
            let turned = before.down * after.down + before.up * after.up;
            let kept = before.down * after.up + before.up * after.down;
            Some(LeavingLayer {
                phase: medium.phase,
                horizontal: ratio / index,
                vertical: before.mu * after.mu,
                turned: scale * against(medium.tau, before.mu, after.mu) * turned,
                kept: scale * along(medium.tau, before.mu, after.mu) * kept,
            })
        };
        Leaving {
            layers: numbers.filter_map(of_layer).collect(),
        }
    }
}

impl Leaving {
    /// Returns `true` if no light leaves.
    pub(super) fn is_dark(&self) -> bool {
        self.layers.is_empty()
    }

    /// Returns `true` if it is the same at all azimuths.
    pub(super) fn is_isotropic(&self) -> bool {
        let mut layers = self.layers.iter();
        layers.all(|layer| layer.phase == PhaseFunction::Isotropic)
    }

    /// The BSDF, given the product `h` of the horizontal components outside.
    pub(super) fn bsdf(&self, h: f64) -> f64 {
        self.layers.iter().map(|layer| layer.bsdf(h)).sum()
    }
}

impl LeavingLayer {
    fn bsdf(&self, h: f64) -> f64 {
        let (h, z) = (self.horizontal * h, self.vertical);
        let p = |cos: f64| self.phase.density(cos.clamp(-1.0, 1.0));
        let mut f = 0.0;
        // Skip phase functions without light
        if self.turned > 0.0 {
            f += self.turned * p(h - z);
        }
        if self.kept > 0.0 {
            f += self.kept * p(h + z);
        }
        f
    }
}
