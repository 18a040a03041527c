//! The list of `every_mechanism!` names every model file, and each module of it exists.
#![cfg(feature = "all")]

use hodograph::{ComponentKind, Mechanism};

macro_rules! listed {
    ($($feature:literal $module:ident $mechanism:ident,)*) => {
        [$((
            $feature,
            stringify!($module),
            hodograph_models::$module::$mechanism::<f64>::default().count(ComponentKind::Speed),
        )),*]
    };
}

#[test]
fn the_list_has_every_model_file() {
    let folder = std::fs::read_dir(env!("CARGO_MANIFEST_DIR")).expect("the models");
    let mut files: Vec<String> = folder
        .filter_map(|entry| Some(entry.ok()?.file_name().to_str()?.strip_suffix(".mech")?.to_owned()))
        .collect();
    files.sort();
    let list = hodograph_models::every_mechanism!(listed);
    assert_eq!(files, list.map(|(_, module, _)| module.to_owned()));
    for (feature, module, speeds) in list {
        assert_eq!(feature, module);
        assert!(speeds > 0, "{module}");
    }
}
