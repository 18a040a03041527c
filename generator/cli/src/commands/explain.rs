//! `hodograph explain`: writes the equations of a model for people, or the explanation of an error code.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use hodograph_generator::diagnostics::codes::ALL;
use hodograph_generator::explain::{Format, explain, usual};
use hodograph_generator::explanations;
use hodograph_generator::program::Quantity;
use hodograph_generator::program::cost::{Cost, Count};

use crate::derivation::{self, Limits};
use crate::evaluate::Machine;
use crate::model;
use crate::output;
use crate::spelling;
use crate::stop::{Outcome, Stop};

/// Write the equations of a model: mass matrix, forcing, contacts, with intermediate symbols z1, z2 .. as in
/// the paper
///
/// `hodograph explain E062` says what a mistake of that code is, with a wrong and a right example.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// the model file, or the code of an error or warning
    model: PathBuf,
    /// the format of the equations
    #[arg(long, value_enum, default_value_t = Style::Text)]
    format: Style,
    /// only these quantities, as derivations call them (`mass_matrix`, `contact 0 reduced` ..) [default: the
    /// usual ones]
    #[arg(long, value_name = "NAME")]
    quantity: Vec<String>,
    /// instead of equations, the number of operations of each routine at each stage
    #[arg(long, conflicts_with = "format")]
    cost: bool,
    /// with --cost: derive again, and show the operations after each pass
    #[arg(long, requires = "cost")]
    passes: bool,
    #[command(flatten)]
    limits: Limits,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Style {
    /// plain text
    Text,
    /// a LaTeX document
    Latex,
    /// an HTML page
    Html,
}

/// Runs the command.
///
/// # Errors
///
/// The model has errors, cannot be derived, or has no such quantity.
pub fn run(arguments: &Arguments) -> Outcome {
    if let Some(page) = code(&arguments.model)? {
        return output::text(&page);
    }
    let machine = derivation::machine(&arguments.model, &arguments.limits)?;
    let program = &machine.program;
    let known: Vec<String> = program.outputs.iter().map(|output| output.quantity.to_string()).collect();
    let mut quantities = Vec::new();
    for name in &arguments.quantity {
        let quantity = Quantity::from_words(&name.split_whitespace().collect::<Vec<_>>());
        match quantity.filter(|&quantity| program.output(quantity).is_some()) {
            Some(quantity) => quantities.push(quantity),
            None => {
                let hint = spelling::hint(name, known.iter().map(String::as_str));
                return Err(Stop::Call(format!("the model has no quantity `{name}`: {hint}")));
            }
        }
    }
    if arguments.cost {
        let trace = match arguments.passes {
            true => derivation::trace(&model::load(&arguments.model)?, &arguments.limits)?,
            false => String::new(),
        };
        return output::text(&costs(&machine, &quantities, &trace));
    }
    if quantities.is_empty() {
        quantities = usual(program);
    }
    let format = match arguments.format {
        Style::Text => Format::Text,
        Style::Latex => Format::Latex,
        Style::Html => Format::Html,
    };
    let Machine { mechanism, program } = machine;
    let doing = format!("writing the equations of {}", arguments.model.display());
    output::text(&arguments.limits.bound(&doing, move || explain(&mechanism, &program, &quantities, format))?)
}

/// The page of a code such as `E062`, if the argument is a code and not a file.
fn code(path: &Path) -> Outcome<Option<String>> {
    let Some(name) = path.to_str().filter(|_| !path.exists()).map(str::to_uppercase) else { return Ok(None) };
    let digits = name.strip_prefix(['E', 'W']).filter(|rest| !rest.is_empty() && rest.len() <= 6);
    let Some(digits) = digits.filter(|rest| rest.bytes().all(|digit| digit.is_ascii_digit())) else {
        return Ok(None);
    };
    // accept `E62` for `E062`
    let full = format!("{}{:0>3}", &name[..1], digits.trim_start_matches('0'));
    match explanations::page_of(&full) {
        Some(page) => Ok(Some(page)),
        None => {
            let mut of_letter = ALL.iter().map(|(code, _)| code.0).filter(|code| code[..1] == name[..1]);
            let (first, last) = (of_letter.clone().next().unwrap_or(""), of_letter.next_back().unwrap_or(""));
            let kind = if name.starts_with('E') { "errors" } else { "warnings" };
            Err(Stop::Call(format!(
                "there is no code {name}: {kind} have codes from {first} to {last}; docs/errors.md lists all"
            )))
        }
    }
}

/// The cells of a row: operations at construction, then those of an evaluation: multiplications, additions,
/// divisions, sines and cosines, others, all.
pub fn row(cost: &Cost) -> String {
    let cells = |count: Count| {
        let Count { multiplications, additions, divisions, trigonometric, functions, .. } = count;
        [multiplications, additions, divisions, trigonometric, functions, count.total()]
    };
    let evaluation = cost.evaluation();
    let numbers = [cost.parameter.total(), cost.configuration.total(), cost.velocity.total()];
    let numbers: Vec<String> = numbers
        .into_iter()
        .chain(cells(evaluation))
        .chain([evaluation.fused])
        .map(|n| n.to_string())
        .collect();
    numbers.join("\t")
}

/// The table of operations.
fn costs(machine: &Machine, quantities: &[Quantity], trace: &str) -> String {
    let program = &machine.program;
    let all = program.quantities();
    let chosen = if quantities.is_empty() { &all[..] } else { quantities };
    let mut rows: Vec<Vec<String>> = Vec::new();
    let split = |name: &str, cells: &str| {
        [name].into_iter().chain(cells.split('\t')).map(str::to_owned).collect::<Vec<String>>()
    };
    for &quantity in chosen {
        rows.push(split(&named(machine, quantity), &row(&program.cost(&[quantity]))));
    }
    rows.push(split("all together", &row(&program.cost(chosen))));
    for line in trace.lines() {
        if let Some((pass, cells)) = line.split_once('\t') {
            rows.push(split(&format!("all, after pass {pass}"), cells));
        }
    }
    let head =
        ["routine", "once", "config.", "speeds", "mul", "add", "div", "sin/cos", "other", "total", "fused"];
    rows.insert(0, head.map(str::to_owned).to_vec());
    let width =
        |column: usize| rows.iter().filter_map(|row| row.get(column)).map(String::len).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut out = "Operations: once at construction; then per evaluation, those of the configuration and those of the speeds, \
                   and both by kind. A pair of sine and cosine counts once.\n"
        .to_owned();
    for row in &rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column {
            0 => format!("{cell:width$}"),
            _ => format!("{cell:>width$}"),
        });
        out += &format!("{}\n", cells.collect::<Vec<_>>().join("  "));
    }
    out
}

/// A quantity with the name of its contact, point or frame.
fn named(machine: &Machine, quantity: Quantity) -> String {
    let words = quantity.to_string();
    let mechanism = &machine.mechanism;
    let name = |index: u32| match quantity {
        Quantity::Contact(..) => mechanism.contacts.get(index as usize).map(|contact| &contact.name),
        Quantity::Point(..) => mechanism.points.get(index as usize).map(|point| &point.name),
        _ => mechanism.frames.get(index as usize).map(|frame| &frame.name),
    };
    match quantity {
        Quantity::Contact(index, _) | Quantity::Point(index, _) | Quantity::Orientation(index) => {
            match name(index) {
                Some(name) => format!("{words} ({name})"),
                None => words,
            }
        }
        _ => words,
    }
}
