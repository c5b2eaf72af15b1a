//! Grooves: parallel V, sine and blazed grooves.
//!
//! Ridges lie at height zero, bottoms at `-depth`. Grooves repeat with the tile, so that the period and the direction are the
//! nearest ones with whole numbers of periods along both sides of the tile.
//!
//! # Source
//! E. Loewen, E. Popov, *Diffraction Gratings and Applications*, Marcel Dekker (1997): ruled (echelette) gratings have facets
//! at right angles to each other, so that `depth = period sin(blaze) cos(blaze)`.

use std::f64::consts::{PI, TAU};

use asperity_numerics::elementary::{asin, atan, atan2, atanh, cos, hypot, sin, sin_cos};
use serde::{Deserialize, Serialize};

use super::corner::Corner;
use super::error::{Allowed, Check, StructureError};
use super::expected::StructureStatistics;
use super::grid::Grid;
use super::limits;
use super::random::Streams;

/// The shape of a groove.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GrooveProfile {
    /// Two straight flanks of the same angle.
    V,
    /// A cosine.
    Sine,
    /// Two straight flanks at right angles to each other. The less steep one, of the blaze angle `asin(2 depth / width) / 2`,
    /// falls along the direction 90 degrees right of `azimuth`.
    Blazed,
}

/// Parameters of grooves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grooves {
    /// The shape.
    pub profile: GrooveProfile,
    /// Mean depth, length units, above 0; of blazed grooves up to half the width.
    pub depth: f64,
    /// Mean width of a groove, the period, length units, above 0.
    pub width: f64,
    /// Angle from +x to the direction along the grooves, radians.
    pub azimuth: f64,
    /// Radius of curvature of ridges and bottoms, length units, 0 or more; sine grooves have none.
    pub edge_radius: f64,
    /// Depths and widths are uniform within `1 ± randomness`, independently, but of blazed grooves by the same factor: from 0 to
    /// below 1.
    pub randomness: f64,
}

/// Grooves on a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlannedGrooves {
    grooves: Grooves,
    /// Periods along x and y; negative where phases fall.
    periods: [i64; 2],
}

impl Grooves {
    pub(super) fn check(&self, structure: &'static str) -> Result<(), StructureError> {
        let check = Check(structure);
        let Self {
            depth,
            width,
            randomness,
            ..
        } = *self;
        check.that("width", width, Allowed::Positive)?;
        let depths = match self.profile {
            GrooveProfile::V | GrooveProfile::Sine => Allowed::Positive,
            GrooveProfile::Blazed => Allowed::Up(0.5 * width),
        };
        check.that("depth", depth, depths)?;
        check.that("azimuth", self.azimuth, Allowed::Finite)?;
        check.that("randomness", randomness, Allowed::FromBelow(0.0, 1.0))?;
        let most = self.largest_edge_radius();
        check.that("edge radius", self.edge_radius, Allowed::FromTo(0.0, most))
    }

    /// Edge radius at which the arcs at ridge and bottom may meet on the shortest flank.
    ///
    /// An arc takes the length `r tan(turn / 2)` of each flank, `turn` being the angle between both.
    fn largest_edge_radius(&self) -> f64 {
        let Self {
            depth,
            width,
            randomness,
            ..
        } = *self;
        // Widths are scaled after they are drawn so that they fill the tile
        let [narrowest, widest] = [1.0 - randomness, 1.0 + randomness].map(|factor| factor * width);
        let (narrowest, widest) = (narrowest / (1.0 + randomness), widest / (1.0 - randomness));
        match self.profile {
            GrooveProfile::Sine => 0.0,
            GrooveProfile::V => {
                let steepest = 2.0 * (1.0 + randomness) * depth / narrowest;
                let flattest = 2.0 * (1.0 - randomness) * depth / widest;
                0.25 * narrowest / (steepest * cos(atan(flattest)))
            }
            GrooveProfile::Blazed => {
                let blaze = 0.5 * asin((2.0 * depth / width).min(1.0));
                0.5 * narrowest * sin(blaze)
            }
        }
    }

    pub(super) fn planned(&self, grid: &Grid) -> Result<PlannedGrooves, StructureError> {
        let Self { width, azimuth, .. } = *self;
        let lengths = grid.lengths();
        // Phases grow along the direction 90 degrees right of that along the grooves
        let (sin, cos) = sin_cos(azimuth);
        let wanted = [sin / width, -cos / width];
        let whole = [0, 1].map(|i| (wanted[i] * lengths[i]).round());
        let found = [0, 1].map(|i| whole[i] / lengths[i]);
        let off = hypot(found[0] - wanted[0], found[1] - wanted[1]) * width;
        let along_a_side = [0, 1]
            .into_iter()
            .find(|i| wanted[1 - i].abs() * width < 1e-9);
        if let Some(i) = along_a_side {
            // Names the sides that fit
            super::positions::whole_periods(['x', 'y'][i], lengths[i], width)?;
        }
        let period = width.into();
        if whole == [0.0; 2] {
            return Err(StructureError::TooWideGrooves { period });
        }
        if off > limits::MAX_ADJUSTMENT {
            return Err(StructureError::NoNearbyGrooves {
                period,
                nearest_period: hypot(found[0], found[1]).recip().into(),
            });
        }
        let features = whole[0].abs().max(whole[1].abs());
        if features > limits::MAX_FEATURES as f64 {
            return Err(StructureError::TooManyFeatures { features });
        }
        let periods = whole.map(|n| n as i64);
        if self.randomness > 0.0 && periods[0] != 0 && periods[1] != 0 {
            return Err(StructureError::ObliqueRandomGrooves);
        }
        Ok(PlannedGrooves {
            grooves: *self,
            periods,
        })
    }
}

impl PlannedGrooves {
    /// Wave vector over 2 pi, inverse length units.
    fn frequency(&self, grid: &Grid) -> [f64; 2] {
        let lengths = grid.lengths();
        [0, 1].map(|i| self.periods[i] as f64 / lengths[i])
    }

    /// Mean period that fits the tile, length units.
    pub(super) fn period(&self, grid: &Grid) -> f64 {
        let [x, y] = self.frequency(grid);
        hypot(x, y).recip()
    }

    /// Angle from +x to the direction along the grooves that fit the tile, radians, within half a turn of the requested one.
    pub(super) fn azimuth(&self, grid: &Grid) -> f64 {
        let [x, y] = self.frequency(grid);
        let turn = atan2(x, -y) - self.grooves.azimuth;
        self.grooves.azimuth + turn - TAU * (turn / TAU).round()
    }

    /// Number of different grooves of the tile.
    pub(super) fn number(&self) -> usize {
        if self.grooves.randomness == 0.0 {
            return 1;
        }
        (self.periods[0].abs() + self.periods[1].abs()) as usize
    }

    pub(super) fn heights(&self, grid: &Grid, streams: &Streams) -> Vec<f64> {
        let Grooves {
            profile,
            depth,
            edge_radius,
            randomness,
            ..
        } = self.grooves;
        let number = self.number();
        // Widths in units of the mean one; they fill as many periods as there are grooves
        let factors: Vec<[f64; 2]> = (0..number)
            .map(|i| {
                let mut stream = streams.of(i);
                let width = stream.about_one(randomness);
                let depth = stream.about_one(randomness);
                [
                    width,
                    if profile == GrooveProfile::Blazed {
                        width
                    } else {
                        depth
                    },
                ]
            })
            .collect();
        let sum: f64 = factors.iter().map(|[width, _]| width).sum();
        let fill = number as f64 / sum;
        let period = self.period(grid);
        let mut end = 0.0;
        let mut grooves: Vec<Groove> = factors
            .iter()
            .map(|[width, deep]| {
                let start = end;
                end += width * fill * period;
                // Blazed grooves keep their angles whatever the widths are scaled by
                let deep = if profile == GrooveProfile::Blazed {
                    deep * fill
                } else {
                    *deep
                };
                Groove::new(profile, deep * depth, [start, end])
            })
            .collect();
        round_corners(&mut grooves, edge_radius);
        let [fx, fy] = self.periods.map(|n| n as f64);
        let [lx, ly] = grid.lengths();
        grid.heights(|(), [x, y]| {
            // Phase in periods
            let phase = fx * (x / lx) + fy * (y / ly);
            let position = phase.rem_euclid(number as f64) * period;
            let next = grooves.partition_point(|groove| groove.start <= position);
            grooves[next.max(1) - 1].height(position)
        })
    }

    pub(super) fn least_radius(&self, grid: &Grid) -> f64 {
        let Grooves {
            profile,
            depth,
            edge_radius,
            randomness,
            ..
        } = self.grooves;
        match profile {
            GrooveProfile::V | GrooveProfile::Blazed => edge_radius,
            // Of h = depth cos(2 pi x / period) / 2, at its crests
            GrooveProfile::Sine => {
                let narrowest = (1.0 - randomness) / (1.0 + randomness) * self.period(grid);
                2.0 * (narrowest / TAU).powi(2) / ((1.0 + randomness) * depth)
            }
        }
    }

    pub(super) fn expected(&self, grid: &Grid) -> StructureStatistics {
        let Grooves {
            profile,
            depth,
            edge_radius,
            randomness,
            ..
        } = self.grooves;
        let steepness = (depth / self.period(grid)).powi(2);
        // Mean of depth^2 / width by groove; widths are scaled to fill the tile, so that each is one part of their sum
        let number = self.number() as f64;
        let mean_inverse = if randomness == 0.0 {
            1.0
        } else {
            atanh(randomness) / randomness
        };
        let random =
            (1.0 + randomness.powi(2) / 3.0) * (1.0 + (number - 1.0) * mean_inverse) / number;
        let mean_square_slope = match profile {
            GrooveProfile::V => 4.0 * steepness * random,
            GrooveProfile::Sine => 0.5 * PI * PI * steepness * random,
            // tan^2 on the fraction cos^2 of the width, and cot^2 on sin^2
            GrooveProfile::Blazed => 1.0,
        };
        StructureStatistics {
            depth: (randomness == 0.0 && edge_radius == 0.0).then_some(depth),
            coverage: None,
            mean_square_slope: (edge_radius == 0.0).then_some(mean_square_slope),
        }
    }
}

/// One groove across its length.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Groove {
    start: f64,
    end: f64,
    depth: f64,
    flanks: Option<Flanks>,
}

/// Straight flanks of a groove; a sine has none.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Flanks {
    /// Position of the bottom.
    middle: f64,
    /// Slopes before and after the bottom.
    slopes: [f64; 2],
    /// Rounded ridge, bottom and next ridge; `None` if they are sharp.
    corners: Option<[Corner; 3]>,
}

impl Groove {
    fn new(profile: GrooveProfile, depth: f64, [start, end]: [f64; 2]) -> Self {
        let width = end - start;
        let fraction = match profile {
            GrooveProfile::V => Some(0.5),
            GrooveProfile::Sine => None,
            // cos^2 of the blaze angle, of which sin(2 blaze) = 2 depth / width
            GrooveProfile::Blazed => {
                let sin = 2.0 * depth / width;
                Some(0.5 * (1.0 + (1.0 - sin * sin).max(0.0).sqrt()))
            }
        };
        let flanks = fraction.map(|fraction| {
            let middle = start + fraction * width;
            Flanks {
                middle,
                slopes: [-depth / (middle - start), depth / (end - middle)],
                corners: None,
            }
        });
        Self {
            start,
            end,
            depth,
            flanks,
        }
    }

    fn height(&self, x: f64) -> f64 {
        let Self {
            start, end, depth, ..
        } = *self;
        let Some(flanks) = self.flanks else {
            let phase = TAU * (x - start) / (end - start);
            return -0.5 * depth * (1.0 - cos(phase));
        };
        let corners = flanks.corners.iter().flatten();
        let arc = corners.into_iter().find_map(|corner| corner.height(x));
        arc.unwrap_or_else(|| {
            let slope = flanks.slopes[usize::from(x > flanks.middle)];
            -depth + slope * (x - flanks.middle)
        })
    }
}

/// Rounds ridges and bottoms of grooves that follow each other periodically.
fn round_corners(grooves: &mut [Groove], radius: f64) {
    let slopes: Vec<[f64; 2]> = grooves
        .iter()
        .filter_map(|groove| Some(groove.flanks?.slopes))
        .collect();
    if radius == 0.0 || slopes.is_empty() {
        return;
    }
    let number = slopes.len();
    for (i, groove) in grooves.iter_mut().enumerate() {
        let Some(flanks) = &mut groove.flanks else {
            continue;
        };
        let [[_, before], own, [after, _]] = [
            slopes[(i + number - 1) % number],
            slopes[i],
            slopes[(i + 1) % number],
        ];
        let corner = |x, z, slopes| Corner::new([x, z], slopes, radius);
        flanks.corners = Some([
            corner(groove.start, 0.0, [before, own[0]]),
            corner(flanks.middle, -groove.depth, own),
            corner(groove.end, 0.0, [own[1], after]),
        ]);
    }
}
