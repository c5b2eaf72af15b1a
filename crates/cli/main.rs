//! asperity: light on explicit rough surfaces, against the statistical models.

mod args;
mod failure;
mod generate;
mod input;
mod inspect;
mod mesh;
mod model;
mod output;
mod progress;
mod text;
mod trace;
mod verify;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Arguments, Command, Common};
use crate::failure::Failure;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        // Help and version are no errors; clap knows where each goes and its exit code.
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    set_threads(&arguments.common)?;
    let common = &arguments.common;
    match &arguments.command {
        Command::Generate(command) => generate::run(command, common),
        Command::Inspect(command) => inspect::run(command, common),
        Command::Mesh(command) => mesh::run(command, common),
        Command::Trace(command) => trace::run(command, common),
        Command::Verify(command) => verify::run(command, common),
        Command::Model(command) => model::run(command, common),
    }
}

fn set_threads(common: &Common) -> Result<(), Failure> {
    let mut builder = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = common.threads {
        builder = builder.num_threads(threads);
    }
    builder.build_global().map_err(|error| {
        Failure::failed(format!(
            "the threads could not be started ({error}); take fewer with --threads"
        ))
    })
}
