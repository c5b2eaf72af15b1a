//! Surfaces and helpers shared by the tests.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test file uses its own part"
)]

use asperity_optics::{Incidence, Layer, Material};
use std::sync::Arc;

use asperity_surface::{Border, HeightField, TurnedCells};
use asperity_tally::{Estimate, TallySpec, TallyStatistics};
use asperity_tracer::{
    Accelerator, BruteForce, Geometry, HalfSpace, Illumination, PathSettings, PathStream,
    SearchedSurface, Surface, TracedLayerError, TracedStack, Tracer, Work,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A layer below a surface, on a bottom of its own if there is one.
pub fn layer_below<'a, G: Geometry>(
    top: &'a G,
    layer: &Layer,
    bottom: Option<SearchedSurface<'a, G>>,
    max_scatterings: u32,
) -> Result<TracedStack<'a, G>, TracedLayerError> {
    let top = SearchedSurface {
        geometry: top,
        accelerator: &BruteForce,
    };
    TracedStack::new(top, &[*layer], &[bottom], max_scatterings)
}

/// Independent uniform heights in `[-height, height]`: as rough as a surface can be.
pub fn rugged(nx: usize, ny: usize, height: f64, seed: u64, border: Border) -> Surface {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let heights = (0..nx * ny)
        .map(|_| height * rng.random_range(-1.0..1.0))
        .collect();
    let field = HeightField::new(heights, [ny, nx], [1.0, 1.0]).unwrap();
    Surface::new(field.with_border(border))
}

/// The surface with half of its cells split along the other diagonal, at random.
pub fn turned(field: &HeightField) -> HeightField {
    let is_turned = |ix: usize, iy: usize| (37 * ix * ix + 11 * ix * iy + 5 * iy) % 7 > 3;
    let cells = TurnedCells::new(field.shape(), is_turned);
    field.clone().with_turned_cells(Some(Arc::new(cells)))
}

/// A sum of eight waves with random phases that fit the tile: smooth, periodic, about Gaussian.
pub fn waves(n: usize, amplitude: f64, seed: u64) -> HeightField {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let waves: Vec<[f64; 3]> = [
        (1, 0),
        (0, 1),
        (1, 1),
        (1, -1),
        (2, 1),
        (1, 2),
        (2, 0),
        (0, 2),
    ]
    .map(|(kx, ky)| {
        let turn = std::f64::consts::TAU;
        [
            turn * f64::from(kx),
            turn * f64::from(ky),
            turn * rng.random::<f64>(),
        ]
    })
    .to_vec();
    let heights = (0..n * n)
        .map(|i| {
            let (x, y) = ((i % n) as f64 / n as f64, (i / n) as f64 / n as f64);
            waves
                .iter()
                .map(|[kx, ky, phase]| (kx * x + ky * y + phase).cos())
                .sum::<f64>()
                * amplitude
        })
        .collect();
    HeightField::new(heights, [n, n], [1.0, 1.0]).unwrap()
}

/// Traces `batches` batches of `strata^2` rays each and returns their statistics.
pub struct Run<'a, G = Surface> {
    pub surface: &'a G,
    pub accelerator: &'a dyn Accelerator<G>,
    pub material: Material,
    pub incident: HalfSpace,
    pub settings: PathSettings,
    pub theta_deg: f64,
    pub phi_deg: f64,
    pub spec: TallySpec,
    pub seed: u64,
}

impl<'a, G: Geometry> Run<'a, G> {
    pub fn new(surface: &'a G, accelerator: &'a dyn Accelerator<G>, material: Material) -> Self {
        Self {
            surface,
            accelerator,
            material,
            incident: HalfSpace::Above,
            settings: PathSettings::default(),
            theta_deg: 30.0,
            phi_deg: 180.0,
            spec: TallySpec::default(),
            seed: 1,
        }
    }

    pub fn go(&self, batches: u64, strata: u32) -> (TallyStatistics, Work) {
        let tracer = Tracer::new(
            self.surface,
            self.accelerator,
            self.material,
            self.incident,
            self.settings,
        );
        let incidence = Incidence::from_degrees(self.theta_deg, self.phi_deg).unwrap();
        let mut statistics = TallyStatistics::new(self.spec);
        let mut work = Work::default();
        for block in 0..batches {
            let stream = PathStream::new(self.seed, block);
            let (values, done) = tracer.batch(
                &Illumination::new(incidence, false),
                strata,
                self.spec,
                None,
                stream,
            );
            statistics.push(&values);
            work += done;
        }
        (statistics, work)
    }
}

/// `(x - reference) / hypot(se, se_reference)`, zero where both are without error and equal.
pub fn z_score(x: Estimate, reference: f64, se_reference: f64) -> f64 {
    let se = x.se.unwrap().hypot(se_reference);
    let difference = x.mean - reference;
    if difference == 0.0 {
        0.0
    } else {
        difference / se
    }
}
