hodograph::mechanism!();
hodograph::mechanism!("a.mech", "b.mech");
hodograph::mechanism!(concat!("models", "/x.mech"));
hodograph::mechanism!(path = "models/x.mech");
hodograph::mechanism!("");
hodograph::mechanism!("models/no_such.mech");
hodograph::mechanism!("no_text.mech");
hodograph::mechanism!(42);
hodograph::mechanism! { parameters { m: kg = 1 } }
hodograph::mechanism! { mechanism; coordinates { q1: m } }

fn main() {}
