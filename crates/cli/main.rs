//! asperity: light on explicit rough surfaces, against the statistical models.

mod args;
mod attenuation;
mod converge;
mod failure;
mod generate;
mod gonio;
mod input;
mod inspect;
mod interrupt;
mod map;
mod mesh;
mod model;
mod output;
mod progress;
mod render;
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
        Err(error) if error.use_stderr() && !is_help(&error) => {
            return Failure::usage(one_sentence(&error.render().to_string())).report();
        }
        // Help and version are no errors; clap knows where they go.
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

/// Whether clap shows its help because no command was given.
fn is_help(error: &clap::Error) -> bool {
    error.kind() == clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
}

/// What clap has to say, without its heading, usage and hints, in one line.
fn one_sentence(message: &str) -> String {
    let sentences: Vec<String> = message
        .split("\n\n")
        .filter(|part| !part.starts_with("Usage:") && !part.starts_with("For more information"))
        .map(|part| part.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    let sentence = sentences.join("; ");
    sentence
        .strip_prefix("error: ")
        .unwrap_or(&sentence)
        .to_owned()
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    set_threads(&arguments.common)?;
    let common = &arguments.common;
    match &arguments.command {
        Command::Generate(command) => generate::run(command, common),
        Command::Inspect(command) => inspect::run(command, common),
        Command::Mesh(command) => mesh::run(command, common),
        Command::Trace(command) => trace::run(command, common),
        Command::Render(command) => render::run(command, common),
        Command::Verify(command) => verify::run(command, common),
        Command::Map(command) => map::run(command, common),
        Command::Gonio(command) => gonio::run(command, common),
        Command::Converge(command) => converge::run(command, common),
        Command::Attenuation(command) => attenuation::run(command, common),
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
