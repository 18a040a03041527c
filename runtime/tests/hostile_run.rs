//! A hostile run that is judged case by case: every outcome is compared with an independent solution in
//! numbers of 32 digits, every input that has none must be refused. The table in `docs/solver.md` counts what
//! came of it; the test holds the rows of a small run, and that none is wrong in silence.
//!
//! `HODOGRAPH_UPDATE=1 cargo test --release -p hodograph --test all hostile_run::` makes the table anew.

use std::fmt::Write;
use std::path::PathBuf;

use crate::common::random::{Draw, Random};
use crate::common::second_road::{self, Failure, condition};
use hodograph::{Characteristics, Impact, Law, ReducedMatrix, Surface, solve};
use nalgebra::{Matrix3, Vector3};

/// Collisions of each family: in the table, and in the test.
const MANY: usize = 2_500;
const FEW: usize = 60;

/// A collision to be solved, and whether it has an outcome at all.
struct Case {
    m: ReducedMatrix<f64>,
    v: Vector3<f64>,
    surface: Surface<f64>,
    /// the kind of error that it must give, if it is none
    wrong: Option<&'static str>,
}

/// What came of the collisions of a family.
#[derive(Default)]
struct Tally {
    tried: usize,
    right: usize,
    refused: usize,
    silent: usize,
    /// neither the input nor one that differs from it by rounding has the outcome, so near to a jump that 32
    /// digits do not decide, or the second road does not end for any of them
    open: usize,
}

/// What an error may be: some roundings (32, or what 1e-12 is) times the condition of the contact, by which
/// phases that stick amplify them, and times the growth of the normal impulse, I_n m_nn over the speed of
/// approach: v_2 = v_1 + M I is a difference of terms that are larger than the speeds by it. Derived in
/// `docs/solver.md`.
fn bound(m: &ReducedMatrix<f64>, v: &Vector3<f64>, road: &second_road::Outcome) -> f64 {
    let growth = (road.impulse.x * m.nn / -v.x).max(1.0);
    (32.0 * condition(m) * f64::EPSILON).max(1e-12) * growth
}

/// Whether an outcome is that of an input whose speeds, friction and restitution differ by the roundings that
/// [`bound`] allows.
fn has_a_neighbour(
    m: &ReducedMatrix<f64>,
    v: &Vector3<f64>,
    surface: &Surface<f64>,
    hit: &Impact<f64>,
) -> bool {
    let rounding = 32.0 * condition(m) * f64::EPSILON;
    let mut random = Random::new(17);
    (0..40).any(|_| {
        let mut near = |x: f64| x * (1.0 + rounding * random.number());
        let v = Vector3::new(near(v.x), near(v.y), near(v.z));
        let surface = Surface { mu: near(surface.mu), e: near(surface.e).min(1.0), ..*surface };
        match second_road::solve(m, &v, &surface) {
            Ok(road) => road.error(hit, &v) <= bound(m, &v, &road),
            Err(_) => false,
        }
    })
}

impl Tally {
    fn judge(&mut self, case: &Case) {
        let Case { m, v, surface, wrong } = case;
        self.tried += 1;
        let ours = solve(m, v, surface);
        if let Some(kind) = wrong {
            match ours {
                Err(error) if error.kind() == *kind => self.refused += 1,
                other => {
                    println!("{kind} is answered by {other:?}: {m:?} {v:?} {surface:?}");
                    self.silent += 1;
                }
            }
            return;
        }
        // The 32 digits do not see a target of v_n below their rounding: it is zero to them.
        let e = if surface.e < 1e-28 { 0.0 } else { surface.e };
        let surface = &Surface { e, ..*surface };
        match (ours, second_road::solve(m, v, surface)) {
            (Ok(hit), Ok(road)) if road.error(&hit, v) <= bound(m, v, &road) => self.right += 1,
            // At a jump the last digits of the input decide: the outcome must be that of an input within rounding.
            (Ok(hit), Err(Failure::Unfinished)) if has_a_neighbour(m, v, surface, &hit) => self.right += 1,
            (_, Err(Failure::Unfinished)) => self.open += 1,
            (Ok(hit), Ok(road)) if road.margin < 1e-9 * condition(m) => {
                let right = has_a_neighbour(m, v, surface, &hit);
                *if right { &mut self.right } else { &mut self.open } += 1;
            }
            (_, Ok(road)) if road.margin < 1e-9 * condition(m) => self.open += 1,
            (Err(error), Err(Failure::Wedged)) if error.kind() == "wedged" => self.right += 1,
            (Err(_), _) => self.refused += 1,
            (Ok(hit), road) => {
                println!("wrong: {hit:?}\n{road:?}\n{m:?} {v:?} {surface:?}");
                self.silent += 1;
            }
        }
    }
}

/// B B^T of a rank, exact in doubles, and a velocity in its range.
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

/// A contact of condition up to 3e8, in units from micro to mega.
fn ill_conditioned(random: &mut Random) -> (ReducedMatrix<f64>, Vector3<f64>) {
    loop {
        let scales = [1.0, random.logarithmic(1e-4, 1.0), random.logarithmic(1e-4, 1.0)];
        let b = Matrix3::from_fn(|_, j| random.number() * scales[j]);
        let m = ReducedMatrix::from(b * b.transpose());
        let v = Vector3::new(-0.1 - random.number().abs(), random.number(), random.number());
        if m.nn >= 1e-2 && condition(&m) <= 3e8 {
            let (mass, speed) = (random.power(6.0), random.power(6.0));
            return (ReducedMatrix::from(<[f64; 6]>::from(m).map(|x| x * mass)), v * speed);
        }
    }
}

/// The families, each with what makes it hostile.
const FAMILIES: [&str; 8] = [
    "ordinary contacts of rank 3",
    "singular contacts of rank 1 and 2",
    "condition to 3e8, units from 1e-6 to 1e6",
    "mu within 1e-12 to 1e-1 of mu_c",
    "mu from 1e-12 to 1e6",
    "e of 0, 1e-300, 1e-20, 1e-10, 1 - 1e-12, 1",
    "slip of 1e-12 to 1e6 times the speed of approach",
    "input that is none: NaN, infinite, e = 1.2, mu < 0, parting, no mass matrix",
];

fn case(family: usize, random: &mut Random) -> Case {
    let (mut m, mut v) = match family {
        1 => {
            let rank = 1 + random.below(2);
            exact(random, rank)
        }
        2 => ill_conditioned(random),
        _ => exact(random, 3),
    };
    let mut surface = random.surface();
    let mut wrong = None;
    match family {
        3 => {
            let mu_c = Characteristics::of(&m, 1.0).mu_c;
            let off = random.logarithmic(1e-12, 1e-1) * if random.below(2) == 0 { 1.0 } else { -1.0 };
            surface.mu = if mu_c.is_finite() { mu_c * (1.0 + off) } else { surface.mu };
        }
        4 => surface.mu = random.logarithmic(1e-12, 1e6),
        5 => surface.e = [0.0, 1e-300, 1e-20, 1e-10, 1.0 - 1e-12, 1.0][random.below(6)],
        6 => {
            let slip = random.logarithmic(1e-12, 1e6) * -v.x / v.yz().norm().max(1e-3);
            (v.y, v.z) = (v.y * slip, v.z * slip);
        }
        7 => {
            let strange = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][random.below(3)];
            wrong = Some(match random.below(6) {
                0 => {
                    v[random.below(3)] = strange;
                    "not_finite"
                }
                1 => {
                    m = ReducedMatrix { tt: strange, ..m };
                    "not_finite"
                }
                2 => {
                    surface.e =
                        if random.below(2) == 0 { 1.0 + random.logarithmic(1e-12, 10.0) } else { -0.1 };
                    "restitution_out_of_range"
                }
                3 => {
                    surface.mu = -random.logarithmic(1e-300, 10.0);
                    "negative_friction"
                }
                4 => {
                    v.x = [0.0, -v.x, 1e-300][random.below(3)];
                    "not_approaching"
                }
                _ => {
                    m.nt = 1.5 * (m.nn * m.tt).sqrt() + 0.1;
                    "not_positive_semidefinite"
                }
            });
        }
        _ => {}
    }
    Case { m, v, surface, wrong }
}

fn run(count: usize) -> Vec<Tally> {
    let mut tallies = Vec::new();
    for family in 0..FAMILIES.len() {
        let mut random = Random::new(900 + family as u64);
        let mut tally = Tally::default();
        for _ in 0..count {
            tally.judge(&case(family, &mut random));
        }
        tallies.push(tally);
    }
    tallies
}

/// The rows of the table.
fn rows(tallies: &[Tally]) -> String {
    let mut out = String::new();
    let row = |out: &mut String, name: &str, tally: &Tally| {
        let Tally { tried, right, refused, silent, open } = tally;
        writeln!(out, "| {name} | {tried} | {right} | {refused} | {silent} | {open} |").expect("a row");
    };
    let mut all = Tally::default();
    for (name, tally) in FAMILIES.iter().zip(tallies) {
        row(&mut out, name, tally);
        all.tried += tally.tried;
        all.right += tally.right;
        all.refused += tally.refused;
        all.silent += tally.silent;
        all.open += tally.open;
    }
    row(&mut out, "all", &all);
    out
}

/// What stands in the page between these lines.
const BEGIN: &str = "<!-- hostile_run: begin -->\n";
const END: &str = "<!-- hostile_run: end -->";

#[test]
fn nothing_is_wrong_in_silence() {
    let update = crate::expectations::are_written_anew();
    let tallies = run(if update { MANY } else { FEW });
    print!("{}", rows(&tallies));
    for (name, tally) in FAMILIES.iter().zip(&tallies) {
        assert_eq!(tally.silent, 0, "{name}");
        assert_eq!(tally.tried, tally.right + tally.refused + tally.open, "{name}");
        let fed = name.starts_with("input that is none");
        assert!(fed == (tally.right == 0), "{name}");
        assert!(10 * tally.open <= tally.tried, "{name}: {} are left open", tally.open);
        assert!(fed || 20 * tally.refused <= tally.tried, "{name}: {} are refused", tally.refused);
    }
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/solver.md");
    let page = std::fs::read_to_string(&path).expect("docs/solver.md");
    let (before, rest) = page.split_once(BEGIN).expect("the beginning of the table");
    let (table, after) = rest.split_once(END).expect("the end of the table");
    let (head, shown) = table.split_at(table.match_indices('\n').nth(1).map_or(0, |(at, _)| at + 1));
    if update {
        let page = format!("{before}{BEGIN}{head}{}{END}{after}", rows(&tallies));
        std::fs::write(&path, page).expect("docs/solver.md");
        return;
    }
    // The page has a row for each family, all of whose counts add up, and none wrong in silence.
    let numbers =
        |line: &str| -> Vec<usize> { line.split('|').filter_map(|cell| cell.trim().parse().ok()).collect() };
    let shown: Vec<&str> = shown.lines().collect();
    assert_eq!(shown.len(), FAMILIES.len() + 1);
    for (line, name) in shown.iter().zip(FAMILIES.iter().chain(&["all"])) {
        assert!(line.starts_with(&format!("| {name} | ")), "{line}");
        let [tried, right, refused, silent, open] = numbers(line)[..] else { panic!("{line}") };
        assert_eq!((tried, silent), (right + refused + open, 0), "{line}");
        assert!(tried >= MANY, "{line}");
    }
}

/// A case that is wrong is seen: the law of another kind, or a normal impulse off by a millionth.
#[test]
fn the_judge_sees_what_is_wrong() {
    let mut random = Random::new(5);
    for _ in 0..50 {
        let Case { m, v, surface, .. } = case(0, &mut random);
        let (Ok(mut hit), Ok(road)) = (solve(&m, &v, &surface), second_road::solve(&m, &v, &surface)) else {
            continue;
        };
        let bound = bound(&m, &v, &road);
        assert!(road.error(&hit, &v) <= bound || road.margin < 1e-9 * condition(&m));
        hit.impulse.x *= 1.0 + 1e-6;
        assert!(road.error(&hit, &v) > bound);
        let parting = Case { m, v: -v, surface, wrong: None };
        assert_ne!(surface.law, [Law::Poisson, Law::Newton][usize::from(surface.law == Law::Poisson)]);
        assert!(solve(&parting.m, &parting.v, &parting.surface).is_err());
    }
}
