//! What the spacing of a mesh does to results: what is known of it beforehand, and what meshes of
//! several spacings show.

use asperity_analysis::{ModelError, SlopeCovariance, control_variate, unshadowed_fluxes};
use asperity_surface::{HeightField, Psd, Synthesis};
use asperity_tally::{BatchStatistics, Control, Estimate, Layout, UnshadowedFluxes};
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
    /// Of the records of the first mesh.
    pub records: BatchStatistics,
    /// Of [`shifts`], where there are several meshes.
    pub shifts: Option<BatchStatistics>,
}

impl MeshStatistics {
    /// Statistics of records of `len` entries on so many meshes.
    pub(crate) fn new(len: usize, meshes: usize) -> Self {
        Self {
            records: BatchStatistics::new(len),
            shifts: (meshes > 1).then(|| BatchStatistics::new(meshes * len)),
        }
    }

    /// Adds one batch: the records of all meshes, one after the other.
    pub(crate) fn push(&mut self, records: &[f64]) {
        let len = self.records.means().len();
        self.records.push(&records[..len]);
        if let Some(statistics) = &mut self.shifts {
            statistics.push(&shifts(records, len));
        }
    }
}

/// From records of `len` entries on the finer, the given, and perhaps the coarser mesh: the given less
/// the finer ones, Richardson's values `finer + (finer - given) / 3`, and the coarser less the given.
fn shifts(records: &[f64], len: usize) -> Vec<f64> {
    let (finer, others) = records.split_at(len);
    let (given, coarser) = others.split_at(len);
    let mut shifts: Vec<f64> = given.iter().zip(finer).map(|(g, f)| g - f).collect();
    let extrapolated: Vec<f64> = finer
        .iter()
        .zip(&shifts)
        .map(|(f, s)| f - s / 3.0)
        .collect();
    shifts.extend(extrapolated);
    shifts.extend(coarser.iter().zip(given).map(|(c, g)| c - g));
    shifts
}

/// What meshes of several spacings showed.
#[derive(Clone, Debug)]
pub struct Refinement {
    /// Spacing of the given mesh, length units along x and y.
    pub given: [f64; 2],
    /// Entries of a record.
    len: usize,
    /// Of [`shifts`]; a batch is a surface, or a ray block where there is one surface.
    shifts: BatchStatistics,
}

impl Refinement {
    pub const fn new(given: [f64; 2], len: usize, shifts: BatchStatistics) -> Self {
        Self { given, len, shifts }
    }

    /// From what each of several surfaces showed, or from the ray blocks of one.
    pub fn of_surfaces(given: [f64; 2], len: usize, surfaces: &[BatchStatistics]) -> Option<Self> {
        let (first, others) = surfaces.split_first()?;
        let statistics = if others.is_empty() {
            first.clone()
        } else {
            let mut statistics = BatchStatistics::new(first.means().len());
            surfaces.iter().for_each(|one| statistics.push(one.means()));
            statistics
        };
        Some(Self::new(given, len, statistics))
    }

    /// Whether there was a mesh of twice the given spacing.
    pub fn has_coarser(&self) -> bool {
        self.shifts.means().len() > 2 * self.len
    }

    /// The given mesh less the finer one.
    pub fn shift(&self, entry: usize) -> Estimate {
        self.shifts.estimate(entry)
    }

    /// What is left of the mesh error in the finer mesh, for second order: a third of that.
    pub fn remaining(&self, entry: usize) -> Estimate {
        let Estimate { mean, se } = self.shift(entry);
        Estimate {
            mean: mean / 3.0,
            se: se.map(|se| se / 3.0),
        }
    }

    /// The coarser mesh less the given one.
    pub fn coarser_shift(&self, entry: usize) -> Option<Estimate> {
        self.has_coarser()
            .then(|| self.shifts.estimate(2 * self.len + entry))
    }

    /// The order with which an entry converges.
    ///
    /// # Errors
    /// Why none is seen.
    pub fn order(&self, entry: usize) -> Result<f64, String> {
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
    pub fn extrapolated(&self, entry: usize) -> Result<Estimate, String> {
        let order = self.order(entry)?;
        if SECOND_ORDER.contains(&order) {
            return Ok(self.shifts.estimate(self.len + entry));
        }
        Err(format!(
            "the order seen is {order:.2}, and the value holds for second order, seen from {} to {}",
            SECOND_ORDER.start(),
            SECOND_ORDER.end()
        ))
    }
}

/// The error of a mesh, by the layout of the results.
#[derive(Clone, Debug)]
pub struct MeshErrors {
    /// What the mesh adds, where that is known.
    pub remaining: Vec<Option<f64>>,
    /// What it would add but for the control.
    pub removed: Option<Vec<f64>>,
    /// How both were estimated, or why not.
    pub ways: [String; 2],
    pub refinement: Option<Refinement>,
}

/// Said where nothing is subtracted whose mean is known.
const NOTHING_REMOVED: &str = "none: nothing that is known of the continuous surface is subtracted";

impl MeshErrors {
    /// Not known of any of `len` entries, and why.
    pub fn unknown(len: usize, why: &str) -> Self {
        Self {
            remaining: vec![None; len],
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
    pub fn of_flat(len: usize) -> Self {
        Self {
            remaining: vec![Some(0.0); len],
            removed: None,
            ways: ["0: any mesh shows a flat surface as it is", NOTHING_REMOVED].map(str::to_owned),
            refinement: None,
        }
    }

    /// Of a case whose surfaces `synthesis` draws.
    pub fn of_case(
        synthesis: &Synthesis,
        (case, method): (&Case, &Method),
        layout: &Layout,
        any_azimuth: bool,
        refinement: Option<Refinement>,
    ) -> Self {
        let first_order = FirstOrder {
            case,
            layout,
            any_azimuth,
        };
        let mut ways = [NOT_ASKED.to_owned(), NOTHING_REMOVED.to_owned()];
        let mut remaining = vec![None; layout.len()];
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
fn measured(refinement: &Refinement, way: &mut String) -> Vec<Option<f64>> {
    *way = format!(
        "{SIGN}; a third of the given mesh less that of half its spacing, which is the one reported, as for second order"
    );
    (0..refinement.len)
        .map(|entry| Some(refinement.remaining(entry).mean))
        .collect()
}

/// What the slopes of facets do to light that is scattered once.
struct FirstOrder<'a> {
    case: &'a Case,
    layout: &'a Layout,
    any_azimuth: bool,
}

impl FirstOrder<'_> {
    /// What completing the records of a control has removed.
    fn removed(
        &self,
        synthesis: &Synthesis,
        refined: bool,
        control: &Control,
    ) -> Result<Vec<f64>, String> {
        let slopes = if refined {
            let finer = finer(synthesis).ok_or("the finer mesh has too many samples")?;
            self.slopes(&finer)
        } else {
            self.slopes(synthesis)
        };
        let fluxes = slopes.and_then(|slopes| self.fluxes(&slopes));
        let fluxes = fluxes.map_err(|error| error.to_string())?;
        Ok(control.removed(&fluxes).to_vec())
    }

    /// What the mesh adds to the plain estimate, where light of the first order reaches.
    fn shift(&self, synthesis: &Synthesis) -> Result<Vec<Option<f64>>, String> {
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

    fn shift_of_rough(&self, synthesis: &Synthesis) -> Result<Vec<Option<f64>>, ModelError> {
        let Case {
            psd,
            material,
            incidence,
            ..
        } = *self.case;
        let control = control_variate(&slopes(&psd)?, material, incidence, self.layout)?;
        let fluxes = self.fluxes(&self.slopes(synthesis)?)?;
        let of_mesh = Control::new(*self.layout, control.shares().clone(), &fluxes);
        let expected = of_mesh.expected().iter().zip(control.expected());
        let mut shift: Vec<Option<f64>> = expected
            .map(|(mesh, surface)| (mesh != surface).then_some(mesh - surface))
            .collect();
        // What single scattering gains, light scattered more often loses, and the energies hold both.
        let closed = control.removed(&fluxes);
        for total in [Layout::REFLECTED, Layout::TRANSMITTED, Layout::ABSORBED] {
            shift[total] = Some(closed[total]);
        }
        Ok(shift)
    }

    fn fluxes(&self, slopes: &SlopeCovariance) -> Result<UnshadowedFluxes, ModelError> {
        unshadowed_fluxes(slopes, self.case.material, self.case.incidence, self.layout)
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
