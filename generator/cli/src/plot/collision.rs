//! The figure of a collision's course, as Fig. 3 of the paper: v_s over v_t, and v_n and the speed of slip
//! over I_n.
//!
//! The paper draws its Fig. 3 with s = t x n; here s = n x t, so that the first panel is its mirror image.

use hodograph::Law;

use super::figure::{Axis, Figure, Legend, Mark, Panel, Series, Sign};
use super::label::Label;
use super::trace::{Sample, Trace};

/// The marks of the ends of a collision by each law, in the order of [`Law::ALL`].
const SIGNS: [Sign; 3] = [Sign::Circle, Sign::Cross, Sign::Square];
const _: () = assert!(SIGNS.len() == Law::ALL.len(), "every law needs a sign");

/// The coordinates of a sample in a panel.
type Pick = fn(&Sample) -> [f64; 2];

/// The figure of collisions that differ in friction.
pub fn figure(title: &str, traces: &[Trace]) -> Figure {
    let velocity = |index: &str| Axis::new(Label::symbol("v", index), "m/s");
    let impulse = || Axis::new(Label::symbol("I", "n"), "N\u{b7}s");
    let slip = Axis::new(Label::words("speed of slip ").with("s", ""), "m/s");
    let panels: [(&str, Panel, Pick); 3] = [
        ("hodograph", Panel::new(velocity("t"), velocity("s")), |sample| {
            [sample.velocity[1], sample.velocity[2]]
        }),
        ("normal velocity", Panel::new(impulse(), velocity("n")), |sample| {
            [sample.impulse, sample.velocity[0]]
        }),
        ("slip", Panel::new(impulse(), slip), |sample| [sample.impulse, sample.slip()]),
    ];
    let empty =
        Figure { columns: 3, panel_size: [410.0, 400.0], legend: Legend::Below, ..Figure::new(title) };
    panels.into_iter().fold(empty, |figure, (caption, mut panel, pick)| {
        panel.equal = caption.starts_with("hodograph");
        panel.title = Label::words(caption);
        if panel.equal {
            panel.title = Label::words("hodograph of slip, ")
                .with("s", "")
                .then(" = ")
                .with("n", "")
                .then(" \u{d7} ")
                .with("t", "");
            directions(&mut panel, traces);
        }
        fill(&mut panel, traces, pick);
        figure.panel(panel)
    })
}

/// Rays in the directions phi_bar in which slip stops (section 3.2).
fn directions(panel: &mut Panel, traces: &[Trace]) {
    for (index, trace) in traces.iter().enumerate() {
        let (Some(phi), Some(first)) = (trace.phi_bar, trace.samples.first()) else { continue };
        // The ray indicates the direction of the curve near the origin.
        let length = 0.3 * first.slip();
        // adding 0 turns -0 into 0
        let label = Label::symbol("\u{3c6}\u{304}", "")
            .then(&format!(" = {:.3} rad", phi + 0.0).replace('-', "\u{2212}"));
        let ray = vec![[0.0, 0.0], [length * phi.cos(), length * phi.sin()]];
        panel.series.push(Series::new(label, index + 6, ray));
    }
}

fn fill(panel: &mut Panel, traces: &[Trace], pick: Pick) {
    for (index, trace) in traces.iter().enumerate() {
        let Some(first) = trace.samples.first() else { continue };
        let points = trace.samples.iter().map(pick).collect();
        let label = Label::symbol("\u{3bc}", "").then(&format!(" = {}", trace.mu));
        panel.series.push(Series { directed: true, ..Series::new(label, index, points) });
        let start = Label::words("approach");
        panel.marks.push(Mark { label: start, sign: Sign::Dot, style: None, at: pick(first) });
        for ((sign, end), law) in SIGNS.into_iter().zip(&trace.ends).zip(Law::ALL) {
            let (initial, rest) = law.name().split_at(1);
            let label = Label::words(&format!("end by {}{rest}'s law", initial.to_uppercase()));
            let mark = |end| Mark { label: label.clone(), sign, style: Some(index), at: pick(end) };
            panel.marks.extend(end.as_ref().map(mark));
        }
    }
}
