//! Structured surfaces: pits, caps, grooves, scratches, cracks and pyramids on a periodic tile.
//!
//! | structure | file |
//! |---|---|
//! | spherical pits and caps | `segments` |
//! | V, sine and blazed grooves | `grooves` |
//! | scratches, as on brushed metal | `scratches` |
//! | cracks along a random Voronoi network | `cracks` |
//! | pyramids, upright and inverted | `pyramids` |
//!
//! Each feature draws its random numbers from a stream of its own (`random`), and buckets find the features near a sample
//! (`buckets`), so that heights cost as much as samples and features together and do not depend on the number of threads.
//! A finer grid over the same tile has the same surface.
//!
//! Lattices and grooves have whole numbers of periods along the sides of the tile. The period is adjusted to the nearest one
//! that fits, by up to [`MAX_ADJUSTMENT`], which [`StructureSynthesis::pitches`] reports; what is farther is refused.

mod buckets;
mod corner;
mod cracks;
mod error;
mod expected;
mod grid;
mod grooves;
mod limits;
mod positions;
mod pyramids;
mod random;
mod scratches;
mod segments;
mod stamps;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use self::cracks::Cracks;
pub use self::error::{Allowed, StructureError};
pub use self::expected::StructureStatistics;
pub use self::grooves::{GrooveProfile, Grooves};
pub use self::limits::{MAX_ADJUSTMENT, MAX_FEATURES, MIN_SPACINGS_PER_WIDTH};
pub use self::positions::Arrangement;
pub use self::pyramids::Pyramids;
pub use self::scratches::Scratches;
pub use self::segments::SphericalSegments;

use self::cracks::PlannedCracks;
use self::grid::Grid;
use self::grooves::PlannedGrooves;
use self::limits::{BYTES_PER_FEATURE, MAX_TILES_PER_WIDTH, SPACINGS_PER_RADIUS};
use self::pyramids::PlannedPyramids;
use self::random::Streams;
use self::scratches::PlannedScratches;
use self::segments::PlannedSegments;
use asperity_numerics::elementary::{cos, sin};
use asperity_surface::{HeightField, Length, TurnedCells, check_grid};

/// Rounding of heights, in units of the depth. Places of features are rounded by 2^-52 of the tile, so that heights are by the slope
/// times that: below 1e-9 of the depth on tiles of a million widths. What facets leave out below it changes no result.
const ROUNDING: f64 = 1e-9;

/// A structure with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum Structure {
    /// Spherical pits in a plane.
    Pits(SphericalSegments),
    /// Spherical caps on a plane.
    Caps(SphericalSegments),
    /// Parallel grooves.
    Grooves(Grooves),
    /// Straight scratches.
    Scratches(Scratches),
    /// Cracks along a Voronoi network.
    Cracks(Cracks),
    /// Pyramids on a plane.
    Pyramids(Pyramids),
    /// Pyramids pressed into a plane.
    Inverted(Pyramids),
}

impl Structure {
    /// Its name in messages.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Pits(_) => "pits",
            Self::Caps(_) => "caps",
            Self::Grooves(grooves) => match grooves.profile {
                GrooveProfile::V => "V grooves",
                GrooveProfile::Sine => "sine grooves",
                GrooveProfile::Blazed => "blazed grooves",
            },
            Self::Scratches(_) => "scratches",
            Self::Cracks(_) => "cracks",
            Self::Pyramids(_) => "pyramids",
            Self::Inverted(_) => "inverted pyramids",
        }
    }

    /// Mean width of a feature, length units.
    #[must_use]
    pub const fn width(&self) -> f64 {
        match self {
            Self::Pits(segments) | Self::Caps(segments) => segments.width,
            Self::Grooves(grooves) => grooves.width,
            Self::Scratches(scratches) => scratches.width,
            Self::Cracks(cracks) => cracks.width,
            Self::Pyramids(pyramids) | Self::Inverted(pyramids) => pyramids.width,
        }
    }

    /// Mean depth or height of a feature, length units.
    #[must_use]
    pub const fn depth(&self) -> f64 {
        match self {
            Self::Pits(segments) | Self::Caps(segments) => segments.depth,
            Self::Grooves(grooves) => grooves.depth,
            Self::Scratches(scratches) => scratches.depth,
            Self::Cracks(cracks) => cracks.depth,
            Self::Pyramids(pyramids) | Self::Inverted(pyramids) => pyramids.depth,
        }
    }

    /// Approximate number of features of random slopes in a tile of this `extent` along x and y, at least one; `None` if all have the same slopes.
    #[must_use]
    pub fn random_features(&self, [x, y]: [f64; 2]) -> Option<f64> {
        let width = self.width();
        let (randomness, features) = match self {
            Self::Pits(one) | Self::Caps(one) => (one.randomness, x * y / (width * width)),
            Self::Pyramids(one) | Self::Inverted(one) => (one.randomness, x * y / (width * width)),
            Self::Grooves(one) => {
                let [across_x, across_y] = [sin(one.azimuth).abs(), cos(one.azimuth).abs()];
                (one.randomness, (x * across_x + y * across_y) / width)
            }
            Self::Scratches(one) => (one.randomness, x.max(y) / width),
            Self::Cracks(_) => (1.0, x * y / (width * width)),
        };
        (randomness > 0.0).then_some(features.max(1.0))
    }

    /// Returns `true` if its statistics do not depend on azimuth.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Pits(segments) | Self::Caps(segments) => {
                segments.arrangement != Arrangement::Lattice
            }
            Self::Cracks(_) => true,
            Self::Grooves(_) | Self::Scratches(_) | Self::Pyramids(_) | Self::Inverted(_) => false,
        }
    }

    /// Returns `true` if its statistics are the same on either side of the x axis, and so of the y axis.
    #[must_use]
    pub fn is_mirror_symmetric(&self) -> bool {
        let along_an_axis = |azimuth: f64| sin(2.0 * azimuth).abs() < 1e-9;
        match self {
            Self::Pits(_) | Self::Caps(_) | Self::Cracks(_) => true,
            Self::Pyramids(_) | Self::Inverted(_) => true,
            Self::Grooves(grooves) => {
                grooves.profile != GrooveProfile::Blazed && along_an_axis(grooves.azimuth)
            }
            Self::Scratches(scratches) => along_an_axis(scratches.azimuth),
        }
    }

    /// Returns the structure with all lengths converted.
    #[must_use]
    pub(crate) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        let mut converted = *self;
        let lengths: Vec<&mut f64> = match &mut converted {
            Self::Pits(s) | Self::Caps(s) => vec![&mut s.depth, &mut s.width, &mut s.edge_radius],
            Self::Grooves(g) => vec![&mut g.depth, &mut g.width, &mut g.edge_radius],
            Self::Scratches(s) => vec![
                &mut s.depth,
                &mut s.width,
                &mut s.length,
                &mut s.edge_radius,
            ],
            Self::Cracks(c) => vec![&mut c.depth, &mut c.width, &mut c.edge_radius],
            Self::Pyramids(p) | Self::Inverted(p) => vec![&mut p.depth, &mut p.width],
        };
        for length in lengths {
            *length = convert(*length);
        }
        converted
    }

    /// Checks all parameters.
    ///
    /// # Errors
    /// [`StructureError::BadParameter`] and [`StructureError::NoSeparatePyramids`].
    pub fn check(&self) -> Result<(), StructureError> {
        let name = self.name();
        match self {
            Self::Pits(segments) | Self::Caps(segments) => segments.check(name),
            Self::Grooves(grooves) => grooves.check(name),
            Self::Scratches(scratches) => scratches.check(name),
            Self::Cracks(cracks) => cracks.check(name),
            Self::Pyramids(pyramids) | Self::Inverted(pyramids) => pyramids.check(name),
        }
    }
}

/// Features of a tile, by kind.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Planned {
    Segments(PlannedSegments),
    Grooves(PlannedGrooves),
    Scratches(PlannedScratches),
    Cracks(PlannedCracks),
    Pyramids(PlannedPyramids),
}

/// A generator of structured periodic surfaces.
///
/// One generator draws any number of realisations. Heights depend on the structure, shape, spacing, seed and realisation
/// alone, and not on the number of threads.
///
/// # Examples
/// ```
/// use asperity_synthesis::{GrooveProfile, Grooves, Structure, StructureSynthesis};
///
/// // Eight V grooves with flanks at 45 degrees
/// let grooves = Structure::Grooves(Grooves {
///     profile: GrooveProfile::V,
///     depth: 4.0,
///     width: 8.0,
///     azimuth: 0.0,
///     edge_radius: 0.0,
///     randomness: 0.0,
/// });
/// let synthesis = StructureSynthesis::new(grooves, [64, 64], [1.0, 1.0], false)?;
/// let (seed, realisation) = (1, 0);
/// let surface = synthesis.draw(seed, realisation)?;
/// assert_eq!(synthesis.expected().mean_square_slope, Some(1.0));
/// // Ridges lie at half the depth above the mean plane.
/// assert!((surface.height(5, 0) - 2.0).abs() < 1e-12);
/// # Ok::<(), asperity_synthesis::StructureError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StructureSynthesis {
    structure: Structure,
    grid: Grid,
    planned: Planned,
}

impl StructureSynthesis {
    /// Plans surfaces with `structure`.
    ///
    /// `shape`: `[ny, nx]`, at least `[2, 2]`. `spacing`: `[dx, dy]`, length units per sample. `insist`: draw even features that
    /// the grid cannot resolve.
    ///
    /// # Errors
    /// [`StructureError`] if a parameter is out of range, the grid is too coarse, whole numbers of periods do not fit the tile,
    /// or it would have too many features.
    pub fn new(
        structure: Structure,
        shape: [usize; 2],
        spacing: [f64; 2],
        insist: bool,
    ) -> Result<Self, StructureError> {
        check_grid(shape, spacing)?;
        structure.check()?;
        let grid = Grid {
            shape,
            spacing,
            first: [0.0; 2],
        };
        let (width, spacing) = (structure.width(), grid.coarser_spacing());
        // Periods of grooves fit the tile, as each is checked.
        if !matches!(structure, Structure::Grooves(_)) {
            let [x, y] = grid.lengths();
            let most = MAX_TILES_PER_WIDTH * x.min(y);
            if width > most {
                return Err(StructureError::TooWide {
                    width: width.into(),
                    widest: Length::at_most(most),
                });
            }
        }
        if !insist && width < MIN_SPACINGS_PER_WIDTH * spacing {
            return Err(StructureError::Unresolved {
                width: width.into(),
                spacing: spacing.into(),
                largest_spacing: Length::at_most(width / MIN_SPACINGS_PER_WIDTH),
            });
        }
        let planned = match &structure {
            Structure::Pits(segments) | Structure::Caps(segments) => {
                Planned::Segments(segments.planned(&grid)?)
            }
            Structure::Grooves(grooves) => Planned::Grooves(grooves.planned(&grid)?),
            Structure::Scratches(scratches) => Planned::Scratches(scratches.planned(&grid)?),
            Structure::Cracks(cracks) => Planned::Cracks(cracks.planned(&grid)?),
            Structure::Pyramids(pyramids) | Structure::Inverted(pyramids) => {
                Planned::Pyramids(pyramids.planned(&grid)?)
            }
        };
        Ok(Self {
            structure,
            grid,
            planned,
        })
    }

    /// The requested structure.
    #[must_use]
    pub const fn structure(&self) -> &Structure {
        &self.structure
    }

    /// `[ny, nx]`.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.grid.shape
    }

    /// `[dx, dy]`, length units per sample.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        self.grid.spacing
    }

    /// Bytes that a program holds at the peak of a [`StructureSynthesis::draw`]: the heights, those in the middle of all cells, the
    /// features with their entries in buckets, and 8 MiB for the program itself.
    #[must_use]
    pub fn peak_bytes(&self) -> usize {
        let [ny, nx] = self.grid.shape;
        let features = match &self.planned {
            Planned::Segments(planned) => planned.number(),
            Planned::Grooves(planned) => planned.number(),
            Planned::Scratches(planned) => planned.pieces(),
            Planned::Cracks(planned) => planned.number(),
            Planned::Pyramids(planned) => planned.number(),
        };
        2 * ny * nx * size_of::<f64>() + features * BYTES_PER_FEATURE + (8 << 20)
    }

    /// Statistics expected of its surfaces, as far as closed forms are known.
    #[must_use]
    pub fn expected(&self) -> StructureStatistics {
        match &self.planned {
            Planned::Segments(planned) => planned.expected(&self.grid),
            Planned::Grooves(planned) => planned.expected(&self.grid),
            Planned::Scratches(planned) => planned.expected(&self.grid),
            Planned::Cracks(planned) => planned.expected(&self.grid),
            Planned::Pyramids(planned) => planned.expected(&self.grid),
        }
    }

    /// Distances between columns and between rows of a lattice, as they fit the tile, length units; `None` without a lattice.
    #[must_use]
    pub fn pitches(&self) -> Option<[f64; 2]> {
        match &self.planned {
            Planned::Segments(planned) => planned.pitches(&self.grid),
            Planned::Pyramids(planned) => planned.pitches(&self.grid),
            Planned::Grooves(_) | Planned::Scratches(_) | Planned::Cracks(_) => None,
        }
    }

    /// Mean period of grooves, length units, and the angle from +x along them, radians, as they fit the tile; `None` for other
    /// structures.
    #[must_use]
    pub fn period_and_azimuth(&self) -> Option<[f64; 2]> {
        match &self.planned {
            Planned::Grooves(planned) => {
                Some([planned.period(&self.grid), planned.azimuth(&self.grid)])
            }
            _ => None,
        }
    }

    /// Returns `true` if smooth cells follow its surfaces: it has no edges, and radii of curvature of at least four spacings.
    ///
    /// Others have edges that a spline would round by about a spacing and ripple beside; flat cells are meant for them.
    #[must_use]
    pub fn suits_smooth_cells(&self) -> bool {
        let least = match &self.planned {
            Planned::Segments(planned) => planned.least_radius(&self.grid),
            Planned::Grooves(planned) => planned.least_radius(&self.grid),
            // These have edges where they meet
            Planned::Scratches(_) | Planned::Cracks(_) | Planned::Pyramids(_) => 0.0,
        };
        least >= SPACINGS_PER_RADIUS * self.grid.coarser_spacing()
    }

    /// Heights `[ny, nx]`, row-major, length units. The plane that features are in, or on, lies at zero.
    ///
    /// `seed` and `realisation` may be any numbers; every pair is its own surface.
    ///
    /// # Errors
    /// [`StructureError::Crowded`] if separate features find no position.
    pub fn heights(&self, seed: u64, realisation: u64) -> Result<Vec<f64>, StructureError> {
        self.heights_on(&self.grid, seed, realisation)
    }

    /// Heights on another grid of the tile.
    fn heights_on(
        &self,
        grid: &Grid,
        seed: u64,
        realisation: u64,
    ) -> Result<Vec<f64>, StructureError> {
        let streams = Streams::new(seed, realisation);
        let depths = match &self.planned {
            Planned::Grooves(planned) => return Ok(planned.heights(grid, &streams)),
            Planned::Segments(planned) => planned.depths(grid, &streams)?,
            Planned::Scratches(planned) => planned.depths(grid, &streams),
            Planned::Cracks(planned) => planned.depths(grid, &streams),
            Planned::Pyramids(planned) => planned.depths(grid, &streams)?,
        };
        let mut heights = depths;
        if !matches!(self.structure, Structure::Caps(_) | Structure::Pyramids(_)) {
            for h in &mut heights {
                // No negative zeros
                *h = 0.0 - *h;
            }
        }
        Ok(heights)
    }

    /// Heights half a cell after the samples along the axes `[x, y]` chosen.
    fn heights_between(
        &self,
        [x, y]: [bool; 2],
        seed: u64,
        realisation: u64,
    ) -> Result<Vec<f64>, StructureError> {
        let first = [x, y].map(|is_between| if is_between { 0.5 } else { 0.0 });
        let grid = Grid { first, ..self.grid };
        self.heights_on(&grid, seed, realisation)
    }

    /// The heights, and the cells with an edge along their other diagonal, from corner 10 to 01: in their middle the surface has the
    /// height of that diagonal, and not that of the one from 00 to 11.
    ///
    /// # Errors
    /// Errors of [`StructureSynthesis::heights`].
    pub(crate) fn heights_and_turned_cells(
        &self,
        seed: u64,
        realisation: u64,
    ) -> Result<(Vec<f64>, TurnedCells), StructureError> {
        let heights = self.heights(seed, realisation)?;
        let middles = self.heights_between([true, true], seed, realisation)?;
        let [_, nx] = self.grid.shape;
        let turned_cells = TurnedCells::new(self.grid.shape, |ix, iy| {
            let middle = middles[iy * nx + ix];
            let is_on = |ends| self.is_between(&heights, ends, middle);
            is_on([[ix + 1, iy], [ix, iy + 1]]) && !is_on([[ix, iy], [ix + 1, iy + 1]])
        });
        Ok((heights, turned_cells))
    }

    /// Returns `true` if the facets of a surface are the surface itself: no edge or curve passes between samples.
    ///
    /// # Errors
    /// Errors of [`StructureSynthesis::heights`].
    pub fn is_exact(&self, seed: u64, realisation: u64) -> Result<bool, StructureError> {
        let [ny, nx] = self.grid.shape;
        let (heights, turned) = self.heights_and_turned_cells(seed, realisation)?;
        for between in [[true, false], [false, true], [true, true]] {
            let found = self.heights_between(between, seed, realisation)?;
            let [x, y] = between.map(usize::from);
            let is_on_facets = |ix: usize, iy: usize| {
                let ends = if between == [true, true] && turned.contains(ix, iy) {
                    [[ix + 1, iy], [ix, iy + 1]]
                } else {
                    [[ix, iy], [ix + x, iy + y]]
                };
                self.is_between(&heights, ends, found[iy * nx + ix])
            };
            if !(0..ny).all(|iy| (0..nx).all(|ix| is_on_facets(ix, iy))) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns `true` if `middle` is, to rounding, the mean of the heights at two samples, which wrap.
    fn is_between(&self, heights: &[f64], ends: [[usize; 2]; 2], middle: f64) -> bool {
        let [ny, nx] = self.grid.shape;
        let [a, b] = ends.map(|[ix, iy]| heights[iy % ny * nx + ix % nx]);
        (0.5 * (a + b) - middle).abs() <= ROUNDING * self.structure.depth()
    }

    /// Draws one periodic surface, with heights about their mean.
    ///
    /// # Errors
    /// Errors of [`StructureSynthesis::heights`], and [`StructureError::HeightField`] if a height is too large.
    pub fn draw(&self, seed: u64, realisation: u64) -> Result<HeightField, StructureError> {
        let (mut heights, turned_cells) = self.heights_and_turned_cells(seed, realisation)?;
        let [_, nx] = self.grid.shape;
        let rows: Vec<f64> = heights.chunks(nx).map(|row| row.iter().sum()).collect();
        let mean = rows.iter().sum::<f64>() / heights.len() as f64;
        for h in &mut heights {
            *h -= mean;
        }
        let field = HeightField::new(heights, self.grid.shape, self.grid.spacing);
        Ok(field?.with_turned_cells(Some(Arc::new(turned_cells))))
    }
}
