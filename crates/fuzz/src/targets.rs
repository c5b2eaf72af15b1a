//! Targets: every reader of a file.

use std::path::Path;
use std::time::Duration;

use asperity_io::{
    HeightMapFormat, MeshFormat, ResultFolder, material, read_height_map, read_journal, read_mesh,
    read_number_table, read_text,
};
use asperity_results::{Header, ResultSet, Shards, Stored, Thumbnail};
use asperity_simulate::Share;
use asperity_studies::settings::{Command, Document};
use asperity_studies::{
    AlbedoConfig, AttenuationConfig, ConvergeConfig, GonioConfig, MapConfig, TraceConfig,
    VerifyConfig,
};
use asperity_surface::{Border, MissingPolicy};

/// Folder of files of formats that are only read, `SMALL_FILES` of the tests of `asperity-io`.
const SEEDS: &str = "crates/fuzz/seeds";
const MATERIALS: &str = "crates/io/materials";
const EXAMPLES: &str = "examples";

/// Header of the results among the seeds.
pub(crate) fn seed_header() -> Header {
    Header::new("verify", 7, "seed".into())
}

/// Result of a reader, or the text of its error.
type Read = Result<(), String>;

/// A reader and the file that it reads.
#[derive(Clone, Debug)]
pub struct Target {
    /// Name in the table.
    pub name: &'static str,
    /// Name of the file.
    pub file: String,
    /// The reader of a file of that name.
    pub read: fn(&Path) -> Read,
    /// Folders of seeds in the repository, besides those that [`write_seeds`](crate::write_seeds) makes.
    pub folders: &'static [&'static str],
    /// Endings of seeds.
    pub endings: &'static [&'static str],
}

fn target(
    name: &'static str,
    file: &str,
    read: fn(&Path) -> Read,
    folders: &'static [&'static str],
    endings: &'static [&'static str],
) -> Target {
    let file = file.to_owned();
    Target {
        name,
        file,
        read,
        folders,
        endings,
    }
}

/// All targets: formats by themselves, as soon as they are read.
#[must_use]
pub fn targets() -> Vec<Target> {
    let formats = HeightMapFormat::ALL.into_iter();
    let maps = formats.filter(|format| format.can_read()).map(|format| {
        let endings = format.endings();
        let file = format!("in.{}", endings[0]);
        target(endings[0], &file, height_map, &[SEEDS], endings)
    });
    let meshes = MeshFormat::ALL.map(|format| match format {
        MeshFormat::Ply => target("ply", "in.ply", mesh, &[SEEDS], &["ply"]),
        MeshFormat::Obj => target("obj", "in.obj", mesh, &[SEEDS], &["obj"]),
        _ => target("stl", "in.stl", mesh, &[SEEDS], &["stl"]),
    });
    let others = [
        target("record", "in.yml", of_material, &[MATERIALS], &["yml"]),
        target("constants", "in.csv", of_material, &[SEEDS], &["csv"]),
        target("numbers", "in.csv", numbers, &[SEEDS], &["csv"]),
        target("config", "in.toml", config, &[EXAMPLES], &["toml"]),
        target("manifest", "manifest.json", manifest, &[], &["json"]),
        target("results", "results.npz", results, &[], &["npz"]),
        target("journal", "results.journal", journal, &[], &["journal"]),
        target("resumed", "results.journal", resumed, &[], &["journal"]),
        target("replaced", "results.npz", resumed, &[], &["npz"]),
        target("merged", "results.npz", merged, &[], &["npz"]),
    ];
    maps.chain(meshes).chain(others).collect()
}

/// Targets that fail in every way that is to be found; for the test of the program.
#[must_use]
pub fn broken() -> Vec<Target> {
    let broken = |name, read| target(name, "in.csv", read, &[SEEDS], &["csv"]);
    vec![
        broken("broken-panic", no_nines),
        broken("broken-text", |_| Err("two\nlines".to_owned())),
        broken("broken-memory", |_| {
            drop(std::hint::black_box(vec![1_u8; 1 << 30]));
            Ok(())
        }),
        broken("broken-hang", |_| {
            std::thread::sleep(Duration::from_secs(60));
            Ok(())
        }),
    ]
}

fn no_nines(path: &Path) -> Read {
    let text = read_text(path).map_err(words)?;
    assert!(!text.contains('9'), "a nine");
    Ok(())
}

fn words(error: impl ToString) -> String {
    error.to_string()
}

fn height_map(path: &Path) -> Read {
    let map = read_height_map(path).map_err(words)?;
    let field = map.into_height_field(MissingPolicy::Fill, Border::Open);
    field.map(drop).map_err(words)
}

fn mesh(path: &Path) -> Read {
    read_mesh(path).map(drop).map_err(words)
}

fn of_material(path: &Path) -> Read {
    let found = material(&path.to_string_lossy()).map_err(words)?;
    found.constants.at(0.55).map(drop).map_err(words)
}

fn numbers(path: &Path) -> Read {
    read_number_table(path).map(drop).map_err(words)
}

/// A configuration, read for each command that has one.
fn config(path: &Path) -> Read {
    let text = read_text(path).map_err(words)?;
    let mut refusal = None;
    for command in Command::ALL {
        if !command.has_configuration() {
            continue;
        }
        let mut document = Document::new(command);
        let added = document.add_file(Some("in.toml"), &text);
        let read = added.and_then(|()| match command {
            Command::Trace => document.read::<TraceConfig>().map(drop),
            Command::Map => document.read::<MapConfig>().map(drop),
            Command::Gonio => document.read::<GonioConfig>().map(drop),
            Command::Albedo => document.read::<AlbedoConfig>().map(drop),
            Command::Converge => document.read::<ConvergeConfig>().map(drop),
            Command::Attenuation => document.read::<AttenuationConfig>().map(drop),
            _ => document.read::<VerifyConfig>().map(drop),
        });
        match read {
            Ok(()) => return Ok(()),
            Err(error) => refusal = Some(error.to_string()),
        }
    }
    refusal.map_or(Ok(()), Err)
}

fn folder_of(path: &Path) -> Result<ResultFolder, String> {
    let folder = path.parent().unwrap_or(path);
    ResultFolder::open(folder, "verify", &[]).map_err(words)
}

fn manifest(path: &Path) -> Read {
    folder_of(path)?.check(["summary.json"]).map_err(words)
}

/// A file of results, as `export` and `report` read it.
fn results(path: &Path) -> Read {
    Header::read(path).map_err(words)?;
    Thumbnail::read(path).map_err(words)?;
    let set = ResultSet::read(path).map_err(words)?;
    for (_, case) in set.cases() {
        case.columns();
    }
    set.comparable_bytes().map(drop).map_err(words)
}

/// The journal of a killed run, as `export` and `report` read it.
fn journal(path: &Path) -> Read {
    read_journal(path).map_err(words)?;
    let set = ResultSet::read(path.parent().unwrap_or(path)).map_err(words)?;
    set.comparable_bytes().map(drop).map_err(words)
}

/// Results of an earlier run, as the same command resumes them.
fn resumed(path: &Path) -> Read {
    let folder = folder_of(path)?;
    let set = ResultSet::open(&folder, seed_header()).map_err(words)?;
    match set.notes() {
        [] => set.comparable_bytes().map(drop).map_err(words),
        [note, ..] => Err(note.clone()),
    }
}

/// Results taken as the only shard of a run, and as both of two, which have surfaces in common, as `merge` puts them together.
fn merged(path: &Path) -> Read {
    let merge = |of: u64| {
        let shard = |number| {
            let mut set = ResultSet::read(path).map_err(words)?;
            let share = Share::new(number, of).ok_or("no such share")?;
            set.header.shards = Some(Shards {
                finished: true,
                ..Shards::one(share, set.header.document.clone(), Default::default())
            });
            Ok::<_, String>((path, set))
        };
        let shards = (1..=of).map(shard).collect::<Result<Vec<_>, _>>()?;
        let mut all = ResultSet::in_memory(Header {
            shards: None,
            ..shards[0].1.header.clone()
        });
        all.merge(shards).map_err(words)?;
        all.comparable_bytes().map(drop).map_err(words)
    };
    let _ = merge(2);
    merge(1)
}
