//! Figures: panels with axes, curves, marks and a legend, written as SVG or PNG.
//!
//! [`figure`] says what is shown, [`layout`] where it stands. Drawing goes through the library `plotters`
//! onto a [`canvas`] that keeps hundredths of a pixel, from which [`svg`] and [`png`] make what
//! [`file`](mod@file) writes. [`collision`], [`conics`] and [`portrait`] are the
//! figures of `hodograph plot`.

mod canvas;
pub mod collision;
pub mod conics;
pub mod figure;
pub mod file;
mod font;
pub mod label;
mod layout;
mod legend;
mod png;
pub mod portrait;
mod series;
pub mod sketch;
pub mod svg;
#[cfg(test)]
mod tests;
pub mod trace;
