//! Keeps texts of interpreted models for the rest of the process, up to a limit, because errors of the runtime hold
//! `&'static str`: they are copied freely, also where nothing can be allocated.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// As many bytes are kept in all.
const MOST: usize = 1 << 20;
/// What stands for a text once so many were kept.
const ANOTHER: &str = "a quantity of the model (this process has met too many others to keep its name)";

/// The texts that are kept, and their bytes.
struct Kept {
    texts: BTreeSet<&'static str>,
    bytes: usize,
}

static KEPT: Mutex<Kept> = Mutex::new(Kept { texts: BTreeSet::new(), bytes: 0 });

/// The text, kept. Equal texts are kept once; a process that goes through models without end keeps no more than
/// [`MOST`] bytes of them, and then has [`ANOTHER`] for new ones.
pub fn intern(text: &str) -> &'static str {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).intern(text, MOST)
}

impl Kept {
    fn intern(&mut self, text: &str, most: usize) -> &'static str {
        if let Some(known) = self.texts.get(text) {
            return known;
        }
        if self.bytes + text.len() > most {
            return ANOTHER;
        }
        let kept: &'static str = Box::leak(text.to_owned().into_boxed_str());
        self.bytes += kept.len();
        self.texts.insert(kept);
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::{ANOTHER, BTreeSet, Kept, intern};

    #[test]
    fn equal_texts_are_kept_once() {
        let (first, second) = (intern("a slider"), intern(&format!("a {}", "slider")));
        assert!(std::ptr::eq(first, second));
        assert_eq!(intern("another"), "another");
    }

    #[test]
    fn no_more_is_kept_than_the_limit() {
        let mut kept = Kept { texts: BTreeSet::new(), bytes: 0 };
        let texts: Vec<&str> = (0..100).map(|i| kept.intern(&format!("{i:02}"), 20)).collect();
        assert_eq!((texts[9], texts[10], kept.bytes), ("09", ANOTHER, 20));
        assert_eq!(kept.intern("03", 20), "03");
    }
}
