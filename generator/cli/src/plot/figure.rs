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
    /// where the legend stands
    pub legend: Legend,
}

/// Where the legend stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Legend {
    /// one for all panels, below them; what has the same label in several panels stands there once
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
    /// a unit is as long upwards as to the right
    pub equal: bool,
    /// in the order of drawing
    pub series: Vec<Series>,
    /// drawn over the series
    pub marks: Vec<Mark>,
}

/// What an axis shows.
#[derive(Clone, Debug)]
pub struct Axis {
    /// the quantity
    pub name: Label,
    /// its unit; may be empty
    pub unit: String,
    /// the ends; `None`: those of the data, and a margin
    pub range: Option<[f64; 2]>,
}

/// A curve.
#[derive(Clone, Debug)]
pub struct Series {
    /// in the legend; empty: not there
    pub label: Label,
    /// number of its [`style`](super::series::style)
    pub style: usize,
    /// in units of the axes; a number that is not finite interrupts the curve
    pub points: Vec<[f64; 2]>,
    /// arrowheads show in which direction the curve is run through
    pub directed: bool,
}

/// A place that is marked.
#[derive(Clone, Debug)]
pub struct Mark {
    /// in the legend; empty: not there
    pub label: Label,
    /// its form
    pub sign: Sign,
    /// colour of this style; `None`: black
    pub style: Option<usize>,
    /// in units of the axes
    pub at: [f64; 2],
}

/// The form of a mark.
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
    /// A figure of one column, legends beside its panels: quantities over time.
    pub fn new(title: &str) -> Self {
        Figure {
            title: title.to_owned(),
            panels: Vec::new(),
            columns: 1,
            panel_size: [760.0, 230.0],
            legend: Legend::Beside,
        }
    }

    /// With a panel more.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// What the panels show, in words.
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
    /// An axis as long as its data.
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
