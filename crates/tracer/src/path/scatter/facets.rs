//! Facets: reflect and transmit light, many at a time, by [`crate::interaction::facet::scatter`].
//!
//! Arrivals are taken in blocks of a few rows, which are copied to arrays, so that the compiler sees that nothing overlaps, and
//! makes vector instructions of plain code for one row.

use std::marker::PhantomData;
use std::ops::Range;

use asperity_optics::Material;
use glam::DVec3;

use crate::interaction::facet::{Incident, Outgoing, scatter};
use crate::interaction::polarised::{
    AveragedLight, BothLight, CarriedLight, MuellerLight, TrackedLight,
};
use crate::path::state::scattered::{Branches, ScatteredLight};
use crate::path::state::segments::Segments;
use crate::settings::Polarisation;
use crate::vector::{Instructions, Stage};

/// Rows of a block.
const BLOCK: usize = 32;

/// Scatters all light that has arrived at an interface.
pub(crate) struct Scatter<'a> {
    pub(crate) at: &'a Segments,
    /// Unit normals, upwards.
    pub(crate) normal: &'a [Vec<f64>; 3],
    pub(crate) material: Material,
    /// Sign of the half space to whose medium the indices of the material are relative.
    pub(crate) outer: f64,
    /// Sign of the half space of the incident light, in which +z of its polarisation points.
    pub(crate) incident: f64,
    /// Random numbers of each arrival at diffuse facets; empty at others.
    pub(crate) numbers: &'a [[f64; 2]],
    pub(crate) into: &'a mut ScatteredLight,
}

impl<'a> Scatter<'a> {
    /// Runs the stage for the polarisation that the paths carry.
    pub(crate) fn run(self, instructions: Instructions) {
        match self.at.kept.polarisation {
            Polarisation::Averaged => instructions.run(self.of_light::<AveragedLight, 0>()),
            Polarisation::Tracked => instructions.run(self.of_light::<TrackedLight, 3>()),
            Polarisation::Both => instructions.run(self.of_light::<BothLight, 4>()),
            Polarisation::Mueller => instructions.run(self.of_light::<MuellerLight, 15>()),
        }
    }

    const fn of_light<L, const N: usize>(self) -> ScatterLight<'a, L, N> {
        ScatterLight {
            stage: self,
            light: PhantomData,
        }
    }
}

/// The stage for light of kind `L`, whose paths carry `N` numbers of polarisation.
struct ScatterLight<'a, L, const N: usize> {
    stage: Scatter<'a>,
    light: PhantomData<L>,
}

impl<L: CarriedLight<N>, const N: usize> Stage for ScatterLight<'_, L, N> {
    #[inline(always)]
    fn run(self) {
        // A loop for each kind of material
        match self.stage.material {
            Material::Dielectric { eta } => self.scatter(Material::Dielectric { eta }),
            Material::Conductor { eta, kappa } => self.scatter(Material::Conductor { eta, kappa }),
            Material::Lambertian { reflectance } => {
                self.scatter(Material::Lambertian { reflectance });
            }
            Material::Coated { films, eta, kappa } => {
                self.scatter(Material::Coated { films, eta, kappa });
            }
            _ => self.scatter(Material::Mirror),
        }
    }
}

impl<L: CarriedLight<N>, const N: usize> ScatterLight<'_, L, N> {
    #[inline(always)]
    fn scatter(self, material: Material) {
        let stage = self.stage;
        let ScatteredLight {
            transmitted,
            reflected,
        } = &mut *stage.into;
        let n = stage.at.len;
        transmitted.resize(n, N);
        reflected.resize(n, N);
        let mut rows = Rows::<N>::EMPTY;
        let [mut transmitted_rows, mut reflected_rows] = [const { OutgoingRows::<N>::EMPTY }; 2];
        for first in (0..n).step_by(BLOCK) {
            let block = first..(first + BLOCK).min(n);
            rows.load(
                stage.at,
                stage.normal,
                stage.numbers,
                stage.incident,
                block.clone(),
            );
            for j in 0..BLOCK {
                let scattered = scatter::<L, N>(material, &rows.row(j, stage.outer));
                transmitted_rows.set(j, scattered.transmitted);
                reflected_rows.set(j, scattered.reflected);
            }
            transmitted_rows.store(transmitted, block.clone());
            reflected_rows.store(reflected, block);
        }
    }
}

/// Some arrivals, field by field.
struct Rows<const N: usize> {
    k: [[f64; BLOCK]; 3],
    normal: [[f64; BLOCK]; 3],
    side: [f64; BLOCK],
    handedness: [f64; BLOCK],
    numbers: [[f64; 2]; BLOCK],
    light: [[f64; BLOCK]; N],
}

impl<const N: usize> Rows<N> {
    const EMPTY: Self = Self {
        k: [[0.0; BLOCK]; 3],
        normal: [[0.0; BLOCK]; 3],
        side: [0.0; BLOCK],
        handedness: [0.0; BLOCK],
        numbers: [[0.0; 2]; BLOCK],
        light: [[0.0; BLOCK]; N],
    };

    /// Takes some arrivals; rows behind them keep what they hold.
    #[inline(always)]
    fn load(
        &mut self,
        at: &Segments,
        normal: &[Vec<f64>; 3],
        numbers: &[[f64; 2]],
        incident: f64,
        block: Range<usize>,
    ) {
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
        if let Some(numbers) = numbers.get(block.clone()) {
            self.numbers[..len].copy_from_slice(numbers);
        }
        for (row, mirrored) in self.handedness.iter_mut().zip(&at.mirrored[block]) {
            *row = handedness(*mirrored, incident);
        }
    }

    #[inline(always)]
    fn row(&self, j: usize, outer: f64) -> Incident<N> {
        let mut light = [0.0; N];
        for (number, column) in light.iter_mut().zip(&self.light) {
            *number = column[j];
        }
        let normal = DVec3::new(self.normal[0][j], self.normal[1][j], self.normal[2][j]);
        Incident {
            k: DVec3::new(self.k[0][j], self.k[1][j], self.k[2][j]),
            m: self.side[j] * normal,
            is_entering: self.side[j] == outer,
            handedness: self.handedness[j],
            numbers: self.numbers[j],
            light,
        }
    }
}

/// Handedness of directions of which some axes are mirrored, for light through a half space of the sign `incident`.
#[inline(always)]
pub(super) fn handedness(mirrored: u32, incident: f64) -> f64 {
    // Images that are mirrored along both axes are turned, not mirrored.
    let is_mirrored = (mirrored ^ mirrored >> 1) & 1 == 1;
    if is_mirrored { -incident } else { incident }
}

/// Transmitted or reflected light of some arrivals, field by field.
struct OutgoingRows<const N: usize> {
    direction: [[f64; BLOCK]; 3],
    fraction: [f64; BLOCK],
    light: [[f64; BLOCK]; N],
}

impl<const N: usize> OutgoingRows<N> {
    const EMPTY: Self = Self {
        direction: [[0.0; BLOCK]; 3],
        fraction: [0.0; BLOCK],
        light: [[0.0; BLOCK]; N],
    };

    #[inline(always)]
    fn set(&mut self, j: usize, out: Outgoing<N>) {
        let Outgoing { direction, passed } = out;
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
    fn store(&self, into: &mut Branches, block: Range<usize>) {
        let len = block.len();
        for (column, row) in into.direction.iter_mut().zip(&self.direction) {
            column[block.clone()].copy_from_slice(&row[..len]);
        }
        into.flux[block.clone()].copy_from_slice(&self.fraction[..len]);
        for (column, row) in into.light.iter_mut().zip(&self.light) {
            column[block.clone()].copy_from_slice(&row[..len]);
        }
    }
}
