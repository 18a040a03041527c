//! The procedural macro of Hodograph. Use it as `hodograph::mechanism!`, which passes the path of the
//! runtime, whatever its name in the user's crate.

use hodograph_generator::expand::{expand, package};

/// `($crate) "models/two_sleds.mech"` or `($crate) mechanism Name; ..`; without the first group the runtime
/// is `::hodograph`.
#[proc_macro]
pub fn mechanism(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    expand(input.into(), &package()).into()
}
