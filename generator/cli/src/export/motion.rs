//! Motion in an exported library: functions that advance it from event to event, and their header. They call
//! `hodograph_fmu::motion`; the feature `simulation` of the crate builds them.

use hodograph_simulation::EventKind;

use super::module::Module;
use super::names;

/// What motion needs to be known of a mechanism.
pub struct Motion {
    /// the names of the contacts
    pub contacts: Vec<String>,
    /// the number of the inputs
    pub inputs: usize,
    /// the greatest step of the integration, s
    pub max_step: f64,
    /// what stands after `hodograph-fmu =` in the manifest, in braces
    pub dependency: String,
}

/// How many numbers a record of the module holds.
pub fn size(module: &Module, name: &str) -> usize {
    module.records.iter().find(|record| record.name == name).map_or(0, |record| record.fields.len())
}

/// The functions, without the name of the library. `set_inputs` is that of mechanisms with inputs.
const FUNCTIONS: [&str; 8] = ["new", "advance", "set_inputs", "time", "state", "force", "message", "free"];

/// The constants of the contacts in order, all different also where capitals make names equal.
fn contacts(motion: &Motion) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for contact in &motion.contacts {
        let mut name = format!("CONTACT_{}", names::ascii(contact).to_uppercase());
        while names.contains(&name) {
            name.push('_');
        }
        names.push(name);
    }
    names
}

/// All names that the header declares.
pub fn declared_names(name: &str, motion: &Motion) -> Vec<String> {
    let upper = name.to_uppercase();
    let kinds = EventKind::NAMES.iter().map(|kind| format!("EVENT_{}", kind.to_uppercase()));
    let constants = ["SIMULATION_H", "REACHED", "AT_EVENT", "REFUSED"].map(str::to_owned);
    let constants = constants.into_iter().chain(kinds).chain(contacts(motion));
    let types = ["event_kind", "contact", "progress", "event", "simulation"].map(str::to_owned);
    let functions = FUNCTIONS.iter().filter(|function| **function != "set_inputs" || motion.inputs > 0);
    let functions = functions.map(|function| format!("simulation_{function}"));
    let types = types.into_iter().filter(|of| of != "contact" || !motion.contacts.is_empty());
    let lower = types.chain(functions);
    constants.map(|of| format!("{upper}_{of}")).chain(lower.map(|of| format!("{name}_{of}"))).collect()
}

/// The text of the header.
pub fn header(module: &Module, motion: &Motion) -> String {
    let (name, upper) = (&module.name, module.name.to_uppercase());
    let rows = |rows: Vec<String>| {
        let rows: Vec<String> =
            rows.into_iter().enumerate().map(|(value, row)| format!("    {upper}_{row} = {value}")).collect();
        rows.join(",\n")
    };
    let kinds = rows(EventKind::NAMES.iter().map(|kind| format!("EVENT_{}", kind.to_uppercase())).collect());
    let contacts = match motion.contacts.len() {
        0 => String::new(),
        _ => format!(
            "/** The contacts by number. */\nenum {name}_contact {{\n{}\n}};\n\n",
            rows(contacts(motion))
        ),
    };
    let surfaces = match motion.contacts.len() {
        0 => ("", String::new()),
        1 => (", const {name}_surface *surface", " `surface` is that of the contact.".to_owned()),
        count => (
            ", const {name}_surface *surfaces",
            format!(" `surfaces` are those of the {count} contacts, by number."),
        ),
    };
    let (surfaces, about_surfaces) = (surfaces.0.replace("{name}", name), surfaces.1);
    let (inputs, set_inputs) = match motion.inputs {
        0 => (String::new(), String::new()),
        _ => (
            format!(" const {name}_inputs *inputs,"),
            format!(
                "/** Changes the inputs, which are held until they are changed again. Refused ones change nothing. */\n\
                 int32_t {name}_simulation_set_inputs(\n    {name}_simulation *motion, const {name}_inputs *inputs);\n\n"
            ),
        ),
    };
    format!(
        r#"/**
 * @file
 * Motion of {mechanism} with impacts and contact that lasts, from event to event.
 *
 * The library must be built with it: `cargo build --release --features simulation`.
 *
 * A motion is an object that only this library reads. {name}_simulation_new makes it, {name}_simulation_free
 * gives it back; in between the library takes memory from the system. Calls with different motions may run at
 * the same time.
 */
#ifndef {upper}_SIMULATION_H
#define {upper}_SIMULATION_H

#include "{name}.h"

#ifdef __cplusplus
extern "C" {{
#endif

/** Kinds of events. */
enum {name}_event_kind {{
{kinds}
}};

{contacts}/** How far {name}_simulation_advance came. The others answer a {name}_status, or that they refuse, too. */
enum {name}_progress {{
    /** to the time asked for */
    {upper}_REACHED = 0,
    /** to an event */
    {upper}_AT_EVENT = 1,
    /** no further, or the call is refused: {name}_simulation_message says why */
    {upper}_REFUSED = -1
}};

/** An event. */
typedef struct {name}_event {{
    /** time, in s */
    double time;
    /** change of kinetic energy of an impact, in J; 0 of other events */
    double energy_change;
    /** impulse on the striking point of an impact of one contact, along N.x, N.y, N.z, in N s; 0 of others */
    double impulse_on_point[3];
    /** one of the constants of {name}_event_kind */
    int32_t kind;
    /** the number of the contact; -1 where there is none or where there are several */
    int32_t contact;
}} {name}_event;

/** A motion. */
typedef struct {name}_simulation {name}_simulation;

/**
 * Begins a motion.{about_surfaces} `tolerance` is the relative and absolute tolerance of the integration, as
 * 1e-12.
 *
 * The mechanism is copied. Answers {upper}_OK, or {upper}_NULL or {upper}_UNKNOWN_LAW and no motion, or
 * {upper}_REFUSED and a motion that did not begin: its message says why, and it must be given back as any other.
 */
int32_t {name}_simulation_new(
    const {name} *mechanism, double time, const {name}_coordinates *q, const {name}_speeds *u,{inputs}
    double tolerance{surfaces}, {name}_simulation **answer);

/**
 * Advances the motion to its next event or to a time in s, whichever comes first: one of the constants of
 * {name}_progress. The event is written only with {upper}_AT_EVENT; a null pointer asks for none.
 */
int32_t {name}_simulation_advance({name}_simulation *motion, double until, {name}_event *event);

{set_inputs}/** The time reached, in s; not a number for a null pointer and for a motion that did not begin. */
double {name}_simulation_time(const {name}_simulation *motion);

/** The state at that time. */
int32_t {name}_simulation_state(
    const {name}_simulation *motion, {name}_coordinates *q, {name}_speeds *u);

/** The force of a contact at that time on its striking point along its n, t, s, in N; 0 where it is open. */
int32_t {name}_simulation_force({name}_simulation *motion, int32_t contact, double answer[3]);

/**
 * Why the motion did not begin, or why its last call of advance, set_inputs or force was refused; empty where
 * it was not. The text lasts until the next call with this motion.
 */
const char *{name}_simulation_message(const {name}_simulation *motion);

/** Gives a motion back. A null pointer is allowed. */
void {name}_simulation_free({name}_simulation *motion);

#ifdef __cplusplus
}}
#endif

#endif /* {upper}_SIMULATION_H */
"#,
        mechanism = module.mechanism,
    )
}

/// The text of `src/simulation.rs`.
pub fn library(module: &Module, motion: &Motion) -> String {
    let name = &module.name;
    let (n, p) = (size(module, "Coordinates"), size(module, "Speeds"));
    let (count, contacts) = (motion.inputs, motion.contacts.len());
    let max_step = if motion.max_step.is_finite() {
        format!("{:?}", motion.max_step)
    } else {
        "f64::INFINITY".to_owned()
    };
    let (with_inputs, inputs_null, inputs) = match count {
        0 => (String::new(), "", "[0.0; 0]"),
        _ => (
            format!("\n    inputs: *const [f64; {count}],"),
            " || inputs.is_null()",
            "unsafe { inputs.read() }",
        ),
    };
    let (with_surfaces, surfaces_null, surfaces) = match contacts {
        0 => (String::new(), "", "[CSurface { mu: 0.0, e: 0.0, law: 0 }; 0]"),
        _ => (
            format!("\n    surfaces: *const [CSurface; {contacts}],"),
            " || surfaces.is_null()",
            "unsafe { surfaces.read() }",
        ),
    };
    let set_inputs = match count {
        0 => String::new(),
        _ => set_inputs(name, count),
    };
    format!(
        r#"//! Motion for C: see `include/{name}_simulation.h`.

use core::ffi::c_char;
use std::sync::Arc;

use hodograph::{{Cause, State, Surface}};
use hodograph_fmu::motion::{{Motion, MotionEvent, REFUSED, Start}};

use crate::{{CMechanism, CSurface, Mechanism, NULL, OK, status, surface_of}};

#[unsafe(no_mangle)]
pub unsafe extern "C" fn {name}_simulation_new(
    mechanism: *const CMechanism,
    time: f64,
    q: *const [f64; {n}],
    u: *const [f64; {p}],{with_inputs}
    tolerance: f64,{with_surfaces}
    answer: *mut *mut Motion,
) -> i32 {{
    if mechanism.is_null() || q.is_null() || u.is_null() || answer.is_null(){inputs_null}{surfaces_null} {{
        return NULL;
    }}
    // SAFETY: the pointers are not null, and point to what the header says.
    let (mechanism, q, u) = unsafe {{ (mechanism.cast::<Mechanism>().read(), q.read(), u.read()) }};
    // SAFETY: as above.
    let inputs: [f64; {count}] = {inputs};
    // SAFETY: as above.
    let surfaces: [CSurface; {contacts}] = {surfaces};
    let surfaces: Option<Vec<Surface<f64>>> = surfaces.into_iter().map(surface_of).collect();
    let Some(surfaces) = surfaces else {{ return status(Cause::UnknownLaw) }};
    let state = State {{ time, coordinates: &q, speeds: &u, inputs: &inputs }};
    let start = Start {{ state, surfaces: &surfaces, tolerance, max_step: {max_step} }};
    let motion = Box::new(Motion::begin(Arc::new(mechanism), &start));
    let has_begun = motion.has_begun();
    // SAFETY: not null, and the caller's to write to.
    unsafe {{ answer.write(Box::into_raw(motion)) }};
    if has_begun {{ OK }} else {{ REFUSED }}
}}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn {name}_simulation_advance(
    motion: *mut Motion,
    until: f64,
    event: *mut MotionEvent,
) -> i32 {{
    // SAFETY: null, or made by `{name}_simulation_new`, and no other call uses it now.
    let Some(motion) = (unsafe {{ motion.as_mut() }}) else {{ return REFUSED }};
    let (progress, found) = motion.advance(until);
    if let Some(found) = found
        && !event.is_null()
    {{
        // SAFETY: not null, and the caller's to write to.
        unsafe {{ event.write(found) }};
    }}
    progress
}}

{set_inputs}#[unsafe(no_mangle)]
pub unsafe extern "C" fn {name}_simulation_time(motion: *const Motion) -> f64 {{
    // SAFETY: null, or made by `{name}_simulation_new`.
    unsafe {{ motion.as_ref() }}.map_or(f64::NAN, Motion::time)
}}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn {name}_simulation_state(
    motion: *const Motion,
    q: *mut [f64; {n}],
    u: *mut [f64; {p}],
) -> i32 {{
    if motion.is_null() || q.is_null() || u.is_null() {{
        return NULL;
    }}
    let (mut coordinates, mut speeds) = ([0.0; {n}], [0.0; {p}]);
    // SAFETY: not null, and made by `{name}_simulation_new`.
    if !unsafe {{ &*motion }}.state(&mut coordinates, &mut speeds) {{
        return REFUSED;
    }}
    // SAFETY: not null, and the caller's to write to.
    unsafe {{
        q.write(coordinates);
        u.write(speeds);
    }}
    OK
}}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn {name}_simulation_force(
    motion: *mut Motion,
    contact: i32,
    answer: *mut [f64; 3],
) -> i32 {{
    if motion.is_null() || answer.is_null() {{
        return NULL;
    }}
    // SAFETY: not null, made by `{name}_simulation_new`, and no other call uses it now.
    let Some(force) = unsafe {{ &mut *motion }}.contact_force(contact) else {{ return REFUSED }};
    // SAFETY: not null, and the caller's to write to.
    unsafe {{ answer.write(force) }};
    OK
}}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn {name}_simulation_message(motion: *const Motion) -> *const c_char {{
    // SAFETY: null, or made by `{name}_simulation_new`.
    unsafe {{ motion.as_ref() }}.map_or(c"there is no motion".as_ptr(), |motion| motion.message().as_ptr())
}}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn {name}_simulation_free(motion: *mut Motion) {{
    if !motion.is_null() {{
        // SAFETY: made by `{name}_simulation_new`, and given back once.
        drop(unsafe {{ Box::from_raw(motion) }});
    }}
}}
"#
    )
}

/// The function that changes inputs.
fn set_inputs(name: &str, count: usize) -> String {
    format!(
        r#"#[unsafe(no_mangle)]
pub unsafe extern "C" fn {name}_simulation_set_inputs(
    motion: *mut Motion,
    inputs: *const [f64; {count}],
) -> i32 {{
    if motion.is_null() || inputs.is_null() {{
        return NULL;
    }}
    // SAFETY: not null, and made by `{name}_simulation_new`, and no other call uses it now.
    let (motion, inputs) = unsafe {{ (&mut *motion, inputs.read()) }};
    if motion.set_inputs(&inputs) {{ OK }} else {{ REFUSED }}
}}

"#
    )
}

/// The part of the README.
pub fn readme(module: &Module, motion: &Motion) -> String {
    let (name, upper) = (&module.name, module.name.to_uppercase());
    let (mut declared, mut filled) = (String::new(), String::new());
    let mut default = |what: &str| {
        declared += &format!("    {name}_{what} {what};\n");
        filled += &format!("    if ({name}_default_{what}(&{what}) != {upper}_OK)\n        return 1;\n");
    };
    let has_parameters = size(module, "Parameters") > 0;
    if has_parameters {
        default("parameters");
    }
    default("coordinates");
    default("speeds");
    let inputs = if motion.inputs > 0 { "&inputs, " } else { "" };
    if motion.inputs > 0 {
        default("inputs");
    }
    let parameters = if has_parameters { "&parameters, " } else { "" };
    let surfaces = if motion.contacts.is_empty() { "" } else { "surfaces, " };
    if !motion.contacts.is_empty() {
        let each = vec![format!("{{0.3, 0.5, {upper}_STRONGE}}"); motion.contacts.len()].join(", ");
        declared += &format!("    {name}_surface surfaces[{}] = {{{each}}};\n", motion.contacts.len());
    }
    format!(
        r#"
## Motion

`cargo build --release --features simulation` adds the functions of `include/{name}_simulation.h`: motion with
impacts and contact that lasts, from event to event, with inputs that may change at any time. These functions
allocate, and need the standard library. A program that prints the events of two seconds, with the same surface for
all contacts:

```c
#include <stdio.h>
#include "{name}_simulation.h"

int main(void)
{{
    {name} mechanism;
{declared}    {name}_simulation *motion = NULL;
    {name}_event event;
    int progress = {upper}_REFUSED;

{filled}    if ({name}_new({parameters}&mechanism) != {upper}_OK)
        return 2;
    if ({name}_simulation_new(
            &mechanism, 0, &coordinates, &speeds, {inputs}1e-12, {surfaces}&motion) == {upper}_OK) {{
        while ((progress = {name}_simulation_advance(motion, 2, &event)) == {upper}_AT_EVENT)
            printf("%.17g s: event %d at contact %d\n", event.time, (int)event.kind, (int)event.contact);
    }}
    if (progress == {upper}_REFUSED)
        printf("%s\n", {name}_simulation_message(motion));
    {name}_simulation_free(motion);
    return progress == {upper}_REACHED ? 0 : 3;
}}
```
"#
    )
}
