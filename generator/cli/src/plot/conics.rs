//! The figure of Appendix B of the paper, its Fig. 4: the ellipse g = 0, the hyperbola h = 0 and circles of
//! radius mu in the plane of mu cos phi and mu sin phi, and the directions of slip given by their
//! intersections.

use std::f64::consts::{FRAC_PI_2, PI};

use hodograph::{Characteristics, ReducedMatrix, invariant_directions, phi_bar, rates};

use super::figure::{Axis, Figure, Mark, Panel, Series, Sign};
use super::label::Label;

/// Number of points of a curve.
const POINTS: usize = 720;
/// The extent of the figure relative to circles and ellipse, and the largest radius to which the ellipse is
/// drawn (it is large if the contact hardly moves in some direction), relative to the largest circle.
const MARGIN: f64 = 1.15;
const ELLIPSE: f64 = 4.0;
/// A rate counts as zero below this part of its terms.
const NEGLIGIBLE: f64 = 1e-12;

/// The curves of a contact.
struct Conics<'a> {
    m: &'a ReducedMatrix<f64>,
    /// extent of the figure to the right and upwards
    reach: f64,
}

impl Conics<'_> {
    /// b.d, the terms of g and of h without friction: g = b.d - mu d.T d.
    fn terms_without_friction(&self, phi: f64) -> [f64; 2] {
        let (sin, cos) = phi.sin_cos();
        [self.m.nt * cos + self.m.ns * sin, self.m.ns * cos - self.m.nt * sin]
    }

    /// The factors of mu in -g and in -h.
    fn terms_of_friction(&self, phi: f64) -> [f64; 2] {
        let (sin, cos) = phi.sin_cos();
        let m = self.m;
        let along = m.tt * cos * cos + m.ss * sin * sin + 2.0 * m.ts * sin * cos;
        [along, m.ts * (cos * cos - sin * sin) - (m.tt - m.ss) * sin * cos]
    }

    /// A point at this distance from the origin, which may be negative; NaN outside the figure.
    fn place(&self, mu: f64, phi: f64) -> [f64; 2] {
        let (sin, cos) = phi.sin_cos();
        let place = [mu * cos, mu * sin];
        let inside = place.iter().all(|number| number.abs() <= self.reach);
        if inside { place } else { [f64::NAN; 2] }
    }

    /// Points in all directions of a half turn from this angle on.
    fn sweep(&self, from: f64, mu: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        let angle = |index: usize| from + PI * index as f64 / POINTS as f64;
        (0..=POINTS).map(|index| self.place(mu(angle(index)), angle(index))).collect()
    }

    /// g = 0 (69): mu = b.d / d.T d where b.d > 0.
    fn ellipse(&self) -> Vec<[f64; 2]> {
        let ahead = self.m.ns.atan2(self.m.nt);
        self.sweep(ahead - FRAC_PI_2, |phi| {
            self.terms_without_friction(phi)[0] / self.terms_of_friction(phi)[0]
        })
    }

    /// h = 0 (70): its near branch, which passes through the origin, and the remote one. If the contact is
    /// symmetric to the direction of b, the near branch degenerates to one or two lines.
    fn hyperbola(&self) -> [Vec<[f64; 2]>; 2] {
        let ahead = self.m.ns.atan2(self.m.nt);
        let size = self.m.tt + self.m.ss;
        let reference = self.terms_of_friction(ahead)[1];
        if reference.abs() <= NEGLIGIBLE * size
            || self.m.nt.hypot(self.m.ns) <= NEGLIGIBLE * size.max(self.m.nn)
        {
            // A line along b, or along both principal axes of T; and another line perpendicular to b, unless
            // T is isotropic.
            let axis = 0.5 * (2.0 * self.m.ts).atan2(self.m.tt - self.m.ss);
            let straight = |phi: f64| [-1.0, 1.0].map(|end| self.ray(end, phi));
            let balanced = self.m.nt.hypot(self.m.ns) <= NEGLIGIBLE * size.max(self.m.nn);
            let first = straight(if balanced { axis } else { ahead }).to_vec();
            let second = if balanced {
                straight(axis + FRAC_PI_2).to_vec()
            } else {
                // sin(phi - ahead) cancels from both sides of (70).
                let half = 0.5 * (self.m.tt - self.m.ss);
                let twist = self.m.ts * (2.0 * ahead).sin() + half * (2.0 * ahead).cos();
                let b = self.m.nt.hypot(self.m.ns);
                match twist.abs() <= NEGLIGIBLE * size {
                    true => Vec::new(),
                    false => self.sweep(ahead - FRAC_PI_2, |phi| b / (2.0 * twist * (phi - ahead).cos())),
                }
            };
            return [first, second];
        }
        let branch = |near: bool| {
            self.sweep(ahead, |phi| {
                let [free, friction] = [self.terms_without_friction(phi)[1], self.terms_of_friction(phi)[1]];
                if (friction * reference > 0.0) == near { free / friction } else { f64::NAN }
            })
        };
        [branch(true), branch(false)]
    }

    /// The end of a line from the origin to the border of the figure.
    fn ray(&self, end: f64, phi: f64) -> [f64; 2] {
        let (sin, cos) = phi.sin_cos();
        let length = self.reach / sin.abs().max(cos.abs());
        [end * length * cos, end * length * sin]
    }
}

/// The figure of a contact with circles for these coefficients of friction; `phi` is the initial direction of
/// slip, from which slip turns to phi_bar.
pub fn figure(title: &str, m: &ReducedMatrix<f64>, mu: &[f64], phi: f64) -> Figure {
    let found = Characteristics::of(m, 0.0);
    let radius = mu.iter().copied().fold(found.mu_c, f64::max);
    let radius = if radius > 0.0 && radius.is_finite() { radius } else { 1.0 };
    let ellipse = Conics { m, reach: ELLIPSE * radius }.ellipse();
    let farthest = ellipse.iter().flatten().filter(|number| number.is_finite());
    let reach = MARGIN * farthest.fold(radius, |most, number| most.max(number.abs()));
    let conics = Conics { m, reach };
    let [near, remote] = conics.hyperbola();
    let axis = |function: &str| {
        let label = Label::symbol("\u{3bc}", "").then(function).with("\u{3c6}", "");
        Axis { range: Some([-reach, reach]), ..Axis::new(label, "") }
    };
    let mut panel = Panel::new(axis(" cos "), axis(" sin "));
    panel.equal = true;
    panel.title = Label::symbol("s", "").then(" = ").with("n", "").then(" \u{d7} ").with("t", "");
    let curve = |symbol: &str, words: &str| Label::symbol(symbol, "").then(words);
    panel.series.push(Series::new(curve("g", " = 0: inside, slip grows"), 0, conics.ellipse()));
    panel.series.push(Series::new(curve("h", " = 0, near branch"), 1, near));
    panel.series.push(Series::new(curve("h", " = 0, remote branch"), 2, remote));
    for (index, &mu) in mu.iter().enumerate() {
        let turn = |index: usize| 2.0 * PI * index as f64 / POINTS as f64;
        let circle = (0..=POINTS).map(|index| conics.place(mu, turn(index))).collect();
        let style = 3 + index;
        panel.series.push(Series::new(curve("\u{3bc}", &format!(" = {mu}")), style, circle));
        let stop = phi_bar(m, mu, phi);
        for direction in invariant_directions(m, mu).into_iter().flatten() {
            let g = rates(m, mu, direction).y;
            let stops = stop
                .is_some_and(|stop| (stop - direction).sin().abs() < 1e-9 && (stop - direction).cos() > 0.0);
            let (sign, label) = match (g > 0.0, stops) {
                (true, _) => (
                    Sign::Circle,
                    Label::words("C: slip is renewed in this direction, ").with("\u{3c6}\u{302}", ""),
                ),
                (_, true) => (
                    Sign::Block,
                    Label::words("B: slip stops in this direction, ").with("\u{3c6}\u{304}", ""),
                ),
                _ => (Sign::Triangle, Label::words("A: another direction that slip keeps")),
            };
            panel.marks.push(Mark { label, sign, style: Some(style), at: conics.place(mu, direction) });
        }
    }
    let label = Label::words("D: ").with("\u{3bc}", "c").then(", ").with("\u{3c6}", "c");
    panel.marks.push(Mark { label, sign: Sign::Dot, style: None, at: conics.place(found.mu_c, found.phi_c) });
    // in the alphabetical order of the letters
    panel.marks.sort_by_key(|mark| mark.label.plain());
    Figure { panel_size: [560.0, 560.0], ..Figure::new(title) }.panel(panel)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two sleds of the paper, s = n x t.
    const SLEDS: [f64; 6] = [0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211];

    fn residuals(m: &ReducedMatrix<f64>, points: &[[f64; 2]], which: usize) -> usize {
        let mut count = 0;
        for [u, v] in points.iter().filter(|point| point.iter().all(|number| number.is_finite())) {
            let (mu, phi) = (u.hypot(*v), v.atan2(*u));
            // (69), (70): a point at the origin has no direction
            let found = mu * rates(m, mu, phi)[which];
            assert!(found.abs() <= 1e-12 * (1.0 + mu) * (1.0 + mu), "{u} {v}: {found}");
            count += 1;
        }
        count
    }

    /// Every point of the curves lies on its conic, also for contacts whose hyperbola degenerates to two
    /// lines.
    #[test]
    fn curves_are_where_g_and_h_vanish() {
        for (m, pieces) in [
            (SLEDS, [true, true, true]),
            // symmetric to t, and planar
            ([1.0, 0.3, 0.0, 2.0, 0.0, 0.5], [true, true, true]),
            ([1.0, 0.3, 0.0, 2.0, 0.0, 0.0], [true, true, true]),
            // isotropic: one line; balanced: the axes
            ([1.0, 0.3, 0.4, 2.0, 0.0, 2.0], [true, true, false]),
            ([1.0, 0.0, 0.0, 2.0, 0.3, 1.0], [true, true, true]),
        ] {
            let m = ReducedMatrix::from(m);
            let conics = Conics { m: &m, reach: 3.0 };
            let [near, remote] = conics.hyperbola();
            let found = [(conics.ellipse(), 1), (near, 2), (remote, 2)]
                .map(|(points, which)| residuals(&m, &points, which) > 1);
            assert_eq!(found, pieces, "{m:?}");
        }
    }

    /// Fig. 4 has A, B and C on the circle mu = 1.1 < mu_c, and D where ellipse and hyperbola meet.
    #[test]
    fn the_points_of_the_paper_are_marked() {
        let m = ReducedMatrix::from(SLEDS);
        let found = figure("", &m, &[1.1, 1.6], 0.0);
        let of = |letter: &str, style: Option<usize>| {
            let marks = found.panels[0].marks.iter();
            marks.filter(|mark| mark.label.plain().starts_with(letter) && mark.style == style).count()
        };
        assert_eq!((of("C", Some(3)), of("C", Some(4))), (1, 0), "phi_hat exists below mu_c");
        assert_eq!((of("B", Some(3)), of("B", Some(4)), of("D", None)), (1, 1, 1));
        assert!(of("A", Some(3)) >= 1 && of("A", Some(4)) >= 1);
        let d = found.panels[0].marks.last().expect("D").at;
        assert!((d[0].hypot(d[1]) - 1.2147135).abs() < 1e-7);
    }
}
