//! Mixtures of Gaussian slopes, against drawn surfaces and closed forms.

use asperity_numerics::elementary::erfc;
use asperity_synthesis::{
    FieldSynthesis, Psd, Resolution, SlopeMixture, Structure, StructureSynthesis,
    StructuredSurface, StudentSlopes, SurfaceRecipe, TransformedHeights,
};

use crate::structures::GROOVES;

fn mixture(recipe: impl Into<SurfaceRecipe>, size: usize) -> (FieldSynthesis, SlopeMixture) {
    let synthesis =
        FieldSynthesis::new(recipe.into(), [size; 2], [1.0; 2], Resolution::Facets).unwrap();
    let mixture = synthesis.slope_mixture().unwrap();
    (synthesis, mixture)
}

/// The fraction of places whose slope along x exceeds `t`, either way.
fn exceedance(mixture: &SlopeMixture, t: f64) -> f64 {
    let [xx, ..] = mixture.covariance();
    let components = mixture.components().iter();
    let fraction = components.map(|one| one.weight * erfc(t / (2.0 * one.factor * xx).sqrt()));
    fraction.sum()
}

/// The slope variance at a place of lognormal heights `exp(z / delta)` is that of the waves times `exp(2 z / delta)`: the rule must
/// reproduce its moments of all orders, `exp(2 n^2 / delta^2)`.
#[test]
fn lognormal_heights_have_lognormal_slope_variances() {
    let psd = Psd::gaussian(1.0, 8.0).unwrap();
    // The lognormal distribution of delta 3: w = exp(1 / 9)
    let w = (1.0_f64 / 9.0).exp();
    let skewness = (w - 1.0).sqrt() * (w + 2.0);
    let kurtosis = w.powi(4) + 2.0 * w.powi(3) + 3.0 * w * w - 3.0;
    let heights = TransformedHeights::new(psd, skewness, kurtosis).unwrap();
    let (_, mixture) = mixture(heights, 128);
    let moment = |power: f64| {
        let components = mixture.components().iter();
        let terms = components.map(|one| one.weight * one.factor.powf(power));
        terms.sum::<f64>()
    };
    for power in [-2.0, -0.5, 2.0, 3.0_f64] {
        let found = moment(power) / moment(1.0).powf(power);
        let expected = (2.0 / 9.0 * (power * power - power)).exp();
        println!("{power}: {found} for {expected}");
        // The curve is a cubic of differences; the fitted delta is known to 1e-6
        assert!((found / expected - 1.0).abs() < 1e-5, "{power}");
    }
}

/// The closed form has neither the slope of the amplitude nor the grid: both are of second order in the ratio, and taken out of
/// the mean square.
#[test]
fn ggx_slopes_have_their_closed_form() {
    let student = StudentSlopes::new(Psd::gaussian(1.0, 8.0).unwrap(), 16.0).unwrap();
    let [alpha, _] = student.alpha();
    let (_, mixture) = mixture(student, 1024);
    for t in [0.1, 0.3, 1.0, 3.0, 10.0, 25.0] {
        // Of the gradient: exp(-t^2 / alpha^2) for a variance of alpha^2 / 2 per axis
        let found: f64 = mixture
            .components()
            .iter()
            .map(|one| {
                one.weight
                    * (-0.5 * (t * alpha).powi(2) / (one.factor * mixture.covariance()[0])).exp()
            })
            .sum();
        let expected = StudentSlopes::exceedance(t);
        println!("{t}: {found:.6} for {expected:.6}");
        assert!((found / expected - 1.0).abs() < 0.002, "{t}: {found}");
    }
}

/// Slopes along x of skewed, of bounded and of GGX surfaces, over many draws, whose scatter gives the standard error. Slopes are
/// differences of heights one spacing apart, smaller by `1 / (24 n^2)` of their second derivatives' scale: for 12 spacings per
/// correlation length below 0.2 % of the slope, so 1 % of rare exceedances.
#[test]
fn drawn_surfaces_have_the_slopes_of_the_mixture() {
    let psd = || Psd::gaussian(2.0, 12.0).unwrap();
    let recipes: [(SurfaceRecipe, usize); 3] = [
        (
            TransformedHeights::new(psd(), 1.0, 5.0).unwrap().into(),
            128,
        ),
        (
            TransformedHeights::new(psd(), 0.5, 2.6).unwrap().into(),
            128,
        ),
        (StudentSlopes::new(psd(), 2.0).unwrap().into(), 256),
    ];
    for (recipe, size) in recipes {
        let (synthesis, mixture) = mixture(recipe, size);
        let total: f64 = mixture.components().iter().map(|one| one.weight).sum();
        assert!((total - 1.0).abs() < 1e-12);
        let rms = 2.0_f64.sqrt() * 2.0 / 12.0;
        let draws = 48;
        for t in [0.3, 1.0, 2.0, 3.5] {
            let threshold = t * rms;
            let (mut sum, mut squares) = (0.0, 0.0);
            for realisation in 0..draws {
                let field = synthesis.draw(5, realisation).unwrap();
                let heights = field.heights();
                let steep = (0..size * size).filter(|i| {
                    let next = i - i % size + (i + 1) % size;
                    (heights[next] - heights[*i]).abs() > threshold
                });
                let fraction = steep.count() as f64 / (size * size) as f64;
                sum += fraction;
                squares += fraction * fraction;
            }
            let n = f64::from(draws as u32);
            let mean = sum / n;
            let error = ((squares / n - mean * mean) / (n - 1.0)).sqrt();
            let expected = exceedance(&mixture, threshold);
            println!("{t}: {mean:.5} +- {error:.5}, expected {expected:.5}");
            assert!(
                (mean - expected).abs() < 4.0 * error + 0.01 * expected,
                "{t}"
            );
        }
    }
}

/// Slope variances are those requested, but for what the spectrum misses. Between neighbouring samples that is 0.1 % of them, and more of
/// the continuous surface, since it lies in the shortest waves: below 1 % for a correlation length of 8 samples.
#[test]
fn the_mean_square_is_that_of_the_spectrum() {
    for anisotropy in [1.0, 2.0] {
        let psd = Psd::anisotropic_gaussian(1.0, 8.0, 8.0 * anisotropy, 0.3).unwrap();
        let [xx, xy, yy] = psd.slope_covariance();
        let heights = TransformedHeights::new(psd, 0.6, 4.0).unwrap();
        let (_, mixture) = mixture(heights, 256);
        for (i, expected) in [xx, xy, yy].into_iter().enumerate() {
            let components = mixture.components().iter();
            let found: f64 = components
                .map(|one| one.weight * one.factor * mixture.covariance()[i])
                .sum();
            println!("{found} for {expected}");
            assert!((found - expected).abs() < 0.01 * xx, "{i}");
        }
    }
}

#[test]
fn structures_have_none() {
    let grooves = Structure::Grooves(GROOVES);
    let drawn = StructureSynthesis::new(grooves, [128; 2], [1.0; 2], false).unwrap();
    let surface = StructuredSurface::new(&drawn, None).unwrap();
    let synthesis = FieldSynthesis::new(surface.into(), [128; 2], [1.0; 2], Resolution::Facets);
    assert!(synthesis.unwrap().slope_mixture().is_none());
}
