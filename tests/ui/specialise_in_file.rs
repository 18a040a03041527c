//! Mistakes in specialised collisions: each at its place, and none of them makes another error in the code around.

mod unknown {
    hodograph::mechanism!("../models/dpend.mech", specialise strike(contact_e, law = Stronge), specialise hit(zebra));

    pub fn strike(
        pendulum: &dpend::Dpend<f64>,
        q: &dpend::Coordinates<f64>,
        u: &dpend::Speeds<f64>,
    ) -> dpend::Collision<f64> {
        pendulum.strike(q, u, 0.3, 0.5).unwrap()
    }
}

mod names {
    hodograph::mechanism!(
        "../models/dpend.mech",
        evaluate control(forcing),
        specialise control(contact_ee),
        specialise mass_matrix(contact_ee),
        specialise loop(contact_ee),
        specialise strike(contact_ee),
        specialise strike(contact_ee, e = 1),
    );
}

mod malformed {
    hodograph::mechanism!(
        "../models/dpend.mech",
        specialise,
        specialise (contact_ee),
        specialise a,
        specialise b(),
        specialise c(law = Newton),
        specialise d(contact_ee law = Newton),
        specialise e(contact_ee, lwa = Newton),
        specialise f(contact_ee, restitution = 0.5),
        specialise g(contact_ee, law),
        specialise h(contact_ee, law = Pisson),
        specialise i(contact_ee, mu = -0.3),
        specialise j(contact_ee, e = 1.2),
        specialise k(contact_ee, e = 0.5, e = 0.5),
        specialise l(contact_ee, mu = friction),
        specialise m(contact_ee, budget = 0.5),
    );
}

mod other_arguments {
    hodograph::mechanism!("../models/dpend.mech", specialize strike(contact_ee));
    hodograph::mechanism!("../models/dpend.mech" "../models/dpend.mech");
    hodograph::mechanism!("../models/dpend.mech", evaluate control(forcing), inputs);
}

fn main() {}
