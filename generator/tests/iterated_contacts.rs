//! Contacts that solve an equation: spheres and ellipsoids on ellipsoids, round shapes on surfaces, curves and implicit
//! surfaces.
//!
//! Places of contact are known in advance: of convex bodies the support points of a direction that is chosen first, of a
//! surface a point that is chosen first. Then the bodies are placed so that they touch there, or are apart along the normal.

use hodograph_generator::model::mechanism::Mechanism;
use hodograph_generator::numeric::hyper_dual::HyperDual;
use hodograph_generator::numeric::views::{dot3, norm3, sub3};
use hodograph_generator::numeric::{Level, State, Views};
use hodograph_random::Random;

use crate::shapes::{
    Pose, Said, V, along, back, compare, evaluator, model, plus, pose, random_state, said, scaled,
};

const POSES: usize = 3000;

/// A n/sqrt(n . A n) of an ellipsoid with these semi-axes: where its outward normal is n.
fn support(sizes: V, n: V) -> V {
    let stretched = [0, 1, 2].map(|i| sizes[i] * n[i]);
    let length = norm3(stretched);
    [0, 1, 2].map(|i| sizes[i] * stretched[i] / length)
}

fn direction(random: &mut Random) -> V {
    loop {
        let v = [0, 1, 2].map(|_| random.number());
        if (0.1..1.0).contains(&norm3(v)) {
            return scaled(v, 1.0 / norm3(v));
        }
    }
}

/// What a contact says at touching poses: the largest differences of gap, normal and point; of the rate of the gap from
/// n . v; and of the rates of normal and point from differences.
#[derive(Debug, Default)]
struct Seen {
    place: f64,
    rate: f64,
    differences: f64,
    poses: usize,
}

impl Seen {
    /// Looks at a state at which the point and the normal of the first contact are known.
    fn look(
        &mut self,
        m: &Mechanism,
        state: &State,
        (point, normal): (V, V),
        size: f64,
        random: &mut Random,
    ) {
        let found = said(m, state).unwrap_or_else(|| panic!("{state:?}"));
        let one = found[0];
        let off = norm3(sub3(one.point, point)).max(one.gap.abs()) / size;
        self.place = self.place.max(off).max(norm3(sub3(one.normal, normal)));
        let contact = &m.contacts[0];
        let views = Views::at(m, state).unwrap();
        let rate = views.now.scalar(contact.gap.as_ref().unwrap(), Level::Geometry).unwrap().e1;
        let velocity = views.now.contact_velocity(contact).unwrap().map(|c| c.re);
        self.rate = self.rate.max((rate - dot3(velocity, one.normal)).abs() / size.max(norm3(velocity)));
        self.poses += 1;
        if !self.poses.is_multiple_of(10) {
            return;
        }
        // along one direction of all coordinates
        let ways: Vec<f64> = state.coordinates.iter().map(|_| random.number()).collect();
        let moved = |h: f64| {
            let mut state = state.clone();
            state.coordinates.iter_mut().zip(&ways).for_each(|(q, d)| *q += h * d);
            said(m, &state).map(|said| said[0])
        };
        let h = 2e-4 * size;
        let around: Option<Vec<Said>> = [-2.0, -1.0, 1.0, 2.0].into_iter().map(|k| moved(k * h)).collect();
        let Some(around) = around else { return };
        let rate = |of: &dyn Fn(&Said) -> f64| -> f64 {
            around.iter().zip([1.0, -8.0, 8.0, -1.0]).map(|(said, w)| w * of(said)).sum::<f64>() / (12.0 * h)
        };
        let second = |of: &dyn Fn(&Said) -> f64| -> f64 {
            let sum: f64 = around.iter().zip([-1.0, 16.0, 16.0, -1.0]).map(|(said, w)| w * of(said)).sum();
            (sum - 30.0 * of(&one)) / (12.0 * h * h)
        };
        let coordinates = state.coordinates.iter().zip(&ways);
        let coordinates = coordinates.map(|(q, d)| HyperDual { re: *q, e1: *d, e2: *d, e12: 0.0 }).collect();
        let values = evaluator(m, state, coordinates);
        let point = values.position(contact.point).unwrap();
        let normal = values.vector(&contact.normal, Level::Geometry).unwrap();
        for axis in 0..3 {
            let off = (rate(&|said| said.point[axis]) - point[axis].e1).abs() / (1.0 + point[axis].e1.abs());
            let tilt =
                (rate(&|said| said.normal[axis]) - normal[axis].e1).abs() / (1.0 + normal[axis].e1.abs());
            let bent = (second(&|said| said.normal[axis]) - normal[axis].e12).abs() * size;
            let bent = 1e-3 * bent / (1.0 + normal[axis].e12.abs());
            self.differences = self.differences.max(off).max(tilt).max(bent);
        }
    }

    fn end(&self, name: &str, most: [f64; 3]) {
        println!(
            "{name}: {:.1e} of places, {:.1e} of rates, {:.1e} beside differences",
            self.place, self.rate, self.differences
        );
        assert!(
            self.place < most[0] && self.rate < most[1] && self.differences < most[2],
            "{name}: {self:?}"
        );
    }
}

/// Moves the body A of a state by a vector.
fn shift(state: &mut State, by: V) {
    (0..3).for_each(|i| state.coordinates[i] += by[i]);
}

/// A centre outside has one point of the surface at which the normal leads to it; that is the nearest one.
#[test]
fn spheres_on_ellipsoids() {
    let m = model("S { of: A, sphere: k }, T { of: B, ellipsoid: [2*k, 3*k, 5*k] }", "S on T");
    let sizes = [0.2, 0.3, 0.5];
    let inside = std::cell::Cell::new(0);
    compare("sphere on ellipsoid", &m, |said, pose| {
        let [one] = said else { panic!() };
        let c = along(sub3(pose.at[0], pose.at[1]), &pose.axes[1]);
        let n = along(one.normal, &pose.axes[1]);
        let distance = one.gap + 0.1;
        // far inside the way out is not the shortest one, or there are several
        if distance < -0.05 {
            return None;
        }
        inside.set(inside.get() + usize::from(distance < 0.0));
        let nearest = plus(c, n, -distance);
        let off = norm3(sub3(nearest, support(sizes, n)));
        let point = norm3(sub3(one.point, plus(pose.at[0], one.normal, -0.1)));
        Some(off.max(point))
    });
    println!("{} centres inside", inside.get());
    assert!(inside.get() > 50);
}

/// Two ellipsoids, placed so that they touch at a direction that is chosen first, and then moved along it.
fn touch(sizes: [V; 2], poses: usize, most: [f64; 3]) {
    let list = |sizes: V| sizes.map(|size| format!("{}*k", 10.0 * size)).join(", ");
    let [own, other] = sizes.map(list);
    let shapes = format!("S {{ of: A, ellipsoid: [{own}] }}, T {{ of: B, ellipsoid: [{other}] }}");
    let m = model(&shapes, "S on T");
    let mut random = Random::new(3);
    let (mut seen, mut wrong, mut apart) = (Seen::default(), 0, 0);
    let least = sizes.iter().flatten().fold(f64::INFINITY, |least, size| size.min(least));
    for _ in 0..poses {
        let mut state = random_state(&mut random, &m);
        let now: Pose = pose(&m, &state);
        let n = direction(&mut random);
        // of A where -n leads out, of B where n does
        let own = plus(now.at[0], back(support(sizes[0], along(n, &now.axes[0])), &now.axes[0]), -1.0);
        let other = plus(now.at[1], back(support(sizes[1], along(n, &now.axes[1])), &now.axes[1]), 1.0);
        shift(&mut state, sub3(other, own));
        seen.look(&m, &state, (other, n), least, &mut random);
        // moved along n they are apart, or overlap
        let by = 0.1 * least * random.number();
        shift(&mut state, scaled(n, by));
        apart += usize::from(by > 0.0);
        wrong += usize::from((said(&m, &state).unwrap()[0].gap > 0.0) != (by > 0.0));
    }
    seen.end(&shapes, most);
    println!("{apart} of {poses} apart, {wrong} with the wrong sign");
    assert!(wrong == 0 && apart > poses / 3);
}

#[test]
fn ellipsoids_touch_at_their_support_points() {
    touch([[0.2, 0.3, 0.5], [0.4, 0.1, 0.2]], POSES, [1e-12, 1e-12, 1e-6]);
}

/// Semi-axes in ratios of 10 to 100.
#[test]
fn needles_and_discs_touch() {
    touch([[0.01, 0.1, 1.0], [1.0, 0.1, 0.3]], POSES / 5, [1e-10, 1e-11, 1e-5]);
    touch([[1.0, 0.9, 0.01], [0.02, 0.02, 1.0]], POSES / 5, [1e-10, 1e-11, 1e-5]);
    touch([[0.1, 0.1, 0.1], [10.0, 0.1, 0.1]], POSES / 5, [1e-10, 1e-11, 1e-5]);
}

/// A kind of ground: as a shape, along which axis it is high, the radius in m of a sphere that just fits into its hollows
/// (0.9 of their least radius), and its height with its slopes.
type Ground = (&'static str, usize, f64, fn(f64, f64) -> (f64, [f64; 2]));

const GROUNDS: [Ground; 2] =
    [("surface: k*sin(3*x/k/10)*cos(2*y/k/10)", 2, 1.0, waves), ("curve: k*sin(3*x/k/10)^2", 1, 0.5, road)];

fn waves(x: f64, y: f64) -> (f64, [f64; 2]) {
    let ((sx, cx), (sy, cy)) = ((3.0 * x).sin_cos(), (2.0 * y).sin_cos());
    (0.1 * sx * cy, [0.3 * cx * cy, -0.2 * sx * sy])
}

fn road(x: f64, _: f64) -> (f64, [f64; 2]) {
    let (s, c) = (3.0 * x).sin_cos();
    (0.1 * s * s, [0.6 * s * c, 0.0])
}

/// A sphere of this radius, m, on a ground.
fn on_ground(ground: &str, radius: f64) -> Mechanism {
    model(&format!("S {{ of: A, sphere: {}*k }}, W {{ of: B, {ground} }}", 10.0 * radius), "S on W")
}

#[test]
fn spheres_on_heights() {
    for ((shape, up, tight, height), radius) in
        GROUNDS.into_iter().flat_map(|ground| [0.1, ground.2].map(|radius| (ground, radius)))
    {
        let m = on_ground(shape, radius);
        let mut random = Random::new(11);
        let (mut seen, mut wrong) = (Seen::default(), 0);
        for _ in 0..if radius < tight { POSES } else { POSES / 5 } {
            let mut state = random_state(&mut random, &m);
            let now: Pose = pose(&m, &state);
            let place = [0, 1].map(|_| 2.0 * random.number());
            let (level, [sx, sy]) = height(place[0], place[1]);
            let (foot, n) = if up == 1 {
                ([place[0], level, place[1]], [-sx, 1.0, 0.0])
            } else {
                ([place[0], place[1], level], [-sx, -sy, 1.0])
            };
            let n = back(scaled(n, 1.0 / norm3(n)), &now.axes[1]);
            let foot = plus(now.at[1], back(foot, &now.axes[1]), 1.0);
            shift(&mut state, sub3(plus(foot, n, radius), now.at[0]));
            seen.look(&m, &state, (foot, n), 0.3, &mut random);
            let by = 0.02 * random.number();
            shift(&mut state, scaled(n, by));
            wrong += usize::from((said(&m, &state).unwrap()[0].gap > 0.0) != (by > 0.0));
        }
        // where the sphere just fits places are known worse, by the least eigenvalue of Newton's matrix
        seen.end(&format!("{radius} m on {shape}"), [1e-12, 1e-12, if radius < tight { 1e-6 } else { 1e-3 }]);
        assert!(wrong == 0);
    }
}

/// A sphere that is larger than a hollow touches it at several places: either an error says so, by name, or the place that
/// is found is the one that it touches first.
#[test]
fn spheres_that_do_not_fit_touch_first_where_they_are_said_to() {
    for (shape, up, tight, height) in GROUNDS {
        // up to twice as large as what fits, and more
        let (mut refused, mut right, mut worst) = (0, 0, [0.0_f64; 2]);
        for times in [1.5, 2.0, 4.0, 10.0] {
            let radius = times * tight;
            let m = on_ground(shape, radius);
            let mut random = Random::new(13);
            let mut state = State::of(&m);
            state.coordinates.iter_mut().for_each(|q| *q = 0.0);
            for _ in 0..150 {
                let [x, y] = [0, 1].map(|_| 2.0 * random.number());
                (state.coordinates[0], state.coordinates[1], state.coordinates[2]) = (x, y, y);
                // the level at which the gap that is said at some level above vanishes
                state.coordinates[up] = 5.0 * radius;
                let Some(found) = said(&m, &state) else {
                    refused += 1;
                    continue;
                };
                state.coordinates[up] -= found[0].gap / found[0].normal[up];
                if said(&m, &state).is_none() {
                    refused += 1;
                    continue;
                }
                // the greatest level at which the sphere touches the ground at any place under it
                let mut highest = f64::NEG_INFINITY;
                let across = if up == 1 { 0..=0 } else { -100..=100 };
                for j in across {
                    for i in -100..=100 {
                        let [a, b] = [i, j].map(|i| 0.01 * radius * f64::from(i));
                        let below = radius * radius - a * a - b * b;
                        if below >= 0.0 {
                            highest = highest.max(height(x + a, y + b).0 + below.sqrt());
                        }
                    }
                }
                right += 1;
                let off = (highest - state.coordinates[up]) / radius;
                let worst = &mut worst[usize::from(times > 2.0)];
                *worst = worst.max(off);
            }
        }
        println!("{shape}: {refused} refused, {right} found, at most {worst:?} of the radius in the ground");
        assert!(refused > 60 && right > 6, "{shape}: {refused} {right}");
        // under much larger spheres a crest may lie between the places at which the ground is looked at
        assert!(worst[0] < 5e-3 && worst[1] < 0.03, "{shape}: {worst:?}");
    }
}

/// A function of a place, m, with its gradient.
type OfPlace = fn(V) -> (f64, V);

/// Surfaces f(x, y, z) = 0: as shapes, and these functions.
const SURFACES: [(&str, OfPlace); 6] = [
    ("implicit: (x/(9*k))^2 + (y/(6*k))^2 + (z/(8*k))^2 - 1", egg),
    // free within
    ("implicit: 100*k^2 - x^2 - y^2 - z^2", bowl),
    ("implicit: (sqrt(x^2 + y^2) - 8*k)^2 + z^2 - 9*k^2", ring),
    ("implicit: sin(x/k/5)*cos(y/k/5) + sin(y/k/5)*cos(z/k/5) + sin(z/k/5)*cos(x/k/5)", gyroid),
    ("surface: k*sin(3*x/k/10)*cos(2*y/k/10)", above_waves),
    ("curve: k*sin(3*x/k/10)^2", above_road),
];

fn egg(p: V) -> (f64, V) {
    let s = [0.9, 0.6, 0.8].map(|l: f64| 1.0 / (l * l));
    ((0..3).map(|i| s[i] * p[i] * p[i]).sum::<f64>() - 1.0, [0, 1, 2].map(|i| 2.0 * s[i] * p[i]))
}

fn bowl(p: V) -> (f64, V) {
    (1.0 - dot3(p, p), scaled(p, -2.0))
}

fn ring(p: V) -> (f64, V) {
    let away = p[0].hypot(p[1]);
    let off = away - 0.8;
    (off * off + p[2] * p[2] - 0.09, [2.0 * off * p[0] / away, 2.0 * off * p[1] / away, 2.0 * p[2]])
}

fn gyroid(p: V) -> (f64, V) {
    let [x, y, z] = p.map(|x| (2.0 * x).sin_cos());
    let value = x.0 * y.1 + y.0 * z.1 + z.0 * x.1;
    let slope = |a: (f64, f64), b: (f64, f64), c: (f64, f64)| 2.0 * (a.1 * b.1 - c.0 * a.0);
    (value, [slope(x, y, z), slope(y, z, x), slope(z, x, y)])
}

fn above_waves(p: V) -> (f64, V) {
    let (level, [sx, sy]) = waves(p[0], p[1]);
    (p[2] - level, [-sx, -sy, 1.0])
}

fn above_road(p: V) -> (f64, V) {
    let (level, [slope, _]) = road(p[0], p[1]);
    (p[1] - level, [-slope, 1.0, 0.0])
}

/// A place on a surface, and the normal there.
fn on_surface(function: OfPlace, random: &mut Random) -> (V, V) {
    loop {
        let mut place = [0, 1, 2].map(|_| 1.5 * random.number());
        for _ in 0..50 {
            let (value, slopes) = function(place);
            place = plus(place, slopes, -value / dot3(slopes, slopes));
        }
        let (value, slopes) = function(place);
        if value.abs() < 1e-14 && norm3(place) < 3.0 && norm3(slopes) > 1e-3 {
            return (place, scaled(slopes, 1.0 / norm3(slopes)));
        }
    }
}

/// A round shape: as it is written, and its place furthest along a direction.
type RoundShape = (&'static str, fn(V) -> V);

const ROUND: [RoundShape; 5] = [
    ("sphere: k", |n| scaled(n, 0.1)),
    ("sphere: 4*k", |n| scaled(n, 0.4)),
    ("ellipsoid: [k, 2*k, 3*k/2]", |n| support([0.1, 0.2, 0.15], n)),
    ("disc: 2*k, axis: E.y", |n| rim(0.2, n)),
    ("torus: [2*k, k/2], axis: E.y", |n| plus(rim(0.2, n), n, 0.05)),
];

/// Of a circle about y.
fn rim(radius: f64, n: V) -> V {
    let away = n[0].hypot(n[2]);
    [radius * n[0] / away, 0.0, radius * n[2] / away]
}

/// The number of poses is that of `HODOGRAPH_POSES`, else 60.
#[test]
fn round_shapes_on_surfaces() {
    let poses = std::env::var("HODOGRAPH_POSES").ok().and_then(|poses| poses.parse().ok()).unwrap_or(60);
    for ((surface, function), (round, furthest)) in
        SURFACES.into_iter().flat_map(|surface| ROUND.map(|round| (surface, round)))
    {
        let m = model(&format!("S {{ of: A, {round} }}, T {{ of: B, {surface} }}"), "S on T");
        let mut random = Random::new(17);
        let (mut seen, mut wrong, mut refused, mut elsewhere, mut missed) = (Seen::default(), 0, 0, 0, 0);
        while seen.poses < poses {
            let mut state = random_state(&mut random, &m);
            let now: Pose = pose(&m, &state);
            let (foot, n) = on_surface(function, &mut random);
            let n = back(n, &now.axes[1]);
            let foot = plus(now.at[1], back(foot, &now.axes[1]), 1.0);
            let against = along(scaled(n, -1.0), &now.axes[0]);
            // rims that lie flat touch everywhere
            if against[0].hypot(against[2]) < 0.05 {
                continue;
            }
            let reach = back(furthest(against), &now.axes[0]);
            shift(&mut state, sub3(sub3(foot, reach), now.at[0]));
            // poses in which another place is in the ground
            let centre = pose(&m, &state).at[0];
            let in_ground = (0..200).any(|_| {
                let place = furthest(direction(&mut random));
                let place = sub3(plus(centre, back(place, &now.axes[0]), 1.0), now.at[1]);
                function(along(place, &now.axes[1])).0 < -1e-9
            });
            if in_ground {
                elsewhere += 1;
                continue;
            }
            if said(&m, &state).is_none() {
                refused += 1;
                continue;
            }
            // where it is in the ground there is the one that counts
            let one = said(&m, &state).unwrap()[0];
            let place = along(sub3(one.point, now.at[1]), &now.axes[1]);
            if function(place).0 < -1e-9 {
                elsewhere += 1;
                continue;
            }
            // another place of the rim is almost as deep as this one
            if one.gap > 1e-9 {
                assert!(one.gap < 1e-4, "{round} on {surface}: {}", one.gap);
                missed += 1;
                continue;
            }
            seen.look(&m, &state, (foot, n), 0.1, &mut random);
            let by = 0.01 * random.number();
            shift(&mut state, scaled(n, by));
            wrong += usize::from(said(&m, &state).is_some_and(|said| (said[0].gap > 0.0) != (by > 0.0)));
        }
        let name = format!("{round} on {surface}");
        println!("{name}: {refused} refused, {elsewhere} in the ground elsewhere, {missed} missed");
        // rims that lie almost flat have places that are known worse
        let flat = round.contains("axis");
        seen.end(&name, if flat { [1e-11, 1e-12, 2e-3] } else { [1e-13, 1e-13, 1e-8] });
        assert!(wrong == 0 && elsewhere * 4 < poses, "{name}: {wrong} {elsewhere}");
        assert!((refused + missed) * 100 <= poses.max(100), "{name}: {refused} {missed}");
    }
}
