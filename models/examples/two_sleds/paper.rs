//! Every number that the paper prints for this example, beside ours.

use nalgebra::Vector3;

use super::integrate::{Course, slopes};
use super::{Contact, Sticking, last_direction, positive, renewal_direction};

/// What the comparison is made of.
pub struct Numbers<'a> {
    /// t along N.x, N.y, N.z
    pub tangent: Vector3<f64>,
    /// heading of sled A
    pub q3: f64,
    /// the contact
    pub contact: &'a Contact,
    /// the course for mu = 1.1 under Stronge's hypothesis, and its v_n2
    pub renewal: (&'a Course, f64),
    /// the same for mu = 1.6
    pub sticking: (&'a Course, f64),
}

/// A line of the table: what, as printed, ours, and why they differ where they do.
struct Row(&'static str, &'static str, f64, &'static str);

/// The lines of the table.
fn rows(numbers: &Numbers<'_>) -> Vec<Row> {
    let m = &numbers.contact.reduced;
    let v = &numbers.contact.approach;
    let Sticking { c, mu_c, phi_c } = Sticking::of(m);
    let (sin, cos) = numbers.q3.sin_cos();
    let along_a1 = numbers.tangent.dot(&Vector3::new(cos, sin, 0.0));
    let along_a3 = numbers.tangent.z;
    let phi_hat = renewal_direction(m, 1.1);
    let (f_hat, ..) = slopes(numbers.contact, 1.1, phi_hat);
    let of = |place: Option<super::integrate::Place>, value: fn(&super::integrate::Place) -> f64| {
        place.as_ref().map_or(f64::NAN, value)
    };
    let (renewal, sticking) = (numbers.renewal.0, numbers.sticking.0);
    let energy =
        |course: &Course| (of(course.compression, |p| p.normal_work), of(course.slip, |p| p.normal_work));
    let (c_11, s_11) = energy(renewal);
    let (c_16, s_16) = energy(sticking);
    vec![
        Row("p, m", "-0.5", 0.5, "all other numbers belong to p = +0.5"),
        Row("phi of t in a1, a3", "3.81", positive(along_a3.atan2(along_a1)), ""),
        Row("v_n1, m/s", "-0.9", v.x, ""),
        Row("v_t1, m/s", "1.06", v.y, ""),
        Row("v_s1, m/s", "0", v.z, ""),
        Row("m_nn, 1/kg", "0.225", m.nn, ""),
        Row("m_tt, 1/kg", "0.236", m.tt, ""),
        Row("m_ss, 1/kg", "0.270", m.ss, ""),
        Row("m_nt, 1/kg", "-0.109", m.nt, ""),
        Row("m_ts, 1/kg", "-0.116", m.ts, ""),
        Row("m_ns, 1/kg", "-0.126", m.ns, ""),
        Row("c_n, kg (41)", "42.6", c.x, ""),
        Row("c_t, kg (41)", "37.3", c.y, ""),
        Row("c_s, kg (41)", "35.8", c.z, ""),
        Row("mu_c (43)", "1.21", mu_c, ""),
        Row("phi_c (43)", "3.76", phi_c, "(43) with the printed c_t, c_s gives 3.906"),
        Row("phi_hat, mu = 1.1", "3.91", phi_hat, ""),
        Row("mu_s = m_ns/m_ts", "1.086", m.ns / m.ts, ""),
        Row("phi_bar, mu = 1.1", "0.432", last_direction(numbers.contact, 1.1), ""),
        Row("phi_bar, mu = 1.6", "0.598", last_direction(numbers.contact, 1.6), ""),
        Row("mu = 1.1: E_nC, J", "-1.295", c_11, ""),
        Row("mu = 1.1: E_nS, J", "-1.291", s_11, ""),
        Row("mu = 1.1: f_hat, 1/kg", "0.0425", f_hat, ""),
        Row("mu = 1.1: v_nS, m/s", "0.0533", of(renewal.slip, |p| p.normal), ""),
        Row("mu = 1.1: v_n2, m/s", "0.203", numbers.renewal.1, "(61) with the printed inputs gives 0.270"),
        Row("mu = 1.6: E_nC, J", "-1.085", c_16, ""),
        Row("mu = 1.6: E_nS, J", "-1.083", s_16, ""),
        Row("mu = 1.6: c_n, kg", "42.59", c.x, ""),
        Row("mu = 1.6: v_nS, m/s", "0.0402", of(sticking.slip, |p| p.normal), ""),
        Row("mu = 1.6: v_n2, m/s", "0.267", numbers.sticking.1, "(61) with the printed inputs gives 0.185"),
    ]
}

/// Prints the table. The error names a number that should agree and does not.
pub fn compare(numbers: &Numbers<'_>) -> Result<(), String> {
    let mut wrong = Vec::new();
    say!("                           the paper        this program");
    for Row(what, printed, ours, why) in rows(numbers) {
        let mark = match (agrees(printed, ours), why) {
            (true, _) => String::new(),
            (false, "") => {
                wrong.push(what);
                "   <- should agree".to_string()
            }
            (false, why) => format!("   <- cannot be reproduced: {why}"),
        };
        say!("  {what:24} {printed:>9} {ours:18.9}{mark}");
    }
    say!("  docs/assumptions.md lists what else the print gets wrong.");
    if wrong.is_empty() { Ok(()) } else { Err(format!("not reproduced: {}", wrong.join(", "))) }
}

/// Whether the number, rounded or cut to the digits printed, agrees.
fn agrees(printed: &str, ours: f64) -> bool {
    let digits = printed.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
    let Ok(number) = printed.parse::<f64>() else { return false };
    (number - ours).abs() < 10f64.powi(-digits)
}
