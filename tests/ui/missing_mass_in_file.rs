hodograph::mechanism!("missing_mass.mech");

fn main() {}
