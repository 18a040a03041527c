//! The command line tool of Hodograph: models to equations, states to numbers, collisions to outcomes.

use std::process::ExitCode;

use clap::Parser;

mod commands;
mod import;
mod json;
mod output;
mod plot;
mod spelling;
mod stop;
mod surface;

/// Impact with friction in three dimensions, and equations of motion generated from model files
///
/// Results go to standard output, everything else to standard error. Exit code 0: done; 1: a mistake in a model, a state
/// or a collision, or a check that failed; 2: the call was wrong.
#[derive(Parser)]
#[command(name = "hodograph", version, max_term_width = 110)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Solve(commands::solve::Arguments),
    Plot(commands::plot::Arguments),
    Import(commands::import::Arguments),
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Solve(arguments) => commands::solve::run(&arguments),
        Command::Plot(arguments) => commands::plot::run(&arguments),
        Command::Import(arguments) => commands::import::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(stop) => stop.report(),
    }
}
