//! Writes a motion as an animated HTML page: points and the lines between them, contacts, impulses and
//! forces, and curves over time.
//!
//! [`page()`] makes the text of the page from an [`Animation`]. The page loads no other files, and works with
//! mouse, touch and keyboard.

mod energies;
mod follow;
mod gap;
#[cfg(feature = "mcap")]
pub mod mcap_file;
mod number;
mod recording;
mod rigid;
mod sections;
mod segments;
mod setup;
mod shapes;
mod solids;
#[cfg(test)]
mod tests;

use hodograph_model::page::{self, escaped};
use serde::Serialize;

pub use energies::missing;
pub use follow::{Span, Watch, follow};
pub use gap::gap;
pub use number::number;
pub use recording::{Recorded, Recording, numbers};
pub use segments::segments;
pub use setup::{Setup, Value};
pub use shapes::{Outline, Place, Shape};

/// The style sheet of pages with curves, beyond that of all pages.
pub const STYLE: &str = include_str!("../page/style.css");
/// The script that draws a motion; the playground's `build` uses the same files.
const SCRIPT: &str = concat!(
    include_str!("../page/geometry.js"),
    include_str!("../page/body.js"),
    include_str!("../page/motion.js"),
);
/// The place of the motion in a written page.
const BODY: &str = "<div id=\"motion\"></div>\n<noscript><p>This page needs JavaScript, which stands in the page itself.</p></noscript>\n";
/// Shows the motion there.
const SHOW: &str = "showMotion(document.getElementById(\"motion\"), JSON.parse(document.getElementById(\"data\").textContent));";
/// A page contains about this many moments at most; of longer motions every second or third moment is kept,
/// and those of events.
const MOMENTS: usize = 6000;

/// An animation. Lengths are in metres along N.x, N.y, N.z.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Animation {
    /// in plain words
    pub title: String,
    /// the moments, s, not decreasing; each event has one before and one after it
    pub times: Vec<f64>,
    /// indices in `times` of the moments just before events, increasing
    #[serde(skip)]
    pub before: Vec<usize>,
    /// the points of the mechanism
    pub points: Vec<Point>,
    /// the frames to be drawn, if any
    pub frames: Vec<Frame>,
    /// lines between points, by their indices in `points`
    pub segments: Vec<[usize; 2]>,
    /// shapes of bodies, and grounds
    pub shapes: Vec<Shape>,
    /// the events in order of time
    pub events: Vec<Happening>,
    /// contact forces and other forces over time
    pub forces: Vec<Force>,
    /// curves below the animation; those with the same panel share axes
    pub series: Vec<Series>,
    /// the direction upwards, such as that against gravity
    pub up: [f64; 3],
    /// further notes, in sentences
    pub notes: Vec<String>,
    /// the simulated model, its parameters and surfaces
    #[serde(skip)]
    pub setup: Setup,
}

/// A point.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// name in the model
    pub name: String,
    /// its position at each moment
    pub places: Vec<[f64; 3]>,
    /// a contact point of a shape: drawn small, without name and path
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub quiet: bool,
}

/// A frame.
#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    /// name in the model
    pub name: String,
    /// index in `points` of the point at which it is drawn
    pub at: usize,
    /// its axes x, y, z at each moment
    pub axes: Vec<[[f64; 3]; 3]>,
}

/// An event at one instant.
#[derive(Clone, Debug, Serialize)]
pub struct Happening {
    /// time, s
    pub time: f64,
    /// the contact; may be empty
    pub contact: String,
    /// kind of the event, such as `collision`
    pub label: String,
    /// its place
    pub at: Option<[f64; 3]>,
    /// its impulse, N s
    pub impulse: Option<[f64; 3]>,
}

/// A force over time.
#[derive(Clone, Debug, Serialize)]
pub struct Force {
    /// its name, such as that of its contact
    pub name: String,
    /// its point of action at each moment
    pub at: Vec<[f64; 3]>,
    /// the force at each moment, N; `None` if there is none
    pub force: Vec<Option<[f64; 3]>>,
}

/// A curve over time.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// the title of its panel, such as `energy`
    pub panel: String,
    /// its name in the legend
    pub name: String,
    /// its unit; may be empty
    pub unit: String,
    /// its value at each moment; a value that is not finite interrupts the curve
    pub values: Vec<f64>,
}

/// The text of the page.
pub fn page(animation: &Animation) -> String {
    let mut shown = animation.clone();
    shown.thin();
    // JSON represents numbers that are not finite as null. `<` is escaped, so that no string can end the
    // element that contains the data.
    let data = serde_json::to_string(&shown).unwrap_or_default().replace('<', "\\u003c");
    let (title, line, setup) = (escaped(&animation.title), animation.setup.line(), animation.setup.html());
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{title}: motion</title>\n<style>\n{}{STYLE}</style>\n</head>\n<body>\n\
         <header><h1>{title}</h1>{line}</header>\n<main>\n{BODY}{setup}</main>\n<script type=\"application/json\" id=\"data\">{data}</script>\n\
         <script>\n{SCRIPT}{SHOW}\n</script>\n</body>\n</html>\n",
        page::STYLE,
    )
}

impl Animation {
    /// Removes moments if there are too many, but none at an event, and not the last.
    pub fn thin(&mut self) {
        let stride = self.times.len().div_ceil(MOMENTS).max(1);
        let last = self.times.len().saturating_sub(1);
        let keep: Vec<bool> = (0..self.times.len())
            .map(|index| {
                let time = self.times[index];
                stride == 1
                    || index % stride == 0
                    || index == last
                    || self.events.iter().any(|event| event.time == time)
            })
            .collect();
        let kept = |index: usize| keep.get(index).copied().unwrap_or(false);
        fn only<T>(list: &mut Vec<T>, kept: impl Fn(usize) -> bool) {
            let mut index = 0;
            list.retain(|_| {
                index += 1;
                kept(index - 1)
            });
        }
        only(&mut self.times, kept);
        self.points.iter_mut().for_each(|point| only(&mut point.places, kept));
        self.frames.iter_mut().for_each(|frame| only(&mut frame.axes, kept));
        self.series.iter_mut().for_each(|series| only(&mut series.values, kept));
        for force in &mut self.forces {
            only(&mut force.at, kept);
            only(&mut force.force, kept);
        }
    }
}
