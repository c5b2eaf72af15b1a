//! Batch: everything that changes while a batch of paths is traced.

use asperity_tally::{ExitColumns, Loss, Tallies, Tally};

use super::arrivals::Arrivals;
use super::bottom::BottomArrivals;
use super::flights::{Flights, Numbers};
use super::illumination::{Illumination, Starts};
use super::scatter::ScatteredLight;
use super::segments::{Kept, Segments};
use super::sightlines::Sightlines;
use super::state::{PathState, SingleSegment};
use super::work::Work;
use crate::geometry::Outlook;
use crate::random::PathStream;
use crate::ray::{Hit, RayBatch};
use crate::sampling::Start;
use crate::settings::Polarisation;
use crate::vector::Instructions;

/// New paths start while fewer segments are in flight: enough to fill lanes in every stage, few enough for them and
/// the surface around them to stay in cache.
pub(super) const MAX_IN_FLIGHT: usize = 2048;

/// Memory for the interactions of one round.
#[derive(Default)]
pub(super) struct Interactions {
    pub(super) scattered: ScatteredLight,
    /// Interactions that need random numbers, and these.
    pub(super) which: Vec<u32>,
    pub(super) pairs: Vec<[f64; 2]>,
    /// Interactions that transmit light.
    pub(super) transmitting: Vec<u32>,
}

/// Memory for the search of single segments.
pub(super) struct SingleSearch<F> {
    /// Those that are searched; empty between searches, as are the hits.
    pub(super) singles: Vec<SingleSegment<F>>,
    pub(super) rays: RayBatch,
    /// Those at one interface.
    pub(super) which: Vec<u32>,
    pub(super) hits: Vec<Option<Hit<F>>>,
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

/// The state of one batch, or of several that are traced together.
pub(super) struct Batch<'r, F> {
    pub(super) tallies: Tallies<'r>,
    pub(super) work: Work,
    pub(super) stream: PathStream,
    pub(super) instructions: Instructions,
    /// Q, U and V over I of the light that falls on the surface.
    pub(super) stokes: [f64; 3],
    /// Whether light is followed on behind the first facet that it has met, to shadowed facets.
    pub(super) traces_shadows: bool,
    /// Segments of paths in their first tile.
    pub(super) segments: Segments,
    /// Those of them that are searched in this round.
    pub(super) searched: Vec<u32>,
    /// All other segments that are searched.
    pub(super) singles: Vec<SingleSegment<F>>,
    /// Lines of sight of this round from starts on the surface.
    pub(super) sightlines: Sightlines<F>,
    /// Starts of this round.
    pub(super) starts: Vec<Start>,
    /// Facets that light has arrived at.
    pub(super) arrivals: Arrivals<F>,
    /// Light that has arrived at the bottom of the layer.
    pub(super) at_bottom: BottomArrivals,
    /// Light that begins inside the layer, in the coordinates of the upper surface, before its free flights.
    pub(super) entering: Segments,
    /// Flights inside the layer.
    pub(super) flights: Flights,
    /// Light that has left, not yet in the tally.
    pub(super) exits: ExitColumns,
    /// Memory that stages use again and again.
    pub(super) outlooks: Vec<Outlook>,
    pub(super) hits: Vec<Option<Hit<F>>>,
    /// Numbers of segments: that have met a facet, that escape, that begin outside of the tile or meet nothing in it.
    pub(super) met: Vec<u32>,
    pub(super) escaped: Vec<u32>,
    pub(super) elsewhere: Vec<u32>,
    /// Whether each of the segments elsewhere escapes.
    pub(super) escape: Vec<bool>,
    pub(super) single_search: SingleSearch<F>,
    pub(super) interactions: Interactions,
    /// Flights of the round before, which of them are searched, and random numbers of the medium.
    pub(super) flown: Flights,
    pub(super) searched_flights: Vec<u32>,
    pub(super) numbers: Numbers,
}

impl<'r, F: Copy> Batch<'r, F> {
    pub(super) fn new(
        tallies: Tallies<'r>,
        stream: PathStream,
        instructions: Instructions,
        illumination: &Illumination,
        polarisation: Polarisation,
    ) -> Self {
        let kept = Kept {
            turn: illumination.turns(polarisation),
            polarisation,
        };
        let traces_shadows =
            tallies.control_variate().is_some() && illumination.starts == Starts::FromAbove;
        Self {
            tallies,
            work: Work::default(),
            stream,
            instructions,
            stokes: illumination.stokes,
            traces_shadows,
            segments: Segments::new(kept),
            searched: Vec::new(),
            singles: Vec::new(),
            sightlines: Sightlines::new(kept),
            starts: Vec::new(),
            arrivals: Arrivals::new(kept),
            at_bottom: BottomArrivals::new(kept),
            entering: Segments::new(kept),
            flights: Flights::new(kept),
            exits: ExitColumns::new(polarisation.polarimetry()),
            outlooks: Vec::new(),
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
    pub(super) fn tally_of(&mut self, ray: u32) -> &mut Tally<'r> {
        self.tallies.of(PathStream::batch_of(ray))
    }

    /// Tallies flux of a path that ended without an exit.
    pub(super) fn add_loss(&mut self, of: &PathState, loss: Loss, flux: f64) {
        self.tally_of(of.ray).add_loss(loss, flux);
    }

    /// Number of segments in flight, without the lines of sight.
    pub(super) fn in_flight(&self) -> usize {
        let inside = self.flights.at.len + self.entering.len;
        self.searched.len() + self.singles.len() + self.arrivals.len() + inside
    }

    /// Whether no segment is left.
    pub(super) fn is_finished(&self) -> bool {
        self.in_flight() == 0 && self.sightlines.need_no_search()
    }
}
