//! Limits of what a grid resolves and holds.

use asperity_surface::Length;

use super::error::{SynthesisError, UNRESOLVED_SLOPES};
use crate::Psd;

/// Fewest spacings a correlation length must span along each axis.
///
/// At four, the power beyond the Nyquist wave number is `erfc(2 pi) < 1e-17` of the whole, and the
/// slope variance of the mesh is low by 3 %.
pub const MIN_SPACINGS_PER_CORRELATION_LENGTH: f64 = 4.0;

/// Fewest spacings that a wavelength must span, per spacing that a correlation length must: 8 of facets, whose slope variance is then
/// low by 5 % for the shortest waves, and 5 of splines.
///
/// This is required of the waves that hold all but [`UNRESOLVED_SLOPES`] of the slope variance, where the spectrum is not Gaussian.
const SPACINGS_PER_WAVE: f64 = 2.0;

/// Fewest correlation lengths a tile's side must span.
///
/// At eight, the expected variance is low by `pi / 64` = 5 %, and the realised variance scatters by
/// 22 % from one realisation to the next.
pub const MIN_CORRELATION_LENGTHS_PER_SIDE: f64 = 8.0;

/// Tolerance of a spacing that repeats that of a measured surface, since people write few digits.
const SPACING_TOLERANCE: f64 = 1e-3;

/// Refuses what the grid cannot resolve, with `fewest` spacings per correlation length, or hold.
pub(super) fn check_resolution(
    psd: &Psd,
    [ny, nx]: [usize; 2],
    spacing: [f64; 2],
    fewest: f64,
) -> Result<(), SynthesisError> {
    for part in psd.parts() {
        let lengths = part.axis_correlation_lengths();
        let extents = part.correlation_extents();
        let waves = part.wavelengths_holding(UNRESOLVED_SLOPES);
        for (i, (axis, n)) in [('x', nx), ('y', ny)].into_iter().enumerate() {
            let (spacing, length) = (spacing[i], lengths[i]);
            let is_as_measured = part
                .sampled()
                .is_some_and(|own| spacing <= (1.0 + SPACING_TOLERANCE) * own[i]);
            if !is_as_measured && length < fewest * spacing {
                return Err(SynthesisError::Unresolved {
                    axis,
                    length: length.into(),
                    spacing: spacing.into(),
                    largest_spacing: Length::at_most(length / fewest),
                });
            }
            let fewest_of_wave = SPACINGS_PER_WAVE * fewest;
            if let Some([wave_x, wave_y]) = waves
                && !is_as_measured
                && [wave_x, wave_y][i] < fewest_of_wave * spacing * (1.0 - 1e-9)
            {
                let wavelength = [wave_x, wave_y][i];
                return Err(SynthesisError::UnresolvedWaves {
                    axis,
                    wavelength: wavelength.into(),
                    spacing: spacing.into(),
                    fewest: fewest_of_wave,
                    largest_spacing: Length::at_most(wavelength / fewest_of_wave),
                });
            }
            let (side, length) = (n as f64 * spacing, extents[i]);
            if side < MIN_CORRELATION_LENGTHS_PER_SIDE * length {
                return Err(SynthesisError::TooSmallTile {
                    axis,
                    side: side.into(),
                    length: length.into(),
                    fewest_samples: (MIN_CORRELATION_LENGTHS_PER_SIDE * length / spacing).ceil(),
                });
            }
        }
    }
    Ok(())
}
