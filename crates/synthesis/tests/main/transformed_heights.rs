//! Surfaces of transformed heights: distribution and autocorrelation, over many seeds.

use asperity_surface::Roughness;
use asperity_synthesis::{
    FieldSynthesis, Psd, Resolution, SurfaceRecipe, SynthesisError, TransformedHeights,
};

/// Means over `draws` surfaces with their standard errors: variance, skewness, kurtosis, autocorrelations at 2 and 4 spacings over the
/// variance, and slope variance of facets along x. Moments are about zero, the mean of the ensemble, but for the tile's own mean: a tile
/// of `n` independent areas has lost `1 / n` of its variance with it.
fn means(synthesis: &FieldSynthesis, draws: u64) -> [[f64; 2]; 6] {
    let (mut sums, mut squares) = ([0.0; 6], [0.0; 6]);
    for realisation in 0..draws {
        let field = synthesis.draw(5, realisation).expect("heights are finite");
        let (nx, count) = (field.nx(), field.heights().len() as f64);
        let moment =
            |power: i32| field.heights().iter().map(|h| h.powi(power)).sum::<f64>() / count;
        let lagged = |lag: usize| {
            let rows = field.heights().chunks_exact(nx);
            let products =
                rows.map(|row| (0..nx).map(|i| row[i] * row[(i + lag) % nx]).sum::<f64>());
            products.sum::<f64>() / count
        };
        let slopes = Roughness::of(&field).slope_variance[0];
        let found = [
            moment(2),
            moment(3),
            moment(4),
            lagged(2),
            lagged(4),
            slopes,
        ];
        for i in 0..6 {
            sums[i] += found[i];
            squares[i] += found[i] * found[i];
        }
    }
    let n = draws as f64;
    [0, 1, 2, 3, 4, 5].map(|i| {
        let mean = sums[i] / n;
        [mean, ((squares[i] / n - mean * mean) / (n - 1.0)).sqrt()]
    })
}

/// Tiles of 32 correlation lengths hold `1024 / pi` independent areas: moments are low by 0.3 % of the variance and by as much
/// of the others, times their order. What is clipped of the spectrum is below 0.01. Each passes at four standard errors besides.
#[test]
fn heights_have_the_moments_and_the_autocorrelation_requested() {
    let psd = Psd::gaussian(1.0, 4.0).unwrap();
    for (skewness, kurtosis) in [(0.8, 4.5), (-0.7, 3.2), (0.0, 2.2), (0.0, 6.0)] {
        let recipe = TransformedHeights::new(psd.clone(), skewness, kurtosis).unwrap();
        let synthesis =
            FieldSynthesis::new(recipe.into(), [128; 2], [1.0; 2], Resolution::Facets).unwrap();
        println!(
            "{skewness} {kurtosis}: mismatch {:.2e}",
            synthesis.spectrum_mismatch().autocorrelation
        );
        assert!(
            synthesis.spectrum_mismatch().autocorrelation < 0.002,
            "{skewness} {kurtosis}"
        );
        let e = |lag: f64| (-lag * lag / 16.0).exp();
        let slopes = 2.0 * (1.0 - e(1.0));
        let expected = [1.0, skewness, kurtosis, e(2.0), e(4.0), slopes];
        let bias = [
            0.004,
            0.01 * skewness.abs(),
            0.007 * kurtosis,
            0.004,
            0.004,
            1e-3,
        ];
        for (i, [mean, error]) in means(&synthesis, 300).into_iter().enumerate() {
            println!(
                "  {i}: {mean:.4} +- {error:.4}, expected {:.4}",
                expected[i]
            );
            let allowed = 4.0 * error + bias[i] + synthesis.spectrum_mismatch().autocorrelation;
            assert!(
                (mean - expected[i]).abs() < allowed,
                "{skewness} {kurtosis} {i}"
            );
        }
    }
}

#[test]
fn normal_heights_are_those_of_the_gaussian_surface() {
    let psd = Psd::gaussian(0.5, 4.0).unwrap();
    let recipe = TransformedHeights::new(psd.clone(), 0.0, 3.0).unwrap();
    let draw = |recipe: SurfaceRecipe| {
        let synthesis = FieldSynthesis::new(recipe, [64, 70], [1.0; 2], Resolution::Facets);
        synthesis.unwrap().draw(2, 3).unwrap()
    };
    let (transformed, plain) = (draw(recipe.into()), draw(psd.into()));
    // The one has the variance of the spectrum, the other has lost that of the mean: 16 pi / (64 70) of it
    let scale = (1.0 - 16.0 * std::f64::consts::PI / (64.0 * 70.0)).sqrt();
    for (found, expected) in transformed.heights().iter().zip(plain.heights()) {
        assert!(
            (scale * found - expected).abs() < 1e-6,
            "{found} {expected}"
        );
    }
}

/// Waves of one length alone, whose autocorrelation goes far below zero, and heights of a long tail, which cannot follow it there.
#[test]
fn what_no_gaussian_surface_gives_is_refused_and_told() {
    let psd = Psd::of_radial_table(
        asperity_synthesis::RadialTable::new(vec![0.2, 0.21, 0.3], vec![1e-9, 1.0, 1.0]).unwrap(),
        Some(1.0),
    )
    .unwrap();
    let recipe: SurfaceRecipe = TransformedHeights::new(psd, 3.0, 20.0).unwrap().into();
    let draw = |resolution| FieldSynthesis::new(recipe.clone(), [256; 2], [1.0; 2], resolution);
    assert!(matches!(
        draw(Resolution::Facets),
        Err(SynthesisError::Unreachable(mismatch)) if mismatch.autocorrelation > 0.01
    ));
    assert!(
        draw(Resolution::Any)
            .unwrap()
            .spectrum_mismatch()
            .autocorrelation
            > 0.01
    );
}

/// Bounded heights of kurtosis 1.9: waves that would need negative powers raise the slopes. What the plan says of one spacing is what surfaces have:
/// 40 tiles of 512^2 / (pi 16^2) = 326 correlation areas, whose slope variances scatter by some 5 %.
#[test]
fn slopes_that_miss_the_spectrum_are_told() {
    let psd = Psd::gaussian(4.0, 16.0).unwrap();
    let recipe: SurfaceRecipe = TransformedHeights::new(psd, 0.0, 1.9).unwrap().into();
    let synthesis =
        FieldSynthesis::new(recipe.clone(), [512; 2], [1.0; 2], Resolution::Facets).unwrap();
    let told = synthesis.spectrum_mismatch().slope_variance;
    assert!(
        told.iter().all(|off| (0.01..0.05).contains(off)),
        "{told:?}"
    );
    let requested = recipe.slope_covariance()[0];
    let variances = (0..40).map(|number| {
        let slopes = Roughness::of(&synthesis.draw(1, number).unwrap());
        0.5 * (slopes.slope_variance[0] + slopes.slope_variance[1]) / requested
    });
    let mean = variances.sum::<f64>() / 40.0;
    // Facets of this spacing lose (1/16)^2 / 2 of the variance
    let expected = 1.0 + 0.5 * (told[0] + told[1]) - 0.002;
    assert!(
        (mean - expected).abs() < 4.0 * 0.05 / 40.0_f64.sqrt(),
        "{mean} {expected}"
    );
    assert!(mean > 1.01);
}
