//! Seeds: the small files of the repository, and what writers and a run write.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_io::{Journal, MeshView, ResultFolder, write_bytes, write_height_map, write_mesh};
use asperity_optics::{Incidence, Material};
use asperity_results::ResultSet;
use asperity_simulate::{
    Case, Effort, Light, Observer, Settings, Silent, StoppedBy, SurfaceSource,
};
use asperity_surface::LengthUnit;
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{HemisphereGrid, TallySpec};
use ciborium::Value;

use crate::targets::{Target, seed_header};

/// Stops a run after its second surface.
#[derive(Default)]
struct SecondSurface(AtomicBool);

impl Observer for SecondSurface {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn surface_drawn(&self, number: u64) {
        self.0.fetch_or(number == 1, Ordering::Relaxed);
    }
    fn stop(&self) -> Option<StoppedBy> {
        let is_over = self.0.load(Ordering::Relaxed);
        is_over.then_some(StoppedBy::Interrupt)
    }
}

/// Writes seeds of all formats that are written into `folder`.
///
/// # Errors
/// Of writers, and of the run whose results are written.
pub fn write_seeds(folder: &Path) -> Result<(), Box<dyn Error>> {
    let synthesis = Synthesis::new(Psd::gaussian(1.0, 4.0)?, [16, 16], [1.0, 1.0], true)?;
    let surface = synthesis.draw(7, 0)?.with_unit(LengthUnit::Metre);
    for ending in ["exr", "npy", "gsf", "x3p"] {
        write_height_map(folder.join(format!("made.{ending}")), &surface)?;
    }
    let mesh = MeshView {
        vertices: &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5], [1.0, 1.0, 0.25]],
        triangles: &[[0, 1, 2], [1, 3, 2]],
        comment: "a seed",
    };
    for ending in ["ply", "obj", "stl"] {
        write_mesh(folder.join(format!("made.{ending}")), &mesh)?;
    }

    // One case that is complete, and finished surfaces of another
    let case = |theta| {
        let light = Light::from_above(Incidence::from_degrees(theta, 0.0)?);
        let surfaces = SurfaceSource::random(synthesis.clone());
        Ok::<Case, Box<dyn Error>>(Case::new(surfaces, Material::dielectric(1.5)?, light))
    };
    let settings = Settings {
        effort: Effort::Rays {
            total: 400,
            surfaces: 4,
        },
        tally: TallySpec::new(HemisphereGrid::new(2, 4)?, 0.2)?,
        ..Settings::default()
    };
    let run = tempfile::tempdir()?;
    let target = ResultFolder::open(run.path(), "verify", &[])?;
    let mut set = ResultSet::open(&target, seed_header())?;
    set.run_missing(0, &[case(30.0)?], &settings, &Silent)?;
    set.run_missing(1, &[case(60.0)?], &settings, &SecondSurface::default())?;
    let kept = ResultSet::read({
        set.close()?;
        let file = folder.join("made.npz");
        write_bytes(&file, &set.comparable_bytes()?)?;
        file
    })?;
    drop(set);
    std::fs::write(target.claim("summary.json")?, "{}\n")?;
    target.finish(false)?;
    let manifest = std::fs::read(run.path().join("manifest.json"))?;
    write_bytes(folder.join("made.json"), &manifest)?;

    let mut records = vec![serde_json::to_vec(&kept.header)?];
    for (number, case) in kept.cases() {
        let record = BTreeMap::from([("Case", (number, case))]);
        let mut bytes = Vec::new();
        ciborium::into_writer(&record, &mut bytes)?;
        records.push(bytes);
    }
    let mut archive = zip::ZipArchive::new(std::fs::File::open(folder.join("made.npz"))?)?;
    let parts: Vec<Value> = ciborium::from_reader(archive.by_name("parts.cbor")?)?;
    for part in parts {
        let mut bytes = Vec::new();
        ciborium::into_writer(&BTreeMap::from([("Part", part)]), &mut bytes)?;
        records.push(bytes);
    }
    Journal::open(folder.join("made.journal"), 0)?.append(&records)?;
    Ok(())
}

/// Contents of the seeds of a target, by name; `made` is the folder of [`write_seeds`].
pub(crate) fn seeds_of(target: &Target, made: &Path) -> std::io::Result<Vec<Vec<u8>>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folders = target.folders.iter().map(|folder| root.join(folder));
    let mut found = Vec::new();
    for folder in folders.chain([made.to_owned()]) {
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder)? {
            paths.push(entry?.path());
        }
        paths.sort();
        paths.retain(|path| {
            let ending = path.extension().and_then(|ending| ending.to_str());
            ending.is_some_and(|ending| target.endings.contains(&ending))
        });
        for path in paths {
            found.push(std::fs::read(path)?);
        }
    }
    Ok(found)
}
