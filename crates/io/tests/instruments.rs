//! Files that instruments wrote: shape, spacing, unit, spread and single heights, as independent readers give them
//! (`benches/readers`). The files are no part of the project: where they are missing, the tests say so and pass.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "the helpers of tests are tests too"
)]

use std::path::Path;

use asperity_io::read_height_map;
use asperity_surface::{Border, LengthUnit, MissingPolicy};

/// Values that SurfaceTopography 1.27.1 reads.
struct Reference {
    file: &'static str,
    shape: [usize; 2],
    spacing: [f64; 2],
    unit: LengthUnit,
    missing: usize,
    /// Root mean square about the mean, without missing points.
    sq: f64,
    /// Row, column, height: the four corners, and one inside.
    heights: [(usize, usize, f64); 5],
}

/// Single precision of the numbers in headers.
const TOLERANCE: f64 = 1e-7;

impl Reference {
    fn check(&self) {
        let folder = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../../shared/data/instruments"
        );
        let path = Path::new(folder).join(self.file);
        if !path.exists() {
            println!(
                "skipped: ../shared/data/instruments/{} is not here",
                self.file
            );
            return;
        }
        let map = read_height_map(&path).unwrap();
        println!("{}: {:?}", self.file, map.notes);
        assert_eq!(
            (map.shape(), map.unit, map.missing()),
            (self.shape, self.unit, self.missing)
        );
        let close = |a: f64, b: f64| (a - b).abs() <= TOLERANCE * b.abs();
        let field = map
            .into_height_field(MissingPolicy::Fill, Border::Open)
            .unwrap();
        let heights = field.heights();
        let n = heights.len() as f64;
        let mean = heights.iter().sum::<f64>() / n;
        let sq = (heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / n).sqrt();
        // Gaps are next to outliers of tens of Sq: 117 of 272492 points, filled at 9 Sq, add 1.7 % to Sq
        let tolerance = if self.missing > 0 { 2e-2 } else { 1e-5 };
        let off = (sq - self.sq).abs();
        assert!(off <= tolerance * self.sq, "Sq {sq:e}, not {:e}", self.sq);
        for (found, expected) in field.spacing().into_iter().zip(self.spacing) {
            assert!(
                close(found, expected),
                "spacing {found:e}, not {expected:e}"
            );
        }
        for (row, column, expected) in self.heights {
            let height = field.height(column, row);
            let is_missing = expected.is_nan();
            assert!(
                is_missing || close(height, expected),
                "row {row}, column {column}: {height:e}, not {expected:e}"
            );
        }
    }
}

#[test]
fn alicona_is_read() {
    Reference {
        file: "al3d-1.al3d",
        shape: [296, 200],
        spacing: [4.38027e-7; 2],
        unit: LengthUnit::Metre,
        missing: 0,
        sq: 7.688265843362921e-6,
        heights: [
            (0, 0, 0.07635815441608429),
            (0, 199, 0.07634570449590683),
            (295, 0, 0.07633679360151291),
            (295, 199, 0.07632320374250412),
            (98, 50, 0.07634830474853516),
        ],
    }
    .check();
}

#[test]
fn bcrf_is_read() {
    Reference {
        file: "bcrf-1.bcrf",
        shape: [600, 960],
        spacing: [1851.4625, 1851.4633333333334],
        unit: LengthUnit::Nanometre,
        missing: 0,
        sq: 24.560210667743558,
        heights: [
            (0, 0, 50628.37219238281),
            (0, 959, 50625.797271728516),
            (599, 0, 50628.50570678711),
            (599, 959, 50590.69061279297),
            (200, 240, 50639.095306396484),
        ],
    }
    .check();
}

#[test]
fn nanoscope_is_read() {
    Reference {
        file: "di-1.di",
        shape: [512, 512],
        spacing: [0.9765625; 2],
        unit: LengthUnit::Nanometre,
        missing: 0,
        sq: 9.945986800560389,
        heights: [
            (0, 0, 6.059980111183001),
            (0, 511, -9.740178655504911),
            (511, 0, 2.843159166937812),
            (511, 511, -30.306374893640626),
            (170, 128, 3.8633298114181005),
        ],
    }
    .check();
}

#[test]
fn metropro_is_read() {
    Reference {
        file: "metropro-1.dat",
        shape: [480, 640],
        spacing: [1.0982520279867458e-6; 2],
        unit: LengthUnit::Metre,
        missing: 0,
        sq: 7.52882220473459e-8,
        heights: [
            (0, 0, 5.05753145602552e-5),
            (0, 639, 5.08308995810728e-5),
            (479, 0, 5.056755638157932e-5),
            (479, 639, 5.085188667204241e-5),
            (160, 160, 5.067864967331359e-5),
        ],
    }
    .check();
}

#[test]
fn wyko_is_read() {
    Reference {
        file: "opd-1.opd",
        shape: [480, 640],
        spacing: [0.00019673303177114576; 2],
        unit: LengthUnit::Millimetre,
        missing: 116,
        sq: 8.356451162720973e-6,
        heights: [
            (0, 0, -0.00026550621614908413),
            (0, 639, -0.00025646328900066873),
            (479, 0, -0.00028399285465906726),
            (479, 639, -0.00027377381208626504),
            (160, 160, -0.0002721409626628847),
        ],
    }
    .check();
}

#[test]
fn sensofar_is_read() {
    Reference {
        file: "plu-1.plu",
        shape: [576, 768],
        spacing: [1.6600000858306885; 2],
        unit: LengthUnit::Micrometre,
        missing: 0,
        sq: 2.8343909876348845,
        heights: [
            (0, 0, -111.2265625),
            (0, 767, -101.44921875),
            (575, 0, -111.06640625),
            (575, 767, -101.21484375),
            (192, 192, -108.7265625),
        ],
    }
    .check();
}

#[test]
fn sdf_is_read() {
    Reference {
        file: "sdf-1.sdf",
        shape: [4, 7],
        spacing: [1e-6; 2],
        unit: LengthUnit::Metre,
        missing: 0,
        sq: 0.013602897289488262e-6,
        heights: [
            (0, 0, 1e-6),
            (0, 6, 1e-6),
            (3, 0, 0.97986e-6),
            (3, 6, 0.97986e-6),
            (1, 1, 0.99748e-6),
        ],
    }
    .check();
}

#[test]
fn digital_surf_is_read() {
    Reference {
        file: "sur-2.sur",
        shape: [484, 563],
        spacing: [0.0034840002190321684; 2],
        unit: LengthUnit::Millimetre,
        missing: 117,
        sq: 1.7517881243588178e-5,
        heights: [
            (0, 0, 0.01014770011858701),
            (0, 562, 0.01011390011819202),
            (483, 0, 0.010127500118350952),
            (483, 562, f64::NAN),
            (161, 140, 0.01017730011893292),
        ],
    }
    .check();
}
