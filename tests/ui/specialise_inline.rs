//! A mistake in the specialised collision of an inline model is told before the model has a derivation.

hodograph::mechanism! {
    mechanism Puck;
    parameters { m: kg = 1 }
    coordinates { q1: m }
    speeds { u1: m/s }
    points { P = O + q1*N.x; }
    particles { A { point: P, mass: m } }
    contacts { wall { point: P of A, normal: -N.x } }
    specialise strike(wall, law = Stronger);
}

fn main() {}
