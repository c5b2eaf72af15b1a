//! Entry: a value of a setting, and where it was given.

use serde_json::Value;

use super::error::Given;
use super::setting::Setting;

/// A value of a setting, and where it was given.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) setting: &'static Setting,
    pub(super) value: Value,
    pub(super) given: Given,
}

impl Entry {
    /// Section and key of its setting.
    pub(super) const fn section_and_key(&self) -> (&'static str, &'static str) {
        (self.setting.section, self.setting.key)
    }

    /// Returns `true` if `pattern` means it.
    pub(super) fn is(&self, pattern: &str) -> bool {
        self.setting.has_value(pattern, &self.value)
    }

    /// Returns `true` if one of the `patterns` means it.
    pub(super) fn is_any(&self, patterns: &[&str]) -> bool {
        is_any(patterns, self.setting, &self.value)
    }
}

/// Returns `true` if one of the `patterns` means a setting of this value.
pub(super) fn is_any(patterns: &[&str], setting: &Setting, value: &Value) -> bool {
    let means = |pattern: &str| setting.has_value(pattern, value);
    let left_out = |pattern: &&str| pattern.strip_prefix('-').is_some_and(means);
    patterns.iter().any(|pattern| means(pattern)) && !patterns.iter().any(left_out)
}
