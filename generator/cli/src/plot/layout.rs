//! Computes the positions of the parts of a figure.

use plotters::chart::{ChartBuilder, LabelAreaPosition};
use plotters::coord::ranged1d::{BoldPoints, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::IntoDrawingArea;
use plotters::style::{Color, IntoFont, RGBColor, TextStyle, WHITE};

use super::canvas::{Anchor, Canvas, Shape, Sheet, units};
use super::figure::{Axis, Figure, Legend, Panel};
use super::label::Label;
use super::series::{BLACK, curve, mark, style};
use super::{font, legend};

/// Font sizes of titles, names of axes and numbers, pixels.
const TITLE: f64 = 16.0;
const NAME: f64 = 13.0;
const NUMBER: f64 = 11.0;
/// Space around the figure and between its parts.
const MARGIN: f64 = 14.0;
/// Height of the title.
const TITLE_LINE: f64 = 34.0;
/// Height of the title of a panel.
const CAPTION_LINE: f64 = 24.0;
/// Height of the name of an axis, and length of a tick.
const NAME_LINE: f64 = 20.0;
const TICK: f64 = 5.0;
/// Least distance between two numbers of an axis: to the right, upwards; and if both axes have the same
/// scale.
const NUMBER_DISTANCE: [f64; 2] = [75.0, 28.0];
const EQUAL_DISTANCE: [f64; 2] = [55.0, 55.0];
/// The margin between curves and frame, relative to the width.
const CURVE_MARGIN: f64 = 0.06;
/// The smallest range of an axis relative to its values.
const MIN_RANGE: f64 = 1e-6;

type DrawError = Box<dyn std::error::Error>;

/// Draws the figure on a sheet.
///
/// # Errors
///
/// An error of the plotting library.
pub fn draw(figure: &Figure) -> Result<Sheet, DrawError> {
    let columns = figure.columns.clamp(1, figure.panels.len().max(1));
    let rows = figure.panels.len().div_ceil(columns);
    let [wide, high] = figure.panel_size;
    let beside = match figure.legend {
        Legend::Below => 0.0,
        Legend::Beside => {
            let widest = |panel| legend::column(&legend::entries(std::iter::once(panel)));
            let widest = figure.panels.iter().map(widest).fold(0.0, f64::max);
            if widest > 0.0 { widest + MARGIN } else { 0.0 }
        }
    };
    let cell = [wide + beside, high];
    let width = columns as f64 * cell[0] + 2.0 * MARGIN;
    let top = if figure.title.is_empty() { MARGIN } else { MARGIN + TITLE_LINE };
    let shared = legend::entries(figure.panels.iter().filter(|_| figure.legend == Legend::Below));
    let bottom = top + rows as f64 * cell[1];
    let below = legend::height(&shared, width - 2.0 * MARGIN);
    let space = if shared.is_empty() { 0.0 } else { MARGIN };
    let canvas = Canvas::new([width, bottom + space + below + MARGIN]);
    let title = Label::words(&figure.title);
    text(&canvas, title.marked(), [width / 2.0, MARGIN + TITLE], TITLE);
    // Align the axes of panels in a column.
    let mut lefts = vec![0.0_f64; columns];
    for (index, panel) in figure.panels.iter().enumerate() {
        let left = &mut lefts[index % columns];
        *left = left.max(Frame::new(panel, figure.panel_size, 0.0).left);
    }
    for (index, panel) in figure.panels.iter().enumerate() {
        let corner = [MARGIN + (index % columns) as f64 * cell[0], top + (index / columns) as f64 * cell[1]];
        let frame = Frame::new(panel, figure.panel_size, lefts[index % columns]);
        self::panel(&canvas, panel, corner, figure.panel_size, &frame)?;
        if figure.legend == Legend::Beside {
            let entries = legend::entries(std::iter::once(panel));
            legend::draw_column(&canvas, &entries, [corner[0] + wide + MARGIN, corner[1] + CAPTION_LINE]);
        }
    }
    legend::draw_rows(&canvas, &shared, width, bottom + space);
    Ok(canvas.sheet())
}

fn text(canvas: &Canvas, marked: &str, at: [f64; 2], size: f64) {
    if !marked.is_empty() {
        let (marked, anchor, upwards) = (marked.to_owned(), Anchor::Middle, false);
        canvas.push(Shape::Text { marked, at, size, colour: BLACK, anchor, upwards });
    }
}

/// The positions of the axes of a panel, and their numbers.
struct Frame {
    scales: [Scale; 2],
    /// height above and below the frame
    caption: f64,
    below: f64,
    /// width of the numbers and the name on the left
    left: f64,
    width: f64,
    height: f64,
}

impl Frame {
    /// The frame of a panel of a given size; `least` is the smallest width on the left.
    fn new(panel: &Panel, size: [f64; 2], least: f64) -> Frame {
        let caption = if panel.title == Label::default() { MARGIN / 2.0 } else { CAPTION_LINE };
        let below = NAME_LINE + NUMBER + 2.5 * TICK;
        let height = size[1] - caption - below - MARGIN / 2.0;
        let points = || {
            let of_series = panel.series.iter().flat_map(|series| series.points.iter().copied());
            of_series.chain(panel.marks.iter().map(|mark| mark.at))
        };
        let mut scales = [
            Scale::new(&panel.x, points().map(|point| point[0])),
            Scale::new(&panel.y, points().map(|point| point[1])),
        ];
        if panel.equal {
            let exponent = scales[0].exponent.max(scales[1].exponent);
            scales = scales.map(|scale| scale.with_exponent(exponent));
        }
        // The width of the numbers depends on the ticks, and these on the remaining width.
        let apart = if panel.equal { EQUAL_DISTANCE } else { NUMBER_DISTANCE };
        let (mut left, mut width) = (least, size[0]);
        for _ in 0..3 {
            left = least.max(NAME_LINE + scales[1].ticks(height, apart[1]).widest() + 3.0 * TICK);
            width = size[0] - left - MARGIN;
            if panel.equal {
                scales = Scale::equal(scales, [width, height]);
            }
        }
        Frame { scales, caption, below, left, width, height }
    }
}

fn panel(
    canvas: &Canvas,
    panel: &Panel,
    corner: [f64; 2],
    size: [f64; 2],
    frame: &Frame,
) -> Result<(), DrawError> {
    let &Frame { ref scales, caption, below, left, width, height } = frame;
    let apart = if panel.equal { EQUAL_DISTANCE } else { NUMBER_DISTANCE };
    let [x, y] = scales;
    let (x_ticks, y_ticks) = (x.ticks(width, apart[0]), y.ticks(height, apart[1]));
    let middle = corner[0] + left + width / 2.0;
    text(canvas, panel.title.marked(), [middle, corner[1] + CAPTION_LINE - 9.0], NAME);

    let area = canvas.clone().into_drawing_area().shrink(
        (units(corner[0]), units(corner[1] + caption)),
        (units(size[0] - MARGIN), units(height + below)),
    );
    let mut chart = ChartBuilder::on(&area)
        .set_label_area_size(LabelAreaPosition::Left, units(left))
        .set_label_area_size(LabelAreaPosition::Bottom, units(below))
        .build_cartesian_2d(x.low..x.high, y.low..y.high)?;
    let letters = |size: f64| {
        TextStyle::from(("sans-serif", f64::from(units(size))).into_font()).color(&RGBColor(30, 30, 30))
    };
    chart
        .configure_mesh()
        .max_light_lines(0)
        .light_line_style(WHITE.mix(0.0))
        .bold_line_style(RGBColor(225, 225, 225).stroke_width(units(0.8).unsigned_abs()))
        .axis_style(RGBColor(90, 90, 90).stroke_width(units(1.0).unsigned_abs()))
        .set_all_tick_mark_size(units(TICK))
        .x_labels(x_ticks.most)
        .y_labels(y_ticks.most)
        .x_label_formatter(&|number| x_ticks.text(*number))
        .y_label_formatter(&|number| y_ticks.text(*number))
        .label_style(letters(NUMBER))
        .axis_desc_style(letters(NAME))
        .x_desc(x.description(&panel.x))
        .y_desc(y.description(&panel.y))
        .draw()?;
    let place = |point: [f64; 2]| {
        let (right, down) =
            ((x.of(point[0]) - x.low) / (x.high - x.low), (y.high - y.of(point[1])) / (y.high - y.low));
        [corner[0] + left + right * width, corner[1] + caption + down * height]
    };
    zero_lines(canvas, scales, place, [[corner[0] + left, corner[1] + caption], [width, height]]);
    for series in &panel.series {
        let places: Vec<[f64; 2]> = series.points.iter().map(|point| place(*point)).collect();
        curve(canvas, &places, style(series.style), series.directed);
    }
    for shown in &panel.marks {
        let colour = shown.style.map_or(BLACK, |index| style(index).colour);
        let at = place(shown.at);
        if at.iter().all(|number| number.is_finite()) {
            mark(canvas, shown.sign, at, colour);
        }
    }
    Ok(())
}

/// Lines at the zeros of the axes.
fn zero_lines(
    canvas: &Canvas,
    scales: &[Scale; 2],
    place: impl Fn([f64; 2]) -> [f64; 2],
    [[left, top], [width, height]]: [[f64; 2]; 2],
) {
    let inside = |scale: &Scale| scale.low < 0.0 && 0.0 < scale.high;
    let [x, y] = place([0.0, 0.0]);
    let line = |points: [[f64; 2]; 2]| {
        let colour = super::canvas::Colour([120, 120, 120], 1.0);
        canvas.push(Shape::Line { points: points.to_vec(), colour, width: 0.8, dashes: Vec::new() });
    };
    if inside(&scales[0]) {
        line([[x, top], [x, top + height]]);
    }
    if inside(&scales[1]) {
        line([[left, y], [left + width, y]]);
    }
}

/// The scale of an axis: the range of the data divided by a power of ten.
#[derive(Clone, Copy, Debug)]
struct Scale {
    low: f64,
    high: f64,
    exponent: i32,
}

/// A number divided by a power of ten.
fn divided(number: f64, exponent: i32) -> f64 {
    // In two steps, since the power of ten may overflow although the quotient does not.
    let half = exponent / 2;
    number / 10f64.powi(half) / 10f64.powi(exponent - half)
}

impl Scale {
    fn new(axis: &Axis, numbers: impl Iterator<Item = f64>) -> Self {
        let numbers = numbers.filter(|number| number.is_finite());
        let (low, high) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| {
            (low.min(number), high.max(number))
        });
        let [low, high] = match axis.range {
            Some([low, high]) if low < high => [low, high],
            _ if low > high => [-1.0, 1.0],
            _ => [low, high],
        };
        let largest = low.abs().max(high.abs());
        let exponent = match largest {
            0.01..1e4 | 0.0 => 0,
            _ => 3 * (largest.log10() / 3.0).floor() as i32,
        };
        let (low, high) = (divided(low, exponent), divided(high, exponent));
        if axis.range.is_some_and(|[low, high]| low < high) {
            return Scale { low, high, exponent };
        }
        let largest = low.abs().max(high.abs());
        let width = (high - low).max(MIN_RANGE * largest);
        let width = if width > 0.0 { width } else { 1.0 };
        let least = if high - low < width { width } else { CURVE_MARGIN * width };
        Scale { low: low - least, high: high + least, exponent }
    }

    fn of(&self, number: f64) -> f64 {
        divided(number, self.exponent)
    }

    /// The same range divided by another power of ten.
    fn with_exponent(self, exponent: i32) -> Self {
        let again = |number| divided(number, exponent - self.exponent);
        Scale { low: again(self.low), high: again(self.high), exponent }
    }

    /// Scales of equal length per unit, for a plot of this size.
    fn equal(scales: [Scale; 2], size: [f64; 2]) -> [Scale; 2] {
        let unit = [0, 1].map(|axis| (scales[axis].high - scales[axis].low) / size[axis]);
        let unit = unit[0].max(unit[1]);
        [0, 1].map(|axis| {
            let Scale { low, high, exponent } = scales[axis];
            let more = (unit * size[axis] - (high - low)) / 2.0;
            Scale { low: low - more, high: high + more, exponent }
        })
    }

    /// The ticks of an axis of this length with at least this distance.
    fn ticks(&self, length: f64, apart: f64) -> Ticks {
        let most = (length / apart).floor().max(2.0) as usize;
        let numbers = RangedCoordf64::from(self.low..self.high).key_points(BoldPoints(most));
        let apart = numbers.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let apart = if apart.is_finite() { apart } else { self.high - self.low };
        // A step of 0.25 needs one digit more than its magnitude suggests.
        let digits = (0..12).find(|&digits| {
            let steps = apart * 10f64.powi(digits);
            (steps - steps.round()).abs() < 1e-3 * steps
        });
        Ticks { most, digits: digits.unwrap_or(12) as usize, numbers }
    }

    /// The name of an axis, with its unit and power of ten.
    fn description(&self, axis: &Axis) -> String {
        let mut label = axis.name.clone();
        let unit = axis.unit.as_str();
        if self.exponent != 0 {
            label = label.then(" [").with_power_of_ten(self.exponent).then(if unit.is_empty() {
                ""
            } else {
                " "
            });
            label = label.then(unit).then("]");
        } else if !unit.is_empty() {
            label = label.then(" [").then(unit).then("]");
        }
        label.marked().to_owned()
    }
}

/// The numbers at an axis.
struct Ticks {
    most: usize,
    digits: usize,
    numbers: Vec<f64>,
}

impl Ticks {
    fn text(&self, number: f64) -> String {
        let text = format!("{number:.*}", self.digits);
        match text.strip_prefix('-') {
            None => text,
            Some(digits) if digits.bytes().all(|digit| matches!(digit, b'0' | b'.')) => digits.to_owned(),
            Some(digits) => format!("\u{2212}{digits}"),
        }
    }

    fn widest(&self) -> f64 {
        self.numbers.iter().map(|&number| font::width(&self.text(number), NUMBER)).fold(0.0, f64::max)
    }
}
