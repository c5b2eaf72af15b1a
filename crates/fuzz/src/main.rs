//! Damages files and has every reader of the workspace read them; `docs/how_it_works/fuzzing.md`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program prints"
)]

use std::alloc::System;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, SystemTime};

use asperity_fuzz::{Limit, Run, Target, broken, targets, write_seeds};
use cap::Cap;

/// Longest time of an input.
const MAX_TIME: Duration = Duration::from_secs(5);

/// Memory that a reader may take. Inputs have at most 128 KiB.
const MAX_MEMORY: usize = 256 << 20;

const USAGE: &str = "usage: asperity-fuzz [--seconds N | --inputs N] [--seed S] [TARGET..]
       asperity-fuzz --replay FILE TARGET

--seconds N: time in all, divided among the targets (60)
--inputs N: inputs per target instead, the same ones for the same seed
--seed S: seed of the damage (1)
--replay FILE: reads a file that failed
";

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

/// The command line.
#[derive(Default)]
struct Options {
    seconds: Option<f64>,
    inputs: Option<u64>,
    seed: Option<u64>,
    replay: Option<PathBuf>,
    /// Folder of a process that runs one target for another process.
    worker: Option<PathBuf>,
    targets: Vec<String>,
}

impl Options {
    fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self::default();
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
            match word.as_str() {
                "--seconds" => options.seconds = Some(value()?.parse()?),
                "--inputs" => options.inputs = Some(value()?.parse()?),
                "--seed" => options.seed = Some(value()?.parse()?),
                "--replay" => options.replay = Some(value()?.into()),
                "--worker" => options.worker = Some(value()?.into()),
                flag if flag.starts_with('-') => return Err(USAGE.into()),
                _ => options.targets.push(word),
            }
        }
        Ok(options)
    }

    /// The targets that are named, or all.
    fn chosen(&self) -> Result<Vec<Target>, String> {
        if self.targets.is_empty() {
            return Ok(targets());
        }
        let known: Vec<Target> = targets().into_iter().chain(broken()).collect();
        let find = |name: &String| known.iter().find(|target| target.name == name).cloned();
        let unknown = |name: &String| {
            let names: Vec<&str> = known.iter().map(|target| target.name).collect();
            format!("unknown target {name}; targets are {}", names.join(", "))
        };
        let found = self.targets.iter();
        found
            .map(|name| find(name).ok_or_else(|| unknown(name)))
            .collect()
    }

    fn run<'a>(
        &self,
        target: &'a Target,
        count: usize,
        [made, folder, failures]: [&'a Path; 3],
    ) -> Run<'a> {
        let seconds = self.seconds.unwrap_or(60.0) / count as f64;
        Run {
            target,
            seed: self.seed.unwrap_or(1),
            limit: match self.inputs {
                Some(inputs) => Limit::Inputs(inputs),
                None => Limit::Time(Duration::from_secs_f64(seconds)),
            },
            made,
            folder,
            failures,
        }
    }
}

fn main() -> ExitCode {
    let run = || -> Result<bool, Box<dyn Error>> {
        let options = Options::parse(std::env::args().skip(1))?;
        let targets = options.chosen()?;
        match (&options.replay, &options.worker, targets.as_slice()) {
            (Some(file), _, [target]) => replay(target, file),
            (None, Some(folder), [target]) => work(&options, target, folder),
            (None, None, targets) => all(&options, targets),
            _ => Err(USAGE.into()),
        }
    };
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("asperity-fuzz: {error}");
            ExitCode::from(2)
        }
    }
}

/// Reads one file, without catching anything.
fn replay(target: &Target, file: &Path) -> Result<bool, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join(&target.file);
    std::fs::copy(file, &path)?;
    println!("{:?}", (target.read)(&path));
    Ok(true)
}

/// Runs one target, and prints its row.
fn work(options: &Options, target: &Target, folder: &Path) -> Result<bool, Box<dyn Error>> {
    let count = options.targets.len();
    let [made, input, failures] = folders(folder);
    std::fs::create_dir_all(&input)?;
    MEMORY
        .set_limit(MEMORY.allocated() + MAX_MEMORY)
        .map_err(|()| "no memory")?;
    let tally = options
        .run(target, count, [&made, &input, &failures])
        .run()?;
    println!(
        "{:<13}{:>10}{:>10}{:>10}{:>10}{:>8}{:>8}{:>9.3} s",
        target.name,
        tally.inputs,
        tally.accepted,
        tally.refused,
        tally.refusals,
        tally.caught,
        tally.panics,
        tally.longest.as_secs_f64()
    );
    for (failure, file) in &tally.failures {
        eprintln!("{}: {failure}: {}", target.name, file.display());
    }
    Ok(tally.failures.is_empty())
}

/// Folders of seeds that were made, of inputs, and of inputs that failed.
fn folders(place: &Path) -> [PathBuf; 3] {
    let failures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/fuzz");
    [place.join("made"), place.join("in"), failures]
}

/// Runs targets one after the other, each in a process of its own, and prints a table.
fn all(options: &Options, targets: &[Target]) -> Result<bool, Box<dyn Error>> {
    // In memory, where there is such a folder: a file on a disk takes milliseconds.
    let memory = Path::new("/dev/shm");
    let place = match memory.is_dir() {
        true => tempfile::tempdir_in(memory),
        false => tempfile::tempdir(),
    }?;
    let [made, input, failures] = folders(place.path());
    std::fs::create_dir(&made)?;
    // One thread, so that the surfaces that an interrupted run has finished are the same ones each time
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build_global()?;
    write_seeds(&made)?;
    println!(
        "{:<13}{:>10}{:>10}{:>10}{:>10}{:>8}{:>8}{:>11}",
        "target", "inputs", "accepted", "refused", "refusals", "caught", "panics", "longest"
    );
    let mut is_clean = true;
    for target in targets {
        let run = options.run(target, targets.len(), [&made, &input, &failures]);
        let limit = match run.limit {
            Limit::Inputs(inputs) => ["--inputs".to_owned(), inputs.to_string()],
            Limit::Time(time) => ["--seconds".to_owned(), time.as_secs_f64().to_string()],
        };
        let mut worker = Command::new(std::env::current_exe()?);
        worker.env("RUST_BACKTRACE", "0");
        worker.args([target.name, "--seed", &run.seed.to_string(), "--worker"]);
        let mut worker = worker
            .arg(place.path())
            .args(limit)
            .stdin(Stdio::null())
            .spawn()?;
        let file = input.join(&target.file);
        let ended = loop {
            if let Some(status) = worker.try_wait()? {
                break status.code().ok_or_else(|| status.to_string());
            }
            if is_older(&file, MAX_TIME) {
                worker.kill()?;
                worker.wait()?;
                break Err(format!("over {} s", MAX_TIME.as_secs()));
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        is_clean &= ended == Ok(0);
        if let Err(reason) = ended {
            println!("{:<13}{reason}: {}", target.name, run.keep(0)?.display());
        }
        let _ = std::fs::remove_dir_all(&input);
    }
    Ok(is_clean)
}

/// Returns `true` if a file was written longer ago than `time`.
fn is_older(file: &Path, time: Duration) -> bool {
    let written = std::fs::metadata(file).and_then(|found| found.modified());
    written.is_ok_and(|written| {
        let age = SystemTime::now().duration_since(written);
        age.is_ok_and(|age| age > time)
    })
}
