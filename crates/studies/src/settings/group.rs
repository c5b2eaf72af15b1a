//! Group: variants of which one holds, and the settings that belong to each.
//!
//! A variant is chosen by the value of a *kind* setting, such as `material.kind`, or by the settings of its own that are given, as a target
//! error is in place of numbers of rays. Settings of two variants exclude each other in a file, and on the command line. A flag that chooses
//! a variant, or changes which one holds, clears what the file has of the others. Defaults of settings hold within the chosen variant alone.
//!
//! Lists of settings hold patterns: `section.key`, `section.*`, `section.key=value`, `section.key!value` for any other value, and, with `-`
//! before it, what they do not mean. A value that ends in `:` is the beginning of one.

use serde_json::Value;

use super::entry::{Entry, is_any};
use super::setting::Setting;

/// Name of the variant of a kind that names a file.
pub(super) const A_FILE: &str = "a file";

/// Name of the variant of a kind that names a material, or a file of one.
pub(super) const NAMED: &str = "NAME or INDEX";

/// Variants of which one holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    /// The setting whose value is the name of a variant; empty where settings of the variants choose.
    pub(super) kind: &'static str,
    /// The setting or section without which the group does not matter; empty if there is none.
    pub(super) only_with: &'static str,
    /// Advice to who gives settings of two variants.
    pub(super) advice: &'static str,
    /// `true` if defaults of other variants hold as well.
    pub(super) keeps_all_defaults: bool,
    pub(super) variants: &'static [Variant],
}

/// One variant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variant {
    /// The value of the kind, or a name in sentences.
    pub(super) name: &'static str,
    /// Settings that choose it.
    pub(super) chosen_by: &'static [&'static str],
    /// Further settings that it has to have.
    pub(super) needs: &'static [&'static str],
    /// Further settings that it may have.
    pub(super) allows: &'static [&'static str],
    /// Settings whose defaults do not hold with it, though they may be given.
    pub(super) without_default_of: &'static [&'static str],
    /// `true` if it holds where nothing chooses one.
    pub(super) is_default: bool,
}

/// Variants that their own settings choose.
pub(super) const fn group(variants: &'static [Variant]) -> Group {
    group_by("", variants)
}

/// Variants that the value of the setting `kind` chooses.
pub(super) const fn group_by(kind: &'static str, variants: &'static [Variant]) -> Group {
    Group {
        kind,
        only_with: "",
        advice: "give one or the other",
        keeps_all_defaults: false,
        variants,
    }
}

/// A variant without settings.
pub(super) const fn variant(name: &'static str) -> Variant {
    Variant {
        name,
        chosen_by: &[],
        needs: &[],
        allows: &[],
        without_default_of: &[],
        is_default: false,
    }
}

impl Group {
    pub(super) const fn only_with(mut self, pattern: &'static str) -> Self {
        self.only_with = pattern;
        self
    }

    pub(super) const fn advice(mut self, advice: &'static str) -> Self {
        self.advice = advice;
        self
    }

    pub(super) const fn keeps_all_defaults(mut self) -> Self {
        self.keeps_all_defaults = true;
        self
    }

    /// Section under which it is listed: that of its kind, or of its first setting.
    pub(super) fn section(&self) -> &'static str {
        let settings = self.variants.iter().flat_map(|variant| variant.chosen_by);
        let first = settings.copied().next().unwrap_or_default();
        let path = if self.kind.is_empty() {
            first
        } else {
            self.kind
        };
        path.split('.').next().unwrap_or_default()
    }

    /// Returns the variant that an entry chooses.
    pub(super) fn variant_of(&self, entry: &Entry) -> Option<&'static Variant> {
        let mut variants = self.variants.iter();
        if self.kind.is_empty() {
            return variants.find(|variant| entry.is_any(variant.chosen_by));
        }
        let name = entry.value.as_str().filter(|_| entry.is(self.kind))?;
        let choices = entry.setting.kind.choices();
        let is_choice = choices.iter().any(|choice| choice.name == name);
        variants.find(|variant| match is_choice {
            true => variant.name == name,
            false => [A_FILE, NAMED].contains(&variant.name),
        })
    }

    /// Returns `true` if a setting of this value belongs to one of the variants.
    pub(super) fn owns(&self, setting: &Setting, value: &Value) -> bool {
        let mut variants = self.variants.iter();
        variants.any(|variant| variant.has(setting, value))
    }

    /// Variants that an entry belongs to.
    pub(super) fn owners(&self, entry: &Entry) -> Vec<&'static Variant> {
        let owners = self.variants.iter();
        owners
            .filter(|variant| variant.has(entry.setting, &entry.value))
            .collect()
    }
}

impl Variant {
    pub(super) const fn when(mut self, settings: &'static [&'static str]) -> Self {
        self.chosen_by = settings;
        self
    }

    pub(super) const fn needs(mut self, settings: &'static [&'static str]) -> Self {
        self.needs = settings;
        self
    }

    pub(super) const fn allows(mut self, settings: &'static [&'static str]) -> Self {
        self.allows = settings;
        self
    }

    pub(super) const fn without_default_of(mut self, settings: &'static [&'static str]) -> Self {
        self.without_default_of = settings;
        self
    }

    pub(super) const fn by_default(mut self) -> Self {
        self.is_default = true;
        self
    }

    /// Returns `true` if a setting of this value belongs to it.
    pub(super) fn has(&self, setting: &Setting, value: &Value) -> bool {
        let lists = [self.chosen_by, self.needs, self.allows];
        lists.iter().any(|list| is_any(list, setting, value))
    }
}
