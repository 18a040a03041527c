//! No outcome violates a law of impact, for random contacts chosen to be difficult: friction from 0 to 1e308,
//! ranks 1 to 3, entries that are rounding noise, anisotropy, and numbers near both ends of the range, in
//! single and double precision.
//!
//! The laws are evaluated in numbers of twice the digits, independently of the solver's own verification.

use crate::common::double_double::Double;
use crate::common::random::{Draw, Random};
use crate::common::second_road::{self, condition};
use hodograph::structure::{Balanced, Diagonal, Isotropic, Planar, solve_structured};
use hodograph::{
    Characteristics, Hodograph, Impact, ImpactError, Law, ReducedMatrix, Scalar, Surface, solve,
};
use nalgebra::{Matrix3, Vector3, convert};
use std::collections::BTreeMap;

/// Numbers as the solver sees them, as doubles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub m: [f64; 6],
    pub v: [f64; 3],
    pub mu: f64,
    pub e: f64,
    pub law: Law,
    /// What the entries are known to, over the largest diagonal entry.
    noise: f64,
    /// The smallest number with all digits.
    least: f64,
    /// Nothing is extreme: an answer exists and is known to many digits.
    tame: bool,
}

/// The greatest relative residual of each law: momentum, friction, separation, law of restitution, friction's
/// work, Stronge's energy.
fn residuals(case: &Case, hit: &Impact<f64>) -> [f64; 6] {
    let d = |x: f64| Double::from(x);
    let [nn, nt, ns, tt, ts, ss] = case.m.map(d);
    let unit = Double::from(-case.v[0]);
    let m = [[nn, nt, ns], [nt, tt, ts], [ns, ts, ss]].map(|row| row.map(|x| x / nn));
    let v1 = case.v.map(|x| d(x) / unit);
    let v2: [Double; 3] = std::array::from_fn(|k| d(hit.velocity[k]) / unit);
    // In the order in which no intermediate number leaves the range.
    let i: [Double; 3] = std::array::from_fn(|k| {
        let x = d(hit.impulse[k]);
        let ways = [x * nn, x / unit, nn / unit];
        let size = |way: &Double| if way.hi == 0.0 { f64::INFINITY } else { way.hi.abs().log10().abs() };
        let nearest = (0..3).min_by(|&a, &b| size(&ways[a]).total_cmp(&size(&ways[b])));
        match nearest {
            Some(0) => ways[0] / unit,
            Some(1) => ways[1] * nn,
            _ => x * ways[2],
        }
    });
    let abs = |x: Double| x.abs().hi;
    let slips = 1.0 + abs(v1[1]) + abs(v1[2]) + abs(v2[1]) + abs(v2[2]);
    // Where slip drives v_n, it passes through speeds of the size of slip.
    let speed = 1.0 + abs(v2[0]) + (abs(m[0][1]) + abs(m[0][2])).min(1.0) * slips;
    let largest = case.m[0].max(case.m[3]).max(case.m[5]) / case.m[0];
    let rounding = case.noise * largest * (abs(i[0]) + abs(i[1]) + abs(i[2]));
    let mut momentum: f64 = 0.0;
    for k in 0..3 {
        let sum = v1[k] + m[k][0] * i[0] + m[k][1] * i[1] + m[k][2] * i[2] - v2[k];
        let scale = if k == 0 { speed } else { slips };
        momentum = momentum.max((abs(sum) - rounding).max(0.0) / scale);
    }
    let rubbed = abs(i[1]).hypot(abs(i[2]));
    // Denormal numbers have no digits to compare.
    let most = case.mu * abs(i[0]);
    let denormal = hit.impulse.yz().amax() < 1e12 * case.least;
    let excess = (rubbed - most) / (most + 1e18 * case.least * abs(i[0]));
    let friction = if denormal || most.is_infinite() { 0.0 } else { excess };
    let friction = if case.mu == 0.0 { rubbed } else { friction };
    let separation = (-i[0].hi).max(-v2[0].hi / speed);
    let law = match case.law {
        Law::Newton => abs(v2[0] - d(case.e)) / speed,
        _ if case.e == 0.0 => abs(v2[0]) / speed,
        _ => 0.0,
    };
    let work = d(hit.normal_work / case.v[0] / case.v[0] * case.m[0]);
    let across = i[1] * (v1[1] + v2[1]) + i[2] * (v1[2] + v2[2]);
    let total = (i[0] * (v2[0] - d(1.0)) + across) * 0.5;
    let scale = abs(i[0]) * speed + (abs(i[1]) + abs(i[2])) * slips;
    let energy = if case.law == Law::Stronge { total.hi / scale } else { 0.0 };
    // Products of numbers of 32 digits end at some 1e300.
    let beyond = rubbed > 1e290;
    let work = if beyond { 0.0 } else { (total - work).hi / scale };
    [momentum, friction, separation, law, work, if beyond { 0.0 } else { energy }]
}

#[derive(Default)]
struct Tally {
    counts: BTreeMap<String, usize>,
    tame: BTreeMap<String, usize>,
    worst: [f64; 6],
}

impl Tally {
    fn take(&mut self, case: &Case, answer: Result<Impact<f64>, ImpactError<f64>>, tolerance: f64) {
        let kind = match &answer {
            Ok(hit) => {
                let numbers = [hit.contact_work, hit.normal_work];
                assert!(
                    hit.impulse.iter().chain(hit.velocity.iter()).chain(&numbers).all(|x| x.is_finite()),
                    "{case:?} {hit:?}"
                );
                let found = residuals(case, hit);
                for (worst, residual) in self.worst.iter_mut().zip(found) {
                    assert!(residual <= tolerance, "{found:?}\n{case:?}\n{hit:?}");
                    *worst = worst.max(residual);
                }
                "solved"
            }
            Err(error) => error.kind(),
        };
        if std::env::var("HOSTILE").is_ok_and(|what| what == kind) {
            println!("{case:?} {answer:?}");
        }
        *self.counts.entry(kind.to_owned()).or_default() += 1;
        if case.tame {
            *self.tame.entry(kind.to_owned()).or_default() += 1;
        }
    }

    fn report(&self, what: &str) {
        println!(
            "{what}: {:?}\n  tame: {:?}\n  worst {:?}",
            self.counts,
            self.tame,
            self.worst.map(|x| format!("{x:.1e}"))
        );
        let solved = |counts: &BTreeMap<String, usize>| counts.get("solved").copied().unwrap_or(0);
        let all = |counts: &BTreeMap<String, usize>| counts.values().sum::<usize>();
        let wedged = self.tame.get("wedged").copied().unwrap_or(0);
        assert_eq!(
            solved(&self.tame) + wedged,
            all(&self.tame),
            "{what}: an ordinary contact without answer"
        );
        let wedged = self.counts.get("wedged").copied().unwrap_or(0);
        let refused = all(&self.counts) - solved(&self.counts) - wedged;
        assert!(10 * refused <= all(&self.counts), "{what}: {refused} refused");
    }
}

/// A contact of a rank, with all that hurts; `epsilon` is the rounding unit of the numbers, `range` the
/// exponent of the largest.
pub(crate) fn contact(random: &mut Random, epsilon: f64, range: f64) -> Case {
    let rank = 1 + random.below(3);
    let bound = |x: f64| x.clamp(10.0_f64.powf(-range), 10.0_f64.powf(range));
    let wild = random.below(2) == 0;
    let spread = if wild { range / 40.0 } else { 0.5 };
    let scales = [random.power(spread), random.power(spread), random.power(spread)];
    let mut b = Matrix3::from_fn(|i, j| if j < rank { random.number() * scales[i] } else { 0.0 });
    // A direction that does not move, or by noise alone.
    let still = random.below(4);
    let mut noise = 0.0;
    if still == 1 || still == 2 {
        b.row_mut(still).fill(0.0);
        if random.below(2) == 0 {
            let size = 8.0 * epsilon * b.amax();
            b.row_mut(still).iter_mut().for_each(|x| *x = size * random.number());
        }
    }
    let mut v = b * Vector3::from_fn(|_, _| random.number());
    if random.below(4) == 0 {
        v = Vector3::from_fn(|_, _| random.number());
    }
    v.x = -v.x.abs();
    match random.below(6) {
        0 => (v.y, v.z) = (0.0, 0.0),
        1 => {
            let slip = random.power(range / 20.0);
            (v.y, v.z) = (v.y * slip, v.z * slip);
        }
        _ => {}
    }
    let mut m = b * b.transpose();
    if random.below(2) == 0 {
        // Rounding noise in every entry.
        noise = 16.0 * epsilon;
        let size = noise * m[(0, 0)].max(m[(1, 1)]).max(m[(2, 2)]);
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            m[(i, j)] += size * random.number();
        }
    }
    let mass = if random.below(3) == 0 { random.power(range / 3.0) } else { 1.0 };
    let pace = if random.below(3) == 0 { random.power(range / 6.0) } else { 1.0 };
    let (m, v) = (m * mass, v * pace);
    let matrix = ReducedMatrix::from(m);
    let mu_c = Characteristics::of(&matrix, 1.0).mu_c;
    let mu = match random.below(8) {
        0 => 0.0,
        1 => 10.0_f64.powf(-range),
        2 => bound(random.power(range)),
        3 if mu_c.is_finite() => {
            bound(mu_c * (1.0 + random.number() * 10.0_f64.powf(8.0 * random.number() - 8.0)))
        }
        _ => random.power(1.5),
    };
    let e = [0.0, 1.0, 0.5 + 0.5 * random.number()][random.below(3)];
    let law = Law::ALL[random.below(Law::ALL.len())];
    let tame = !wild
        && rank == 3
        && m.determinant() > 1e-4 * m.trace().powi(3)
        && (mu == 0.0 || mu < 100.0)
        && v.x.abs() > 1e-6 * v.yz().norm()
        && v.x != 0.0;
    Case {
        m: matrix.into(),
        v: v.into(),
        mu,
        e,
        law,
        noise: noise.max(256.0 * epsilon),
        least: 10.0_f64.powf(-range),
        tame,
    }
}

/// Solves a case in the numbers of a type, with what these numbers make of it.
fn solved<T: Scalar>(case: &Case) -> (Case, Result<Impact<f64>, ImpactError<f64>>) {
    let to = |x: f64| -> T { convert(x) };
    let back = |x: T| nalgebra::try_convert::<T, f64>(x).unwrap_or(f64::NAN);
    let m = case.m.map(to);
    let v = case.v.map(to);
    let surface = Surface { mu: to(case.mu), e: to(case.e), law: case.law };
    let seen = Case { m: m.map(back), v: v.map(back), mu: back(surface.mu), e: back(surface.e), ..*case };
    let vector = |v: &Vector3<T>| Vector3::new(back(v.x), back(v.y), back(v.z));
    // The solver in doubles gives a frame for the fields that are not compared.
    let answer = solve(&ReducedMatrix::from(m), &Vector3::from(v), &surface);
    let answer = match answer {
        Ok(hit) => {
            let plain = ReducedMatrix::new(1.0, 0.0, 0.0, 1.0, 0.0, 1.0);
            let mut frame =
                solve(&plain, &Vector3::new(-1.0, 0.0, 0.0), &Surface { mu: 0.0, e: 0.0, law: case.law })
                    .expect("an outcome");
            frame.impulse = vector(&hit.impulse);
            frame.velocity = vector(&hit.velocity);
            frame.contact_work = back(hit.contact_work);
            frame.normal_work = back(hit.normal_work);
            Ok(frame)
        }
        Err(error) => Err(match error {
            ImpactError::Wedged { law, .. } => ImpactError::Wedged { normal_velocity: 0.0, law },
            ImpactError::Inaccurate { violated, residual } => {
                ImpactError::Inaccurate { violated, residual: back(residual) }
            }
            ImpactError::NotApproaching { .. } => ImpactError::NotApproaching { normal_velocity: 0.0 },
            ImpactError::NotPositiveSemidefinite { .. } => {
                ImpactError::NotPositiveSemidefinite { minor: 0.0 }
            }
            ImpactError::NoNormalMobility { .. } => ImpactError::NoNormalMobility { nn: 0.0 },
            _ => ImpactError::NotFinite { value: 0.0 },
        }),
    };
    (seen, answer)
}

#[test]
fn double_precision() {
    let mut random = Random::new(21);
    let mut tally = Tally::default();
    for _ in 0..20_000 {
        let case = contact(&mut random, f64::EPSILON, 308.0);
        if case.v[0] < 0.0 {
            let (seen, answer) = solved::<f64>(&case);
            tally.take(&seen, answer, 1.6e-8);
        }
    }
    tally.report("double precision");
}

#[test]
fn single_precision() {
    let mut random = Random::new(22);
    let mut tally = Tally::default();
    for _ in 0..10_000 {
        let case = contact(&mut random, f64::from(f32::EPSILON), 37.0);
        if case.v[0] < 0.0 && (case.v[0] as f32) < 0.0 {
            let (seen, answer) = solved::<f32>(&case);
            tally.take(&seen, answer, 4e-4);
        }
    }
    tally.report("single precision");
}

/// The closed forms are held to the same laws.
#[test]
fn closed_forms() {
    let mut random = Random::new(23);
    let mut tallies = [(); 4].map(|()| Tally::default());
    for _ in 0..6_000 {
        let case = contact(&mut random, f64::EPSILON, 308.0);
        if case.v[0] >= 0.0 {
            continue;
        }
        let [nn, nt, ns, tt, ts, ss] = case.m;
        let [n, t, s] = case.v;
        let surface = Surface { mu: case.mu, e: case.e, law: case.law };
        let variants = [
            ([nn, nt, 0.0, tt, 0.0, ss], [n, t, 0.0]),
            ([nn, 0.0, 0.0, tt, ts, ss], [n, t, s]),
            ([nn, 0.0, 0.0, tt, 0.0, ss], [n, t, s]),
            ([nn, nt, ns, tt.max(ss), 0.0, tt.max(ss)], [n, t, s]),
        ];
        for (kind, ((m, v), tally)) in variants.into_iter().zip(&mut tallies).enumerate() {
            let (matrix, approach) = (ReducedMatrix::from(m), Vector3::from(v));
            let answer = match kind {
                0 => solve_structured::<Planar, _>(&matrix, &approach, &surface),
                1 => solve_structured::<Balanced, _>(&matrix, &approach, &surface),
                2 => solve_structured::<Diagonal, _>(&matrix, &approach, &surface),
                _ => solve_structured::<Isotropic, _>(&matrix, &approach, &surface),
            };
            // An isotropic contact made of another's couplings may be none.
            if kind == 3 && matches!(answer, Err(ImpactError::NotPositiveSemidefinite { .. })) {
                continue;
            }
            tally.take(&Case { m, v, ..case }, answer, 1.6e-8);
        }
    }
    for (tally, what) in tallies.iter().zip(["planar", "balanced", "diagonal", "isotropic"]) {
        tally.report(what);
    }
}

/// A contact that sticks with hardly any mobility along n takes an impulse of the inverse of that mobility:
/// its balance of momentum consists of terms of that size, each with its rounding, and is met as well as they
/// allow. Such an answer is right, and leaves.
///
/// Outcomes in numbers of 32 digits (`common::second_road`): I_n and v_n2.
#[test]
fn great_impulses_are_no_error() {
    let cases = [
        (
            [
                0.21025714813560442,
                -0.06867637639755157,
                0.3194261781560483,
                0.08662134781243938,
                -0.15195074243369164,
                0.5205999453169415,
            ],
            [-1.3537540435791016, -0.26169681549072266, 0.12002849578857422],
            (2.3681945457700704, 1.0, Law::Stronge),
        ),
        (
            [
                0.30196891879832616,
                0.20711223293722175,
                0.34961140516900313,
                0.7535808538305236,
                0.3018066283506842,
                0.411060067632061,
            ],
            [-1.3878231048583984, 0.5890769958496094, 1.09857177734375],
            (1.7880334979205352, 0.34097167031925724, Law::Newton),
        ),
        (
            [
                0.021527155445118448,
                -0.043954441407099025,
                -0.04889381175139923,
                0.0897467906707861,
                0.09983204769309352,
                0.11105068009565472,
            ],
            [-0.38282203674316406, -0.9336633682250977, 0.24482345581054688],
            (0.5678090379472598, 1.0, Law::Poisson),
        ),
    ];
    for (m, v, (mu, e, law)) in cases {
        let (m, v, surface) = (ReducedMatrix::from(m), Vector3::from(v), Surface { mu, e, law });
        let road = second_road::solve(&m, &v, &surface).expect("a second road");
        let hit = solve(&m, &v, &surface).unwrap_or_else(|error| panic!("{error}"));
        let bound = 32.0 * condition(&m) * f64::EPSILON;
        assert!(road.impulse.x > 1e8, "{road:?}");
        assert!(
            bound < 1e-5 && road.error(&hit, &v) < bound,
            "{} {bound}\n{hit:?}\n{road:?}",
            road.error(&hit, &v)
        );
    }
}

/// Friction up to the largest number: the limit is that of friction that stops slip at once, in every
/// structure and for every rank.
#[test]
fn friction_to_the_end_of_the_range() {
    let mut random = Random::new(24);
    let (mut compared, mut small, mut stopped) = (0, 0, 0);
    for _ in 0..400 {
        let rank = 1 + random.below(3);
        let scale = random.power(3.0);
        let b = Matrix3::from_fn(|_, j| if j < rank { scale * random.number() } else { 0.0 });
        let mut v = b * Vector3::from_fn(|_, _| random.number());
        v.x = -v.x.abs();
        let m = ReducedMatrix::from(b * b.transpose());
        let (n, t) = (v.x, v.y);
        if n > -1e-3 * v.norm() || m.nn < 1e-2 * m.tt.max(m.ss) || (rank == 3 && condition(&m) > 1e6) {
            continue;
        }
        let law = Law::ALL[random.below(Law::ALL.len())];
        let variants = [
            (m, v),
            (ReducedMatrix { ns: 0.0, ts: 0.0, ..m }, Vector3::new(n, t, 0.0)),
            (ReducedMatrix { nt: 0.0, ns: 0.0, ..m }, v),
            (ReducedMatrix { nt: 0.0, ns: 0.0, ts: 0.0, ..m }, v),
            (ReducedMatrix { tt: m.tt.max(m.ss), ts: 0.0, ss: m.tt.max(m.ss), ..m }, v),
        ];
        for (kind, (m, v)) in variants.into_iter().enumerate() {
            // A tangential block that is regular by rounding only leaves the impulse in its directions open.
            let is_open = kind != 1 && m.tt * m.ss - m.ts * m.ts < 1e-6 * m.tt * m.ss;
            let at = |mu: f64| {
                let surface = Surface { mu, e: 0.5, law };
                match kind {
                    0 => solve(&m, &v, &surface),
                    1 => solve_structured::<Planar, _>(&m, &v, &surface),
                    2 => solve_structured::<Balanced, _>(&m, &v, &surface),
                    3 => solve_structured::<Diagonal, _>(&m, &v, &surface),
                    _ => solve_structured::<Isotropic, _>(&m, &v, &surface),
                }
            };
            // Singular contacts may wedge or lose their digits at any friction.
            let Ok(limit) = at(1e20) else { continue };
            for mu in [1e150, 1e200, 1e290, 1e300, 1e304, 1e306, 1e307, 1e308, 1.7e308, f64::MAX] {
                // A collision that friction ends takes an I_n of the order of 1/mu.
                let by_friction = limit.impulse.x < 1e-10 * limit.impulse.amax();
                let normal = if by_friction { limit.impulse.x * 1e20 / mu } else { limit.impulse.x };
                let hit = match at(mu) {
                    Ok(hit) => hit,
                    Err(ImpactError::NotFinite { value }) if normal < 2.3e-308 => {
                        assert!((value - normal).abs() < 1e-9 * normal + 1e-320, "{value:e} {normal:e}");
                        small += 1;
                        continue;
                    }
                    Err(error) => panic!("{kind} {mu:e} {law:?} {error} {m:?} {v:?}"),
                };
                assert!((hit.impulse.x - normal).abs() <= 1e-9 * normal + 1e-320, "{kind} {mu:e} {hit:?}");
                let (impulse, velocity) = (limit.impulse.amax(), v.amax() + limit.velocity.amax());
                let apart = hit.impulse - limit.impulse;
                let apart = if is_open { apart.x.abs() } else { apart.amax() };
                let error = (apart / impulse)
                    .max((hit.velocity - limit.velocity).amax() / velocity)
                    .max((hit.normal_work - limit.normal_work).abs() / (impulse * velocity));
                assert!(error < 1e-9, "{kind} {mu:e} {law:?} {error:e} {m:?} {v:?}\n{hit:?}\n{limit:?}");
                assert_eq!(hit.path, limit.path, "{kind} {mu:e} {law:?} {m:?} {v:?}");
                // So does slip that friction stops.
                let ends = hit.phases.slip_end.zip(limit.phases.slip_end);
                if let Some((end, limit)) = ends.filter(|_| !is_open) {
                    let early = limit.impulse.x < 1e-10 * limit.impulse.amax();
                    let normal = if early { limit.impulse.x * 1e20 / mu } else { limit.impulse.x };
                    assert!(
                        (end.impulse.x - normal).abs() <= 1e-9 * normal + 1e-320,
                        "{kind} {mu:e} {end:?}"
                    );
                    stopped += 1;
                }
                compared += 1;
                if kind == 0 {
                    let surface = Surface { mu, e: 0.5, law };
                    let middle =
                        Hodograph::new(&m, &v, &surface).expect("an outcome").at(0.5 * hit.impulse.x);
                    let balance = v + Matrix3::from(m) * middle.impulse - middle.velocity;
                    assert!(
                        balance.amax() < 1e-9 * v.amax().max(middle.velocity.amax()),
                        "{mu:e} {middle:?} {hit:?}"
                    );
                }
            }
        }
    }
    println!("{compared} compared, {small} normal impulses out of range");
    assert_eq!((compared, small, stopped), (14_445, 385, 12_728));
    for mu in [1e10_f32, 1e20, 1e30, 1e37, 3e38, f32::MAX] {
        for &law in Law::ALL {
            let m = ReducedMatrix::new(0.2251_f32, -0.1094, 0.1258, 22.360, 0.1158, 20.2702);
            let at = |mu| {
                solve(&m, &Vector3::new(-0.946, 1.063, 0.3), &Surface { mu, e: 0.5, law })
                    .unwrap_or_else(|error| panic!("{mu:e} {error}"))
            };
            let (hit, limit) = (at(mu), at(1e7));
            assert!(
                (hit.velocity - limit.velocity).amax() < 1e-5 && (hit.impulse - limit.impulse).amax() < 1e-4
            );
        }
    }
}

/// What was wrong once: a singular contact close to mu_c that gained energy, friction beyond 1e71, spurious
/// refusals of tiny numbers.
#[test]
fn wrong_once() {
    let m = [
        0.18014824382572298,
        -0.420750580666942,
        0.16886182934617142,
        1.6755467502844015,
        -0.620154188571219,
        0.2318472622443747,
    ];
    let surface = Surface { mu: 5.965507846482992, e: 0.8, law: Law::Stronge };
    let answer = solve(&ReducedMatrix::from(m), &Vector3::new(-1.0, 0.0, 0.0), &surface);
    assert!(matches!(answer, Err(ImpactError::Inaccurate { .. } | ImpactError::Wedged { .. })), "{answer:?}");
    // Great friction: the limit is that of friction that stops slip at once.
    let m = ReducedMatrix::new(0.2251, -0.1094, 0.1258, 0.2360, 0.1158, 0.2702);
    let v = Vector3::new(-0.946, 1.063, 0.3);
    for &law in Law::ALL {
        let at = |mu: f64| {
            solve(&m, &v, &Surface { mu, e: 0.5, law }).unwrap_or_else(|e| panic!("{mu:e} {law:?} {e}"))
        };
        let limit = at(1e20);
        for mu in [1e30, 1e51, 1e60, 1e71, 1e100, 1e150, 1e200, 1e280] {
            let hit = at(mu);
            assert!((hit.velocity - limit.velocity).amax() < 1e-12, "{mu:e} {law:?} {hit:?} {limit:?}");
            assert!((hit.impulse.yz() - limit.impulse.yz()).amax() < 1e-11, "{mu:e} {law:?}");
            assert_eq!(hit.path, limit.path);
        }
    }
    for mu in [1e-300, 1e-308, 5e-324] {
        let hit = solve(&m, &v, &Surface { mu, e: 0.5, law: Law::Stronge }).expect("an outcome");
        let none = solve(&m, &v, &Surface { mu: 0.0, e: 0.5, law: Law::Stronge }).expect("an outcome");
        assert!((hit.velocity - none.velocity).amax() < 1e-15);
    }
    for tiny in [1e-290, 1e-300, 1e-305] {
        let m = ReducedMatrix::new(1.0, tiny, 0.5 * tiny, tiny, 0.0, tiny);
        for (v, law) in [
            ([-1.0, 1.0, 0.5], Law::Poisson),
            ([-1.0, 0.0, 0.0], Law::Stronge),
            ([-1.0, 1e-9, 0.0], Law::Newton),
        ] {
            let hit = solve(&m, &Vector3::from(v), &Surface { mu: 0.5, e: 0.5, law })
                .unwrap_or_else(|e| panic!("{tiny:e} {e}"));
            assert!((hit.velocity - Vector3::new(0.5, v[1], v[2])).amax() < 1e-15);
        }
    }
    // Noise beside a zero diagonal entry.
    let m = ReducedMatrix::new(0.25, 0.1, 1e-18, 0.04, 0.0, 0.0);
    for &law in Law::ALL {
        for mu in [0.0, 0.2, 0.9] {
            let exact = ReducedMatrix { ns: 0.0, ..m };
            let surface = Surface { mu, e: 0.5, law };
            let v = Vector3::new(-1.0, 0.4, 0.0);
            assert_eq!(solve(&m, &v, &surface), solve(&exact, &v, &surface));
        }
    }
    let coupled = ReducedMatrix { ns: 1e-9, ..m };
    let refused = solve(&coupled, &Vector3::new(-1.0, 0.4, 0.0), &surface).map_err(|e| e.kind());
    assert_eq!(refused.err(), Some("not_positive_semidefinite"));
}
