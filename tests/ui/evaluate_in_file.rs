//! Mistakes in sets of quantities: each at its place, and none of them makes another error in the code around.

mod unknown {
    hodograph::mechanism!("../models/dpend.mech", evaluate control(mass_matix, forcing, reduced_matrix, zebra, forcing));

    pub fn control(pendulum: &dpend::Dpend<f64>, q: &dpend::Coordinates<f64>) -> dpend::Control<f64> {
        pendulum.control(q).unwrap()
    }
}

mod names {
    hodograph::mechanism!(
        "../models/dpend.mech",
        evaluate mass_matrix(forcing),
        evaluate speeds(forcing),
        evaluate fn(forcing),
        evaluate twice(forcing),
        evaluate twice(mass_matrix),
    );
}

mod not_of_one_state {
    hodograph::mechanism!("../models/dpend.mech", evaluate control(collide_contact_ee, linearise));
}

mod no_sets {
    hodograph::mechanism!("../models/dpend.mech", evaluate control, evaluate (forcing), evaluate control());
}

mod no_names {
    hodograph::mechanism!("../models/dpend.mech", evaluate control(contact(contact_ee)), evaluate more(name = "more", forcing));
}

fn main() {}
