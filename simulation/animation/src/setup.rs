//! Writes what a motion is the motion of: surfaces, parameters, initial values, and the text of the model.

use hodograph::Surface;
use hodograph_model::model::mechanism::{Mechanism, Variable};
use hodograph_model::numeric::State;
use hodograph_model::page::escaped;

use crate::number::number;

/// What was simulated.
#[derive(Clone, Debug, Default)]
pub struct Setup {
    /// contacts with their surfaces: name, mu, e, law
    pub surfaces: Vec<(String, f64, f64, String)>,
    /// the parameters as used
    pub parameters: Vec<Value>,
    /// coordinates and speeds at the start
    pub start: Vec<Value>,
    /// the text of the model
    pub model: String,
}

/// A quantity of the model.
#[derive(Clone, Debug)]
pub struct Value {
    /// as in the model
    pub name: String,
    /// in its unit
    pub value: f64,
    /// may be empty
    pub unit: String,
    /// what the model says of it
    pub docs: String,
}

impl Setup {
    /// Of a motion of a model from a state, on these surfaces of contacts by number; `text` is that of the model.
    pub fn of(model: &Mechanism, state: &State, surfaces: &[(usize, Surface<f64>)], text: String) -> Self {
        let value = |(quantity, &value): (&Variable, &f64)| Value {
            name: quantity.name.clone(),
            value,
            unit: if quantity.unit == "1" { String::new() } else { quantity.unit.clone() },
            docs: quantity.docs.trim().to_owned(),
        };
        let of_contact = |(contact, surface): &(usize, Surface<f64>)| {
            let name = model.contacts.get(*contact).map_or(String::new(), |contact| contact.name.clone());
            (name, surface.mu, surface.e, surface.law.name().to_owned())
        };
        let coordinates = model.coordinates.iter().zip(&state.coordinates);
        Setup {
            surfaces: surfaces.iter().map(of_contact).collect(),
            parameters: model.parameters.iter().zip(&state.parameters).map(value).collect(),
            start: coordinates.chain(model.speeds.iter().zip(&state.speeds)).map(value).collect(),
            model: text,
        }
    }

    /// The surfaces in a line, as a paragraph of a page.
    pub fn line(&self) -> String {
        let of = |(name, mu, e, law): &(String, f64, f64, String)| {
            format!("{name}: \u{3bc} = {}, e = {}, {law}", number(*mu), number(*e))
        };
        match &self.surfaces[..] {
            [] => String::new(),
            surfaces => {
                let all: Vec<String> = surfaces.iter().map(of).collect();
                format!("<p class=\"help\">{}</p>\n", escaped(&all.join("; ")))
            }
        }
    }

    /// The tables and the text, as a section of a page.
    pub fn html(&self) -> String {
        let mut out = String::new();
        if !self.surfaces.is_empty() {
            let rows = self.surfaces.iter().map(|(name, mu, e, law)| {
                format!(
                    "<tr><td>{}</td><td class=\"value\">{}</td><td class=\"value\">{}</td><td>{}</td></tr>\n",
                    escaped(name),
                    number(*mu),
                    number(*e),
                    escaped(law)
                )
            });
            out += &table("Surfaces", ["contact", "friction \u{3bc}", "restitution e", "law"], rows);
        }
        for (caption, values) in [("Parameters", &self.parameters), ("Start", &self.start)] {
            if !values.is_empty() {
                let heads = ["name", "value", "unit", "meaning"];
                out += &table(caption, heads, values.iter().map(Value::row));
            }
        }
        if !self.model.is_empty() {
            let model: Vec<String> = self.model.lines().map(escaped).collect();
            let model = model.join("\n");
            out += &format!("<h2>Model</h2>\n<pre tabindex=\"0\">{model}</pre>\n");
        }
        match out.is_empty() {
            true => out,
            false => format!(
                "<details id=\"setup\"><summary>Model, parameters and surfaces</summary>\n{out}</details>\n"
            ),
        }
    }
}

fn table(caption: &str, heads: [&str; 4], rows: impl Iterator<Item = String>) -> String {
    let heads = heads.map(|head| format!("<th scope=\"col\">{head}</th>")).concat();
    let rows: String = rows.collect();
    format!(
        "<div class=\"scroll\"><table><caption>{caption}</caption><thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
    )
}

impl Value {
    fn row(&self) -> String {
        let [name, unit, docs] = [&self.name, &self.unit, &self.docs].map(|text| escaped(text));
        let value = number(self.value);
        format!("<tr><td>{name}</td><td class=\"value\">{value}</td><td>{unit}</td><td>{docs}</td></tr>\n")
    }
}
