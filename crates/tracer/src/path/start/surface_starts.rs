//! Surface starts: the points of the surface at which paths start, many at a time.

use asperity_surface::Border;
use glam::DVec3;

use crate::geometry::Geometry;
use crate::path::beam::Beam;
use crate::path::state::arrivals::{Arrivals, Move};
use crate::path::state::segments::{IncidentState, Segments, rows_of};
use crate::periodic::mirror_image;
use crate::sampling::Start;
use crate::vector::Stage;

/// Finds the points of the surface over which paths start, the facets there, and the flux that falls on them, with rays towards
/// the light. A geometry that is not a height field has none.
pub(crate) struct StartOnSurface<'a, G: Geometry> {
    pub(crate) geometry: &'a G,
    pub(crate) beam: &'a Beam,
    pub(crate) starts: &'a [Start],
    /// With the direction towards it.
    pub(crate) light: &'a IncidentState,
    /// Empty before.
    pub(crate) into: &'a mut Arrivals<G::Facet>,
}

impl<G: Geometry> Stage for StartOnSurface<'_, G> {
    #[inline(always)]
    fn run(self) {
        let Self {
            geometry,
            beam,
            starts,
            light,
            into,
        } = self;

        // Place the starts over the tile
        debug_assert_eq!(into.len(), 0);
        into.at.add_starts(starts, light);
        let [x, y, z] = &mut into.at.origin;
        z[..starts.len()].fill(0.0);
        for (start, (x, y)) in starts.iter().zip(x.iter_mut().zip(y)) {
            let [u, v, _] = start.position;
            [*x, *y] = beam.position([u, v]);
        }
        if geometry.border() == Border::Mirrored {
            mirror_images(geometry, &mut into.at);
        }

        // Find the facets there
        let [x, y, _] = &into.at.origin;
        into.facets.reserve(starts.len());
        for (x, y) in x.iter().zip(y).take(starts.len()) {
            if let Some(facet) = geometry.facet_over(*x, *y) {
                into.facets.push(facet);
            }
        }
        debug_assert!(into.facets.is_empty() || into.facets.len() == starts.len());
        into.at.len = into.facets.len();
        into.ts.resize(into.facets.len(), 0.0);
        Move {
            geometry,
            arrivals: into,
        }
        .run();

        // Find the flux that falls on them
        let Arrivals { at, normal, .. } = into;
        let n = at.len;
        let [wx, wy, wz] = rows_of(&at.direction, 0..n);
        let [mx, my, mz] = rows_of(normal, 0..n);
        let flux = &mut at.flux[..n];
        for i in 0..n {
            let (wi, m) = (
                DVec3::new(wx[i], wy[i], wz[i]),
                DVec3::new(mx[i], my[i], mz[i]),
            );
            flux[i] = beam.flux_on(wi, m);
        }
    }
}

/// Moves rays that begin in mirror images of the tile into the tile.
fn mirror_images<G: Geometry>(geometry: &G, rays: &mut Segments) {
    for i in 0..rays.len {
        let heading = mirror_image(geometry, rays.heading(i));
        rays.set_heading(i, &heading);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use asperity_optics::Incidence;
    use asperity_surface::{HeightField, SplineSurface};
    use asperity_synthesis::{Psd, Synthesis};
    use glam::DVec2;

    use super::*;
    use crate::geometry::height_field::Surface;
    use crate::geometry::smooth::SmoothSurface;
    use crate::path::illumination::Window;
    use crate::path::state::light_state::LightState;
    use crate::path::state::segments::Kept;
    use crate::ray::HalfSpace;
    use crate::vector::Instructions;

    /// A rough field of 16 x 12 cells.
    fn field(border: Border) -> HeightField {
        let psd = Psd::gaussian(2.0, 4.0).unwrap();
        let synthesis = Synthesis::new(psd, [12, 16], [1.0, 1.25], true).unwrap();
        synthesis.draw(1, 0).unwrap().with_border(border)
    }

    /// Starts anywhere in the window, on edges of cells and at its corners.
    fn starts(any_azimuth: bool) -> Vec<Start> {
        let start = |ray: u32| {
            let part = |step: f64| (f64::from(ray) * step).fract();
            let position = match ray % 10 {
                0 => [part(0.25), part(0.5)],
                1 => [f64::from(ray / 10 % 2), f64::from(ray / 20 % 2)],
                _ => [part(0.569_840), part(0.754_878)],
            };
            let azimuth = if any_azimuth { part(0.618_034) } else { 0.0 };
            Start {
                position: [position[0], position[1], azimuth],
                ray,
            }
        };
        (0..333).map(start).collect()
    }

    /// The position of a start in the tile, and the axes along which it is mirrored, by the definition of borders.
    fn position_in_tile<G: Geometry>(surface: &G, [u, v]: [f64; 2]) -> ([f64; 2], [bool; 2]) {
        let mirrored = surface.border() == Border::Mirrored;
        let tiles = if mirrored { 2.0 } else { 1.0 };
        let [cx, cy] = surface.extent();
        let position = [u * tiles * cx, v * tiles * cy];
        let beyond = [position[0] >= cx && mirrored, position[1] >= cy && mirrored];
        let back = |p: f64, beyond: bool, size: f64| if beyond { 2.0 * size - p } else { p };
        let position = [
            back(position[0], beyond[0], cx),
            back(position[1], beyond[1], cy),
        ];
        (position, beyond)
    }

    /// Compares starts on a surface with points of it found one by one, and their flux with the weight of Xu and Sun 2008, Eq. 26.
    fn compare<G: Geometry>(surface: &G, half_space: HalfSpace, any_azimuth: bool) {
        let incidence = Incidence::from_degrees(65.0, 20.0).unwrap();
        let beam = Beam::new(surface, half_space, incidence, Window::WHOLE);
        let starts = starts(any_azimuth);
        let kept = Kept {
            turn: any_azimuth,
            ..Kept::NOTHING
        };
        for instructions in [
            Instructions::Portable,
            Instructions::Avx2,
            Instructions::Avx512,
        ] {
            let mut found = Arrivals::new(kept);
            instructions.run(StartOnSurface {
                geometry: surface,
                beam: &beam,
                starts: &starts,
                light: &IncidentState {
                    direction: beam.wi(),
                    half_space,
                    state: LightState::NONE,
                },
                into: &mut found,
            });
            assert_eq!(found.len(), starts.len());
            let bound = beam.largest_flux_on(surface.steepest_slope());
            let (mut facing_away, mut largest) = (0, 0.0_f64);
            for (i, start) in starts.iter().enumerate() {
                let ([u, v, azimuth], turn) = (start.position, start.turn());
                let ([x, y], mirrored) = position_in_tile(surface, [u, v]);
                let (facet, point) = surface.over(x, y).unwrap();
                let sign = half_space.sign();
                let phi = incidence.phi() + TAU * azimuth;
                let (sin, cos) = incidence.theta().sin_cos();
                let flip = mirrored.map(|is| if is { -1.0 } else { 1.0 });
                let wi = DVec3::new(
                    flip[0] * sin * phi.cos(),
                    flip[1] * sin * phi.sin(),
                    sign * cos,
                );
                let m = sign * surface.normal_at(facet, point);
                let flux = wi.dot(m).max(0.0) / (m.z.abs() * cos);
                let towards_light = found.at.heading(i);
                assert_eq!(found.facets[i], facet, "{i}");
                assert_eq!(towards_light.mirrored, mirrored, "{i}");
                // Positions and sines to a few roundings
                assert!((towards_light.origin - point).length() < 1e-12, "{i}");
                assert!((towards_light.direction - wi).length() < 1e-14, "{i}");
                let state = found.at.state(i);
                assert!((state.flux - flux).abs() < 1e-13 * (1.0 + flux), "{i}");
                assert_eq!(state.ray, start.ray);
                assert_eq!(state.turn, DVec2::new(turn.x, -turn.y));
                assert_eq!((state.events.order(), state.scatterings), (0, 0));
                assert_eq!(found.at.half_space(i), half_space);
                facing_away += usize::from(state.flux == 0.0);
                largest = largest.max(state.flux);
            }
            assert!(
                (0.3 * bound..=bound).contains(&largest),
                "{largest} {bound}"
            );
            assert!((20..300).contains(&facing_away), "{facing_away}");
        }
    }

    #[test]
    fn many_starts_are_where_the_definition_of_borders_puts_them() {
        for border in [Border::Periodic, Border::Mirrored, Border::Open] {
            let field = field(border);
            let smooth = SmoothSurface::new(SplineSurface::through(&field));
            let flat_cells = Surface::new(field);
            for half_space in [HalfSpace::Above, HalfSpace::Below] {
                for any_azimuth in [false, true] {
                    compare(&flat_cells, half_space, any_azimuth);
                    compare(&smooth, half_space, any_azimuth);
                }
            }
        }
    }
}
