//! Text of a picture: what was rendered, and what of its light is missing.

use std::path::PathBuf;

use asperity_io::shown_path;
use asperity_render::RenderOutcome;
use asperity_simulate::{counted, short};

use crate::output::{note_lines, wrapped};

/// A picture, and what is said of it.
pub struct RenderedPicture {
    /// The picture, its errors and missing light.
    pub outcome: RenderOutcome,
    /// Factor from radiance to the brightness of a PNG.
    pub(super) exposure: f64,
    /// Name of the surface.
    pub(super) name: String,
    /// Notes for the user on the surface and its light, one sentence each.
    pub(super) notes: Vec<String>,
    /// The files.
    pub(super) files: Vec<PathBuf>,
}

impl RenderedPicture {
    /// Text: surface, rays, radiance and exposure, then missing light, notes and files.
    #[must_use]
    pub fn text(&self) -> String {
        let outcome = &self.outcome;
        let picture = &outcome.picture;
        let [columns, rows] = picture.size;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let [build, follow] = outcome.seconds;
        let rays = outcome.samples as f64 * (columns * rows) as f64;
        let mut text = format!(
            "{}, {columns} x {rows} pixels of {}, {} rays in {:.1} s\nmean radiance {:.5}, standard error of a pixel {:.2e} on average\nexposure {:.4}\n",
            self.name,
            counted(outcome.samples, "camera ray"),
            short(rays),
            build + follow,
            mean(&picture.radiance),
            mean(&picture.error),
            self.exposure,
        );
        for (fraction, end) in [
            (outcome.truncated, "was truncated by a limit of the paths"),
            (outcome.left_patch, "left the open patch past its rim"),
            (outcome.lost, "failed numerically"),
        ] {
            if fraction > 0.0 {
                text.push_str(&format!(
                    "note: a fraction of {fraction:.1e} of the light {end} and is missing from the picture\n"
                ));
            }
        }
        text.push_str(&note_lines(&self.notes));
        for path in &self.files {
            text.push_str(&format!("picture in {}\n", shown_path(path)));
        }
        wrapped(&text)
    }
}
