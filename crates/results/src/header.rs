//! Header: what results follow from, by which two runs are told apart.

use std::collections::BTreeMap;

use asperity_io::{Build, RESULTS_EPOCH, read_text};
use asperity_simulate::Case;
use asperity_tracer::Instructions;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::rounding::rounding;

/// Form of the files; another number is another form.
const FORMAT: u64 = 1;

/// What results follow from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Form of the files.
    pub format: u64,
    /// Name of the study.
    pub study: String,
    /// Version, results epoch and commit of the program.
    pub build: Build,
    /// Fingerprint of how the machine rounds.
    pub rounding: String,
    /// Seed of surfaces and rays.
    pub seed: u64,
    /// All settings that the results depend on.
    pub document: Value,
    /// The values of each coordinate in which cases differ.
    pub axes: BTreeMap<String, Vec<Value>>,
    /// What depends on the machine and the moment: comparisons leave it out.
    #[serde(default)]
    pub machine: Machine,
}

/// The machine of a run, and how long it took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Its name, where the system tells it.
    pub host: Option<String>,
    /// Threads.
    pub threads: usize,
    /// Instructions by which light is traced.
    pub instructions: String,
    /// Seconds of all runs from beginning to end.
    pub seconds: f64,
}

impl Machine {
    /// This one.
    fn current() -> Self {
        let host = read_text("/proc/sys/kernel/hostname").ok();
        let host = host.map(|host| host.trim().to_owned());
        Self {
            host: host.filter(|host| !host.is_empty()),
            threads: rayon::current_num_threads(),
            instructions: Instructions::best().to_string(),
            seconds: 0.0,
        }
    }
}

impl Header {
    /// The header of a run of this program on this machine.
    #[must_use]
    pub fn new(study: &str, seed: u64, document: Value) -> Self {
        Self {
            format: FORMAT,
            study: study.to_owned(),
            build: Build::current(),
            rounding: rounding().to_owned(),
            seed,
            document,
            axes: BTreeMap::new(),
            machine: Machine::current(),
        }
    }

    /// Sets the axes: each quantity in which the cases differ, with its values.
    pub(crate) fn set_axes(&mut self, cases: &[Case]) {
        let mut axes: BTreeMap<String, Vec<Value>> = BTreeMap::new();
        for column in cases.iter().flat_map(Case::columns) {
            let values = axes.entry(column.name).or_default();
            if !values.contains(&column.value) {
                values.push(column.value);
            }
        }
        axes.retain(|_, values| values.len() > 1);
        self.axes = axes;
    }

    /// What tells the header `found`, which may be of any form, from this one: the first key that differs. The commit, the version,
    /// the rounding and the machine may be others.
    pub(crate) fn difference(&self, found: &Value) -> Option<String> {
        other_build(found, &self.study).or_else(|| {
            let own = json!(self);
            let part = |header: &Value| {
                let keys = ["document", "seed"];
                let parts = keys.map(|key| (key.to_owned(), header[key].clone()));
                Value::Object(Map::from_iter(parts))
            };
            first_difference(&part(found), &part(&own), "")
        })
    }
}

/// What tells results from those of this form, study and results epoch; `None` if nothing does.
pub(crate) fn other_build(found: &Value, study: &str) -> Option<String> {
    let number = |value: &Value| value.as_u64().map_or("none".to_owned(), |n| n.to_string());
    let format = number(&found["format"]);
    if format != FORMAT.to_string() {
        return Some(format!("format {format}, this program writes {FORMAT}"));
    }
    let of = found["study"].as_str().unwrap_or("none");
    if of != study {
        return Some(format!("study {of} in place of {study}"));
    }
    let epoch = number(&found["build"]["results_epoch"]);
    (epoch != RESULTS_EPOCH.to_string())
        .then(|| format!("results epoch {epoch}, that of this program is {RESULTS_EPOCH}"))
}

/// The first key whose value differs, with both values.
#[must_use]
pub fn first_difference(found: &Value, expected: &Value, key: &str) -> Option<String> {
    if found == expected {
        return None;
    }
    let (Value::Object(a), Value::Object(b)) = (found, expected) else {
        return Some(format!("{key} {found} in place of {expected}"));
    };
    let mut names: Vec<&String> = a.keys().chain(b.keys()).collect();
    names.sort();
    names.into_iter().find_map(|name| {
        let key = if key.is_empty() {
            name.clone()
        } else {
            format!("{key}.{name}")
        };
        let of = |map: &Map<String, Value>| map.get(name).cloned().unwrap_or(Value::Null);
        first_difference(&of(a), &of(b), &key)
    })
}
