//! Head of summary.json: what wrote a result.

use asperity_io::Build;
use serde::Serialize;
use serde_json::{Value, json};

/// Form of the files; another number is another form.
const SCHEMA: u32 = 2;

/// The first keys of every summary: form, command, version, results epoch and commit.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Head {
    schema: u32,
    command: &'static str,
    #[serde(flatten)]
    build: Build,
}

impl Head {
    /// Head of a result of `command`, written by this build.
    pub(crate) fn of(command: &'static str) -> Self {
        Self {
            schema: SCHEMA,
            command,
            build: Build::current(),
        }
    }

    /// Puts its keys into a summary, which is an object.
    pub(crate) fn insert_into(&self, summary: &mut Value) {
        if let (Some(summary), Value::Object(head)) = (summary.as_object_mut(), json!(self)) {
            summary.extend(head);
        }
    }
}
