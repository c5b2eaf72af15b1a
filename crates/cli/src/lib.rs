//! The command line of asperity: parses arguments, runs the command, prints, and ends in an exit code.
//!
//! A library, so that other programs can run it as a whole, such as an extension module of Python.

mod command_line;
mod common;
mod end;
mod export;
mod failure;
mod file_set;
mod generate;
mod help;
mod inspect;
mod interrupt;
mod man_sections;
mod materials;
mod merge;
mod mesh;
mod model;
mod output;
mod output_files;
mod progress;
mod render;
mod report;
mod study;
mod tools;

use std::ffi::OsString;

use asperity_io::shown;
use asperity_numerics::vector::Instructions;
use asperity_studies::settings::{Command, Document};
use asperity_studies::{
    AlbedoStudy, AttenuationStudy, ConvergeStudy, GonioStudy, MapStudy, TraceStudy, VerifyStudy,
};

use crate::command_line::{Request, Stop, parse, program};
use crate::common::Common;
use crate::end::End;
use crate::failure::Failure;
use crate::output::{keep_arguments, say_notes};
pub use crate::tools::Example;
use crate::tools::keep_examples;

/// Runs the command that `arguments` name, the name of the program first, and returns the exit code.
///
/// To be called once per process: it sets the number of threads and handles interrupts, the second of which ends the
/// process. `examples`: those that `asperity example` writes. Prints on standard output and standard error.
pub fn run(arguments: Vec<OsString>, examples: &'static [Example]) -> u8 {
    keep_arguments(&arguments);
    keep_examples(examples);
    let request = match parse(arguments) {
        Ok(request) => request,
        Err(Stop::Failure(failure)) => return failure.report(),
        // Help and version are no errors; clap knows where they go.
        Err(Stop::Shown(text)) => {
            let _ = text.print();
            return u8::try_from(text.exit_code()).unwrap_or(2);
        }
    };
    let done = match request {
        Request::Run(document) => run_command(&document),
        Request::Tool(tool) => tool.run(program(true)).map(|()| End::Complete),
    };
    match done {
        Ok(end) => end.code(),
        Err(failure) => failure.report(),
    }
}

fn run_command(document: &Document) -> Result<End, Failure> {
    let common = &Common::of(document).map_err(Failure::usage)?;
    document.check_required().map_err(Failure::usage)?;
    Instructions::requested().map_err(|name| {
        let (variable, name) = (Instructions::VARIABLE, shown(&name));
        Failure::usage(format!(
            "invalid {variable} {name}: must be portable, avx2 or avx512, and available on this machine"
        ))
    })?;
    say_notes(document.notes());
    interrupt::handle();
    set_threads(common)?;
    match document.command() {
        Command::Generate => generate::run(document, common),
        Command::Inspect => inspect::run(document, common),
        Command::Mesh => mesh::run(document, common),
        Command::Trace => study::run::<TraceStudy>(document, common),
        Command::Render => render::run(document, common),
        Command::Verify => study::run::<VerifyStudy>(document, common),
        Command::Map => study::run::<MapStudy>(document, common),
        Command::Gonio => study::run::<GonioStudy>(document, common),
        Command::Albedo => study::run::<AlbedoStudy>(document, common),
        Command::Converge => study::run::<ConvergeStudy>(document, common),
        Command::Attenuation => study::run::<AttenuationStudy>(document, common),
        Command::Model => model::run(document, common),
        Command::Materials => materials::run(document, common),
        Command::Export => export::run(document, common),
        Command::Report => report::run(document, common),
        Command::Merge => merge::run(document, common),
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
