//! Surface starts: the points of the surface at which paths start, many at a time.

use asperity_surface::Border;
use glam::DVec3;

use super::arrivals::{Arrivals, Move};
use super::beam::Beam;
use super::segments::{IncidentState, Segments};
use crate::geometry::Geometry;
use crate::periodic::mirror_image;
use crate::sampling::Start;
use crate::vector::Stage;

/// Finds the points of the surface over which paths start, the facets there, and the flux that falls on them, with rays towards
/// the light. There are none where the geometry does not have exactly one facet over every place.
pub(super) struct StartOnSurface<'a, G: Geometry> {
    pub(super) geometry: &'a G,
    pub(super) beam: &'a Beam,
    pub(super) starts: &'a [Start],
    /// With the direction towards it.
    pub(super) light: &'a IncidentState,
    /// Empty before.
    pub(super) into: &'a mut Arrivals<G::Facet>,
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
            let [u, v, _] = start.place;
            [*x, *y] = beam.place([u, v]);
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
        let [wx, wy, wz] = at.direction.each_ref().map(|column| &column[..n]);
        let [mx, my, mz] = normal.each_ref().map(|column| &column[..n]);
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
    use asperity_optics::Incidence;
    use asperity_surface::{HeightField, Psd, SplineSurface, Synthesis};
    use glam::DVec2;

    use super::*;
    use crate::geometry::height_field::Surface;
    use crate::geometry::smooth::SmoothSurface;
    use crate::path::light_state::LightState;
    use crate::path::segments::Kept;
    use crate::path::window::Window;
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
            let place = match ray % 10 {
                0 => [part(0.25), part(0.5)],
                1 => [f64::from(ray / 10 % 2), f64::from(ray / 20 % 2)],
                _ => [part(0.569_840), part(0.754_878)],
            };
            let azimuth = if any_azimuth { part(0.618_034) } else { 0.0 };
            Start {
                place: [place[0], place[1], azimuth],
                ray,
            }
        };
        (0..333).map(start).collect()
    }

    /// Compares starts on a surface with [`Beam::point`].
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
            let mut facing_away = 0;
            for (i, start) in starts.iter().enumerate() {
                let ([u, v, _], turn) = (start.place, start.turn());
                let (heading, facet, flux) = beam.point(surface, [u, v], turn).unwrap();
                let towards_light = found.at.heading(i);
                assert_eq!(found.facets[i], facet, "{i}");
                assert_eq!(towards_light.origin, heading.origin, "{i}");
                assert_eq!(towards_light.direction, -heading.direction, "{i}");
                assert_eq!(towards_light.mirrored, heading.mirrored, "{i}");
                let state = found.at.state(i);
                assert_eq!(state.flux, flux, "{i}");
                assert_eq!(state.ray, start.ray);
                assert_eq!(state.turn, DVec2::new(turn.x, -turn.y));
                assert_eq!((state.events.order(), state.scatterings), (0, 0));
                assert_eq!(found.at.half_space(i), half_space);
                facing_away += usize::from(flux == 0.0);
            }
            assert!((20..300).contains(&facing_away), "{facing_away}");
        }
    }

    #[test]
    fn many_starts_are_where_one_is() {
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
