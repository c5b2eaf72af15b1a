//! Conductors that are traced together: the bytes of each alone, tallies and work.

use asperity_optics::{Incidence, Material};
use asperity_surface::{Border, HeightField, SplineSurface};
use asperity_tally::{
    Aperture, ApertureShape, ControlVariate, Side, Sides, Tallies, TallySpec, UnshadowedFluxes,
    VisibleFractions,
};
use asperity_tracer::{
    AcceleratorKind, BatchedRays, BuildAccelerator, HalfSpace, Illumination, MeshSurface,
    PathSettings, PathStream, Polarisation, Sampling, SmoothSurface, Starts, Surface, Tracer,
    TriangleMesh, Work,
};

use crate::common::{rugged, waves};

const POLARISATIONS: [Polarisation; 4] = [
    Polarisation::Averaged,
    Polarisation::Tracked,
    Polarisation::Both,
    Polarisation::Mueller,
];

/// Indices of gold at several wavelengths, and some that end paths sooner, or reflect nothing.
const INDICES: [[f64; 2]; 11] = [
    [0.21, 3.272],
    [0.16, 3.95],
    [0.43, 2.455],
    [1.31, 1.849],
    [1.56, 1.904],
    [1.66, 1.956],
    [1.47, 1.952],
    [1.6, 0.02],
    [2.5, 0.0],
    [1.0, 0.0],
    [0.05, 9.0],
];

/// Light on any surface, and how its paths are followed.
struct Scene {
    light: Illumination,
    incident: HalfSpace,
    polarisation: Polarisation,
    roulette: f64,
    max_order: u32,
    sides: Sides,
    has_control_variate: bool,
}

impl Scene {
    fn new(theta_deg: f64, polarisation: Polarisation) -> Self {
        Self {
            light: Illumination::new(Incidence::from_degrees(theta_deg, 25.0).unwrap(), false),
            incident: HalfSpace::Above,
            polarisation,
            roulette: 0.01,
            max_order: 20,
            sides: Sides::Both,
            has_control_variate: false,
        }
    }

    /// Scenes that differ in all that a path can meet.
    fn all() -> Vec<Self> {
        let mut scenes: Vec<Self> = POLARISATIONS
            .into_iter()
            .flat_map(|polarisation| {
                [
                    Self::new(60.0, polarisation),
                    Self {
                        roulette: 0.5,
                        sides: Sides::Transmitted,
                        max_order: 3,
                        light: Illumination {
                            starts: Starts::OnSurface,
                            stokes: [0.6, -0.3, 0.2],
                            ..Illumination::new(Incidence::from_degrees(0.0, 0.0).unwrap(), true)
                        },
                        ..Self::new(0.0, polarisation)
                    },
                ]
            })
            .collect();
        for polarisation in [Polarisation::Averaged, Polarisation::Tracked] {
            for starts in [Starts::FromAbove, Starts::OnSurface] {
                scenes.push(Self {
                    has_control_variate: true,
                    roulette: 0.3,
                    incident: HalfSpace::Below,
                    light: Illumination {
                        starts,
                        sampling: Sampling::Stratified,
                        ..Illumination::new(Incidence::from_degrees(65.0, 25.0).unwrap(), true)
                    },
                    ..Self::new(65.0, polarisation)
                });
            }
        }
        scenes
    }

    fn spec(&self) -> TallySpec {
        let theta = self.light.incidence.theta();
        let apertures = [
            Aperture::whole(Side::Reflected),
            Aperture::cone(Side::Reflected, theta, 0.4),
        ];
        // Vertical light of any azimuth has no plane of incidence
        let receptor = (theta > 0.0).then_some(Aperture {
            shape: ApertureShape::Receptor {
                in_plane: [0.2, 0.5],
                across: [0.3, 0.6],
            },
            ..apertures[1]
        });
        TallySpec::default()
            .with_apertures(apertures.into_iter().chain(receptor).collect())
            .with_polarimetry(self.polarisation.polarimetry())
            .with_sides(self.sides)
            .with_medium()
    }

    /// Control variates of fractions that differ by material, side and ring; that their expectations are wrong does not matter here.
    fn control_variates(&self) -> Vec<Option<ControlVariate>> {
        let spec = self.spec();
        let n_theta = spec.grid().n_theta();
        let control = |material: usize| {
            let fraction = |ring: usize| 0.9 / (1.0 + 0.1 * (material + ring) as f64);
            let fractions = VisibleFractions {
                rings: [0, 7].map(|side| (0..n_theta).map(|ring| fraction(side + ring)).collect()),
                absorbed: fraction(3),
            };
            ControlVariate::new(spec, fractions, &UnshadowedFluxes::zeros(&spec))
                .with_shadow_probability(0.75)
        };
        (0..INDICES.len())
            .map(|material| self.has_control_variate.then(|| control(material)))
            .collect()
    }

    /// Traces materials together, in three batches of which a part is left out.
    fn trace<'c, G: BuildAccelerator>(
        &self,
        surface: &G,
        materials: &[Material],
        controls: &[Option<&'c ControlVariate>],
    ) -> Vec<(Tallies<'c>, Work)> {
        let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let settings = PathSettings::new(Default::default(), self.roulette, self.max_order)
            .unwrap()
            .with_polarisation(self.polarisation);
        let rays = BatchedRays::new(STRATA, 3, 40..STRATA * STRATA);
        let stream = PathStream::new(3, 1).from_batch(2);
        Tracer::of_each(surface, &*accelerator, materials, self.incident, settings)
            .batches_of_each(&self.light, &rays, self.spec(), controls, stream, &|| false)
            .unwrap()
    }

    /// Compares conductors that are traced together with each alone, and returns the segments searched of each.
    fn compare<G: BuildAccelerator>(&self, surface: &G, name: &str) -> Vec<u64> {
        let materials = INDICES.map(|[eta, kappa]| Material::conductor(eta, kappa).unwrap());
        let controls = self.control_variates();
        let controls: Vec<Option<&ControlVariate>> = controls.iter().map(Option::as_ref).collect();
        let together = self.trace(surface, &materials, &controls);
        assert_eq!(together.len(), materials.len());
        let pairs = materials.iter().zip(controls).zip(together);
        pairs
            .map(|((&material, control), (tallies, work))| {
                let [(alone, work_alone)] = self
                    .trace(surface, &[material], &[control])
                    .try_into()
                    .unwrap();
                let at = format!("{name} {:?} {material:?}", self.polarisation);
                assert_eq!(work, work_alone, "{at}");
                let fractions = [tallies, alone].map(|one| one.into_fractions(900));
                assert!(fractions[0] == fractions[1], "{at}");
                work.segments
            })
            .collect()
    }
}

/// Strata along a side of a batch.
const STRATA: u32 = 16;

/// Surfaces of all kinds and borders; plateaus send vertical light back vertically.
#[test]
fn conductors_traced_together_have_the_bytes_of_each_alone() {
    let plateaus = |border| {
        let heights = (0..144).map(|i| f64::from((i / 3 * 7 + i % 12 / 4 * 5) % 4));
        let field = HeightField::new(heights.collect(), [12, 12], [1.0, 1.0]).unwrap();
        Surface::new(field.with_border(border))
    };
    let smooth = SmoothSurface::new(SplineSurface::through(&waves(16, 1.5, 4)));
    let rough = rugged(17, 12, 0.9, 5, Border::Periodic);
    let TriangleMesh {
        vertices,
        triangles,
    } = TriangleMesh::new(&rough).unwrap();
    let mesh = MeshSurface::new(&vertices, triangles, Border::Mirrored).unwrap();
    let mut fewest = u64::MAX;
    for scene in Scene::all() {
        let segments = [
            scene.compare(&rough, "rough"),
            scene.compare(&plateaus(Border::Open), "open"),
            scene.compare(&plateaus(Border::Mirrored), "mirrored"),
            scene.compare(&smooth, "smooth"),
        ];
        // Roulette ends paths for some conductors and not for others.
        let [of_rough, ..] = segments;
        fewest = fewest.min(of_rough.iter().max().unwrap() - of_rough.iter().min().unwrap());
        if scene.light.starts == Starts::FromAbove {
            scene.compare(&mesh, "mesh");
        }
    }
    assert!(fewest > 0);
}
