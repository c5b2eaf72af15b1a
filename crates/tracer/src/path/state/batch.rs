//! Batch: everything that changes while a batch of paths is traced.

use asperity_tally::{ExitColumns, Loss, Tallies, Tally};

use crate::geometry::CullingClass;
use crate::path::state::arrivals::{Arrivals, BottomArrivals};
use crate::path::state::conductors::Conductors;
use crate::path::state::flights::Flights;
use crate::path::state::path_state::{PathState, SingleSegment};
use crate::path::state::random_numbers::Numbers;
use crate::path::state::scattered::ScatteredLight;
use crate::path::state::segments::{Kept, Segments};
use crate::path::state::visibility_rays::VisibilityRays;
use crate::path::state::work::Work;
use crate::random::PathStream;
use crate::ray::{Hit, RayBatch};
use crate::sampling::Start;
use crate::vector::Instructions;

/// New paths start while fewer segments are in flight: enough to fill lanes in every stage, few enough for them and
/// the surface around them to stay in cache.
pub(crate) const MAX_IN_FLIGHT: usize = 2048;

/// Memory for the interactions of one round.
#[derive(Default)]
pub(crate) struct Interactions {
    pub(crate) scattered: ScatteredLight,
    /// Interactions that need random numbers, and these.
    pub(crate) which: Vec<u32>,
    pub(crate) pairs: Vec<[f64; 2]>,
    /// Interactions that transmit light.
    pub(crate) transmitting: Vec<u32>,
}

/// Memory for the search of single segments.
pub(crate) struct SingleSearch<F> {
    /// Those that are searched; empty between searches, as are the hits.
    pub(crate) singles: Vec<SingleSegment<F>>,
    pub(crate) rays: RayBatch,
    /// Those at one interface.
    pub(crate) which: Vec<u32>,
    pub(crate) hits: Vec<Option<Hit<F>>>,
}

impl<F> Default for SingleSearch<F> {
    fn default() -> Self {
        Self {
            singles: Vec::new(),
            rays: RayBatch::default(),
            which: Vec::new(),
            hits: Vec::new(),
        }
    }
}

/// Light in one layer, and at its bottom.
pub(crate) struct LightInLayer {
    /// Light that has arrived at the bottom.
    pub(crate) at_bottom: BottomArrivals,
    /// Light that begins inside, in the coordinates of the uppermost surface, before its free flights.
    pub(crate) entering: Segments,
    pub(crate) flights: Flights,
}

impl LightInLayer {
    fn new(kept: Kept) -> Self {
        Self {
            at_bottom: BottomArrivals::new(kept),
            entering: Segments::new(kept),
            flights: Flights::new(kept),
        }
    }

    const fn in_flight(&self) -> usize {
        self.flights.at.len + self.entering.len
    }
}

/// The state of one batch, or of several that are traced together.
pub(crate) struct Batch<'r, F> {
    /// Without batches for several conductors, which have tallies of their own.
    pub(crate) tallies: Tallies<'r>,
    /// `None` for a single material.
    pub(crate) conductors: Option<Conductors<'r>>,
    pub(crate) work: Work,
    pub(crate) stream: PathStream,
    pub(crate) instructions: Instructions,
    /// Q, U and V over I of the light that falls on the surface.
    pub(crate) stokes: [f64; 3],
    /// `true` if light is followed on behind the first facet that it has met, to shadowed facets.
    pub(crate) traces_shadows: bool,
    /// Segments of paths in their first tile.
    pub(crate) segments: Segments,
    /// Segments that are searched in this round.
    pub(crate) searched: Vec<u32>,
    /// All other segments that are searched.
    pub(crate) singles: Vec<SingleSegment<F>>,
    /// Visibility rays of this round from starts on the surface.
    pub(crate) visibility_rays: VisibilityRays<F>,
    /// Starts of this round.
    pub(crate) starts: Vec<Start>,
    /// Light that has arrived at the upper surface.
    pub(crate) arrivals: Arrivals<F>,
    /// Light in each layer, from above.
    pub(crate) layers: Vec<LightInLayer>,
    /// Light that has left, not yet in the tally.
    pub(crate) exits: ExitColumns,
    /// Memory that stages use again and again.
    pub(crate) classes: Vec<CullingClass>,
    pub(crate) hits: Vec<Option<Hit<F>>>,
    /// Numbers of segments: that have met a facet, that escape, that begin outside of the tile or meet nothing in it.
    pub(crate) met: Vec<u32>,
    pub(crate) escaped: Vec<u32>,
    pub(crate) elsewhere: Vec<u32>,
    /// `true` for each of the segments elsewhere that escapes.
    pub(crate) escape: Vec<bool>,
    pub(crate) single_search: SingleSearch<F>,
    pub(crate) interactions: Interactions,
    /// Flights of the round before, which of them are searched, and random numbers of the medium.
    pub(crate) flown: Flights,
    pub(crate) searched_flights: Vec<u32>,
    pub(crate) numbers: Numbers,
}

impl<'r, F: Copy> Batch<'r, F> {
    /// Empty batch for one material.
    pub(crate) fn new(
        tallies: Tallies<'r>,
        stream: PathStream,
        instructions: Instructions,
        kept: Kept,
        layers: usize,
    ) -> Self {
        Self {
            tallies,
            conductors: None,
            work: Work::default(),
            stream,
            instructions,
            stokes: [0.0; 3],
            traces_shadows: false,
            segments: Segments::new(kept),
            searched: Vec::new(),
            singles: Vec::new(),
            visibility_rays: VisibilityRays::new(kept),
            starts: Vec::new(),
            arrivals: Arrivals::new(kept),
            layers: (0..layers).map(|_| LightInLayer::new(kept)).collect(),
            exits: ExitColumns::new(kept.polarisation.polarimetry()),
            classes: Vec::new(),
            hits: Vec::new(),
            met: Vec::new(),
            escaped: Vec::new(),
            elsewhere: Vec::new(),
            escape: Vec::new(),
            single_search: SingleSearch::default(),
            interactions: Interactions::default(),
            flown: Flights::new(kept),
            searched_flights: Vec::new(),
            numbers: Numbers::default(),
        }
    }

    /// The tally of the batch that path number `ray` belongs to.
    #[inline(always)]
    pub(crate) fn tally_of(&mut self, ray: u32) -> &mut Tally<'r> {
        self.tallies.of(PathStream::batch_of(ray))
    }

    /// Number under which an exit is tallied: that of its batch, or the slot of its path where one is kept.
    pub(crate) const fn number_of(&self, path: &PathState) -> u32 {
        match self.segments.kept.slot {
            true => path.slot,
            false => PathStream::batch_of(path.ray),
        }
    }

    /// Tallies flux of a path that ended without an exit.
    pub(crate) fn add_loss(&mut self, of: &PathState, loss: Loss, flux: f64) {
        match &mut self.conductors {
            Some(conductors) => conductors.add_loss(of, loss),
            None => self.tally_of(of.ray).add_loss(loss, flux),
        }
    }

    /// Ends a path of several conductors. `counted`: the work since its last interaction.
    pub(crate) fn end_path(&mut self, path: &PathState, counted: Work) {
        if let Some(conductors) = &mut self.conductors
            && path.events.order() > 0
        {
            conductors.end(path.slot, counted);
        }
    }

    /// The tallies of each material, and the work done on it.
    pub(crate) fn into_tallies(self) -> Vec<(Tallies<'r>, Work)> {
        match self.conductors {
            Some(conductors) => conductors.into_tallies(self.work),
            None => vec![(self.tallies, self.work)],
        }
    }

    /// Number of segments in flight, without the visibility rays.
    pub(crate) fn in_flight(&self) -> usize {
        let inside = self.layers.iter().map(LightInLayer::in_flight);
        let inside: usize = inside.sum();
        self.searched.len() + self.singles.len() + self.arrivals.len() + inside
    }

    /// Returns `true` if no segment is left.
    pub(crate) fn is_finished(&self) -> bool {
        self.in_flight() == 0 && self.visibility_rays.need_no_search()
    }
}
