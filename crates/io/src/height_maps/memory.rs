//! Height maps in memory, which readers find by a path as if they were files.
//!
//! Programs that embed this one give surfaces so: a configuration names its surfaces by path.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use asperity_surface::RawHeightMap;
use md5::{Digest, Md5};

/// The height maps in memory, each with the number of its owners.
static MAPS: Mutex<BTreeMap<PathBuf, (RawHeightMap, usize)>> = Mutex::new(BTreeMap::new());

fn maps() -> MutexGuard<'static, BTreeMap<PathBuf, (RawHeightMap, usize)>> {
    // An owner is added or removed in one step
    MAPS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Height map in memory that [`read_height_map`](crate::read_height_map) finds by its path, until it is dropped.
///
/// # Examples
/// ```
/// use asperity_io::{MemoryHeightMap, read_height_map};
/// use asperity_surface::RawHeightMap;
///
/// let map = RawHeightMap::new(vec![0.0, 1.0, 2.0, 3.0], [2, 2], [0.5, 0.5])?;
/// let kept = MemoryHeightMap::new(map);
/// assert_eq!(read_height_map(kept.path())?.shape(), [2, 2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct MemoryHeightMap {
    path: PathBuf,
}

impl MemoryHeightMap {
    /// Keeps a height map. Its path follows from its heights and all that is known of them, so that equal ones have equal paths.
    #[must_use]
    pub fn new(map: RawHeightMap) -> Self {
        let mut hash = Md5::new();
        let known = (map.shape(), map.spacing(), map.spacing_is_known(), map.unit);
        let others = (map.y_is_north, map.border, &map.turned_cells, &map.notes);
        hash.update(format!("{known:?} {others:?} {:?}", map.provenance));
        for row in map.heights().chunks(map.shape()[1]) {
            let bytes: Vec<u8> = row.iter().flat_map(|height| height.to_le_bytes()).collect();
            hash.update(bytes);
        }
        let hash = hash.finalize();
        let digits = hash.iter().take(8).map(|byte| format!("{byte:02x}"));
        let path = PathBuf::from(format!("surface-{}.npy", digits.collect::<String>()));
        maps().entry(path.clone()).or_insert((map, 0)).1 += 1;
        Self { path }
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for MemoryHeightMap {
    fn drop(&mut self) {
        let mut maps = maps();
        if let Some((_, owners)) = maps.get_mut(&self.path) {
            *owners -= 1;
            if *owners == 0 {
                maps.remove(&self.path);
            }
        }
    }
}

/// The height map in memory that has this path; its heights are shared.
pub(super) fn found(path: &Path) -> Option<RawHeightMap> {
    maps().get(path).map(|(map, _)| map.clone())
}
