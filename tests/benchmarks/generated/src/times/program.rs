//! The text of the programs: C functions around the peer's, and the Rust program that calls them and ours in
//! turns.

use std::fmt::Write;
use std::path::Path;

use crate::derive::Derivation;
use crate::harness;
use crate::times::routines;

/// A routine of the peer.
pub struct Peer {
    /// name of its file and function
    pub name: String,
    /// the routine of ours that answers the same
    pub routine: String,
    /// how many numbers it answers with
    pub length: usize,
    /// the places of the sines and cosines that it needs, each with the angle as a C expression
    pub angles: Vec<(u64, String)>,
}

/// Angles that our runtime takes at once.
const MOST: usize = 8;

impl Peer {
    /// The C functions `own_..`, with one `sincos` of the system for each angle, and `shared_..`, with the
    /// sines and cosines of our runtime. The compiler knows that no pointer is null, so that the tests in
    /// CasADi's code vanish.
    pub fn calls(&self) -> String {
        let name = &self.name;
        let count = self.angles.iter().map(|(place, _)| place + 1).max().unwrap_or(1);
        let mut own = String::new();
        for (place, angle) in &self.angles {
            let _ = writeln!(own, "  sincos({angle}, &s[{place}], &c[{place}]);");
        }
        let mut shared = String::new();
        for group in self.angles.chunks(MOST) {
            let angles: Vec<&str> = group.iter().map(|(_, angle)| angle.as_str()).collect();
            let length = group.len();
            let _ = writeln!(
                shared,
                "  {{ const double a[{length}] = {{{}}}; double as[{length}], ac[{length}]; shared_sines_{length}(a, as, ac);",
                angles.join(", ")
            );
            for (at, (place, _)) in group.iter().enumerate() {
                let _ = writeln!(shared, "  s[{place}] = as[{at}]; c[{place}] = ac[{at}];");
            }
            shared += "  }\n";
        }
        let sines: String = (1..=MOST)
            .map(|length| format!("void shared_sines_{length}(const double*, double*, double*);\n"))
            .collect();
        let function = |kind: &str, angles: &str| {
            format!(
                "__attribute__((nonnull)) void {kind}_{name}(const double* q, const double* u, const double* x, double* out) {{
  double s[{count}], c[{count}];
{angles}  const double* arg[5] = {{q, s, c, u, x}};
  double* res[1] = {{out}};
  casadi_f0(arg, res, 0, 0, 0);
}}
"
            )
        };
        format!(
            "#define _GNU_SOURCE\n#include \"{name}.c\"\n{sines}{}{}",
            function("own", &own),
            function("shared", &shared)
        )
    }
}

/// The build script of a program: links the library in this folder.
pub fn build(folder: &Path) -> String {
    format!(
        "fn main() {{
    println!(\"cargo:rustc-link-search=native={0}\");
    println!(\"cargo:rustc-link-lib=static=peer\");
    println!(\"cargo:rustc-link-lib=m\");
    println!(\"cargo:rerun-if-changed={0}/libpeer.a\");
}}
",
        folder.display()
    )
}

/// The program: `numbers` prints what all answer at the states, `times` the least time of each, a number
/// repeats all that often at its states.
pub fn main(derivation: &Derivation<'_>, peers: &[Peer]) -> String {
    let case = derivation.case;
    let (module, mechanism) = (harness::module_name(derivation), harness::type_name(derivation));
    let (record, inputs) = if case.inputs { ("Inputs", ", i") } else { ("()", "") };
    let empty = if case.inputs { "Inputs::default()" } else { "()" };
    let given = format!("m: &Machine, q: &Coordinates, u: &Speeds, a: &Speeds, i: &{record}");
    let mut text = format!(
        "#![allow(unused)]
use std::hint::black_box;
use std::time::{{Duration, Instant}};
use hodograph::{{ReducedMatrix, StateError, nalgebra::SMatrix}};
include!(\"module.rs\");
use {module}::*;
type Machine = {mechanism}<f64>;

#[inline(never)]
fn measured_fd({given}) -> Result<Speeds, StateError> {{ m.accelerations(q, u{inputs}) }}
#[inline(never)]
fn measured_id({given}) -> Result<SMatrix<f64, {p}, 1>, StateError> {{ m.inverse_dynamics(q, u, a{inputs}) }}
#[inline(never)]
fn measured_cm({given}) -> Result<(SMatrix<f64, 3, {p}>, ReducedMatrix<f64>), StateError> {{ m.contact_matrices_{contact}(q) }}
#[inline(never)]
fn measured_m({given}) -> Result<SMatrix<f64, {p}, {p}>, StateError> {{ m.mass_matrix(q) }}
#[inline(never)]
fn measured_ml({given}) -> Result<[f64; {lower}], StateError> {{ m.mass_matrix_lower(q) }}
#[inline(never)]
fn measured_dfd({given}) -> Result<Derivatives<f64>, StateError> {{ m.accelerations_derivatives(q, u{inputs}) }}

struct State {{ q: Coordinates, u: Speeds, a: Speeds, i: {record}, none: {record}, peer_q: Vec<f64>, peer_u: Vec<f64>, peer_a: Vec<f64>, peer_x: Vec<f64> }}
type Foreign = unsafe extern \"C\" fn(*const f64, *const f64, *const f64, *mut f64);

fn print(numbers: &[f64]) {{
    let words: Vec<String> = numbers.iter().map(|number| format!(\"{{number:?}}\")).collect();
    println!(\"{{}}\", words.join(\" \"));
}}

/// The least time of each call, in turns, s.
fn least(calls: &mut [(&str, &mut dyn FnMut(usize))]) {{
    const TURN: Duration = Duration::from_micros(150);
    const TURNS: usize = 120;
    let mut repeats: Vec<usize> = Vec::new();
    for (_, call) in calls.iter_mut() {{
        let mut count = 1;
        loop {{
            let start = Instant::now();
            call(count);
            if start.elapsed() >= TURN {{ break }}
            count *= 2;
        }}
        repeats.push(count);
    }}
    let mut least = vec![f64::INFINITY; calls.len()];
    for _ in 0..TURNS {{
        for (at, (_, call)) in calls.iter_mut().enumerate() {{
            let start = Instant::now();
            call(repeats[at]);
            least[at] = least[at].min(start.elapsed().as_secs_f64() / repeats[at] as f64);
        }}
    }}
    for ((name, _), time) in calls.iter().zip(&least) {{ println!(\"{{name}} {{time:e}}\"); }}
}}
",
        p = derivation.speeds.len(),
        lower = derivation.speeds.len() * (derivation.speeds.len() + 1) / 2,
        contact = case.contact,
    );
    text += &sines();
    text += "unsafe extern \"C\" {\n";
    for peer in peers {
        for kind in ["own", "shared"] {
            let name = &peer.name;
            let _ = writeln!(
                text,
                "    fn {kind}_{name}(q: *const f64, u: *const f64, x: *const f64, out: *mut f64);"
            );
        }
    }
    text += "}\n\nfn main() {\n    let m = black_box(Machine::default());\n    let states: Vec<State> = black_box(vec![\n";
    for state in &derivation.states {
        let records = harness::state(state, case.inputs);
        let list = |values: &crate::states::Named| {
            let numbers: Vec<String> = values.iter().map(|(_, value)| format!("{value:?}")).collect();
            format!("vec![{}]", numbers.join(", "))
        };
        let x = if state.inputs.is_empty() { list(&state.a) } else { list(&state.inputs) };
        let _ = writeln!(
            text,
            "        {{ let (q, u, a, i) = ({records}); State {{ q, u, a, i, none: {empty}, peer_q: {}, peer_u: {}, peer_a: {}, peer_x: {x} }} }},",
            list(&state.q),
            list(&state.u),
            list(&state.a),
        );
    }
    text += "    ]);\n    let argument = std::env::args().nth(1).unwrap_or_default();\n";
    text += &calls(derivation, peers);
    text
}

/// The functions for sines and cosines that the peer's C code may call: ours.
fn sines() -> String {
    let mut text = String::new();
    for length in 1..=MOST {
        let _ = writeln!(
            text,
            "#[unsafe(no_mangle)]
unsafe extern \"C\" fn shared_sines_{length}(angles: *const f64, sines: *mut f64, cosines: *mut f64) {{
    unsafe {{
        let (s, c) = hodograph::generated::sines_cosines::<f64, {length}>(*(angles as *const [f64; {length}]));
        *(sines as *mut [f64; {length}]) = s;
        *(cosines as *mut [f64; {length}]) = c;
    }}
}}"
        );
    }
    text
}

/// The rest of the program: what is printed, counted and timed.
fn calls(derivation: &Derivation<'_>, peers: &[Peer]) -> String {
    let speeds = derivation.speeds.len();
    let mut numbers = String::new();
    let mut counted = String::new();
    let mut timed = String::new();
    let ours = |name: &str| {
        let inputs = if name == "measured_id" { "none" } else { "i" };
        format!(
            "black_box({name}(black_box(&m), black_box(&s.q), black_box(&s.u), black_box(&s.a), black_box(&s.{inputs})))"
        )
    };
    for (routine, name) in routines() {
        let call = ours(name);
        let shown = match routine {
            "FD" => format!("<[f64; {speeds}]>::from(r)"),
            "ID" => "r.as_slice()".to_owned(),
            "M" => "r.transpose().as_slice()".to_owned(),
            "M, one triangle" => "r".to_owned(),
            "dFD" => "[r.value.as_slice(), r.by_coordinates.as_slice(), r.by_speeds.as_slice()].concat()"
                .to_owned(),
            _ => "[r.0.transpose().as_slice(), &<[f64; 6]>::from(r.1)].concat()".to_owned(),
        };
        let shown = if matches!(routine, "M" | "ID") { shown } else { format!("&{shown}") };
        let _ = writeln!(numbers, "            let r = {call}.unwrap(); print({shown});");
        let _ = writeln!(counted, "            let _ = {call};");
        let _ = writeln!(
            timed,
            "    let mut {name}_ = |count: usize| for s in states.iter().cycle().take(count) {{ let _ = {call}; }};"
        );
    }
    for peer in peers {
        let x = if peer.routine == "ID" { "peer_a" } else { "peer_x" };
        for kind in ["own", "shared"] {
            let name = format!("{kind}_{}", peer.name);
            let call = format!(
                "unsafe {{ black_box({name} as Foreign)(black_box(s.peer_q.as_ptr()), black_box(s.peer_u.as_ptr()), black_box(s.{x}.as_ptr()), black_box(out.as_mut_ptr())) }}"
            );
            let _ = writeln!(numbers, "            {call}; print(&out[..{}]);", peer.length);
            let _ = writeln!(counted, "            {call};");
            let _ = writeln!(
                timed,
                "    let mut {name}_ = |count: usize| {{ let mut out = [0.0; LONGEST]; for s in states.iter().cycle().take(count) {{ {call}; black_box(&mut out); }} }};"
            );
        }
    }
    let longest = peers.iter().map(|peer| peer.length).max().unwrap_or(1);
    let names = routines()
        .map(|(_, name)| name.to_owned())
        .chain(peers.iter().flat_map(|peer| [format!("own_{}", peer.name), format!("shared_{}", peer.name)]));
    let listed: Vec<String> = names.map(|name| format!("(\"{name}\", &mut {name}_)")).collect();
    format!(
        "    const LONGEST: usize = {longest};
    let mut out = [0.0; LONGEST];
    if argument == \"numbers\" {{
        for s in &states {{
{numbers}        }}
    }}
    for _ in 0..argument.parse().unwrap_or(0) {{
        for s in &states {{
{counted}        }}
    }}
    if argument == \"times\" {{
{timed}    least(&mut [{}]);
    }}
}}
",
        listed.join(", ")
    )
}
