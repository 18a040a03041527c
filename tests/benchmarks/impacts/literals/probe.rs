//! Multiplies the literals of the solver by factors, one literal at a time, and shows how errors and work
//! change.

#[path = "@COMMON@/double_double.rs"]
#[allow(dead_code)]
mod double_double;
#[path = "@COMMON@/random.rs"]
#[allow(dead_code)]
mod random;
#[path = "@COMMON@/second_road.rs"]
#[allow(dead_code)]
mod second_road;

use hodograph::{
    Impact, ImpactError, Law, ReducedMatrix, Surface, probe, rates, solve,
    structure::{Balanced, Isotropic, solve_structured},
};
use nalgebra::{Matrix3, Vector3};
use random::Random;
use second_road::{Outcome, condition};

const FACTORS: [f64; 8] = [1.0 / 64.0, 1.0 / 16.0, 0.25, 0.5, 2.0, 4.0, 16.0, 64.0];

#[derive(Clone, Copy, PartialEq)]
enum Shape {
    General,
    Balanced,
    Isotropic,
}

struct Case {
    family: &'static str,
    shape: Shape,
    matrix: ReducedMatrix<f64>,
    approach: Vector3<f64>,
    surface: Surface<f64>,
    /// What is right; `None` where the contact wedges.
    road: Option<Outcome>,
    bound: f64,
}

fn run(
    shape: Shape,
    m: &ReducedMatrix<f64>,
    v: &Vector3<f64>,
    s: &Surface<f64>,
) -> Result<Impact<f64>, ImpactError<f64>> {
    match shape {
        Shape::General => solve(m, v, s),
        Shape::Balanced => solve_structured::<Balanced, _>(m, v, s),
        Shape::Isotropic => solve_structured::<Isotropic, _>(m, v, s),
    }
}

fn exact(random: &mut Random, rank: usize) -> (ReducedMatrix<f64>, Vector3<f64>) {
    loop {
        let b = Matrix3::from_fn(|_, j| if j < rank { random.short() } else { 0.0 });
        let v = b * Vector3::from_fn(|_, _| random.short());
        let v = if v.x > 0.0 { -v } else { v };
        let m = ReducedMatrix::from(b * b.transpose());
        if v.x < -0.01 && m.nn > 1e-2 {
            return (m, v);
        }
    }
}

/// Collisions that were a weakness once (`runtime/tests/second_road.rs`): a direction left half exact, slip
/// that falls ever faster, terms that rise before they fall, a target just before v_n falls.
const WEAK: [([f64; 6], [f64; 3], f64, f64, Law); 4] = [
    (
        [
            1.562693923703253e-1,
            9.517281270427472e-2,
            -3.6941659398012014e-3,
            4.295014268951763e-1,
            5.199858484536779e-2,
            1.7671524112743349,
        ],
        [-5.467858501108753e-1, -3.7649437140756475e-1, -2.2024437970540553e-1],
        7.099815424891492e-2,
        1.0,
        Law::Poisson,
    ),
    (
        [
            1.553754583019265,
            1.4859946114461262,
            -2.0440832295277946,
            1.4731919552954202,
            -1.9587032696991438,
            2.7435798911894107,
        ],
        [-6.586426026214272e-1, -3.96145708894763e-1, 6.356833928469813e-1],
        6.137566184111034e-1,
        1.0,
        Law::Stronge,
    ),
    (
        [
            1.1354636731283674e-2,
            1.0661031149869021e-2,
            -8.66209183775131e-2,
            1.1241334296777679,
            2.8624731590636654e-3,
            1.1062228549630624,
        ],
        [-1.2901713053276833, 1.9798927217006306, -9.80689889706402e-2],
        5.36145915745949,
        9.999881602346368e-1,
        Law::Poisson,
    ),
    (
        [
            1.4188186905498252e1,
            -6.776239075011882,
            4.627156408538082,
            8.30539003853021,
            -1.594162874491028,
            2.3577605336339817,
        ],
        [-2.4695891634244527, 3.55054109332601, 1.146693921511248],
        3.865491895603112,
        9.999824176319805e-1,
        Law::Poisson,
    ),
];

/// A direction in which h vanishes.
fn zero(random: &mut Random, m: &ReducedMatrix<f64>, mu: f64) -> f64 {
    let h = |phi: f64| rates(m, mu, phi).z;
    loop {
        let begin = 7.0 * random.next();
        let Some((mut lo, mut hi)) = (0..60)
            .map(|k| (begin + 0.11 * f64::from(k), begin + 0.11 * f64::from(k + 1)))
            .find(|&(a, b)| (h(a) > 0.0) != (h(b) > 0.0))
        else {
            return 0.0;
        };
        for _ in 0..60 {
            let middle = 0.5 * (lo + hi);
            if (h(middle) > 0.0) == (h(lo) > 0.0) { lo = middle } else { hi = middle }
        }
        return lo;
    }
}

fn merging(random: &mut Random, n: usize) -> (ReducedMatrix<f64>, Vector3<f64>, Surface<f64>) {
    let (sin, cos) = (3.0 * random.next()).sin_cos();
    let (x, y) = (random.between(0.1, 10.0), random.between(0.1, 10.0));
    let (tt, ts, ss) = (x * cos * cos + y * sin * sin, (x - y) * cos * sin, x * sin * sin + y * cos * cos);
    let surface = Surface { mu: random.between(0.05, 4.0), ..random.surface() };
    let (sin, cos) = (3.0 * random.next()).sin_cos();
    let along = tt * cos * cos + 2.0 * ts * sin * cos + ss * sin * sin;
    let mixed = (ss - tt) * sin * cos + ts * (cos * cos - sin * sin);
    let size = surface.mu * (tt + ss);
    let h = size * random.next().signum() * random.between(1e-16, [1e-6, 1e-11][n % 2]);
    let slope = [0.0, random.next() * (size * h.abs()).sqrt()][n % 2];
    let (p, q) = (surface.mu * (2.0 * along - tt - ss) - slope, surface.mu * mixed + h);
    let (nt, ns) = (p * cos - q * sin, p * sin + q * cos);
    let need = (ss * nt * nt - 2.0 * ts * nt * ns + tt * ns * ns) / (x * y);
    let m = ReducedMatrix::new(need * (1.0 + random.between(1e-2, 10.0)), nt, ns, tt, ts, ss);
    let speed = random.between(1e-2, 10.0);
    let off: f64 = if n % 3 == 0 { random.next() } else { 0.0 };
    let (sin, cos) = (sin + off * cos, cos - off * sin);
    let long = sin.hypot(cos);
    (m, Vector3::new(-0.2 - random.next().abs(), speed * cos / long, speed * sin / long), surface)
}

fn cases(count: usize) -> Vec<Case> {
    let mut random = Random(2012);
    let mut cases: Vec<Case> = Vec::new();
    let families = [
        "any rank",
        "ill-conditioned",
        "nearly straight",
        "merging zeros",
        "slow",
        "fast",
        "steep",
        "near mu_c",
        "little e",
        "repeated",
        "hardly mobile",
        "lasting",
        "balanced",
        "isotropic",
        "singular, turned",
        "next to immobile",
        "f small",
        "out of range",
    ];
    for (m, v, mu, e, law) in WEAK {
        let (matrix, approach, surface) = (ReducedMatrix::from(m), Vector3::from(v), Surface { mu, e, law });
        let Ok(road) = second_road::solve(&matrix, &approach, &surface) else { continue };
        let bound = (32.0 * condition(&matrix) * 2.2e-16).max(1e-13);
        cases.push(Case {
            family: "weak once",
            shape: Shape::General,
            matrix,
            approach,
            surface,
            road: Some(road),
            bound,
        });
    }
    for (kind, family) in families.into_iter().enumerate() {
        for n in 0..count {
            let (mut m, mut v) = exact(&mut random, if kind == 0 { 1 + n % 3 } else { 3 });
            let mut surface = random.surface();
            let mut shape = Shape::General;
            match family {
                "ill-conditioned" => {
                    let scales = [1.0, random.between(1e-4, 1.0), random.between(1e-4, 1.0)];
                    let b = Matrix3::from_fn(|_, j| random.next() * scales[j]);
                    m = ReducedMatrix::from(b * b.transpose());
                }
                "nearly straight" => {
                    let phi = zero(&mut random, &m, surface.mu)
                        + random.next().signum() * random.between(1e-13, 1e-1);
                    let speed = v.yz().norm();
                    (v.y, v.z) = (speed * phi.cos(), speed * phi.sin());
                }
                "merging zeros" => (m, v, surface) = merging(&mut random, n),
                "slow" => v.yz_mut_scale(random.between(1e-10, 1e-2)),
                "fast" => v.yz_mut_scale(random.between(10.0, 1e6)),
                "steep" => surface.mu = random.between(6.0, 1000.0),
                "near mu_c" => {
                    surface.mu = hodograph::Characteristics::of(&m, 1.0).mu_c * (1.0 + random.next() * 0.02);
                    v.yz_mut_scale(0.2);
                }
                "little e" => {
                    surface = Surface { e: random.between(1e-8, 0.3), law: Law::Stronge, ..surface }
                }
                "repeated" => {
                    // f changes sign: mu |b| > m_nn.
                    surface.mu = m.nn / m.nt.hypot(m.ns) * random.between(1.0, 10.0);
                    v.yz_mut_scale(random.between(0.5, 20.0));
                }
                "hardly mobile" => {
                    let (nn, tt) = (random.between(0.1, 10.0), random.between(0.1, 10.0));
                    let ss = tt * random.between(1e-12, 1e-3);
                    let (nt, ns) =
                        (0.6 * random.next() * (nn * tt).sqrt(), 0.7 * random.next() * (nn * ss).sqrt());
                    m = ReducedMatrix::new(nn, nt, ns, tt, 0.0, ss);
                    let turn = random.next() * 3.0;
                    m = m.turned(turn.cos(), turn.sin());
                }
                "lasting" => v.x *= random.between(1e-6, 1e-1),
                "balanced" => {
                    shape = Shape::Balanced;
                    (m.nt, m.ns) = (0.0, 0.0);
                    v.yz_mut_scale(random.between(1e-2, 1e2));
                }
                "isotropic" => {
                    shape = Shape::Isotropic;
                    (m.ts, m.ss) = (0.0, m.tt);
                    v.yz_mut_scale(random.between(1e-2, 1e2));
                    if m.nn * m.tt < 1.01 * (m.nt * m.nt + m.ns * m.ns) {
                        continue;
                    }
                }
                _ => {}
            }
            if family == "singular, turned" {
                // Exact in the axes where it is solved the second way, rounded in those where the solver sees
                // it.
                (m, v) = exact(&mut random, 1 + n % 2);
                if n % 3 == 0 {
                    surface.mu *= 5.0;
                }
                let road = match second_road::solve(&m, &v, &surface) {
                    Ok(road) if road.margin < 1e-9 * condition(&m) => continue,
                    Ok(road) => Some(road),
                    Err(second_road::Failure::Wedged) => None,
                    Err(second_road::Failure::Unfinished) => continue,
                };
                let (sin, cos) = (3.0 * random.next()).sin_cos();
                let turned =
                    |v: &Vector3<f64>| Vector3::new(v.x, v.y * cos + v.z * sin, v.z * cos - v.y * sin);
                let road = road.map(|road| Outcome {
                    impulse: turned(&road.impulse),
                    velocity: turned(&road.velocity),
                    ..road
                });
                let bound = (8.0 * condition(&m) * 2.2e-16).max(1e-12) * (1.0 + surface.mu);
                cases.push(Case {
                    family,
                    shape,
                    matrix: m.turned(cos, sin),
                    approach: turned(&v),
                    surface,
                    road,
                    bound,
                });
                continue;
            }
            if family == "next to immobile" {
                let (nn, tt) = (random.between(0.1, 10.0), random.between(0.1, 10.0));
                let ss = tt * random.between(1e-20, 1e-13);
                let (nt, ns) =
                    (0.6 * random.next() * (nn * tt).sqrt(), 0.7 * random.next() * (nn * ss).sqrt());
                m = ReducedMatrix::new(nn, nt, ns, tt, 0.0, ss);
                v = Vector3::new(-1.0, random.next(), random.next() * (ss / tt).sqrt());
                surface.mu = random.between(0.05, 100.0);
                let Ok(road) = second_road::solve(&m, &v, &surface) else { continue };
                let bound = 1e-13 / (ss / tt).sqrt();
                cases.push(Case { family, shape, matrix: m, approach: v, surface, road: Some(road), bound });
                continue;
            }
            if family == "f small" {
                // f nearly vanishes where slip nearly keeps its direction.
                (m, v, surface) = merging(&mut random, n);
                let d = v.yz() / v.yz().norm();
                let along = m.nt * d.x + m.ns * d.y;
                let least = (m.ss * m.nt * m.nt - 2.0 * m.ts * m.nt * m.ns + m.tt * m.ns * m.ns)
                    / (m.tt * m.ss - m.ts * m.ts);
                let nn = surface.mu * along * (1.0 + random.next().signum() * random.between(1e-14, 1e-2));
                if nn < 1.01 * least {
                    continue;
                }
                m.nn = nn;
            }
            if family == "out of range" {
                // Friction and couplings of any size.
                surface.mu = random.between(1e-60, 1e-40);
                v.yz_mut_scale(random.between(1e-5, 1e5));
            }
            if m.nn < 1e-2 || condition(&m) > 1e12 {
                continue;
            }
            let Ok(road) = second_road::solve(&m, &v, &surface) else { continue };
            // A jump of the outcome lies this near: what is right depends on the last digits.
            if road.margin < 1e-9 * condition(&m) {
                continue;
            }
            let bound = (8.0 * condition(&m) * 2.2e-16).max(2e-14);
            cases.push(Case { family, shape, matrix: m, approach: v, surface, road: Some(road), bound });
        }
    }
    cases
}

trait Scale {
    fn yz_mut_scale(&mut self, factor: f64);
}

impl Scale for Vector3<f64> {
    fn yz_mut_scale(&mut self, factor: f64) {
        self.y *= factor;
        self.z *= factor;
    }
}

/// Errors above the bound, the worst error over its bound with its family, and the work.
struct Seen {
    above: usize,
    worst: f64,
    family: &'static str,
    digits: f64,
    work: f64,
    counts: [u64; 4],
}

/// The error over its bound; 1e9 for another number of compressions, no outcome or no number.
fn error(case: &Case, hit: &Result<Impact<f64>, ImpactError<f64>>) -> f64 {
    let error = match hit {
        Ok(hit) => match &case.road {
            Some(road) if hit.compressions == road.compressions => {
                road.error(hit, &case.approach) / case.bound
            }
            _ => 1e9,
        },
        Err(error) if error.kind() == "wedged" && case.road.is_none() => 0.0,
        Err(_) => 1e9,
    };
    if error.is_nan() { 1e9 } else { error }
}

fn examine(cases: &[Case]) -> Seen {
    let mut seen = Seen { above: 0, worst: 0.0, family: "", digits: 0.0, work: 0.0, counts: [0; 4] };
    probe::work();
    for case in cases {
        let error = error(case, &run(case.shape, &case.matrix, &case.approach, &case.surface));
        seen.digits += (error.max(1e-6)).ln();
        seen.above += usize::from(error > 1.0);
        if error > seen.worst {
            (seen.worst, seen.family) = (error, case.family);
        }
    }
    seen.counts = probe::work();
    // Instructions of a stretch, of a short step, of a block of the series and of the direct integration of
    // work, about.
    seen.work =
        @WEIGHTS@.iter().zip(seen.counts).map(|(w, n)| w * n as f64).sum::<f64>() / cases.len() as f64;
    seen.digits = (seen.digits / cases.len() as f64).exp();
    seen
}

fn main() {
    let names: Vec<(&str, &str)> = vec![@NAMES@];
    let only = std::env::args().nth(1);
    let count: usize = std::env::args().nth(2).and_then(|x| x.parse().ok()).unwrap_or(800);
    let mut cases = cases(count);
    probe::set(usize::MAX, 1.0);
    let all = cases.len();
    cases.retain(|case| {
        let hit = run(case.shape, &case.matrix, &case.approach, &case.surface);
        let error = error(case, &hit);
        if error > 1.0 {
            println!(
                "left out, error {error:.1e}: {} {:?} {:?} {:?}",
                case.family, case.matrix, case.approach, case.surface
            );
        }
        error <= 1.0
    });
    println!("{} of {all} left out", all - cases.len());
    let normal = examine(&cases);
    println!(
        "{} collisions; as it is: {} above the bound, worst {:.1} ({}), work {:.0} = {:?}",
        cases.len(),
        normal.above,
        normal.worst,
        normal.family,
        normal.work,
        normal.counts
    );
    for (number, (section, name)) in names.iter().enumerate() {
        if only.as_deref().is_some_and(|only| !name.contains(only) && !section.contains(only)) {
            continue;
        }
        println!("{section} {name}");
        for factor in FACTORS {
            probe::set(number, factor);
            let seen = examine(&cases);
            println!(
                "    x {factor:<9} above {:>5}  worst {:>9.2e} {:<16} mean {:>5.3}  work {:>+6.1} %",
                seen.above,
                seen.worst,
                seen.family,
                seen.digits / normal.digits,
                100.0 * (seen.work / normal.work - 1.0)
            );
        }
    }
}
