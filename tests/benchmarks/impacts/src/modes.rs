//! Closed contacts: the call that selects the mode, by the mode that it selects.

use std::hint::black_box;

use hodograph::{
    ContactMode, Law, ReducedMatrix, Surface, contact_force, contact_mode, impact_without_collision,
};
use nalgebra::{Matrix3, Vector2, Vector3};

/// A closed contact.
pub struct Closed {
    matrix: ReducedMatrix<f64>,
    free_acceleration: Vector3<f64>,
    slip: Vector2<f64>,
    mu: f64,
}

/// How many of each row are measured.
const COUNT: usize = 500;

/// A row of the table: its name, that of its function, the function (never inlined), and which contacts it is
/// asked of.
pub type Row = (&'static str, &'static str, fn(&Closed), fn(&Closed) -> bool);

macro_rules! rows {
    ($($label:literal, $name:ident: $call:expr, $which:expr;)*) => {
        $(#[inline(never)]
        fn $name(contact: &Closed) {
            // Functions of equal bodies would become one.
            black_box(stringify!($name));
            let call: fn(&Closed) -> bool = $call;
            black_box(call(black_box(contact)));
        })*
        /// All rows.
        pub const ROWS: &[Row] = &[$(($label, stringify!($name), $name, $which)),*];
    };
}

fn select(c: &Closed) -> bool {
    black_box(contact_mode(&c.matrix, &c.free_acceleration, &c.slip, c.mu)).is_ok()
}

fn selects(c: &Closed, mode: ContactMode) -> bool {
    contact_mode(&c.matrix, &c.free_acceleration, &c.slip, c.mu).is_ok_and(|answer| answer.mode == mode)
}

fn keep(c: &Closed, mode: ContactMode) -> bool {
    black_box(contact_force(mode, &c.matrix, &c.free_acceleration, &c.slip, c.mu)).is_ok()
}

fn jump(c: &Closed) -> bool {
    let surface = Surface { mu: c.mu, e: 0.5, law: Law::Poisson };
    black_box(impact_without_collision(&c.matrix, &c.slip, &surface)).is_ok()
}

fn slips(c: &Closed) -> bool {
    c.slip != Vector2::zeros()
}

rows! {
    "select: separate", measured_separate: select, |c| slips(c) && selects(c, ContactMode::Separate);
    "select: slide", measured_slide: select, |c| selects(c, ContactMode::Slide);
    "select: stick", measured_stick: select, |c| selects(c, ContactMode::Stick);
    "select: begin to slip", measured_begin: select, |c| selects(c, ContactMode::BeginSlip);
    "keep: slide", measured_keep_slide: |c| keep(c, ContactMode::Slide), |c| selects(c, ContactMode::Slide);
    "keep: stick", measured_keep_stick: |c| keep(c, ContactMode::Stick), |c| selects(c, ContactMode::Stick);
    "impact without collision, Poisson, e = 0.5", measured_jump: jump, |c| slips(c) && jump(c);
}

/// The contacts of a row: random ones of rank three, half of them with slip.
pub fn contacts(row: &Row) -> Vec<Closed> {
    let mut seed = 1_u64;
    let mut number = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let mut found = Vec::new();
    for case in 0.. {
        if found.len() == COUNT {
            break;
        }
        let root = Matrix3::from_fn(|_, _| number());
        let free_acceleration = Vector3::new(number(), number(), number());
        let slip = Vector2::new(number(), number());
        let contact = Closed {
            matrix: ReducedMatrix::from(root * root.transpose()),
            free_acceleration,
            slip: if case % 2 == 0 { slip } else { Vector2::zeros() },
            mu: 1.0 + number(),
        };
        if (row.3)(&contact) {
            found.push(contact);
        }
    }
    found
}
