//! Emits the body of a routine (statements, checks, result) and its arguments.

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::quote;

use super::Emitter;
use super::interface::{self, Argument, Type};
use super::lanes::{self, Lanes};
use super::values::local;
use hodograph_program::program::Guard;
use hodograph_program::program::Quantity;
use hodograph_program::program::graph::Input;
use hodograph_program::program::operation::{Operation, Stage, Value};
use hodograph_program::program::quantity::Takes;

/// A method that computes quantities and returns an expression of their values.
pub struct Routine {
    /// its name in the module
    pub name: String,
    /// its documentation
    pub docs: String,
    /// the quantities that it computes
    pub quantities: Vec<Quantity>,
    /// the type of its result
    pub answer: Type,
    /// its result, an expression of the local variables of the values
    pub value: TokenStream,
}

impl Emitter<'_> {
    /// The statements that compute quantities and check them; their values are then local variables.
    pub fn compute(&self, quantities: &[Quantity]) -> TokenStream {
        let (statements, wrong) = self.computed(quantities);
        let check = self.unless_finite(wrong);
        quote! { #statements #check }
    }

    /// The statement that fails where a result is not finite.
    pub fn unless_finite(&self, wrong: Option<TokenStream>) -> Option<TokenStream> {
        let krate = self.krate;
        wrong.map(|wrong| {
            quote! {
                if #wrong {
                    return ::core::result::Result::Err(#krate::StateError::NotFinite.into());
                }
            }
        })
    }

    /// The statements that compute quantities and check guards, and the expression for whether a result is
    /// not finite.
    pub fn computed(&self, quantities: &[Quantity]) -> (TokenStream, Option<TokenStream>) {
        let slice = self.program.slice(quantities);
        let needed = self.needed(
            &slice.outputs.iter().flat_map(|output| output.values.clone()).collect::<Vec<_>>(),
            &slice.guards,
        );
        let order: Vec<Value> = slice.order.iter().copied().filter(|value| needed.contains(value)).collect();
        let order = self.program.with_few_live(&order, |value| !self.is_work(value));
        let guards = slice
            .guards
            .iter()
            .filter(|guard| self.guard_stage(guard) > Stage::Parameter)
            .map(|guard| self.guard(guard));
        let results: BTreeSet<Value> =
            slice.outputs.iter().flat_map(|output| output.values.iter().copied()).collect();
        let late = slice.guards.iter().filter(|guard| self.guard_stage(guard) > Stage::Parameter);
        let checked = late.flat_map(|guard| [Some(guard.value), guard.scale]).flatten();
        let looked_at: BTreeSet<Value> = checked.collect();
        let wanted: BTreeSet<Value> = results.union(&looked_at).copied().collect();
        let solved = slice.outputs.iter().find(|output| output.quantity.is_solved_by_columns());
        let lanes: Vec<Lanes> = solved.map_or_else(Vec::new, |solved| {
            let others = slice.outputs.iter().filter(|output| output.quantity != solved.quantity);
            let others = others.flat_map(|output| output.values.iter().copied());
            self.lanes(solved, &order, &looked_at.iter().copied().chain(others).collect())
        });
        let in_lanes: BTreeSet<Value> = lanes.iter().flat_map(Lanes::computed).collect();
        let order: Vec<Value> = order.into_iter().filter(|value| !in_lanes.contains(value)).collect();
        let statements = self.statements(&order, &wanted, &lanes::storage(&lanes));
        let loops = lanes::loops(&lanes, self);
        let wrong = self.not_finite(&results, &lanes);
        let fetch = lanes.iter().zip(0..).map(|(lanes, number)| lanes.fetch(number));
        // Results of loops are loaded last: loaded before the checks, they would be spilled.
        (quote! { #statements #loops #(#guards)* #(#fetch)* }, wrong)
    }

    /// The values that a method computes; values that depend on parameters alone are only loaded.
    pub fn needed(&self, results: &[Value], guards: &[&Guard]) -> BTreeSet<Value> {
        let mut needed = BTreeSet::new();
        let mut stack: Vec<Value> = results.to_vec();
        for guard in guards.iter().filter(|guard| self.guard_stage(guard) > Stage::Parameter) {
            stack.push(guard.value);
            stack.extend(guard.scale);
        }
        while let Some(value) = stack.pop() {
            if needed.insert(value) && self.stage(value) > Stage::Parameter {
                stack.extend(self.program.operation(value).operands());
            }
        }
        needed
    }

    /// The statement that checks a value that must not vanish.
    pub fn guard(&self, guard: &Guard) -> TokenStream {
        let krate = self.krate;
        let value = local(guard.value);
        let message = &guard.message;
        match guard.scale {
            Some(scale) => {
                let scale = local(scale);
                quote! {
                    if #krate::generated::vanishes_beside(#value, #scale) {
                        return ::core::result::Result::Err(#krate::generated::singular(#value, #scale, #message).into());
                    }
                }
            }
            None => quote! {
                if #krate::generated::vanishes(#value) {
                    return ::core::result::Result::Err(#krate::generated::singular(#value, #value, #message).into());
                }
            },
        }
    }

    /// The arguments of a routine for these quantities after `&self`.
    pub fn arguments(&self, quantities: &[Quantity]) -> Arguments {
        let takes =
            |of: fn(&Takes) -> bool| quantities.iter().any(|quantity| of(&quantity.description().takes));
        let velocity = quantities.iter().any(|&quantity| self.takes_speeds(quantity));
        Arguments {
            time: self.uses_time,
            coordinates: !self.coordinates.is_empty(),
            speeds: velocity,
            accelerations: takes(|takes| takes.accelerations),
            inputs: !self.inputs.is_empty() && (takes(|takes| takes.loads) || self.kinematic_inputs),
            tangent: takes(|takes| takes.tangent),
        }
    }

    /// Whether the quantity depends on speeds, by definition or in this program.
    fn takes_speeds(&self, quantity: Quantity) -> bool {
        quantity.description().takes.speeds || self.uses(quantity, |input| matches!(input, Input::Speed(_)))
    }

    fn uses(&self, quantity: Quantity, which: impl Fn(Input) -> bool) -> bool {
        let slice = self.program.slice(&[quantity]);
        slice
            .order
            .iter()
            .any(|&value| matches!(self.program.operation(value), Operation::Input(input) if which(input)))
    }

    /// The arguments in their order, with their types.
    pub fn declared(&self, arguments: Arguments) -> Vec<Argument> {
        let Arguments { time, coordinates, speeds, accelerations, inputs, tangent } = arguments;
        let all = [
            (time, "time", Type::Number),
            (coordinates, "q", Type::of_struct("Coordinates")),
            (speeds, "u", Type::of_struct("Speeds")),
            (accelerations, "acceleration", Type::of_struct("Speeds")),
            (inputs, "inputs", Type::of_struct("Inputs")),
            (tangent, "tangent", self.tangent_type()),
        ];
        all.into_iter().filter(|(taken, ..)| *taken).map(|(_, name, of)| Argument { name, of }).collect()
    }

    /// The arguments of a private function.
    pub fn signature(&self, arguments: Arguments) -> TokenStream {
        let declared = interface::declared(&self.declared(arguments), self.krate);
        quote!(&self, #declared)
    }

    /// The same arguments, passed on to another routine.
    pub fn passed(&self, arguments: Arguments) -> TokenStream {
        let time = arguments.time.then(|| quote!(time,));
        let coordinates = arguments.coordinates.then(|| quote!(q,));
        let speeds = arguments.speeds.then(|| quote!(u,));
        let accelerations = arguments.accelerations.then(|| quote!(acceleration,));
        let inputs = arguments.inputs.then(|| quote!(inputs,));
        quote!(#time #coordinates #speeds #accelerations #inputs)
    }
}

/// The arguments of a routine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arguments {
    /// time
    pub time: bool,
    /// coordinates
    pub coordinates: bool,
    /// independent speeds
    pub speeds: bool,
    /// derivatives of the independent speeds
    pub accelerations: bool,
    /// named inputs
    pub inputs: bool,
    /// direction of a linearisation
    pub tangent: bool,
}
