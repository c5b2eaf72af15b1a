//! Light paths: single paths over a section of a surface, for a figure.
//!
//! Rays aim at points of the section of the first surface by the plane of incidence through the middle of its tile, so that all begin in that
//! plane; most leave it where they are scattered. Polarisation is averaged at every interface, and one branch is picked.

use std::f64::consts::PI;
use std::sync::Arc;

use asperity_numerics::elementary::{cos, sin};
use asperity_optics::{BottomSurface, Material};
use asperity_tally::EventPath;
use asperity_tracer::{
    BuildAccelerator, Geometry, PathEnd, PathIntegrator, Polarisation, SearchedSurface, Shape,
    TracedStack,
};
use glam::{DVec2, DVec3};

use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::settings::Settings;
use crate::stream::point_stream;

/// Points of the section.
const SECTION: usize = 400;

/// Part of the section at which rays aim, about its middle.
const AIMED: f64 = 0.7;

/// A section of a surface, and paths that begin on it. Lengths are in the unit of the surface, along the direction in which the light travels
/// and across it from the middle of the tile, and above the mean plane.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPaths {
    /// Points `[along, height]` of the surface.
    pub section: Vec<[f64; 2]>,
    /// Heights of the flat bottoms of layers.
    pub planes: Vec<f64>,
    /// The paths.
    pub paths: Vec<LightPath>,
}

/// The path of a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPath {
    /// Its points `[along, across, height]`: where it comes from, its interactions, and where it goes.
    pub points: Vec<[f64; 3]>,
    /// Its interactions with surfaces.
    pub events: EventPath,
    /// Number of scatterings inside layers.
    pub scatterings: u32,
    /// Kind of its end.
    pub end: PathEnd,
}

impl LightPaths {
    /// Traces `count` rays of a case on given surfaces over a section of this `length`, or of the tile where that is shorter; `None` on random
    /// surfaces.
    ///
    /// # Errors
    /// [`SimulateError`] if the surface cannot be searched, or the layers do not fit below it.
    ///
    /// # Panics
    /// If the light comes from below.
    pub fn of(
        case: &Case,
        settings: &Settings,
        length: f64,
        count: u64,
    ) -> Result<Option<Self>, SimulateError> {
        let Some(shape) = case.surface.shapes().first() else {
            return Ok(None);
        };
        let paths = match shape {
            Shape::HeightField { top, below } => on(top, below, case, settings, length, count),
            Shape::Smooth { top, below } => on(top, below, case, settings, length, count),
            Shape::TriangleMesh { top, below } => on(top, below, case, settings, length, count),
        };
        paths.map(Some)
    }
}

fn on<G: BuildAccelerator>(
    top: &Arc<G>,
    below: &[Option<Arc<G>>],
    case: &Case,
    settings: &Settings,
    length: f64,
    count: u64,
) -> Result<LightPaths, SimulateError> {
    let top = &**top;
    let accelerator = top.accelerator(settings.accelerator)?;
    let of_bottom = |bottom: &Option<Arc<G>>| {
        let bottom = bottom.as_ref();
        bottom
            .map(|bottom| bottom.accelerator(settings.accelerator))
            .transpose()
    };
    let accelerators = below.iter().map(of_bottom).collect::<Result<Vec<_>, _>>()?;
    let bottoms = below
        .iter()
        .zip(&accelerators)
        .map(|(bottom, accelerator)| {
            Some(SearchedSurface {
                geometry: bottom.as_deref()?,
                accelerator: accelerator.as_deref()?,
            })
        });
    let bottoms: Vec<_> = bottoms.collect();
    let searched = SearchedSurface {
        geometry: top,
        accelerator: &*accelerator,
    };
    let stack = TracedStack::new(searched, &case.layers, &bottoms, settings.max_scatterings)?;
    let paths = settings.paths.without_pilot();
    let paths = paths.with_polarisation(Polarisation::Averaged);
    let frame = Frame::of(top, case, length);
    let mirror = PathIntegrator::new(top, &*accelerator, Material::Mirror, paths);
    let integrator = PathIntegrator::new(top, &*accelerator, case.material, paths).over(stack);
    let wi = case.light.incidence.wi();

    let steps = 0..=SECTION;
    let section = steps.filter_map(|i| {
        let along = frame.length * (i as f64 / SECTION as f64 - 0.5);
        let mut first = None;
        let origin = frame.before(top, along, DVec3::Z);
        let visit = &mut |at| first = first.or(Some(at));
        mirror.trace_visiting(origin, -DVec3::Z, &mut point_stream(0, 0, 0), visit);
        Some([along, frame.place(top, first?)[2]])
    });
    let section = section.collect();
    let path = |number: u64| {
        let along = AIMED * frame.length * ((number as f64 + 0.5) / count as f64 - 0.5);
        let origin = frame.before(top, along, wi);
        let mut points = vec![frame.place(top, origin)];
        let mut rng = point_stream(settings.seed, 0, number);
        let visit = &mut |at| points.push(frame.place(top, at));
        let result = integrator.trace_visiting(origin, -wi, &mut rng, visit);
        // From far before to far after
        let far = 4.0 * frame.length;
        points[0] = plus(points[0], frame.turned(far * wi));
        let last = frame.place(top, result.origin);
        if points.last() != Some(&last) && points.len() > 1 {
            points.push(last);
        }
        if matches!(result.end, PathEnd::Above | PathEnd::Below) {
            points.push(plus(last, frame.turned(far * result.direction)));
        }
        LightPath {
            points,
            events: result.path,
            scatterings: result.scatterings,
            end: result.end,
        }
    };
    let mut depth = 0.0;
    let planes = case.layers.iter().zip(0..).filter_map(|(layer, number)| {
        let end = layer.end()?;
        depth += end.thickness;
        let is_plane =
            bottoms.get(number).is_none_or(Option::is_none) && end.shape == BottomSurface::Flat;
        is_plane.then_some(-depth)
    });
    let planes = planes.collect();
    Ok(LightPaths {
        section,
        planes,
        paths: (0..count).map(path).collect(),
    })
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

/// Coordinates along the direction in which the light travels, across it, and above the mean plane.
struct Frame {
    along: DVec2,
    /// Middle of the tile, tile coordinates.
    middle: DVec2,
    length: f64,
}

impl Frame {
    fn of<G: Geometry>(top: &G, case: &Case, length: f64) -> Self {
        let phi = case.light.incidence.phi() + PI;
        let along = DVec2::new(cos(phi), sin(phi));
        let [x, y] = top.extent();
        let middle = 0.5 * DVec2::new(x, y);
        // The part of the line through the middle that lies in the tile
        let sides = DVec2::new(x, y / top.aspect()) * top.unit();
        let within = (sides / along.abs()).min_element();
        let length = length.min(within);
        Self {
            along,
            middle,
            length,
        }
    }

    /// A vector of the world in the frame.
    fn turned(&self, world: DVec3) -> [f64; 3] {
        let flat = world.truncate();
        [self.along.dot(flat), self.along.perp_dot(flat), world.z]
    }

    /// A point of the tile, continued without end, in the frame.
    fn place<G: Geometry>(&self, top: &G, at: DVec3) -> [f64; 3] {
        let flat = (at.truncate() - self.middle) / DVec2::new(1.0, top.aspect());
        self.turned(top.unit() * flat.extend(at.z - top.mean_plane()))
    }

    /// The point of the tile above the surface from which light from the direction `wi` comes to the mean plane at a place of the section.
    fn before<G: Geometry>(&self, top: &G, along: f64, wi: DVec3) -> DVec3 {
        let [_, high] = top.z_range();
        let height = high - top.mean_plane();
        let flat = along / top.unit() * self.along + height / wi.z * wi.truncate();
        let place = self.middle + flat * DVec2::new(1.0, top.aspect());
        place.extend(high)
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Bottom, Incidence, Layer, ParticipatingMedium, PhaseFunction};
    use asperity_surface::HeightField;
    use asperity_synthesis::{Psd, Synthesis};

    use super::*;
    use crate::input::case::Light;
    use crate::input::surface_source::SurfaceSource;

    const GLASS: Material = Material::Dielectric { eta: 1.5 };

    fn case(field: HeightField, theta: f64, phi: f64) -> Case {
        let light = Light::from_above(Incidence::from_degrees(theta, phi).unwrap());
        Case::new(SurfaceSource::height_field(field), GLASS, light)
    }

    fn paths(case: &Case, length: f64, count: u64) -> LightPaths {
        let settings = Settings::default();
        let found = LightPaths::of(case, &settings, length, count).unwrap();
        found.unwrap()
    }

    /// Columns are half as wide as rows, so that axes cannot be mixed up.
    fn rough() -> HeightField {
        let psd = Psd::gaussian(4.0, 4.0).unwrap();
        let synthesis = Synthesis::new(psd, [64, 128], [0.5, 1.0], false).unwrap();
        synthesis.draw(3, 0).unwrap()
    }

    #[test]
    fn light_on_a_plane_goes_by_the_laws_of_reflection_and_refraction() {
        let field = HeightField::new(vec![2.0; 16], [4, 4], [1.0, 3.0]).unwrap();
        let found = paths(&case(field, 30.0, 250.0), 2.0, 200);
        assert!(found.section.iter().all(|[_, height]| height.abs() < 1e-12));
        assert!((found.section[0][0] + 1.0).abs() < 1e-12);
        let slope = |a: [f64; 3], b: [f64; 3]| (b[0] - a[0]) / (b[2] - a[2]);
        let (mut above, mut below) = (0, 0);
        for (i, path) in found.paths.iter().enumerate() {
            let &[before, at, after] = path.points.as_slice() else {
                panic!("{path:?}");
            };
            let aimed = AIMED * 2.0 * ((i as f64 + 0.5) / 200.0 - 0.5);
            assert!((at[0] - aimed).abs() < 1e-9 && at[2].abs() < 1e-9);
            assert!([before, at, after].iter().all(|p| p[1].abs() < 1e-9));
            let tan = 30_f64.to_radians().tan();
            assert!((slope(before, at) + tan).abs() < 1e-9);
            let refracted = (0.5_f64 / 1.5).asin().tan();
            match path.end {
                PathEnd::Above => {
                    above += 1;
                    assert!((slope(at, after) - tan).abs() < 1e-9);
                }
                _ => {
                    below += 1;
                    assert!((slope(at, after) + refracted).abs() < 1e-9);
                }
            }
        }
        // 4 % are reflected
        assert!(above > 0 && below > 150);
    }

    #[test]
    fn interactions_lie_on_the_surface_and_the_first_in_its_section() {
        let field = rough();
        let surface = asperity_tracer::Surface::new(field.clone());
        let found = paths(&case(field, 60.0, 20.0), 16.0, 40);
        let (sin, cos) = 200_f64.to_radians().sin_cos();
        let height = |[along, across, _]: [f64; 3]| {
            let world = [along * cos - across * sin, along * sin + across * cos];
            let x = (world[0] / 0.5 + 64.0).rem_euclid(128.0);
            let y = (world[1] + 32.0).rem_euclid(64.0);
            let scaled = surface.extent()[1] / 64.0 * y;
            let (_, at) = surface
                .over(surface.extent()[0] / 128.0 * x, scaled)
                .unwrap();
            (at.z - surface.mean_plane()) * surface.unit()
        };
        for &[along, z] in &found.section {
            assert!((height([along, 0.0, z]) - z).abs() < 1e-9, "{along}");
        }
        assert!((found.section[0][0] + 8.0).abs() < 1e-12);
        let mut several = 0;
        for path in &found.paths {
            let order = path.events.order() as usize;
            assert_eq!(path.points.len(), order + 2, "{path:?}");
            several += usize::from(order > 1);
            assert!(path.points[1][1].abs() < 1e-9);
            for &at in &path.points[1..=order] {
                assert!((height(at) - at[2]).abs() < 1e-9, "{at:?}");
            }
        }
        assert!(several > 5, "{several}");
    }

    #[test]
    fn scatterings_of_a_layer_lie_between_surface_and_bottom() {
        let mut case = case(rough(), 30.0, 0.0);
        let fog = ParticipatingMedium::from_coefficients(0.0, 0.2, PhaseFunction::Isotropic);
        case.layers = vec![Layer::slab(fog.unwrap(), 30.0, Bottom::MIRROR).unwrap()];
        let found = paths(&case, 16.0, 20);
        assert_eq!(found.planes, [-30.0]);
        let mut scattered = 0;
        for path in &found.paths {
            let inner = path.events.order() as usize + path.scatterings as usize;
            assert_eq!(path.points.len(), inner + 2);
            let inside = &path.points[1..=inner];
            assert!(inside.iter().all(|at| at[2] > -30.0 - 1e-9));
            scattered += path.scatterings;
        }
        assert!(scattered > 20);
    }
}
