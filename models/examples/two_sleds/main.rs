//! The example of S. Djerassi, "Three-dimensional, one-point collision with friction" (2012), from its model
//! file to its solved collisions, beside every number that the paper prints for it.
//!
//! `cargo run --release --example two_sleds` draws and prints the nine outcomes; `-- --compare` prints every
//! number beside the published one. Equation numbers are the paper's. The paper takes s = t x n in this
//! example (and n x t elsewhere); this program prints s = t x n, too.

/// Prints a line; ends the program where nobody reads on, as in `| head`.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        if writeln!(std::io::stdout(), $($text)*).is_err() {
            std::process::exit(0);
        }
    }};
}

mod integrate;
mod paper;
mod picture;

use std::error::Error;
use std::path::Path;

use hodograph::{Law, ReducedMatrix, Surface};
use hodograph_models::two_sleds::{Collision, Coordinates, Speeds, TwoSleds};
use nalgebra::Vector3;

use integrate::{Course, Terminal};

/// A contact in the paper's axes n, t and s = t x n.
struct Contact {
    reduced: ReducedMatrix<f64>,
    approach: Vector3<f64>,
}

impl Contact {
    fn of(hit: &Collision) -> Self {
        let m = hit.reduced;
        Contact { reduced: ReducedMatrix { ns: -m.ns, ts: -m.ts, ..m }, approach: flipped(&hit.approach) }
    }
}

/// Components along n, t, s = t x n from those along n, t, s = n x t, and back.
fn flipped(v: &Vector3<f64>) -> Vector3<f64> {
    // Adding 0 turns -0 into 0.
    Vector3::new(v.x, v.y, 0.0 - v.z)
}

/// e of all collisions, and mu.
const E: f64 = 0.8;
const MU: [f64; 3] = [0.6, 1.1, 1.6];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => show(),
        ["--compare"] => compare(),
        _ => Err("there is one option, --compare: every number beside the published one".into()),
    }
}

/// A solved collision.
struct Outcome {
    mu: f64,
    law: Law,
    hit: Collision,
}

/// The nine outcomes: three coefficients of friction under three laws of restitution.
fn outcomes() -> Result<Vec<Outcome>, Box<dyn Error>> {
    let sleds = TwoSleds::<f64>::default();
    let (q, u) = (Coordinates::default(), Speeds::default());
    let mut outcomes = Vec::new();
    for mu in MU {
        for &law in Law::ALL {
            let hit = sleds.collide_bc_ac(&q, &u, &Surface { mu, e: E, law })?;
            outcomes.push(Outcome { mu, law, hit });
        }
    }
    Ok(outcomes)
}

/// What there is to see first: a picture, a paragraph and the nine outcomes.
fn show() -> Result<(), Box<dyn Error>> {
    let outcomes = outcomes()?;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target");
    std::fs::create_dir_all(&folder)?;
    let path = folder.canonicalize()?.join("two_sleds.svg");
    std::fs::write(&path, picture::picture(&outcomes)?)?;
    say!(
        "Two sleds, each sliding on a plane of its own, collide at one point, with friction: the example of S. Djerassi's paper.\n\
         Hodograph derived their equations of motion from models/two_sleds.mech; the collision is solved exactly. While the bodies\n\
         touch, friction turns and slows the slip. It stops and begins anew in another direction, or stays zero, or lasts to the end.\n\
         The picture shows this course:\n\n  {}\n",
        path.display()
    );
    nine(&outcomes);
    say!(
        "\nEvery number of the paper beside ours, energies and speeds after: cargo run --release --example two_sleds -- --compare"
    );
    Ok(())
}

/// Prints the nine outcomes.
fn nine(outcomes: &[Outcome]) {
    say!("Nine outcomes, e = {E}: impulse and velocity of separation along n, t, s = t x n\n");
    say!("                    impulse, N s                      velocity of separation, m/s");
    say!("  mu   law              I_n        I_t        I_s         v_n        v_t        v_s   path");
    for Outcome { mu, law, hit } in outcomes {
        let (i, v) = (flipped(&hit.impulse), flipped(&hit.separation));
        let (law, path) = (format!("{law:?}"), hit.path.phases().join(", "));
        say!(
            " {mu:4}  {law:8} {:11.6} {:10.6} {:10.6}  {:10.7} {:10.7} {:10.7}   {path}",
            i.x,
            i.y,
            i.z,
            v.x,
            v.y,
            v.z,
        );
    }
}

/// Everything: each number of the paper beside ours, the outcomes, their energies and speeds.
fn compare() -> Result<(), Box<dyn Error>> {
    let sleds = TwoSleds::<f64>::default();
    let q = Coordinates::default();
    let u = Speeds::default();
    let e = E;

    say!(
        "Two sleds, each sliding on a plane of its own, collide at one point, with friction. The tables show what Hodograph computes\n\
         from the model file beside what the paper prints (S. Djerassi, Three-dimensional, one-point collision with friction, section 5):\n\
         the contact, its course for two coefficients of friction, then the outcomes for three, under three laws of restitution.\n"
    );
    say!("n = A.y, t along the slip of approach, s = t x n (the sign of this example in the paper)\n");

    let first = sleds.collide_bc_ac(&q, &u, &Surface { mu: 1.1, e, law: Law::Stronge })?;
    let contact = Contact::of(&first);
    let courses = [1.1, 1.6].map(|mu| {
        let collision = sleds.collide_bc_ac(&q, &u, &Surface { mu, e, law: Law::Stronge })?;
        Ok::<_, Box<dyn Error>>((integrate::course(&contact, mu, collision.impulse.x), collision))
    });
    let [renewal, sticking] = courses;
    let (renewal, sticking) = (renewal?, sticking?);
    paper::compare(&paper::Numbers {
        tangent: first.tangent,
        q3: q.q3,
        contact: &contact,
        renewal: (&renewal.0, renewal.1.separation.x),
        sticking: (&sticking.0, sticking.1.separation.x),
    })?;

    say!();
    let outcomes = outcomes()?;
    nine(&outcomes);

    say!(
        "\nEnergy of the nine outcomes, J: (23) from impulses, (23) from speeds, (35a) integrated along the path\n"
    );
    say!("  mu   law      I.(v1 + v2)/2   u M u/2 after - before   integral of (v_n - mu s) dI_n");
    for Outcome { mu, law, hit } in &outcomes {
        let before = sleds.kinetic_energy(&q, &u)?;
        let after = sleds.kinetic_energy(&q, &hit.speeds)?;
        let course = integrate::course(&contact, *mu, hit.impulse.x);
        let note =
            if hit.impact.energy_gained().is_some() { "  Newton's hypothesis gains energy" } else { "" };
        let law = format!("{law:?}");
        say!(
            " {mu:4}  {law:8} {:+14.10} {:+24.10} {:+31.10}{note}",
            hit.impact.contact_work,
            after - before,
            course.end.work,
        );
    }

    say!("\nGeneralised speeds after the collision by (12a); before: u1 = u4 = 1 m/s, u3 = u6 = 0.1 rad/s\n");
    say!("  mu   law              u1         u2         u3         u4         u5         u6");
    for Outcome { mu, law, hit } in &outcomes {
        let (u, d) = (&hit.speeds, &hit.dependent_speeds);
        let law = format!("{law:?}");
        say!(
            " {mu:4}  {law:8} {:10.6} {:10.6} {:10.6} {:10.6} {:10.6} {:10.6}",
            u.u1,
            d.u2,
            u.u3,
            u.u4,
            d.u5,
            u.u6,
        );
    }
    Ok(())
}

/// mu_c and phi_c of (43), and what they are made of.
struct Sticking {
    /// c_n, c_t, c_s of (41)
    c: Vector3<f64>,
    mu_c: f64,
    phi_c: f64,
}

impl Sticking {
    fn of(m: &ReducedMatrix<f64>) -> Self {
        let determinant = m.nn * (m.tt * m.ss - m.ts * m.ts) - m.tt * m.ns * m.ns - m.ss * m.nt * m.nt
            + 2.0 * m.nt * m.ns * m.ts;
        let c = Vector3::new(m.tt * m.ss - m.ts * m.ts, m.ns * m.ts - m.nt * m.ss, m.nt * m.ts - m.ns * m.tt)
            / determinant;
        Sticking { c, mu_c: c.y.hypot(c.z) / c.x, phi_c: positive(f64::atan2(-c.z, -c.y)) }
    }
}

/// The angle in [0, 2 pi).
fn positive(angle: f64) -> f64 {
    angle.rem_euclid(std::f64::consts::TAU)
}

/// The direction phi_hat in which slip is renewed, for mu < mu_c: (mu T + gamma) d = b with gamma > 0, see
/// (44).
fn renewal_direction(m: &ReducedMatrix<f64>, mu: f64) -> f64 {
    let direction = |gamma: f64| {
        let (tt, ts, ss) = (mu * m.tt + gamma, mu * m.ts, mu * m.ss + gamma);
        let determinant = tt * ss - ts * ts;
        ((ss * m.nt - ts * m.ns) / determinant, (tt * m.ns - ts * m.nt) / determinant)
    };
    // |d| falls as gamma grows, from more than 1 to less.
    let (mut low, mut high) = (0.0, m.nt.hypot(m.ns));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        let (x, y) = direction(middle);
        if x.hypot(y) > 1.0 { low = middle } else { high = middle }
    }
    let (x, y) = direction(high);
    positive(y.atan2(x))
}

/// The direction phi_bar in which slip ends: the first zero of h from phi = 0, where (34a) points.
fn last_direction(contact: &Contact, mu: f64) -> f64 {
    let h = |phi: f64| integrate::slopes(contact, mu, phi).2;
    let sign = h(0.0).signum();
    let mut low = 0.0;
    while h(low + 0.01 * sign) * sign > 0.0 && low.abs() < std::f64::consts::TAU {
        low += 0.01 * sign;
    }
    let mut high = low + 0.01 * sign;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if h(middle) * sign > 0.0 { low = middle } else { high = middle }
    }
    high
}

impl Course {
    /// What slip turns into when it ends.
    fn terminal(contact: &Contact, mu: f64) -> Terminal {
        let sticking = Sticking::of(&contact.reduced);
        if mu >= sticking.mu_c {
            Terminal::Stick(sticking.c)
        } else {
            Terminal::Renewal(renewal_direction(&contact.reduced, mu))
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;
    use std::process::{Command, Stdio};

    /// Every number of the paper is reproduced but those that are marked and explained.
    #[test]
    fn the_example_runs() {
        super::compare().expect("the numbers of the paper");
    }

    /// The picture has a curve for each friction in both panels, and a mark for each outcome.
    #[test]
    fn the_picture_shows_the_nine_outcomes() {
        super::show().expect("the outcomes");
        let drawn = super::picture::picture(&super::outcomes().expect("the outcomes")).expect("a picture");
        assert_eq!(drawn.matches("class=\"curve\"").count(), 6, "{drawn}");
        assert_eq!(drawn.matches("class=\"end\"").count(), 18, "{drawn}");
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{drawn}");
    }

    /// The program itself, in a process of its own: prints when standard input ends.
    #[test]
    #[ignore = "run by the test below"]
    fn prints_when_its_input_ends() {
        std::io::stdin().read_to_end(&mut Vec::new()).unwrap();
        super::show().unwrap();
        super::compare().unwrap();
    }

    /// Whoever reads a line and leaves, as `head` does, ends the program: without a panic, and with exit code 0.
    #[test]
    fn a_reader_that_leaves_ends_the_program() {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--ignored", "--exact", "tests::prints_when_its_input_ends", "--nocapture"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // What the test program says before the first line of ours.
        let begin = "\nrunning 1 test\n";
        let mut said = vec![0; begin.len()];
        let mut output = child.stdout.take().unwrap();
        output.read_exact(&mut said).unwrap();
        assert_eq!(String::from_utf8(said).unwrap(), begin);
        drop(output);
        drop(child.stdin.take());
        let left = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&left.stderr);
        assert!(left.status.success() && !told.contains("panicked"), "{}: {told}", left.status);
    }
}
