//! Merges of the shards of one run.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use asperity_simulate::{Share, StoppedBy};
use serde_json::json;

use super::Container;
use crate::case_result::Stored;
use crate::error::ResultsError;
use crate::header::first_difference;
use crate::shards::Shards;
use crate::store::Part;

impl<C: Stored> Container<'_, C> {
    /// Replaces all results by those of shards of the same run, each with the folder that it was read from. Of a case that several have, the first
    /// complete one counts.
    ///
    /// The results are then those of the whole run, or of [some shards](crate::Header::shards) if others are missing.
    ///
    /// # Errors
    /// [`ResultsError::OtherShard`] if two are of different runs or divisions, are not finished, or have surfaces or rays in common.
    pub fn merge(
        &mut self,
        shards: Vec<(impl AsRef<Path>, Container<'_, C>)>,
    ) -> Result<(), ResultsError> {
        self.clear();
        let mut merged: Option<Shards> = None;
        let mut folders = BTreeMap::new();
        for (folder, shard) in shards {
            let refused = |reason: String| ResultsError::OtherShard {
                path: folder.as_ref().to_owned(),
                reason,
            };
            let difference = self.header.difference_of_run(&json!(shard.header));
            if let Some(difference) = difference {
                return Err(refused(format!("it is of another run: {difference}")));
            }
            let Some(shards) = &shard.header.shards else {
                return Err(refused("it is of a whole run".to_owned()));
            };
            if !shards.finished {
                return Err(refused(format!("{shards} is not finished: run it again")));
            }
            let all = merged.get_or_insert_with(|| Shards {
                numbers: [].into(),
                merged: true,
                ..shards.clone()
            });
            if let Some(difference) = first_difference(&shards.settings, &all.settings, "") {
                return Err(refused(format!("it is of another run: {difference}")));
            }
            if all.of != shards.of {
                let reason = format!("it is one of {} shards in place of {}", shards.of, all.of);
                return Err(refused(reason));
            }
            for &number in &shards.numbers {
                if let Some(other) = folders.insert(number, folder.as_ref().to_owned()) {
                    let other = asperity_io::shown_path(&other);
                    let reason = format!("shard {number}/{} is in {other} too", all.of);
                    return Err(refused(reason));
                }
                all.numbers.insert(number);
            }
            self.add_shard(shard).map_err(refused)?;
        }
        self.header.shards = merged.filter(|shards| shards.missing().next().is_some());
        if self.header.shards.is_some() {
            self.division.share = Share::NOTHING;
            self.stopped_by = Some(StoppedBy::Shards);
        }
        Ok(())
    }

    /// Removes all cases and parts.
    fn clear(&mut self) {
        self.cases.clear();
        let mut state = self.store.state();
        state.hold_parts();
        state.parts.clear();
        state.is_changed = true;
    }

    /// Adds the cases and finished parts of a shard.
    fn add_shard(&mut self, mut shard: Container<'_, C>) -> Result<(), String> {
        self.header.machine.seconds += shard.header.machine.seconds;
        self.make_room(shard.cases.len());
        if self.thumbnail.is_none() {
            self.thumbnail = shard.thumbnail.take();
        }
        for (number, case) in std::mem::take(&mut shard.cases).into_iter().enumerate() {
            let Some(case) = case.filter(|_| !self.is_complete(number)) else {
                continue;
            };
            let case = Arc::unwrap_or_clone(case);
            self.add(number, case);
        }
        let mut of_shard = shard.store.state();
        of_shard.hold_parts();
        let mut state = self.store.state();
        state.is_changed = true;
        for (key, part) in std::mem::take(&mut of_shard.parts) {
            let Part::Held(surface) = part else { continue };
            match state.parts.get_mut(&key) {
                None => {
                    state.parts.insert(key, Part::Held(surface));
                }
                // Each shard draws the surfaces of the pilot run by itself.
                Some(_) if key.is_of_pilot() => {}
                Some(Part::Held(known)) => {
                    if !known.merge(*surface) {
                        return Err("it has rays in common with another shard".to_owned());
                    }
                }
                Some(Part::Journal(_)) => {}
            }
        }
        Ok(())
    }
}
