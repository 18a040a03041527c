//! Writes figures to files.

use std::path::Path;

use clap::ValueEnum;

use super::canvas::Sheet;
use super::figure::Figure;
use super::{layout, png, svg};
use crate::output;
use crate::stop::{Outcome, Stop};

impl Figure {
    /// The bytes of a file in a format.
    ///
    /// # Errors
    ///
    /// The figure is too large for a picture.
    pub fn bytes(&self, format: Format) -> Outcome<Vec<u8>> {
        let sheet = layout::draw(self).map_err(|error| Stop::Fault(format!("cannot draw: {error}")))?;
        picture(&sheet, format, &self.title, &self.description())
    }

    /// Writes a file, whole or not at all.
    ///
    /// # Errors
    ///
    /// As [`bytes`](Self::bytes), or the file cannot be written.
    pub fn save(&self, path: &Path, format: Format) -> Outcome {
        output::file(path, &self.bytes(format)?)
    }
}

/// The bytes of a sheet in a format, with a title and a description where it has room for them.
///
/// # Errors
///
/// The sheet is too large for a picture.
pub fn picture(sheet: &Sheet, format: Format, title: &str, description: &str) -> Outcome<Vec<u8>> {
    match format {
        Format::Svg => Ok(svg::write(sheet, title, description).into_bytes()),
        Format::Png => png::write(sheet).map_err(|error| Stop::Fault(format!("cannot draw {error}"))),
    }
}

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// lines and letters, which can be magnified
    Svg,
    /// a picture of points
    Png,
}

impl Format {
    /// The format that is asked for, else the one a file's name ends with, else SVG.
    ///
    /// # Errors
    ///
    /// The name ends otherwise, and no format is asked for.
    pub fn of(asked: Option<Format>, path: Option<&Path>) -> Outcome<Format> {
        let ending = |path: &Path| path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match (asked, path.map(ending)) {
            (Some(format), _) => Ok(format),
            (None, None | Some(None)) => Ok(Format::Svg),
            (None, Some(Some(ending))) => Format::from_str(&ending, true).map_err(|_| {
                Stop::Call(format!(
                    "figures are written as SVG or PNG, not as `{ending}`: end the file's name with .svg or .png, \
                     or give --format"
                ))
            }),
        }
    }
}
