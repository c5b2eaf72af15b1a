//! Axes: the coordinates over which the cases of a measurement form a grid.

use std::collections::BTreeSet;

use asperity_results::coordinates;
use asperity_simulate::Case;
use serde_json::Value;

/// Coordinates of the direction of the light, which are always axes, the last ones.
const DIRECTION: [&str; 2] = ["theta_deg", "phi_deg"];

/// Coordinates that are axes before others, if they tell cases apart.
const PREFERRED: [&str; 2] = ["from", "wavelength_nm"];

/// A coordinate of all cases.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) about: String,
    /// Its values, in the order of the cases.
    pub(super) values: Vec<Value>,
    /// Number of its value, by case.
    indices: Vec<usize>,
}

/// The grid of cases.
#[derive(Clone, Debug)]
pub(super) struct Axes {
    /// Axes of the settings, then polar angle and azimuth of the light.
    pub(super) axes: Vec<Axis>,
    /// Coordinates that vary with the settings and are no axes.
    pub(super) others: Vec<Axis>,
    /// Coordinates that all cases share.
    pub(super) constants: Vec<Axis>,
    /// Number of the case at each point, the last axis fastest; `None` where no case was measured.
    pub(super) cases: Vec<Option<usize>>,
}

impl Axis {
    /// The coordinates of cases, in the order of their columns.
    fn all(cases: &[&Case]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for column in cases.iter().flat_map(|case| coordinates(case)) {
            let known = all.iter().position(|axis| axis.name == column.name);
            let number = known.unwrap_or_else(|| {
                all.push(Self {
                    name: column.name,
                    unit: column.unit,
                    about: column.about,
                    values: Vec::new(),
                    indices: Vec::new(),
                });
                all.len() - 1
            });
            let Self {
                values, indices, ..
            } = &mut all[number];
            let index = values.iter().position(|value| *value == column.value);
            indices.push(index.unwrap_or(values.len()));
            if index.is_none() {
                values.push(column.value);
            }
        }
        all.iter_mut().for_each(Self::sort);
        all
    }

    /// Puts numbers in ascending order, as readers expect of coordinates.
    fn sort(&mut self) {
        let numbers: Option<Vec<f64>> = self.values.iter().map(Value::as_f64).collect();
        let Some(numbers) = numbers else {
            return;
        };
        let mut order: Vec<usize> = (0..numbers.len()).collect();
        order.sort_by(|&a, &b| numbers[a].total_cmp(&numbers[b]));
        self.values = order.iter().map(|&i| self.values[i].clone()).collect();
        let mut index = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            index[old] = new;
        }
        self.indices.iter_mut().for_each(|old| *old = index[*old]);
    }

    /// Value of a case.
    pub(super) fn of(&self, case: usize) -> &Value {
        &self.values[self.indices[case]]
    }

    fn rank(&self) -> usize {
        let index = PREFERRED.iter().position(|name| *name == self.name);
        index.unwrap_or(PREFERRED.len())
    }
}

impl Axes {
    pub(super) fn of(cases: &[&Case]) -> Self {
        let is_direction = |axis: &Axis| DIRECTION.contains(&axis.name.as_str());
        let (direction, settings): (Vec<Axis>, Vec<Axis>) =
            Axis::all(cases).into_iter().partition(is_direction);
        let directions = tuples(&direction).len();
        let is_constant = |axis: &Axis| axis.values.len() == 1;
        let (mut constants, mut settings): (Vec<Axis>, Vec<Axis>) =
            settings.into_iter().partition(is_constant);
        constants.retain(|axis| !axis.values[0].is_null());
        settings.retain(|axis| {
            let mut with_axis = direction.clone();
            with_axis.push(axis.clone());
            // The patch about each direction tells nothing of settings
            let follows = tuples(&with_axis).len() == directions;
            !follows
        });
        settings.sort_by_key(Axis::rank);
        let wanted = tuples(&settings).len();
        let (mut axes, mut others): (Vec<Axis>, Vec<Axis>) = (Vec::new(), Vec::new());
        for axis in settings {
            let found = tuples(&axes).len();
            let count = axis.values.len();
            axes.push(axis);
            // A coordinate that follows from others is not an axis
            if found == wanted || tuples(&axes).len() != found * count {
                others.extend(axes.pop());
            }
        }
        if tuples(&axes).len() < wanted {
            others.splice(0..0, axes);
            axes = vec![numbered(&others)];
        }
        axes.extend(direction);
        let points = axes.iter().map(|axis| axis.values.len()).product();
        let mut grid = vec![None; points];
        for case in 0..cases.len() {
            let index = |index, axis: &Axis| index * axis.values.len() + axis.indices[case];
            grid[axes.iter().fold(0, index)] = Some(case);
        }
        Self {
            axes,
            others,
            constants,
            cases: grid,
        }
    }
}

/// Distinct tuples of the indices of the cases on `axes`; one, the empty one, without axes.
fn tuples(axes: &[Axis]) -> BTreeSet<Vec<usize>> {
    let cases = axes.first().map_or(1, |axis| axis.indices.len());
    let of_case = |case| axes.iter().map(|axis| axis.indices[case]).collect();
    (0..cases).map(of_case).collect()
}

/// Settings by number, where no product of coordinates has them all.
fn numbered(coordinates: &[Axis]) -> Axis {
    let all: Vec<Vec<usize>> = tuples(coordinates).into_iter().collect();
    let cases = coordinates[0].indices.len();
    let index = |case| {
        let of_case: Vec<usize> = coordinates.iter().map(|axis| axis.indices[case]).collect();
        all.partition_point(|tuple| *tuple < of_case)
    };
    Axis {
        name: "setting".to_owned(),
        unit: String::new(),
        about: "number of the setting".to_owned(),
        values: (1..=all.len()).map(Value::from).collect(),
        indices: (0..cases).map(index).collect(),
    }
}
