//! The command `hodograph-sweep`.

use std::process::ExitCode;

use clap::Parser;
use hodograph_sweeps::arguments::{Arguments, Command, cores};
use hodograph_sweeps::failure::Failure;
use hodograph_sweeps::{cluster, describe, output, run};

/// Deep plans are deep recursions.
const STACK: usize = 16 << 20;

fn main() -> ExitCode {
    match act(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.status())
        }
    }
}

fn runtime(threads: usize) -> Result<tokio::runtime::Runtime, Failure> {
    let mut builder = tokio::runtime::Builder::new_multi_thread();
    builder.worker_threads(threads).thread_stack_size(STACK).enable_all();
    builder.build().map_err(|error| Failure::Engine(error.to_string()))
}

fn act(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run(given) => match given.sweep()? {
            Ok(sweep) => runtime(sweep.setup.cores)?.block_on(run::run(&sweep)),
            Err(sql) => {
                println!("{sql}");
                Ok(())
            }
        },
        Command::Functions { model, name } => {
            println!("{}", describe::functions(&model, name.as_deref())?);
            Ok(())
        }
        Command::Verify { files } => verify(&files),
        Command::Scheduler { listen, host, patience } => {
            let host = host.unwrap_or_else(|| listen.ip().to_string());
            let given = cluster::Scheduler { listen, host, patience };
            runtime(cores(None)?)?.block_on(cluster::scheduler(&given))
        }
        Command::Executor { scheduler, listen, host, cores: given, memory, work } => {
            let threads = cores(given)?;
            let host = host.unwrap_or_else(|| listen.ip().to_string());
            let work = work.unwrap_or_else(|| {
                std::env::temp_dir().join(format!("hodograph-sweep-{}-{}", listen.port(), std::process::id()))
            });
            let given =
                cluster::Executor { scheduler, listen, host, cores: threads, memory: memory as u64, work };
            runtime(threads + 1)?.block_on(cluster::executor(&given))
        }
    }
}

fn verify(files: &[std::path::PathBuf]) -> Result<(), Failure> {
    for file in files {
        let (stated, found) = output::digests(file)?;
        match stated {
            Some(stated) if stated == found => println!("{}: {found}, as stated", file.display()),
            Some(stated) => {
                return Err(Failure::Engine(format!(
                    "{}: the file states {stated}, its rows have {found}",
                    file.display()
                )));
            }
            None => {
                return Err(Failure::Engine(format!(
                    "{} states no digest; its rows have {found}",
                    file.display()
                )));
            }
        }
    }
    Ok(())
}
