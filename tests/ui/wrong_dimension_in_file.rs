hodograph::mechanism!("wrong_dimension.mech");

fn main() {}
