//! `asperity model`: a statistical model, direction by direction or bin by bin.

use std::path::Path;

use asperity_studies::settings::Document;
use asperity_studies::{ModelConfig, Resolution, evaluate_model, model_list, wrapped};

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::print;
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let config: ModelConfig = document.read().map_err(Failure::usage)?;
    if config.is_list() {
        print(&model_list().map_err(Failure::failed)?)?;
        return Ok(End::Complete);
    }
    let results = Results::of(document).map_err(Failure::usage)?;
    let file = results.output.as_deref();
    if let Some(path) = file {
        check_table_output(path)?;
        check_outputs(&[path], document)?;
    }
    let resolution = match results.json {
        true => Resolution::Bins,
        false => Resolution::Directions,
    };
    let model =
        evaluate_model(&config, document, resolution).map_err(|error| match error.is_usage() {
            true => Failure::usage(error),
            false => Failure::failed(error),
        })?;
    if let Some(path) = file {
        model.write_csv(path).map_err(Failure::failed)?;
    }
    if let (Some(table), None) = (model.csv(), file) {
        let notes = model.notes().iter().filter(|_| !common.quiet);
        let notes: String = notes.map(|note| format!("# {note}\n")).collect();
        print(&format!("{notes}{table}"))?;
        return Ok(End::Complete);
    }
    let text = || {
        let notes: String = model
            .notes()
            .iter()
            .map(|note| format!("{note}\n"))
            .collect();
        let mut text = format!("{}\n{notes}{}", model.description(), model.text());
        if let Some(path) = file {
            text.push_str(&format!("{}: {}\n", path.display(), model.rows()));
        }
        wrapped(&text)
    };
    results.print_file(common, || model.summary(file), text)?;
    Ok(End::Complete)
}

/// Refuses a file whose ending is not that of a table.
fn check_table_output(path: &Path) -> Result<(), Failure> {
    match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("csv") => Ok(()),
        _ => Err(Failure::usage(format!(
            "{}: a model is written as .csv",
            path.display()
        ))),
    }
}
