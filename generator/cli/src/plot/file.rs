//! Writes figures to files.

use std::path::Path;

use clap::ValueEnum;

use super::canvas::Sheet;
use super::figure::Figure;
use super::{layout, png, svg};
use crate::output;
use crate::stop::{Outcome, Stop};

impl Figure {
    /// The bytes of the figure's file.
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
    /// Those of [`bytes`](Self::bytes), or the file cannot be written.
    pub fn save(&self, path: &Path, format: Format) -> Outcome {
        output::file(path, &self.bytes(format)?)
    }
}

/// The bytes of a sheet's file, with a title and a description if the format supports them.
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
    /// a vector graphic
    Svg,
    /// a raster image
    Png,
}

impl Format {
    /// The given format, else that of the file's ending, else SVG.
    ///
    /// # Errors
    ///
    /// The file's name has another ending, and no format is given.
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
