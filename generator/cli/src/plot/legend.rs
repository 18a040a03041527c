//! Draws legends.

use super::canvas::{Anchor, Canvas, Shape};
use super::figure::{Panel, Sign};
use super::font;
use super::label::Label;
use super::series::{BLACK, Style, curve, mark, style};

/// Font size, pixels.
const SIZE: f64 = 12.0;
/// Line height.
const LINE: f64 = 20.0;
/// Length of the sample of a curve, and its width with the gap after it.
const KEY: [f64; 2] = [34.0, 42.0];
/// Distance between two entries of a row.
const BETWEEN: f64 = 26.0;

/// A curve or mark and its label.
#[derive(Clone, Debug)]
pub struct Entry {
    label: Label,
    key: Key,
}

#[derive(Clone, Copy, Debug)]
enum Key {
    Curve(Style),
    Mark(Sign, Option<usize>),
}

/// The entries of panels, each label once; a mark with several styles is black.
pub fn entries<'a>(panels: impl Iterator<Item = &'a Panel>) -> Vec<Entry> {
    let mut curves: Vec<Entry> = Vec::new();
    let mut marks: Vec<Entry> = Vec::new();
    for panel in panels {
        for series in &panel.series {
            let known = curves.iter().any(|entry| entry.label == series.label);
            if !known && series.label != Label::default() {
                curves.push(Entry { label: series.label.clone(), key: Key::Curve(style(series.style)) });
            }
        }
        for mark in panel.marks.iter().filter(|mark| mark.label != Label::default()) {
            match marks.iter_mut().find(|entry| entry.label == mark.label) {
                None => {
                    marks.push(Entry { label: mark.label.clone(), key: Key::Mark(mark.sign, mark.style) })
                }
                Some(Entry { key: Key::Mark(_, style), .. }) if *style != mark.style => *style = None,
                Some(_) => {}
            }
        }
    }
    curves.append(&mut marks);
    curves
}

fn width(entry: &Entry) -> f64 {
    KEY[1] + font::width(entry.label.marked(), SIZE)
}

/// Entries in rows of at most a given width.
fn rows(entries: &[Entry], most: f64) -> Vec<Vec<&Entry>> {
    let mut rows: Vec<Vec<&Entry>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in entries {
        match rows.last_mut().filter(|_| used + BETWEEN + width(entry) <= most) {
            Some(row) => {
                used += BETWEEN + width(entry);
                row.push(entry);
            }
            None => {
                used = width(entry);
                rows.push(vec![entry]);
            }
        }
    }
    rows
}

/// The height of a legend in rows.
pub fn height(entries: &[Entry], most: f64) -> f64 {
    rows(entries, most).len() as f64 * LINE
}

/// The width of a legend with one entry per row.
pub fn column(entries: &[Entry]) -> f64 {
    entries.iter().map(width).fold(0.0, f64::max)
}

/// Draws rows, each centred in a width, from a height downwards.
pub fn draw_rows(canvas: &Canvas, entries: &[Entry], most: f64, top: f64) {
    for (index, row) in rows(entries, most).into_iter().enumerate() {
        let all: f64 = row.iter().map(|entry| width(entry) + BETWEEN).sum::<f64>() - BETWEEN;
        let mut x = (most - all) / 2.0;
        for entry in row {
            draw(canvas, entry, [x, top + LINE * (index as f64 + 0.5)]);
            x += width(entry) + BETWEEN;
        }
    }
}

/// Draws one entry per row, from a position downwards.
pub fn draw_column(canvas: &Canvas, entries: &[Entry], [x, top]: [f64; 2]) {
    for (index, entry) in entries.iter().enumerate() {
        draw(canvas, entry, [x, top + LINE * (index as f64 + 0.5)]);
    }
}

fn draw(canvas: &Canvas, entry: &Entry, [x, y]: [f64; 2]) {
    match entry.key {
        Key::Curve(style) => curve(canvas, &[[x, y], [x + KEY[0], y]], style, false),
        Key::Mark(sign, index) => {
            let colour = index.map_or(BLACK, |index| style(index).colour);
            mark(canvas, sign, [x + KEY[0] - 8.0, y], colour);
        }
    }
    canvas.push(Shape::Text {
        marked: entry.label.marked().to_owned(),
        at: [x + KEY[1], y + font::CAPITAL * SIZE / 2.0],
        size: SIZE,
        colour: BLACK,
        anchor: Anchor::Start,
        upwards: false,
    });
}
