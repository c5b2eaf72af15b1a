//! Input files: all files that a run reads, which it must not replace.

use std::path::{Path, PathBuf};

use serde_json::Value;

use asperity_io::names_file;

use super::definitions::settings_of;
use super::document::Document;
use super::film_text::FilmText;
use super::kind::Kind;
use super::layer_text::LayerText;

/// Sections whose files are written.
const OUTPUTS: [&str; 2] = ["results", "picture"];

/// Beginning of the name of a height map that surfaces are to be like.
pub(crate) const LIKE: &str = "like:";

impl Document {
    /// The files that the run reads: the configuration, and all that its settings name.
    #[must_use]
    pub fn input_files(&self) -> Vec<PathBuf> {
        let settings = settings_of(self.command());
        let inputs = settings.filter(|setting| !OUTPUTS.contains(&setting.section));
        let named = inputs.flat_map(|setting| {
            let values = match self.value(&setting.path()) {
                Some(Value::Array(values)) => values,
                value => value.into_iter().collect(),
            };
            let texts = values.iter().filter_map(Value::as_str);
            texts
                .filter_map(|text| file_of(setting.kind, text))
                .collect::<Vec<PathBuf>>()
        });
        let configuration = self.file().map(Path::to_owned);
        configuration.into_iter().chain(named).collect()
    }
}

/// The file that the value of a setting of this kind names, if it is one.
fn file_of(kind: Kind, text: &str) -> Option<PathBuf> {
    let is_choice = kind.choices().iter().any(|choice| choice.name == text);
    let material = match kind {
        Kind::Path | Kind::ChoiceOrFile(_) if !is_choice => {
            return Some(text.strip_prefix(LIKE).unwrap_or(text).into());
        }
        Kind::ChoiceOrMaterial(_) | Kind::Material if !is_choice => text.to_owned(),
        Kind::Film => FilmText::parse(text)?.material,
        Kind::Layer => LayerText::parse(text)?.material,
        _ => return None,
    };
    names_file(&material).then(|| material.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Command;

    #[test]
    fn every_setting_that_names_a_file_is_an_input_or_an_output() {
        for command in Command::ALL {
            for setting in settings_of(command).filter(|s| !OUTPUTS.contains(&s.section)) {
                if !matches!(setting.kind, Kind::Path | Kind::ChoiceOrFile(_)) {
                    continue;
                }
                // Named by an argument
                let Some(flag) = setting.flag_name() else {
                    continue;
                };
                let mut document = Document::new(command);
                let values = vec!["some/file.csv".to_owned()];
                document.add_flags(&[(flag.clone(), values)], None).unwrap();
                assert_eq!(
                    document.input_files(),
                    [PathBuf::from("some/file.csv")],
                    "{command} --{flag}"
                );
            }
        }
    }

    #[test]
    fn names_of_choices_are_no_files_and_like_is_no_part_of_a_name() {
        let flags = [("psd", "matern"), ("heights", "like:glass.sur")];
        let flags = flags.map(|(flag, value)| (flag.to_owned(), vec![value.to_owned()]));
        let mut document = Document::of_text(Command::Verify, "").unwrap();
        document.add_flags(&flags, None).unwrap();
        assert_eq!(document.input_files(), [PathBuf::from("glass.sur")]);
    }
}
