//! Multiple scattering on the Smith microsurface against rays followed over explicit surfaces.
//!
//! The model takes successive facets as independent; on a surface they are neighbours. So it is no
//! matter of errors whether both agree, but of how far the model is off: its figures are printed, and
//! held only to a wide band.

use asperity_analysis::{SamplingEffort, SlopeCovariance, create_model, expect};
use asperity_optics::{Incidence, Material};
use asperity_tally::{Azimuth, Component, HemisphereGrid, Side, TallyResult, TallySpec};

/// Flux fractions of orders 2 and 3 and of all above one on explicit Gaussian surfaces, by an independent
/// program: `ensemble_s3.json` (12 surfaces) and `explicit_s2_eta1.5.json` (one).
struct Explicit {
    s: f64,
    eta: f64,
    theta: f64,
    reflected: [f64; 3],
    transmitted: [f64; 3],
}

#[rustfmt::skip]
const EXPLICIT: [Explicit; 6] = [
    Explicit { s: 3.0, eta: 1.4, theta: 0.0, reflected: [6.787e-4, 1.40e-5, 6.974e-4], transmitted: [6.158e-3, 9.610e-4, 7.204e-3] },
    Explicit { s: 3.0, eta: 1.4, theta: 30.0, reflected: [1.2026e-3, 6.36e-5, 1.2799e-3], transmitted: [1.39188e-2, 1.2865e-3, 1.53634e-2] },
    Explicit { s: 3.0, eta: 1.0 / 1.4, theta: 0.0, reflected: [7.6793e-2, 2.6641e-2, 0.105_975], transmitted: [9.401e-3, 1.985e-3, 1.1540e-2] },
    Explicit { s: 3.0, eta: 1.0 / 1.4, theta: 30.0, reflected: [0.142_443, 2.7602e-2, 0.173_822], transmitted: [7.437e-3, 1.318e-3, 8.9196e-3] },
    Explicit { s: 2.0, eta: 1.5, theta: 30.0, reflected: [2.47518e-3, 1.95391e-4, 2.75408e-3], transmitted: [3.39434e-2, 6.08234e-3, 4.14900e-2] },
    Explicit { s: 2.0, eta: 1.5, theta: 60.0, reflected: [3.13962e-3, 3.41516e-4, 3.65464e-3], transmitted: [6.00521e-2, 7.46176e-3, 6.93222e-2] },
];

/// The fraction of light scattered more than once, over that of the explicit surface: neighbours are not
/// independent, and between 0.39 and 1.51 is what was measured with 4e6 rays, to 0.005. Wrong physics,
/// say an index inverted behind the surface, moves these energies by factors.
const BAND: [f64; 2] = [0.33, 1.7];

#[test]
fn multiple_scattering_is_within_the_band_of_explicit_surfaces() {
    let grid = HemisphereGrid::new(3, 4).unwrap();
    let spec = TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH).unwrap();
    for case in &EXPLICIT {
        let slopes = SlopeCovariance::isotropic(case.s).unwrap();
        let model = create_model("heitz", slopes, Material::dielectric(case.eta).unwrap()).unwrap();
        let incidence = Incidence::from_degrees(case.theta, 180.0).unwrap();
        let effort = SamplingEffort {
            rays: 50_000,
            batches: 50,
            seed: 1,
        };
        let expected = expect(model.as_ref(), incidence, &spec, Azimuth::From(0.0), effort);
        println!(
            "s {}, eta {:.3}, {} deg, model / surface:",
            case.s, case.eta, case.theta
        );
        let sides = [
            (Side::Reflected, case.reflected),
            (Side::Transmitted, case.transmitted),
        ];
        for (side, explicit) in sides {
            let entries = [
                spec.order_entry(side, 2),
                spec.order_entry(side, 3),
                spec.flux_entry(side, Component::Multiple),
            ];
            let [second, third, all] = [0, 1, 2].map(|k| {
                let found = expected.statistics().at(entries[k]);
                (found.mean / explicit[k], found.se.unwrap() / explicit[k])
            });
            println!(
                "  {side:?}: order 2 {:.3} +- {:.3}, order 3 {:.3} +- {:.3}, all above one {:.3} +- {:.3}",
                second.0, second.1, third.0, third.1, all.0, all.1
            );
            assert!(all.0 > BAND[0] && all.0 < BAND[1] && all.1 < 0.1);
        }
    }
}
