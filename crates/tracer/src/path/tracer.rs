//! Tracer: follows the light of batches on a surface, round by round.

use std::f64::consts::PI;

use asperity_optics::Material;
use asperity_tally::{Azimuth, ControlVariate, Tallies, Tally, TallySpec, TallyValues};

use crate::accelerators::{Accelerator, SearchedSurface};
use crate::geometry::Geometry;
use crate::interaction::layer::{Interface, TracedLayer};
use crate::path::beam::Beam;
use crate::path::illumination::{Illumination, Starts};
use crate::path::state::batch::Batch;
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
    pub(super) layer: Option<TracedLayer<'a, G>>,
    instructions: Instructions,
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
            layer: None,
            instructions: Instructions::best(),
        }
    }

    /// This tracer with a layer of medium below the surface.
    ///
    /// # Panics
    /// Unless the light comes from above onto a dielectric: there is no medium elsewhere.
    #[must_use]
    pub fn over(self, layer: TracedLayer<'a, G>) -> Self {
        assert!(
            self.incident == HalfSpace::Above && self.material.transmitting_index().is_some(),
            "a medium lies below a dielectric that is lit from above"
        );
        Self {
            layer: Some(layer),
            ..self
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
    /// If there is both a layer and a control, the tally keeps other measures than [`crate::Polarisation::polarimetry`], the
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
        let found = self.batches_unless(illumination, rays, spec, control, stream, &|| false);
        found.expect("nothing gives it up")
    }

    /// Traces rays as [`Tracer::batches`]; `None` once `gives_up` returns `true`, which is asked in every round.
    pub(crate) fn batches_unless<'c>(
        &self,
        illumination: &Illumination,
        rays: &BatchedRays,
        spec: TallySpec,
        control: Option<&'c ControlVariate>,
        stream: PathStream,
        gives_up: &dyn Fn() -> bool,
    ) -> Option<(Tallies<'c>, Work)> {
        assert!(
            self.layer.is_none() || control.is_none(),
            "there are no control variates for layers"
        );
        let polarimetry = self.settings.polarisation.polarimetry();
        assert!(
            spec.polarimetry() == polarimetry,
            "the tally keeps other measures of polarised light than paths carry"
        );
        let incidence = illumination.incidence;
        // Of vertical light from any azimuth the azimuths of exits have no meaning.
        let turns = illumination.turns(self.settings.polarisation);
        let azimuth = if illumination.any_azimuth && !turns {
            Azimuth::Free
        } else {
            Azimuth::From(incidence.phi() + PI)
        };
        let mut places = Positions::new(illumination.sampling, rays, turns, stream);
        let window = illumination.window;
        let beam = Beam::new(self.geometry, self.incident, incidence, window);
        let tally = Tally::new(spec, azimuth)
            .with_control_variate(control)
            .with_largest_weight(self.largest_weight(&beam, illumination.starts, control));
        let tallies = Tallies::new(tally, rays.batches() as usize);
        let mut batch = Batch::new(
            tallies,
            stream,
            self.instructions,
            illumination,
            self.settings.polarisation,
        );
        loop {
            self.start_paths(&beam, illumination.starts, &mut places, &mut batch);
            if batch.is_finished() {
                break;
            }
            if gives_up() {
                return None;
            }
            self.search(&mut batch);
            self.interact_at_surface(&mut batch);
            self.trace_flights(&mut batch);
            self.escape(&mut batch);
            self.tally_exits(&mut batch);
        }
        self.tally_exits(&mut batch);
        Some((batch.tallies, batch.work))
    }

    /// Upper bound of the flux that a path adds to an entry at a time: that with which it starts, which branches share and Russian
    /// roulette raises to one at the most. Shadowed facets that are traced count for those that are not.
    fn largest_weight(&self, beam: &Beam, starts: Starts, control: Option<&ControlVariate>) -> f64 {
        let start = match starts {
            Starts::FromAbove => 1.0,
            Starts::OnSurface => beam.largest_flux_on(self.geometry.steepest_slope()),
        };
        start / control.map_or(1.0, ControlVariate::shadow_probability)
    }

    /// The surface that is an interface, and how hits on it are found; `None` for a flat bottom.
    #[inline]
    pub(super) fn surface(&self, interface: Interface) -> Option<SearchedSurface<'a, G>> {
        match interface {
            Interface::Top => Some(SearchedSurface {
                geometry: self.geometry,
                accelerator: self.accelerator,
            }),
            Interface::Bottom => self.layer.as_ref().and_then(TracedLayer::surface),
        }
    }
}
