//! Arrays that loops over columns read. The parts of a long routine store values in them one by one; a short
//! routine writes them as array literals.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::values::local;
use hodograph_program::program::operation::Value;

/// A place in an array.
#[derive(Clone)]
pub struct ArrayEntry {
    /// the array
    pub array: Ident,
    /// the place in it
    pub index: TokenStream,
}

/// An array that a routine fills: rows of values of equal length.
struct Filled {
    name: Ident,
    rows: Vec<Vec<Value>>,
    /// length of its rows including padding, as the loop reads them; `None`: a one-dimensional array
    width: Option<usize>,
}

/// All arrays that the loops of a routine read, and the places of each value.
#[derive(Default)]
pub struct Storage {
    arrays: Vec<Filled>,
    places: BTreeMap<Value, Vec<ArrayEntry>>,
}

impl Storage {
    /// Adds an array of numbers.
    pub fn list(&mut self, name: &str, values: Vec<Value>) {
        self.add(Filled { name: format_ident!("{name}"), rows: vec![values], width: None });
    }

    /// Adds an array of rows, padded with zeros to a length.
    pub fn table(&mut self, name: &Ident, rows: Vec<Vec<Value>>, width: usize) {
        self.add(Filled { name: name.clone(), rows, width: Some(width) });
    }

    fn add(&mut self, filled: Filled) {
        for (row, values) in filled.rows.iter().enumerate() {
            for (column, &value) in values.iter().enumerate() {
                let [row, column] = [row, column].map(Literal::usize_unsuffixed);
                let index = if filled.width.is_some() { quote!([#row][#column]) } else { quote!([#column]) };
                self.places.entry(value).or_default().push(ArrayEntry { array: filled.name.clone(), index });
            }
        }
        self.arrays.push(filled);
    }

    /// The places of a value.
    pub fn of(&self, value: Value) -> &[ArrayEntry] {
        self.places.get(&value).map_or(&[], Vec::as_slice)
    }

    /// All values with a place.
    pub fn values(&self) -> impl Iterator<Item = Value> {
        self.places.keys().copied()
    }

    /// The type of an array.
    pub fn shape(&self, array: &Ident) -> Option<TokenStream> {
        self.arrays.iter().find(|filled| filled.name == *array).map(Filled::shape)
    }

    /// The arrays before values are stored in them.
    pub fn empty(&self) -> TokenStream {
        let arrays = self.arrays.iter().map(|filled| {
            let (name, empty) = (&filled.name, filled.empty());
            quote!(let mut #name = #empty;)
        });
        quote!(#(#arrays)*)
    }

    /// The statements that store every value except those already stored.
    pub fn stores(&self, stored: &BTreeSet<Value>) -> TokenStream {
        let left = self.places.iter().filter(|(value, _)| !stored.contains(value));
        let stores = left.flat_map(|(&value, storage)| storage.iter().map(move |slot| slot.store(value)));
        quote!(#(#stores)*)
    }

    /// The arrays with all values as literals.
    pub fn full(&self) -> TokenStream {
        let arrays = self.arrays.iter().map(|filled| {
            let (name, full) = (&filled.name, filled.full());
            quote!(let #name = #full;)
        });
        quote!(#(#arrays)*)
    }
}

impl ArrayEntry {
    /// The value in it.
    pub fn tokens(&self) -> TokenStream {
        let (array, index) = (&self.array, &self.index);
        quote!(#array #index)
    }

    /// The statement that stores a value.
    pub fn store(&self, value: Value) -> TokenStream {
        let (place, value) = (self.tokens(), local(value));
        quote!(#place = #value;)
    }
}

impl Filled {
    fn shape(&self) -> TokenStream {
        let count = Literal::usize_unsuffixed(self.rows.len());
        match self.width.map(Literal::usize_unsuffixed) {
            Some(width) => quote!([[T; #width]; #count]),
            None => {
                let count = Literal::usize_unsuffixed(self.rows[0].len());
                quote!([T; #count])
            }
        }
    }

    fn empty(&self) -> TokenStream {
        let count = Literal::usize_unsuffixed(self.rows.len());
        match self.width.map(Literal::usize_unsuffixed) {
            Some(width) => quote!([[T::zero(); #width]; #count]),
            None => {
                let count = Literal::usize_unsuffixed(self.rows[0].len());
                quote!([T::zero(); #count])
            }
        }
    }

    fn full(&self) -> TokenStream {
        let rows = self.rows.iter().map(|values| {
            let values = values.iter().map(|&value| local(value)).map(|name| quote!(#name));
            let fill = self.width.unwrap_or(0).saturating_sub(values.len());
            let values = values.chain(std::iter::repeat_n(quote!(T::zero()), fill));
            quote!([#(#values),*])
        });
        match self.width {
            Some(_) => quote!([#(#rows),*]),
            None => quote!(#(#rows)*),
        }
    }
}
