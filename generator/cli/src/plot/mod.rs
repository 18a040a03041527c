//! Figures: panels with axes, curves, marks and a legend, written as SVG or PNG.
//!
//! [`figure`] defines the content, [`layout`] the positions. Drawing goes through the library `plotters` onto
//! a [`canvas`] that records shapes to hundredths of a pixel; [`svg`] and [`png`] convert them, and
//! [`file`](mod@file) writes the result. [`collision`], [`conics`] and [`portrait`] are the figures of
//! `hodograph plot`.

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
