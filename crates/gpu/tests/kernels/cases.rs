//! Cases: surfaces, light and settings, plain and awkward, chosen by the digits of a number.

use asperity_optics::{Incidence, Material};
use asperity_surface::{Border, HeightField, SplineSurface};
use asperity_tally::{
    Aperture, ApertureShape, Apertures, ControlVariate, HemisphereGrid, Side, SideEdges, Sides,
    TallySpec, UnshadowedFluxes, VisibleFractions,
};
use asperity_tracer::{
    BatchedRays, Branching, HalfSpace, Illumination, PathSettings, PathStream, Polarisation, Shape,
    Starts, Window,
};

/// One call of an engine.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) shape: Shape,
    /// One, or several conductors.
    pub(crate) materials: Vec<Material>,
    pub(crate) incident: HalfSpace,
    pub(crate) settings: PathSettings,
    pub(crate) light: Illumination,
    pub(crate) rays: BatchedRays,
    pub(crate) spec: TallySpec,
    pub(crate) control: Option<ControlVariate>,
    pub(crate) stream: PathStream,
}

/// Numbers in `[0, 1)` that follow from a number and a place.
fn noise(seed: u32, i: usize) -> f64 {
    (f64::from(seed) * 0.754_877_666 + (i * i % 9973) as f64 * 0.618_033_989).fract()
}

/// Heights of `[rows, columns]` points, in units of a column.
fn relief(kind: usize, [rows, columns]: [usize; 2], seed: u32) -> Vec<f64> {
    let at = |i: usize| (i % columns, i / columns);
    let heights = (0..rows * columns).map(|i| {
        let (x, y) = at(i);
        match kind {
            // White noise, from gentle to jagged
            0 => 0.3 * noise(seed, i),
            1 => 3.0 * noise(seed, i),
            // Plateaus
            2 => (3.0 * noise(seed, x / 3 + 7 * (y / 4))).floor(),
            // An egg box: equal heights everywhere
            3 => ((x + y) % 2) as f64,
            // Grooves along x and along y
            4 => (x % 4) as f64 * 0.7,
            5 => (y % 3) as f64,
            // A needle in a plane
            6 => f64::from(u8::from(i == rows * columns / 2)) * 12.0,
            // A slit
            7 => f64::from(u8::from(x != columns / 2)) * 8.0,
            // Hills far apart, rough in places
            8 => {
                let across = |p: usize| 2.0 * (p % 40) as f64 / 39.0 - 1.0;
                let [u, v] = [across(x), across(y)].map(|p| 1.0 - p * p);
                9.0 * u * v + 0.4 * noise(seed, i)
            }
            _ => 0.0,
        }
    });
    heights.collect()
}

const SHAPES: [[usize; 2]; 6] = [[16, 16], [20, 33], [9, 40], [64, 64], [2, 2], [3, 7]];

/// A height field, its length unit and offset of any size.
fn height_field(digits: &mut Digits) -> HeightField {
    let (kind, seed) = (
        digits.one_of(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 8, 9]),
        digits.below(1000) as u32,
    );
    let shape = match kind {
        8 => [96, 80],
        _ => digits.one_of(&SHAPES),
    };
    let unit = digits.one_of(&[1.0, 1.0, 1.0, 1e-9, 1e9]);
    let offset = digits.one_of(&[0.0, 0.0, 1e3]);
    let dy = digits.one_of(&[1.0, 1.0, 0.3, 2.5]);
    let heights = relief(kind, shape, seed);
    let heights = heights.into_iter().map(|height| unit * (height + offset));
    let field = HeightField::new(heights.collect(), shape, [unit, unit * dy]).unwrap();
    field.with_border(digits.one_of(&[
        Border::Periodic,
        Border::Periodic,
        Border::Mirrored,
        Border::Open,
    ]))
}

fn shape(digits: &mut Digits) -> Shape {
    let field = height_field(digits);
    match digits.below(2) {
        0 => Shape::height_field(field),
        _ => Shape::smooth(SplineSurface::through(&field)),
    }
}

fn materials(digits: &mut Digits) -> Vec<Material> {
    let conductor = |eta, kappa| Material::conductor(eta, kappa).unwrap();
    let lambertian = |reflectance| Material::lambertian(reflectance).unwrap();
    match digits.below(12) {
        0 => return vec![conductor(0.21, 3.27)],
        1 => return vec![conductor(1.5, 1e-3)],
        2 => return vec![Material::Mirror],
        3 => {
            return vec![
                conductor(0.21, 3.27),
                conductor(2.9, 3.0),
                conductor(1.0, 0.5),
            ];
        }
        4 => return vec![lambertian(0.7)],
        5 => return vec![lambertian(1.0)],
        _ => {}
    }
    let eta = digits.one_of(&[1.5, 1.5, 1.0 / 1.5, 1.0, 4.0, 1.0 + 1e-9, 0.25]);
    vec![Material::dielectric(eta).unwrap()]
}

/// Light from any direction; now and then along one line, through a vertex or along edges and diagonals.
fn light(digits: &mut Digits) -> Illumination {
    let theta = digits.one_of(&[0.0, 30.0, 45.0, 70.0, 85.0, 89.0, 89.9]);
    let phi = digits.one_of(&[0.0, 20.0, 45.0, 90.0, 180.0, 211.0, 270.0, 359.9]);
    let incidence = Incidence::from_degrees(theta, phi).unwrap();
    let point = digits.one_of(&[0.25, 0.5, 0.0, 1.0, 1.0 / 3.0]);
    let window = match digits.below(4) {
        0 => Window {
            from: [point; 2],
            to: [point; 2],
        },
        1 => Window {
            from: [0.1, 0.4],
            to: [0.7, 0.4],
        },
        _ => Window::WHOLE,
    };
    let any_azimuth = digits.below(3) == 0;
    let stokes = match digits.below(4) {
        0 => [0.3, -0.5, 0.7],
        _ => [0.0; 3],
    };
    Illumination {
        window,
        stokes,
        starts: digits.one_of(&[Starts::FromAbove, Starts::OnSurface]),
        ..Illumination::new(incidence, any_azimuth)
    }
}

/// Windows about the specular direction, on both sides, and all light of one.
fn apertures(light: &Illumination) -> Apertures {
    let (theta, phi) = (
        light.incidence.theta(),
        if light.any_azimuth { 0.0 } else { 1.0 },
    );
    // Azimuths that are free have vertical apertures alone
    let theta = if light.incidence.is_vertical() {
        0.0
    } else {
        theta
    };
    let receptor = ApertureShape::Receptor {
        in_plane: [0.2, 0.3],
        across: [0.4, 0.9 + phi],
    };
    let list = [
        Aperture::whole(Side::Transmitted),
        Aperture::cone(Side::Reflected, theta, 0.3),
        Aperture {
            shape: receptor,
            ..Aperture::cone(Side::Reflected, theta, 0.0)
        },
    ];
    list.into_iter().collect()
}

fn spec(digits: &mut Digits, light: &Illumination) -> TallySpec {
    let edges = || {
        let phi = vec![20.0, 150.0, 199.0, 201.0, 250.0, 380.0];
        let reflected = vec![0.0, 20.0, 29.0, 29.99, 30.01, 31.0, 90.0];
        let transmitted = vec![90.0, 140.0, 158.0, 159.9, 160.1, 170.0, 180.0];
        let reflected = SideEdges::new(Side::Reflected, reflected, phi.clone()).unwrap();
        let transmitted = SideEdges::new(Side::Transmitted, transmitted, phi).unwrap();
        HemisphereGrid::with_edges([reflected, transmitted]).unwrap()
    };
    let grid = match digits.below(4) {
        0 => HemisphereGrid::default(),
        1 => HemisphereGrid::new(7, 13).unwrap(),
        2 => HemisphereGrid::new(1, 1).unwrap(),
        _ => edges(),
    };
    let half_width = digits.one_of(&[0.1, 1e-3, std::f64::consts::FRAC_PI_2]);
    let sides = digits.one_of(&[
        Sides::Both,
        Sides::Both,
        Sides::Reflected,
        Sides::Transmitted,
    ]);
    let spec = TallySpec::new(grid, half_width).unwrap().with_sides(sides);
    match digits.below(2) {
        0 => spec,
        _ => spec.with_apertures(apertures(light)),
    }
}

/// A control variate with visible fractions of any size, now and then one, and with shadows of some paths alone.
fn control(digits: &mut Digits, spec: TallySpec) -> Option<ControlVariate> {
    let seed = digits.below(1000) as u32;
    let rings = |side: u32| {
        let count = 0..spec.grid().n_theta();
        let fraction = |ring| (1.25 * noise(seed + side, ring)).min(1.0);
        count.map(fraction).collect()
    };
    let fractions = VisibleFractions {
        rings: [rings(0), rings(1)],
        absorbed: noise(seed, 0),
    };
    let control = ControlVariate::new(spec, fractions, &UnshadowedFluxes::zeros(&spec));
    let probability = digits.one_of(&[1.0, 0.4]);
    (digits.below(2) == 0).then(|| control.with_shadow_probability(probability))
}

fn settings(digits: &mut Digits) -> PathSettings {
    let branching = digits.one_of(&[Branching::Split, Branching::Pick]);
    let roulette = digits.one_of(&[0.01, 0.01, 1e-3, 0.3, 1.0]);
    let max_order = digits.one_of(&[200, 200, 40, 3, 1]);
    let settings = PathSettings::new(branching, roulette, max_order).unwrap();
    settings.with_polarisation(digits.one_of(&[
        Polarisation::Averaged,
        Polarisation::Tracked,
        Polarisation::Both,
        Polarisation::Mueller,
    ]))
}

/// Digits of a number in changing bases, which choose a case.
struct Digits(u64);

impl Digits {
    fn below(&mut self, base: usize) -> usize {
        // Words of a linear congruence, of which the high ones are as good as random
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % base as u64) as usize
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
}

/// Case number `number`.
pub(crate) fn case(number: u64) -> Case {
    let digits = &mut Digits(number);
    let rays = match digits.below(3) {
        0 => BatchedRays::of_one(12),
        1 => BatchedRays::new(16, 5, 37..101),
        _ => BatchedRays::new(13, 3, 109..169),
    };
    let light = light(digits);
    let settings = settings(digits);
    let polarimetry = settings.polarisation().polarimetry();
    let spec = spec(digits, &light).with_polarimetry(polarimetry);
    Case {
        control: control(digits, spec),
        shape: shape(digits),
        materials: materials(digits),
        incident: digits.one_of(&[HalfSpace::Above, HalfSpace::Above, HalfSpace::Below]),
        settings,
        spec,
        light,
        rays,
        stream: PathStream::new(number, 7).from_batch(number % 5),
    }
}
