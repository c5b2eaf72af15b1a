//! What the spacing of a mesh does to results: what is known of it beforehand, and what meshes of
//! several spacings show.

use asperity_analysis::{ModelError, SlopeCovariance, control_variate, unshadowed_fluxes};
use asperity_surface::{HeightField, Psd, Synthesis};
use asperity_tally::{
    ByEntry, ControlVariate, Entry, Estimate, TallyResult, TallySpec, TallyStatistics, TallyValues,
    UnshadowedFluxes,
};
use asperity_tracer::{Accelerator, AcceleratorKind, BuildAccelerator, Surface};

use crate::input::case::Case;
use crate::input::limits::RunError;
use crate::methods::method::Method;
use crate::slopes::slopes;

/// Said of a mesh error that nobody asked for.
pub(crate) const NOT_ASKED: &str = "not estimated: --refine traces a finer mesh";

/// Said of a mesh error, wherever it comes from.
const SIGN: &str = "what the mesh adds to the result, so less it is that of the continuous surface";

/// Standard errors that a difference between meshes must exceed before an order is read off it.
const RESOLVED: f64 = 3.0;

/// Slope variance below which the plain estimate is not made to wait for a quadrature: lobes narrower than
/// a thousandth of a milliradian take it minutes, and lie in one bin.
const LEAST_SLOPE_VARIANCE: f64 = 1e-12;

/// Orders that count as second.
const SECOND_ORDER: std::ops::RangeInclusive<f64> = 1.5..=2.5;

/// The meshes of one surface that are traced: the one whose results are reported, and those beside it
/// that show its error.
pub(crate) struct Meshes<G = Surface> {
    /// The given mesh; or, if it is refined, the finer one, the given one, and, if its cells are
    /// even, the coarser one.
    pub surfaces: Vec<G>,
}

impl<G: BuildAccelerator> Meshes<G> {
    /// One mesh alone.
    pub(crate) fn of_one(surface: G) -> Self {
        Self {
            surfaces: vec![surface],
        }
    }

    /// An accelerator for each mesh.
    pub(crate) fn accelerators(
        &self,
        kind: AcceleratorKind,
    ) -> Result<Vec<Box<dyn Accelerator<G>>>, RunError> {
        self.surfaces
            .iter()
            .map(|surface| Ok(surface.accelerator(kind)?))
            .collect()
    }
}

impl Meshes {
    /// The mesh `field`, with a finer and a coarser one if it is to be refined.
    pub(crate) fn new(field: HeightField, refine: bool) -> Result<Self, RunError> {
        let fields = if refine {
            let finer = field.refined()?;
            let coarser = field.coarsened().ok();
            [finer, field].into_iter().chain(coarser).collect()
        } else {
            vec![field]
        };
        Ok(Self {
            surfaces: fields.into_iter().map(Surface::new).collect(),
        })
    }

    /// The given mesh back.
    pub(crate) fn into_given(mut self) -> HeightField {
        let given = usize::from(self.surfaces.len() > 1);
        self.surfaces.swap_remove(given).into_field()
    }
}

/// Statistics of what is reported, and of what differs between meshes.
#[derive(Clone, Debug)]
pub(crate) struct MeshStatistics {
    /// Of the tallies of the first mesh.
    pub tallies: TallyStatistics,
    /// Of what differs, where there are several meshes.
    pub shifts: Option<MeshShifts>,
}

impl MeshStatistics {
    /// Statistics of tallies on so many meshes.
    pub(crate) fn new(spec: TallySpec, meshes: usize) -> Self {
        Self {
            tallies: TallyStatistics::new(spec),
            shifts: (meshes > 1).then(|| MeshShifts::new(spec, meshes > 2)),
        }
    }

    /// Adds one batch: a tally of each mesh.
    pub(crate) fn push(&mut self, tallies: &[TallyValues]) {
        self.tallies.push(&tallies[0]);
        if let Some(shifts) = &mut self.shifts {
            shifts.push(tallies);
        }
    }
}

/// Statistics of what differs between the finer, the given, and perhaps the coarser mesh.
#[derive(Clone, Debug)]
pub struct MeshShifts {
    /// The given mesh less the finer one.
    given_less_finer: TallyStatistics,
    /// Richardson's values, `finer + (finer - given) / 3`.
    extrapolated: TallyStatistics,
    /// The coarser mesh less the given one.
    coarser_less_given: Option<TallyStatistics>,
}

impl MeshShifts {
    fn new(spec: TallySpec, has_coarser: bool) -> Self {
        Self {
            given_less_finer: TallyStatistics::new(spec),
            extrapolated: TallyStatistics::new(spec),
            coarser_less_given: has_coarser.then(|| TallyStatistics::new(spec)),
        }
    }

    /// Adds one batch: a tally of each mesh, the finest first.
    fn push(&mut self, tallies: &[TallyValues]) {
        let (finer, given) = (&tallies[0], &tallies[1]);
        let shift = given.zip_map(finer, |g, f| g - f);
        self.given_less_finer.push(&shift);
        self.extrapolated
            .push(&finer.zip_map(&shift, |f, s| f - s / 3.0));
        if let (Some(statistics), Some(coarser)) = (&mut self.coarser_less_given, tallies.get(2)) {
            statistics.push(&coarser.zip_map(given, |c, g| c - g));
        }
    }

    /// Adds one surface: the means of its own batches.
    fn push_means(&mut self, surface: &Self) {
        self.given_less_finer.push(surface.given_less_finer.means());
        self.extrapolated.push(surface.extrapolated.means());
        if let (Some(statistics), Some(of_surface)) =
            (&mut self.coarser_less_given, &surface.coarser_less_given)
        {
            statistics.push(of_surface.means());
        }
    }
}

/// What meshes of several spacings showed.
#[derive(Clone, Debug)]
pub struct Refinement {
    /// Spacing of the given mesh, length units along x and y.
    pub given: [f64; 2],
    /// A batch is a surface, or a ray block where there is one surface.
    shifts: MeshShifts,
}

impl Refinement {
    /// Of a given mesh of that spacing.
    pub const fn new(given: [f64; 2], shifts: MeshShifts) -> Self {
        Self { given, shifts }
    }

    /// From what each of several surfaces showed, or from the ray blocks of one.
    pub fn of_surfaces(given: [f64; 2], surfaces: &[MeshShifts]) -> Option<Self> {
        let (first, others) = surfaces.split_first()?;
        let shifts = if others.is_empty() {
            first.clone()
        } else {
            let spec = *first.extrapolated.spec();
            let mut shifts = MeshShifts::new(spec, first.coarser_less_given.is_some());
            surfaces.iter().for_each(|one| shifts.push_means(one));
            shifts
        };
        Some(Self::new(given, shifts))
    }

    /// Whether there was a mesh of twice the given spacing.
    pub const fn has_coarser(&self) -> bool {
        self.shifts.coarser_less_given.is_some()
    }

    /// The given mesh less the finer one.
    pub fn shift(&self, entry: Entry) -> Estimate {
        self.shifts.given_less_finer.at(entry)
    }

    /// What is left of the mesh error in the finer mesh, for second order: a third of that.
    pub fn remaining(&self, entry: Entry) -> Estimate {
        let Estimate { mean, se } = self.shift(entry);
        Estimate {
            mean: mean / 3.0,
            se: se.map(|se| se / 3.0),
        }
    }

    /// The coarser mesh less the given one.
    pub fn coarser_shift(&self, entry: Entry) -> Option<Estimate> {
        let shifts = self.shifts.coarser_less_given.as_ref()?;
        Some(shifts.at(entry))
    }

    /// The order with which an entry converges.
    ///
    /// # Errors
    /// Why none is seen.
    pub fn order(&self, entry: Entry) -> Result<f64, String> {
        let Some(coarser) = self.coarser_shift(entry) else {
            return Err("the tile has an odd number of cells, so there is no coarser mesh".into());
        };
        let shift = self.shift(entry);
        let seen = |shift: Estimate| {
            shift
                .se
                .is_some_and(|se| shift.mean != 0.0 && shift.mean.abs() > RESOLVED * se)
        };
        if !seen(shift) || !seen(coarser) {
            return Err(format!(
                "the differences between meshes are not both beyond {RESOLVED} of their standard errors"
            ));
        }
        let ratio = coarser.mean / shift.mean;
        if ratio <= 0.0 {
            return Err("the differences between meshes have opposite signs".into());
        }
        Ok(ratio.log2())
    }

    /// Richardson's value for a spacing of zero.
    ///
    /// # Errors
    /// Why it is not to be trusted.
    pub fn extrapolated(&self, entry: Entry) -> Result<Estimate, String> {
        let order = self.order(entry)?;
        if SECOND_ORDER.contains(&order) {
            return Ok(self.shifts.extrapolated.at(entry));
        }
        Err(format!(
            "the order seen is {order:.2}, and the value holds for second order, seen from {} to {}",
            SECOND_ORDER.start(),
            SECOND_ORDER.end()
        ))
    }
}

/// The error of a mesh, by entry.
#[derive(Clone, Debug)]
pub struct MeshErrors {
    /// What the mesh adds, where that is known.
    pub remaining: ByEntry<Option<f64>>,
    /// What it would add but for the control.
    pub removed: Option<TallyValues>,
    /// How both were estimated, or why not.
    pub ways: [String; 2],
    pub refinement: Option<Refinement>,
}

/// Said where nothing is subtracted whose mean is known.
const NOTHING_REMOVED: &str = "none: nothing that is known of the continuous surface is subtracted";

impl MeshErrors {
    /// Not known of any entry, and why.
    pub fn unknown(spec: TallySpec, why: &str) -> Self {
        Self {
            remaining: ByEntry::filled(spec, None),
            removed: None,
            ways: [why, NOTHING_REMOVED].map(str::to_owned),
            refinement: None,
        }
    }

    /// Of one surface that was refined.
    pub fn of_refined(refinement: Refinement) -> Self {
        let mut ways = ["", NOTHING_REMOVED].map(str::to_owned);
        Self {
            remaining: measured(&refinement, &mut ways[0]),
            removed: None,
            ways,
            refinement: Some(refinement),
        }
    }

    /// Of a flat surface, which any mesh shows as it is.
    pub fn of_flat(spec: TallySpec) -> Self {
        Self {
            remaining: ByEntry::filled(spec, Some(0.0)),
            removed: None,
            ways: ["0: any mesh shows a flat surface as it is", NOTHING_REMOVED].map(str::to_owned),
            refinement: None,
        }
    }

    /// Of a case whose surfaces `synthesis` draws.
    pub fn of_case(
        synthesis: &Synthesis,
        (case, method): (&Case, &Method),
        spec: &TallySpec,
        any_azimuth: bool,
        refinement: Option<Refinement>,
    ) -> Self {
        let first_order = FirstOrder {
            case,
            spec,
            any_azimuth,
        };
        let mut ways = [NOT_ASKED.to_owned(), NOTHING_REMOVED.to_owned()];
        let mut remaining = ByEntry::filled(*spec, None);
        let mut removed = None;
        match method.control() {
            Some(control) => match first_order.removed(synthesis, refinement.is_some(), control) {
                Ok(values) => {
                    ways[0].push_str("; what is removed is no part of it");
                    ways[1] = format!(
                        "exact, by quadrature: unshadowed single scattering by the slopes of the facets, less that by those of the continuous surface, in the shares that the control subtracts{}",
                        first_order.over_azimuth()
                    );
                    removed = Some(values);
                }
                Err(error) => ways[1] = format!("not estimated: {error}"),
            },
            None if case.layer.is_some() => {
                ways[0].push_str("; with a medium below no quadrature tells it");
            }
            None if refinement.is_none() => match first_order.shift(synthesis) {
                Ok(values) => {
                    ways[0] = format!(
                        "{SIGN}; estimated by quadrature: unshadowed single scattering by the slopes of the facets, less that by those of the continuous surface, in the shares that Smith's masking leaves{}; what it gains or loses in all is taken off the energies in proportion; null for light scattered more than once: --refine traces a finer mesh",
                        first_order.over_azimuth()
                    );
                    remaining = values;
                }
                Err(error) => {
                    ways[0] = format!("not estimated: {error}; --refine traces a finer mesh")
                }
            },
            None => {}
        }
        if let Some(refinement) = &refinement {
            remaining = measured(refinement, &mut ways[0]);
        }
        Self {
            remaining,
            removed,
            ways,
            refinement,
        }
    }
}

/// A third of what halving the spacing changed, and how that was found.
fn measured(refinement: &Refinement, way: &mut String) -> ByEntry<Option<f64>> {
    *way = format!(
        "{SIGN}; a third of the given mesh less that of half its spacing, which is the one reported, as for second order"
    );
    let spec = *refinement.shifts.given_less_finer.spec();
    ByEntry::from_fn(spec, |entry| Some(refinement.remaining(entry).mean))
}

/// What the slopes of facets do to light that is scattered once.
struct FirstOrder<'a> {
    case: &'a Case,
    spec: &'a TallySpec,
    any_azimuth: bool,
}

impl FirstOrder<'_> {
    /// What completing tallies under a control variate has removed.
    fn removed(
        &self,
        synthesis: &Synthesis,
        refined: bool,
        control: &ControlVariate,
    ) -> Result<TallyValues, String> {
        let slopes = if refined {
            let finer = finer(synthesis).ok_or("the finer mesh has too many samples")?;
            self.slopes(&finer)
        } else {
            self.slopes(synthesis)
        };
        let fluxes = slopes.and_then(|slopes| self.fluxes(&slopes));
        let fluxes = fluxes.map_err(|error| error.to_string())?;
        Ok(control.removed(&fluxes))
    }

    /// What the mesh adds to the plain estimate, where light of the first order reaches.
    fn shift(&self, synthesis: &Synthesis) -> Result<ByEntry<Option<f64>>, String> {
        if self
            .case
            .psd
            .slope_variance()
            .into_iter()
            .fold(0.0, f64::max)
            < LEAST_SLOPE_VARIANCE
        {
            return Err("the surface is so smooth that its lobe is hard to integrate".into());
        }
        self.shift_of_rough(synthesis)
            .map_err(|error| error.to_string())
    }

    fn shift_of_rough(&self, synthesis: &Synthesis) -> Result<ByEntry<Option<f64>>, ModelError> {
        let Case {
            psd,
            material,
            incidence,
            ..
        } = *self.case;
        let control = control_variate(&slopes(&psd)?, material, incidence, self.spec)?;
        let fluxes = self.fluxes(&self.slopes(synthesis)?)?;
        let of_mesh = ControlVariate::new(*self.spec, control.fractions().clone(), &fluxes);
        let mut shift = of_mesh
            .expected()
            .zip_map(control.expected(), |mesh, surface| {
                (mesh != surface).then_some(mesh - surface)
            });
        // What single scattering gains, light scattered more often loses, and the energies hold both.
        let closed = control.removed(&fluxes);
        for total in [
            TallySpec::BUDGET.reflected,
            TallySpec::BUDGET.transmitted,
            TallySpec::BUDGET.absorbed,
        ] {
            shift[total] = Some(closed[total]);
        }
        Ok(shift)
    }

    fn fluxes(&self, slopes: &SlopeCovariance) -> Result<UnshadowedFluxes, ModelError> {
        unshadowed_fluxes(slopes, self.case.material, self.case.incidence, self.spec)
    }

    /// Slopes of the facets; their mean over azimuth where the light may come from any.
    fn slopes(&self, synthesis: &Synthesis) -> Result<SlopeCovariance, ModelError> {
        let [xx, xy, yy] = synthesis.facet_slope_covariance();
        if self.any_azimuth {
            let mean = 0.5 * (xx + yy);
            return Ok(SlopeCovariance::new(mean, mean, 0.0)?);
        }
        Ok(SlopeCovariance::new(xx, yy, xy)?)
    }

    /// What is said where the light comes from any azimuth.
    const fn over_azimuth(&self) -> &'static str {
        if self.any_azimuth {
            ", whose variance is averaged over azimuth: that facets correlate slopes along x and y is of second order then"
        } else {
            ""
        }
    }
}

/// The ensemble at half the spacing: the same surfaces, if the grid resolves them.
pub fn finer(synthesis: &Synthesis) -> Option<Synthesis> {
    let psd: Psd = *synthesis.psd();
    let shape = synthesis.shape().map(|n| 2 * n);
    Synthesis::new(psd, shape, synthesis.spacing().map(|d| d / 2.0), true).ok()
}
