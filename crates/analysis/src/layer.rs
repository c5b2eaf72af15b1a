//! Flat layer: a medium between flat faces, with light that is unscattered inside and light scattered once.
//!
//! A face of relative index `eta` on top, a homogeneous medium of optical thickness `tau = sigma_t d` (or
//! infinite), and a bottom that is open, an interface, a mirror or absorbing. Reflection at flat faces keeps the
//! angle of light, so the inner reflections of one direction are a geometric series, and single scattering has a
//! closed form. Two models differ in the paths that count: see [`LayerPaths`].
//!
//! # Equations
//! Inside the layer `mu_i` and `mu` are the cosines before and after scattering, `R1` and `R2` the
//! reflectances of top and bottom seen from within, `T1 = 1 - R1(mu_i)`, `a = exp(-tau / mu_i)`, `b =
//! exp(-tau / mu)`. Per incident flux, unscattered light goes down with `D exp(-t / mu_i)` and up with
//! `U exp(-(tau - t) / mu_i)` at the optical depth `t`:
//!
//! ```text
//! D = T1 / (1 - R1 R2 a^2),    U = D R2 a
//! ```
//!
//! The fraction `albedo p(cos) dt / mu_i` of either is scattered, by `cos- = h - mu_i mu` from down to up or back,
//! `cos+ = h + mu_i mu` from down to down and up to up, `h` the product of the horizontal components. Over
//! all depths,
//!
//! ```text
//! A = int exp(-t / mu_i) exp(-t / mu) dt,    B = int exp(-t / mu_i) exp(-(tau - t) / mu) dt
//! f_r = albedo / eta^2 (1 - R1) / (1 - R1 R2 b^2) [p- A (D + U R2 b) + p+ B (U + D R2 b)] / (mu_i mu)
//! f_t = albedo eta_3^2 (1 - R2) / (1 - R1 R2 b^2) [p+ B (D + U R1 b) + p- A (U + D R1 b)] / (mu_i mu)
//! ```
//!
//! with `eta_3 = n_3 / n_2`: solid angles change by `n^2 cos` from within to without, radiance by `n^2`.
//!
//! # Source
//! Hanrahan and Krueger 1993, Reflection from Layered Surfaces due to Subsurface Scattering, Eqs. 18 to 21
//! and the first-order transmitted radiance of the same section: these are the terms without `R2 a`, `R2 b`
//! and `R1 b`. They are written for radiances and in angles within the layer; the `1 / eta^2` of `f_r` is
//! that of the solid angle of the beam, which narrows as it enters. The series are those of any plate.

mod depth;
mod expectation;
mod faces;
mod range;

use asperity_optics::{
    Bottom, Fresnel, Layer, Material, MaterialError, PhaseFunction, azimuth, dielectric,
    polar_angle,
};
use asperity_tally::{Side, Sides};
use glam::DVec3;
use serde::Serialize;

use faces::Inside;

/// The paths through a layer that a model accounts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LayerPaths {
    /// Paths of the paper, without inner reflection. Unscattered light is reflected at the top or passes both
    /// faces. Light scattered once passes a face on its way in and a face on its way out, and meets none between.
    HanrahanKrueger,
    /// All paths of unscattered light and of light scattered once, with all inner reflections.
    All,
}

impl LayerPaths {
    /// Both, in the order of [`FlatLayer::NAMES`].
    pub const ALL: [Self; 2] = [Self::HanrahanKrueger, Self::All];

    /// The name under which [`FlatLayer::by_name`] knows the model.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::HanrahanKrueger => "hanrahan-krueger",
            Self::All => "flat-layer",
        }
    }

    /// One line about the model and its source.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::HanrahanKrueger => {
                "flat layer, unscattered light and single scattering inside, no reflection at inner faces (Hanrahan and Krueger 1993, Eqs. 18 to 21)"
            }
            Self::All => {
                "flat layer, unscattered light and single scattering inside, all reflections at its faces"
            }
        }
    }

    /// One sentence on where the model is meant to hold, and what it leaves out.
    #[must_use]
    pub const fn valid_range(self) -> &'static str {
        match self {
            Self::HanrahanKrueger => {
                "flat faces, thin or absorbing media; all of light scattered once over half spaces and absorbing bottoms, elsewhere without what inner faces reflect; no mirror or Lambertian bottom"
            }
            Self::All => {
                "flat faces, thin or absorbing media; exact for light scattered once and never, without what is scattered more often; no Lambertian bottom"
            }
        }
    }
}

/// A flat layer, exact for light scattered at most once inside or as Hanrahan and Krueger have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatLayer {
    eta: f64,
    /// Zero to infinity.
    tau: f64,
    albedo: f64,
    phase: PhaseFunction,
    bottom: Bottom,
    paths: LayerPaths,
}

/// Unscattered light: it leaves along one direction, as a delta in the BSDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnscatteredBeam {
    /// Side on which it leaves.
    pub side: Side,
    /// Direction.
    pub wo: DVec3,
    /// Fraction of the incident flux.
    pub flux: f64,
}

impl UnscatteredBeam {
    /// Polar angle from +z and azimuth, degrees, rounded to a billionth.
    #[must_use]
    pub fn angles_deg(&self) -> [f64; 2] {
        [polar_angle(self.wo), azimuth(self.wo)]
            .map(|angle| (angle.to_degrees() * 1e9).round() / 1e9)
    }
}

/// Why a model of a layer cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlatLayerError {
    /// No model has this name.
    #[error("unknown model `{name}` of a layer; the models are {}", FlatLayer::NAMES.join(", "))]
    Unknown {
        /// The given name.
        name: String,
    },
    /// Invalid index of the top face.
    #[error(transparent)]
    Index(#[from] MaterialError),
    /// A diffuse bottom.
    #[error(
        "the model {0} requires light to keep its angle between the faces, which a Lambertian bottom does not; use another bottom"
    )]
    DiffuseBottom(&'static str),
    /// A mirror at the bottom, in the model without inner reflections.
    #[error(
        "the model hanrahan-krueger leaves out the light reflected by a mirror at the bottom; use flat-layer"
    )]
    MirrorBelow,
}

impl FlatLayer {
    /// The names that [`FlatLayer::by_name`] knows.
    pub const NAMES: [&'static str; 2] =
        [LayerPaths::HanrahanKrueger.name(), LayerPaths::All.name()];

    /// The model of that name of `layer` below a face of index `eta`: see [`FlatLayer::new`].
    ///
    /// # Errors
    /// [`FlatLayerError`]: an unknown name, or as [`FlatLayer::new`].
    pub fn by_name(name: &str, eta: f64, layer: &Layer) -> Result<Self, FlatLayerError> {
        let known = LayerPaths::ALL
            .into_iter()
            .find(|paths| paths.name() == name);
        let paths = known.ok_or_else(|| FlatLayerError::Unknown {
            name: name.to_owned(),
        })?;
        Self::new(eta, layer, paths)
    }

    /// `layer` below a flat face of index `eta`, n_layer / n_above, which may be one.
    ///
    /// # Errors
    /// [`FlatLayerError`] for an invalid index, a Lambertian bottom, and a mirror under
    /// [`LayerPaths::HanrahanKrueger`].
    pub fn new(eta: f64, layer: &Layer, paths: LayerPaths) -> Result<Self, FlatLayerError> {
        Material::dielectric(eta)?;
        let medium = layer.medium();
        let (tau, bottom) = match layer.end() {
            Some(slab) => (medium.extinction() * slab.thickness, slab.bottom),
            None if medium.is_clear() => (0.0, Bottom::Open),
            // No light returns from infinite depth.
            None => (f64::INFINITY, Bottom::Absorbing),
        };
        match (bottom, paths) {
            (Bottom::Lambertian { .. }, _) => {
                return Err(FlatLayerError::DiffuseBottom(paths.name()));
            }
            (Bottom::Mirror, LayerPaths::HanrahanKrueger) => {
                return Err(FlatLayerError::MirrorBelow);
            }
            _ => {}
        }
        Ok(Self {
            eta,
            tau,
            albedo: medium.albedo(),
            phase: medium.phase(),
            bottom,
            paths,
        })
    }

    /// The paths that count.
    #[must_use]
    pub const fn paths(&self) -> LayerPaths {
        self.paths
    }

    /// Optical thickness `sigma_t d`; infinite for a half space.
    #[must_use]
    pub const fn optical_thickness(&self) -> f64 {
        self.tau
    }

    /// The sides that light leaves on.
    #[must_use]
    pub const fn sides(&self) -> Sides {
        match self.index_beyond() {
            Some(_) => Sides::Both,
            None => Sides::Reflected,
        }
    }

    /// The BSDF of light scattered once inside, 1/sr, for directions outside the layer. Unscattered light is a
    /// delta: see [`FlatLayer::unscattered`].
    ///
    /// Unit vectors, `wo.z > 0` reflected, `wo.z < 0` transmitted; zero unless `wi.z > 0`. Stable for equal
    /// cosines, at grazing, at and beyond critical angles, and from `tau = 0` to infinity.
    #[must_use]
    pub fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 || wo.z == 0.0 {
            return 0.0;
        }
        let side = if wo.z > 0.0 {
            Side::Reflected
        } else {
            Side::Transmitted
        };
        let inside = self.enter(wi);
        self.leave(&inside, side, wo.z.abs())
            .map_or(0.0, |exit| self.scattered(&inside, &exit, wo.truncate()))
    }

    /// Unscattered light: reflected by the layer, and transmitted through the bottom.
    #[must_use]
    pub fn unscattered(&self, wi: DVec3) -> Vec<UnscatteredBeam> {
        if wi.z <= 0.0 {
            return Vec::new();
        }
        let inside = self.enter(wi);
        let through_top = inside.up * inside.attenuation() * inside.top.transmitted;
        let mut beams = vec![UnscatteredBeam {
            side: Side::Reflected,
            wo: DVec3::new(-wi.x, -wi.y, wi.z),
            flux: inside.top.reflected + through_top,
        }];
        if let Some(wo) = self.straight_on(wi, &inside) {
            beams.push(UnscatteredBeam {
                side: Side::Transmitted,
                wo,
                flux: inside.down * inside.attenuation() * self.bottom_face(inside.mu).transmitted,
            });
        }
        beams
    }

    /// Direction of light that passes both faces, if it can.
    fn straight_on(&self, wi: DVec3, inside: &Inside) -> Option<DVec3> {
        let index = self.index_beyond()?;
        let face = self.bottom_face(inside.mu);
        let passes = inside.top.transmitted > 0.0 && face.transmitted > 0.0;
        passes.then(|| {
            let across = -wi.truncate() / (self.eta * index);
            across.extend(-face.cos_theta_t).normalize()
        })
    }

    /// n_beyond / n_layer, if light leaves below.
    const fn index_beyond(&self) -> Option<f64> {
        match self.bottom {
            Bottom::Open => Some(1.0),
            Bottom::Interface { eta } => Some(eta),
            _ => None,
        }
    }

    /// Fresnel terms of the bottom at the cosine `mu`; absorbed light counts as transmitted.
    fn bottom_face(&self, mu: f64) -> Fresnel {
        match (self.bottom, self.index_beyond()) {
            (_, Some(eta)) => dielectric(mu, eta),
            (Bottom::Mirror, _) => Fresnel {
                reflected: 1.0,
                transmitted: 0.0,
                cos_theta_t: 0.0,
            },
            _ => Fresnel {
                reflected: 0.0,
                transmitted: 1.0,
                cos_theta_t: mu,
            },
        }
    }
}
