//! Header: the identity of a run, by which two runs are told apart.

use asperity_io::{Build, RESULTS_EPOCH, read_text};
use asperity_tracer::Instructions;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::shards::Shards;

/// Version of the file format.
const FORMAT: u64 = 1;

/// Settings of the section `run` that decide how many surfaces and rays there are.
const EFFORT: [&str; 4] = ["realisations", "rays", "target_error", "of"];

/// Identity of a run: study, build, seed and settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the file format.
    pub format: u64,
    /// Name of the study.
    pub study: String,
    /// Version, results epoch and commit of the program.
    pub build: Build,
    /// Seed of surfaces and rays.
    pub seed: u64,
    /// All settings that the results depend on.
    pub document: Value,
    /// The shards that the results are of; `None` if they are of the whole run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shards: Option<Shards>,
    /// Machine and run time, which comparisons ignore.
    #[serde(default)]
    pub machine: Machine,
}

/// The machine of a run, and how long it took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Host name, if the system gives one.
    pub host: Option<String>,
    /// Threads.
    pub threads: usize,
    /// Instruction set of the tracer.
    pub instructions: String,
    /// Seconds of all runs from beginning to end.
    pub seconds: f64,
}

impl Machine {
    /// The current machine.
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
            seed,
            document,
            shards: None,
            machine: Machine::current(),
        }
    }

    /// First key in which the header `found`, which may be of any format, differs from this one. Commit, version and machine
    /// are not compared.
    pub(crate) fn difference(&self, found: &Value) -> Option<String> {
        let of_run = self.difference_of_run(found);
        of_run.or_else(|| self.other_shards(found))
    }

    /// The same, whatever shards of the run both are of.
    pub(crate) fn difference_of_run(&self, found: &Value) -> Option<String> {
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

    /// Returns `true` if the header `found` is of a partial merge of the run, which this one, of the whole, completes.
    pub(crate) fn completes(&self, found: &Value) -> bool {
        let is_partial = found["shards"]["merged"] == true;
        self.shards.is_none() && is_partial && self.difference_of_run(found).is_none()
    }

    /// Returns `true` if the header `found` is of a run that differs in its number of surfaces and rays alone.
    pub(crate) fn extends(&self, found: &Value) -> bool {
        let without_effort = |mut header: Value| {
            if let Some(run) = header
                .pointer_mut("/document/run")
                .and_then(Value::as_object_mut)
            {
                run.retain(|key, _| !EFFORT.contains(&key.as_str()));
            }
            header
        };
        let own = serde_json::from_value::<Self>(without_effort(json!(self)));
        own.is_ok_and(|own| own.difference(&without_effort(found.clone())).is_none())
    }

    fn other_shards(&self, found: &Value) -> Option<String> {
        let found: Option<Shards> = Deserialize::deserialize(&found["shards"]).ok()?;
        let text = |shards: &Option<Shards>| {
            let text = shards.as_ref().map(Shards::to_string);
            text.unwrap_or_else(|| "the whole run".to_owned())
        };
        let are_same = match (&found, &self.shards) {
            (Some(found), Some(own)) => found.are_those_of(own),
            (None, None) => true,
            _ => false,
        };
        (!are_same).then(|| format!("{} in place of {}", text(&found), text(&self.shards)))
    }
}

/// Difference in format, study or results epoch; `None` if there is none.
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

/// First key whose value differs, with both values; objects of lists are numbered from 1.
pub(crate) fn first_difference(found: &Value, expected: &Value, key: &str) -> Option<String> {
    if found == expected {
        return None;
    }
    if let (Value::Array(a), Value::Array(b)) = (found, expected)
        && a.iter().chain(b).all(Value::is_object)
    {
        if a.len() != b.len() {
            let [found, expected] = [a.len(), b.len()];
            let key = key.trim_start_matches("document.");
            return Some(format!("{key} {found} elements in place of {expected}"));
        }
        let mut pairs = (1..).zip(a.iter().zip(b));
        return pairs.find_map(|(i, (a, b))| first_difference(a, b, &format!("{key}.{i}")));
    }
    let (Value::Object(a), Value::Object(b)) = (found, expected) else {
        let key = key.trim_start_matches("document.");
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
