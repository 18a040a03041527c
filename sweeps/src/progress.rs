//! Reports the progress of a sweep on standard error: the completed part, rows per second and the remaining
//! time.

use std::io::{IsTerminal, Write};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use crate::rows::COUNTED;

/// The progress of a sweep with a number of rows.
#[derive(Clone, Debug)]
pub struct Progress {
    started: Instant,
    total: u64,
    quiet: bool,
}

/// A time span for readers.
pub fn span(seconds: f64) -> String {
    match seconds {
        ..90.0 => format!("{seconds:.0} s"),
        ..5400.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.1} h", seconds / 3600.0),
    }
}

impl Progress {
    /// Starts the clock.
    pub fn new(total: u64, quiet: bool) -> Self {
        Progress { started: Instant::now(), total, quiet }
    }

    /// Seconds since the beginning.
    pub fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Reports the progress; `skipped` rows were completed before.
    pub fn say(&self, done: u64, skipped: u64) {
        if self.quiet || self.total == 0 {
            return;
        }
        let rate = done.saturating_sub(skipped) as f64 / self.seconds().max(1e-9);
        let left = self.total.saturating_sub(done) as f64 / rate;
        let left = if left.is_finite() { span(left) } else { "unknown time".to_owned() };
        let line = format!(
            "{:5.1} %  {:.3e} of {:.3e} rows  {rate:.3e} rows/s  {left} left",
            100.0 * done as f64 / self.total as f64,
            done as f64,
            self.total as f64
        );
        write_line(&line);
    }

    /// Reports periodically the rows that this process counts, until it is dropped. `before` rows were
    /// counted before.
    pub async fn watch(self, before: u64) {
        loop {
            tokio::time::sleep(pause()).await;
            self.say(COUNTED.load(Ordering::Relaxed).saturating_sub(before).min(self.total), 0);
        }
    }

    /// Reports periodically how long other processes have been working, until it is dropped; the number of
    /// completed rows is known only between parts.
    pub async fn wait(self) {
        loop {
            tokio::time::sleep(pause()).await;
            if !self.quiet {
                write_line(&format!(
                    "the cluster works for {}; with --parts it says how far it is",
                    span(self.seconds())
                ));
            }
        }
    }
}

/// The time between two reports.
fn pause() -> Duration {
    Duration::from_secs(if std::io::stderr().is_terminal() { 1 } else { 10 })
}

/// Writes a report; on a terminal it replaces the previous one.
fn write_line(line: &str) {
    let mut out = std::io::stderr().lock();
    // errors of writing a report are ignored
    let _ = if out.is_terminal() { write!(out, "\r{line}   ") } else { writeln!(out, "{line}") };
    let _ = out.flush();
}

/// The peak memory of this process, MB, if the system provides it.
pub fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes / 1024.0)
}
