//! The files beside the lines of `simulate`: a figure, a page, and a recording for viewers of robots.

use std::path::{Path, PathBuf};

use hodograph_animation::{Recording, Setup};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Event, Simulation};

use super::figure::figure;
use crate::answers::is_read;
use crate::json::state::State;
use crate::plot::file::Format;
use crate::stop::{Outcome, Stop};
use crate::{mcap_file, output};

/// The files that are asked for.
#[derive(Clone, Debug, clap::Args)]
pub struct PictureFiles {
    /// a figure of coordinates, speeds, gaps and contact forces over time, as SVG or PNG
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// a page for browsers in which the mechanism moves: needs neither scripts from elsewhere nor a network
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// a recording for viewers of robots, such as Foxglove: frames, points, contact forces, impulses,
    /// events, curves
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
}

impl PictureFiles {
    /// Refuses before the simulation what could not be written after it, or what would be written over one
    /// of the files that are read.
    ///
    /// # Errors
    ///
    /// [`Stop::Call`] where a figure has no known format, or two files are one; [`Stop::Fault`] where a file
    /// cannot be written.
    pub fn check(&self, inputs: &[PathBuf]) -> Outcome {
        Format::of(None, self.plot.as_deref())?;
        let files = self.files();
        files.iter().try_for_each(|path| output::check(path))?;
        output::apart(&files, inputs)
    }

    /// Whether any file is asked for.
    pub fn wanted(&self) -> bool {
        !self.files().is_empty()
    }

    fn files(&self) -> Vec<&Path> {
        [&self.plot, &self.html, &self.mcap].into_iter().filter_map(Option::as_deref).collect()
    }

    /// Refuses times that a recording cannot hold.
    ///
    /// # Errors
    ///
    /// [`Stop::Call`].
    pub fn check_times(&self, start: f64, until: f64) -> Outcome {
        if self.mcap.is_some() && !(start >= 0.0 && until <= mcap_file::LAST) {
            return Err(Stop::Call(format!(
                "--mcap: times in a recording lie between 0 and {} s, and the motion is from {start} to {until}: change `t` of the state \
                 and --until",
                mcap_file::LAST
            )));
        }
        Ok(())
    }
}

/// What is kept of a motion for these files.
pub struct Pictures<'m> {
    recording: Option<Recording<'m>>,
    /// is anything kept?
    begun: bool,
}

impl<'m> Pictures<'m> {
    /// Nothing yet; `setup` says of which motion.
    pub fn new(
        files: &PictureFiles,
        mechanism: &'m InterpretedMechanism,
        state: &State,
        setup: impl FnOnce() -> Setup,
    ) -> Self {
        let recording = files
            .wanted()
            .then(|| Recording::new(mechanism, mechanism.model(), &state.to_numeric(), setup()));
        Pictures { recording, begun: false }
    }

    /// The state of a simulation.
    pub fn add(&mut self, simulation: &Simulation<'_>) {
        self.begun = true;
        if let Some(recording) = &mut self.recording {
            recording.add(simulation);
        }
    }

    /// Something that happened, where the simulation now is: the states before and after it.
    pub fn event(&mut self, event: &Event, simulation: &Simulation<'_>) {
        if let Some(recording) = &mut self.recording {
            recording.before(event, simulation);
            recording.add(simulation);
            recording.event(event);
        }
    }

    /// Writes the files and returns how the simulation ended, or why a file could not be written. Where the
    /// motion never began, files stay as they are.
    ///
    /// # Errors
    ///
    /// That of the simulation; else that of the first file that cannot be written. The others are told on
    /// standard error.
    pub fn save(self, files: &PictureFiles, simulated: Outcome) -> Outcome {
        let Some(recording) = self.recording.filter(|_| self.begun) else { return simulated };
        let recorded = recording.finish();
        recorded.notes.iter().for_each(|note| output::say(format_args!("note: {note}")));
        let mut outcomes = vec![simulated];
        if let Some(path) = &files.plot {
            let format = Format::of(None, Some(path));
            outcomes.push(format.and_then(|format| figure(&recorded).save(path, format)));
        }
        if let Some(path) = &files.html {
            outcomes.push(output::file(path, hodograph_animation::page(&recorded.shown).as_bytes()));
        }
        if let Some(path) = &files.mcap {
            let bytes = mcap_file::bytes(&recorded.shown, &recorded.states)
                .map_err(|error| Stop::Fault(format!("cannot make {}: {error}", path.display())));
            outcomes.push(bytes.and_then(|bytes| output::file(path, &bytes)));
        }
        let mut failed = outcomes.into_iter().filter_map(Result::err).peekable();
        if failed.peek().is_none() && is_read() {
            let written = [&files.plot, &files.html, &files.mcap].into_iter().flatten();
            written.for_each(|path| output::say(format_args!("wrote {}", path.display())));
        }
        let first = failed.next();
        failed.for_each(|other| output::say(format_args!("error: {other}")));
        first.map_or(Ok(()), Err)
    }
}
