//! Surfaces of Student slopes: the distribution of GGX, over many seeds.

use asperity_synthesis::{
    DrawnRoughness, FieldSynthesis, Provenance, Psd, Resolution, StudentSlopes, SurfaceRecipe,
};

/// `E_1(0.001) exp(0.001)`
const MEAN_SQUARE_AMPLITUDE: f64 = 6.337_874;

fn recipe(amplitude_ratio: f64) -> StudentSlopes {
    let base = Psd::gaussian(0.5, 4.0).expect("lengths are positive");
    StudentSlopes::new(base, amplitude_ratio).expect("the ratio is allowed")
}

/// Fractions of facets whose gradient exceeds multiples of alpha, over tiles of 16 amplitude lengths a side: each holds some
/// `256 / pi` independent amplitudes. Their scatter between tiles gives the standard error. Facets of four spacings per correlation
/// length have 3 % less slope variance than the surface, so alpha is lower by 1.5 %: the exact factor is `sqrt((1 - exp(-1/16)) 16)`.
/// The remainder is the gradient of the amplitude, below 0.01 at a ratio of 8, where its mean square is already taken out.
#[test]
fn gradients_have_the_distribution_of_ggx() {
    let student = recipe(8.0);
    let [alpha, _] = student.alpha();
    assert!((alpha - 0.25).abs() < 1e-12, "{alpha}");
    let facets = (16.0 * (1.0 - (-1.0_f64 / 16.0).exp())).sqrt();
    let synthesis =
        FieldSynthesis::new(student.into(), [512, 512], [1.0, 1.0], Resolution::Facets).unwrap();
    let thresholds = [0.3, 0.6, 1.0, 1.5, 2.5, 5.0, 10.0];
    let draws = 24;
    let (mut sums, mut squares) = ([0.0; 7], [0.0; 7]);
    for realisation in 0..draws {
        let field = synthesis.draw(11, realisation).unwrap();
        let mut counts = [0_u32; 7];
        for iy in 0..512 {
            for ix in 0..512 {
                for [x, y] in field.facet_slopes(ix, iy) {
                    let gradient = x.hypot(y) / (alpha * facets);
                    for (count, t) in counts.iter_mut().zip(thresholds) {
                        *count += u32::from(gradient > t);
                    }
                }
            }
        }
        for i in 0..7 {
            let fraction = f64::from(counts[i]) / (2.0 * 512.0 * 512.0);
            sums[i] += fraction;
            squares[i] += fraction * fraction;
        }
    }
    let n = f64::from(draws as u32);
    for (i, t) in thresholds.into_iter().enumerate() {
        let mean = sums[i] / n;
        let error = ((squares[i] / n - mean * mean) / (n - 1.0)).sqrt();
        let expected = StudentSlopes::exceedance(t);
        println!("{t}: {mean:.5} +- {error:.5}, expected {expected:.5}");
        assert!(
            (mean - expected).abs() < 4.0 * error + 0.01 * expected.sqrt(),
            "{t}"
        );
    }
}

/// Measured fractions are equal for grooves along any azimuth.
#[test]
fn the_measured_distribution_does_not_depend_on_the_azimuth_of_grooves() {
    for azimuth in [0.0, 0.5, 2.2] {
        let base = Psd::anisotropic_gaussian(0.5, 8.0, 32.0, azimuth).unwrap();
        let student = StudentSlopes::new(base, 2.0).unwrap();
        let [first, second] = student.alpha();
        assert!((first / 0.125 - 1.0).abs() < 1e-12 && (second / 0.03125 - 1.0).abs() < 1e-12);
        let field = FieldSynthesis::new(student.into(), [1024; 2], [1.0; 2], Resolution::Any)
            .unwrap()
            .draw(3, 0)
            .unwrap();
        let realised = DrawnRoughness::of(&field).realised.unwrap();
        let off = realised.gradients.unwrap().largest_difference;
        println!("{azimuth}: {off}");
        // Of some 1024^2 / (pi 16 64) = 330 independent amplitudes fractions scatter by 0.03 at most
        assert!(off < 0.07, "{azimuth}: {off}");
    }
}

#[test]
fn moments_are_those_of_the_recipe() {
    let recipe: SurfaceRecipe = recipe(6.0).into();
    assert!(recipe.gaussian().is_none());
    let base = Psd::gaussian(0.5, 4.0).unwrap();
    let ratio = recipe.sigma().powi(2) / 0.25;
    assert!((ratio - MEAN_SQUARE_AMPLITUDE).abs() < 1e-5, "{ratio}");
    let [xx, _, _] = recipe.slope_covariance();
    let ratio = xx / base.slope_variance()[0];
    assert!((ratio - MEAN_SQUARE_AMPLITUDE).abs() < 1e-5, "{ratio}");
    // Twice the integral of the exceedance over t^2 / 2, by the trapezium rule in t
    let step = 1e-3;
    let sum: f64 = (1..200_000)
        .map(|i| f64::from(i) * step)
        .map(|t| 2.0 * t * step * StudentSlopes::exceedance(t))
        .sum();
    assert!((sum / MEAN_SQUARE_AMPLITUDE - 1.0).abs() < 1e-5, "{sum}");
}

#[test]
fn surfaces_have_mean_zero_and_their_provenance_and_do_not_depend_on_threads() {
    let recipe: SurfaceRecipe = recipe(4.0).into();
    let synthesis =
        FieldSynthesis::new(recipe.clone(), [130, 140], [1.0, 1.0], Resolution::Facets).unwrap();
    let field = synthesis.draw(3, 5).unwrap();
    let mean: f64 = field.heights().iter().sum::<f64>() / field.heights().len() as f64;
    assert!(mean.abs() < 1e-12);
    let provenance = Provenance::of(field.provenance()).unwrap();
    assert_eq!((&provenance.recipe, provenance.realisation), (&recipe, 5));
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    assert_eq!(one.install(|| synthesis.draw(3, 5)).unwrap(), field);
}

#[test]
fn tiles_that_do_not_hold_the_amplitude_are_refused() {
    let draw =
        |size| FieldSynthesis::new(recipe(8.0).into(), [size; 2], [1.0; 2], Resolution::Facets);
    let error = draw(255).unwrap_err().to_string();
    assert!(error.contains("correlation lengths of 32"), "{error}");
    assert!(draw(256).is_ok());
    assert!(StudentSlopes::new(Psd::gaussian(1.0, 1.0).unwrap(), 1.0).is_err());
}
