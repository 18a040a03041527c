hodograph::mechanism! {
    mechanism Chain;
    import "parts/nowhere.mech";
    count n = 3;
    part Link(hinge: point, base: frame) {
        parameters { shared m: kg }
        coordinates { q: rad }
        speeds { u: rad/s }
        frames { B = base.rotate(z, q); }
        points { tip = hinge - l*B.y; }
        particles { Bob { point: tip, mass: m } }
    }
    parameters { m: kg = 1, l: m = 0.5 }
    use Link as link[1](hinge: O, base: N, lenght: l);
    for i in 2..n { use Link as link[i](hinge: link[i - 1].tip); }
    for i in 1..l { use Link as other[i](hinge: O, base: N); }
}

fn main() {}
