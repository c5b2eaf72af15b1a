//! `asperity materials`: the list of materials, or the optical constants of one.

use std::path::Path;

use asperity_io::{check_ending, shown_path};
use asperity_studies::settings::{Document, SettingError};
use asperity_studies::{MaterialsConfig, material_list, material_list_text};

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output_files::check_outputs;

/// Settings of the constants of one material, with their flags.
const OF_ONE: [(&str, &str); 3] = [
    ("materials.wavelength", "--wavelength"),
    ("results.output", "-o"),
    ("results.plot", "--plot"),
];

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let config: MaterialsConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let (table, plot) = (results.output.as_deref(), results.plot.as_deref());
    if let Some(path) = table {
        check_ending(path, "optical constants", &["csv"]).map_err(Failure::usage)?;
    }
    if let Some(path) = plot {
        check_ending(path, "plots", &["svg", "png"]).map_err(Failure::usage)?;
    }
    let found = config.sheet();
    let Some(sheet) = found.map_err(|error| Failure::new(error.is_usage(), error))? else {
        if let Some((_, flag)) = OF_ONE.iter().find(|(path, _)| document.is_given(path)) {
            return Err(Failure::usage(SettingError::Missing {
                subject: (*flag).to_owned(),
                needed: "a material, as in `asperity materials gold`".to_owned(),
            }));
        }
        let list = material_list();
        results.print_file(common, || &list, || material_list_text(&list))?;
        return Ok(End::Complete);
    };
    let outputs: Vec<&Path> = table.into_iter().chain(plot).collect();
    check_outputs(&outputs, document)?;
    if let Some(path) = table {
        sheet.write_csv(path).map_err(Failure::failed)?;
        common.say(|| format!("{} written", shown_path(path)));
    }
    if let Some(path) = plot {
        sheet.draw(path).map_err(Failure::failed)?;
        common.say(|| format!("{} drawn", shown_path(path)));
    }
    results.print_file(common, || sheet.json(), || sheet.text())?;
    Ok(End::Complete)
}
