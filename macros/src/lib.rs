//! The procedural macro of Hodograph. Use it as `hodograph::mechanism!`, which says where the runtime is under whatever name.

use hodograph_generator::expand::{expand, package};

/// `($crate) "models/two_sleds.mech"` or `($crate) mechanism Name; ..`; without the first group the runtime is `::hodograph`.
#[proc_macro]
pub fn mechanism(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    expand(input.into(), &package()).into()
}
