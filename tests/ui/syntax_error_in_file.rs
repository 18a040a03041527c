hodograph::mechanism!("syntax_error.mech");

fn main() {}
