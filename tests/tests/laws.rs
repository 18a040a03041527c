//! Laws of restitution have one name and one meaning, in models, in generated code and in the solver.

use hodograph::Law;
use hodograph_generator::emit::law_variant;
use hodograph_generator::words;

#[test]
fn laws_of_models_are_those_of_the_solver() {
    let stated: Vec<_> = words::LAWS.iter().map(|word| (word.text, word.meaning)).collect();
    let solved: Vec<_> = Law::ALL.iter().map(|law| (law.name(), law.about())).collect();
    assert_eq!(stated, solved);
    for law in Law::ALL {
        assert_eq!(law_variant(law.name()), format!("{law:?}"));
    }
}
