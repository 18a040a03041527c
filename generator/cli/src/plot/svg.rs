//! Writes a drawing as SVG.

use std::fmt::Write;

use hodograph_generator::page::escaped;

use super::canvas::{Anchor, Colour, Shape, Sheet};
use super::font::{FAMILY, LOWER, RAISE, SMALL};
use super::label::{Kind, Label};

/// The text of the file.
pub fn write(sheet: &Sheet, title: &str, description: &str) -> String {
    let [width, height] = sheet.size.map(short);
    let (title, description) = (escaped(title), escaped(description));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\" aria-label=\"{title}\" font-family=\"{FAMILY}\" fill=\"none\" stroke-linejoin=\"round\">\n\
         <title>{title}</title>\n<desc>{description}</desc>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
    );
    for shape in &sheet.shapes {
        out += &element(shape);
        out.push('\n');
    }
    out + "</svg>\n"
}

/// A length to hundredths, without trailing zeros.
fn short(length: f64) -> String {
    let text = format!("{length:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The attributes of a fill or stroke colour.
fn paint(property: &str, Colour([red, green, blue], opacity): Colour) -> String {
    let colour = format!("{property}=\"#{red:02x}{green:02x}{blue:02x}\"");
    if opacity < 1.0 { format!("{colour} {property}-opacity=\"{}\"", short(opacity)) } else { colour }
}

fn path(points: &[[f64; 2]]) -> String {
    let place = |point: &[f64; 2]| point.map(short).join(" ");
    let mut out = String::new();
    for (index, point) in points.iter().enumerate() {
        let _ = write!(out, "{}{}", if index == 0 { 'M' } else { 'L' }, place(point));
    }
    out
}

fn element(shape: &Shape) -> String {
    match shape {
        Shape::Line { points, colour, width, dashes } => {
            let dashes: Vec<String> = dashes.iter().map(|&length| short(length)).collect();
            let dashes = match dashes.is_empty() {
                true => String::new(),
                false => format!(" stroke-dasharray=\"{}\"", dashes.join(" ")),
            };
            let (line, width) = (paint("stroke", *colour), short(*width));
            format!("<path d=\"{}\" {line} stroke-width=\"{width}\"{dashes}/>", path(points))
        }
        Shape::Polygon { points, colour } => {
            format!("<path d=\"{}Z\" {}/>", path(points), paint("fill", *colour))
        }
        Shape::Circle { centre: [x, y], radius, colour, width } => {
            let paint = match width {
                Some(width) => format!("{} stroke-width=\"{}\"", paint("stroke", *colour), short(*width)),
                None => paint("fill", *colour),
            };
            format!("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {paint}/>", short(*x), short(*y), short(*radius))
        }
        Shape::Text { marked, at: [x, y], size, colour, anchor, upwards } => {
            let (x, y) = (short(*x), short(*y));
            let place = match upwards {
                true => format!("transform=\"translate({x} {y}) rotate(-90)\""),
                false => format!("x=\"{x}\" y=\"{y}\""),
            };
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            };
            let paint = paint("fill", *colour);
            format!(
                "<text {place} font-size=\"{}\"{anchor} {paint}>{}</text>",
                short(*size),
                pieces(marked, *size)
            )
        }
    }
}

/// The pieces of a label; text after an index returns to the base line.
fn pieces(marked: &str, size: f64) -> String {
    let mut out = String::new();
    let mut below = 0.0;
    for (kind, text) in Label::pieces(marked) {
        let (level, style) = match kind {
            Kind::Word => (0.0, String::new()),
            Kind::Symbol => (0.0, " font-style=\"italic\"".to_owned()),
            Kind::Index => (LOWER * size, format!(" font-size=\"{}\"", short(SMALL * size))),
            Kind::Exponent => (-RAISE * size, format!(" font-size=\"{}\"", short(SMALL * size))),
        };
        let shift = match level - below {
            0.0 => String::new(),
            shift => format!(" dy=\"{}\"", short(shift)),
        };
        below = level;
        match style.is_empty() && shift.is_empty() {
            true => out += &escaped(text),
            false => out += &format!("<tspan{style}{shift}>{}</tspan>", escaped(text)),
        }
    }
    out
}
