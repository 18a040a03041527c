hodograph::mechanism!("constraint_not_linear.mech");

fn main() {}
