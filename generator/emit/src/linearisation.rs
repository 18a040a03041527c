//! Emits the derivatives of accelerations and inverse dynamics as matrices, and the linearised equations x' =
//! A x + B w.

use std::ops::Range;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Emitter;
use super::interface::{Failure, Field, InPlace, Method, Signature, Struct, Type};
use super::routine::Arguments;
use super::values::local;
use hodograph_program::program::{Output, Quantity};

impl Emitter<'_> {
    /// Number of states and of named inputs.
    fn linear_sizes(&self) -> (usize, usize) {
        (self.mechanism.independent_states(), self.mechanism.inputs.len())
    }

    /// The type of a direction: states, then inputs.
    pub fn tangent_type(&self) -> Type {
        let (states, inputs) = self.linear_sizes();
        Type::Array(Box::new(Type::Number), states + inputs)
    }

    /// The struct of the two matrices; `None` if the program has no directional derivative.
    pub fn linearisation_record(&self) -> Option<Struct> {
        self.program.output(Quantity::StateTangent)?;
        let (states, inputs) = self.linear_sizes();
        let names = |dependent: bool| {
            let all = self.mechanism.coordinates.iter().chain(&self.mechanism.speeds);
            let names: Vec<_> =
                all.filter(|q| q.dependent == dependent).map(|q| format!("`{}`", q.name)).collect();
            names.join(", ")
        };
        let docs = format!(
            "Equations linearised about a state: x' = A x + B w for small deviations of the states {} (in this order){}.",
            names(false),
            if inputs == 0 { "" } else { " and of the named inputs w" },
        );
        let fields = vec![
            Field::new(
                "a",
                Type::of_shape(states, states),
                "A: derivatives of the rates of the states (rows) with respect to the states (columns)",
            ),
            Field::new(
                "b",
                Type::of_shape(states, inputs),
                "B: derivatives of the rates of the states (rows) with respect to the named inputs (columns)",
            ),
        ];
        Some(Struct::of_results("Linearisation", &docs, fields))
    }

    /// The struct of a value and its derivatives; `None` if the program has none.
    pub fn derivatives_record(&self) -> Option<Struct> {
        let of = [Quantity::AccelerationsDerivatives, Quantity::InverseDynamicsDerivatives];
        of.iter().find(|&&quantity| self.program.output(quantity).is_some())?;
        let (states, inputs) = self.linear_sizes();
        let rows = self.speeds.len();
        let by = |name: &str, columns: usize, what: &str| {
            let docs = format!("derivatives with respect to the {what} (columns, in their order)");
            Field::new(name, Type::of_shape(rows, columns), &docs)
        };
        let fields = vec![
            Field::new("value", Type::Vector(rows), "the quantity itself"),
            by("by_coordinates", states - rows, "independent coordinates"),
            by("by_speeds", rows, "independent speeds"),
            by("by_inputs", inputs, "named inputs"),
        ];
        let docs = "Accelerations or generalised forces with their derivatives. Rows: independent speeds.";
        Some(Struct::of_results("Derivatives", docs, fields))
    }

    /// The type and the expression of a value with its derivatives.
    pub fn value_and_derivatives(&self, output: &Output) -> (Type, TokenStream) {
        let (states, inputs) = self.linear_sizes();
        let coordinates = 1 + states - self.speeds.len();
        let [(_, value), (_, by_coordinates), (_, by_speeds), (_, by_inputs)] =
            [0..1, 1..coordinates, coordinates..1 + states, 1 + states..1 + states + inputs]
                .map(|columns| self.block(output, columns));
        let fields = quote! {
            value: #value, by_coordinates: #by_coordinates, by_speeds: #by_speeds, by_inputs: #by_inputs
        };
        (Type::of_struct("Derivatives"), quote!(Derivatives { #fields }))
    }

    /// The method `linearise`; `None` if the program has no directional derivative.
    pub fn linearise(&self) -> Option<Method> {
        self.program.output(Quantity::StateTangent)?;
        let mut arguments = self.arguments(&[Quantity::StateTangent]);
        arguments.tangent = false;
        let body = match self.program.output(Quantity::AccelerationsDerivatives) {
            Some(_) => self.by_derivatives(arguments),
            None => self.by_tangents(arguments),
        };
        let docs = "The equations linearised about a state, by exact differentiation. Dependent coordinates and \
                    speeds follow the independent ones; parameters and time are constant.";
        let signature = Signature {
            name: "linearise".to_owned(),
            docs: docs.to_owned(),
            arguments: self.declared(arguments),
            answer: Type::of_struct("Linearisation"),
            failure: Failure::State,
            in_place: Some(InPlace::of("linearise")),
        };
        let body = quote! {
            #body
            put(Linearisation { a, b })
        };
        Some(Method { signature, attributes: TokenStream::new(), body })
    }

    /// The rows of coordinates are the derivatives of their rates, the rows of speeds those of the
    /// accelerations.
    fn by_derivatives(&self, arguments: Arguments) -> TokenStream {
        let krate = self.krate;
        let (states, inputs) = self.linear_sizes();
        let coordinates = states - self.speeds.len();
        let passed = self.passed(arguments);
        let rates = self.program.output(Quantity::RatesDerivatives);
        let compute = rates.map(|_| self.compute(&[Quantity::RatesDerivatives]));
        let entry = |row: usize, column: usize| {
            let Some(row) = row.checked_sub(coordinates).map(Literal::usize_unsuffixed) else {
                let value = rates.and_then(|output| output.values.get(row * output.columns + column));
                let value = value.map(|&value| local(value));
                return quote!(#value);
            };
            let (block, first) = match column {
                column if column < coordinates => (quote!(by_coordinates), 0),
                column if column < states => (quote!(by_speeds), coordinates),
                _ => (quote!(by_inputs), states),
            };
            let column = Literal::usize_unsuffixed(column - first);
            quote!(#block[#column][#row])
        };
        let matrix = |columns: Range<usize>| {
            if columns.is_empty() {
                return quote!(#krate::nalgebra::SMatrix::zeros());
            }
            let columns = columns.map(|column| {
                let entries = (0..states).map(|row| entry(row, column));
                quote!([#(#entries),*])
            });
            quote!(#krate::nalgebra::SMatrix::from([#(#columns),*]))
        };
        let (a, b) = (matrix(0..states), matrix(states..states + inputs));
        quote! {
            #compute
            let of_speeds = self.accelerations_derivatives(#passed);
            // By reference: a matrix is copied when it is moved out of a result.
            let of_speeds = match &of_speeds {
                ::core::result::Result::Ok(of_speeds) => of_speeds,
                ::core::result::Result::Err(error) => return ::core::result::Result::Err(*error),
            };
            let (by_coordinates, by_speeds, by_inputs) =
                (&of_speeds.by_coordinates.data.0, &of_speeds.by_speeds.data.0, &of_speeds.by_inputs.data.0);
            let (a, b) = (#a, #b);
        }
    }

    /// One column at a time, for programs in which all derivatives at once would be too long.
    fn by_tangents(&self, arguments: Arguments) -> TokenStream {
        let krate = self.krate;
        let (states, inputs) = self.linear_sizes();
        let (n, m) = (Literal::usize_unsuffixed(states), Literal::usize_unsuffixed(inputs));
        let size = Literal::usize_unsuffixed(states + inputs);
        let passed = self.passed(arguments);
        quote! {
            let mut a = #krate::nalgebra::SMatrix::<T, #n, #n>::zeros();
            let mut b = #krate::nalgebra::SMatrix::<T, #n, #m>::zeros();
            for (number, mut column) in a.column_iter_mut().chain(b.column_iter_mut()).enumerate() {
                let mut tangent = [T::zero(); #size];
                if let Some(entry) = tangent.get_mut(number) {
                    *entry = T::one();
                }
                column.copy_from(&self.state_tangent(#passed &tangent)?);
            }
        }
    }
}
