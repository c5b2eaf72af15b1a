//! Surfaces of a stage by their number, and the memory that they take.

use std::sync::Arc;

use asperity_tracer::{Shape, Window};

use crate::engine::draw::built_surface::BuiltSurface;
use crate::engine::prepare::case_run::{CaseRun, independent_bottoms};
use crate::input::cells::Cells;
use crate::input::limits::{meshes_bytes, shape_bytes, smooth_meshes_bytes};
use crate::input::random_surfaces::RandomSurfaces;
use crate::input::regions::Regions;
use crate::input::settings::Settings;

/// Number of the surface whose random streams the rays of the first region have: beyond those of pilot runs.
const FIRST_REGION: u64 = 1 << 41;

/// Surfaces by their number.
#[derive(Clone, Copy)]
pub(crate) enum Surfaces<'a> {
    /// Surfaces that a recipe draws.
    Random(&'a RandomSurfaces),
    /// Given ones.
    Given(&'a [Shape]),
    /// One given surface, or regions of it.
    Built(&'a Arc<BuiltSurface>, Option<Regions>),
}

impl<'a> Surfaces<'a> {
    /// Memory that each one takes at its peak, beyond what is held anyway.
    pub(super) fn bytes(self, cases: &[CaseRun], settings: &Settings) -> usize {
        match self {
            Self::Random(surfaces) => surface_bytes(surfaces, cases, settings),
            Self::Given(shapes) => {
                let all = shapes
                    .iter()
                    .map(|shape| shape_bytes(shape, settings.accelerator, settings.refine));
                all.max().unwrap_or(0)
            }
            Self::Built(..) => 0,
        }
    }

    /// Windows of the surface of a number on which light falls.
    pub(super) fn windows(self, number: u64) -> Vec<Window> {
        match self {
            Self::Built(built, Some(regions)) => regions.windows(number, built.border()),
            _ => vec![Window::WHOLE],
        }
    }

    /// Number of the random streams that the rays on the surface of a number have.
    pub(super) const fn stream(self, number: u64) -> u64 {
        match self {
            Self::Built(_, Some(_)) => FIRST_REGION + number,
            _ => number,
        }
    }
}

/// Memory that one surface takes at its peak.
pub(crate) fn surface_bytes(
    surfaces: &RandomSurfaces,
    cases: &[CaseRun],
    settings: &Settings,
) -> usize {
    let (shape, accelerator) = (surfaces.shape(), settings.accelerator);
    let traced = match surfaces.cells() {
        // A surface that is drawn is not flat.
        Cells::Flat => meshes_bytes(shape, accelerator, false, settings.refine),
        Cells::Smooth => smooth_meshes_bytes(shape, accelerator, settings.refine),
    };
    let one = surfaces.peak_bytes().max(traced);
    // Bottoms of their own are drawn while the surface above is held, and sides that are lit from below are made of all.
    let held = independent_bottoms(cases).len();
    let turned = usize::from(cases.iter().any(|run| run.case.is_turned_over())) * (1 + held);
    one.saturating_add(traced.saturating_mul(held + turned))
}
