hodograph::mechanism!("unknown_name.mech");

fn main() {}
