//! Surfaces as height fields and splines, measured and edited.
//!
//! A [`HeightField`] holds samples `h[iy][ix]` at `(ix dx, iy dy)` with shape `[ny, nx]`, a length
//! unit, and what lies beyond its border. [`Roughness`] measures any, [`Form`] removes mean, plane or parabola, and [`RawHeightMap`] with
//! its [`MissingPolicy`] fills or refuses points that an instrument did not see. The same surface on
//! a finer grid is [`HeightField::refined`]. A [`SplineSurface`] passes through the samples
//! smoothly. Random surfaces are drawn by `asperity-synthesis`.
//!
//! # Conventions
//! Autocorrelation `C(r) = sigma^2 exp(-r^2 / tau^2)`; `tau` is the 1/e length. The other habit,
//! `exp(-r^2 / (2 l^2))`, is `l = tau / sqrt 2`. Smoothness `s = tau / sigma`; slope variance per
//! axis `2 sigma^2 / tau^2 = 2 / s^2`. Power spectral density, two-sided in angular wave vector:
//! `W(k) = sigma^2 tau^2 / (4 pi) exp(-k^2 tau^2 / 4)`, whose integral over `d^2k` is `sigma^2`.

mod editing;
mod height_field;
mod numbers;
mod quick_roughness;
mod roughness;
mod slopes;
mod spline;

pub use editing::{
    CoarseningError, FilterError, Form, GaussianFilter, MissingError, MissingPolicy, RawHeightMap,
    RefinementError,
};
pub use height_field::{
    Border, HeightField, HeightFieldError, Length, LengthUnit, ProvenanceRecord, TurnedCells,
    are_allowed, check_grid,
};
pub use numbers::{short, short_below};
pub use quick_roughness::QuickRoughness;
pub use roughness::{
    AxisAutocorrelation, FunctionalParameters, HeightBlocks, Histogram, Iso25178, PowerSpectrum,
    Roughness, SpatialParameters, SpectralRing, SteepestFacet, Triangle,
};
pub use slopes::{RegionSlopes, SlopeMoments};
pub use spline::{SplineRoughness, SplineSurface};
