hodograph::mechanism! {
    mechanism Rod;
    parameters { m: kg = 1, l: m = 0.5, gamma: m/s^2 = 9.81, l: m = 1 }
    coordinates { q1: rad, q2: m }
    speeds { u1: rad/s }
    dependent { u2: m/s }
    frames { B = N.rotate(z, q1); }
    points { S = O + q2*N.x; G = S - l/2*B.y; P = S - l*B.y; }
    bodies { Rod1 { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
    loads { gravity: -gama*N.y; force on G: (m*gamma + l)*N.x; }
    constraints { (u2 + 2)*u1*l = u2*gamma*m; }
    contacts { tip { point: P of Rod1, normal: cross(velocity(P), N.y) } }
}

fn main() {}
