//! Slope images: where the facets of each cell of a slope table send the light.
//!
//! Unshadowed single scattering by a table is a sum over its cells, each of which sends a known flux about its mirrored or refracted direction.
//! A cell whose light crosses an edge between places, which are bins or whatever is counted, is divided into four, and so on, until what is
//! divided holds less flux than [`LEAST_FLUX`]. The places of the corners then share it. Images do not depend on the
//! masses of cells but by how finely they are divided: one set serves all tables on a grid.
//!
//! Shadowing and masking are those of one direction per cell and place, the mean of the light that goes there.

use asperity_optics::Material;
use asperity_tally::Side;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::microfacet::beckmann::Masking;
use crate::microfacet::half_vector::outgoing_direction;
use crate::microfacet::lambda_map::LambdaMap;
use crate::microfacet::slope_table::SlopeTable;

/// Flux fraction of a square of slopes that is divided no further. Of a bin with the flux `f` some `4 sqrt(f / LEAST_FLUX)` squares lie on its
/// edge, each wrong by about a tenth of its flux either way: for a flux of 1e-3, that is 4e-8 together.
const LEAST_FLUX: f64 = 1e-8;

/// Divisions in four, at most.
const MAX_DEPTH: u32 = 12;

/// Distance between the directions of opposite corners, in radians, above which a square is divided whatever its places: bins that are
/// narrower could be missed.
const MAX_SPREAD: f64 = 0.03;

/// Light from one direction on facets of one material, and the side that it leaves on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FacetLight {
    pub(crate) wi: DVec3,
    pub(crate) material: Material,
    pub(crate) side: Side,
}

/// Part of the light of the facets of a cell.
#[derive(Clone, Copy, Debug)]
struct Image<P> {
    cell: usize,
    place: P,
    /// Unshadowed flux fraction, over the mass of the cell.
    flux: f64,
    /// Its mean direction, of any length.
    wo: DVec3,
}

/// Images of all cells of a table.
pub(crate) struct SlopeImages<P> {
    light: FacetLight,
    images: Vec<Image<P>>,
}

impl<P: Copy + PartialEq + Send + Sync> SlopeImages<P> {
    /// `place`: of a direction on the side of the light; `None` if it is not counted.
    pub(crate) fn new(
        table: &SlopeTable,
        light: FacetLight,
        place: impl Fn(DVec3) -> Option<P> + Sync,
    ) -> Self {
        let refracted = match light.side {
            Side::Reflected => None,
            Side::Transmitted => light.material.transmitting_index(),
        };
        let nothing = light.wi.z <= 0.0 || light.side == Side::Transmitted && refracted.is_none();
        let images = if nothing {
            Vec::new()
        } else {
            let divider = Divider {
                light,
                refracted,
                tangent: light.wi.truncate() / light.wi.z,
                place: &place,
            };
            let cells: Vec<usize> = (0..table.grid().len())
                .filter(|&cell| table.masses()[cell] > 0.0)
                .collect();
            cells
                .par_iter()
                .flat_map_iter(|&cell| divider.images(table, cell))
                .collect()
        };
        Self { light, images }
    }

    /// Flux that each image adds to its place, by the masses of `table`, on the same grid, with the Lambda of `map`.
    pub(crate) fn fluxes(
        &self,
        table: &SlopeTable,
        map: &LambdaMap,
    ) -> impl Iterator<Item = (P, f64)> {
        let lambda_i = table.lambda(self.light.wi);
        let is_reflected = self.light.side == Side::Reflected;
        self.images.iter().map(move |image| {
            let lambda_o = map.lambda(image.wo);
            let g2 = Masking::HeightCorrelated.g2([lambda_i, lambda_o], is_reflected);
            (image.place, table.masses()[image.cell] * image.flux * g2)
        })
    }
}

/// Direction of the light of one slope; none on this side if `wo` is `None`.
#[derive(Clone, Copy)]
struct Exit<P> {
    wo: Option<DVec3>,
    place: Option<P>,
}

/// A square of slopes within a cell.
#[derive(Clone, Copy)]
struct Square {
    low: DVec2,
    high: DVec2,
    /// Part of the cell.
    part: f64,
    depth: u32,
}

struct Divider<'a, F> {
    light: FacetLight,
    refracted: Option<f64>,
    /// `tan(theta_i)` along the azimuth of the light.
    tangent: DVec2,
    place: &'a F,
}

impl<F> Divider<'_, F> {
    fn images<P>(&self, table: &SlopeTable, cell: usize) -> Vec<Image<P>>
    where
        P: Copy + PartialEq,
        F: Fn(DVec3) -> Option<P>,
    {
        let [low, high] = table.grid().facets(cell);
        let square = Square {
            low,
            high,
            part: 1.0,
            depth: 0,
        };
        let corners = corners(low, high).map(|slope| self.exit(slope));
        let mut images = Vec::new();
        let mut add = |place, flux, wo| match images
            .iter_mut()
            .find(|image: &&mut Image<P>| image.place == place)
        {
            Some(image) => {
                image.flux += flux;
                image.wo += flux * wo;
            }
            None => images.push(Image {
                cell,
                place,
                flux,
                wo: flux * wo,
            }),
        };
        self.divide(square, corners, table.masses()[cell], &mut add);
        images
    }

    /// Corners are in the order of [`corners`].
    fn divide<P>(
        &self,
        square: Square,
        corners: [Exit<P>; 4],
        mass: f64,
        add: &mut impl FnMut(P, f64, DVec3),
    ) where
        P: Copy + PartialEq,
        F: Fn(DVec3) -> Option<P>,
    {
        let Square {
            low,
            high,
            part,
            depth,
        } = square;
        let middle = 0.5 * (low + high);
        let flux = part * self.flux(middle);
        // A facet that turns away in the middle may have others that do not.
        let steepest = part * (1.0 + self.tangent.length() * middle.length());
        let is_small = depth >= MAX_DEPTH || mass * steepest <= LEAST_FLUX;
        let agree = corners.iter().all(|exit| exit.place == corners[0].place)
            && corners
                .iter()
                .all(|exit| exit.wo.is_some() == corners[0].wo.is_some());
        if is_small || depth > 0 && agree && spread(&corners) <= MAX_SPREAD {
            for Exit { wo, place } in corners {
                if let (Some(wo), Some(place)) = (wo, place)
                    && flux > 0.0
                {
                    add(place, 0.25 * flux, wo);
                }
            }
            return;
        }
        let exit = |x: f64, y: f64| self.exit(DVec2::new(x, y));
        let [a, b, c, d] = corners;
        let centre = exit(middle.x, middle.y);
        let [south, north] = [low.y, high.y].map(|y| exit(middle.x, y));
        let [west, east] = [low.x, high.x].map(|x| exit(x, middle.y));
        let quarters = [
            ([low.x, low.y], [a, south, west, centre]),
            ([middle.x, low.y], [south, b, centre, east]),
            ([low.x, middle.y], [west, centre, c, north]),
            ([middle.x, middle.y], [centre, east, north, d]),
        ];
        let half = 0.5 * (high - low);
        for (from, corners) in quarters {
            let low = DVec2::from_array(from);
            let quarter = Square {
                low,
                high: low + half,
                part: 0.25 * part,
                depth: depth + 1,
            };
            self.divide(quarter, corners, mass, add);
        }
    }

    fn exit<P>(&self, slope: DVec2) -> Exit<P>
    where
        F: Fn(DVec3) -> Option<P>,
    {
        let m = (-slope).extend(1.0).normalize();
        let wo = outgoing_direction(&self.light.material, self.light.wi, m, self.refracted);
        let wo = wo.filter(|wo| match self.light.side {
            Side::Reflected => wo.z > 0.0,
            Side::Transmitted => wo.z < 0.0,
        });
        Exit {
            wo,
            place: wo.and_then(|wo| (self.place)(wo)),
        }
    }

    /// Flux that facets of this slope send to the side, over what falls on the mean plane above them.
    fn flux(&self, slope: DVec2) -> f64 {
        let area = 1.0 - self.tangent.dot(slope);
        if area <= 0.0 {
            return 0.0;
        }
        let m = (-slope).extend(1.0).normalize();
        let cos_theta_i = self.light.wi.dot(m).clamp(0.0, 1.0);
        let fresnel = self.light.material.fresnel(cos_theta_i);
        area * match self.light.side {
            Side::Reflected => fresnel.reflected,
            Side::Transmitted => fresnel.transmitted,
        }
    }
}

fn corners(low: DVec2, high: DVec2) -> [DVec2; 4] {
    [
        low,
        DVec2::new(high.x, low.y),
        DVec2::new(low.x, high.y),
        high,
    ]
}

/// Distance between the directions of opposite corners; zero if one has none.
fn spread<P: Copy>(corners: &[Exit<P>; 4]) -> f64 {
    let distance = |a: usize, b: usize| match (corners[a].wo, corners[b].wo) {
        (Some(a), Some(b)) => a.distance(b),
        _ => 0.0,
    };
    distance(0, 3).max(distance(1, 2))
}

#[cfg(test)]
mod tests {
    use asperity_optics::Incidence;
    use asperity_tally::HemisphereGrid;

    use super::*;
    use crate::microfacet::lambda_map::MapSize;

    /// Level facets send all light into one bin, though bins meet at the direction of a mirror or along the plane of incidence; slopes about
    /// level ones send it to both sides.
    #[test]
    fn light_of_level_facets_is_not_divided_between_bins() {
        let grid = HemisphereGrid::new(18, 36).unwrap();
        // Slopes, and how many rings and sectors each reaches
        let plateau = [[0.0; 2]; 4];
        let grooves = [[0.04, 0.0], [-0.04, 0.0], [0.02, 0.0], [-0.02, 0.0]];
        let tilted = [[0.02, 0.02], [-0.02, 0.02], [0.02, -0.02], [-0.02, -0.02]];
        for theta in [30.0, 40.0, 45.0, 60.0] {
            let light = FacetLight {
                wi: Incidence::from_degrees(theta, 0.0).unwrap().wi(),
                material: Material::Mirror,
                side: Side::Reflected,
            };
            let exact = grid.index_of(Side::Reflected, -light.wi + 2.0 * light.wi.z * DVec3::Z);
            for (slopes, expected) in [(plateau, [1, 1]), (grooves, [2, 1]), (tilted, [2, 2])] {
                let table = SlopeTable::of_slopes(&slopes).unwrap();
                let place = |wo: DVec3| Some(grid.index_of(Side::Reflected, wo));
                let images = SlopeImages::new(&table, light, place);
                let map = LambdaMap::new(&table, MapSize::COARSE);
                let bins: Vec<usize> = images.fluxes(&table, &map).map(|(bin, _)| bin).collect();
                let distinct = |of: &dyn Fn(usize) -> usize| {
                    let found: std::collections::HashSet<usize> =
                        bins.iter().map(|&bin| of(bin)).collect();
                    found.len()
                };
                let found = [distinct(&|bin| bin / 36), distinct(&|bin| bin % 36)];
                assert_eq!(found, expected, "{theta} {slopes:?}");
                assert!(expected == [2, 2] || bins.iter().all(|bin| bin % 36 == exact % 36));
            }
        }
    }
}
