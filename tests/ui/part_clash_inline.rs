hodograph::mechanism! {
    mechanism Chain;
    part Link(hinge: point, base: frame) {
        parameters { shared m: kg, shared l: m }
        coordinates { q: rad }
        speeds { u: rad/s }
        frames { B = base.rotate(z, q); }
        points { tip = hinge - l*m*B.y; }
        particles { Bob { point: tip, mass: m } }
    }
    parameters { m: kg = 1, l: m = 0.5, link_1_q: rad = 2 }
    use Link as link[1](hinge: O, base: N);
    use Link as link[2](hinge: link[1].tip, base: link[1].B);
}

fn main() {}
