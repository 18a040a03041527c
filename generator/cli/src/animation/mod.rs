//! Writes a motion as an animated HTML page: points and the lines between them, contacts, impulses and
//! forces, and curves over time.
//!
//! [`page`] makes the text of the page from an [`Animation`]. The page loads no other files, and works with
//! mouse, touch and keyboard.

mod segments;
mod setup;
mod shapes;
#[cfg(test)]
mod tests;

use serde::Serialize;

pub use segments::segments;
pub use setup::{Setup, Value};
pub use shapes::{Outline, Place, Shape};

use crate::plot::svg::escaped;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
/// A page holds this many instants at most, about; of more, every second or third .. is kept, and those of
/// events.
const MOMENTS: usize = 6000;

/// What is to be seen. Lengths are in metres along N.x, N.y, N.z.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Animation {
    /// in plain words
    pub title: String,
    /// the moments, s; they do not decrease, and an event has one before and one after it
    pub times: Vec<f64>,
    /// the moments just before events, by their places in `times`, rising
    #[serde(skip)]
    pub before: Vec<usize>,
    /// the points of the mechanism
    pub points: Vec<Point>,
    /// the frames to be shown, if any
    pub frames: Vec<Frame>,
    /// lines between points, by their places in `points`
    pub segments: Vec<[usize; 2]>,
    /// shapes of bodies, and grounds
    pub shapes: Vec<Shape>,
    /// in the order of time
    pub events: Vec<Event>,
    /// forces that last
    pub forces: Vec<Force>,
    /// curves below the picture; those with the same panel share axes
    pub series: Vec<Series>,
    /// the direction upwards, such as that against gravity
    pub up: [f64; 3],
    /// what else is to be said, in sentences
    pub notes: Vec<String>,
    /// of what this is the motion
    #[serde(skip)]
    pub setup: Setup,
}

/// A point.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// as in the model
    pub name: String,
    /// where it is at each moment
    pub places: Vec<[f64; 3]>,
    /// the place where a shape touches: drawn small, without name and path
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub quiet: bool,
}

/// A frame.
#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    /// as in the model
    pub name: String,
    /// the point at which it is drawn, by its place in `points`
    pub at: usize,
    /// its axes x, y, z at each moment
    pub axes: Vec<[[f64; 3]; 3]>,
}

/// An event at one instant.
#[derive(Clone, Debug, Serialize)]
pub struct Event {
    /// s
    pub time: f64,
    /// the contact at which it happens; may be empty
    pub contact: String,
    /// what happens, such as `collision`
    pub label: String,
    /// where
    pub at: Option<[f64; 3]>,
    /// its impulse, N s
    pub impulse: Option<[f64; 3]>,
}

/// A force over time.
#[derive(Clone, Debug, Serialize)]
pub struct Force {
    /// such as the name of its contact
    pub name: String,
    /// where it acts at each moment
    pub at: Vec<[f64; 3]>,
    /// N at each moment, `None` where it does not act
    pub force: Vec<Option<[f64; 3]>>,
}

/// A curve over time.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// what stands over its panel, such as `energy`
    pub panel: String,
    /// in the legend
    pub name: String,
    /// may be empty
    pub unit: String,
    /// at each moment; a number that is not finite interrupts the curve
    pub values: Vec<f64>,
}

/// The page.
pub fn page(animation: &Animation) -> String {
    let mut shown = animation.clone();
    shown.thin();
    // JSON has no numbers that are not finite: they become null. Nothing in a string can end the element it
    // stands in.
    let data = serde_json::to_string(&shown).unwrap_or_default().replace('<', "\\u003c");
    let (title, line, setup) = (escaped(&animation.title), animation.setup.line(), animation.setup.html());
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{title}: motion</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header><h1>{title}</h1>{line}</header>\n<main>\n{BODY}{setup}</main>\n<script type=\"application/json\" id=\"data\">{data}</script>\n\
         <script>\n{SCRIPT}</script>\n</body>\n</html>\n"
    )
}

const BODY: &str = r#"<section class="motion" aria-label="Motion">
<svg id="stage" role="img" aria-label="The mechanism; drag, or use the arrow keys with Shift, to look from elsewhere" tabindex="0"></svg>
<div class="controls">
<button id="play" type="button" aria-label="Play"></button>
<span class="line"><input id="time" type="range" min="0" max="1" step="any" value="0" aria-label="Time"><svg id="marks" aria-hidden="true"></svg></span>
<output id="now" for="time"></output>
<label>Speed <select id="speed"></select></label>
<label><input id="names" type="checkbox" checked> names</label>
<label><input id="trails" type="checkbox" checked> paths</label>
<button id="view" type="button">Reset view</button>
</div>
<p class="help">Space plays and pauses; the left and right arrow keys go from moment to moment. Drag the picture to turn it, pinch or roll to come closer.</p>
<ul class="key" id="key"></ul>
</section>
<div id="zoom"><button id="closer" type="button" aria-label="Show less of the time">+</button><button id="farther" type="button" aria-label="Show more of the time">&minus;</button><button id="whole" type="button">All the time</button><span>zooms the curves in time, as Shift or Ctrl and the wheel do</span></div>
<section id="curves" aria-label="Curves over time"></section>
<section id="events" aria-label="Events"></section>
<noscript><p>This page needs JavaScript, which stands in the page itself.</p></noscript>
"#;

impl Animation {
    /// Leaves out moments where there are too many, none of them at an event, nor the last.
    fn thin(&mut self) {
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
