//! Draws the course of the collisions as SVG: the hodograph, v_s over v_t, and v_n over I_n.

use std::error::Error;
use std::fmt::Write;

use hodograph::{Hodograph, Law, Surface};
use nalgebra::Vector3;

use super::{E, MU, Outcome};

/// Places of a curve.
const PLACES: usize = 240;
/// Colours that are told apart by readers who do not see all of them (after Okabe and Ito), and dashes.
const STYLES: [(&str, &str); 3] = [("#0072b2", "none"), ("#d55e00", "9 4"), ("#00825f", "9 3 2 3")];
/// The frame of a panel: left, top, width, height.
const FRAMES: [[f64; 4]; 2] = [[80.0, 70.0, 420.0, 330.0], [600.0, 70.0, 420.0, 330.0]];

/// A plot area with its ranges.
struct Panel {
    frame: [f64; 4],
    x: [f64; 2],
    y: [f64; 2],
}

impl Panel {
    /// With room around points.
    fn around(frame: [f64; 4], points: impl Iterator<Item = [f64; 2]> + Clone) -> Self {
        let range = |axis: usize| {
            let (low, high) =
                points.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
                    (low.min(point[axis]), high.max(point[axis]))
                });
            let room = 0.07 * (high - low);
            [low - room, high + room]
        };
        Panel { frame, x: range(0), y: range(1) }
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, width, height] = self.frame;
        let (right, up) =
            ((x - self.x[0]) / (self.x[1] - self.x[0]), (y - self.y[0]) / (self.y[1] - self.y[0]));
        [left + right * width, top + (1.0 - up) * height]
    }

    /// Frame, numbers and names of the axes.
    fn axes(&self, out: &mut String, [x, y]: [&str; 2]) -> std::fmt::Result {
        let [left, top, width, height] = self.frame;
        let (right, bottom) = (left + width, top + height);
        for (value, text) in ticks(self.x) {
            let [at, _] = self.place([value, self.y[0]]);
            writeln!(out, "<path class=\"grid\" d=\"M{at:.1} {top}V{bottom}\"/>")?;
            writeln!(
                out,
                "<text class=\"number\" x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
                bottom + 19.0
            )?;
        }
        for (value, text) in ticks(self.y) {
            let [_, at] = self.place([self.x[0], value]);
            writeln!(out, "<path class=\"grid\" d=\"M{left} {at:.1}H{right}\"/>")?;
            writeln!(
                out,
                "<text class=\"number\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                left - 8.0,
                at + 4.0
            )?;
        }
        for (zero, path) in [
            (self.x, format!("M{:.1} {top}V{bottom}", self.place([0.0, self.y[0]])[0])),
            (self.y, format!("M{left} {:.1}H{right}", self.place([self.x[0], 0.0])[1])),
        ] {
            if zero[0] < 0.0 && zero[1] > 0.0 {
                writeln!(out, "<path class=\"zero\" d=\"{path}\"/>")?;
            }
        }
        writeln!(out, "<path class=\"frame\" d=\"M{left} {top}V{bottom}H{right}\"/>")?;
        let middle = left + width / 2.0;
        writeln!(
            out,
            "<text class=\"axis\" x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{x}</text>",
            bottom + 42.0
        )?;
        let (x, middle) = (left - 52.0, top + height / 2.0);
        writeln!(
            out,
            "<text class=\"axis\" transform=\"translate({x} {middle}) rotate(-90)\" text-anchor=\"middle\">{y}</text>"
        )
    }

    /// A curve with an arrowhead in its direction.
    fn curve(
        &self,
        out: &mut String,
        points: &[[f64; 2]],
        (colour, dashes): (&str, &str),
    ) -> std::fmt::Result {
        let places: Vec<[f64; 2]> = points.iter().map(|point| self.place(*point)).collect();
        let path: Vec<String> = places.iter().map(|[x, y]| format!("{x:.2} {y:.2}")).collect();
        writeln!(
            out,
            "<path class=\"curve\" stroke=\"{colour}\" stroke-dasharray=\"{dashes}\" d=\"M{}\"/>",
            path.join("L")
        )?;
        // In the middle of its length.
        let lengths: Vec<f64> =
            places.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).collect();
        let (half, mut gone) = (0.4 * lengths.iter().sum::<f64>(), 0.0);
        for (pair, length) in places.windows(2).zip(&lengths) {
            gone += length;
            if gone >= half && *length > 0.0 {
                let [[x0, y0], [x, y]] = [pair[0], pair[1]];
                let angle = (y - y0).atan2(x - x0).to_degrees();
                writeln!(
                    out,
                    "<path fill=\"{colour}\" transform=\"translate({x:.1} {y:.1}) rotate({angle:.1})\" d=\"M6 0L-5 -4.5V4.5Z\"/>"
                )?;
                break;
            }
        }
        Ok(())
    }
}

/// Round numbers of an axis.
fn ticks([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let rough: f64 = (high - low) / 6.0;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|times| times * power).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(rough);
    let digits = usize::try_from(-(step.log10().floor() as i32)).unwrap_or(0);
    let first = (low / step).ceil() as i64;
    let text = |value: f64| format!("{value:.digits$}").replace('-', "\u{2212}");
    (first..=(high / step).floor() as i64)
        .map(|count| count as f64 * step)
        .map(|value| (value, text(if value.abs() < 1e-9 { 0.0 } else { value })))
        .collect()
}

/// The mark of a law, around a place.
fn mark(law: Law, [x, y]: [f64; 2], colour: &str) -> String {
    let at = format!("class=\"end\" stroke=\"{colour}\" transform=\"translate({x:.1} {y:.1})\"");
    match law {
        Law::Newton => format!("<circle {at} r=\"5.5\"/>"),
        Law::Poisson => format!("<path {at} d=\"M-5 -5L5 5M-5 5L5 -5\"/>"),
        _ => format!("<path {at} d=\"M-5 -5H5V5H-5Z\"/>"),
    }
}

/// A name with its index in italics, and its unit.
fn name(symbol: &str, index: &str, unit: &str) -> String {
    format!(
        "<tspan font-style=\"italic\">{symbol}</tspan><tspan font-size=\"11\" dy=\"4\">{index}</tspan><tspan dy=\"-4\"> [{unit}]</tspan>"
    )
}

/// The picture of the outcomes.
///
/// # Errors
///
/// A collision has no outcome.
pub fn picture(outcomes: &[Outcome]) -> Result<String, Box<dyn Error>> {
    // Along s = t x n, as the paper has it.
    let tangential = |v: &Vector3<f64>| [v.y, 0.0 - v.z];
    let mut courses = Vec::new();
    for mu in MU {
        let of_mu = outcomes.iter().filter(|outcome| outcome.mu == mu);
        let Some(first) = of_mu.clone().next() else { continue };
        // The course is the same under all laws; they end it earlier or later.
        let longest = of_mu.max_by(|a, b| a.hit.impulse.x.total_cmp(&b.hit.impulse.x)).unwrap_or(first);
        let surface = Surface { mu, e: E, law: longest.law };
        let course = Hodograph::new(&longest.hit.reduced, &longest.hit.approach, &surface)?;
        let end = longest.hit.impulse.x;
        let places: Vec<(f64, Vector3<f64>)> = (0..=PLACES)
            .map(|place| end * place as f64 / PLACES as f64)
            .map(|impulse| (impulse, course.at(impulse).velocity))
            .collect();
        courses.push(places);
    }
    let slips: Vec<Vec<[f64; 2]>> =
        courses.iter().map(|places| places.iter().map(|(_, v)| tangential(v)).collect()).collect();
    let normals: Vec<Vec<[f64; 2]>> =
        courses.iter().map(|places| places.iter().map(|(impulse, v)| [*impulse, v.x]).collect()).collect();
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1060 530\" width=\"1060\" height=\"530\" font-family=\"sans-serif\" \
         fill=\"#222\">\n<title>The collision of two sleds</title>\n<style>.grid{stroke:#e3e3e3}.zero{stroke:#999}.frame{stroke:#555;fill:none}\
         .curve{fill:none;stroke-width:2.2}.end{fill:none;stroke-width:2.2}.number{font-size:12px}.axis{font-size:14px}</style>\n\
         <rect width=\"1060\" height=\"530\" fill=\"#fff\"/>\n",
    );
    writeln!(
        out,
        "<text x=\"530\" y=\"30\" font-size=\"17\" text-anchor=\"middle\">Two sleds collide: slip and normal velocity during contact, e = {E}</text>"
    )?;
    let names =
        [[name("v", "t", "m/s"), name("v", "s", "m/s")], [name("I", "n", "N s"), name("v", "n", "m/s")]];
    for ((frame, curves), [x, y]) in FRAMES.into_iter().zip([&slips, &normals]).zip(&names) {
        let panel = Panel::around(frame, curves.iter().flatten().copied());
        panel.axes(&mut out, [x, y])?;
        for (curve, style) in curves.iter().zip(STYLES) {
            panel.curve(&mut out, curve, style)?;
        }
        if let Some([x, y]) = curves.first().and_then(|curve| curve.first()).map(|start| panel.place(*start))
        {
            writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\"/>")?;
        }
        for Outcome { mu, law, hit } in outcomes {
            let colour = MU.iter().position(|other| other == mu).map_or("#222", |index| STYLES[index].0);
            let at = match frame[0] == FRAMES[0][0] {
                true => tangential(&hit.separation),
                false => [hit.impulse.x, hit.separation.x],
            };
            writeln!(out, "{}", mark(*law, panel.place(at), colour))?;
        }
    }
    let mut x = 80.0;
    for (mu, (colour, dashes)) in MU.into_iter().zip(STYLES) {
        writeln!(
            out,
            "<path fill=\"none\" stroke-width=\"2.2\" stroke=\"{colour}\" stroke-dasharray=\"{dashes}\" d=\"M{x} 485h38\"/><text \
             class=\"axis\" x=\"{}\" y=\"490\"><tspan font-style=\"italic\">\u{3bc}</tspan> = {mu}</text>",
            x + 46.0
        )?;
        x += 130.0;
    }
    writeln!(
        out,
        "<circle cx=\"{}\" cy=\"485\" r=\"4.5\"/><text class=\"axis\" x=\"{}\" y=\"490\">approach</text>",
        x + 8.0,
        x + 22.0
    )?;
    x += 125.0;
    for &law in Law::ALL {
        let key = mark(law, [x, 485.0], "#222")
            .replace("end", "key")
            .replace("class=\"key\"", "fill=\"none\" stroke-width=\"2.2\"");
        writeln!(out, "{key}<text class=\"axis\" x=\"{}\" y=\"490\">end, {law:?}</text>", x + 14.0)?;
        x += 140.0;
    }
    out.push_str("</svg>\n");
    Ok(out)
}
