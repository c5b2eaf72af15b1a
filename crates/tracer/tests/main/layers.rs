//! Light on surfaces with a medium below: exact answers, limits and symmetries.

mod bottoms;
mod half_space;
mod nearby;
mod rough;
mod slabs;

use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_surface::HeightField;
use asperity_tally::{Entry, Sides, TallyResult, TallySpec, TallyStatistics};
use asperity_tracer::{
    AcceleratorKind, BuildAccelerator, HalfSpace, Illumination, PathSettings, PathStream,
    SearchedSurface, Surface, Tracer, Work,
};

/// A scene: a surface of glass, what lies below it, and the light.
#[derive(Clone)]
struct Scene {
    surface: Surface,
    eta: f64,
    layer: Layer,
    bottom: Option<Surface>,
    theta_deg: f64,
    settings: PathSettings,
    max_scatterings: u32,
    accelerator: AcceleratorKind,
    sides: Sides,
    seed: u64,
}

impl Scene {
    fn new(surface: Surface, layer: Layer) -> Self {
        Self {
            surface,
            eta: 1.5,
            layer,
            bottom: None,
            theta_deg: 30.0,
            settings: PathSettings::default(),
            max_scatterings: 100_000,
            accelerator: AcceleratorKind::Auto,
            sides: Sides::Both,
            seed: 1,
        }
    }

    /// Traces `batches` batches of `strata^2` rays each.
    fn trace(&self, batches: u64, strata: u32) -> (TallyStatistics, Work) {
        let spec = TallySpec::default().with_medium().with_sides(self.sides);
        let accelerator = self.surface.accelerator(self.accelerator).unwrap();
        let below = self
            .bottom
            .as_ref()
            .map(|bottom| (bottom, bottom.accelerator(self.accelerator).unwrap()));
        let shape = below
            .as_ref()
            .map(|(geometry, accelerator)| SearchedSurface {
                geometry: *geometry,
                accelerator: &**accelerator,
            });
        let layer =
            crate::common::layer_below(&self.surface, &self.layer, shape, self.max_scatterings)
                .unwrap();
        let tracer = Tracer::new(
            &self.surface,
            &*accelerator,
            Material::dielectric(self.eta).unwrap(),
            HalfSpace::Above,
            self.settings,
        )
        .over(layer);
        let light = Illumination::new(
            Incidence::from_degrees(self.theta_deg, 20.0).unwrap(),
            false,
        );
        let mut statistics = TallyStatistics::new(spec);
        let mut work = Work::default();
        for batch in 0..batches {
            let stream = PathStream::new(self.seed, batch);
            let (values, done) = tracer.batch(&light, strata, spec, None, stream);
            statistics.push(&values);
            work += done;
        }
        (statistics, work)
    }
}

fn flat() -> Surface {
    Surface::new(HeightField::new(vec![0.0; 16], [4, 4], [1.0, 1.0]).unwrap())
}

fn medium(mean_free_path: f64, albedo: f64) -> ParticipatingMedium {
    let phase = PhaseFunction::Isotropic;
    ParticipatingMedium::from_mean_free_path(mean_free_path, albedo, phase).unwrap()
}

fn clear() -> ParticipatingMedium {
    ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic).unwrap()
}

fn slab(medium: ParticipatingMedium, thickness: f64, bottom: Bottom) -> Layer {
    Layer::slab(medium, thickness, bottom).unwrap()
}

fn budget(statistics: &TallyStatistics) -> f64 {
    statistics.means().budget().total()
}

/// Difference of one entry between two runs over its standard error.
fn z_between(a: &TallyStatistics, b: &TallyStatistics, entry: Entry) -> f64 {
    let (a, b) = (a.at(entry), b.at(entry));
    crate::common::z_score(a, b.mean, b.se.unwrap())
}
