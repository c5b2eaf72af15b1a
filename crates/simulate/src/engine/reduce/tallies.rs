//! The tallies of one case, surface by surface.

use asperity_surface::SlopeMoments;
use asperity_tally::{SurfaceCounts, TallySpec, TallyStatistics, TallyValues};
use asperity_tracer::Work;

use crate::engine::prepare::case_run::CaseRun;
use crate::errors::budget::LeastErrors;
use crate::errors::refinement::MeshShifts;
use crate::input::surface_source::SurfaceSource;
use crate::methods::control_variates::slopes::SlopeControlVariate;
use crate::output::numbered_blocks::BlockStatistics;
use crate::output::surface_tallies::{CaseOnSurface, Seconds, SurfaceTallies};
use crate::output::work::Used;

/// The tallies of one case, one per surface.
#[derive(Clone, Debug)]
pub(crate) struct CaseTallies {
    /// Flux fractions of each surface.
    pub(crate) surfaces: Vec<TallyValues>,
    /// Surfaces behind each entry.
    lit: SurfaceCounts,
    /// Moments of the slopes of each, of random surfaces.
    pub(crate) slopes: Vec<SlopeMoments>,
    /// Squares of standard errors by the scatter between ray blocks, summed over surfaces.
    pub(crate) ray_squares: TallyValues,
    /// Statistics over ray blocks, where there is only one surface, or an analytic result.
    pub(crate) blocks_of_one: Option<TallyStatistics>,
    /// Differences between the meshes of each surface, where it has several.
    pub(crate) shifts: Vec<MeshShifts>,
    pub(crate) work: Work,
    pub(crate) seconds: Seconds,
    pub(crate) used: Used,
}

impl CaseTallies {
    fn new(spec: TallySpec, used: Used) -> Self {
        Self {
            surfaces: Vec::new(),
            lit: SurfaceCounts::new(spec),
            slopes: Vec::new(),
            ray_squares: TallyValues::zeros(spec),
            blocks_of_one: None,
            shifts: Vec::new(),
            work: Work::default(),
            seconds: Seconds::default(),
            used,
        }
    }

    /// An analytic result, with no rays traced.
    pub(crate) fn analytic(statistics: TallyStatistics) -> Self {
        let mut tallies = Self::new(*statistics.means().spec(), Used::nothing());
        tallies.surfaces.push(statistics.means().clone());
        tallies.blocks_of_one = Some(statistics);
        tallies
    }

    /// The tallies of each case, of these specs, on these surfaces, in the order of their number.
    pub(crate) fn of_surfaces(specs: &[TallySpec], surfaces: Vec<SurfaceTallies>) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        let is_only = surfaces.len() == 1;
        for surface in surfaces {
            if all.is_empty() {
                let of_case = |spec: &TallySpec| Self::new(*spec, surface.used.clone());
                all = specs.iter().map(of_case).collect();
            }
            let fraction = 1.0 / surface.cases.len() as f64;
            for (tallies, case) in all.iter_mut().zip(surface.cases) {
                tallies.add(&case, is_only);
                tallies.slopes.extend(surface.slopes);
                tallies.seconds.add(fraction, &surface.seconds);
            }
        }
        all
    }

    fn add(&mut self, case: &CaseOnSurface, is_only: bool) {
        let empty = || BlockStatistics::empty(*self.ray_squares.spec());
        let BlockStatistics { tally, shifts } = case.blocks.total().unwrap_or_else(empty);
        self.lit.push(tally.means());
        self.surfaces.push(tally.means().clone());
        self.ray_squares += &tally.error_squares();
        self.blocks_of_one = is_only.then_some(tally);
        self.shifts.extend(shifts);
        self.work += case.work;
    }

    /// Puts the surfaces of `more` behind those that are there.
    pub(crate) fn append(&mut self, more: Self) {
        self.surfaces.extend(more.surfaces);
        self.lit.append(&more.lit);
        self.slopes.extend(more.slopes);
        self.ray_squares += &more.ray_squares;
        self.blocks_of_one = None;
        self.shifts.extend(more.shifts);
        self.work += more.work;
        self.seconds.add(1.0, &more.seconds);
    }

    /// Takes from the fluxes of each surface what its slopes explain.
    pub(crate) fn adjust(&mut self, control: &SlopeControlVariate) {
        let pairs = self.surfaces.iter_mut().zip(&self.slopes);
        for (number, (tally, slopes)) in pairs.enumerate() {
            *tally = control.adjusted(number, tally, slopes);
        }
    }

    /// Statistics of the tallies of surfaces, less what their slopes explain.
    pub(crate) fn adjusted_statistics(&self, control: &SlopeControlVariate) -> TallyStatistics {
        let mut statistics = TallyStatistics::new(*self.ray_squares.spec());
        let pairs = self.surfaces.iter().zip(&self.slopes);
        for (number, (tally, slopes)) in pairs.enumerate() {
            statistics.push(&control.adjusted(number, tally, slopes));
        }
        statistics
    }

    /// Squares of the standard errors of the means by the scatter between ray blocks.
    pub(crate) fn error_squares_of_rays(&self) -> TallyValues {
        let n = self.surfaces.len() as f64;
        self.ray_squares.map(|sum| sum / (n * n))
    }

    /// Errors below which no mean of `statistics`, which are of these tallies, is reported.
    pub(crate) fn least_errors(&self, run: &CaseRun, statistics: &TallyStatistics) -> LeastErrors {
        let (means, squares) = (statistics.means(), self.error_squares_of_rays());
        let light = &run.case.light;
        let by_rays = run
            .method()
            .least_errors(light, means, &squares, self.work.rays);
        let features = match &run.case.surface {
            SurfaceSource::Random(surfaces) => surfaces.random_features(),
            SurfaceSource::Given(_) | SurfaceSource::Described(_) => None,
        };
        let by_surfaces = self.lit.least(means, &statistics.error_squares(), features);
        LeastErrors {
            all: by_rays.zip_map(&by_surfaces, |a, b| a.max(*b)),
            by_rays,
        }
    }

    /// Statistics of the tallies; a batch is a surface, or a block of rays where there is only one surface.
    pub(crate) fn statistics(&self) -> TallyStatistics {
        if let Some(blocks) = &self.blocks_of_one {
            return blocks.clone();
        }
        let mut statistics = TallyStatistics::new(*self.ray_squares.spec());
        self.surfaces
            .iter()
            .for_each(|tally| statistics.push(tally));
        statistics
    }
}
