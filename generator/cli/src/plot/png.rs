//! Writes a drawing as PNG, with two pixels of the image per unit of the figure.

use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};
use ttf_parser::OutlineBuilder;

use super::canvas::{Anchor, Colour, Shape, Sheet};
use super::font;

/// Pixels of the image per pixel of the figure.
const SCALE: f32 = 2.0;

/// The bytes of the file.
///
/// # Errors
///
/// The sheet is too large for an image; the error says its size.
pub fn write(sheet: &Sheet) -> Result<Vec<u8>, String> {
    let [width, height] = sheet.size.map(|length| (length as f32 * SCALE).ceil() as u32);
    let mut picture =
        Pixmap::new(width, height).ok_or_else(|| format!("a picture of {width} x {height} points"))?;
    picture.fill(tiny_skia::Color::WHITE);
    for shape in &sheet.shapes {
        draw(&mut picture, shape);
    }
    picture.encode_png().map_err(|error| error.to_string())
}

fn paint(Colour([red, green, blue], opacity): Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, (255.0 * opacity).round() as u8);
    paint
}

fn path(points: &[[f64; 2]], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    path.move_to(first[0] as f32, first[1] as f32);
    rest.iter().for_each(|point| path.line_to(point[0] as f32, point[1] as f32));
    if closed {
        path.close();
    }
    path.finish()
}

fn draw(picture: &mut Pixmap, shape: &Shape) {
    let scale = Transform::from_scale(SCALE, SCALE);
    let fill = FillRule::Winding;
    match shape {
        Shape::Line { points, colour, width, dashes } => {
            let Some(path) = path(points, false) else { return };
            let dash = StrokeDash::new(dashes.iter().map(|&length| length as f32).collect(), 0.0);
            let width = *width as f32;
            let stroke = Stroke {
                width,
                dash,
                line_cap: LineCap::Butt,
                line_join: LineJoin::Round,
                ..Stroke::default()
            };
            picture.stroke_path(&path, &paint(*colour), &stroke, scale, None);
        }
        Shape::Polygon { points, colour } => {
            let Some(path) = path(points, true) else { return };
            picture.fill_path(&path, &paint(*colour), fill, scale, None);
        }
        Shape::Circle { centre, radius, colour, width } => {
            let [x, y, radius] = [centre[0], centre[1], *radius].map(|number| number as f32);
            let Some(path) = PathBuilder::from_circle(x, y, radius) else { return };
            match width {
                None => picture.fill_path(&path, &paint(*colour), fill, scale, None),
                Some(width) => {
                    let stroke = Stroke { width: *width as f32, ..Stroke::default() };
                    picture.stroke_path(&path, &paint(*colour), &stroke, scale, None);
                }
            }
        }
        Shape::Text { marked, at, size, colour, anchor, upwards } => {
            let (letters, width) = font::placed(marked, *size);
            let begin = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => -width / 2.0,
                Anchor::End => -width,
            };
            let turned = if *upwards {
                scale.pre_translate(at[0] as f32, at[1] as f32).pre_rotate(-90.0)
            } else {
                scale.pre_translate(at[0] as f32, at[1] as f32)
            };
            for letter in letters {
                let mut outline = Outline(PathBuilder::new());
                let size = (letter.size / letter.outline(&mut outline)) as f32;
                let Some(path) = outline.0.finish() else { continue };
                let place = turned
                    .pre_translate((begin + letter.x) as f32, -letter.raised as f32)
                    .pre_scale(size, -size);
                picture.fill_path(&path, &paint(*colour), fill, place, None);
            }
        }
    }
}

struct Outline(PathBuilder);

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
