//! The Rust side of an exported mechanism: functions with C's calling convention.

use std::fmt::Write;

use super::module::{Form, Module, Routine};
use super::{STATUSES, names};

/// The text of `src/lib.rs`.
pub fn library(module: &Module, scalar: &str, motion: bool) -> String {
    let simulation = if motion { "#[cfg(feature = \"simulation\")]\nmod simulation;\n" } else { "" };
    let name = &module.name;
    let mut out = format!(
        "//! The mechanism `{}` for C: see `include/{name}.h`.\n\n#![cfg_attr(not(feature = \"std\"), no_std)]\n#![allow(clippy::missing_safety_doc, clippy::useless_conversion)]\n\n\
         mod mechanism;\n{simulation}\nuse hodograph::{{Cause, Law, Surface}};\n\
         use mechanism::{} as model;\n\n",
        module.mechanism, module.path
    );
    out += "#[cfg(not(feature = \"std\"))]\n#[panic_handler]\nfn panic(_: &core::panic::PanicInfo<'_>) -> ! {\n    loop {}\n}\n\n";
    let _ = write!(
        out,
        "/// The mechanism as C keeps it.\n#[repr(C)]\n#[derive(Clone, Copy)]\npub struct CMechanism([{scalar}; {0}]);\n\ntype Mechanism = model::{1}<{scalar}>;\n\
         const _: () = assert!(size_of::<Mechanism>() <= size_of::<CMechanism>() && align_of::<Mechanism>() <= align_of::<CMechanism>());\n\n\
         /// Friction and restitution as C gives them.\n#[repr(C)]\n#[derive(Clone, Copy)]\npub struct CSurface {{\n    mu: {scalar},\n    e: {scalar},\n    law: i32,\n}}\n\n",
        module.numbers.max(1),
        module.mechanism,
    );
    out += &statuses(scalar);
    for record in module.records.iter().filter(|record| !record.is_plain()) {
        let _ = write!(
            out,
            "/// {} as C has it.\n#[repr(C)]\n#[derive(Clone, Copy)]\npub struct C{} {{\n",
            record.name, record.name
        );
        for field in &record.fields {
            let _ = writeln!(out, "    {}: {},", field.name, names::memory(module, scalar, &field.form));
        }
        let _ = write!(
            out,
            "}}\n\nimpl From<model::{0}<{scalar}>> for C{0} {{\n    fn from(value: model::{0}<{scalar}>) -> Self {{\n        C{0} {{\n",
            record.name
        );
        for field in &record.fields {
            let value = names::stored(module, &field.form, &format!("value.{}", field.name));
            let _ = writeln!(out, "            {}: {value},", field.name);
        }
        out += "        }\n    }\n}\n\n";
    }
    out += &construction(module, scalar);
    for record in module.records.iter().filter(|record| record.stated && !record.fields.is_empty()) {
        let of = names::record(module, &record.name);
        let what = of.trim_start_matches(name.as_str()).trim_start_matches('_').to_owned();
        let _ = write!(
            out,
            "#[unsafe(no_mangle)]\npub unsafe extern \"C\" fn {name}_default_{what}(answer: *mut [{scalar}; {}]) -> i32 {{\n    if answer.is_null() {{\n        return NULL;\n    }}\n    \
             // SAFETY: not null, and the caller's to write to.\n    unsafe {{ answer.write(model::{}::<{scalar}>::default().into()) }};\n    OK\n}}\n\n",
            record.fields.len(),
            record.name,
        );
    }
    for routine in &module.routines {
        out += &function(module, scalar, routine, false);
        if routine.budgeted {
            out += &function(module, scalar, routine, true);
        }
    }
    out
}

/// The constants of the status, the status of a cause, and the surface with a given number of the law.
fn statuses(scalar: &str) -> String {
    let mut out = String::new();
    for (value, (name, docs)) in STATUSES.iter().enumerate() {
        let _ = write!(out, "/// {docs}\npub const {name}: i32 = {value};\n");
    }
    let first = STATUSES.len();
    let _ = write!(
        out,
        "\n/// The status of a cause: its number after the others.\nfn status(cause: Cause) -> i32 {{\n    {first} + i32::from(cause.number())\n}}\n\n\
         #[allow(dead_code)]\nfn surface_of(CSurface {{ mu, e, law }}: CSurface) -> Option<Surface<{scalar}>> {{\n    Law::numbered(law).map(|law| Surface {{ mu, e, law }})\n}}\n\n"
    );
    out += &parts(scalar);
    out
}

/// What collisions and closed contacts answer beside vectors: works and sensitivity, margins, selection.
fn parts(scalar: &str) -> String {
    format!(
        "/// Works, compressions and sensitivity of a collision as C has them.\n#[repr(C)]\n#[derive(Clone, Copy)]\npub struct CImpact {{\n    contact_work: {scalar},\n    \
         normal_work: {scalar},\n    energy_gained: {scalar},\n    compressions: i32,\n    flags: [i32; 5],\n}}\n\n\
         impl From<hodograph::Impact<{scalar}>> for CImpact {{\n    fn from(impact: hodograph::Impact<{scalar}>) -> Self {{\n        let of = impact.sensitivity;\n        \
         let flags = [of.near_mu_c, of.grazing, of.unstable_direction, of.no_slip, of.jam];\n        CImpact {{\n            contact_work: impact.contact_work,\n            \
         normal_work: impact.normal_work,\n            energy_gained: impact.energy_gained().unwrap_or(0.0),\n            compressions: impact.compressions as i32,\n            \
         flags: flags.map(i32::from),\n        }}\n    }}\n}}\n\n\
         /// The margins of a mode as C has them.\n#[repr(C)]\n#[derive(Clone, Copy)]\npub struct CMargins([{scalar}; 4]);\n\n\
         impl From<hodograph::Margins<{scalar}>> for CMargins {{\n    fn from(margins: hodograph::Margins<{scalar}>) -> Self {{\n        \
         CMargins(margins.named().map(|(_, margin)| margin.unwrap_or({scalar}::INFINITY)))\n    }}\n}}\n\n\
         #[allow(dead_code)]\nfn selection(of: hodograph::Selection) -> i32 {{\n    match of {{\n        hodograph::Selection::Unique => 0,\n        \
         hodograph::Selection::SeveralModes => 1,\n        hodograph::Selection::Indeterminate => 2,\n        _ => 3,\n    }}\n}}\n\n"
    )
}

fn construction(module: &Module, scalar: &str) -> String {
    let parameters =
        module.records.iter().find(|record| record.name == "Parameters" && !record.fields.is_empty());
    let (argument, check, value) = match parameters {
        Some(record) => (
            format!("parameters: *const [{scalar}; {}], ", record.fields.len()),
            "parameters.is_null() || ",
            "Mechanism::new(unsafe { parameters.read() }.into())",
        ),
        None => (String::new(), "", "Mechanism::new()"),
    };
    let name = &module.name;
    format!(
        "#[unsafe(no_mangle)]\npub unsafe extern \"C\" fn {name}_new({argument}answer: *mut CMechanism) -> i32 {{\n    if {check}answer.is_null() {{\n        return NULL;\n    }}\n    \
         // SAFETY: the pointers are not null, and point to what the header says.\n    match {value} {{\n        Ok(mechanism) => {{\n            \
         // SAFETY: as above; the memory is large enough and aligned, which was asserted.\n            unsafe {{ answer.cast::<Mechanism>().write(mechanism) }};\n            OK\n        }}\n        \
         Err(error) => status(error.cause()),\n    }}\n}}\n\n"
    )
}

/// The function of a routine; `budgeted`: with a number of quadratures after the surface.
fn function(module: &Module, scalar: &str, routine: &Routine, budgeted: bool) -> String {
    let mut declared = vec!["mechanism: *const CMechanism".to_owned()];
    let mut nulls = vec!["mechanism.is_null()".to_owned()];
    let (mut read, mut passed) = (String::new(), Vec::new());
    for (name, form) in &routine.arguments {
        let memory = names::memory(module, scalar, form);
        match form {
            Form::Number => {
                declared.push(format!("{name}: {memory}"));
                passed.push(name.clone());
                continue;
            }
            Form::Surface => {
                let _ = writeln!(
                    read,
                    "    let Some({name}) = surface_of(unsafe {{ {name}.read() }}) else {{ return status(Cause::UnknownLaw) }};"
                );
            }
            Form::Record(record) => {
                let _ = writeln!(read, "    let {name} = model::{record}::from(unsafe {{ {name}.read() }});");
            }
            _ => {}
        }
        declared.push(format!("{name}: *const {memory}"));
        nulls.push(format!("{name}.is_null()"));
        if budgeted && *form == Form::Surface {
            declared.push("quadratures: u32".to_owned());
            passed.push(format!("&{name}.with_budget(quadratures)"));
        } else {
            passed.push(format!("&{name}"));
        }
    }
    declared.push(format!("answer: *mut {}", names::memory(module, scalar, &routine.answer)));
    nulls.push("answer.is_null()".to_owned());
    let of = &module.name;
    format!(
        "#[unsafe(no_mangle)]\npub unsafe extern \"C\" fn {of}_{}(\n    {},\n) -> i32 {{\n    if {} {{\n        return NULL;\n    }}\n    \
         // SAFETY: the pointers are not null, and point to what the header says; values are copied before anything is written.\n    \
         let mechanism = unsafe {{ &*mechanism.cast::<Mechanism>() }};\n{read}    match mechanism.{}({}) {{\n        Ok(value) => {{\n            \
         // SAFETY: as above.\n            unsafe {{ answer.write({}) }};\n            OK\n        }}\n        Err(error) => status(error.cause()),\n    }}\n}}\n\n",
        names::routine(routine, budgeted),
        declared.join(",\n    "),
        nulls.join(" || "),
        routine.name,
        passed.join(", "),
        names::stored(module, &routine.answer, "value"),
    )
}
