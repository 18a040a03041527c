hodograph::mechanism!("part_import_cycle.mech");

fn main() {}
