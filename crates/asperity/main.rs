//! The program `asperity`: hands its arguments to the command line.

mod examples;
mod system;

use std::process::ExitCode;

fn main() -> ExitCode {
    system::refuse_large_files();
    ExitCode::from(asperity_cli::run(
        std::env::args_os().collect(),
        &examples::EXAMPLES,
    ))
}
