//! The bound from below on how far two shapes are apart (docs/theory.md, 16.14), against their points and their gaps.

use hodograph_generator::numeric::Level;
use hodograph_generator::numeric::views::{norm3, sub3};
use hodograph_random::Random;

use crate::shapes::{V, back, evaluator, model, plus, pose, random_state, said, still};

/// Random poses of each pair of shapes.
const POSES: usize = 700;

/// Points of a shape along the axes of its body from the mass centre, and the radius about them that is its own.
type Points = (Vec<V>, f64);

fn box_of(half: V) -> Points {
    let corner = |number: usize| [0, 1, 2].map(|i| if number >> i & 1 == 0 { half[i] } else { -half[i] });
    ((0..8).map(corner).collect(), 0.0)
}

/// No points of two shapes are nearer to each other than their clearance, and no contact of theirs has a gap below it
/// where it is valid, or touches where it is not.
#[test]
fn no_two_points_are_nearer_than_the_clearance() {
    let capsule = ("capsule: [k, 10*k], axis: {}.x", (vec![[0.5, 0.0, 0.0], [-0.5, 0.0, 0.0]], 0.1));
    let cube = ("box: [4*k, 6*k, 8*k]", box_of([0.2, 0.3, 0.4]));
    let slab = ("at: {P} + 2*k*{}.y, box: [8*k, k, 2*k]", {
        let (points, radius) = box_of([0.4, 0.05, 0.1]);
        (points.iter().map(|p| [p[0], p[1] + 0.2, p[2]]).collect(), radius)
    });
    let vertices = [[0.3, 0.0, 0.0], [0.0, 0.3, 0.1], [-0.2, 0.0, 0.0], [0.0, 0.0, 0.7], [0.0, -0.4, 0.1]];
    let list = vertices.map(|v| format!("{{P}} + 10*k*{{}}.vec({}, {}, {})", v[0], v[1], v[2])).join(", ");
    let gem = (&*format!("polytope: [{list}]"), (vertices.to_vec(), 0.0));
    let pairs: [[&(&str, Points); 2]; 8] = [
        [&cube, &cube],
        [&cube, &slab],
        [&slab, &slab],
        [&capsule, &cube],
        [&capsule, &slab],
        [&capsule, &gem],
        [&gem, &slab],
        [&gem, &gem],
    ];
    for [(first, a), (second, b)] in pairs {
        let place = |text: &str, frame: &str, point: &str| text.replace("{}", frame).replace("{P}", point);
        let (first, second) = (place(first, "E", "G"), place(second, "F", "H"));
        let m = model(&format!("S {{ of: A, {first} }}, T {{ of: B, {second} }}"), "S on T");
        assert!(m.contacts.iter().all(|contact| contact.first_of_pair == Some(0)));
        assert!(m.contacts.iter().skip(1).all(|contact| contact.clearance.is_none()));
        let clearance = m.contacts[0].clearance.as_ref().unwrap();
        let mut random = Random::named(&first);
        let (mut apart, mut least) = (0, f64::INFINITY);
        for _ in 0..POSES {
            let state = random_state(&mut random, &m);
            let values = evaluator(&m, &state, still(&state));
            let by = values.scalar(clearance, Level::Geometry).unwrap().re;
            if by <= 0.0 {
                continue;
            }
            apart += 1;
            let there = pose(&m, &state);
            let at = |body: usize, p: &V| plus(there.at[body], back(*p, &there.axes[body]), 1.0);
            for p in &a.0 {
                for q in &b.0 {
                    let distance = norm3(sub3(at(0, p), at(1, q))) - a.1 - b.1;
                    assert!(distance >= by - 1e-12, "{first} {second}: {distance} {by}");
                    least = least.min(distance - by);
                }
            }
            let found = said(&m, &state).unwrap();
            for (contact, one) in m.contacts.iter().zip(found) {
                let validity = contact.validity.as_ref();
                let valid = validity.is_none_or(|of| values.scalar(of, Level::Geometry).unwrap().re >= 0.0);
                assert!(one.gap > if valid { by - 1e-12 } else { 1e-6 }, "{first} {second}: {one:?} {by}");
            }
        }
        println!("{first} on {second}: {apart} of {POSES} apart, {least:.3} above");
        assert!(apart > POSES / 7 && least < 0.15, "{first} {second}: {apart} {least}");
    }
}

/// On a plane the clearance is that of the lowest point of the sphere about the shape; pairs with few contacts have none.
#[test]
fn clearances_above_a_plane() {
    for (shape, points) in [("box: [4*k, 6*k, 8*k]", Some(box_of([0.2, 0.3, 0.4]))), ("sphere: k", None)] {
        let m = model(&format!("S {{ of: A, {shape} }}, T {{ of: B, plane: F.z }}"), "S on T");
        let Some((points, _)) = points else {
            assert!(m.contacts.iter().all(|contact| contact.first_of_pair.is_none()));
            continue;
        };
        let mut random = Random::named("above a plane");
        let mut apart = 0;
        for _ in 0..POSES {
            let state = random_state(&mut random, &m);
            let values = evaluator(&m, &state, still(&state));
            let clearance = m.contacts[0].clearance.as_ref().unwrap();
            let by = values.scalar(clearance, Level::Geometry).unwrap().re;
            let there = pose(&m, &state);
            let height = |p: &V| {
                let from = sub3(plus(there.at[0], back(*p, &there.axes[0]), 1.0), there.at[1]);
                from.iter().zip(&there.axes[1][2]).map(|(a, b)| a * b).sum::<f64>()
            };
            assert!(points.iter().all(|p| height(p) >= by - 1e-12));
            let radius = norm3([0.2, 0.3, 0.4]);
            assert!((height(&[0.0; 3]) - radius - by).abs() < 1e-12);
            apart += usize::from(by > 0.0);
        }
        assert!(apart > POSES / 7, "{apart}");
    }
}
