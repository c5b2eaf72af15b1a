//! `asperity model`: a statistical model, direction by direction or bin by bin.

use asperity_io::check_ending;
use asperity_studies::settings::Document;
use asperity_studies::{ListedModel, ModelConfig, Resolution, evaluate_model, model_list};

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let config: ModelConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    if config.is_list() {
        let list = model_list().map_err(Failure::failed)?;
        match results.json {
            true => print_json(&list)?,
            false => print(&list.iter().map(ListedModel::text).collect::<String>())?,
        }
        return Ok(End::Complete);
    }
    let file = results.output.as_deref();
    if let Some(path) = file {
        check_ending(path, "models", &["csv"]).map_err(Failure::usage)?;
        check_outputs(&[path], document)?;
    }
    let resolution = match results.json {
        true => Resolution::Bins,
        false => Resolution::Directions,
    };
    let model = evaluate_model(&config, document, resolution);
    let model = model.map_err(|error| Failure::new(error.is_usage(), error))?;
    if let Some(path) = file {
        model.write_csv(path).map_err(Failure::failed)?;
    }
    let rows = match common.quiet {
        true => model.csv(),
        false => model.commented_csv(),
    };
    match rows {
        Some(rows) if file.is_none() => print(&rows)?,
        _ => results.print_file(common, || model.summary(file), || model.report(file))?,
    }
    Ok(End::Complete)
}
