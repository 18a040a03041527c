hodograph::mechanism!("part_dimension.mech");

fn main() {}
