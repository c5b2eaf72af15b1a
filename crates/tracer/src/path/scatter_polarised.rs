//! Scatter polarised light: what facets of the upper surface do with the light that has arrived, many at a time, by its
//! polarisation.
//!
//! Arrivals are taken in blocks of a few rows, which are copied to arrays, so that the compiler sees that nothing overlaps, and
//! makes vector instructions of plain code for one row.

use std::marker::PhantomData;
use std::ops::Range;

use asperity_optics::{
    FacetMueller, Material, PolarisedFresnel, incidence_axis, polarised_conductor,
    polarised_dielectric, reflect, refract,
};
use glam::DVec3;

use super::arrivals::Arrivals;
use super::scatter::ScatteredLight;
use crate::interaction::polarised::{CarriedLight, Passage, Passed};
use crate::vector::{Instructions, Stage};

/// Rows of a block.
const BLOCK: usize = 32;

/// Scatters all arrivals, whose paths carry `N` numbers of polarisation of kind `L`.
pub(super) struct ScatterPolarised<'a, F, L, const N: usize> {
    arrivals: &'a Arrivals<F>,
    /// Sign of the half space of the light.
    incident: f64,
    into: &'a mut ScatteredLight,
    light: PhantomData<L>,
}

impl<'a, F: Copy, L: CarriedLight<N>, const N: usize> ScatterPolarised<'a, F, L, N> {
    pub(super) fn new(
        arrivals: &'a Arrivals<F>,
        incident: f64,
        into: &'a mut ScatteredLight,
    ) -> Self {
        Self {
            arrivals,
            incident,
            into,
            light: PhantomData,
        }
    }

    /// Runs the stage for facets of a material.
    pub(super) fn run(self, material: Material, instructions: Instructions) {
        match material {
            Material::Dielectric { eta } => instructions.run(At {
                stage: self,
                facets: Dielectric {
                    etas: [eta, 1.0 / eta],
                },
            }),
            Material::Conductor { eta, kappa } => instructions.run(At {
                stage: self,
                facets: Conductor { eta, kappa },
            }),
            _ => instructions.run(At {
                stage: self,
                facets: Mirror,
            }),
        }
    }
}

/// What facets are made of.
trait Facets {
    /// Fresnel terms at a cosine of the angle of incidence, and the index of the other medium relative to that of the
    /// light.
    fn meet(&self, cos_theta_i: f64, is_entering: bool) -> (PolarisedFresnel, f64);
}

struct Dielectric {
    /// From the incident medium, and from the other.
    etas: [f64; 2],
}

impl Facets for Dielectric {
    #[inline(always)]
    fn meet(&self, cos_theta_i: f64, is_entering: bool) -> (PolarisedFresnel, f64) {
        let eta = if is_entering {
            self.etas[0]
        } else {
            self.etas[1]
        };
        (polarised_dielectric(cos_theta_i, eta), eta)
    }
}

struct Conductor {
    eta: f64,
    kappa: f64,
}

impl Facets for Conductor {
    #[inline(always)]
    fn meet(&self, cos_theta_i: f64, _: bool) -> (PolarisedFresnel, f64) {
        (polarised_conductor(cos_theta_i, self.eta, self.kappa), 1.0)
    }
}

struct Mirror;

impl Facets for Mirror {
    #[inline(always)]
    fn meet(&self, _: f64, _: bool) -> (PolarisedFresnel, f64) {
        let fresnel = PolarisedFresnel {
            reflected: FacetMueller::MIRROR,
            transmitted: FacetMueller::NONE,
            cos_theta_t: 0.0,
        };
        (fresnel, 1.0)
    }
}

/// One row: light that has arrived at a facet.
struct Row<const N: usize> {
    /// Direction, and the normal upwards.
    k: DVec3,
    normal: DVec3,
    /// Sign of the half space.
    side: f64,
    /// Of the tile against the world.
    handedness: f64,
    light: [f64; N],
}

/// What a facet reflects or transmits of a row.
struct Out<const N: usize> {
    direction: DVec3,
    passed: Passed<N>,
}

/// Some rows, field by field.
struct Rows<const N: usize> {
    k: [[f64; BLOCK]; 3],
    normal: [[f64; BLOCK]; 3],
    side: [f64; BLOCK],
    handedness: [f64; BLOCK],
    light: [[f64; BLOCK]; N],
}

/// What is reflected or transmitted of some rows.
struct Outs<const N: usize> {
    direction: [[f64; BLOCK]; 3],
    fraction: [f64; BLOCK],
    light: [[f64; BLOCK]; N],
}

/// The stage, for facets of one kind.
struct At<'a, F, L, M, const N: usize> {
    stage: ScatterPolarised<'a, F, L, N>,
    facets: M,
}

impl<F: Copy, L: CarriedLight<N>, M: Facets, const N: usize> Stage for At<'_, F, L, M, N> {
    #[inline(always)]
    fn run(self) {
        let ScatterPolarised {
            arrivals,
            incident,
            into,
            ..
        } = self.stage;
        let n = arrivals.len();
        into.resize(n);
        for light in &mut into.light {
            light.resize(N, Vec::new());
            light.iter_mut().for_each(|column| column.resize(n, 0.0));
        }
        let mut rows = Rows::<N>::EMPTY;
        let [mut reflected, mut transmitted] = [const { Outs::<N>::EMPTY }; 2];
        for first in (0..n).step_by(BLOCK) {
            let block = first..(first + BLOCK).min(n);
            rows.load(arrivals, incident, block.clone());
            for j in 0..BLOCK {
                let row = rows.row(j);
                let met = Met::new(&self.facets, &row, incident);
                reflected.set(j, met.reflected::<L, N>(&row));
                transmitted.set(j, met.transmitted::<L, N>(&row));
            }
            let [light, transmitted_light] = &mut into.light;
            reflected.store(&mut into.wo, &mut into.reflected, light, block.clone());
            transmitted.store(
                &mut into.wt,
                &mut into.transmitted,
                transmitted_light,
                block,
            );
        }
    }
}

/// A facet that a row has met.
struct Met {
    fresnel: PolarisedFresnel,
    /// Index of the other medium relative to that of the light.
    eta: f64,
    wi: DVec3,
    /// The normal on the side of the light.
    m: DVec3,
    /// Normal of the plane of incidence.
    axis: DVec3,
}

impl Met {
    #[inline(always)]
    fn new<M: Facets, const N: usize>(facets: &M, row: &Row<N>, incident: f64) -> Self {
        let wi = -row.k;
        let m = row.side * row.normal;
        let cos_theta_i = wi.dot(m);
        let cos_theta_i = if cos_theta_i > 0.0 { cos_theta_i } else { 0.0 };
        let cos_theta_i = if cos_theta_i < 1.0 { cos_theta_i } else { 1.0 };
        let (fresnel, eta) = facets.meet(cos_theta_i, row.side == incident);
        Self {
            fresnel,
            eta,
            wi,
            m,
            axis: incidence_axis(row.k, m),
        }
    }

    #[inline(always)]
    fn reflected<L: CarriedLight<N>, const N: usize>(&self, row: &Row<N>) -> Out<N> {
        self.leave::<L, N>(row, reflect(self.wi, self.m), self.fresnel.reflected)
    }

    #[inline(always)]
    fn transmitted<L: CarriedLight<N>, const N: usize>(&self, row: &Row<N>) -> Out<N> {
        let direction = refract(self.wi, self.m, self.eta, self.fresnel.cos_theta_t);
        self.leave::<L, N>(row, direction, self.fresnel.transmitted)
    }

    #[inline(always)]
    fn leave<L: CarriedLight<N>, const N: usize>(
        &self,
        row: &Row<N>,
        direction: DVec3,
        facet: FacetMueller,
    ) -> Out<N> {
        let passage = Passage::new([row.k, direction], self.axis, facet, row.handedness);
        Out {
            direction,
            passed: L::after(row.light, &passage),
        }
    }
}

impl<const N: usize> Rows<N> {
    const EMPTY: Self = Self {
        k: [[0.0; BLOCK]; 3],
        normal: [[0.0; BLOCK]; 3],
        side: [0.0; BLOCK],
        handedness: [0.0; BLOCK],
        light: [[0.0; BLOCK]; N],
    };

    /// Takes some arrivals; rows behind them keep what they hold.
    #[inline(always)]
    fn load<F>(&mut self, arrivals: &Arrivals<F>, incident: f64, block: Range<usize>) {
        let Arrivals { at, normal, .. } = arrivals;
        let len = block.len();
        let vectors = [(&mut self.k, &at.direction), (&mut self.normal, normal)];
        for (rows, columns) in vectors {
            for (row, column) in rows.iter_mut().zip(columns) {
                row[..len].copy_from_slice(&column[block.clone()]);
            }
        }
        self.side[..len].copy_from_slice(&at.side[block.clone()]);
        for (row, column) in self.light.iter_mut().zip(&at.light) {
            row[..len].copy_from_slice(&column[block.clone()]);
        }
        for (handedness, mirrored) in self.handedness.iter_mut().zip(&at.mirrored[block]) {
            // Images that are mirrored along both axes are turned, not mirrored.
            let is_mirrored = (mirrored ^ mirrored >> 1) & 1 == 1;
            *handedness = if is_mirrored { -incident } else { incident };
        }
    }

    #[inline(always)]
    fn row(&self, j: usize) -> Row<N> {
        let mut light = [0.0; N];
        for (number, column) in light.iter_mut().zip(&self.light) {
            *number = column[j];
        }
        Row {
            k: DVec3::new(self.k[0][j], self.k[1][j], self.k[2][j]),
            normal: DVec3::new(self.normal[0][j], self.normal[1][j], self.normal[2][j]),
            side: self.side[j],
            handedness: self.handedness[j],
            light,
        }
    }
}

impl<const N: usize> Outs<N> {
    const EMPTY: Self = Self {
        direction: [[0.0; BLOCK]; 3],
        fraction: [0.0; BLOCK],
        light: [[0.0; BLOCK]; N],
    };

    #[inline(always)]
    fn set(&mut self, j: usize, out: Out<N>) {
        let Out { direction, passed } = out;
        self.direction[0][j] = direction.x;
        self.direction[1][j] = direction.y;
        self.direction[2][j] = direction.z;
        self.fraction[j] = passed.fraction;
        for (column, number) in self.light.iter_mut().zip(passed.light) {
            column[j] = number;
        }
    }

    /// Writes the rows of a block to their columns.
    #[inline(always)]
    fn store(
        &self,
        direction: &mut [Vec<f64>; 3],
        fraction: &mut [f64],
        light: &mut [Vec<f64>],
        block: Range<usize>,
    ) {
        let len = block.len();
        for (column, row) in direction.iter_mut().zip(&self.direction) {
            column[block.clone()].copy_from_slice(&row[..len]);
        }
        fraction[block.clone()].copy_from_slice(&self.fraction[..len]);
        for (column, row) in light.iter_mut().zip(&self.light) {
            column[block.clone()].copy_from_slice(&row[..len]);
        }
    }
}
