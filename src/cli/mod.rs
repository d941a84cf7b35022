//! The command line: arguments and printing, nothing else. One file a subcommand.

mod accuracy;
mod bench;
mod diff;
mod failure;
mod images;
mod inspect;
mod interrupt;
mod json;
mod load;
mod memory;
mod options;
mod profile;
mod progress;
mod render;
mod stats;
mod summary;
mod system;
mod text;
mod until;
mod values;

use clap::{Parser, Subcommand};
use failure::Failure;
use std::process::ExitCode;

/// A data-oriented wavefront path tracer for CPUs.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100, arg_required_else_help = true)]
#[command(
    after_help = "Exit codes: 0 done; 2 wrong input or usage; 3 slower (bench); 130 interrupted; 1 anything else."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Render(Box<render::Args>),
    Inspect(inspect::Args),
    Accuracy(Box<accuracy::Args>),
    Diff(diff::Args),
    Bench(bench::Args),
    Profile(Box<profile::Args>),
}

/// Runs the command line of this process.
pub(crate) fn main() -> ExitCode {
    // Usage errors, --help and --version end here, with exit code 2, 0 and 0.
    let cli = Cli::parse();
    let run = || match &cli.command {
        Command::Render(args) => render::run(args),
        Command::Inspect(args) => inspect::run(args),
        Command::Accuracy(args) => accuracy::run(args),
        Command::Diff(args) => diff::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Profile(args) => profile::run(args),
    };
    let result = std::panic::catch_unwind(run).unwrap_or_else(|_| Err(Failure::defect()));
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            ExitCode::from(failure.code())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_argument_definitions_are_consistent() {
        Cli::command().debug_assert();
    }
}
