//! The coefficients of a quadratic form in the speeds, as which a form in velocities ends.

use std::collections::BTreeMap;

use super::sums::{sum_scalar, take_where};
use crate::algebra::Expr;
use crate::kinematics::linear_forms::{self, Triple};

/// The symmetric matrix M of `1/2 sum M u_r u_s`, by slots `(r, s)` with `r <= s`.
#[derive(Default)]
pub struct Products(BTreeMap<(usize, usize), Expr>);

impl Products {
    /// Adds to an entry. An off-diagonal entry represents both halves, so that the form gains the whole
    /// product.
    pub fn add(&mut self, r: usize, s: usize, value: &Expr) {
        sum_scalar(&mut self.0, (r.min(s), r.max(s)), value);
    }

    /// Adds `value * u_r * u_s` to the form.
    pub fn add_product(&mut self, r: usize, s: usize, value: &Expr) {
        if !value.is_zero() {
            let value = if r == s { value.mul(&Expr::integer(2)) } else { value.clone() };
            self.add(r, s, &value);
        }
    }

    /// Adds `u_slot` times the products of a momentum with these partial velocities.
    pub fn add_products(&mut self, slot: usize, momentum: &Triple, partials: &[(usize, Triple)]) {
        for (other, b) in partials {
            self.add_product(*other, slot, &linear_forms::dot(b, momentum));
        }
    }

    /// Adds the products of half a quadratic form in the slot of its momentum with the partial velocities of
    /// slots up to its own, which is last: the square once, and the product with every other speed fully.
    pub fn add_square(&mut self, partials: &[(usize, Triple)], momentum: &Triple) {
        let Some(((slot, own), before)) = partials.split_last() else { return };
        self.add_products(*slot, momentum, before);
        self.add(*slot, *slot, &linear_forms::dot(own, momentum));
    }

    /// Removes and returns the diagonal entry of a slot.
    pub fn take_square(&mut self, slot: usize) -> Option<Expr> {
        self.0.remove(&(slot, slot))
    }

    /// Removes and returns the off-diagonal entries of a slot, with the slots of the other factors.
    pub fn take(&mut self, slot: usize) -> Vec<(usize, Expr)> {
        let entries = take_where(&mut self.0, |key| key.0 == slot || key.1 == slot).into_iter();
        entries.map(|(key, value)| (if key.0 == slot { key.1 } else { key.0 }, value)).collect()
    }

    /// All entries, by slots `(r, s)` with `r <= s`.
    pub fn entries(self) -> BTreeMap<(usize, usize), Expr> {
        self.0
    }
}
