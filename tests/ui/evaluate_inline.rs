//! A mistake in the set of an inline model is told before the model has a derivation.

hodograph::mechanism! {
    mechanism Cart;
    parameters { m: kg = 1 }
    coordinates { q1: m }
    speeds { u1: m/s }
    points { P = O + q1*N.x; }
    particles { A { point: P, mass: m } }
    evaluate control[forcing];
}

fn main() {}
