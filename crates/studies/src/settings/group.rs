//! Group: variants of which one holds, and the settings that belong to each.
//!
//! A variant is chosen by the value of a *kind* setting, such as `material.kind`, or by the settings of its own that are given, as a target
//! error is in place of numbers of rays. Settings of two variants exclude each other in a file, and on the command line. Those of a flag take
//! the place of those of a file. Defaults of settings hold within the chosen variant alone.
//!
//! Lists of settings hold patterns: `section.key`, `section.*`, `section.key=value`, `section.key!value` for any other value, and, with `-`
//! before it, what they do not mean. A value that ends in `:` is the beginning of one.

use serde_json::Value;

use super::entry::{Entry, is_any};
use super::setting::Setting;

/// Name of the variant of a kind that names a file.
pub(super) const A_FILE: &str = "a file";

/// Variants of which one holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    /// The setting whose value is the name of a variant; empty where settings of the variants choose.
    pub(super) kind: &'static str,
    /// The setting or section without which the group does not matter; empty if there is none.
    pub(super) within: &'static str,
    /// Subject of the sentence that refuses a group without a chosen variant; empty where none is needed.
    pub(super) subject: &'static str,
    /// `true` if defaults of other variants hold as well.
    pub(super) keeps_defaults: bool,
    pub(super) variants: &'static [Variant],
}

/// One variant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variant {
    /// The value of the kind, or a name in sentences.
    pub(super) name: &'static str,
    /// Settings that choose it.
    pub(super) by: &'static [&'static str],
    /// Further settings that it has to have.
    pub(super) needs: &'static [&'static str],
    /// Further settings that it may have.
    pub(super) takes: &'static [&'static str],
    /// Settings whose defaults do not hold with it, though they may be given.
    pub(super) without_default: &'static [&'static str],
    /// `true` if it holds where nothing chooses one.
    pub(super) otherwise: bool,
}

/// Variants that their own settings choose.
pub(super) const fn group(variants: &'static [Variant]) -> Group {
    kind("", variants)
}

/// Variants that the value of the setting `kind` chooses.
pub(super) const fn kind(kind: &'static str, variants: &'static [Variant]) -> Group {
    Group {
        kind,
        within: "",
        subject: "",
        keeps_defaults: false,
        variants,
    }
}

/// A variant without settings.
pub(super) const fn variant(name: &'static str) -> Variant {
    Variant {
        name,
        by: &[],
        needs: &[],
        takes: &[],
        without_default: &[],
        otherwise: false,
    }
}

impl Group {
    pub(super) const fn within(mut self, pattern: &'static str) -> Self {
        self.within = pattern;
        self
    }

    pub(super) const fn one_of_them(mut self, subject: &'static str) -> Self {
        self.subject = subject;
        self
    }

    pub(super) const fn keeping_defaults(mut self) -> Self {
        self.keeps_defaults = true;
        self
    }

    /// Section under which it is listed: that of its kind, or of its first setting.
    pub(super) fn section(&self) -> &'static str {
        let settings = self.variants.iter().flat_map(|variant| variant.by);
        let first = settings.copied().next().unwrap_or_default();
        let path = if self.kind.is_empty() {
            first
        } else {
            self.kind
        };
        path.split('.').next().unwrap_or_default()
    }

    /// Returns the variant that an entry chooses.
    pub(super) fn chosen_by(&self, entry: &Entry) -> Option<&'static Variant> {
        let mut variants = self.variants.iter();
        if self.kind.is_empty() {
            return variants.find(|variant| entry.is_any(variant.by));
        }
        let name = entry.value.as_str().filter(|_| entry.is(self.kind))?;
        let choices = entry.setting.kind.choices();
        let is_file = !choices.iter().any(|choice| choice.name == name);
        variants.find(|variant| variant.name == if is_file { A_FILE } else { name })
    }

    /// Returns `true` if a setting of this value belongs to one of the variants.
    pub(super) fn owns(&self, setting: &Setting, value: &Value) -> bool {
        let mut variants = self.variants.iter();
        variants.any(|variant| variant.has(setting, value))
    }

    /// Names of the variants that an entry belongs to, as in `psd exponential or matern`.
    pub(super) fn owners(&self, entry: &Entry) -> Vec<&'static str> {
        let owners = self.variants.iter();
        owners
            .filter(|variant| variant.has(entry.setting, &entry.value))
            .map(|variant| variant.name)
            .collect()
    }
}

impl Variant {
    pub(super) const fn by(mut self, settings: &'static [&'static str]) -> Self {
        self.by = settings;
        self
    }

    pub(super) const fn needs(mut self, settings: &'static [&'static str]) -> Self {
        self.needs = settings;
        self
    }

    pub(super) const fn takes(mut self, settings: &'static [&'static str]) -> Self {
        self.takes = settings;
        self
    }

    pub(super) const fn without_default(mut self, settings: &'static [&'static str]) -> Self {
        self.without_default = settings;
        self
    }

    pub(super) const fn otherwise(mut self) -> Self {
        self.otherwise = true;
        self
    }

    /// Returns `true` if a setting of this value belongs to it.
    pub(super) fn has(&self, setting: &Setting, value: &Value) -> bool {
        let lists = [self.by, self.needs, self.takes];
        lists.iter().any(|list| is_any(list, setting, value))
    }
}
