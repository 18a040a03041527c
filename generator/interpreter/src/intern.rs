//! Keeps texts of interpreted models for the rest of the process, because errors of the runtime hold
//! `&'static str`.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

static TEXTS: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// The text, kept for ever. Equal texts are kept once, so that no more memory is used than the names and
/// messages of the models amount to that were ever in use.
pub fn intern(text: &str) -> &'static str {
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = texts.get(text) {
        return known;
    }
    let kept: &'static str = Box::leak(text.to_owned().into_boxed_str());
    texts.insert(kept);
    kept
}

#[cfg(test)]
mod tests {
    use super::intern;

    #[test]
    fn equal_texts_are_kept_once() {
        let (first, second) = (intern("a slider"), intern(&format!("a {}", "slider")));
        assert!(std::ptr::eq(first, second));
        assert_eq!(intern("another"), "another");
    }
}
