hodograph::mechanism!("part_import_missing.mech");

fn main() {}
