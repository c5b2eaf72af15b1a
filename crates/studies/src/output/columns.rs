//! Columns that several tables share: bins of the hemispheres, materials, fluxes.

use asperity_optics::Incidence;
use asperity_simulate::{Case, CaseColumn, CaseGroup};
use asperity_tally::{BinFilter, Estimate, HemisphereGrid, Side};
use serde_json::Value;

use super::table::{Cell, Column};

/// A bin of a grid, by its number.
#[derive(Clone, Copy)]
pub(crate) struct GridBin {
    pub(crate) grid: HemisphereGrid,
    pub(crate) number: usize,
}

impl GridBin {
    fn side(self) -> Side {
        Side::BOTH[self.number / self.grid.bins_per_side()]
    }

    /// Edges in polar angle, exact in degrees.
    fn theta_deg(self) -> [f64; 2] {
        self.of_side(BinFilter::theta_deg)
    }

    /// Edges in azimuth, exact in degrees.
    fn phi_deg(self) -> [f64; 2] {
        self.of_side(BinFilter::phi_deg)
    }

    fn of_side(self, edges: fn(&BinFilter, usize) -> [f64; 2]) -> [f64; 2] {
        let filter = BinFilter::new(self.grid, self.side());
        edges(&filter, self.number % self.grid.bins_per_side())
    }
}

/// Columns that tell which bin of `grid` a row is about: its side and its edges.
pub(crate) fn bin_columns<'a, R: 'a>(
    grid: HemisphereGrid,
    bin: impl Fn(&R) -> usize + Copy + 'a,
) -> [Column<'a, R>; 5] {
    grid_bin_columns(move |row| GridBin {
        grid,
        number: bin(row),
    })
}

/// Variant for rows on bins of several grids.
pub(crate) fn grid_bin_columns<'a, R: 'a>(
    bin: impl Fn(&R) -> GridBin + Copy + 'a,
) -> [Column<'a, R>; 5] {
    let edge = |name, about, edge: fn(GridBin) -> f64| {
        Column::new(name, about, move |row: &R| edge(bin(row))).unit("deg")
    };
    let side = Column::new("side", "side on which light leaves", move |row: &R| {
        bin(row).side().to_string()
    });
    [
        side,
        edge("theta_min_deg", "lower polar angle of the bin", |bin| {
            bin.theta_deg()[0]
        }),
        edge("theta_max_deg", "upper polar angle of the bin", |bin| {
            bin.theta_deg()[1]
        }),
        edge("phi_min_deg", "lower azimuth of the bin", |bin| {
            bin.phi_deg()[0]
        }),
        edge("phi_max_deg", "upper azimuth of the bin", |bin| {
            bin.phi_deg()[1]
        }),
    ]
}

/// The columns `theta_o_deg` and `phi_o_deg`: the middle of a bin.
pub(crate) fn bin_centre_columns<'a, R: 'a>(
    bin: impl Fn(&R) -> GridBin + Copy + 'a,
) -> [Column<'a, R>; 2] {
    let centre = |name, about, range: fn(GridBin) -> [f64; 2]| {
        let middle = move |row: &R| {
            let [from, to] = range(bin(row));
            0.5 * (from + to)
        };
        Column::new(name, about, middle).unit("deg")
    };
    [
        centre(
            "theta_o_deg",
            "polar angle in the middle of the bin",
            GridBin::theta_deg,
        ),
        centre(
            "phi_o_deg",
            "azimuth in the middle of the bin",
            GridBin::phi_deg,
        ),
    ]
}

/// The column `solid_angle_sr` of bins of `grid`.
pub(crate) fn solid_angle_column<'a, R: 'a>(
    grid: HemisphereGrid,
    bin: impl Fn(&R) -> usize + 'a,
) -> Column<'a, R> {
    let solid_angle = move |row: &R| grid.bin(bin(row)).solid_angle;
    Column::new("solid_angle_sr", "solid angle of the bin", solid_angle).unit("sr")
}

/// Flux into a bin that makes a BSDF of one: solid angle times mean |cos theta|, steradians.
pub(crate) fn projected_solid_angle(grid: &HemisphereGrid, bin: usize) -> f64 {
    let bin = grid.bin(bin);
    bin.solid_angle * bin.mean_abs_cos()
}

/// An estimate over a number that has no error.
pub(crate) fn over(estimate: Estimate, divisor: f64) -> Estimate {
    Estimate {
        mean: estimate.mean / divisor,
        se: estimate.se.map(|se| se / divisor),
    }
}

/// The columns `theta_i_deg` and `phi_i_deg`.
pub(crate) fn incidence_columns<'a, R: 'a>(
    incidence: impl Fn(&R) -> Incidence + Copy + 'a,
) -> [Column<'a, R>; 2] {
    let column = |name, about, angle: fn(Incidence) -> f64| {
        Column::new(name, about, move |row: &R| angle(incidence(row))).unit("deg")
    };
    [
        column(
            "theta_i_deg",
            "polar angle of the light",
            Incidence::theta_deg,
        ),
        column("phi_i_deg", "azimuth of the light", Incidence::phi_deg),
    ]
}

/// The columns that describe cases by the quantities of `groups`.
pub(crate) fn case_columns<'a, R: 'a>(
    cases: &[Case],
    groups: &[CaseGroup],
    case: impl Fn(&R) -> &Case + Copy + 'a,
) -> Vec<Column<'a, R>> {
    let first = cases.first().map(Case::columns).unwrap_or_default();
    let shown = first.into_iter().enumerate();
    let shown = shown.filter(|(_, column)| groups.contains(&column.group));
    let column = move |(place, of): (usize, CaseColumn)| {
        let value = move |row: &R| match case(row).columns().swap_remove(place).value {
            Value::Null => Cell::Empty,
            Value::String(text) => Cell::Text(text.into()),
            value => value.as_f64().map_or(Cell::Empty, Cell::Number),
        };
        Column::new(of.name, of.about, value).unit(of.unit)
    };
    shown.map(column).collect()
}

/// A number of rays, as counted per incident ray times incident rays: whole but for rounding, unless the rays
/// of a ring were spread over its bins.
pub(crate) fn ray_count(count: f64) -> Cell {
    let whole = count.round();
    if (count - whole).abs() <= 1e-9 * whole {
        Cell::Count(whole as u64)
    } else {
        Cell::Number(count)
    }
}
