//! Lobes: cosine-weighted BSDF by bin, of rays and of models, in the form that `lobe.js` reads.
//!
//! A value `v` of an array whose largest one is `max` is stored in 16 bits as `q = -2048 log2(v / max)`, little-endian, in base64: a relative
//! error of at most 1.7e-4 over nine decades. What is smaller, zero or negative has `q = 65535`, which is zero.

use std::collections::BTreeMap;

use asperity_studies::model_colour;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::cases::Case;
use crate::error::PageError;
use crate::folder::Folder;
use crate::rows::Rows;

/// Steps per factor of two.
const STEPS: f64 = 2048.0;
/// The code of zero.
const ZERO: u16 = u16::MAX;
/// Largest length of all lobes of a page, in characters.
const MAX_LOBES: usize = 190_000;

/// The lobes of one case.
#[derive(Clone, Serialize)]
pub(crate) struct Lobes {
    /// Number of the case.
    case: usize,
    sides: Vec<Lobe>,
}

/// Light on one side, by bin `[theta, phi]`.
#[derive(Clone, Serialize)]
struct Lobe {
    side: String,
    /// Edges of bins, from +z, in degrees.
    theta: Vec<f64>,
    phi: Vec<f64>,
    /// Rays: all light, its standard error, and components.
    rays: Vec<Array>,
    models: Vec<Array>,
}

/// Values in 1/sr.
#[derive(Clone, Serialize)]
struct Array {
    name: String,
    /// Colour of a model in figures; `None` for rays.
    #[serde(skip_serializing_if = "Option::is_none")]
    colour: Option<String>,
    max: f64,
    codes: String,
}

impl Array {
    fn of(name: impl Into<String>, values: &[f64]) -> Self {
        let max = values.iter().copied().fold(0.0, f64::max);
        let codes = values.iter().flat_map(|value| {
            let code = -STEPS * (value / max).log2();
            // Negative values and zeros have no logarithm.
            let code = match code.is_finite() && code < f64::from(ZERO) {
                true => code.round() as u16,
                false => ZERO,
            };
            code.to_le_bytes()
        });
        Self {
            name: name.into(),
            colour: None,
            max,
            codes: STANDARD.encode(codes.collect::<Vec<u8>>()),
        }
    }

    /// Array of a model, with its colour in figures.
    fn of_model(self) -> Self {
        let name = self.name.split(',').next().unwrap_or_default();
        Self {
            colour: Some(model_colour(name)),
            ..self
        }
    }
}

/// Lobes of the cases of a folder.
pub(crate) struct FoundLobes {
    pub(crate) lobes: Vec<Lobes>,
    /// `false` if some directions are left out for their size.
    pub(crate) is_whole: bool,
}

/// Reads the lobes of `cases`, which are numbered from `first`. Where all would be too long for a page of `share` folders, first the
/// components go, then bins are joined four by four, then every second, fourth, ... direction of each setting.
pub(crate) fn lobes(
    folder: &Folder,
    cases: &[Case],
    first: usize,
    share: usize,
) -> Result<FoundLobes, PageError> {
    let room = MAX_LOBES / share;
    for detail in [Detail::All, Detail::Sum, Detail::Coarse] {
        let mut found = Vec::new();
        let mut length = 0;
        for (number, case) in cases.iter().enumerate() {
            let one = of_case(folder, case, first + number, detail)?;
            length += one.as_ref().map_or(0, Lobes::length);
            found.extend(one);
            if length > room && detail != Detail::Coarse {
                break;
            }
        }
        if length <= room {
            return Ok(FoundLobes {
                lobes: found,
                is_whole: true,
            });
        }
        if detail == Detail::Coarse {
            let step = length.div_ceil(room.max(1)).next_power_of_two();
            found.retain(|one| place_in_group(cases, one.case - first).is_multiple_of(step));
            return Ok(FoundLobes {
                lobes: found,
                is_whole: false,
            });
        }
    }
    Ok(FoundLobes {
        lobes: Vec::new(),
        is_whole: false,
    })
}

/// Detail of lobes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Detail {
    /// All light with errors, its components and models.
    All,
    /// All light with errors, and models.
    Sum,
    /// All light with errors, and models, in bins of two by two.
    Coarse,
}

/// Number of the cases of the same setting before this one.
fn place_in_group(cases: &[Case], number: usize) -> usize {
    let before = &cases[..number];
    before
        .iter()
        .filter(|case| case.group == cases[number].group)
        .count()
}

impl Lobes {
    /// Length on the page, in characters.
    fn length(&self) -> usize {
        let arrays = |lobe: &Lobe| {
            let arrays = lobe.rays.iter().chain(&lobe.models);
            arrays.map(|array| array.codes.len()).sum::<usize>()
        };
        self.sides.iter().map(arrays).sum()
    }
}

fn of_case(
    folder: &Folder,
    case: &Case,
    number: usize,
    detail: Detail,
) -> Result<Option<Lobes>, PageError> {
    let Some(bins) = folder.rows(&case.bins)? else {
        return Ok(None);
    };
    let models = folder.rows(&format!("{}comparison.csv", case.folder))?;
    // Both tables have the same bins in the same order.
    let models = models.filter(|models| models.len() == bins.len());
    let sides = sides(&bins, models.as_ref(), detail);
    Ok(sides.map(|sides| Lobes {
        case: number,
        sides,
    }))
}

/// The light of each side of a table; `None` if it is no table of bins.
fn sides(bins: &Rows, models: Option<&Rows>, detail: Detail) -> Option<Vec<Lobe>> {
    let side = bins.texts("side")?;
    let solid_angle = bins.numbers("solid_angle_sr")?;
    let edges = |axis: &str| {
        let [low, high] = ["min", "max"].map(|end| bins.numbers(&format!("{axis}_{end}_deg")));
        Some([low?, high?])
    };
    let [theta, phi] = [edges("theta")?, edges("phi")?];
    let mut rows: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (row, side) in side.iter().enumerate() {
        rows.entry(side).or_default().push(row);
    }
    let mut columns = of_rays(bins);
    if detail != Detail::All {
        columns.truncate(2);
    }
    let of_models = models.map(of_models).unwrap_or_default();
    let lobe = |(side, rows): (&str, Vec<usize>)| {
        let [theta, phi] = [&theta, &phi].map(|edges| distinct(edges, &rows));
        let width = if detail == Detail::Coarse { 2 } else { 1 };
        let grid = Grid {
            sectors: phi.len() - 1,
            width,
        };
        let solid_angle: Vec<f64> = rows.iter().map(|&row| solid_angle[row]).collect();
        let solid_angle = grid.sums(&solid_angle);
        let array = |(name, flux): &(String, Vec<f64>)| {
            let flux: Vec<f64> = rows.iter().map(|&row| flux[row]).collect();
            // Errors of bins that are joined are taken as independent.
            let flux = match name.as_str() {
                "se" => {
                    let squares: Vec<f64> = flux.iter().map(|se| se * se).collect();
                    grid.sums(&squares).iter().map(|sum| sum.sqrt()).collect()
                }
                _ => grid.sums(&flux),
            };
            let values = flux
                .iter()
                .zip(&solid_angle)
                .map(|(flux, angle)| flux / angle);
            Array::of(name, &values.collect::<Vec<f64>>())
        };
        Lobe {
            side: side.to_owned(),
            rays: columns.iter().map(array).collect(),
            models: of_models.iter().map(array).map(Array::of_model).collect(),
            theta: grid.edges(theta),
            phi: grid.edges(phi),
        }
    };
    Some(rows.into_iter().map(lobe).collect())
}

/// Bins `[rings][sectors]` of one side, of which `width` by `width` are joined.
struct Grid {
    sectors: usize,
    width: usize,
}

impl Grid {
    /// Sums over bins that are joined.
    fn sums(&self, values: &[f64]) -> Vec<f64> {
        let joined = self.sectors.div_ceil(self.width);
        let rings = values.len().div_ceil(self.sectors).div_ceil(self.width);
        let mut sums = vec![0.0; rings * joined];
        for (i, value) in values.iter().enumerate() {
            let [ring, sector] =
                [i / self.sectors, i % self.sectors].map(|place| place / self.width);
            sums[ring * joined + sector] += value;
        }
        sums
    }

    /// Edges of bins that are joined.
    fn edges(&self, mut edges: Vec<f64>) -> Vec<f64> {
        let last = edges.len() - 1;
        let mut place = 0..;
        edges.retain(|_| {
            let place = place.next().unwrap_or(0);
            place % self.width == 0 || place == last
        });
        edges
    }
}

/// Edges of the bins of `rows` along one axis, ascending.
fn distinct(edges: &[Vec<f64>; 2], rows: &[usize]) -> Vec<f64> {
    let of_rows = edges
        .iter()
        .flat_map(|ends| rows.iter().map(|&row| ends[row]));
    let mut found: Vec<f64> = of_rows.map(|edge| (edge * 1e6).round() / 1e6).collect();
    found.sort_by(f64::total_cmp);
    found.dedup();
    found
}

/// Fluxes of all light, with errors, and of its components.
fn of_rays(bins: &Rows) -> Vec<(String, Vec<f64>)> {
    let names: Vec<&str> = bins.names().collect();
    let has_error = |name: &str| names.contains(&format!("{name}_se").as_str());
    let components = names.iter().copied().filter(|name| has_error(name));
    let components = components.filter_map(|name| Some((name.strip_prefix("flux_")?, name)));
    let all = [("all", "flux"), ("se", "flux_se")].into_iter();
    all.chain(components)
        .filter_map(|(name, column)| Some((name.to_owned(), bins.numbers(column)?)))
        .collect()
}

/// Fluxes of models: of all light, or of that which is scattered once.
fn of_models(rows: &Rows) -> Vec<(String, Vec<f64>)> {
    let is_model = |name: &&str| {
        let column = |prefix: &str| format!("{prefix}{name}");
        let names: Vec<&str> = rows.names().collect();
        names.contains(&column("z_").as_str()) && names.contains(&column("flux_").as_str())
    };
    let names = rows.names().filter_map(|name| name.strip_prefix("flux_"));
    let of_part = |name: &&str| !name.starts_with("total_") && !name.starts_with("multiple_");
    let models = names.filter(of_part).filter(is_model);
    models
        .filter_map(|name| {
            let words = name.replace('_', "-");
            match rows.numbers(&format!("flux_total_{name}")) {
                Some(all) => Some((words, all)),
                None => Some((
                    format!("{words}, scattered once"),
                    rows.numbers(&format!("flux_{name}"))?,
                )),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(array: &Array) -> Vec<f64> {
        let bytes = STANDARD.decode(&array.codes).unwrap();
        let codes = bytes.chunks(2).map(|b| u16::from_le_bytes([b[0], b[1]]));
        let value = |code| match code {
            ZERO => 0.0,
            code => array.max * 2_f64.powf(-f64::from(code) / STEPS),
        };
        codes.map(value).collect()
    }

    #[test]
    fn codes_keep_four_digits_over_nine_decades() {
        let values = [3.0, 2.0, 1e-3, 4.2e-9, 1e-12, 0.0, -0.5];
        let found = decoded(&Array::of("all", &values));
        for (value, found) in values.iter().zip(&found).take(4) {
            assert!((found / value - 1.0).abs() < 1.8e-4, "{found} of {value}");
        }
        assert_eq!(&found[4..], [0.0; 3]);
        assert_eq!(decoded(&Array::of("dark", &[0.0, 0.0])), [0.0, 0.0]);
    }

    #[test]
    fn lobes_are_flux_over_solid_angle_by_side() {
        let bins = "side,theta_min_deg,theta_max_deg,phi_min_deg,phi_max_deg,solid_angle_sr,flux,flux_se,flux_single,flux_single_se\n\
            reflected,0,90,0,180,2,1,0.1,0.5,0\nreflected,0,90,180,360,2,3,0.1,1,0\ntransmitted,90,180,0,360,4,2,0.2,2,0\n";
        let models = "side,flux_single,flux_single_se,flux_smith,z_smith,flux_total_heitz,flux_heitz,z_heitz\n\
            reflected,1,0,4,0,2,1,0\nreflected,1,0,4,0,2,1,0\ntransmitted,1,0,4,0,2,1,0\n";
        let bins = Rows::read(bins).unwrap();
        let models = Rows::read(models).unwrap();
        let found = sides(&bins, Some(&models), Detail::All).unwrap();
        let names: Vec<&str> = found.iter().map(|lobe| lobe.side.as_str()).collect();
        assert_eq!(names, ["reflected", "transmitted"]);
        assert_eq!(found[0].theta, [0.0, 90.0]);
        assert_eq!(found[0].phi, [0.0, 180.0, 360.0]);
        let near = |array: &Array, expected: &[f64]| {
            let found = decoded(array);
            let close = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() < 2e-4;
            found.iter().zip(expected).all(close)
        };
        assert!(near(&found[0].rays[0], &[0.5, 1.5]));
        let rays: Vec<&str> = found[0]
            .rays
            .iter()
            .map(|array| array.name.as_str())
            .collect();
        assert_eq!(rays, ["all", "se", "single"]);
        let of: Vec<&str> = found[0]
            .models
            .iter()
            .map(|model| model.name.as_str())
            .collect();
        assert_eq!(of, ["smith, scattered once", "heitz"]);
        assert!(near(&found[1].models[1], &[0.5]));
        let coarse = sides(&bins, Some(&models), Detail::Coarse).unwrap();
        assert_eq!(coarse[0].phi, [0.0, 360.0]);
        assert!(near(&coarse[0].rays[0], &[1.0]));
        assert!(near(&coarse[0].rays[1], &[0.02_f64.sqrt() / 4.0]));
        assert_eq!(coarse[0].rays.len(), 2);
    }
}
