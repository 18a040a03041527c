// One wrong unit is one error, at the unit, however many uses contradict it.
hodograph::mechanism! {
    mechanism WrongDeclaration;
    parameters { m: kg = 1, l: s = 0.5, g: m/s^2 = 9.81 }
    coordinates { q1: rad }
    speeds { u1: rad/s }
    frames { B = N.rotate(z, q1); }
    points { G = O - l/2*B.y; P = O - l*B.y; }
    bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
    loads { gravity: -g*N.y; }
    contacts { wall { point: P of Rod, normal: -N.x } }
}

fn main() {}
