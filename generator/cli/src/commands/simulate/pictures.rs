//! The optional files of `simulate`: a figure, a page, and a recording for robot viewers.

use std::path::{Path, PathBuf};

use hodograph_animation::{Recording, Setup, mcap_file};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Event, Simulation};

use super::figure::figure;
use crate::answers::is_terminal;
use crate::json::state::State;
use crate::output;
use crate::plot::file::Format;
use crate::stop::{Outcome, Stop};

/// The options for these files.
#[derive(Clone, Debug, clap::Args)]
pub struct PictureFiles {
    /// a figure of coordinates, speeds, gaps and contact forces over time, as SVG or PNG
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// a page for browsers with an animation of the mechanism; it needs no network and no other files
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// a recording for robot viewers such as Foxglove: frames, points, contact forces, impulses, events,
    /// curves
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
}

impl PictureFiles {
    /// Checks before the simulation that the files can be written, and that none of them is an input file.
    ///
    /// # Errors
    ///
    /// [`Stop::Call`] if a figure has no known format, or two files are the same; [`Stop::Fault`] if a file
    /// cannot be written.
    pub fn check(&self, inputs: &[PathBuf]) -> Outcome {
        Format::of(None, self.plot.as_deref())?;
        let files = self.files();
        files.iter().try_for_each(|path| output::check(path))?;
        output::check_distinct(&files, inputs)
    }

    /// Whether any of the files is requested.
    pub fn wanted(&self) -> bool {
        !self.files().is_empty()
    }

    fn files(&self) -> Vec<&Path> {
        [&self.plot, &self.html, &self.mcap].into_iter().filter_map(Option::as_deref).collect()
    }

    /// Refuses times that a recording cannot represent.
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

/// The recording of a motion for these files.
pub struct Pictures<'m> {
    recording: Option<Recording<'m>>,
    /// whether any state is recorded
    begun: bool,
}

impl<'m> Pictures<'m> {
    /// An empty recording; `setup` describes the motion.
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

    /// Records the current state of a simulation.
    pub fn add(&mut self, simulation: &Simulation<'_>) {
        self.begun = true;
        if let Some(recording) = &mut self.recording {
            recording.add(simulation);
        }
    }

    /// Records an event at the current time, with the states before and after it.
    pub fn event(&mut self, event: &Event, simulation: &Simulation<'_>) {
        if let Some(recording) = &mut self.recording {
            recording.before(event, simulation);
            recording.add(simulation);
            recording.event(event);
        }
    }

    /// Writes the files and returns how the simulation ended, or why a file could not be written. If nothing
    /// was recorded, existing files stay as they are.
    ///
    /// # Errors
    ///
    /// The error of the simulation, else that of the first file that cannot be written. The others are
    /// reported on standard error.
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
        if failed.peek().is_none() && is_terminal() {
            let written = [&files.plot, &files.html, &files.mcap].into_iter().flatten();
            written.for_each(|path| output::say(format_args!("wrote {}", path.display())));
        }
        let first = failed.next();
        failed.for_each(|other| output::say(format_args!("error: {other}")));
        first.map_or(Ok(()), Err)
    }
}
