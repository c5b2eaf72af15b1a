//! Repeat: a document as a request, and the document of a request.

use serde::Deserialize;
use serde_json::{Value, json};

use super::command::Command;
use super::definitions::settings_of;
use super::document::Document;
use super::error::SettingError;
use super::request::Request;

/// Settings that results do not depend on: where they go, which part of them is computed, and how long that may take.
const LEFT_OUT: [&str; 3] = ["results.*", "program.*", "run.max_time"];

/// Settings among these that a merge needs.
const KEPT: [&str; 2] = ["results.for", "results.extendable"];

impl Document {
    /// What the document was made of, as far as results depend on it.
    #[must_use]
    pub fn request(&self) -> Value {
        let mut request = self.request.clone();
        let is_kept = |name: &str| {
            let mut settings = settings_of(self.command());
            settings.any(|setting| {
                let is_left_out = LEFT_OUT.iter().any(|pattern| setting.matches(pattern));
                let is_kept = !is_left_out || KEPT.iter().any(|pattern| setting.matches(pattern));
                setting.flag_name().as_deref() == Some(name) && is_kept
            })
        };
        request.flags.retain(|(name, _)| is_kept(name));
        json!(request)
    }

    /// All settings with their defaults, by section, but those that shards of one run may have apart: where results go, figures, time limits, and
    /// names of given surfaces, whose points are compared instead.
    ///
    /// # Errors
    /// [`SettingError`] if settings do not go together.
    pub fn settings(&self) -> Result<Value, SettingError> {
        let mut settings: Value = self.read()?;
        if let Some(sections) = settings.as_object_mut() {
            sections.retain(|name, _| !["results", "program", "output"].contains(&name.as_str()));
        }
        for (section, key) in [("run", "max_time"), ("measured", "file")] {
            if let Some(section) = settings[section].as_object_mut() {
                section.remove(key);
            }
        }
        Ok(settings)
    }

    /// The document of a [request](Self::request).
    ///
    /// # Errors
    /// [`SettingError`] if it is none, or its settings are invalid.
    pub fn of_request(command: Command, request: &Value) -> Result<Self, SettingError> {
        let request = Request::deserialize(request);
        let request = request.map_err(|error| SettingError::Unreadable(error.to_string()))?;
        let mut document = Self::new(command);
        if let Some(text) = &request.file {
            document.add_file(None, text)?;
        }
        let positional = request.positional.as_ref();
        let positional = positional.map(|(path, values)| (path.as_str(), values.as_slice()));
        document.add_flags(&request.flags, positional)?;
        Ok(document)
    }
}
