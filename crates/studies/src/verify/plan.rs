//! Plan: the cases that a configuration stands for, and how they are simulated.

use asperity_simulate::{
    Case, Coordinates, CoreSlopes, Estimator, Lobe, RandomSurfaces, Settings, Shape, SurfaceSource,
    check_memory,
};
use asperity_surface::LengthUnit;
use asperity_synthesis::{FieldSynthesis, SurfaceRecipe};

use crate::config::error::ConfigError;
use crate::config::{RunConfig, SurfaceConfig, VerifyConfig};
use crate::error::StudyError;

/// The cases that a configuration stands for, and how they are simulated.
#[derive(Clone)]
pub struct Plan {
    /// The cases, in the order of nesting of their lists: the azimuth of the light changes fastest.
    pub cases: Vec<Case>,
    /// Settings of their simulation.
    pub settings: Settings,
    /// The lobes of single scattering of each case.
    pub lobes: Vec<[Option<Lobe>; 2]>,
}

impl Plan {
    /// Cases whose bins refine around their narrow lobes, unless `run` names bins.
    fn new(mut cases: Vec<Case>, settings: Settings, run: &RunConfig) -> Self {
        let mut last: Option<(SurfaceSource, Option<CoreSlopes>)> = None;
        let lobes = cases.iter_mut().map(|case| {
            // Slopes of a given surface are counted facet by facet.
            let slopes = match &last {
                Some((surface, slopes)) if *surface == case.surface => *slopes,
                _ => CoreSlopes::of_source(&case.surface),
            };
            last = Some((case.surface.clone(), slopes));
            let lobes = Lobe::of_slopes(case, slopes);
            case.bins = run.bins_around(lobes);
            lobes
        });
        Self {
            lobes: lobes.collect(),
            cases,
            settings,
        }
    }
}

impl SurfaceConfig {
    /// Surfaces of `recipe` on the grid of the configuration.
    fn planned(&self, recipe: SurfaceRecipe) -> Result<RandomSurfaces, StudyError> {
        let shape = self.shape();
        let planning = FieldSynthesis::planning_bytes(&recipe, shape);
        check_memory("planning these surfaces", planning)?;
        let (cells, spacing) = (self.cells(), self.spacing());
        let insist = self.insist;
        Ok(RandomSurfaces::new(cells, recipe, shape, spacing, insist)?)
    }
}

impl VerifyConfig {
    /// Every combination of surface, material, medium and direction of light, checked.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn plan(&self) -> Result<Plan, StudyError> {
        let cases = self.cases(SurfaceConfig::planned)?;
        Ok(Plan::new(cases, self.ray_settings()?, &self.run))
    }

    /// The cases, on surfaces that `planned` makes of each recipe.
    pub(crate) fn cases<E: From<ConfigError>>(
        &self,
        planned: impl Fn(&SurfaceConfig, SurfaceRecipe) -> Result<RandomSurfaces, E>,
    ) -> Result<Vec<Case>, E> {
        // Refused before surfaces are drawn to be measured, which may take long
        if self.run.estimator == Estimator::Controlled && self.surface.is_measured() {
            return Err(ConfigError::no_control_variate(
                "needs the distribution of slopes, which is not known for these surfaces; take auto or plain",
            )
            .into());
        }
        let mut cases: Vec<Case> = Vec::new();
        for single in self.singles()? {
            let (smoothness, recipe) = single.surface.recipe()?;
            // A recipe takes time to plan, so that neighbours of equal surfaces share it.
            let surface = match cases.last().map(|case| &case.surface) {
                Some(SurfaceSource::Random(last)) if *last.recipe() == recipe => {
                    SurfaceSource::Random(last.clone())
                }
                _ => SurfaceSource::random(planned(&single.surface, recipe)?),
            };
            let at = Coordinates {
                smoothness: Some(smoothness),
                unit: single.surface.unit,
                ..Coordinates::default()
            };
            cases.push(single.case(surface, at)?);
        }
        self.check(&cases)?;
        Ok(cases)
    }

    /// Plan on given surfaces, whose lengths are in `unit`.
    pub(crate) fn plan_on(&self, shapes: &[Shape], unit: LengthUnit) -> Result<Plan, ConfigError> {
        let singles = self.singles()?.into_iter();
        let cases = singles.map(|single| {
            let at = Coordinates {
                unit,
                ..Coordinates::default()
            };
            single.case(SurfaceSource::Given(shapes.to_vec()), at)
        });
        let cases = cases.collect::<Result<Vec<_>, _>>()?;
        self.check(&cases)?;
        Ok(Plan::new(cases, self.ray_settings()?, &self.run))
    }
}
