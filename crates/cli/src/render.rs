//! `asperity render`: a picture of one surface.

use std::path::{Path, PathBuf};

use asperity_io::{PictureFormat, check_ending};
use asperity_simulate::{Observer, counted};
use asperity_studies::settings::Document;
use asperity_studies::{RenderConfig, RenderPlan};

use crate::common::Common;
use crate::end::{Again, End, EndedRun, stopped_without_results};
use crate::failure::Failure;
use crate::output::print;
use crate::output_files::check_outputs;
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config = RenderConfig::new(document).map_err(refused)?;
    let outputs = config.picture.output.as_slice().iter();
    let mut outputs: Vec<&Path> = outputs.map(PathBuf::as_path).collect();
    for path in &outputs {
        PictureFormat::from_path(path).map_err(Failure::usage)?;
    }
    if let Some(path) = &config.picture.error_image {
        check_ending(path, "error images", &["png", "svg"]).map_err(Failure::usage)?;
        outputs.push(path);
    }
    check_outputs(&outputs, document)?;
    let progress = Progress::new(common);
    let plan = RenderPlan::new(&config, document, &progress).map_err(refused)?;

    progress.begin_run();
    let rendered = plan.render(&progress).map_err(|error| match error {
        error if error.is_stopped() => {
            stopped_without_results(progress.stop(), &error, "nothing is written")
        }
        error => refused(error),
    })?;
    let ended = EndedRun {
        stopped_by: rendered.outcome.stopped_by,
        so_far: &format!(
            "the picture of {} per pixel is written",
            counted(rendered.outcome.samples, "camera ray")
        ),
        again: Again::Restarts,
    };
    let end = ended.close(None)?;
    if !common.quiet {
        print(&rendered.text())?;
    }
    Ok(end)
}
