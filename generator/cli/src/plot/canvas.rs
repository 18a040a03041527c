//! A backend of the library `plotters` that records shapes, in hundredths of a pixel; `svg` and `png` write
//! them to files.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};

use super::font;

/// Units of `plotters` per pixel.
pub const UNITS: f64 = 100.0;

/// Pixels in units of `plotters`.
pub fn units(pixels: f64) -> i32 {
    (pixels * UNITS).round() as i32
}

fn pixels((x, y): BackendCoord) -> [f64; 2] {
    [f64::from(x) / UNITS, f64::from(y) / UNITS]
}

/// Red, green, blue, between 0 and 255, and opacity, between 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub [u8; 3], pub f64);

impl From<BackendColor> for Colour {
    fn from(colour: BackendColor) -> Self {
        let (red, green, blue) = colour.rgb;
        Colour([red, green, blue], colour.alpha)
    }
}

/// The place of a text relative to its anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// A shape; lengths in pixels, y downwards.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// a polyline, dashed if lengths of dashes and gaps are given
    Line { points: Vec<[f64; 2]>, colour: Colour, width: f64, dashes: Vec<f64> },
    /// a filled polygon
    Polygon { points: Vec<[f64; 2]>, colour: Colour },
    /// a circle, filled, or a line of this width
    Circle { centre: [f64; 2], radius: f64, colour: Colour, width: Option<f64> },
    /// marked text with its anchor on the base line; rotated by a quarter to the left if `upwards`
    Text { marked: String, at: [f64; 2], size: f64, colour: Colour, anchor: Anchor, upwards: bool },
}

/// Shapes on a sheet.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// width and height, pixels
    pub size: [f64; 2],
    /// the shapes in the order of drawing
    pub shapes: Vec<Shape>,
}

/// The backend. Its clones draw on the same sheet.
#[derive(Clone, Debug)]
pub struct Canvas(Rc<RefCell<Sheet>>);

impl Canvas {
    /// An empty sheet.
    pub fn new(size: [f64; 2]) -> Self {
        Canvas(Rc::new(RefCell::new(Sheet { size, shapes: Vec::new() })))
    }

    /// Draws a shape.
    pub fn push(&self, shape: Shape) {
        self.0.borrow_mut().shapes.push(shape);
    }

    /// The recorded shapes.
    pub fn sheet(&self) -> Sheet {
        self.0.borrow().clone()
    }
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl DrawingBackend for Canvas {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        let [width, height] = self.0.borrow().size;
        (units(width).unsigned_abs(), units(height).unsigned_abs())
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, _: BackendCoord, _: BackendColor) -> Drawn {
        // Single points are too small to be seen; all shapes have functions of their own below.
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        match fill {
            true => self.fill_polygon(corners, style),
            false => self.draw_path(corners.into_iter().chain([corners[0]]), style),
        }
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let colour = Colour::from(style.color());
        if colour.1 > 0.0 {
            let points = path.into_iter().map(pixels).collect();
            let width = f64::from(style.stroke_width()) / UNITS;
            self.push(Shape::Line { points, colour, width, dashes: Vec::new() });
        }
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        centre: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let width = (!fill).then(|| f64::from(style.stroke_width()) / UNITS);
        let radius = f64::from(radius) / UNITS;
        self.push(Shape::Circle { centre: pixels(centre), radius, colour: style.color().into(), width });
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        let points = corners.into_iter().map(pixels).collect();
        self.push(Shape::Polygon { points, colour: style.color().into() });
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, place: BackendCoord) -> Drawn {
        let size = style.size() / UNITS;
        let upwards = matches!(style.transform(), FontTransform::Rotate270);
        let anchor = match style.anchor().h_pos {
            HPos::Left => Anchor::Start,
            HPos::Center => Anchor::Middle,
            HPos::Right => Anchor::End,
        };
        // The distance from the given anchor to the base line.
        let down = size
            * match style.anchor().v_pos {
                VPos::Top => 0.9,
                VPos::Center => font::CAPITAL / 2.0,
                VPos::Bottom => -0.25,
            };
        let [x, y] = pixels(place);
        let at = if upwards { [x + down, y] } else { [x, y + down] };
        let marked = text.to_owned();
        self.push(Shape::Text { marked, at, size, colour: style.color().into(), anchor, upwards });
        Ok(())
    }

    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<Self::ErrorType>> {
        let size = style.size();
        Ok((font::width(text, size).ceil() as u32, (1.2 * size).ceil() as u32))
    }
}
