//! `asperity report`: results as a page.

use std::path::{Path, PathBuf};

use asperity_io::{check_ending, shown_path, write_bytes};
use asperity_page::{Page, PageError};
use asperity_studies::OneOrMany;
use asperity_studies::settings::Document;
use serde::Deserialize;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::print;
use crate::output_files::check_outputs;

/// Configuration of the command.
#[derive(Deserialize)]
struct ReportConfig {
    report: Selection,
}

#[derive(Deserialize)]
struct Selection {
    folders: Option<OneOrMany<PathBuf>>,
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let config: ReportConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let output = results.required();
    check_page(&output, document)?;
    let folders = config.report.folders.as_ref();
    let folders = folders.map_or(&[][..], OneOrMany::as_slice);
    let bytes = write_page(folders, &output, common)?;
    if !common.quiet {
        print(&format!(
            "{}: {} kB\n",
            shown_path(&output),
            bytes.div_ceil(1000)
        ))?;
    }
    Ok(End::Complete)
}

/// Refuses, before any work, a page that cannot be written.
pub(crate) fn check_page(output: &Path, document: &Document) -> Result<(), Failure> {
    check_ending(output, "pages", &["html"]).map_err(Failure::usage)?;
    check_outputs(&[output], document)
}

/// Writes the page of result folders, and returns its length in bytes.
pub(crate) fn write_page(
    folders: &[impl AsRef<Path>],
    output: &Path,
    common: &Common,
) -> Result<usize, Failure> {
    let failed = |error: PageError| Failure::new(error.is_usage(), error);
    let page = Page::of(folders).map_err(failed)?;
    page.check_output(output).map_err(failed)?;
    let html = page.html().map_err(failed)?;
    write_bytes(output, html.as_bytes()).map_err(Failure::failed)?;
    common.say(|| format!("{} written", shown_path(output)));
    Ok(html.len())
}
