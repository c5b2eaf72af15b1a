//! Comparison of explicit surfaces with a model, bin by bin and as a whole.

use serde::Serialize;

use crate::compare::flips::{Flips, LANES};
use crate::compare::input::{ComparisonError, Expected, RayCount, check_length, validate};
use crate::compare::sign_flip::{Scale, SignFlipTest, Untested, sign_flip_test};

/// Flux by which a bin of a correct model may differ from that of the surfaces: ten times the error allowed in
/// quadrature.
const ROUNDING: f64 = 1e-11;

/// Number of flips that estimate the total variation of noise.
const NOISE_FLIPS: usize = 400;

/// Sums of bins that are tested besides the bins themselves, such as rings or whole sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Grouping {
    /// Name of the scale.
    pub name: &'static str,
    /// Numbers of the bins of each group.
    pub groups: Vec<Vec<usize>>,
    /// Rays behind each group.
    pub rays: Vec<RayCount>,
}

/// One bin of explicit surfaces and of a model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BinComparison {
    /// Mean flux fraction over the surfaces.
    pub mean: f64,
    /// Standard error of the difference, from its scatter between surfaces; `None` for one surface.
    pub standard_error: Option<f64>,
    /// Flux that the model expects, or its mean over batches.
    pub model: f64,
    /// `true` if the bin is tested, for which it must hold enough rays.
    pub tested: bool,
}

/// Total variation distance `1/2 sum |mean - model|` over all bins.
///
/// It is the flux that would have to move to turn one distribution into the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TotalVariation {
    /// The observed distance.
    pub observed: f64,
    /// The mean distance that the scatter between surfaces alone would cause under a correct model;
    /// `None` for one surface.
    pub noise: Option<f64>,
    /// The 95th percentile of the distance that noise alone causes; `None` for one surface.
    pub noise_95: Option<f64>,
}

/// Explicit surfaces compared with one model.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Bin by bin.
    pub bins: Vec<BinComparison>,
    /// Number of surfaces.
    pub surfaces: usize,
    /// The size of the deviation, over all bins.
    pub total_variation: TotalVariation,
    /// The significance of the deviation, over the tested bins, or why there is none.
    pub test: Result<SignFlipTest, Untested>,
}

/// Compares the flux fractions of explicit surfaces with those that a model expects.
///
/// - `surfaces`: one list of bin fluxes per surface, each an independent draw of the same ensemble.
/// - `expected`: the fluxes of the model.
/// - `rays`: the rays behind each bin, which decide whether it is tested. Bins left out still count in the total variation and
///   in sums.
/// - `groupings`: coarser scales to test as well.
/// - `seed`: chooses the random flips. The same seed gives the same result.
///
/// The p value accounts for the correlation between bins of one surface: see [`SignFlipTest`]. A chi-squared over
/// bins does not, and would reject correct models.
///
/// # Errors
/// [`ComparisonError`] for no surface, unequal lengths or values that are not finite.
pub fn compare(
    surfaces: &[Vec<f64>],
    expected: Expected<'_>,
    rays: &[RayCount],
    groupings: &[Grouping],
    seed: u64,
) -> Result<Comparison, ComparisonError> {
    let (mut comparison, residuals) = distances(surfaces, expected, seed)?;
    check_length("the list of ray counts", rays.len(), comparison.bins.len())?;
    let enough: Vec<bool> = (0..rays.len())
        .map(|b| rays[b].suffices(residuals.iter().map(|d| d[b])))
        .collect();
    for (bin, &tested) in comparison.bins.iter_mut().zip(&enough) {
        bin.tested = tested;
    }
    Ok(Comparison {
        test: test_on_all_scales(&residuals, &enough, groupings, seed),
        ..comparison
    })
}

/// The comparison of [`compare`] without its test, which takes most of the time.
///
/// # Errors
/// As for [`compare`].
pub fn compare_untested(
    surfaces: &[Vec<f64>],
    expected: Expected<'_>,
    seed: u64,
) -> Result<Comparison, ComparisonError> {
    distances(surfaces, expected, seed).map(|(comparison, _)| comparison)
}

/// The comparison without a test, and the residuals `[surface][bin]`.
fn distances(
    surfaces: &[Vec<f64>],
    expected: Expected<'_>,
    seed: u64,
) -> Result<(Comparison, Vec<Vec<f64>>), ComparisonError> {
    validate(surfaces, expected)?;
    let residuals: Vec<Vec<f64>> = surfaces
        .iter()
        .enumerate()
        .map(|(r, x)| x.iter().zip(expected.of(r)).map(|(x, m)| x - m).collect())
        .collect();
    // Residuals average without the rounding of the larger fluxes.
    let count = surfaces.len() as f64;
    let offsets: Vec<f64> = (0..residuals[0].len())
        .map(|b| residuals.iter().map(|d| d[b]).sum::<f64>() / count)
        .collect();
    let bins = (0..offsets.len())
        .map(|b| {
            let model = match expected {
                Expected::Exact(fluxes) => fluxes[b],
                Expected::Batches(batches) => {
                    batches.iter().map(|batch| batch[b]).sum::<f64>() / count
                }
            };
            BinComparison {
                mean: model + offsets[b],
                standard_error: standard_error(&residuals, b, offsets[b]),
                model,
                tested: false,
            }
        })
        .collect();
    let comparison = Comparison {
        bins,
        surfaces: surfaces.len(),
        total_variation: total_variation(&residuals, &offsets, seed),
        test: Err(Untested::NotRequested),
    };
    Ok((comparison, residuals))
}

/// Standard error of the mean residual of a bin; `None` for one surface.
fn standard_error(residuals: &[Vec<f64>], bin: usize, mean: f64) -> Option<f64> {
    let count = residuals.len() as f64;
    (residuals.len() > 1).then(|| {
        let squares: f64 = residuals.iter().map(|d| (d[bin] - mean).powi(2)).sum();
        (squares / (count * (count - 1.0))).sqrt()
    })
}

/// The sign-flip test of bins and of the sums of bins in `groupings`.
fn test_on_all_scales(
    residuals: &[Vec<f64>],
    enough: &[bool],
    groupings: &[Grouping],
    seed: u64,
) -> Result<SignFlipTest, Untested> {
    let tested: Vec<usize> = (0..enough.len()).filter(|&b| enough[b]).collect();
    let bins = without_rounding(residuals.to_vec(), |_| 1);
    let sums: Vec<(Vec<Vec<f64>>, Vec<usize>)> = groupings
        .iter()
        .map(|grouping| {
            let sum = |d: &Vec<f64>, group: &Vec<usize>| group.iter().map(|&b| d[b]).sum();
            let of_surface = |d| grouping.groups.iter().map(|group| sum(d, group)).collect();
            let sums: Vec<Vec<f64>> = residuals.iter().map(of_surface).collect();
            let members = (0..grouping.groups.len())
                .filter(|&g| grouping.rays[g].suffices(sums.iter().map(|d| d[g])))
                .collect();
            (
                without_rounding(sums, |g| grouping.groups[g].len()),
                members,
            )
        })
        .collect();
    let mut scales = vec![Scale {
        name: "bins",
        residuals: &bins,
        members: &tested,
    }];
    scales.extend(
        groupings
            .iter()
            .zip(&sums)
            .map(|(grouping, (residuals, members))| Scale {
                name: grouping.name,
                residuals,
                members,
            }),
    );
    sign_flip_test(&scales, seed)
}

/// Residuals of all surfaces, with the columns that are no larger than rounding set to zero; each column is a
/// sum of `bins` bins. Where all surfaces have the same flux, as mirrors have in total, the residual is the
/// error of quadrature, and has no scatter to test it against.
fn without_rounding(mut residuals: Vec<Vec<f64>>, bins: impl Fn(usize) -> usize) -> Vec<Vec<f64>> {
    let columns = residuals.first().map_or(0, Vec::len);
    for column in 0..columns {
        let largest = residuals
            .iter()
            .map(|d| d[column].abs())
            .fold(0.0, f64::max);
        if largest <= ROUNDING * bins(column) as f64 {
            residuals.iter_mut().for_each(|d| d[column] = 0.0);
        }
    }
    residuals
}

/// The observed distance, and that of flipped deviations from the mean: the scatter of the mean of as many
/// surfaces, whether or not the model is correct.
fn total_variation(residuals: &[Vec<f64>], offsets: &[f64], seed: u64) -> TotalVariation {
    let observed = 0.5 * offsets.iter().map(|d| d.abs()).sum::<f64>();
    if residuals.len() < 2 {
        return TotalVariation {
            observed,
            noise: None,
            noise_95: None,
        };
    }
    let count = residuals.len() as f64;
    let centred: Vec<Vec<f64>> = residuals
        .iter()
        .map(|d| d.iter().zip(offsets).map(|(d, o)| d - o).collect())
        .collect();
    let flips = Flips::random(residuals.len(), NOISE_FLIPS + 1, seed);
    let add =
        |sum: f64, [sums]: &[[f64; LANES]; 1]| sum + sums.iter().map(|x| x.abs()).sum::<f64>();
    let mut distances = flips.fold([&centred], add, |a, b| a + b);
    // The first flip is the data themselves, whose centred sum is zero: it is no draw of noise.
    distances.remove(0);
    // Deviations from the mean have (R - 1) / R of the variance of the surfaces.
    let scale = 0.5 / count * (count / (count - 1.0)).sqrt();
    for distance in &mut distances {
        *distance *= scale;
    }
    distances.sort_by(f64::total_cmp);
    TotalVariation {
        observed,
        noise: Some(distances.iter().sum::<f64>() / NOISE_FLIPS as f64),
        noise_95: Some(distances[NOISE_FLIPS * 95 / 100]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_errors_and_z_are_those_of_the_surfaces() {
        let surfaces = [vec![0.1, 0.5], vec![0.3, 0.5]];
        let result = compare(
            &surfaces,
            Expected::Exact(&[0.1, 0.5]),
            &[RayCount::UNLIMITED; 2],
            &[],
            1,
        )
        .unwrap();
        let bin = result.bins[0];
        assert!((bin.mean - 0.2).abs() < 1e-15);
        assert!((bin.standard_error.unwrap() - 0.1).abs() < 1e-15);
        assert_eq!(result.bins[1].standard_error, Some(0.0));
        assert!((result.total_variation.observed - 0.05).abs() < 1e-15);
        let too_few = Untested::TooFewSurfaces {
            found: 2,
            needed: 6,
        };
        assert_eq!(result.test, Err(too_few));
    }

    #[test]
    fn one_surface_has_a_deviation_but_no_test() {
        let result = compare(
            &[vec![0.2, 0.4]],
            Expected::Exact(&[0.3, 0.4]),
            &[RayCount::UNLIMITED; 2],
            &[],
            1,
        )
        .unwrap();
        assert_eq!(result.bins[0].standard_error, None);
        assert_eq!(result.test, Err(Untested::OneSurface));
        assert_eq!(result.total_variation.noise, None);
        assert!((result.total_variation.observed - 0.05).abs() < 1e-15);
    }

    #[test]
    fn missing_flux_is_a_deviation_without_scatter() {
        let surfaces = vec![vec![0.0, 0.0]; 10];
        let result = compare(
            &surfaces,
            Expected::Exact(&[0.01, 0.0]),
            &[RayCount::UNLIMITED; 2],
            &[],
            1,
        )
        .unwrap();
        assert!(result.bins[0].mean.abs() < 1e-15);
        let test = result.test.unwrap();
        assert_eq!((test.scales[0].max_t, test.p), (f64::INFINITY, 1.0 / 512.0));
    }

    #[test]
    fn bins_without_enough_rays_do_not_enter_the_test() {
        let surfaces = vec![vec![0.0, 0.0]; 10];
        let result = compare(
            &surfaces,
            Expected::Exact(&[0.01, 0.0]),
            &[RayCount::NONE, RayCount::UNLIMITED],
            &[],
            1,
        )
        .unwrap();
        assert_eq!(result.test.unwrap().p, 1.0);
        assert!((result.total_variation.observed - 0.005).abs() < 1e-15);
        let result = compare(
            &surfaces,
            Expected::Exact(&[0.01, 0.0]),
            &[RayCount::NONE; 2],
            &[],
            1,
        )
        .unwrap();
        assert_eq!(result.test, Err(Untested::NoBins));
    }

    #[test]
    fn rounding_rejects_no_model() {
        // The same flux on every surface, off by what quadrature leaves; the bins scatter and agree in sum.
        let surfaces: Vec<Vec<f64>> = (0..10)
            .map(|r| {
                let part = 0.5 + 0.01 * f64::from(r - 5) + 0.005;
                vec![part, 1.0 - part]
            })
            .collect();
        let groups = [Grouping {
            name: "sides",
            groups: vec![vec![0, 1]],
            rays: vec![RayCount::UNLIMITED],
        }];
        let p = |model: &[f64]| {
            let rays = [RayCount::UNLIMITED; 2];
            let result = compare(&surfaces, Expected::Exact(model), &rays, &groups, 1);
            result.unwrap().test.unwrap().p
        };
        assert!(p(&[0.5, 0.5 - 1e-12]) > 0.3);
        assert!(p(&[0.5, 0.5 - 1e-9]) < 0.01);
    }

    #[test]
    fn inconsistent_input_is_refused() {
        assert_eq!(
            compare(&[], Expected::Exact(&[]), &[], &[], 0),
            Err(ComparisonError::NoSurfaces)
        );
        let error = compare(
            &[vec![0.1], vec![0.1, 0.2]],
            Expected::Exact(&[0.1]),
            &[RayCount::UNLIMITED],
            &[],
            0,
        )
        .unwrap_err();
        assert_eq!(error.to_string(), "surface 1 has 2 bins; the model has 1");
        assert!(compare(&[vec![0.1]], Expected::Exact(&[0.1]), &[], &[], 0).is_err());
        assert!(
            compare(
                &[vec![f64::NAN]],
                Expected::Exact(&[0.1]),
                &[RayCount::UNLIMITED],
                &[],
                0
            )
            .is_err()
        );
        assert!(
            compare(
                &[vec![0.1]],
                Expected::Exact(&[f64::INFINITY]),
                &[RayCount::UNLIMITED],
                &[],
                0
            )
            .is_err()
        );
    }
}
