hodograph::mechanism! {
    mechanism Rod;
    parameters { m: kg = -1, l: m = 0.5, g: m/s^2 = 9.81 }
    coordinates { q1: rad, q2: m }
    speeds { u1: rad/s }
    dependent { u2: m/s }
    frames { B = N.rotate(z, q1); }
    points { S = O + q2*N.x; G = S - l/2*B.y; P = S - l*B.y; }
    bodies { Rod1 { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
    loads { gravity: -g*N.y; }
    contacts { tip { point: P of Rod1, normal: -N.x } }
}

fn main() {}
