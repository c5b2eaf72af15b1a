//! Text of a picture: what was rendered, and what of its light is missing.

use std::path::PathBuf;

use asperity_io::shown_path;
use asperity_render::{RenderOutcome, ToneCurve};
use asperity_simulate::{counted, short};

use super::files::{shown_quantity, tone_name};
use crate::output::{note_lines, wrapped};

/// A picture, and what is said of it.
pub struct RenderedPicture {
    /// The picture, its errors and missing light.
    pub outcome: RenderOutcome,
    /// Curve from radiance to the brightness of a PNG.
    pub(super) tone: ToneCurve,
    /// `true` if the picture is denoised.
    pub(super) denoised: bool,
    /// Wavelengths that were rendered, one at least.
    pub(super) wavelengths: usize,
    /// Name of the surface.
    pub(super) name: String,
    /// Notes for the user on the surface and its light, one sentence each.
    pub(super) notes: Vec<String>,
    /// The files of the picture.
    pub(super) files: Vec<PathBuf>,
    /// The figure of its errors, if it is requested.
    pub(super) error_image: Option<PathBuf>,
}

impl RenderedPicture {
    /// Text: surface, rays, radiance, tone and exposure, then missing light, notes and files.
    #[must_use]
    pub fn text(&self) -> String {
        let outcome = &self.outcome;
        let picture = &outcome.picture;
        let [columns, rows] = picture.size;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let [build, follow] = outcome.seconds;
        let rays = outcome.samples as f64 * (columns * rows * self.wavelengths) as f64;
        let each = match self.wavelengths {
            1 => String::new(),
            count => format!(" at each of {count} wavelengths"),
        };
        let mut text = format!(
            "{}, {columns} x {rows} pixels of {}{each}, {} rays in {:.1} s\nmean {} {:.5}, standard error of a pixel {:.2e} on average\n{}\n",
            self.name,
            counted(outcome.samples, "camera ray"),
            short(rays),
            build + follow,
            match picture.colour {
                Some(_) => "luminance",
                None => "radiance",
            },
            mean(&picture.radiance),
            mean(&picture.error),
            self.brightness(),
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
        if let Some(path) = &self.error_image {
            text.push_str(&format!("errors in {}\n", shown_path(path)));
        }
        wrapped(&text)
    }

    /// Tone, exposure, white and clipping of a PNG, and whether the picture is denoised.
    fn brightness(&self) -> String {
        let mut text = format!(
            "tone {}, exposure {}, white is {} {}",
            tone_name(self.tone.tone),
            short(self.tone.exposure),
            shown_quantity(&self.outcome.picture),
            short(self.tone.white)
        );
        let clipped = self.tone.clipped(&self.outcome.picture);
        if clipped > 0.0 {
            text += &format!(", {} % of the pixels are clipped", short(100.0 * clipped));
        }
        if self.denoised {
            text += "\ndenoised by non-local means; the standard error is that before";
        }
        text
    }
}
