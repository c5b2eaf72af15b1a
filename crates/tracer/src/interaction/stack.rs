//! Stack: the layers below a surface, and the faces between and below them, in the tile coordinates of the surface.

use asperity_numerics::elementary::{exp, ln, log10};
use asperity_optics::{Bottom, BottomSurface, Layer, PhaseFunction};
use glam::DVec3;

use crate::accelerators::SearchedSurface;
use crate::geometry::Geometry;
use crate::periodic::Heading;
use crate::ray::HalfSpace;

/// The layers below a surface, from above, as paths meet them; none below most surfaces.
pub struct TracedStack<'a, G: Geometry> {
    layers: Vec<TracedLayer<'a, G>>,
}

/// A layer, in the tile coordinates of the uppermost surface.
pub(crate) struct TracedLayer<'a, G: Geometry> {
    /// The interface above it.
    upper: Interface,
    /// The faces above and below it; none below a half space.
    faces: [Option<Face<'a, G>>; 2],
    /// z of these faces where they are planes; infinite elsewhere.
    planes: [f64; 2],
    /// Mean free path between sampled interactions; infinite in a medium that only absorbs.
    mean_free_path: f64,
    /// Absorption coefficient of a medium that only absorbs, by which light is weighted along its path; zero in others.
    absorption: f64,
    albedo: f64,
    phase: PhaseFunction,
    max_scatterings: u32,
}

/// A face of a layer.
struct Face<'a, G: Geometry> {
    /// Its surface; `None` for a plane.
    surface: Option<SearchedSurface<'a, G>>,
    bottom: Bottom,
    /// z of its mean plane.
    z: f64,
    /// Offset of z from the coordinates of the uppermost surface to its own; zero of a plane.
    shift: f64,
}

impl<G: Geometry> Clone for Face<'_, G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<G: Geometry> Copy for Face<'_, G> {}

/// A length to six digits and no less than it, as people write it.
fn rounded_up(length: f64) -> f64 {
    if length == 0.0 {
        return 0.0;
    }
    let unit = 10_f64.powi(log10(length.abs()).floor() as i32 - 5);
    let digits = (length / unit).ceil();
    // The nearest number that prints with these digits
    format!("{:.5e}", digits * unit).parse().unwrap_or(length)
}

/// Error of layers that do not fit below a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TracedLayerError {
    /// The surfaces would touch.
    #[error(
        "invalid thickness {thickness} of layer {layer}: must exceed {}, since the face above goes {} below its mean plane and that below rises {} above its own",
        rounded_up(depth + height), rounded_up(*depth), rounded_up(*height)
    )]
    TooThin {
        /// Number of the layer, from 1.
        layer: usize,
        /// Between both mean planes.
        thickness: f64,
        /// Depth of the lowest point of the surface below its mean plane.
        depth: f64,
        /// Height of the highest point of the bottom above its mean plane.
        height: f64,
    },
    /// A length out of proportion to the tile.
    #[error(
        "{what} is {value:e}; below a tile {extent:e} wide it must be from {least:e} to {most:e}, since rounding would blur where light is (limits of short and of long lengths are reached long before)"
    )]
    OutOfProportion {
        /// The mean free path or the thickness.
        what: &'static str,
        /// The given length.
        value: f64,
        /// The longer side of the tile, in the same unit.
        extent: f64,
        /// Least that is possible.
        least: f64,
        /// Most that is possible.
        most: f64,
    },
    /// The bottom has another tile.
    #[error(
        "the bottom does not lie under the surface: its tile is {} x {}, {bottom_border}, that of the surface {} x {}, {top_border}",
        bottom[0], bottom[1], top[0], top[1]
    )]
    OtherTile {
        /// Extent of the surface along x and y.
        top: [f64; 2],
        /// Continuation of the surface beyond its border.
        top_border: asperity_surface::Border,
        /// Extent of the bottom.
        bottom: [f64; 2],
        /// Continuation of the bottom beyond its border.
        bottom_border: asperity_surface::Border,
    },
    /// An open bottom is no interface.
    #[error("an open bottom has no shape: take a flat one, or another kind of bottom")]
    OpenShape,
}

/// Mean free paths over the largest coordinate, at the least: shorter steps would drown in its rounding.
const MIN_FREE_PATH: f64 = 1e-12;

/// Mean free paths and thicknesses over the tile, at the most: of a point so far away rounding still tells over which
/// part of a column it lies. Flat faces are alike everywhere, and have no such limit.
const MAX_LENGTH: f64 = 1e10;

/// Largest thickness above a bottom with a shape, over the tile. The heights of such a bottom are rounded in proportion
/// to its depth.
const MAX_DEPTH: f64 = 1e6;

/// Scatterings inside a layer after which a path is truncated unless another number is given.
pub const DEFAULT_MAX_SCATTERINGS: u32 = 100_000;

/// One of the interfaces of a stack, numbered from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Interface(u32);

impl Interface {
    /// The uppermost surface.
    pub(crate) const TOP: Self = Self(0);

    /// The next one below.
    pub(crate) const fn next(self) -> Self {
        Self(self.0 + 1)
    }

    /// Its number.
    pub(crate) const fn number(self) -> usize {
        self.0 as usize
    }
}

impl<G: Geometry> Default for TracedStack<'_, G> {
    /// No layers.
    fn default() -> Self {
        Self { layers: Vec::new() }
    }
}

impl<'a, G: Geometry> TracedStack<'a, G> {
    /// Layers below `top`, from above. `surfaces` has the surface of the bottom of each where it is one of its own; missing ones
    /// follow from [`Layer::end`]. Light that is scattered inside `max_scatterings` times is truncated.
    ///
    /// # Errors
    /// [`TracedLayerError`] if a layer is too thin for the heights of its faces, or its bottom has another tile.
    ///
    /// # Panics
    /// If there is a layer below a half space or an opaque bottom.
    pub fn new(
        top: SearchedSurface<'a, G>,
        layers: &[Layer],
        surfaces: &[Option<SearchedSurface<'a, G>>],
        max_scatterings: u32,
    ) -> Result<Self, TracedLayerError> {
        let mut upper = Face {
            surface: Some(top),
            bottom: Bottom::Open,
            z: top.geometry.mean_plane(),
            shift: 0.0,
        };
        let mut traced = Vec::with_capacity(layers.len());
        for (number, layer) in layers.iter().enumerate() {
            let ends_light = number > 0 && upper.bottom.index_beyond().is_none();
            assert!(!ends_light, "a layer below one that lets no light through");
            let own = surfaces.get(number).copied().flatten();
            let is_same = layer
                .end()
                .is_some_and(|slab| slab.shape == BottomSurface::Same);
            let surface = own.or(is_same.then_some(top));
            let lower = Face::below(&upper, top.geometry, (number + 1, layer), surface)?;
            let plane = |face: Option<Face<'a, G>>, none: f64| {
                face.filter(|face| face.surface.is_none())
                    .map_or(none, |face| face.z)
            };
            let medium = layer.medium();
            let unit = top.geometry.unit();
            let [mean_free_path, absorption] = match medium.albedo() {
                0.0 => [f64::INFINITY, medium.extinction() * unit],
                _ => [medium.mean_free_path() / unit, 0.0],
            };
            traced.push(TracedLayer {
                upper: Interface(number as u32),
                faces: [Some(upper), lower],
                planes: [
                    plane(Some(upper), f64::INFINITY),
                    plane(lower, f64::NEG_INFINITY),
                ],
                mean_free_path,
                absorption,
                albedo: medium.albedo(),
                phase: medium.phase(),
                max_scatterings,
            });
            match lower {
                Some(lower) => upper = lower,
                None => assert!(number + 1 == layers.len(), "a layer below a half space"),
            }
        }
        Ok(Self { layers: traced })
    }

    /// The layers, from above.
    pub(crate) fn layers(&self) -> &[TracedLayer<'a, G>] {
        &self.layers
    }

    /// The layer on one side of an interface, if there is one.
    #[inline(always)]
    pub(crate) fn layer_at(
        &self,
        interface: Interface,
        half_space: HalfSpace,
    ) -> Option<&TracedLayer<'a, G>> {
        match half_space {
            HalfSpace::Below => self.layers.get(interface.number()),
            HalfSpace::Above => self.layers.get(interface.number().checked_sub(1)?),
        }
    }

    /// The surface of an interface below the uppermost one, where it is not a plane.
    pub(crate) fn surface(&self, interface: Interface) -> Option<SearchedSurface<'a, G>> {
        self.face(interface)?.surface
    }

    /// The bottom of the layer above an interface.
    pub(crate) fn bottom(&self, interface: Interface) -> Option<Bottom> {
        Some(self.face(interface)?.bottom)
    }

    /// The interfaces below the uppermost surface, from above.
    pub(crate) fn interfaces(&self) -> impl Iterator<Item = Interface> + use<'a, G> {
        (1..=self.layers.len() as u32).map(Interface)
    }

    fn face(&self, interface: Interface) -> Option<&Face<'a, G>> {
        let above = self.layers.get(interface.number().checked_sub(1)?)?;
        above.faces[1].as_ref()
    }

    /// Offset of z from the coordinates of the uppermost surface to those of `interface`.
    #[inline(always)]
    fn shift_to(&self, interface: Interface) -> f64 {
        self.face(interface).map_or(0.0, |face| face.shift)
    }

    /// A heading in the coordinates of the uppermost surface, in those of `interface`.
    #[inline]
    pub(crate) fn to_interface(&self, interface: Interface, mut heading: Heading) -> Heading {
        if let Some(Face {
            surface: Some(SearchedSurface { geometry, .. }),
            shift,
            ..
        }) = self.face(interface)
        {
            heading.origin.z += shift;
            // Below a thick layer a height loses digits to the depth
            geometry.lift(&mut heading.origin, 2.0 * f64::EPSILON * shift);
        }
        heading
    }

    /// A heading in the coordinates of `interface`, in those of the uppermost surface.
    #[inline]
    pub(crate) fn to_uppermost(&self, interface: Interface, mut heading: Heading) -> Heading {
        heading.origin.z -= self.shift_to(interface);
        heading
    }
}

impl<'a, G: Geometry> Face<'a, G> {
    /// The face below layer number `number` under the face `upper`; `None` below a half space.
    fn below(
        upper: &Self,
        top: &G,
        (number, layer): (usize, &Layer),
        surface: Option<SearchedSurface<'a, G>>,
    ) -> Result<Option<Self>, TracedLayerError> {
        let surface = surface.filter(|_| layer.end().is_some());
        for face in upper.surface.iter().chain(&surface) {
            face.geometry.prepare_nearby();
        }
        let unit = top.unit();
        let extent = top.extent().into_iter().fold(0.0, f64::max);
        // Heights of the face above about its mean plane; there is no relief of a plane
        let [low, high] = match upper.surface {
            Some(SearchedSurface { geometry, .. }) => geometry.z_range(),
            None => [0.0; 2],
        };
        let has_shape = surface.is_some();
        let range = LengthRange {
            extent,
            unit,
            is_limited: low != high || has_shape,
        };
        let free_path = layer.medium().mean_free_path() / unit;
        if free_path.is_finite() {
            let least = MIN_FREE_PATH * extent.max(high);
            let most = MAX_LENGTH * extent;
            range.check("the mean free path", free_path, least, most)?;
        }
        let Some(slab) = layer.end() else {
            return Ok(None);
        };
        let most = if has_shape { MAX_DEPTH } else { MAX_LENGTH } * extent;
        let z = upper.z - slab.thickness / unit;
        range.check("the thickness", slab.thickness / unit, 0.0, most)?;
        let mut face = Face {
            surface,
            bottom: slab.bottom,
            z,
            shift: 0.0,
        };
        let mut height = 0.0;
        if let Some(SearchedSurface { geometry, .. }) = surface {
            if slab.bottom == Bottom::Open {
                return Err(TracedLayerError::OpenShape);
            }
            check_tile(top, geometry)?;
            face.shift = geometry.mean_plane() - z;
            height = geometry.z_range()[1] - geometry.mean_plane();
        }
        let depth = match upper.surface {
            Some(SearchedSurface { geometry, .. }) => geometry.mean_plane() - low,
            None => 0.0,
        };
        if depth + height >= slab.thickness / unit {
            return Err(TracedLayerError::TooThin {
                layer: number,
                thickness: slab.thickness,
                depth: depth * unit,
                height: height * unit,
            });
        }
        Ok(Some(face))
    }
}

impl<G: Geometry> TracedLayer<'_, G> {
    /// Its number, from above.
    pub(crate) const fn number(&self) -> usize {
        self.upper.number()
    }

    /// The interface above it.
    pub(crate) const fn upper(&self) -> Interface {
        self.upper
    }

    /// The interface below it, which a half space has not.
    pub(crate) const fn lower(&self) -> Interface {
        self.upper.next()
    }

    /// Bottom of the layer; `None` for a half space.
    pub(crate) fn bottom(&self) -> Option<Bottom> {
        Some(self.faces[1].as_ref()?.bottom)
    }

    /// Extinction coefficient, tile coordinates.
    pub(crate) fn extinction(&self) -> f64 {
        self.absorption + self.mean_free_path.recip()
    }

    /// Fraction of an interaction inside that scatters.
    pub(crate) const fn albedo(&self) -> f64 {
        self.albedo
    }

    /// Phase function of the medium.
    pub(crate) const fn phase(&self) -> PhaseFunction {
        self.phase
    }

    /// Scatterings after which a path is truncated.
    pub(crate) const fn max_scatterings(&self) -> u32 {
        self.max_scatterings
    }

    /// Length of a free flight, tile coordinates: exponentially distributed, by a uniform number in `[0, 1)` that is a
    /// multiple of `2^-53`.
    #[inline(always)]
    pub(crate) fn free_flight(&self, u: f64) -> f64 {
        // One minus a number below one is above zero.
        let depth = -ln(1.0 - u);
        if self.mean_free_path.is_infinite() {
            f64::INFINITY
        } else {
            depth * self.mean_free_path
        }
    }

    /// Fraction of light that is left after a distance in a medium that only absorbs; `None` of others.
    #[inline(always)]
    pub(crate) fn transmittance(&self, distance: f64) -> Option<f64> {
        (self.absorption > 0.0).then(|| exp(-self.absorption * distance))
    }

    /// Distance from a height to the flat face ahead of a direction that rises by `dz`; infinite if no flat face lies ahead.
    #[inline(always)]
    pub(crate) fn to_plane(&self, z: f64, dz: f64) -> f64 {
        let [upper, lower] = self.planes;
        let plane = if dz > 0.0 { upper } else { lower };
        let to_plane = (plane - z) / dz;
        let to_plane = if to_plane > 0.0 { to_plane } else { 0.0 };
        if dz != 0.0 { to_plane } else { f64::INFINITY }
    }

    /// The interface ahead of a direction that rises by `dz`, and the half space of it in which the layer lies.
    pub(crate) fn interface_towards(&self, dz: f64) -> (Interface, HalfSpace) {
        let interface = if dz > 0.0 { self.upper } else { self.lower() };
        (interface, self.side_of(interface))
    }

    /// Puts a point onto the flat face ahead of a direction that rises by `dz`.
    pub(crate) fn put_onto_plane(&self, origin: &mut DVec3, dz: f64) {
        let [upper, lower] = self.planes;
        origin.z = if dz > 0.0 { upper } else { lower };
    }

    /// The half space of one of its interfaces in which the layer lies.
    #[inline(always)]
    pub(crate) fn side_of(&self, interface: Interface) -> HalfSpace {
        if interface == self.upper {
            HalfSpace::Below
        } else {
            HalfSpace::Above
        }
    }

    /// Offset of z from the coordinates of the uppermost surface to those of one of its interfaces.
    #[inline(always)]
    pub(crate) fn shift_to(&self, interface: Interface) -> f64 {
        let face = &self.faces[usize::from(interface != self.upper)];
        face.as_ref().map_or(0.0, |face| face.shift)
    }

    /// Number of its interfaces that have a surface.
    #[inline]
    pub(crate) fn interfaces(&self) -> u32 {
        [0, 1].map(|i| u32::from(self.has_surface(i))).iter().sum()
    }

    #[inline(always)]
    fn has_surface(&self, face: usize) -> bool {
        self.faces[face].is_some_and(|face| face.surface.is_some())
    }

    /// The interface that comes as number `rank` of those with a surface, from zero, to light inside that rises by `dz`.
    #[inline(always)]
    pub(crate) fn interface_ahead(&self, dz: f64, rank: u32) -> Interface {
        let is_upper = match [self.has_surface(0), self.has_surface(1)] {
            [_, false] => true,
            [false, true] => false,
            [true, true] => (rank == 0) == (dz <= 0.0),
        };
        if is_upper { self.upper } else { self.lower() }
    }

    /// The rank of `interface` among those interfaces.
    #[inline]
    pub(crate) fn rank_ahead(&self, dz: f64, interface: Interface) -> u32 {
        u32::from(self.interface_ahead(dz, 0) != interface)
    }
}

/// The range of lengths that rounding allows below a tile, in tile coordinates.
struct LengthRange {
    /// The longer side of the tile.
    extent: f64,
    unit: f64,
    /// `true` if there is a largest length. Flat interfaces are alike everywhere, and have none.
    is_limited: bool,
}

impl LengthRange {
    fn check(
        &self,
        what: &'static str,
        value: f64,
        least: f64,
        most: f64,
    ) -> Result<(), TracedLayerError> {
        let most = if self.is_limited { most } else { f64::MAX };
        if (least..=most).contains(&value) {
            return Ok(());
        }
        Err(TracedLayerError::OutOfProportion {
            what,
            value: value * self.unit,
            extent: self.extent * self.unit,
            least: least * self.unit,
            most: most * self.unit,
        })
    }
}

/// Checks that a bottom has the same tile as the surface above it.
fn check_tile<G: Geometry>(top: &G, bottom: &G) -> Result<(), TracedLayerError> {
    let same = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
        // Spacings that were read from files may differ by rounding.
        (a - c).abs() <= 1e-9 * a && (b - d).abs() <= 1e-9 * b
    };
    let same_cells =
        same(top.extent(), bottom.extent()) && same([top.unit(); 2], [bottom.unit(); 2]);
    if same_cells && top.border() == bottom.border() {
        return Ok(());
    }
    let tile = |of: &G| {
        let [x, y] = of.extent().map(|e| e * of.unit());
        [x, y / of.aspect()]
    };
    Err(TracedLayerError::OtherTile {
        top: tile(top),
        top_border: top.border(),
        bottom: tile(bottom),
        bottom_border: bottom.border(),
    })
}
