//! Distinction: how the settings of a measurement are told apart.

use asperity_simulate::{Case, CaseGroup, CasePart};

/// Coordinates that all settings share, and those in which they differ.
pub(super) struct Distinction {
    /// Common parameters, in words.
    pub(super) common: String,
    /// Names of what differs, in words; empty for one setting.
    pub(super) title: String,
    /// Name of each setting among the others.
    pub(super) labels: Vec<String>,
}

impl Distinction {
    /// `settings`: a case of each.
    pub(super) fn of<'a>(settings: impl Iterator<Item = &'a Case>) -> Self {
        let all: Vec<Vec<CasePart>> = settings.map(Case::setting_parts).collect();
        let value = |of: &[CasePart], name: &str| of.iter().find(|part| part.name == name).cloned();
        let mut names: Vec<&str> = Vec::new();
        for part in all.iter().flatten() {
            if !names.contains(&part.name.as_str()) {
                names.push(&part.name);
            }
        }
        let differs = |name: &&str| all.iter().any(|of| value(of, name) != value(&all[0], name));
        let (varied, mut kept): (Vec<&str>, Vec<&str>) = names.into_iter().partition(differs);
        // The usual side of the light goes without saying
        kept.retain(|name| {
            let part = value(&all[0], name);
            part.is_none_or(|part| part.group != CaseGroup::Light || part.value != "from above")
        });
        let words = |of: &[CasePart], names: &[&str], named: bool| {
            let parts = names.iter().filter_map(|name| value(of, name));
            let words = parts.map(|part| if named { part.text() } else { part.value });
            words.collect::<Vec<_>>().join(", ")
        };
        Self {
            common: all
                .first()
                .map_or_else(String::new, |of| words(of, &kept, true)),
            title: varied.join(", "),
            labels: all
                .iter()
                .map(|of| words(of, &varied, varied.len() > 1))
                .collect(),
        }
    }
}

/// A label with the name of what it is a value of; labels of several values name them already.
pub(super) fn labelled(title: &str, label: &str) -> String {
    if label.contains(" = ") || title.is_empty() {
        label.to_owned()
    } else {
        format!("{title} = {label}")
    }
}
