//! Uses of parts: whether they can be, and what they give.

use std::collections::BTreeMap;

use super::count::{Numbers, evaluate};
use super::instances::{Instance, Instances, MOST_INSTANCES, Member, dotted, joined, own_quantities};
use super::outline::{ArgumentKind, Part, Use};
use crate::diagnostics::{Diagnostic, Place as Change, codes};
use crate::span::Span;
use crate::suggest;

impl<'a> Instances<'a, '_> {
    /// Adds the instance that a use makes.
    pub fn instance(&mut self, parent: usize, used: &'a Use, numbers: &Numbers, depth: usize) {
        let file = self.file(parent);
        let Some(part) = self.catalogue.find(file, &used.part.text) else {
            if self.catalogue.incomplete {
                return;
            }
            let names = self.catalogue.names(file);
            let message = format!("there is no part `{}`", used.part.text);
            let error = Diagnostic::new(codes::PART_UNKNOWN, used.part.span, message);
            let error = match suggest::nearest(&used.part.text, names.iter().copied()) {
                Some(near) => error.did_you_mean(near),
                None if names.is_empty() => error.help("state it, `part Leg(..) { .. }`, or import its file"),
                None => error.help(format!("the parts known here are {}", names.join(", "))),
            };
            self.report_once(parent, error);
            return;
        };
        if self.contains_itself(parent, part, used) {
            return;
        }
        self.turns += 1;
        if self.turns > MOST_INSTANCES {
            let message = format!("a mechanism has at most {MOST_INSTANCES} instances of parts");
            let help = "parts that use others twice or more double with each level";
            self.report(parent, codes::REPETITION, used.span, message, help);
            self.full = true;
            return;
        }
        let Some(indices) = self.indices(parent, &used.name, &used.indices, numbers) else { return };
        if !self.is_index(parent, &used.name, &indices) {
            return;
        }
        self.free(parent, &used.name, &indices, &[]);
        let declared = self.catalogue.parts[part].part;
        let place = self.places.within(used.span, self.list[parent].site);
        let site = self.places.add_site(declared.name.text.clone(), place);
        let text = joined(&self.list[parent].text, &used.name.text, &indices);
        let shown = dotted(&self.list[parent].shown, &used.name.text, &indices);
        let instance = self.list.len();
        self.list.push(Instance {
            part: Some(part),
            parent,
            used: Some(used),
            site: Some(site),
            text,
            shown,
            numbers: Numbers::new(),
            outer: numbers.clone(),
            members: BTreeMap::new(),
        });
        let member = Member::Instance(instance, used.name.span);
        self.list[parent].members.entry((used.name.text.clone(), indices)).or_insert(member);
        let counts = self.counts(parent, declared, used, numbers);
        let complete = self.arguments(parent, part, used);
        let (Some(counts), true) = (counts, complete) else { return };
        self.list[instance].numbers.clone_from(&counts);
        self.block(instance, &declared.block, counts, Some(declared.name.span), depth + 1);
    }

    /// Whether a part would contain itself; says so.
    fn contains_itself(&mut self, parent: usize, part: usize, used: &Use) -> bool {
        let mut next = parent;
        while let Some(other) = self.list[next].part {
            if other == part {
                let message = format!("the part `{}` contains itself", used.part.text);
                let error = Diagnostic::new(codes::PART_CYCLE, used.span, message);
                let help = "a part is made of other parts; what is repeated is stated by `for`";
                self.report_once(parent, error.help(help));
                return true;
            }
            next = self.list[next].parent;
        }
        false
    }

    /// The counts that a use gives.
    fn counts(&mut self, parent: usize, part: &Part, used: &Use, numbers: &Numbers) -> Option<Numbers> {
        let (mut counts, mut complete) = (Numbers::new(), true);
        for argument in &part.arguments {
            let ArgumentKind::Count { default } = &argument.kind else { continue };
            let actual = used.actuals.iter().find(|actual| actual.name.text == argument.name.text);
            let value = match (actual, default) {
                (Some(actual), _) => self.number(parent, &actual.tokens, numbers, actual.span()),
                (None, Some(default)) => match evaluate(default, &counts, argument.name.span) {
                    Ok(value) => Some(value),
                    Err(error) => {
                        self.report_once(parent, *error);
                        None
                    }
                },
                // it is missing, which is said elsewhere
                (None, None) => None,
            };
            match value {
                Some(value) => counts.push((argument.name.text.clone(), value)),
                None => complete = false,
            }
        }
        complete.then_some(counts)
    }

    /// Whether a use gives what its part needs and nothing else; says so where it does not.
    fn arguments(&mut self, parent: usize, part: usize, used: &'a Use) -> bool {
        let declared = self.catalogue.parts[part].part;
        let template = self.template(&declared.block, Some(declared.name.span), Some(part));
        let quantities: Vec<String> = own_quantities(&template).map(str::to_owned).collect();
        let known = || {
            declared
                .arguments
                .iter()
                .map(|argument| argument.name.text.as_str())
                .chain(quantities.iter().map(String::as_str))
        };
        let mut complete = true;
        for (i, actual) in used.actuals.iter().enumerate() {
            let name = &actual.name;
            if let Some(first) = used.actuals[..i].iter().find(|first| first.name.text == name.text) {
                let message = format!("the argument `{}` is given twice", name.text);
                let error = Diagnostic::new(codes::ARGUMENT_UNKNOWN, name.span, message);
                self.report_once(parent, error.related(first.name.span, "first here").help("remove one"));
                complete = false;
            } else if !known().any(|known| known == name.text) {
                let message = format!("the part `{}` has no argument `{}`", declared.name.text, name.text);
                let error = Diagnostic::new(codes::ARGUMENT_UNKNOWN, name.span, message)
                    .related(declared.name.span, format!("`{}` is declared here", declared.name.text));
                let all: Vec<String> = known().map(|name| format!("`{name}`")).collect();
                let error = match suggest::nearest(&name.text, known()) {
                    Some(near) => error.did_you_mean(near),
                    None if all.is_empty() => error.help("it takes no arguments"),
                    None => error.help(format!("its arguments and own quantities are {}", all.join(", "))),
                };
                self.report_once(parent, error);
                complete = false;
            }
        }
        let given = |name: &str| used.actuals.iter().any(|actual| actual.name.text == name);
        let missing: Vec<_> = declared
            .arguments
            .iter()
            .filter(|argument| argument.kind.is_required() && !given(&argument.name.text))
            .collect();
        if !missing.is_empty() {
            let names: Vec<String> = missing
                .iter()
                .map(|argument| format!("`{}`, {}", argument.name.text, argument.kind.describe()))
                .collect();
            let message = format!("this use of `{}` lacks {}", declared.name.text, names.join("; "));
            let mut error = Diagnostic::new(codes::ARGUMENT_MISSING, used.span, message);
            for argument in missing.iter().take(5) {
                error =
                    error.related(argument.name.span, format!("`{}` is declared here", argument.name.text));
            }
            let placeholders: Option<Vec<String>> = missing
                .iter()
                .map(|argument| Some(format!("{}: {}", argument.name.text, argument.kind.placeholder()?)))
                .collect();
            if let Some(placeholders) = placeholders {
                let (name, after) = (used.name.span, Span { start: used.span.end, end: used.span.end });
                let text = placeholders.join(", ");
                error = match used.actuals.is_empty() && !used.has_brackets {
                    true => error.fix(Change::Replace(after), format!("({text})")),
                    false => error.fix(Change::IntoBraces(name), text),
                };
            }
            self.report_once(parent, error);
            complete = false;
        }
        complete
    }
}
