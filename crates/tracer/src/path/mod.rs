//! Path engine: follows many light paths together, from interaction to interaction, until all flux has left.
//!
//! Each file is one step of a path. `emission.rs` starts it. `traversal.rs` takes its segments from tile to tile,
//! many of them at a time. `interaction.rs` scatters it at a facet, and `flight.rs` inside the layer below.
//! `escape.rs` makes of what leaves an exit for the tally. `masking.rs` traces what a control variate needs in addition to
//! it. `state.rs` names what passes between these steps. The same light, one path at a time, is in `reference`.

mod batch;
mod beam;
mod emission;
mod escape;
mod flight;
mod illumination;
mod interaction;
mod masking;
mod state;
mod traversal;
mod work;

use std::f64::consts::{PI, TAU};

use asperity_optics::Material;
use asperity_tally::{Azimuth, ControlVariate, Tally, TallySpec, TallyValues};
use glam::DVec2;
use rand::Rng;

use self::batch::{Batch, MAX_IN_FLIGHT};
use self::beam::Beam;
use self::state::SegmentQueue;
use crate::accelerators::Accelerator;
use crate::geometry::Geometry;
use crate::interaction::layer::{Interface, TracedLayer};
use crate::ray::HalfSpace;
use crate::sampling::Places;
use crate::settings::PathSettings;

pub use illumination::{Illumination, Starts};
pub use work::Work;

/// Follows light that falls on a surface.
///
/// # Examples
/// A plane of glass reflects 4 % of vertical light:
/// ```
/// use asperity_optics::{Incidence, Material};
/// use asperity_surface::HeightField;
/// use asperity_tally::{Component, HemisphereGrid, Side, TallyResult, TallySpec};
/// use asperity_tracer::{
///     AcceleratorKind, BuildAccelerator, HalfSpace, Illumination, PathSettings, Surface, Tracer,
/// };
/// use rand::SeedableRng;
///
/// let field = HeightField::new(vec![0.0; 64], [8, 8], [1.0, 1.0])?;
/// let surface = Surface::new(field);
/// let accelerator = surface.accelerator(AcceleratorKind::Auto)?;
/// let glass = Material::dielectric(1.5)?;
/// let tracer = Tracer::new(&surface, &*accelerator, glass, HalfSpace::Above, PathSettings::default());
///
/// let light = Illumination::new(Incidence::from_degrees(0.0, 0.0)?, false);
/// let spec = TallySpec::new(HemisphereGrid::new(6, 12)?, 0.1)?;
/// let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
/// let (fluxes, work) = tracer.batch(&light, 10, spec, None, &mut rng);
/// assert_eq!(work.rays, 100);
/// assert!((fluxes.flux(Side::Reflected, Component::All) - 0.04).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Tracer<'a, G: Geometry> {
    geometry: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    material: Material,
    incident: HalfSpace,
    settings: PathSettings,
    layer: Option<TracedLayer<'a, G>>,
}

impl<'a, G: Geometry> Tracer<'a, G> {
    /// A tracer for light that comes from the `incident` half space.
    ///
    /// The indices of `material` are relative to the medium there, also where it lies below.
    #[must_use]
    pub const fn new(
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
        }
    }

    /// The same with a layer of medium below the surface.
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

    /// Traces one batch of `strata * strata` rays.
    ///
    /// Returns flux fractions, and the work done; under a `control_variate`, the fractions that it
    /// leaves, which [`ControlVariate::complete`] turns into flux fractions.
    ///
    /// Directions are those of the incident medium's frame: its side is +z, also when it is below
    /// the surface. Random numbers are drawn in an order that depends on the paths alone, so all
    /// accelerators give the same result.
    ///
    /// # Panics
    /// If there is both a layer and a control variate, or the sampling is quasi-random and `strata` is not a [`crate::Sampling::quasi_random_strata`].
    pub fn batch<R: Rng>(
        &self,
        illumination: &Illumination,
        strata: u32,
        spec: TallySpec,
        control_variate: Option<&ControlVariate>,
        rng: &mut R,
    ) -> (TallyValues, Work) {
        assert!(
            self.layer.is_none() || control_variate.is_none(),
            "there are no control variates for layers"
        );
        let incidence = illumination.incidence;
        // Vertical light has no azimuth to draw.
        let free = illumination.any_azimuth && incidence.is_vertical();
        let azimuth = if free {
            Azimuth::Free
        } else {
            Azimuth::From(incidence.phi() + PI)
        };
        let turned = illumination.any_azimuth && !free;
        let mut places = Places::new(illumination.sampling, strata, turned, rng);
        let tally = Tally::new(spec, azimuth).with_control_variate(control_variate);
        let mut batch = Batch::new(tally, rng);
        let beam = Beam::new(self.geometry, self.incident, incidence);
        let mut now = [SegmentQueue::new(), SegmentQueue::new()];
        let mut hits = Vec::new();
        loop {
            // Start new paths where there is room
            while batch.continuing < MAX_IN_FLIGHT
                && let Some([u, v, azimuth]) = places.draw(batch.rng)
            {
                let turn = DVec2::from_angle(TAU * azimuth);
                self.emit(&beam, illumination.starts, [u, v], turn, &mut batch);
                self.trace_flights(&mut batch);
                batch.work.rays += 1;
            }
            if !batch.begin_round(&mut now) {
                break;
            }
            for (interface, queue) in [Interface::Top, Interface::Bottom]
                .into_iter()
                .zip(&mut now)
            {
                // Search all segments for their closest hits
                let Some((geometry, accelerator)) = self.surface(interface) else {
                    continue;
                };
                accelerator.closest_hits(geometry, &queue.queries, &mut hits);

                // Continue each in the next tile, at a facet, or into the tally
                let segments = queue.segments.drain(..).zip(&mut queue.queries);
                for ((segment, query), hit) in segments.zip(&hits) {
                    self.advance(interface, segment, query, hit, &mut batch);
                    self.trace_flights(&mut batch);
                }
                queue.queries.clear();
            }
        }
        let rays = batch.work.rays;
        (batch.tally.into_fractions(rays), batch.work)
    }

    /// The surface that is an interface, and how hits on it are found; `None` for a flat bottom.
    #[inline]
    fn surface(&self, interface: Interface) -> Option<(&'a G, &'a dyn Accelerator<G>)> {
        match interface {
            Interface::Top => Some((self.geometry, self.accelerator)),
            Interface::Bottom => self.layer.as_ref().and_then(TracedLayer::surface),
        }
    }

    /// The surface alone.
    #[inline]
    fn geometry_of(&self, interface: Interface) -> Option<&'a G> {
        self.surface(interface).map(|(geometry, _)| geometry)
    }
}
