//! Light on one given surface: what a run of it resumes from.

use asperity_io::ResultFolder;
use asperity_simulate::Shape;
use serde_json::json;

use crate::config::trace::TraceConfig;
use crate::output::{CheckpointError, SurfaceCheckpoints, shape_hash};

impl TraceConfig {
    /// What an earlier run of this configuration on this `surface` has left in `folder`. The time that a run is given
    /// and its plots do not belong to it.
    ///
    /// # Errors
    /// [`CheckpointError`] if a checkpoint cannot be read, or is of another results epoch, of other settings or of
    /// another surface.
    pub fn checkpoints<'a>(
        &self,
        folder: &'a ResultFolder,
        surface: &Shape,
    ) -> Result<SurfaceCheckpoints<'a>, CheckpointError> {
        let mut settings = self.clone();
        settings.run.max_time = None;
        settings.output.plots = true;
        let mut settings = json!(settings);
        settings["points"] = shape_hash(surface);
        SurfaceCheckpoints::open(folder, "trace", settings)
    }
}
