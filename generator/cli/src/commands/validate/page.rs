//! The page of `validate`: the table, the distribution of errors, the pairs, and motions beside their
//! measurements.

use std::fmt::Write as _;

use hodograph_generator::page::{self, escaped};

use super::report::{HEADS, Report};
use crate::table::number;

/// A measured motion and its predictions, of one quantity.
pub struct Course {
    pub title: String,
    pub times: Vec<f64>,
    pub measured: Vec<f64>,
    pub predicted: Vec<f64>,
    pub other: Option<Vec<f64>>,
}

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 260.0;
const LEFT: f64 = 58.0;
const BELOW: f64 = 40.0;
const ABOVE: f64 = 20.0;
const OWN: &str = ".plot { max-width: 34rem; } .plots { display: flex; flex-wrap: wrap; gap: 1rem; } .plots > figure { flex: 1 1 20rem; margin: 0; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; } td, th { padding: .2rem .6rem; text-align: right; border-bottom: 1px solid var(--line); } td:first-child, th:first-child { text-align: left; white-space: nowrap; }
figcaption { color: var(--soft); font-size: .88rem; } .curve { fill: none; stroke-width: 1.8; }";

/// A line or dots of a plot: name, colour, points, whether they are joined.
struct Series {
    name: &'static str,
    colour: &'static str,
    points: Vec<(f64, f64)>,
    joined: bool,
}

/// One axis.
struct Scale {
    from: f64,
    to: f64,
    is_log: bool,
}

impl Scale {
    fn of(values: impl Iterator<Item = f64>, is_log: bool) -> Scale {
        let usable = |value: &f64| value.is_finite() && (!is_log || *value > 0.0);
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        values.filter(usable).for_each(|value| (from, to) = (from.min(value), to.max(value)));
        if from > to {
            (from, to) = if is_log { (0.1, 1.0) } else { (0.0, 1.0) };
        }
        if is_log {
            return Scale { from: from.log10() - 0.03, to: to.log10() + 0.03, is_log };
        }
        let room = if to > from { 0.04 * (to - from) } else { 0.5 * from.abs().max(1e-3) };
        Scale { from: from - room, to: to + room, is_log }
    }

    /// The part of the axis at a value.
    fn part(&self, value: f64) -> f64 {
        let place = if self.is_log { value.log10() } else { value };
        (place - self.from) / (self.to - self.from)
    }

    fn ticks(&self) -> Vec<f64> {
        if self.is_log {
            // decades, or 1, 2, 5 of each where these are few
            let decades = self.from.floor() as i32..=self.to.ceil() as i32;
            let of = |parts: &'static [f64]| {
                let all = decades.clone().flat_map(|power| parts.iter().map(move |m| m * 10_f64.powi(power)));
                let shown = |tick: &f64| (self.from..=self.to).contains(&tick.log10());
                all.filter(shown).collect::<Vec<f64>>()
            };
            let whole = of(&[1.0]);
            return if whole.len() > 3 { whole } else { of(&[1.0, 2.0, 5.0]) };
        }
        let rough = (self.to - self.from) / 5.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= rough);
        let step = step.unwrap_or(rough);
        let first = (self.from / step).ceil() as i64;
        (first..).map(|i| i as f64 * step).take_while(|tick| *tick <= self.to).take(12).collect()
    }
}

/// A plot with its caption.
fn plot(caption: &str, (x_name, y_name): (&str, &str), (x, y): (Scale, Scale), all: &[Series]) -> String {
    let at = |(a, b): (f64, f64)| {
        (LEFT + x.part(a) * (WIDTH - LEFT - 10.0), (HEIGHT - BELOW) - y.part(b) * (HEIGHT - BELOW - ABOVE))
    };
    let mut out = format!(
        "<figure><svg class=\"plot\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">",
        escaped(caption)
    );
    let short = |value: f64| {
        if value.abs() < 1e-12 { "0".to_owned() } else { format!("{}", (value * 1e6).round() / 1e6) }
    };
    let (left, right, top, bottom) = (LEFT, WIDTH - 10.0, ABOVE, HEIGHT - BELOW);
    for tick in x.ticks() {
        let place = LEFT + x.part(tick) * (WIDTH - LEFT - 10.0);
        let label = if x.is_log { format!("{tick:.2e}") } else { short(tick) };
        let label =
            if x.is_log && (1e-3..1e4).contains(&tick) { short((tick * 1e3).round() / 1e3) } else { label };
        let _ = write!(
            out,
            "<line class=\"grid\" x1=\"{place:.1}\" x2=\"{place:.1}\" y1=\"{top}\" y2=\"{bottom}\"/><text x=\"{place:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
            bottom + 15.0
        );
    }
    for tick in y.ticks() {
        let place = bottom - y.part(tick) * (HEIGHT - BELOW - ABOVE);
        let label = if y.is_log { short((tick * 1e4).round() / 1e4) } else { short(tick) };
        let _ = write!(
            out,
            "<line class=\"grid\" x1=\"{left}\" x2=\"{right}\" y1=\"{place:.1}\" y2=\"{place:.1}\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            left - 6.0,
            place + 4.0
        );
    }
    let _ = write!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text><text x=\"{left}\" y=\"10\">{}</text>",
        right,
        HEIGHT - 6.0,
        escaped(x_name),
        escaped(y_name)
    );
    for series in all {
        let usable = |(a, b): &&(f64, f64)| x.part(*a).is_finite() && y.part(*b).is_finite();
        let places = series.points.iter().filter(usable).map(|point| at(*point));
        if series.joined {
            let points: Vec<String> = places.map(|(a, b)| format!("{a:.1},{b:.1}")).collect();
            let _ = write!(
                out,
                "<polyline class=\"curve\" style=\"stroke:var(--{})\" points=\"{}\"/>",
                series.colour,
                points.join(" ")
            );
        } else {
            for (a, b) in places {
                let _ = write!(
                    out,
                    "<circle style=\"fill:var(--{})\" cx=\"{a:.1}\" cy=\"{b:.1}\" r=\"2.6\"/>",
                    series.colour
                );
            }
        }
    }
    out += "</svg><ul class=\"key\">";
    for series in all.iter().filter(|series| !series.name.is_empty()) {
        let _ = write!(
            out,
            "<li><svg viewBox=\"0 0 30 10\" aria-hidden=\"true\"><line x1=\"0\" x2=\"30\" y1=\"5\" y2=\"5\" style=\"stroke:var(--{});stroke-width:3\"/></svg>{}</li>",
            series.colour, series.name
        );
    }
    let _ = write!(out, "</ul><figcaption>{}</figcaption></figure>", escaped(caption));
    out
}

/// The parts of values that are not greater, as a staircase.
fn distribution(values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let mut sorted: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let step = |(i, value): (usize, &f64)| [(*value, i as f64 / n), (*value, (i + 1) as f64 / n)];
    sorted.iter().enumerate().flat_map(step).collect()
}

/// The text of the page.
pub fn page(report: &Report, courses: &[Course]) -> String {
    let title = format!("{}: validation", report.model);
    let mut body = String::from("<div class=\"wide\"><table><thead><tr>");
    for head in HEADS {
        let _ = write!(body, "<th scope=\"col\">{head}</th>");
    }
    body += "</tr></thead><tbody>";
    for (name, summary) in report.rows() {
        let error = summary.standard_error.map_or("-".to_owned(), number);
        let mut numbers: Vec<(String, f64)> =
            summary.quantiles.iter().map(|(part, value)| (part.clone(), *value)).collect();
        numbers.sort_by(|a, b| a.0.parse::<f64>().unwrap_or(0.0).total_cmp(&b.0.parse().unwrap_or(0.0)));
        let cells: String = numbers.iter().map(|(_, value)| format!("<td>{}</td>", number(*value))).collect();
        let _ = write!(
            body,
            "<tr><th scope=\"row\">{name}</th><td>{}</td><td>{}</td><td>{error}</td>{cells}</tr>",
            summary.count,
            number(summary.mean)
        );
    }
    body += "</tbody></table></div>\n<ul>";
    for note in report.notes() {
        let _ = write!(body, "<li>{}</li>", escaped(&note));
    }
    let values: Vec<String> =
        report.values.iter().map(|(name, value)| format!("{name} = {}", number(*value))).collect();
    let units: Vec<String> =
        report.units.iter().map(|(name, unit)| format!("{name}: {}", number(*unit))).collect();
    let _ = write!(
        body,
        "</ul><p class=\"help\">Values: {}. Differences are divided by {}. The error of a motion is the root of their mean square.</p>\n<div class=\"plots\">",
        escaped(&values.join(", ")),
        escaped(&units.join(", "))
    );
    let motions = &report.trajectories;
    let series = |name, colour, points: Vec<(f64, f64)>| Series { name, colour, points, joined: true };
    let mut all =
        vec![series("this prediction", "c0", distribution(motions.iter().filter_map(|one| one.error)))];
    all.push(series("the other", "c1", distribution(motions.iter().filter_map(|one| one.against))));
    all.push(series("nothing moves", "c3", distribution(motions.iter().map(|one| one.at_rest))));
    all.push(series("noise alone", "c2", distribution(motions.iter().filter_map(|one| one.noise))));
    all.push(series("best values of each", "c4", distribution(motions.iter().filter_map(|one| one.floor))));
    all.retain(|series| !series.points.is_empty());
    let x = Scale::of(all.iter().flat_map(|series| series.points.iter().map(|point| point.0)), true);
    let y = Scale { from: 0.0, to: 1.0, is_log: false };
    body += &plot("The part of the motions whose error is not greater.", ("error", "part"), (x, y), &all);
    let pairs: Vec<(f64, f64)> = motions.iter().filter_map(|one| Some((one.against?, one.error?))).collect();
    if !pairs.is_empty() {
        let both = || pairs.iter().flat_map(|pair| [pair.0, pair.1]);
        let usable: Vec<f64> = both().filter(|value| *value > 0.0).collect();
        let ends = [
            usable.iter().copied().fold(f64::INFINITY, f64::min),
            usable.iter().copied().fold(0.0, f64::max),
        ];
        let equal =
            Series { name: "equal", colour: "c3", points: ends.map(|end| (end, end)).to_vec(), joined: true };
        let dots = Series { name: "a motion", colour: "c0", points: pairs.clone(), joined: false };
        body += &plot(
            "Below the line this prediction is nearer.",
            ("error of the other", "error of this prediction"),
            (Scale::of(both(), true), Scale::of(both(), true)),
            &[equal, dots],
        );
    }
    for course in courses {
        let line =
            |values: &[f64]| course.times.iter().copied().zip(values.iter().copied()).collect::<Vec<_>>();
        let mut all =
            vec![Series { name: "measured", colour: "c3", points: line(&course.measured), joined: false }];
        all.push(series("predicted", "c0", line(&course.predicted)));
        if let Some(other) = &course.other {
            all.push(series("the other", "c1", line(other)));
        }
        let x = Scale::of(course.times.iter().copied(), false);
        let y = Scale::of(all.iter().flat_map(|series| series.points.iter().map(|point| point.1)), false);
        body += &plot(&course.title, ("t [s]", ""), (x, y), &all);
    }
    body += "</div>";
    let title = escaped(&title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{}{}{OWN}</style>\n</head>\n<body>\n<header><h1>{title}</h1><p class=\"help\">{}</p></header>\n<main>\n{body}\n</main>\n</body>\n</html>\n",
        page::STYLE,
        hodograph_animation::STYLE,
        escaped(&report.data)
    )
}
