//! The derivation files beside the models: reading and writing gives the same bytes, and every guard belongs
//! to a value that is used.

use std::path::Path;

use hodograph_generator::artifact;

#[test]
fn checked_in_derivations_are_whole() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let (mut found, mut stated) = (0, 0);
    for entry in std::fs::read_dir(models).unwrap() {
        let path = entry.unwrap().path();
        stated += usize::from(path.extension().is_some_and(|extension| extension == "mech"));
        if path.extension().is_none_or(|extension| extension != "derivation") {
            continue;
        }
        found += 1;
        let name = path.display();
        let text = std::fs::read_to_string(&path).unwrap();
        let artifact = artifact::decode(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(artifact::encode(&artifact.program, &artifact.model), text, "{name}");
        let slice = artifact.program.slice(&artifact.program.quantities());
        for guard in &artifact.program.guards {
            assert!(
                slice.order.contains(&guard.value),
                "{name}: nothing needs what `{}` guards",
                guard.message
            );
        }
    }
    assert_eq!(found, stated, "a model without derivation, or a derivation without model");
}
