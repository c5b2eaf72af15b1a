//! Settings: how cases are simulated, and how much is traced.

use asperity_tally::TallySpec;
use asperity_tracer::{AcceleratorKind, DEFAULT_MAX_SCATTERINGS, Sampling};

use super::apertures::CaseApertures;
use super::case::Case;
use super::estimator::Estimator;
use super::path_choice::PathChoice;
use super::regions::Regions;
use super::target::Target;

/// Settings of all cases: tally, paths, and effort.
///
/// # Examples
/// ```
/// use asperity_simulate::{Effort, Settings};
///
/// let settings = Settings {
///     effort: Effort::Rays { total: 1_000_000, surfaces: 16 },
///     refine: true,
///     ..Settings::default()
/// };
/// assert_eq!(settings.target(), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Tally spec of the light that leaves.
    pub tally: TallySpec,
    /// Branching and roulette of paths.
    pub paths: PathChoice,
    /// Accelerator that finds hits.
    pub accelerator: AcceleratorKind,
    /// Estimator.
    pub estimator: Estimator,
    /// Sampling of the mean plane and of azimuth.
    pub sampling: Sampling,
    /// `true` if bins on either side of the plane of incidence are averaged where the statistics of random surfaces are symmetric about it.
    pub fold: bool,
    /// `true` if every surface is also traced at half its spacing, whose results are then reported, and at
    /// twice its spacing, if its number of cells is even. The differences are the error of the mesh.
    pub refine: bool,
    /// Regions of each given surface that are lit on their own. [`Outcome::surfaces`](crate::Outcome::surfaces) then has a tally
    /// of each region, whose mean is the result; all regions have equally many rays, and errors come from their scatter. Only
    /// [`Estimator::Plain`] and a number of rays go with it. Random surfaces are not divided.
    pub regions: Option<Regions>,
    /// Seed of surfaces and rays.
    pub seed: u64,
    /// Scatterings inside a layer after which a path is truncated.
    pub max_scatterings: u32,
    /// Effort.
    pub effort: Effort,
    /// `true` if each case plans what a target error takes for itself, as if it were the only one. Cases of equal surfaces otherwise
    /// share the effort of the most demanding one, and their surfaces.
    pub plan_alone: bool,
    /// `true` if the error of the mesh is estimated by quadrature where a case of random surfaces is not
    /// refined. It takes up to a second per case.
    pub mesh_quadrature: bool,
}

impl Default for Settings {
    /// A million stratified rays on 32 surfaces with the default tally and paths.
    fn default() -> Self {
        Self {
            tally: TallySpec::default(),
            paths: PathChoice::default(),
            accelerator: AcceleratorKind::Auto,
            estimator: Estimator::Auto,
            sampling: Sampling::Stratified,
            fold: true,
            refine: false,
            regions: None,
            seed: 1,
            max_scatterings: DEFAULT_MAX_SCATTERINGS,
            effort: Effort::default(),
            plan_alone: false,
            mesh_quadrature: true,
        }
    }
}

impl Settings {
    /// Tally spec of a case: that of the settings, with the bins of the case if it has any, and the apertures of light of one direction.
    #[must_use]
    pub fn spec_of(&self, case: &Case) -> TallySpec {
        let spec = match case.bins {
            Some(bins) => self.tally.with_bins(bins.grid, bins.in_plane_half_width),
            None => self.tally,
        };
        match case.light.spread {
            None => spec.with_apertures(CaseApertures::of(case).list()),
            // Apertures are about one direction
            Some(_) => spec,
        }
    }

    /// The largest of what is recorded of these cases.
    pub(crate) fn largest_spec<'a>(&self, cases: impl Iterator<Item = &'a Case>) -> TallySpec {
        let specs = cases.map(|case| self.spec_of(case));
        specs.max_by_key(TallySpec::len).unwrap_or(self.tally)
    }

    /// The error to reach, if the effort follows from one.
    #[must_use]
    pub const fn target(&self) -> Option<Target> {
        match self.effort {
            Effort::Rays { .. } => None,
            Effort::TargetError(target) => Some(target),
        }
    }
}

/// Effort of each case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// A number of rays.
    Rays {
        /// Rays over all surfaces, at least. Rounded up so that every block of rays is a square of strata.
        total: u64,
        /// Surfaces drawn. A given surface is one.
        surfaces: u64,
    },
    /// Rays and surfaces until an error is reached.
    TargetError(Target),
}

impl Effort {
    /// Rays unless a number is given.
    pub const DEFAULT_RAYS: u64 = 1_000_000;

    /// Surfaces unless a number is given.
    pub const DEFAULT_SURFACES: u64 = 32;

    /// Rays on a given surface.
    #[must_use]
    pub const fn rays(total: u64) -> Self {
        Self::Rays { total, surfaces: 1 }
    }

    /// Rays over all surfaces; before an error has told how many it takes, the default number.
    #[must_use]
    pub const fn total_rays(self) -> u64 {
        match self {
            Self::Rays { total, .. } => total,
            Self::TargetError(_) => Self::DEFAULT_RAYS,
        }
    }

    /// Surfaces; before an error has told how many it takes, the default number.
    #[must_use]
    pub const fn surfaces(self) -> u64 {
        match self {
            Self::Rays { surfaces, .. } => surfaces,
            Self::TargetError(_) => Self::DEFAULT_SURFACES,
        }
    }
}

impl Default for Effort {
    fn default() -> Self {
        Self::Rays {
            total: Self::DEFAULT_RAYS,
            surfaces: Self::DEFAULT_SURFACES,
        }
    }
}
