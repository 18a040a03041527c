hodograph::mechanism! {
    mechanism Chain;
    part Link(hinge: point, base: frame) {
        parameters { shared m: kg }
        coordinates { q: rad }
        speeds { u: rad/s }
        frames { B = base.rotate(z, q); }
        points { tip = hinge - l*B.y; }
        particles { Bob { point: tip, mass: m } }
    }
    parameters { m: kg = 1, l: m = 0.5 }
    use Link as link[1](hinge: O, base: N);
    use Link as link[2](hinge: link[0].tip, base: link[1].C);
}

fn main() {}
