hodograph::mechanism! {
    mechanism Cart;
    parameters { m: kg = 1 }
    coordinates { q1: m }
    speeds { u1: m/s }
    points { P = O + q1*N.x; }
    particles { Body { point: P, mass: m } }
    mechanism Another;
    parameters { m: kg = 2 }
}

fn main() {}
