//! The contents of a figure: panels with axes, curves and marks.
//!
//! ```ignore
//! let mut panel = Panel::new(Axis::new(Label::symbol("t", ""), "s"), Axis::new(Label::words("gap"), "m"));
//! panel.series.push(Series::new("tip", 0, times.zip(gaps).collect()));
//! Figure::new("Pendulum").panel(panel).save(path, Format::of(None, Some(path))?)?;
//! ```

use super::label::Label;

/// Panels under a title.
#[derive(Clone, Debug)]
pub struct Figure {
    /// in plain words
    pub title: String,
    /// row by row
    pub panels: Vec<Panel>,
    /// panels side by side
    pub columns: usize,
    /// width and height of a panel, pixels
    pub panel_size: [f64; 2],
    /// the place of the legend
    pub legend: Legend,
}

/// The place of the legend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Legend {
    /// one below all panels; a label that occurs in several panels is listed once
    Below,
    /// one for each panel, on its right
    Beside,
}

/// Curves and marks over two axes.
#[derive(Clone, Debug)]
pub struct Panel {
    /// above the panel; may be empty
    pub title: Label,
    /// to the right
    pub x: Axis,
    /// upwards
    pub y: Axis,
    /// whether both axes have the same scale
    pub equal: bool,
    /// the curves in the order of drawing
    pub series: Vec<Series>,
    /// drawn over the series
    pub marks: Vec<Mark>,
}

/// The quantity of an axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// the quantity
    pub name: Label,
    /// its unit; may be empty
    pub unit: String,
    /// its range; `None`: that of the data with a margin
    pub range: Option<[f64; 2]>,
}

/// A curve.
#[derive(Clone, Debug)]
pub struct Series {
    /// the label in the legend; empty: not listed
    pub label: Label,
    /// index of its [`style`](super::series::style)
    pub style: usize,
    /// in units of the axes; a value that is not finite interrupts the curve
    pub points: Vec<[f64; 2]>,
    /// whether arrowheads show the direction of the curve
    pub directed: bool,
}

/// A marked point.
#[derive(Clone, Debug)]
pub struct Mark {
    /// the label in the legend; empty: not listed
    pub label: Label,
    /// its shape
    pub sign: Sign,
    /// index of the style of its colour; `None`: black
    pub style: Option<usize>,
    /// in units of the axes
    pub at: [f64; 2],
}

/// The shape of a mark.
#[allow(dead_code)] // for figures over time
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// a filled circle
    Dot,
    /// a circle
    Circle,
    /// an oblique cross
    Cross,
    /// a square
    Square,
    /// a triangle
    Triangle,
    /// a filled square
    Block,
}

impl Figure {
    /// A figure with one column and legends beside its panels: quantities over time.
    pub fn new(title: &str) -> Self {
        Figure {
            title: title.to_owned(),
            panels: Vec::new(),
            columns: 1,
            panel_size: [760.0, 230.0],
            legend: Legend::Beside,
        }
    }

    /// Adds a panel.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// The contents of the panels in words.
    pub fn description(&self) -> String {
        let panel = |panel: &Panel| format!("{} over {}", panel.y.name.plain(), panel.x.name.plain());
        self.panels.iter().map(panel).collect::<Vec<_>>().join("; ")
    }
}

impl Panel {
    /// An empty panel.
    pub fn new(x: Axis, y: Axis) -> Self {
        Panel { title: Label::default(), x, y, equal: false, series: Vec::new(), marks: Vec::new() }
    }
}

impl Axis {
    /// An axis with the range of its data.
    pub fn new(name: impl Into<Label>, unit: &str) -> Self {
        Axis { name: name.into(), unit: unit.to_owned(), range: None }
    }
}

impl Series {
    /// A curve without direction.
    pub fn new(label: impl Into<Label>, style: usize, points: Vec<[f64; 2]>) -> Self {
        Series { label: label.into(), style, points, directed: false }
    }
}
