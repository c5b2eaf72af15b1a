//! `asperity render`: a picture of one surface.

use std::path::{Path, PathBuf};

use asperity_io::{PictureFormat, write_picture};
use asperity_simulate::counted;
use asperity_studies::settings::Document;
use asperity_studies::{RenderConfig, RenderPlan, wrapped};

use crate::common::Common;
use crate::end::{Again, End, EndedRun};
use crate::failure::Failure;
use crate::output::{note_lines, print};
use crate::output_files::check_outputs;
use crate::progress::Progress;

/// Comment on the channels of an EXR.
const COMMENT: &str = "Y: radiance, linear, in the unit in which the lights were given; error: its standard error, NaN where unknown; A: fraction of the pixel that shows the surface";

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config = RenderConfig::new(document).map_err(refused)?;
    let outputs = config.picture.output.as_slice().to_vec();
    for path in &outputs {
        PictureFormat::from_path(path).map_err(Failure::usage)?;
    }
    let paths: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    check_outputs(&paths, document)?;
    let progress = Progress::new(common);
    let plan = RenderPlan::new(config, document, &progress).map_err(refused)?;

    progress.begin_run();
    let rendered = plan.render(&progress).map_err(refused)?;
    let outcome = &rendered.outcome;
    for path in &outputs {
        write_picture(path, &outcome.picture, rendered.exposure, COMMENT)
            .map_err(Failure::failed)?;
    }
    let ended = EndedRun {
        stopped_by: outcome.stopped_by,
        so_far: &format!(
            "the picture of {} per pixel is written",
            counted(outcome.samples, "camera ray")
        ),
        again: Again::Restarts,
    };
    let end = ended.close(None)?;
    if common.quiet {
        return Ok(end);
    }
    let mut text = rendered.text() + &note_lines(rendered.notes());
    for path in &outputs {
        text.push_str(&format!("picture in {}\n", path.display()));
    }
    print(&wrapped(&text))?;
    Ok(end)
}
