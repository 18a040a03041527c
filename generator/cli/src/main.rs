//! The command line tool of Hodograph: checks and derives models, evaluates them in states, solves
//! collisions, simulates motions.

use std::process::ExitCode;

use clap::Parser;

mod answers;
mod commands;
mod derivation;
mod evaluate;
mod export;
mod expression;
mod files;
mod findings;
mod import;
mod inline;
mod interrupt;
mod json;
mod lsp;
mod model;
mod output;
mod plot;
mod spelling;
mod state_arguments;
mod stop;
mod surface;
mod table;

use commands::{
    check, collide, completions, contacts, derive, derive_worker, eval, expand, explain,
    export as export_library, fit, fmt, gradient, import as import_urdf, lsp as language_server, new, orbit,
    plot as draw, serve, simulate, solve, validate,
};

/// Impact with friction in three dimensions, and equations of motion generated from model files
///
/// Results go to standard output, everything else to standard error. Exit code 0: done; 1: a mistake in a
/// model, a state or a collision, or a check that failed; 2: the call was wrong.
#[derive(Parser)]
#[command(name = "hodograph", version, max_term_width = 110)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    New(new::Arguments),
    Check(check::Arguments),
    Fmt(fmt::Arguments),
    Lsp(language_server::Arguments),
    Serve(serve::Arguments),
    Simulate(Box<simulate::Arguments>),
    Gradient(Box<gradient::Arguments>),
    Orbit(Box<orbit::Arguments>),
    Fit(Box<fit::Arguments>),
    Validate(validate::Arguments),
    Eval(eval::Arguments),
    Collide(collide::Arguments),
    Plot(draw::Arguments),
    Explain(explain::Arguments),
    Derive(derive::Arguments),
    Expand(expand::Arguments),
    Export(export_library::Arguments),
    Import(import_urdf::Arguments),
    Solve(solve::Arguments),
    Contacts(contacts::Arguments),
    Completions(completions::Arguments),
    Man(completions::ManArguments),
    #[command(name = derivation::WORKER, hide = true)]
    DeriveWorker(derive_worker::Arguments),
}

fn main() -> ExitCode {
    interrupt::clean_up();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(answer) => return output::answer(&answer),
    };
    let outcome = match arguments.command {
        Command::New(arguments) => new::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Man(arguments) => completions::run_man(&arguments),
        Command::Solve(arguments) => solve::run(&arguments),
        Command::Contacts(arguments) => contacts::run(&arguments),
        Command::Eval(arguments) => eval::run(&arguments),
        Command::Collide(arguments) => collide::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Fmt(arguments) => fmt::run(&arguments),
        Command::Lsp(arguments) => language_server::run(&arguments),
        Command::Derive(arguments) => derive::run(&arguments),
        Command::Expand(arguments) => expand::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Export(arguments) => export_library::run(&arguments),
        Command::Serve(arguments) => serve::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Gradient(arguments) => gradient::run(&arguments),
        Command::Orbit(arguments) => orbit::run(&arguments),
        Command::Fit(arguments) => fit::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
        Command::Plot(arguments) => draw::run(&arguments),
        Command::Import(arguments) => import_urdf::run(&arguments),
        Command::DeriveWorker(arguments) => derive_worker::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(stop) => output::report(stop),
    }
}
