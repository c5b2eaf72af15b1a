//! Layer: a medium below a surface, and the bottom that it ends on, in the tile coordinates of the surface.

use std::fmt;
use std::str::FromStr;

use asperity_optics::{Bottom, Layer, PhaseFunction, ln_of_normal};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::accelerators::SearchedSurface;
use crate::geometry::Geometry;
use crate::periodic::Heading;
use crate::ray::HalfSpace;

/// The shape of a layer's bottom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BottomSurface {
    /// A plane.
    #[default]
    Flat,
    /// The surface above, moved down.
    Same,
    /// Another surface of the same statistics, of a realisation of its own.
    Independent,
}

impl fmt::Display for BottomSurface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Flat => "flat",
            Self::Same => "same",
            Self::Independent => "independent",
        })
    }
}

impl FromStr for BottomSurface {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        [Self::Flat, Self::Same, Self::Independent]
            .into_iter()
            .find(|shape| shape.to_string() == text)
            .ok_or_else(|| {
                format!("unknown bottom surface `{text}`; allowed are flat, same and independent")
            })
    }
}

/// A layer of a medium below a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerBelow {
    /// The medium, the thickness, and what it ends on.
    pub layer: Layer,
    /// The shape of its bottom, unless the given surface has a bottom of its own.
    pub bottom: BottomSurface,
}

impl LayerBelow {
    /// The layer below `top`, as paths meet it; `bottom` is the surface that it ends on, if it has one of its own.
    ///
    /// # Errors
    /// [`TracedLayerError`] if the layer does not fit below the surface.
    pub fn traced<'a, G: Geometry>(
        &self,
        top: SearchedSurface<'a, G>,
        bottom: Option<SearchedSurface<'a, G>>,
        max_scatterings: u32,
    ) -> Result<TracedLayer<'a, G>, TracedLayerError> {
        let bottom = bottom.or((self.bottom == BottomSurface::Same).then_some(top));
        TracedLayer::new(top.geometry, &self.layer, bottom, max_scatterings)
    }
}

/// A layer below a surface, in the tile coordinates of that surface.
pub struct TracedLayer<'a, G: Geometry> {
    /// The surface that the layer ends on; `None` for a plane.
    surface: Option<SearchedSurface<'a, G>>,
    bottom: Option<Bottom>,
    /// z of the mean plane of the bottom; far below everything if there is none.
    bottom_z: f64,
    /// Offset of z from the coordinates of the upper surface to those of the bottom.
    shift: f64,
    mean_free_path: f64,
    albedo: f64,
    phase: PhaseFunction,
    max_scatterings: u32,
}

/// A length to six digits and no less than it, as people write it.
fn rounded_up(length: f64) -> f64 {
    if length == 0.0 {
        return 0.0;
    }
    let unit = 10_f64.powi(length.abs().log10().floor() as i32 - 5);
    let digits = (length / unit).ceil();
    // The nearest number that prints with these digits
    format!("{:.5e}", digits * unit).parse().unwrap_or(length)
}

/// Error of a layer that does not fit below a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TracedLayerError {
    /// The surfaces would touch.
    #[error(
        "invalid thickness {thickness}: must exceed {}, since the surface goes {} below its mean plane and the bottom rises {} above its own",
        rounded_up(depth + height), rounded_up(*depth), rounded_up(*height)
    )]
    TooThin {
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

/// One of the two surfaces of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interface {
    Top,
    Bottom,
}

impl<'a, G: Geometry> TracedLayer<'a, G> {
    /// A layer below `top`; light that is scattered inside `max_scatterings` times is truncated.
    ///
    /// # Errors
    /// [`TracedLayerError`] if the layer is too thin for the heights of its surfaces, or its bottom another tile.
    pub fn new(
        top: &G,
        layer: &Layer,
        surface: Option<SearchedSurface<'a, G>>,
        max_scatterings: u32,
    ) -> Result<Self, TracedLayerError> {
        top.prepare_nearby();
        let unit = top.unit();
        let medium = layer.medium();
        let mut traced = Self {
            surface: surface.filter(|_| layer.end().is_some()),
            bottom: None,
            bottom_z: f64::NEG_INFINITY,
            shift: 0.0,
            mean_free_path: medium.mean_free_path() / unit,
            albedo: medium.albedo(),
            phase: medium.phase(),
            max_scatterings,
        };
        let extent = top.extent().into_iter().fold(0.0, f64::max);
        let [low, high] = top.z_range();
        let has_shape = traced.surface.is_some();
        let range = LengthRange {
            extent,
            unit,
            is_limited: low != high || has_shape,
        };
        if traced.mean_free_path.is_finite() {
            let least = MIN_FREE_PATH * extent.max(high);
            let most = MAX_LENGTH * extent;
            range.check("the mean free path", traced.mean_free_path, least, most)?;
        }
        let Some(slab) = layer.end() else {
            return Ok(traced);
        };
        let most = if has_shape { MAX_DEPTH } else { MAX_LENGTH } * extent;
        range.check("the thickness", slab.thickness / unit, 0.0, most)?;
        traced.bottom = Some(slab.bottom);
        traced.bottom_z = top.mean_plane() - slab.thickness / unit;
        let mut height = 0.0;
        if let Some(SearchedSurface { geometry, .. }) = traced.surface {
            if slab.bottom == Bottom::Open {
                return Err(TracedLayerError::OpenShape);
            }
            check_tile(top, geometry)?;
            geometry.prepare_nearby();
            traced.shift = geometry.mean_plane() - traced.bottom_z;
            height = geometry.z_range()[1] - geometry.mean_plane();
        }
        let depth = top.mean_plane() - top.z_range()[0];
        if depth + height >= slab.thickness / unit {
            return Err(TracedLayerError::TooThin {
                thickness: slab.thickness,
                depth: depth * unit,
                height: height * unit,
            });
        }
        Ok(traced)
    }

    /// Bottom of the layer; `None` for a half space.
    pub(crate) const fn bottom(&self) -> Option<Bottom> {
        self.bottom
    }

    /// The bottom where it is a surface of its own.
    pub(crate) const fn surface(&self) -> Option<SearchedSurface<'a, G>> {
        self.surface
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
        let depth = -ln_of_normal(1.0 - u);
        if self.mean_free_path.is_infinite() {
            f64::INFINITY
        } else {
            depth * self.mean_free_path
        }
    }

    /// Distance from a height to a flat bottom, along a direction that rises by `dz`; infinite if the bottom does not lie ahead.
    #[inline(always)]
    pub(crate) fn to_flat_bottom(&self, z: f64, dz: f64) -> f64 {
        let to_plane = (z - self.bottom_z) / -dz;
        let to_plane = if to_plane > 0.0 { to_plane } else { 0.0 };
        match self.surface {
            None if dz < 0.0 => to_plane,
            _ => f64::INFINITY,
        }
    }

    /// Puts a point onto the plane of a flat bottom.
    pub(crate) const fn put_onto_bottom(&self, origin: &mut DVec3) {
        origin.z = self.bottom_z;
    }

    /// A heading in the coordinates of the upper surface, in those of `interface`.
    #[inline]
    pub(crate) fn to_interface(&self, interface: Interface, mut heading: Heading) -> Heading {
        heading.origin.z += self.shift_to(interface);
        if let (Interface::Bottom, Some(SearchedSurface { geometry, .. })) =
            (interface, &self.surface)
        {
            // Below a thick layer a height loses digits to the depth
            geometry.lift(&mut heading.origin, 2.0 * f64::EPSILON * self.shift);
        }
        heading
    }

    /// A heading in the coordinates of `interface`, in those of the upper surface.
    #[inline]
    pub(crate) fn to_upper_surface(&self, interface: Interface, mut heading: Heading) -> Heading {
        heading.origin.z -= self.shift_to(interface);
        heading
    }

    /// Offset of z from the coordinates of the upper surface to those of `interface`.
    #[inline(always)]
    pub(crate) const fn shift_to(&self, interface: Interface) -> f64 {
        match interface {
            Interface::Top => 0.0,
            Interface::Bottom => self.shift,
        }
    }

    /// Number of interfaces that have a surface.
    #[inline]
    pub(crate) const fn interfaces(&self) -> u32 {
        match self.surface {
            None => 1,
            Some(_) => 2,
        }
    }

    /// The interface that comes as number `rank` of those with a surface, from zero, to light inside that rises by `dz`.
    #[inline(always)]
    pub(crate) fn interface_ahead(&self, dz: f64, rank: u32) -> Interface {
        if self.surface.is_none() || (rank == 0) == (dz <= 0.0) {
            Interface::Top
        } else {
            Interface::Bottom
        }
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
    let tile = |of: &G| of.extent().map(|e| e * of.unit());
    Err(TracedLayerError::OtherTile {
        top: tile(top),
        top_border: top.border(),
        bottom: tile(bottom),
        bottom_border: bottom.border(),
    })
}

impl Interface {
    /// The half space of this interface in which the layer lies.
    pub(crate) const fn inner_side(self) -> HalfSpace {
        match self {
            Self::Top => HalfSpace::Below,
            Self::Bottom => HalfSpace::Above,
        }
    }
}
