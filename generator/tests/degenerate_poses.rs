//! Pairs of shapes at poses where features are parallel, or almost: faces flush, edges along edges, capsules side by side,
//! rims that almost lie flat. Distances are those of numbers with twice the digits, from the places and axes that the model
//! has at the pose.

use hodograph_arithmetic::DoubleDouble;
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_generator::numeric::{Failure, Level, State};

use crate::shapes::{Pose, Said, evaluator, model, pose, said, still};

type D = DoubleDouble<f64>;
type Place = [D; 3];

/// Angles between what is almost parallel, rad.
const ANGLES: [f64; 11] = [0.0, 1e-17, 1e-16, 1e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3, 0.1];

fn d(x: f64) -> D {
    D::new(x)
}

fn place(v: [f64; 3]) -> Place {
    v.map(d)
}

fn plus(a: Place, b: Place, s: D) -> Place {
    [0, 1, 2].map(|i| a[i] + s * b[i])
}

fn minus(a: Place, b: Place) -> Place {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: Place, b: Place) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: Place) -> D {
    dot(a, a).sqrt()
}

fn least(list: impl IntoIterator<Item = D>) -> D {
    list.into_iter().reduce(|a, b| if b.is_less(a) { b } else { a }).unwrap()
}

/// The value nearest to x within `-half` and `half`.
fn held(x: D, half: D) -> D {
    let below = least([x, half]);
    if below.is_less(-half) { -half } else { below }
}

/// A segment: its middle, the unit vector along it, and half its length.
type Segment = (Place, Place, D);

/// The distance of two segments: of each end to the other segment, and of their insides where both are nearest there.
fn between_segments((a_0, a, h): Segment, (b_0, b, k): Segment) -> D {
    let to = |p: Place, (from, along, half): Segment| {
        let t = held(dot(minus(p, from), along), half);
        length(minus(p, plus(from, along, t)))
    };
    let mut found = vec![];
    for sign in [-1.0, 1.0] {
        found.push(to(plus(a_0, a, d(sign) * h), (b_0, b, k)));
        found.push(to(plus(b_0, b, d(sign) * k), (a_0, a, h)));
    }
    // places s and t of the common perpendicular
    let (c, w) = (dot(a, b), minus(a_0, b_0));
    let square = d(1.0) - c * c;
    if !square.is_less(d(1e-28)) {
        let (e, f) = (dot(w, a), dot(w, b));
        let (s, t) = ((c * f - e) / square, (f - c * e) / square);
        let inside = |x: D, half: D| !half.is_less(x) && !x.is_less(-half);
        if inside(s, h) && inside(t, k) {
            found.push(length(minus(plus(a_0, a, s), plus(b_0, b, t))));
        }
    }
    least(found)
}

/// A box: its middle, its axes, and half its lengths.
struct Crate {
    middle: Place,
    axes: [Place; 3],
    half: Place,
}

impl Crate {
    fn of(pose: &Pose, body: usize, half: [f64; 3]) -> Crate {
        Crate { middle: place(pose.at[body]), axes: pose.axes[body].map(place), half: place(half) }
    }

    fn corner(&self, signs: [f64; 3]) -> Place {
        (0..3).fold(self.middle, |p, i| plus(p, self.axes[i], d(signs[i]) * self.half[i]))
    }

    fn corners(&self) -> Vec<Place> {
        let sign = |number: usize, i: usize| if number >> i & 1 == 0 { 1.0 } else { -1.0 };
        (0..8).map(|number| self.corner([0, 1, 2].map(|i| sign(number, i)))).collect()
    }

    fn edges(&self) -> Vec<Segment> {
        let edge = |i: usize, number: usize| {
            let mut signs = [0.0; 3];
            signs[(i + 1) % 3] = if number & 1 == 0 { 1.0 } else { -1.0 };
            signs[(i + 2) % 3] = if number & 2 == 0 { 1.0 } else { -1.0 };
            (self.corner(signs), self.axes[i], self.half[i])
        };
        (0..3).flat_map(|i| (0..4).map(move |number| edge(i, number))).collect()
    }

    /// The distance of a place outside.
    fn to(&self, p: Place) -> D {
        let w = minus(p, self.middle);
        let nearest =
            (0..3).fold(self.middle, |q, i| plus(q, self.axes[i], held(dot(w, self.axes[i]), self.half[i])));
        length(minus(p, nearest))
    }

    fn apart(&self, other: &Crate) -> D {
        let own = self.corners().into_iter().map(|corner| other.to(corner));
        let theirs = other.corners().into_iter().map(|corner| self.to(corner));
        let edges = self.edges();
        let across = other
            .edges()
            .into_iter()
            .flat_map(|edge| edges.iter().map(move |own| between_segments(*own, edge)));
        least(own.chain(theirs).chain(across))
    }
}

/// The least gap of the contacts that are valid.
fn least_valid(m: &Mechanism, state: &State) -> Option<Said> {
    let found = said(m, state)?;
    let values = evaluator(m, state, still(state));
    let valid = m.contacts.iter().zip(found).filter(|(contact, _)| {
        let validity =
            contact.validity.as_ref().map(|validity| values.scalar(validity, Level::Geometry).unwrap().re);
        validity.is_none_or(|validity| validity >= 0.0)
    });
    valid.map(|(_, said)| said).min_by(|a, b| a.gap.total_cmp(&b.gap))
}

/// Differences of the least gaps from known distances.
#[derive(Default)]
struct Seen {
    worst: f64,
    poses: usize,
    /// poses without a valid contact
    none: usize,
}

impl Seen {
    fn look(&mut self, m: &Mechanism, state: &State, known: f64) {
        self.poses += 1;
        match least_valid(m, state) {
            Some(found) => self.worst = self.worst.max((found.gap - known).abs()),
            None => self.none += 1,
        }
    }

    fn end(&self) {
        let Seen { worst, poses, none } = self;
        println!("{poses} poses: {worst:.1e}, {none} without a valid contact");
        assert!(*worst < 1e-12 && *none == 0, "{worst:e} {none}");
    }
}

/// A state with these coordinates of A, then of B.
fn at(m: &Mechanism, a: [f64; 6], b: [f64; 6]) -> State {
    let mut state = State::of(m);
    state.coordinates.iter_mut().zip(a.into_iter().chain(b)).for_each(|(q, value)| *q = value);
    state
}

/// A crate over another, flush but for two small angles, turned about the vertical by an angle that may be small too: over the
/// middle, over an edge and over corners.
#[test]
fn flush_faces_and_parallel_edges() {
    let m = model("S { of: A, box: [4*k, 6*k, 8*k] }, T { of: B, box: [6*k, 4*k, 5*k] }", "S on T");
    let mut seen = Seen::default();
    let overhangs = [[0.0, 0.0], [0.3, 0.1], [0.4, 0.3], [-0.2, 0.3], [0.1, -0.1]];
    for (x, y) in ANGLES.iter().flat_map(|x| [1.0, -1.0].map(|sign| (sign * x, 0.7 * x))) {
        for turned in ANGLES.iter().flat_map(|t| [*t, *t + std::f64::consts::FRAC_PI_2]) {
            for [p, q] in overhangs {
                // far enough above not to touch where it is tilted
                let above = 0.66 + 0.6 * (x.abs() + y.abs());
                let state = at(&m, [p, q, above, x, y, turned], [0.0; 6]);
                let pose = pose(&m, &state);
                let crates = [Crate::of(&pose, 0, [0.2, 0.3, 0.4]), Crate::of(&pose, 1, [0.3, 0.2, 0.25])];
                seen.look(&m, &state, crates[0].apart(&crates[1]).rounded());
            }
        }
    }
    seen.end();
}

/// Capsules side by side.
#[test]
fn parallel_capsules() {
    let shapes = "S { of: A, capsule: [k, 8*k], axis: E.x }, T { of: B, capsule: [2*k, 12*k], axis: F.x }";
    let m = model(shapes, "S on T");
    let mut worst = 0.0_f64;
    for (tilt, turned) in ANGLES.iter().flat_map(|a| ANGLES.map(|b| (*a, b))) {
        for along in [-1.3, -0.9, -0.2, 0.0, 0.3, 0.7, 1.0] {
            let state = at(&m, [along, 0.3, 0.4, 0.0, tilt, turned], [0.0; 6]);
            let pose = pose(&m, &state);
            let segment = |body: usize, half: f64| (place(pose.at[body]), place(pose.axes[body][0]), d(half));
            let known = between_segments(segment(0, 0.4), segment(1, 0.6)).rounded() - 0.3;
            let found = said(&m, &state).unwrap()[0];
            worst = worst.max((found.gap - known).abs());
        }
    }
    println!("{worst:.1e}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// The rim of a disc, of a cylinder and of a torus over a plane: with the axis a and the normal n its lowest place is
/// R abs(n x a) below the centre. Flat, the place is lost, which is an error with a name.
#[test]
fn rims_that_almost_lie_flat() {
    let shapes =
        [("disc: 2*k", 0.0, 0.0), ("cylinder: [2*k, 2*k]", 0.1, 0.0), ("torus: [2*k, k/2]", 0.0, 0.05)];
    for (shape, half, tube) in shapes {
        let m = model(&format!("S {{ of: A, {shape}, axis: E.z }}, T {{ of: B, plane: F.z }}"), "S on T");
        let mut worst = 0.0_f64;
        for lean in ANGLES.into_iter().filter(|lean| *lean > 1e-12) {
            for turned in [0.0, 0.3, 1.0, 2.0, 4.0] {
                let state = at(&m, [0.1, 0.2, 0.5, lean, 0.3 * lean, turned], [0.0; 6]);
                let pose = pose(&m, &state);
                let (a, n) = (place(pose.axes[0][2]), place(pose.axes[1][2]));
                let across = [0, 1, 2].map(|i| {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    n[j] * a[k] - n[k] * a[j]
                });
                let low = d(0.2) * length(across);
                let height = dot(minus(place(pose.at[0]), place(pose.at[1])), n);
                for (found, sign) in said(&m, &state).unwrap().into_iter().zip([1.0, -1.0]) {
                    let centre = height + d(sign * half) * dot(a, n);
                    let known = (centre - low - d(tube)).rounded();
                    worst = worst.max((found.gap - known).abs());
                }
            }
        }
        println!("{shape}: {worst:.1e}");
        assert!(worst < 1e-12, "{shape}: {worst:e}");
        let state = at(&m, [0.1, 0.2, 0.5, 0.0, 0.0, 0.3], [0.0; 6]);
        let values = evaluator(&m, &state, still(&state));
        let lost = values.position(m.contacts[0].point);
        assert!(matches!(lost, Err(Failure::DivisionByZero(_))), "{shape}: {lost:?}");
    }
}

/// A capsule along a face and along an edge of a box.
#[test]
fn capsules_along_boxes() {
    let shapes = "S { of: A, capsule: [k, 8*k], axis: E.x }, T { of: B, box: [6*k, 4*k, 5*k] }";
    let m = model(shapes, "S on T");
    let mut seen = Seen::default();
    for (tilt, turned) in ANGLES.iter().flat_map(|a| ANGLES.map(|b| (*a, b))) {
        for [x, y] in [[0.0, 0.0], [0.3, 0.1], [0.1, 0.2], [0.5, 0.2], [0.2, 0.35], [0.9, 0.3]] {
            let state = at(&m, [x, y, 0.4 + 0.5 * tilt, 0.0, tilt, turned], [0.0; 6]);
            let pose = pose(&m, &state);
            let own = Crate::of(&pose, 1, [0.3, 0.2, 0.25]);
            let segment = (place(pose.at[0]), place(pose.axes[0][0]), d(0.4));
            let ends = [-1.0, 1.0].map(|sign| own.to(plus(segment.0, segment.1, d(sign) * segment.2)));
            let edges = own.edges().into_iter().map(|edge| between_segments(segment, edge));
            seen.look(&m, &state, least(edges.chain(ends)).rounded() - 0.1);
        }
    }
    seen.end();
}
