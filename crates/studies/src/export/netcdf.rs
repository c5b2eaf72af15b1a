//! NetCDF: BSDF and fluxes over labelled axes, with standard errors as ancillary variables.
//!
//! Bins of directions of light may differ, since they refine about narrow lobes: those of the file are common to all, and where
//! they differ the exact ones stand beside them, by number of ring and sector, with their edges.

use asperity_io::{NetCdf, NetCdfValues, NetCdfVariable};
use asperity_simulate::{Case, Outcome};
use asperity_tally::{
    Component, Estimate, HemisphereGrid, Measure, Polarimetry, Side, TallyResult,
};
use asperity_tracer::HalfSpace;
use serde_json::Value;

use super::axes::{Axes, Axis};
use super::contents::{Agreement, Contents};
use super::measurement::Measurement;
use super::ranges::{
    Range, bin_light, edges_from_normal, regular, regular_light, ring_from_normal,
};

/// What angles and sides mean.
const CONVENTIONS: &str = "theta_i, phi_i: direction towards the light, from the normal of the lit side, and azimuth. side: on which light leaves, reflected on that of the light. theta_o: from the normal of that side; phi_o: azimuth of the direction in which light leaves. bsdf: mean over the bin. Light is unpolarised unless the configuration says otherwise";

pub(super) fn contents(measurement: &Measurement) -> Result<Contents, String> {
    let axes = measurement.axes();
    let file = File::of(measurement, &axes);
    let counts = file.counts;
    let mut notes = Vec::new();
    if !file.is_common {
        notes.push(format!(
            "bins differ between directions: bsdf is over common bins of {} by {} degrees, bsdf_exact over those of each, with edges; --bins gives all the same",
            90 / counts[0],
            360 / counts[1]
        ));
    }
    notes.push(
        "not in the file: absorbed light, orders of scattering, Mueller matrices, covariances"
            .to_owned(),
    );
    let agreement = measurement.cases.iter().flat_map(|case| {
        let outcome = &case.outcome;
        let sides = Side::BOTH.into_iter();
        let sides = sides.filter(|&side| outcome.statistics.spec().records(side));
        let lights = sides.map(|side| {
            let light = regular_light(counts, outcome, side).into_iter().flatten();
            let measured = outcome.statistics.flux(side, Component::All);
            Agreement::of(
                &outcome.case,
                side,
                measured,
                light.map(|one| one.mean).sum(),
            )
        });
        lights.collect::<Vec<Agreement>>()
    });
    Ok(Contents {
        agreement: agreement.collect(),
        notes,
        bytes: file
            .finish(measurement)
            .bytes()
            .map_err(|reason| format!("cannot be made: {reason}"))?,
    })
}

/// All that the file has, with fluxes by order of scattering and Mueller matrices, where these were recorded.
pub(super) fn labelled(measurement: &Measurement) -> NetCdf {
    let axes = measurement.axes();
    let mut file = File::of(measurement, &axes);
    file.add_orders();
    file.add_mueller();
    file.finish(measurement)
}

fn over(light: Estimate, divisor: f64) -> Estimate {
    Estimate {
        mean: light.mean / divisor,
        se: light.se.map(|se| se / divisor),
    }
}

/// The file as it grows.
struct File<'a> {
    content: NetCdf,
    /// Names of the axes of cases.
    axes: Vec<String>,
    /// Names of other coordinates, with blanks between.
    coordinates: String,
    /// Outcomes on the grid of the axes.
    outcomes: Vec<Option<&'a Outcome>>,
    /// `true` if all have the same bins of equal angles.
    is_common: bool,
    /// Rings and sectors of the common bins.
    counts: [usize; 2],
}

impl<'a> File<'a> {
    /// Coordinates, BSDF and fluxes of a measurement, over its `axes`.
    fn of(measurement: &'a Measurement, axes: &Axes) -> Self {
        let cases = &measurement.cases;
        let grid_of = |outcome: &Outcome| outcome.statistics.spec().grid();
        let first = grid_of(&cases[0].outcome);
        let is_common =
            first.has_equal_angles() && cases.iter().all(|case| grid_of(&case.outcome) == first);
        let common = if is_common {
            first
        } else {
            HemisphereGrid::default()
        };
        let counts = [common.n_theta(), common.n_phi()];
        let others = axes.others.iter().chain(&axes.constants).map(name_of);
        let outcome = |number: &Option<usize>| Some(&cases[(*number)?].outcome);
        let mut file = Self {
            content: NetCdf::default(),
            axes: axes.axes.iter().map(name_of).collect(),
            coordinates: others.collect::<Vec<String>>().join(" "),
            outcomes: axes.cases.iter().map(outcome).collect(),
            is_common,
            counts,
        };
        file.add_coordinates(axes);
        file.add_bins(counts);

        let ranges: Vec<Range> = regular(counts).collect();
        let bsdf = |outcome: &Outcome, side: Side| {
            let light = regular_light(counts, outcome, side).into_iter();
            let values = light.zip(&ranges);
            let values =
                values.map(|(light, range)| Some(over(light?, range.projected_solid_angle())));
            values.collect()
        };
        file.add_estimates(
            "bsdf",
            "sr-1",
            "BSDF",
            &["side", "theta_o", "phi_o"],
            ranges.len(),
            bsdf,
        );
        let flux = |outcome: &Outcome, side: Side| {
            let statistics = &outcome.statistics;
            let flux = statistics.flux(side, Component::All);
            vec![statistics.spec().records(side).then_some(flux)]
        };
        file.add_estimates(
            "flux",
            "1",
            "fraction of the incident flux",
            &["side"],
            1,
            flux,
        );
        if !is_common {
            file.add_exact_bins();
        }
        file
    }

    fn add_dimension(&mut self, name: &str, length: usize) {
        self.content.dimensions.push((name.to_owned(), length));
    }

    fn add(
        &mut self,
        name: &str,
        dimensions: &[&str],
        values: NetCdfValues,
        attributes: Vec<(&'static str, String)>,
    ) {
        self.content.variables.push(NetCdfVariable {
            name: name.to_owned(),
            dimensions: dimensions.iter().map(|&one| one.to_owned()).collect(),
            values,
            attributes,
        });
    }

    /// Coordinates of cases: axes, what varies with the settings beside them, and what all share.
    fn add_coordinates(&mut self, axes: &Axes) {
        for axis in &axes.constants {
            self.add(
                &name_of(axis),
                &[],
                values_of(axis.values.iter()),
                attributes_of(axis),
            );
        }
        for (axis, name) in axes.axes.iter().zip(self.axes.clone()) {
            self.add_dimension(&name, axis.values.len());
            self.add(
                &name,
                &[&name],
                values_of(axis.values.iter()),
                attributes_of(axis),
            );
        }
        let settings = self.axes[..self.axes.len() - 2].to_vec();
        let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
        let directions = axes.axes[settings.len()..].iter();
        let directions: usize = directions.map(|axis| axis.values.len()).product();
        for axis in &axes.others {
            let of_setting = |cases: &[Option<usize>]| {
                let case = cases.iter().find_map(|case| *case);
                case.map_or(Value::Null, |case| axis.of(case).clone())
            };
            let values: Vec<Value> = axes.cases.chunks(directions).map(of_setting).collect();
            let name = name_of(axis);
            self.add(
                &name,
                &settings,
                values_of(values.iter()),
                attributes_of(axis),
            );
        }
    }

    /// Sides, and centres and edges of common bins.
    fn add_bins(&mut self, [rings, sectors]: [usize; 2]) {
        let sides = Side::BOTH.map(|side| side.to_string()).to_vec();
        self.add_dimension("side", 2);
        self.add(
            "side",
            &["side"],
            NetCdfValues::Texts(sides),
            vec![described("side on which light leaves")],
        );
        self.add_dimension("edge", 2);
        for (name, about, count, full) in [
            (
                "theta_o",
                "polar angle from the normal of the side, centre of the bin",
                rings,
                90.0,
            ),
            ("phi_o", "azimuth, centre of the bin", sectors, 360.0),
        ] {
            let step = full / count as f64;
            let bounds = format!("{name}_bounds");
            let numbers = |at: &[f64]| {
                let all = (0..count).flat_map(|i| at.iter().map(move |at| (i as f64 + at) * step));
                NetCdfValues::Numbers(all.collect())
            };
            self.add_dimension(name, count);
            let attributes = vec![
                described(about),
                in_unit("degree"),
                ("bounds", bounds.clone()),
            ];
            self.add(name, &[name], numbers(&[0.5]), attributes);
            self.add(&bounds, &[name, "edge"], numbers(&[0.0, 1.0]), Vec::new());
        }
    }

    /// Means and standard errors over the axes of cases and `dimensions`, the first of which is the side.
    fn add_estimates(
        &mut self,
        name: &str,
        unit: &str,
        about: &str,
        dimensions: &[&str],
        per_side: usize,
        of: impl Fn(&Outcome, Side) -> Vec<Option<Estimate>>,
    ) {
        let (mut means, mut errors) = (Vec::new(), Vec::new());
        for outcome in &self.outcomes {
            for side in Side::BOTH {
                let mut values = outcome.map_or_else(Vec::new, |outcome| of(outcome, side));
                values.resize(per_side, None);
                means.extend(
                    values
                        .iter()
                        .map(|one| one.map_or(f64::NAN, |one| one.mean)),
                );
                let se = |one: &Option<Estimate>| one.and_then(|one| one.se).unwrap_or(f64::NAN);
                errors.extend(values.iter().map(se));
            }
        }
        let axes = self.axes.clone();
        let all: Vec<&str> = axes
            .iter()
            .map(String::as_str)
            .chain(dimensions.iter().copied())
            .collect();
        let error = format!("{name}_se");
        let attributes = vec![
            described(about),
            in_unit(unit),
            ("ancillary_variables", error.clone()),
        ];
        let coordinates = Some(("coordinates", self.coordinates.clone()));
        let coordinates = coordinates.filter(|(_, names)| !names.is_empty());
        let attributes = attributes.into_iter().chain(coordinates).collect();
        self.add(name, &all, NetCdfValues::Numbers(means), attributes);
        let about = format!("standard error of {name}");
        let attributes = vec![
            described(&about),
            in_unit(unit),
            ("standard_name", format!("{name} standard_error")),
        ];
        self.add(&error, &all, NetCdfValues::Numbers(errors), attributes);
    }

    /// BSDF over the bins of each direction, and their edges; arrays are as long as the most bins.
    fn add_exact_bins(&mut self) {
        let grids = self.outcomes.iter().flatten();
        let grids = grids.map(|outcome| outcome.statistics.spec().grid());
        let most =
            |count: fn(&HemisphereGrid) -> usize| grids.clone().map(|grid| count(&grid)).max();
        let rings = most(HemisphereGrid::n_theta).unwrap_or(0);
        let sectors = most(HemisphereGrid::n_phi).unwrap_or(0);
        self.add_dimension("ring", rings);
        self.add_dimension("sector", sectors);
        let bins = |outcome: &Outcome, side: Side| {
            let grid = outcome.statistics.spec().grid();
            let edges = edges_from_normal(&grid, side);
            let phi = grid.phi_edges_deg(side);
            let range = |i: usize| {
                let (row, sector) = (i / sectors, i % sectors);
                (row < edges.len() && sector + 1 < phi.len()).then(|| Range {
                    theta_deg: edges[ring_from_normal(side, edges.len(), row)],
                    phi_deg: [phi[sector], phi[sector + 1]],
                })
            };
            (0..rings * sectors)
                .map(range)
                .collect::<Vec<Option<Range>>>()
        };
        let bsdf = |outcome: &Outcome, side: Side| {
            let rings = outcome.statistics.spec().grid().n_theta();
            let ranges = bins(outcome, side).into_iter().enumerate();
            let values = ranges.map(|(i, range)| {
                let divisor = range?.projected_solid_angle();
                let ring = ring_from_normal(side, rings, i / sectors);
                Some(over(bin_light(outcome, side, ring, i % sectors)?, divisor))
            });
            values.collect()
        };
        let dimensions = ["side", "ring", "sector"];
        self.add_estimates(
            "bsdf_exact",
            "sr-1",
            "BSDF over the bins of each direction",
            &dimensions,
            rings * sectors,
            bsdf,
        );
        let edge = |range: Option<&Option<Range>>, of: fn(&Range) -> f64| {
            range.and_then(Option::as_ref).map_or(f64::NAN, of)
        };
        let axes = self.axes.clone();
        let axes: Vec<&str> = axes.iter().map(String::as_str).collect();
        for (name, dimension, count, step, of) in [
            (
                "theta_o_exact",
                "ring",
                rings,
                sectors,
                [
                    |one: &Range| one.theta_deg[0],
                    |one: &Range| one.theta_deg[1],
                ],
            ),
            (
                "phi_o_exact",
                "sector",
                sectors,
                1,
                [|one: &Range| one.phi_deg[0], |one: &Range| one.phi_deg[1]],
            ),
        ] {
            let values = self.outcomes.iter().flat_map(|outcome| {
                Side::BOTH.into_iter().flat_map(move |side| {
                    let ranges = outcome.map_or_else(Vec::new, |outcome| bins(outcome, side));
                    let both = (0..count).flat_map(|i| of.map(|of| edge(ranges.get(i * step), of)));
                    both.collect::<Vec<f64>>()
                })
            });
            let values = NetCdfValues::Numbers(values.collect());
            let dimensions = [axes.as_slice(), &["side", dimension, "edge"]].concat();
            self.add(
                name,
                &dimensions,
                values,
                vec![described("edges of the bin"), in_unit("degree")],
            );
        }
    }

    /// Fluxes by order of scattering.
    fn add_orders(&mut self) {
        let spec_of = |outcome: &&Outcome| *outcome.statistics.spec();
        let specs = self.outcomes.iter().flatten().map(spec_of);
        let orders = specs.map(|spec| spec.order_entries(Side::Reflected).len());
        let orders = orders.max().unwrap_or(0);
        self.add_dimension("order", orders);
        self.add(
            "order",
            &["order"],
            NetCdfValues::Numbers((1..=orders).map(|order| order as f64).collect()),
            vec![described(
                "order of scattering; the last stands for all above too",
            )],
        );
        let fluxes = |outcome: &Outcome, side: Side| {
            let statistics = &outcome.statistics;
            let is_recorded = statistics.spec().records(side);
            let fluxes = statistics.orders(side);
            fluxes.map(|flux| is_recorded.then_some(flux)).collect()
        };
        self.add_estimates(
            "flux_order",
            "1",
            "fraction of the incident flux, by order of scattering",
            &["side", "order"],
            orders,
            fluxes,
        );
    }

    /// Mueller matrices over the bins, if all outcomes have them.
    fn add_mueller(&mut self) {
        let has_matrices =
            |outcome: &&Outcome| outcome.statistics.spec().polarimetry() == Polarimetry::Mueller;
        if !self.outcomes.iter().flatten().all(has_matrices) {
            return;
        }
        let ([rings, sectors], dimensions) = match self.is_common {
            true => (self.counts, ["theta_o", "phi_o"]),
            false => {
                let length = |name| {
                    let mut dimensions = self.content.dimensions.iter();
                    let found = dimensions.find(|(dimension, _)| dimension == name);
                    found.map_or(0, |(_, length)| *length)
                };
                ([length("ring"), length("sector")], ["ring", "sector"])
            }
        };
        self.add_dimension("row", 4);
        self.add_dimension("column", 4);
        let matrices = |outcome: &Outcome, side: Side| {
            let statistics = &outcome.statistics;
            let spec = statistics.spec();
            let (grid, bins) = (spec.grid(), spec.grid_entries(Component::All));
            let edges = edges_from_normal(&grid, side);
            let phi = grid.phi_edges_deg(side);
            let first = side.index() * grid.bins_per_side();
            let element = |i: usize| {
                let (bin, row, column) = (i / 16, i / 4 % 4, i % 4);
                let (from_normal, sector) = (bin / sectors, bin % sectors);
                let is_there = spec.records(side) && from_normal < edges.len();
                if !is_there || sector + 1 >= phi.len() {
                    return None;
                }
                let ring = ring_from_normal(side, edges.len(), from_normal);
                let range = Range {
                    theta_deg: edges[ring],
                    phi_deg: [phi[sector], phi[sector + 1]],
                };
                let flux = bins.get(first + ring * grid.n_phi() + sector);
                let element = spec.measure_entry(flux, Measure::Element { row, column })?;
                Some(over(statistics.at(element), range.projected_solid_angle()))
            };
            (0..rings * sectors * 16).map(element).collect()
        };
        let [ring, sector] = dimensions;
        self.add_estimates(
            "mueller",
            "sr-1",
            "BSDF as a Mueller matrix, from the axes of the incident ray to those of the ray that leaves",
            &["side", ring, sector, "row", "column"],
            rings * sectors * 16,
            matrices,
        );
    }

    fn finish(mut self, measurement: &Measurement) -> NetCdf {
        let header = &measurement.header;
        self.content.attributes = vec![
            ("Conventions", "CF-1.11".to_owned()),
            (
                "title",
                format!(
                    "BSDF of rough surfaces by explicit geometric optics, asperity {}",
                    header.study
                ),
            ),
            ("source", measurement.source()),
            ("comment", CONVENTIONS.to_owned()),
            (
                "completeness",
                format!(
                    "{} of {} directions",
                    measurement.cases.len(),
                    measurement.planned
                ),
            ),
            ("seed", header.seed.to_string()),
            ("configuration", header.document.to_string()),
        ];
        self.content.attributes.extend(optics_of(measurement));
        self.content
    }
}

/// Attributes for renderers: whether azimuths of the light are random, whether it is polarised, and the index behind the sample relative to that above it.
fn optics_of(measurement: &Measurement) -> Vec<(&'static str, String)> {
    let cases = measurement.cases.iter().map(|one| &one.outcome.case);
    let is_random = cases.clone().all(|case| case.light.random_azimuth);
    let is_polarised = cases.clone().any(|case| case.light.is_polarised());
    let mut attributes = vec![
        (
            "azimuths",
            if is_random { "random" } else { "fixed" }.to_owned(),
        ),
        (
            "light",
            if is_polarised {
                "polarised"
            } else {
                "unpolarised"
            }
            .to_owned(),
        ),
    ];
    let mut lit_from_above = cases.filter(|case| case.light.from == HalfSpace::Above);
    let first = lit_from_above.next().and_then(Case::index_beyond);
    let behind =
        first.filter(|first| lit_from_above.all(|case| case.index_beyond() == Some(*first)));
    attributes.extend(behind.map(|index| ("index_behind", index.to_string())));
    attributes
}

/// Name of a coordinate, without its unit.
fn name_of(axis: &Axis) -> String {
    let name = match axis.name.as_str() {
        "theta_deg" => "theta_i",
        "phi_deg" => "phi_i",
        name => name
            .strip_suffix(&format!("_{}", axis.unit))
            .unwrap_or(name),
    };
    name.to_owned()
}

fn attributes_of(axis: &Axis) -> Vec<(&'static str, String)> {
    let unit = match axis.unit.as_str() {
        "deg" => "degree",
        // Lengths in no unit
        "length" => "",
        unit => unit,
    };
    let unit = (!unit.is_empty()).then(|| in_unit(unit));
    [described(&axis.about)].into_iter().chain(unit).collect()
}

fn described(about: &str) -> (&'static str, String) {
    ("long_name", about.to_owned())
}

fn in_unit(unit: &str) -> (&'static str, String) {
    ("units", unit.to_owned())
}

/// Values as numbers, or as texts if one of them is one.
fn values_of<'v>(values: impl Iterator<Item = &'v Value> + Clone) -> NetCdfValues {
    match values.clone().any(Value::is_string) {
        true => NetCdfValues::Texts(
            values
                .map(|value| value.as_str().unwrap_or_default().to_owned())
                .collect(),
        ),
        false => NetCdfValues::Numbers(
            values
                .map(|value| value.as_f64().unwrap_or(f64::NAN))
                .collect(),
        ),
    }
}
