//! `modelDescription.xml`: the variables of a unit as FMI 3.0 states them.

use std::fmt::Write;

use hodograph::{ComponentKind, Contacts, Law};

use crate::layout::{Defaults, Layout, TOLERANCE, VariableKind};

/// Text with the special characters of XML escaped.
pub fn escaped(text: &str) -> String {
    let mut out = String::new();
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML allows no other control characters.
            '\n' | '\t' => out.push(' '),
            letter if letter.is_control() => {}
            letter => out.push(letter),
        }
    }
    out
}

/// The text of `modelDescription.xml`. `identifier` is the name of the shared library without its extension,
/// `token` the instantiation token, `docs` a sentence about the model.
///
/// # Errors
///
/// Those of [`Layout::of`].
pub fn description(
    mechanism: &dyn Contacts<f64>,
    defaults: &Defaults,
    identifier: &str,
    token: &str,
    docs: &str,
) -> Result<String, String> {
    let layout = Layout::of(mechanism, defaults)?;
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{}\" instantiationToken=\"{}\"{} \
         generationTool=\"Hodograph {}\" variableNamingConvention=\"flat\">\n",
        escaped(mechanism.name()),
        escaped(token),
        if docs.is_empty() { String::new() } else { format!(" description=\"{}\"", escaped(docs)) },
        env!("CARGO_PKG_VERSION"),
    );
    let can =
        "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\" providesDirectionalDerivatives=\"true\"";
    let _ = write!(
        out,
        "  <ModelExchange modelIdentifier=\"{0}\" needsCompletedIntegratorStep=\"true\" {can}/>\n  \
         <CoSimulation modelIdentifier=\"{0}\" canHandleVariableCommunicationStepSize=\"true\" {can}/>\n",
        escaped(identifier)
    );
    units(&layout, &mut out);
    let item = |name: &str, value: usize, docs: &str| {
        format!("      <Item name=\"{name}\" value=\"{value}\" description=\"{}\"/>\n", escaped(docs))
    };
    let laws = Law::ALL.iter().enumerate();
    let laws: String = laws.map(|(place, law)| item(law.name(), place + 1, law.about())).collect();
    let phases = [("open", "apart"), ("stick", "they touch without slip"), ("slide", "they touch and slide")];
    let phases: String =
        phases.into_iter().enumerate().map(|(place, (name, docs))| item(name, place, docs)).collect();
    let _ = write!(
        out,
        "  <TypeDefinitions>\n    <EnumerationType name=\"Law\" description=\"hypotheses of restitution\">\n{laws}    </EnumerationType>\n    \
         <EnumerationType name=\"Phase\" description=\"phases of a contact\">\n{phases}    </EnumerationType>\n  </TypeDefinitions>\n"
    );
    out.push_str("  <LogCategories>\n    <Category name=\"logStatusError\" description=\"why a call failed\"/>\n  </LogCategories>\n");
    out.push_str(
        "  <DefaultExperiment startTime=\"0\" stopTime=\"10\" stepSize=\"0.01\"/>\n  <ModelVariables>\n",
    );
    for reference in 0..layout.variables.len() {
        variable(&layout, mechanism, defaults, reference, &mut out);
    }
    out.push_str("  </ModelVariables>\n");
    structure(&layout, mechanism, &mut out);
    out.push_str("</fmiModelDescription>\n");
    Ok(out)
}

/// Whether the description states a unit.
fn has_unit(unit: &str) -> bool {
    !unit.is_empty() && unit != "1"
}

fn units(layout: &Layout, out: &mut String) {
    let mut names: Vec<&str> = layout
        .variables
        .iter()
        .map(|variable| variable.unit.as_str())
        .filter(|unit| has_unit(unit))
        .collect();
    names.sort_unstable();
    names.dedup();
    out.push_str("  <UnitDefinitions>\n");
    for name in names {
        let _ = writeln!(out, "    <Unit name=\"{}\"/>", escaped(name));
    }
    out.push_str("  </UnitDefinitions>\n");
}

fn variable(
    layout: &Layout,
    mechanism: &dyn Contacts<f64>,
    defaults: &Defaults,
    reference: usize,
    out: &mut String,
) {
    let of = &layout.variables[reference];
    let [parameters, coordinates, speeds, inputs] = &layout.start;
    let surface =
        |contact: usize| layout.surfaces.iter().find(|(index, _)| *index == contact).map(|(_, own)| own);
    let fixed = |value: f64| {
        format!(
            " causality=\"parameter\" variability=\"fixed\" initial=\"exact\" start=\"{}\"",
            number(value)
        )
    };
    let computed = " causality=\"output\" variability=\"continuous\" initial=\"calculated\"".to_owned();
    let state = |value: f64, initial: &str| {
        format!(
            " causality=\"output\" variability=\"continuous\" initial=\"{initial}\" start=\"{}\"",
            number(value)
        )
    };
    let rate = |of: VariableKind| {
        let of = layout.reference(of).unwrap_or(0);
        format!(" causality=\"local\" variability=\"continuous\" initial=\"calculated\" derivative=\"{of}\"")
    };
    let (element, attributes) = match of.kind {
        VariableKind::Time => ("Float64", " causality=\"independent\" variability=\"continuous\"".to_owned()),
        VariableKind::Tolerance => ("Float64", fixed(TOLERANCE)),
        VariableKind::MaxStep => ("Float64", fixed(defaults.max_step)),
        VariableKind::Parameter(index) => ("Float64", fixed(parameters[index])),
        VariableKind::Mu(contact) => ("Float64", fixed(surface(contact).map_or(0.0, |own| own.mu))),
        VariableKind::Restitution(contact) => ("Float64", fixed(surface(contact).map_or(0.0, |own| own.e))),
        VariableKind::Law(contact) => {
            let law = surface(contact).and_then(|own| Law::ALL.iter().position(|law| *law == own.law));
            let start = law.unwrap_or(0) + 1;
            (
                "Enumeration",
                format!(
                    " declaredType=\"Law\" causality=\"parameter\" variability=\"fixed\" initial=\"exact\" start=\"{start}\""
                ),
            )
        }
        VariableKind::Input(index) => (
            "Float64",
            format!(" causality=\"input\" variability=\"continuous\" start=\"{}\"", number(inputs[index])),
        ),
        VariableKind::Coordinate(index) => {
            let initial = if is_dependent(mechanism, index) { "approx" } else { "exact" };
            ("Float64", state(coordinates[index], initial))
        }
        VariableKind::Speed(index) => ("Float64", state(speeds[index], "exact")),
        VariableKind::CoordinateRate(index) => ("Float64", rate(VariableKind::Coordinate(index))),
        VariableKind::SpeedRate(index) => ("Float64", rate(VariableKind::Speed(index))),
        VariableKind::DependentSpeed(_)
        | VariableKind::Position(..)
        | VariableKind::Gap(_)
        | VariableKind::Force(..)
        | VariableKind::KineticEnergy
        | VariableKind::PotentialEnergy => ("Float64", computed),
        VariableKind::Phase(_) => (
            "Enumeration",
            " declaredType=\"Phase\" causality=\"output\" variability=\"discrete\" initial=\"calculated\""
                .to_owned(),
        ),
        VariableKind::Events => {
            ("Int64", " causality=\"output\" variability=\"discrete\" initial=\"calculated\"".to_owned())
        }
        VariableKind::Indicator(_) => {
            ("Float64", " causality=\"local\" variability=\"continuous\" initial=\"calculated\"".to_owned())
        }
    };
    let unit = if element == "Float64" && has_unit(&of.unit) {
        format!(" unit=\"{}\"", escaped(&of.unit))
    } else {
        String::new()
    };
    let _ = writeln!(
        out,
        "    <{element} name=\"{}\" valueReference=\"{reference}\" description=\"{}\"{attributes}{unit}/>",
        escaped(&of.name),
        escaped(&of.docs)
    );
}

/// A double in the notation of XML Schema, which reads back as the same double.
fn number(value: f64) -> String {
    if value == f64::INFINITY { "INF".to_owned() } else { format!("{value:?}") }
}

/// Whether a coordinate is dependent.
fn is_dependent(mechanism: &dyn Contacts<f64>, index: usize) -> bool {
    let count = mechanism.count(ComponentKind::DependentCoordinate);
    (0..count).any(|place| mechanism.dependent_coordinate(place) == Some(index))
}

/// The model structure: outputs, derivatives, unknowns of the initialization, and event indicators.
fn structure(layout: &Layout, mechanism: &dyn Contacts<f64>, out: &mut String) {
    let is_computed = |what: VariableKind| {
        matches!(
            what,
            VariableKind::DependentSpeed(_)
                | VariableKind::Position(..)
                | VariableKind::Gap(_)
                | VariableKind::Force(..)
                | VariableKind::Phase(_)
                | VariableKind::KineticEnergy
                | VariableKind::PotentialEnergy
                | VariableKind::Events
        )
    };
    let is_state = |what: VariableKind| matches!(what, VariableKind::Coordinate(_) | VariableKind::Speed(_));
    let is_rate =
        |what: VariableKind| matches!(what, VariableKind::CoordinateRate(_) | VariableKind::SpeedRate(_));
    let is_guess = |what: VariableKind| matches!(what, VariableKind::Coordinate(index) if is_dependent(mechanism, index));
    out.push_str("  <ModelStructure>\n");
    let mut list = |element: &str, wanted: &dyn Fn(VariableKind) -> bool| {
        for (reference, variable) in layout.variables.iter().enumerate() {
            if wanted(variable.kind) {
                let _ = writeln!(out, "    <{element} valueReference=\"{reference}\"/>");
            }
        }
    };
    list("Output", &|what| is_computed(what) || is_state(what));
    list("ContinuousStateDerivative", &is_rate);
    list("InitialUnknown", &|what| is_computed(what) || is_rate(what) || is_guess(what));
    list("EventIndicator", &|what| matches!(what, VariableKind::Indicator(_)));
    out.push_str("  </ModelStructure>\n");
}
