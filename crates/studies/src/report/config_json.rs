//! Configurations as summary.json holds them.

use serde::Serialize;
use serde_json::{Value, json};

use crate::config::RunConfig;

/// A configuration whose section `run` is given, without the keys `left_out` of that section and without the
/// numbers of surfaces and rays if they followed from a target.
pub(crate) fn config_json(config: &impl Serialize, run: &RunConfig, left_out: &[&str]) -> Value {
    let mut config = json!(config);
    let planned = ["realisations", "rays"];
    let planned = planned.iter().filter(|_| run.target_error.is_some());
    if let Some(run) = config.get_mut("run").and_then(Value::as_object_mut) {
        for key in left_out.iter().chain(planned) {
            run.remove(*key);
        }
    }
    config
}
