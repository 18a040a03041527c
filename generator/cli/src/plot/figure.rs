//! Draws hodographs: v_s over v_t, v_n and s over I_n.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::trace::{Moment, Trace};

/// Width of a panel and height, in pixels.
const PANEL: (u32, u32) = (420, 420);
/// Colours that can be told apart by all readers and in print.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 90, 160),
    RGBColor(200, 80, 0),
    RGBColor(0, 130, 90),
    RGBColor(150, 50, 130),
    RGBColor(110, 110, 110),
    RGBColor(160, 130, 0),
];

type Reason = Box<dyn std::error::Error>;

/// The drawing as SVG.
///
/// # Errors
///
/// What the plotting library says.
pub fn svg(title: &str, traces: &[Trace]) -> Result<String, Reason> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (3 * PANEL.0, PANEL.1 + 40)).into_drawing_area();
        area.fill(&WHITE)?;
        let area = area.titled(title, ("sans-serif", 18))?;
        let panels = area.split_evenly((1, 3));
        let hodograph = |moment: &Moment| (moment.velocity[1], moment.velocity[2]);
        panel(&panels[0], traces, "hodograph: v_s over v_t [m/s]", true, hodograph)?;
        let normal = |moment: &Moment| (moment.impulse, moment.velocity[0]);
        panel(&panels[1], traces, "v_n [m/s] over I_n [N s]", false, normal)?;
        let slip = |moment: &Moment| (moment.impulse, moment.slip());
        panel(&panels[2], traces, "s [m/s] over I_n [N s]", false, slip)?;
        area.present()?;
    }
    Ok(text)
}

fn panel(
    area: &DrawingArea<SVGBackend, Shift>,
    traces: &[Trace],
    title: &str,
    same_scale: bool,
    pick: impl Fn(&Moment) -> (f64, f64),
) -> Result<(), Reason> {
    let points = || traces.iter().flat_map(|trace| &trace.moments).map(&pick);
    let (mut x, mut y) = (spread(points().map(|point| point.0)), spread(points().map(|point| point.1)));
    if same_scale {
        let widest = (x.end - x.start).max(y.end - y.start);
        x = widened(x, widest);
        y = widened(y, widest);
    }
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 15))
        .margin(10)
        .x_label_area_size(35)
        .y_label_area_size(50)
        .build_cartesian_2d(x.clone(), y.clone())?;
    chart.configure_mesh().light_line_style(WHITE).x_labels(6).y_labels(6).draw()?;
    let faint = BLACK.mix(0.4);
    for line in [[(x.start, 0.0), (x.end, 0.0)], [(0.0, y.start), (0.0, y.end)]] {
        if line
            .iter()
            .all(|point| x.start <= point.0 && point.0 <= x.end && y.start <= point.1 && point.1 <= y.end)
        {
            chart.draw_series([PathElement::new(line.to_vec(), faint)])?;
        }
    }
    for (trace, colour) in traces.iter().zip(COLOURS.iter().cycle()) {
        let line = LineSeries::new(trace.moments.iter().map(&pick), colour.stroke_width(2));
        chart
            .draw_series(line)?
            .label(format!("mu = {}", trace.mu))
            .legend(|(x, y)| PathElement::new(vec![(x, y), (x + 16, y)], colour.stroke_width(2)));
        let [newton, poisson, stronge] = trace.ends.map(|end| end.as_ref().map(&pick));
        chart.draw_series(newton.map(|at| Circle::new(at, 5, colour.stroke_width(2))))?;
        chart.draw_series(poisson.map(|at| Cross::new(at, 5, colour.stroke_width(2))))?;
        chart
            .draw_series(stronge.map(|at| {
                EmptyElement::at(at) + Rectangle::new([(-5, -5), (5, 5)], colour.stroke_width(2))
            }))?;
    }
    if same_scale {
        let labels = &mut chart.configure_series_labels();
        let labels = labels.position(SeriesLabelPosition::UpperRight);
        labels.background_style(WHITE.mix(0.8)).border_style(faint).draw()?;
    }
    Ok(())
}

/// The range of the numbers with a margin.
fn spread(numbers: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = numbers
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| (low.min(number), high.max(number)));
    if low > high {
        return -1.0..1.0;
    }
    let margin = match high - low {
        0.0 => high.abs().max(1e-300),
        width => 0.08 * width,
    };
    low - margin..high + margin
}

fn widened(range: Range<f64>, width: f64) -> Range<f64> {
    let more = (width - (range.end - range.start)) / 2.0;
    range.start - more..range.end + more
}
