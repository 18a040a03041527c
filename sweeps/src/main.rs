//! The command `hodograph-sweep`.

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use hodograph_sweeps::arguments::{Arguments, Command, cores};
use hodograph_sweeps::failure::Failure;
use hodograph_sweeps::keys::{self, Keys};
use hodograph_sweeps::{cluster, describe, output, run, stdout};

/// Stack size: deep plans are processed recursively.
const STACK: usize = 16 << 20;

fn main() -> ExitCode {
    match act(Arguments::parse().command) {
        Ok(()) | Err(Failure::ReaderGone) => ExitCode::SUCCESS,
        Err(failure) => {
            // the exit status reports it, too, if nobody reads the message
            let _ = writeln!(std::io::stderr(), "error: {failure}");
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
            Err(sql) => stdout::line(sql),
        },
        Command::Functions { model, name } => stdout::line(describe::functions(&model, name.as_deref())?),
        Command::Verify { files } => verify(&files),
        Command::Keys { directory } => {
            keys::make(&directory)?;
            stdout::line(format_args!(
                "keys in {}: copy the directory to every machine of the cluster, for --tls",
                directory.display()
            ))
        }
        Command::Scheduler { listen, host, patience, files, tls } => {
            let keys = tls.as_deref().map(Keys::read).transpose()?;
            let host = host.unwrap_or_else(|| listen.ip().to_string());
            let given = cluster::Scheduler { listen, host, patience, files, keys };
            runtime(cores(None)?)?.block_on(cluster::scheduler(&given))
        }
        Command::Executor { scheduler, listen, host, cores: given, memory, work, tls } => {
            let keys = tls.as_deref().map(Keys::read).transpose()?;
            let threads = cores(given)?;
            let host = host.unwrap_or_else(|| listen.ip().to_string());
            let own = work.is_none();
            let work = work.unwrap_or_else(|| {
                std::env::temp_dir().join(format!("hodograph-sweep-{}-{}", listen.port(), std::process::id()))
            });
            let given = cluster::Executor {
                scheduler,
                listen,
                host,
                cores: threads,
                memory: memory as u64,
                work,
                keys,
            };
            let done = runtime(threads + 1)?.block_on(cluster::executor(&given));
            if own {
                // Results that nobody will fetch any more.
                let _ = std::fs::remove_dir_all(&given.work);
            }
            done
        }
    }
}

fn verify(files: &[std::path::PathBuf]) -> Result<(), Failure> {
    for file in files {
        let (stated, found) = output::digests(file)?;
        match stated {
            Some(stated) if stated == found => {
                match stdout::line(format_args!("{}: {found}, as stated", file.display())) {
                    // the exit status covers all files, even if nobody reads the messages
                    Ok(()) | Err(Failure::ReaderGone) => {}
                    Err(failure) => return Err(failure),
                }
            }
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
