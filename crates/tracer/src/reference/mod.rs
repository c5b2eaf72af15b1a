//! One light path at a time, from interaction to interaction: the plain way to follow light.
//!
//! [`crate::Tracer`] follows many paths together, splits them, and takes short cuts; a [`PathIntegrator`] does none
//! of it. At an interface one way on is picked at random by its share, every flight is searched for facets
//! from its beginning, and the path is a loop. It is what the tracer is tested against, and what looks
//! through a camera: light is reversible, so that a path may as well be followed from the eye.

mod bottom;
mod seen;
mod state;

use asperity_optics::{Bottom, Material};
use asperity_surface::Border;
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};

use crate::accelerators::Accelerator;
use crate::geometry::{Geometry, Nearby};
use crate::interaction::facet::{Scattered, scatter};
use crate::interaction::layer::{Interface, TracedLayer};
use crate::periodic::{Heading, TraversalEnd, TraversalResult, approach, traverse, wrap};
use crate::ray::HalfSpace;
use crate::settings::PathSettings;
use crate::visibility::light_beams::LightBeams;

use bottom::{at_bottom, nothing};
pub use seen::{BeamContribution, CameraContribution, PathEnd, PathResult};
use state::{Path, Space};

/// Follows light that comes from above, one path at a time.
///
/// Of the settings it takes the roulette and the highest order; it always picks a branch.
pub struct PathIntegrator<'a, G: Geometry> {
    geometry: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    material: Material,
    settings: PathSettings,
    layer: Option<TracedLayer<'a, G>>,
    search: FlightSearch,
}

/// How a flight inside a layer is searched for facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightSearch {
    /// For all of its straight line.
    Full,
    /// By the heights nearby, where they can tell; the same facets are found.
    Nearby,
}

/// What comes next on a straight line.
enum Next<F> {
    /// A facet of one of the faces, after so far a flight.
    Facet(Interface, F, Heading, f64),
    FlatBottom(f64),
    Collision(f64),
    End(PathEnd),
}

impl<'a, G: Geometry> PathIntegrator<'a, G> {
    /// Light from above on a surface, and in the layer below it, if there is one.
    ///
    /// # Panics
    /// If there is a layer below what is no dielectric.
    #[must_use]
    pub fn new(
        geometry: &'a G,
        accelerator: &'a dyn Accelerator<G>,
        material: Material,
        settings: PathSettings,
        layer: Option<TracedLayer<'a, G>>,
    ) -> Self {
        assert!(
            layer.is_none() || material.transmitting_index().is_some(),
            "a half_space lies below a dielectric"
        );
        Self {
            geometry,
            accelerator,
            material,
            settings,
            layer,
            search: FlightSearch::Full,
        }
    }

    /// The same, which searches in another way.
    #[must_use]
    pub fn with_flight_search(self, search: FlightSearch) -> Self {
        Self { search, ..self }
    }

    /// Follows light that comes from above along a straight line, to its end.
    ///
    /// `origin`: tile coordinates of the upper surface, above it, be it over another tile; `direction`: a
    /// unit vector in the world.
    pub fn trace<R: Rng>(&self, origin: DVec3, direction: DVec3, rng: &mut R) -> PathResult {
        let mut path = Path::new(origin, direction);
        loop {
            if let Some(end) = self.step(&mut path, None, rng, &mut |_| {}) {
                return path.ended(end);
            }
        }
    }

    /// Looks along a straight line from above: the same, but where the surface divides the light first, both
    /// branches are followed, each with its share of the flux, so that there are one or two ends.
    ///
    /// With `beams` it also tells of light from their direction that is scattered into the path inside the
    /// layer. They are left out under a mirrored border, where a direction has several images, and in a medium
    /// that is the thinner one, in which light may rise below the surface; they end after some tiles.
    pub fn trace_camera_ray<R: Rng>(
        &self,
        origin: DVec3,
        direction: DVec3,
        beams: Option<&LightBeams<G>>,
        rng: &mut R,
        mut each: impl FnMut(CameraContribution),
    ) {
        let denser = self
            .material
            .transmitting_index()
            .is_some_and(|eta| eta >= 1.0);
        let beams = beams.filter(|_| denser && self.geometry.border() != Border::Mirrored);
        let mut path = Path::new(origin, direction);
        let (facet, at, t) = match self.next(&path, rng) {
            Next::Facet(Interface::Top, facet, at, t) => (facet, at, t),
            Next::End(end) => return each(CameraContribution::Path(path.ended(end))),
            _ => return each(CameraContribution::Path(path.ended(PathEnd::Lost))),
        };
        self.advance(&mut path, t);
        path.heading = at;
        let scattered = self.scattered(Interface::Top, facet, &path, rng);
        let mut absorbed = scattered.absorbed;
        for branch in scattered.branches {
            if branch.share > 0.0 {
                let mut path = path;
                path.flux = branch.share;
                path.absorbed = std::mem::take(&mut absorbed);
                path.go_on(Interface::Top, &branch);
                let end = loop {
                    if let Some(end) = self.step(&mut path, beams, rng, &mut each) {
                        break end;
                    }
                };
                let sampled_by_beams = beams.is_some_and(|beams| path.flight <= beams.farthest())
                    && end == PathEnd::Above
                    && path.scatterings > 0
                    && path.events_since == 1;
                each(CameraContribution::Path(PathResult {
                    sampled_by_beams,
                    ..path.ended(end)
                }));
            }
        }
    }

    /// Goes to the next interaction and beyond it, or to the end.
    fn step<R: Rng>(
        &self,
        path: &mut Path,
        beams: Option<&LightBeams<G>>,
        rng: &mut R,
        each: &mut impl FnMut(CameraContribution),
    ) -> Option<PathEnd> {
        match self.next(path, rng) {
            Next::End(end) => Some(end),
            Next::Facet(interface, facet, at, t) => {
                self.advance(path, t);
                path.heading = at;
                path.flight = t;
                if path.events.order() >= self.settings.max_order {
                    return Some(PathEnd::Truncated);
                }
                let scattered = self.scattered(interface, facet, path, rng);
                self.pick(interface, &scattered, path, rng)
            }
            Next::FlatBottom(t) => {
                let layer = self.layer.as_ref()?;
                if !self.fly(path, t) {
                    return Some(PathEnd::LeftPatch);
                }
                layer.put_onto_bottom(&mut path.heading.origin);
                let bottom = layer.bottom()?;
                if bottom == Bottom::Open {
                    return Some(PathEnd::Below);
                }
                if path.events.order() >= self.settings.max_order {
                    return Some(PathEnd::Truncated);
                }
                let wi = -path.heading.direction;
                let scattered = at_bottom(bottom, Space::Inside, wi, DVec3::Z, rng);
                let end = self.pick(Interface::Bottom, &scattered, path, rng);
                // Nothing lies beyond a plane.
                end.or((path.space == Space::Beyond).then_some(PathEnd::Below))
            }
            Next::Collision(t) => {
                let layer = self.layer.as_ref()?;
                if !self.fly(path, t) {
                    return Some(PathEnd::LeftPatch);
                }
                let scattered = path.flux * layer.albedo();
                path.absorbed += path.flux - scattered;
                path.flux = scattered;
                if scattered == 0.0 {
                    return Some(PathEnd::Absorbed);
                }
                if path.scatterings == layer.max_scatterings() {
                    return Some(PathEnd::Truncated);
                }
                path.scatterings += 1;
                path.events_since = 0;
                if let Some(beams) = beams {
                    self.find_sun(layer, path, beams, rng, each);
                }
                path.heading.direction = layer.scattered(path.heading.direction, rng);
                self.roulette(path, rng)
            }
        }
    }

    /// Tells of the light of beams that is scattered into a path where it is now.
    ///
    /// The light must reach from the facet to here without an interaction, of which a free flight of its own
    /// decides, and nothing may stand in its way inside and above.
    fn find_sun<R: Rng>(
        &self,
        layer: &TracedLayer<'_, G>,
        path: &Path,
        beams: &LightBeams<G>,
        rng: &mut R,
        each: &mut impl FnMut(CameraContribution),
    ) {
        let reach = layer.free_flight(rng);
        let goes_on = self.geometry.border() != Border::Open;
        let x = path.heading.origin;
        beams.holding(self.geometry, x, reach, goes_on, |beam| {
            let back = Heading {
                direction: -beam.direction,
                ..path.heading
            };
            let near = beam.t * (1.0 + 1e-9) + 1e-9;
            let Ok(Next::Facet(_, facet, at, t)) =
                self.meet(Interface::Top, &back, HalfSpace::Below, near)
            else {
                return;
            };
            if facet != beam.facet || t > near {
                return;
            }
            if let Ok(Next::Facet(_, _, _, t)) =
                self.meet(Interface::Bottom, &back, HalfSpace::Above, near)
                && t <= near
            {
                return;
            }
            let up = Heading {
                direction: beams.towards(),
                ..at
            };
            let sees = traverse(self.geometry, self.accelerator, up, HalfSpace::Above);
            if !matches!(
                sees,
                TraversalResult::Ended(TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_))
            ) {
                return;
            }
            let d = beam.direction;
            let phase = layer.phase_density(path.heading.direction.dot(-d));
            let level = DVec2::new(d.x, d.y * self.geometry.aspect());
            each(CameraContribution::Beam(BeamContribution {
                share: path.flux * phase * beam.share,
                origin: (path.place - beam.t * level).extend(at.origin.z),
            }));
        });
    }

    /// What a path comes to next on its straight line.
    fn next<R: Rng>(&self, path: &Path, rng: &mut R) -> Next<G::Facet> {
        let infinite = f64::INFINITY;
        let outside = |interface, half_space, end| {
            let met = self.meet(interface, &path.heading, half_space, infinite);
            met.unwrap_or_else(|other| Next::End(other.unwrap_or(end)))
        };
        let layer = match (path.space, &self.layer) {
            (Space::Above, _) => return outside(Interface::Top, HalfSpace::Above, PathEnd::Above),
            (Space::Inside, None) => {
                return outside(Interface::Top, HalfSpace::Below, PathEnd::Below);
            }
            (Space::Beyond, _) => {
                return outside(Interface::Bottom, HalfSpace::Below, PathEnd::Below);
            }
            (Space::Inside, Some(layer)) => layer,
        };
        let mut reach = layer.free_flight(rng);
        let mut next = Next::Collision(reach);
        let flat = layer.to_flat_bottom(&path.heading);
        if flat <= reach {
            reach = flat;
            next = Next::FlatBottom(flat);
        }
        let mut failed = None;
        for interface in TracedLayer::<G>::interfaces_ahead(path.heading.direction) {
            match self.meet(interface, &path.heading, interface.inner_side(), reach) {
                Ok(Next::Facet(interface, facet, at, t)) if t <= reach => {
                    reach = t;
                    next = Next::Facet(interface, facet, at, t);
                }
                Ok(_) => {}
                Err(end) => failed = failed.or(end),
            }
        }
        if reach.is_infinite() {
            // Nothing ends a clear medium.
            return Next::End(failed.unwrap_or(PathEnd::Below));
        }
        next
    }

    /// The facet of a face that a straight line comes to, which matters up to `reach`; or how it ends there,
    /// unless it escapes from that face.
    fn meet(
        &self,
        interface: Interface,
        heading: &Heading,
        half_space: HalfSpace,
        reach: f64,
    ) -> Result<Next<G::Facet>, Option<PathEnd>> {
        let (mut heading, mut geometry, mut accelerator) =
            (*heading, self.geometry, self.accelerator);
        if interface == Interface::Bottom {
            let Some((layer, bottom)) = self
                .layer
                .as_ref()
                .and_then(|s| s.surface().map(|b| (s, b)))
            else {
                return Err(None);
            };
            heading = layer.to_interface(interface, heading);
            (geometry, accelerator) = bottom;
        }
        let at = |heading| match &self.layer {
            Some(layer) => layer.from_interface(interface, heading),
            None => heading,
        };
        let inside = self.layer.is_some() && half_space == interface.inner_side();
        let gone = if self.search == FlightSearch::Nearby && inside {
            approach(geometry, &mut heading, half_space, reach)
        } else {
            0.0
        };
        let reach = reach - gone;
        if self.search == FlightSearch::Nearby && reach.is_finite() {
            let query = heading.query(geometry, half_space);
            match geometry.nearby(&query.ray, half_space, reach) {
                Nearby::Clear => return Err(None),
                Nearby::Met(hit) => {
                    let origin = geometry.snap(hit.facet, query.ray.at(hit.t));
                    let heading = Heading { origin, ..heading };
                    return Ok(Next::Facet(interface, hit.facet, at(heading), gone + hit.t));
                }
                Nearby::Unknown => {}
            }
        }
        match traverse(geometry, accelerator, heading, half_space) {
            TraversalResult::Hit(hit, heading) => {
                Ok(Next::Facet(interface, hit.facet, at(heading), gone + hit.t))
            }
            TraversalResult::Ended(TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_)) => {
                Err(None)
            }
            TraversalResult::Ended(TraversalEnd::LeftPatch) => Err(Some(PathEnd::LeftPatch)),
            TraversalResult::Ended(TraversalEnd::Lost) => Err(Some(PathEnd::Lost)),
        }
    }

    /// Moves the place of a path on by `t`.
    fn advance(&self, path: &mut Path, t: f64) {
        let world = path.heading.world_direction();
        path.place += t * DVec2::new(world.x, world.y * self.geometry.aspect());
    }

    /// Moves a path on by `t` inside the layer; false if it leaves an open patch.
    fn fly(&self, path: &mut Path, t: f64) -> bool {
        self.advance(path, t);
        let d = path.heading.direction;
        path.heading.origin += t * DVec3::new(d.x, d.y * self.geometry.aspect(), d.z);
        wrap(self.geometry, &mut path.heading)
    }

    /// What a facet does with the light that has come to it.
    fn scattered<R: Rng>(
        &self,
        interface: Interface,
        facet: G::Facet,
        path: &Path,
        rng: &mut R,
    ) -> Scattered {
        let wi = -path.heading.direction;
        let Some(layer) = self
            .layer
            .as_ref()
            .filter(|_| interface == Interface::Bottom)
        else {
            let above = path.space == Space::Above;
            let side = if above { 1.0 } else { -1.0 };
            return scatter(self.material, above, wi, side * self.geometry.normal(facet));
        };
        let (Some((geometry, _)), Some(bottom)) = (layer.surface(), layer.bottom()) else {
            return Scattered {
                absorbed: 1.0,
                ..nothing()
            };
        };
        let side = if path.space == Space::Inside {
            1.0
        } else {
            -1.0
        };
        let m = side * geometry.normal(facet);
        at_bottom(bottom, path.space, wi, m, rng)
    }

    /// Goes on along one branch, picked by its share.
    fn pick<R: Rng>(
        &self,
        interface: Interface,
        scattered: &Scattered,
        path: &mut Path,
        rng: &mut R,
    ) -> Option<PathEnd> {
        let [transmitted, reflected] = &scattered.branches;
        let kept = transmitted.share + reflected.share;
        path.absorbed += path.flux * scattered.absorbed;
        path.flux *= kept;
        if path.flux == 0.0 {
            return Some(PathEnd::Absorbed);
        }
        let branch = if rng.random::<f64>() * kept < reflected.share {
            reflected
        } else {
            transmitted
        };
        path.go_on(interface, branch);
        self.roulette(path, rng)
    }

    /// Weak light goes on with a probability proportional to its flux, and then carries the threshold.
    fn roulette<R: Rng>(&self, path: &mut Path, rng: &mut R) -> Option<PathEnd> {
        let threshold = self.settings.roulette_below;
        if path.flux >= threshold {
            return None;
        }
        let survives = rng.random::<f64>() * threshold < path.flux;
        let kept = if survives { threshold } else { 0.0 };
        path.truncated += path.flux - kept;
        path.flux = kept;
        (!survives).then_some(PathEnd::Truncated)
    }
}
