//! Tracer: follows the light of batches on a surface, round by round.

use asperity_optics::Material;
use asperity_tally::{ControlVariate, JointTallies, Tallies, TallySpec, TallyValues};

use crate::accelerators::{Accelerator, SearchedSurface};
use crate::geometry::Geometry;
use crate::interaction::stack::{Interface, TracedStack};
use crate::path::absorbed_cells::AbsorbedCells;
use crate::path::beam::Beam;
use crate::path::illumination::{Illumination, Starts};
use crate::path::state::batch::Batch;
use crate::path::state::conductors::{Conductors, MAX_CONDUCTORS};
use crate::path::state::segments::Kept;
use crate::path::state::work::Work;
use crate::random::PathStream;
use crate::ray::HalfSpace;
use crate::sampling::{BatchedRays, Positions};
use crate::settings::PathSettings;
use crate::vector::Instructions;

/// Follows light that falls on a surface.
///
/// # Examples
/// A plane of glass reflects 4 % of vertical light:
/// ```
/// use asperity_optics::{Incidence, Material};
/// use asperity_surface::HeightField;
/// use asperity_tally::{Component, HemisphereGrid, Side, TallyResult, TallySpec};
/// use asperity_tracer::{
///     AcceleratorKind, BuildAccelerator, HalfSpace, Illumination, PathSettings, PathStream, Surface,
///     Tracer,
/// };
///
/// let field = HeightField::new(vec![0.0; 64], [8, 8], [1.0, 1.0])?;
/// let surface = Surface::new(field);
/// let accelerator = surface.accelerator(AcceleratorKind::Auto)?;
/// let glass = Material::dielectric(1.5)?;
/// let tracer = Tracer::new(&surface, &*accelerator, glass, HalfSpace::Above, PathSettings::default());
///
/// let light = Illumination::new(Incidence::from_degrees(0.0, 0.0)?, false);
/// let spec = TallySpec::new(HemisphereGrid::new(6, 12)?, 0.1)?;
/// let (fluxes, work) = tracer.batch(&light, 10, spec, None, PathStream::new(1, 0));
/// assert_eq!(work.rays, 100);
/// assert!((fluxes.flux(Side::Reflected, Component::All) - 0.04).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Tracer<'a, G: Geometry> {
    pub(super) geometry: &'a G,
    pub(super) accelerator: &'a dyn Accelerator<G>,
    pub(super) material: Material,
    pub(super) incident: HalfSpace,
    pub(super) settings: PathSettings,
    pub(super) stack: TracedStack<'a, G>,
    /// Sums of the flux that facets of the upper surface absorb, if they are recorded.
    pub(super) absorbed: Option<&'a AbsorbedCells>,
    /// Indices `[eta, kappa]` of the conductors that are traced together; empty for a single material.
    pub(super) conductors: Vec<[f64; 2]>,
    pub(super) instructions: Instructions,
}

impl<'a, G: Geometry> Tracer<'a, G> {
    /// A tracer for light that comes from the `incident` half space.
    ///
    /// The indices of `material` are relative to the medium there, also where it lies below.
    #[must_use]
    pub fn new(
        geometry: &'a G,
        accelerator: &'a dyn Accelerator<G>,
        material: Material,
        incident: HalfSpace,
        settings: PathSettings,
    ) -> Self {
        Self {
            geometry,
            accelerator,
            material,
            incident,
            settings,
            stack: TracedStack::default(),
            absorbed: None,
            conductors: Vec::new(),
            instructions: Instructions::best(),
        }
    }

    /// This tracer with layers below the surface.
    ///
    /// # Panics
    /// If there are any, unless the light comes from above onto a dielectric. Layers that are lit from below are lit from above when
    /// they are turned over: see [`Shape::turned_over`](crate::Shape::turned_over).
    #[must_use]
    pub fn over(self, stack: TracedStack<'a, G>) -> Self {
        assert!(
            stack.layers().is_empty()
                || self.incident == HalfSpace::Above
                    && self.material.transmitting_index().is_some(),
            "layers lie below a dielectric that is lit from above"
        );
        Self { stack, ..self }
    }

    /// This tracer, which also adds the flux that each facet absorbs to its cell of `cells`.
    ///
    /// The sum over all cells is the absorbed flux of the tallies without a control variate. Tracing panics if a facet lies in a cell
    /// that is not there; facets of triangle meshes lie in none and add nothing.
    ///
    /// # Panics
    /// If several conductors are traced together.
    #[must_use]
    pub fn recording(self, cells: &'a AbsorbedCells) -> Self {
        assert!(
            self.conductors.is_empty(),
            "several conductors absorb differently"
        );
        Self {
            absorbed: Some(cells),
            ..self
        }
    }

    /// A tracer for several materials, each of which gets the bytes of a tracer of its own: see [`Tracer::batches_of_each`].
    ///
    /// # Panics
    /// Unless there is one material, or up to [`MAX_CONDUCTORS`] that are conductors.
    #[must_use]
    pub fn of_each(
        geometry: &'a G,
        accelerator: &'a dyn Accelerator<G>,
        materials: &[Material],
        incident: HalfSpace,
        settings: PathSettings,
    ) -> Self {
        if let &[material] = materials {
            return Self::new(geometry, accelerator, material, incident, settings);
        }
        let index = |material: &Material| match *material {
            Material::Conductor { eta, kappa } => [eta, kappa],
            other => panic!("{other:?} is traced alone"),
        };
        assert!(
            (1..=MAX_CONDUCTORS).contains(&materials.len()),
            "{} conductors at a time",
            materials.len()
        );
        Self {
            conductors: materials.iter().map(index).collect(),
            ..Self::new(geometry, accelerator, Material::Mirror, incident, settings)
        }
    }

    /// This tracer with the given instructions, or portably if the machine lacks them.
    #[must_use]
    pub fn with_instructions(self, instructions: Instructions) -> Self {
        Self {
            instructions,
            ..self
        }
    }

    /// Traces one batch of `strata * strata` rays: as [`Tracer::batches`].
    ///
    /// # Panics
    /// For the reasons of [`Tracer::batches`] and [`BatchedRays::of_one`].
    pub fn batch(
        &self,
        illumination: &Illumination,
        strata: u32,
        spec: TallySpec,
        control: Option<&ControlVariate>,
        stream: PathStream,
    ) -> (TallyValues, Work) {
        let rays = BatchedRays::of_one(strata);
        let (tallies, work) = self.batches(illumination, &rays, spec, control, stream);
        let mut fractions = tallies.into_fractions(rays.rays_of_batch());
        (fractions.swap_remove(0), work)
    }

    /// Traces rays of several batches together.
    ///
    /// Returns the sums over these rays in a tally of each batch, and the work done. Those of all rays of the batches, added
    /// in any order, make flux fractions; under a `control`, what it leaves of them, which [`ControlVariate::complete`] turns
    /// into flux fractions.
    ///
    /// Directions are those of the incident medium's frame: its side is +z, also when it is below
    /// the surface. The rays are paths of `stream`, those of the first batch from its first on, those of the others
    /// each [`PathStream::MAX_PATHS_OF_BATCH`] further. All accelerators, all instructions and
    /// all divisions of rays into calls give the same result.
    ///
    /// # Panics
    /// If there is both a layer and a control, or light of several directions and a control or starts on the surface, the tally keeps other measures than [`crate::Polarisation::polarimetry`], the
    /// sampling is quasi-random and the strata along a side are not [`crate::Sampling::quasi_random_strata`], or it is not stratified and
    /// the rays are not one whole batch.
    pub fn batches<'c>(
        &self,
        illumination: &Illumination,
        rays: &BatchedRays,
        spec: TallySpec,
        control: Option<&'c ControlVariate>,
        stream: PathStream,
    ) -> (Tallies<'c>, Work) {
        assert!(
            self.conductors.is_empty(),
            "several conductors have several tallies"
        );
        let found = self.batches_of_each(illumination, rays, spec, &[control], stream, &|| false);
        found.expect("nothing gives it up").remove(0)
    }

    /// Traces rays of several batches together, as [`Tracer::batches`], for each material of [`Tracer::of_each`] under its own of the
    /// `controls`; `None` once `gives_up` returns `true`, which is asked in every round.
    ///
    /// # Panics
    /// For the reasons of [`Tracer::batches`], if there are not as many controls as materials, or some materials have a control with
    /// another [`ControlVariate::shadow_probability`] than others.
    pub fn batches_of_each<'c>(
        &self,
        illumination: &Illumination,
        rays: &BatchedRays,
        spec: TallySpec,
        controls: &[Option<&'c ControlVariate>],
        stream: PathStream,
        gives_up: &dyn Fn() -> bool,
    ) -> Option<Vec<(Tallies<'c>, Work)>> {
        let materials = self.conductors.len().max(1);
        assert_eq!(controls.len(), materials, "a control for each material");
        let control = controls[0];
        let probability =
            |control: &Option<&ControlVariate>| control.map(ControlVariate::shadow_probability);
        assert!(
            controls
                .iter()
                .all(|one| probability(one) == probability(&control)),
            "shadows are traced for all materials alike"
        );
        assert!(
            illumination.spread.is_none()
                || control.is_none() && illumination.starts == Starts::FromAbove,
            "light of several directions starts from above, without a control variate"
        );
        assert!(
            self.stack.layers().is_empty() || control.is_none(),
            "there are no control variates for layers"
        );
        let polarimetry = self.settings.polarisation.polarimetry();
        assert!(
            spec.polarimetry() == polarimetry,
            "the tally keeps other measures of polarised light than paths carry"
        );
        let incidence = illumination.incidence;
        let turns = illumination.turns(self.settings.polarisation);
        let mut places = Positions::new(illumination.sampling, rays, turns, stream);
        let window = illumination.window;
        let beam = Beam::new(self.geometry, self.incident, incidence, window);
        let polarisation = self.settings.polarisation;
        let steepest = self.geometry.steepest_slope();
        let tally = beam.tally(illumination, polarisation, steepest, spec, control);
        let batches = rays.batches() as usize;
        let conductors = (!self.conductors.is_empty()).then(|| {
            let tallies = JointTallies::new(tally.clone(), batches, controls.to_vec());
            Conductors::new(&self.conductors, tallies, polarisation)
        });
        let batches = if conductors.is_some() { 0 } else { batches };
        let kept = Kept {
            turn: turns,
            polarisation,
            slot: conductors.is_some(),
        };
        let tallies = Tallies::new(tally, batches);
        let layers = self.stack.layers().len();
        let mut batch = Batch {
            conductors,
            stokes: illumination.stokes,
            traces_shadows: control.is_some() && illumination.starts == Starts::FromAbove,
            ..Batch::new(tallies, stream, self.instructions, kept, layers)
        };
        loop {
            self.start_paths(&beam, illumination, &mut places, &mut batch);
            if batch.is_finished() {
                break;
            }
            if gives_up() {
                return None;
            }
            self.search(&mut batch);
            if batch.conductors.is_some() {
                // Masked light is tallied before its path interacts, which changes what its row holds.
                self.tally_exits(&mut batch);
            }
            self.interact_at_surface(&mut batch);
            self.trace_flights(&mut batch);
            self.escape(&mut batch);
            self.tally_exits(&mut batch);
        }
        self.tally_exits(&mut batch);
        Some(batch.into_tallies())
    }

    /// The surface that is an interface, and how hits on it are found; `None` for a flat bottom.
    #[inline]
    pub(super) fn surface(&self, interface: Interface) -> Option<SearchedSurface<'a, G>> {
        if interface == Interface::TOP {
            return Some(SearchedSurface {
                geometry: self.geometry,
                accelerator: self.accelerator,
            });
        }
        self.stack.surface(interface)
    }
}
