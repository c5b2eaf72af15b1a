//! Entry: a value of a setting as it was given.

use serde_json::Value;

use super::error::Given;
use super::kind::Kind;
use super::setting::Setting;

/// A value of a setting, and where it was given.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) setting: &'static Setting,
    pub(super) value: Value,
    pub(super) given: Given,
}

impl Entry {
    /// Whether it excludes or clears others: a switch that is off does not.
    pub(super) fn is_active(&self) -> bool {
        self.value != Value::Bool(false)
    }

    /// Whether `other` cannot be given together with it.
    pub(super) fn excludes(&self, other: &Setting) -> bool {
        let named = |pattern: &&str| other.matches(pattern);
        self.is_active() && self.setting.excludes.iter().any(named)
    }

    /// Whether it clears `other` of a lower layer.
    pub(super) fn clears(&self, other: &Setting) -> bool {
        let named = |pattern: &&str| other.matches(pattern);
        let by_choice = match self.setting.kind {
            Kind::Choice(choices) => choices
                .iter()
                .filter(|choice| self.value == choice.name)
                .any(|choice| choice.clears.iter().any(named)),
            _ => false,
        };
        let by_setting = self.is_active() && self.setting.clears.iter().any(named);
        self.excludes(other) || by_setting || by_choice
    }
}
