//! Emits a method for each quantity of the mechanism, its points and its frames, with its documentation.

use std::ops::Range;

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::Emitter;
use super::interface::{Failure, Group, InPlace, Method, Signature, Type};
use super::record::Record;
use super::routine::Routine;
use super::values::local;
use crate::prose::prose;
use hodograph_model::rust_names::snake_case;
use hodograph_program::program::quantity::Entries;
use hodograph_program::program::{ContactQuantity, Output, Quantity};

impl Emitter<'_> {
    /// All methods that do not belong to a contact.
    pub fn methods(&self) -> Group {
        let routines = self.routines();
        let methods = routines.iter().map(|routine| self.routine(routine));
        Group { methods: methods.chain(self.linearise()).collect(), in_lanes: true, ..Group::default() }
    }

    /// The routines that do not belong to a contact.
    pub fn routines(&self) -> Vec<Routine> {
        let described = |output: &Output| {
            if matches!(output.quantity, Quantity::Contact(..)) {
                return None;
            }
            let (name, docs) = self.describe(output.quantity).filter(|_| !output.values.is_empty())?;
            let (answer, value) = self.shaped(output);
            Some(Routine { name, docs, quantities: vec![output.quantity], answer, value })
        };
        let described = self.program.outputs.iter().filter_map(described);
        described.chain(self.all_accelerations()).chain(self.mass_matrix_lower()).collect()
    }

    /// One triangle of the mass matrix.
    fn mass_matrix_lower(&self) -> Option<Routine> {
        let output = self.program.output(Quantity::MassMatrix).filter(|output| output.rows > 1)?;
        let lower =
            (0..output.rows).flat_map(|row| (0..=row).map(move |column| row * output.columns + column));
        let values = lower.map(|place| output.values.get(place).map(|&value| local(value)));
        let values = values.collect::<Option<Vec<_>>>()?;
        Some(Routine {
            name: "mass_matrix_lower".to_string(),
            docs: "The lower triangle of the mass matrix, row by row: entry (i, j) with j <= i stands at i (i + 1) / 2 + j. LAPACK calls this layout the packed upper triangle. \
                   The values are those of `mass_matrix`, with fewer numbers to store."
                .to_string(),
            quantities: vec![output.quantity],
            answer: Type::Array(Box::new(Type::Number), values.len()),
            value: quote!([#(#values),*]),
        })
    }

    /// Rates of independent and dependent speeds at once: the second follow from the first.
    fn all_accelerations(&self) -> Option<Routine> {
        let output = |quantity| self.program.output(quantity).filter(|output| !output.values.is_empty());
        let own = output(Quantity::Accelerations)?;
        let dependent = output(Quantity::DependentAccelerations)?;
        let [(of_own, own_value), (of_dependent, dependent_value)] =
            [own, dependent].map(|output| self.shaped(output));
        Some(Routine {
            name: "all_accelerations".to_string(),
            docs: "Rates of the independent and of the dependent speeds without contact forces in one call: those of `accelerations` and `dependent_accelerations`."
                .to_string(),
            quantities: vec![own.quantity, dependent.quantity],
            answer: Type::Pair(Box::new(of_own), Box::new(of_dependent)),
            value: quote!((#own_value, #dependent_value)),
        })
    }

    /// The method of a routine.
    pub fn routine(&self, routine: &Routine) -> Method {
        let Routine { name, docs, quantities, answer: of_answer, value } = routine;
        let signature = Signature {
            name: name.clone(),
            docs: docs.clone(),
            arguments: self.declared(self.arguments(quantities)),
            answer: of_answer.clone(),
            failure: Failure::State,
            in_place: self.in_place(name, quantities),
        };
        let body = match signature.in_place {
            Some(_) => self.compute_and_put(quantities, value),
            None => {
                let compute = self.compute(quantities);
                quote!(#compute ::core::result::Result::Ok(#value))
            }
        };
        Method { signature, attributes: quote!(#[inline]), body }
    }

    /// The body of a method in place: it computes the quantities and hands their value to `put`.
    pub fn compute_and_put(&self, quantities: &[Quantity], value: &TokenStream) -> TokenStream {
        let krate = self.krate;
        match self.computed(quantities) {
            (statements, Some(wrong)) if self.is_stored_first(quantities) => quote! {
                #statements
                let mut answer = put(#value);
                if #wrong {
                    answer = ::core::result::Result::Err(#krate::StateError::NotFinite);
                }
                answer
            },
            (statements, wrong) => {
                let check = self.unless_finite(wrong);
                quote!(#statements #check put(#value))
            }
        }
    }

    /// The methods in place of a routine: it has them where the size of the answer depends on the mechanism,
    /// unless the name is that of another method (beside a point `P` there may be a point `P_into`).
    pub fn in_place(&self, routine: &str, quantities: &[Quantity]) -> Option<InPlace> {
        let grows = |quantity: &Quantity| quantity.description().grows();
        let m = self.mechanism;
        let names = m.points.iter().map(|point| &point.name).chain(m.contacts.iter().map(|of| &of.name));
        let is_taken = names.map(|name| snake_case(name)).any(|name| {
            name.strip_suffix("_into").is_some_and(|name| routine.ends_with(&format!("_{name}")))
        });
        (quantities.iter().any(grows) && !is_taken).then(|| InPlace::of(routine))
    }

    /// Whether the result of a routine is stored before it is checked, so that each number is stored once,
    /// where the caller needs it. Short results stay in registers until they are checked.
    pub fn is_stored_first(&self, quantities: &[Quantity]) -> bool {
        /// more than the number of registers
        const MANY: usize = 16;
        let outputs = quantities.iter().filter_map(|&quantity| self.program.output(quantity));
        let count: usize = outputs.map(|output| output.values.len()).sum();
        // `Contacts` mostly writes the response into a slice.
        let written =
            |quantity: &Quantity| matches!(quantity, Quantity::Contact(_, ContactQuantity::Response));
        count > MANY && !quantities.iter().all(written)
    }

    /// The type and the expression of an output.
    pub fn shaped(&self, output: &Output) -> (Type, TokenStream) {
        let values: Vec<TokenStream> =
            output.values.iter().map(|&value| local(value)).map(|value| quote!(#value)).collect();
        let record =
            |record: &Record| (Type::of_struct(&record.name().to_string()), record.construct(&values));
        let entries = output.quantity.description().entries;
        match self.record_of(output.quantity).filter(|record| record.len() == values.len()) {
            Some(of) => record(of),
            None if entries == Entries::ValueAndDerivatives => self.value_and_derivatives(output),
            None if values.len() == 1 && entries == Entries::Scalar => (Type::Number, quote!(#(#values)*)),
            None => self.matrix(output),
        }
    }

    /// The record with the fields of a quantity, if it has one.
    pub fn record_of(&self, quantity: Quantity) -> Option<&Record> {
        match quantity.description().entries {
            Entries::RatesOfCoordinates => Some(&self.coordinates),
            Entries::RatesOfSpeeds => Some(&self.speeds),
            Entries::DependentSpeeds | Entries::RatesOfDependentSpeeds => Some(&self.dependent),
            Entries::Scalar
            | Entries::Numbers
            | Entries::Symmetric
            | Entries::ValueAndDerivatives
            | Entries::Lists => None,
        }
    }

    /// An output as a matrix of static size.
    pub fn matrix(&self, output: &Output) -> (Type, TokenStream) {
        self.block(output, 0..output.columns)
    }

    /// Some columns of an output.
    pub fn block(&self, output: &Output, columns: Range<usize>) -> (Type, TokenStream) {
        let krate = self.krate;
        let entry = |row: usize, column: usize| {
            output.values.get(row * output.columns + column).map(|&value| local(value))
        };
        let shape = Type::of_shape(output.rows, columns.len());
        if columns.is_empty() {
            return (shape, quote!(#krate::nalgebra::SMatrix::zeros()));
        }
        let columns_of = columns.map(|column| {
            let entries = (0..output.rows).filter_map(|row| entry(row, column));
            quote!([#(#entries),*])
        });
        let data = quote!([#(#columns_of),*]);
        (shape, quote!(#krate::nalgebra::SMatrix::from(#data)))
    }

    /// Name and documentation of the method of a quantity, if it has both.
    pub fn describe(&self, quantity: Quantity) -> Option<(String, String)> {
        let docs = quantity.description().docs;
        let m = self.mechanism;
        let words = match quantity {
            Quantity::Contact(index, _) => self.contact_words(index as usize),
            Quantity::Point(index, _) => m.points.get(index as usize).map(|at| about(&at.name, &at.docs))?,
            Quantity::Orientation(index) => {
                m.frames.get(index as usize).map(|at| about(&at.name, &at.docs))?
            }
            _ => String::new(),
        };
        Some((quantity.method(m).filter(|_| !docs.is_empty())?, docs.replacen("{}", &words, 1)))
    }

    /// Name of a method of a contact.
    pub fn contact_method(&self, prefix: &str, contact: usize) -> String {
        let name = self.mechanism.contacts.get(contact).map_or("", |contact| contact.name.as_str());
        format_ident!("{prefix}_{}", snake_case(name)).to_string()
    }
}

/// A name with its documentation: `P (the end that strikes)`.
pub fn about(name: &str, docs: &str) -> String {
    let prose = prose(docs);
    let paragraph: Vec<&str> =
        prose.lines().take_while(|line| !line.is_empty() && !line.starts_with("```")).collect();
    let docs = paragraph.join(" ");
    let docs = docs.trim_end_matches('.');
    if docs.is_empty() { format!("`{name}`") } else { format!("`{name}` ({docs})") }
}
