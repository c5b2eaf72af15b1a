//! Explicit results against what a model expects, bin by bin and as a whole.

use serde::Serialize;

use crate::compare::sign_flip::{
    Scale, SignFlipTest, Untested, flip_signs, flipped_sums, sign_flip_test,
};

/// Flux by which a bin of a model and of surfaces may differ though both are right: ten times the error that
/// quadrature allows itself.
const ROUNDING: f64 = 1e-11;

/// Flips that estimate the total variation of noise.
const NOISE_FLIPS: usize = 400;

/// Sums of bins that are tested beside the bins themselves, such as rings or whole sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Grouping {
    /// Name of the scale.
    pub name: &'static str,
    /// Numbers of the bins of each group. A group is tested if one of its bins is.
    pub groups: Vec<Vec<usize>>,
}

/// One bin of explicit surfaces beside a model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BinComparison {
    /// Mean flux fraction over the surfaces.
    pub mean: f64,
    /// Standard error of the difference, from its scatter between surfaces; `None` for one surface.
    pub standard_error: Option<f64>,
    /// What the model expects, or its mean over batches.
    pub model: f64,
    /// `(mean - model) / standard_error`: infinite where all surfaces deviate by the same amount,
    /// zero where they agree exactly; `None` for one surface.
    pub z: Option<f64>,
    /// Whether the bin holds enough rays to enter the test.
    pub tested: bool,
}

/// Total variation distance `1/2 sum |mean - model|` over all bins.
///
/// It is the flux that would have to move to make one distribution the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TotalVariation {
    /// The distance found.
    pub observed: f64,
    /// The mean distance that the scatter between surfaces alone would cause if the model were
    /// right; `None` for one surface.
    pub noise: Option<f64>,
    /// The distance that noise alone exceeds in one case of twenty; `None` for one surface.
    pub noise_95: Option<f64>,
}

/// Explicit surfaces beside one model.
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

/// What a model expects, beside surfaces.
#[derive(Clone, Copy, Debug)]
pub enum Expected<'a> {
    /// Fluxes that are exact.
    Exact(&'a [f64]),
    /// Fluxes found by sampling, one list an independent batch, as many as there are surfaces: each surface
    /// is compared with a batch of its own, so that the differences remain independent of each other, and
    /// their scatter is that of surface and model together.
    Batches(&'a [&'a [f64]]),
}

impl<'a> Expected<'a> {
    /// What surface `r` is compared with.
    fn of(self, r: usize) -> &'a [f64] {
        match self {
            Self::Exact(fluxes) => fluxes,
            Self::Batches(batches) => batches[r],
        }
    }
}

/// Why a comparison is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ComparisonError {
    /// Nothing to compare.
    #[error("there is no surface to compare with the model")]
    NoSurfaces,
    /// Lists of unequal length.
    #[error("{what} has {found} bins; the model has {expected}")]
    BinCount {
        /// The list that differs.
        what: String,
        /// Its length.
        found: usize,
        /// The length of the model's list.
        expected: usize,
    },
    /// Batches of a model that do not go with the surfaces.
    #[error("the model has {batches} batches for {surfaces} surfaces; it needs as many")]
    BatchCount {
        /// Batches of the model.
        batches: usize,
        /// Surfaces.
        surfaces: usize,
    },
    /// A flux that is no number.
    #[error("{what} holds {value} in bin {bin}; fluxes must be finite")]
    NotFinite {
        /// The list that holds it.
        what: String,
        /// Number of the bin.
        bin: usize,
        /// The value.
        value: f64,
    },
}

/// Compares the flux fractions of explicit surfaces with those that a model expects.
///
/// `surfaces`: one list of bin fluxes a surface, each an independent draw of the same ensemble.
/// `expected`: what the model says. `enough`: the bins to test; take those in which at least 20 rays
/// are found or expected over all surfaces, because fewer rays are far from symmetric about their
/// mean, which the test assumes. Bins left out still count in the total variation and in sums.
/// `groupings`: coarser scales to test as well. `seed` chooses
/// the random flips; the same seed gives the same result.
///
/// The p value accounts for the correlation between bins of one surface: see
/// [`SignFlipTest`]. A chi-squared over bins does not, and would reject a model that holds.
///
/// # Errors
/// [`ComparisonError`] for no surface, unequal lengths or values that are not finite.
pub fn compare(
    surfaces: &[Vec<f64>],
    expected: Expected<'_>,
    enough: &[bool],
    groupings: &[Grouping],
    seed: u64,
) -> Result<Comparison, ComparisonError> {
    if surfaces.is_empty() {
        return Err(ComparisonError::NoSurfaces);
    }
    if let Expected::Batches(batches) = expected
        && batches.len() != surfaces.len()
    {
        return Err(ComparisonError::BatchCount {
            batches: batches.len(),
            surfaces: surfaces.len(),
        });
    }
    let bin_count = expected.of(0).len();
    let of_length = |what: &dyn Fn() -> String, found: usize| {
        if found == bin_count {
            Ok(())
        } else {
            Err(ComparisonError::BinCount {
                what: what(),
                found,
                expected: bin_count,
            })
        }
    };
    let finite = |what: &dyn Fn() -> String, values: &[f64]| match values
        .iter()
        .position(|x| !x.is_finite())
    {
        None => Ok(()),
        Some(bin) => Err(ComparisonError::NotFinite {
            what: what(),
            bin,
            value: values[bin],
        }),
    };
    of_length(
        &|| "the list of bins with enough rays".to_owned(),
        enough.len(),
    )?;
    for (r, fluxes) in surfaces.iter().enumerate() {
        let of_model = || "the model".to_owned();
        of_length(&of_model, expected.of(r).len())?;
        finite(&of_model, expected.of(r))?;
        let what = || format!("surface {r}");
        of_length(&what, fluxes.len())?;
        finite(&what, fluxes)?;
    }

    let count = surfaces.len() as f64;
    let residuals: Vec<Vec<f64>> = surfaces
        .iter()
        .enumerate()
        .map(|(r, x)| x.iter().zip(expected.of(r)).map(|(x, m)| x - m).collect())
        .collect();
    // Residuals average without the rounding of the larger fluxes.
    let offsets: Vec<f64> = (0..bin_count)
        .map(|b| residuals.iter().map(|d| d[b]).sum::<f64>() / count)
        .collect();
    let bins: Vec<BinComparison> = (0..bin_count)
        .map(|b| {
            let model = match expected {
                Expected::Exact(fluxes) => fluxes[b],
                Expected::Batches(batches) => {
                    batches.iter().map(|batch| batch[b]).sum::<f64>() / count
                }
            };
            let standard_error = (surfaces.len() > 1).then(|| {
                let squares: f64 = residuals.iter().map(|d| (d[b] - offsets[b]).powi(2)).sum();
                (squares / (count * (count - 1.0))).sqrt()
            });
            let z = standard_error.map(|se| {
                if offsets[b] == 0.0 {
                    0.0
                } else if se <= 4.0 * f64::EPSILON * offsets[b].abs() {
                    offsets[b].signum() * f64::INFINITY
                } else {
                    offsets[b] / se
                }
            });
            BinComparison {
                mean: model + offsets[b],
                standard_error,
                model,
                z,
                tested: enough[b],
            }
        })
        .collect();
    Ok(Comparison {
        bins,
        surfaces: surfaces.len(),
        total_variation: total_variation(&residuals, &offsets, seed),
        test: test_on_all_scales(&residuals, enough, groupings, seed),
    })
}

/// The sign-flip test of bins and of the sums that `groupings` name.
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
            let members = (0..grouping.groups.len())
                .filter(|&g| grouping.groups[g].iter().any(|&b| enough[b]))
                .collect();
            let sums = residuals.iter().map(of_surface).collect();
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

/// Residuals of all surfaces with those columns set to zero that are no larger than rounding, each the
/// sum of `bins` bins: where all surfaces have the same flux, as mirrors have in all, what is left of it
/// beside the model is the error of quadrature, and has no scatter to be judged by.
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

/// The observed distance, and that of flipped deviations from the mean: what the mean of so many
/// surfaces scatters by whether or not the model is right.
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
    // The first flip is the data themselves, whose centred sum is zero: it is no draw of noise.
    let signs = flip_signs(residuals.len(), NOISE_FLIPS + 1, false, seed);
    let mut distances = vec![0.0; NOISE_FLIPS];
    flipped_sums(&[&centred], &signs[residuals.len()..], |flip, _, [sums]| {
        distances[flip] += sums.iter().map(|x| x.abs()).sum::<f64>();
    });
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
            &[true, true],
            &[],
            1,
        )
        .unwrap();
        let bin = result.bins[0];
        assert!((bin.mean - 0.2).abs() < 1e-15);
        assert!((bin.standard_error.unwrap() - 0.1).abs() < 1e-15);
        assert!((bin.z.unwrap() - 1.0).abs() < 1e-14);
        assert_eq!(result.bins[1].z, Some(0.0));
        assert!((result.total_variation.observed - 0.05).abs() < 1e-15);
        let too_few = Untested::TooFewSurfaces {
            found: 2,
            needed: 6,
        };
        assert_eq!(result.test, Err(too_few));
    }

    #[test]
    fn one_surface_has_a_deviation_but_no_judgement() {
        let result = compare(
            &[vec![0.2, 0.4]],
            Expected::Exact(&[0.3, 0.4]),
            &[true, true],
            &[],
            1,
        )
        .unwrap();
        assert_eq!(result.bins[0].z, None);
        assert_eq!(result.bins[0].standard_error, None);
        assert_eq!(result.test, Err(Untested::OneSurface));
        assert_eq!(result.total_variation.noise, None);
        assert!((result.total_variation.observed - 0.05).abs() < 1e-15);
    }

    #[test]
    fn light_that_never_comes_is_a_deviation_without_scatter() {
        let surfaces = vec![vec![0.0, 0.0]; 10];
        let result = compare(
            &surfaces,
            Expected::Exact(&[0.01, 0.0]),
            &[true, true],
            &[],
            1,
        )
        .unwrap();
        assert_eq!(result.bins[0].z, Some(f64::NEG_INFINITY));
        assert_eq!(result.bins[1].z, Some(0.0));
        let test = result.test.unwrap();
        assert_eq!((test.scales[0].max_t, test.p), (f64::INFINITY, 1.0 / 512.0));
    }

    #[test]
    fn bins_without_enough_rays_do_not_enter_the_test() {
        let surfaces = vec![vec![0.0, 0.0]; 10];
        let result = compare(
            &surfaces,
            Expected::Exact(&[0.01, 0.0]),
            &[false, true],
            &[],
            1,
        )
        .unwrap();
        assert_eq!(result.test.unwrap().p, 1.0);
        assert!((result.total_variation.observed - 0.005).abs() < 1e-15);
        let result = compare(
            &surfaces,
            Expected::Exact(&[0.01, 0.0]),
            &[false, false],
            &[],
            1,
        )
        .unwrap();
        assert_eq!(result.test, Err(Untested::NoBins));
    }

    #[test]
    fn a_deviation_that_is_rounding_fails_no_model() {
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
        }];
        let p = |model: &[f64]| {
            let enough = [true, true];
            let result = compare(&surfaces, Expected::Exact(model), &enough, &groups, 1);
            result.unwrap().test.unwrap().p
        };
        assert!(p(&[0.5, 0.5 - 1e-12]) > 0.3);
        assert!(p(&[0.5, 0.5 - 1e-9]) < 0.01);
    }

    #[test]
    fn contradictory_input_is_refused() {
        assert_eq!(
            compare(&[], Expected::Exact(&[]), &[], &[], 0),
            Err(ComparisonError::NoSurfaces)
        );
        let error = compare(
            &[vec![0.1], vec![0.1, 0.2]],
            Expected::Exact(&[0.1]),
            &[true],
            &[],
            0,
        )
        .unwrap_err();
        assert_eq!(error.to_string(), "surface 1 has 2 bins; the model has 1");
        assert!(compare(&[vec![0.1]], Expected::Exact(&[0.1]), &[], &[], 0).is_err());
        assert!(compare(&[vec![f64::NAN]], Expected::Exact(&[0.1]), &[true], &[], 0).is_err());
        assert!(
            compare(
                &[vec![0.1]],
                Expected::Exact(&[f64::INFINITY]),
                &[true],
                &[],
                0
            )
            .is_err()
        );
    }
}
