//! Group: cases that share surfaces, ready to be planned and traced.

use super::context::Context;
use super::given::GivenGroup;
use super::random::RandomGroup;
use super::ready_group::ReadyGroup;
use super::traced_case::NumberedCase;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::settings::Settings;
use crate::input::surface_source::SurfaceSource;

/// Cases that share surfaces, checked.
#[derive(Clone)]
pub(crate) enum Group {
    /// Random surfaces.
    Random(Box<RandomGroup>),
    /// Given surfaces.
    Given(GivenGroup),
}

impl Group {
    /// The groups of cases with equal surface sources, each in the place of its first case.
    pub(crate) fn of_cases(
        cases: &[Case],
        settings: &Settings,
    ) -> Result<Vec<Self>, SimulateError> {
        let mut groups: Vec<(SurfaceSource, Vec<NumberedCase>)> = Vec::new();
        for (number, case) in cases.iter().enumerate() {
            let numbered = NumberedCase {
                number,
                case: case.clone(),
            };
            match groups
                .iter_mut()
                .find(|(source, _)| *source == case.surface)
            {
                Some((_, cases)) => cases.push(numbered),
                None => groups.push((case.surface.clone(), vec![numbered])),
            }
        }
        let checked = |(source, cases)| match source {
            SurfaceSource::Random(surfaces) => RandomGroup::new(*surfaces, cases, settings)
                .map(|group| Self::Random(Box::new(group))),
            SurfaceSource::Given(shapes) => {
                GivenGroup::new(shapes, cases, settings).map(Self::Given)
            }
        };
        groups.into_iter().map(checked).collect()
    }

    /// The same with another effort and seed.
    pub(crate) fn repeated(&self, settings: &Settings) -> Self {
        match self {
            Self::Random(group) => Self::Random(Box::new(group.repeated(settings))),
            Self::Given(group) => Self::Given(group.repeated(settings)),
        }
    }

    /// Rays of all cases, as far as they are planned without a pilot run.
    pub(crate) fn rays(&self) -> u64 {
        match self {
            Self::Random(group) => group.rays(),
            Self::Given(group) => group.rays(),
        }
    }

    /// Builds a given surface.
    pub(crate) fn build(self, context: Context<'_>) -> Result<Box<dyn ReadyGroup>, SimulateError> {
        match self {
            Self::Random(group) => Ok(group),
            Self::Given(group) => group.build(context),
        }
    }
}
