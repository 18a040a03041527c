//! Writes all mutants of a file into it: each place computes its original or, if its number is the active
//! one, the mutant.

use std::collections::HashMap;

use proc_macro2::{Span, TokenStream};
use quote::{ToTokens, quote};
use syn::{
    Arm, Block, Expr, ExprBinary, File, ImplItemFn, ItemFn, TraitItemFn, parse_quote,
    spanned::Spanned,
    visit_mut::{self, VisitMut},
};

use crate::{Outcome, list::Mutant};

/// What begins a test for the active mutant in instrumented text.
pub const MARK: &str = "crate :: mutants :: active (";

/// The module that instrumented code calls.
pub const MODULE: &str = r#"
#[doc(hidden)]
#[allow(missing_docs)]
pub mod mutants {
    extern crate std;
    use core::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    static ACTIVE: AtomicUsize = AtomicUsize::new(usize::MAX);
    #[inline(always)]
    pub fn active(id: usize) -> bool {
        let active = ACTIVE.load(Relaxed);
        if active == usize::MAX { read() == id } else { active == id }
    }
    #[cold]
    #[inline(never)]
    fn read() -> usize {
        let id = std::env::var("MUTANT").ok().and_then(|id| id.parse().ok()).unwrap_or(usize::MAX - 1);
        ACTIVE.store(id, Relaxed);
        id
    }
}
"#;

/// The text of a file with the given mutants in it, and how many of them found their place.
pub fn file(source: &str, mutants: &[(usize, &Mutant)]) -> Outcome<(String, Vec<usize>)> {
    let mut tree: File = syn::parse_file(source)?;
    let mut places: HashMap<Place, Vec<(usize, String)>> = HashMap::new();
    for (id, mutant) in mutants {
        let place = (mutant.genre.clone(), mutant.start);
        places.entry(place).or_default().push((*id, mutant.replacement.clone()));
    }
    let mut instrument = Instrument { places, placed: Vec::new() };
    instrument.visit_file_mut(&mut tree);
    Ok((tree.to_token_stream().to_string(), instrument.placed))
}

/// Genre, and line and column from 1.
type Place = (String, (usize, usize));

struct Instrument {
    places: HashMap<Place, Vec<(usize, String)>>,
    placed: Vec<usize>,
}

impl Instrument {
    /// The mutants at a place, with their replacements.
    fn at(&mut self, genre: &str, span: Span) -> Vec<(usize, TokenStream)> {
        let start = span.start();
        let found =
            self.places.remove(&(genre.to_owned(), (start.line, start.column + 1))).unwrap_or_default();
        let parsed: Vec<_> =
            found.into_iter().filter_map(|(id, text)| Some((id, text.parse().ok()?))).collect();
        self.placed.extend(parsed.iter().map(|(id, _)| *id));
        parsed
    }

    /// Bodies of functions return the mutant's value first.
    fn body(&mut self, block: &mut Block) {
        let Some(first) = block.stmts.first() else { return };
        for (id, value) in self.at("FnValue", first.span()) {
            block.stmts.insert(0, parse_quote!(if crate::mutants::active(#id) { return #value; }));
        }
    }

    fn binary(&mut self, expression: ExprBinary) -> Expr {
        let mutants = self.at("BinaryOperator", expression.op.span());
        if mutants.is_empty() || holds_let(&expression) {
            return Expr::Binary(expression);
        }
        let ExprBinary { left, op, right, .. } = expression;
        let lazy = matches!(op, syn::BinOp::And(_) | syn::BinOp::Or(_));
        let assigns = op.to_token_stream().to_string().ends_with('=')
            && !matches!(op, syn::BinOp::Eq(_) | syn::BinOp::Ne(_) | syn::BinOp::Le(_) | syn::BinOp::Ge(_));
        // Operands are evaluated once, but for those that may not be evaluated at all.
        let (a, b) = match (lazy, assigns) {
            (true, _) => (quote!((#left)), quote!((#right))),
            (_, true) => (quote!(#left), quote!(__right)),
            _ => (quote!(__left), quote!(__right)),
        };
        let mut chosen = quote!({ #a #op #b });
        for (id, other) in mutants.into_iter().rev() {
            chosen = quote!({ if crate::mutants::active(#id) { #a #other #b } else #chosen });
        }
        match (lazy, assigns) {
            (true, _) => parse_quote!((#chosen)),
            (_, true) => parse_quote!((match (#right) { __right => #chosen })),
            _ => parse_quote!((match ((#left), (#right)) { (__left, __right) => #chosen })),
        }
    }
}

/// Whether an expression binds names in a condition, which cannot be moved into a block.
fn holds_let(expression: &ExprBinary) -> bool {
    [&expression.left, &expression.right].into_iter().any(|side| match &**side {
        Expr::Let(_) => true,
        Expr::Binary(inner) => holds_let(inner),
        _ => false,
    })
}

impl VisitMut for Instrument {
    fn visit_expr_mut(&mut self, expression: &mut Expr) {
        visit_mut::visit_expr_mut(self, expression);
        let taken = std::mem::replace(expression, Expr::Verbatim(TokenStream::new()));
        *expression = match taken {
            Expr::Binary(binary) => self.binary(binary),
            Expr::Unary(unary) => {
                let mut chosen = quote!(#unary);
                let inner = &unary.expr;
                for (id, _) in self.at("UnaryOperator", unary.op.span()) {
                    chosen = quote!(if crate::mutants::active(#id) { #inner } else { #chosen });
                }
                if chosen.to_string() == unary.to_token_stream().to_string() {
                    Expr::Unary(unary)
                } else {
                    parse_quote!((#chosen))
                }
            }
            other => other,
        };
    }

    fn visit_arm_mut(&mut self, arm: &mut Arm) {
        let deleted = self.at("MatchArm", arm.span());
        let forced = arm
            .guard
            .as_ref()
            .map(|guard| guard.1.span())
            .map(|span| self.at("MatchArmGuard", span))
            .unwrap_or_default();
        visit_mut::visit_arm_mut(self, arm);
        for (id, _) in deleted {
            arm.guard = Some((Default::default(), parse_quote!(!crate::mutants::active(#id))));
        }
        for (id, value) in forced {
            if let Some((_, guard)) = &mut arm.guard {
                **guard = parse_quote!((if crate::mutants::active(#id) { #value } else { #guard }));
            }
        }
    }

    fn visit_item_fn_mut(&mut self, item: &mut ItemFn) {
        self.body(&mut item.block);
        visit_mut::visit_item_fn_mut(self, item);
    }

    fn visit_impl_item_fn_mut(&mut self, item: &mut ImplItemFn) {
        self.body(&mut item.block);
        visit_mut::visit_impl_item_fn_mut(self, item);
    }

    fn visit_trait_item_fn_mut(&mut self, item: &mut TraitItemFn) {
        if let Some(block) = &mut item.default {
            self.body(block);
        }
        visit_mut::visit_trait_item_fn_mut(self, item);
    }
}
