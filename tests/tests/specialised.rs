//! A specialised collision of a mechanism answers as the usual one does, bit by bit: general and planar contacts,
//! dependent speeds, time, a frame that moves, budgets, and states that are refused.

use hodograph::{CollisionError, ImpactError, Law, Surface};

use crate::common::random::Random;

macro_rules! collisions {
    ($($module:ident $machine:ident $file:literal $contact:ident $collide:ident ($($time:expr)?);)*) => {
        $(
            hodograph::mechanism!(
                $file,
                specialise newton($contact, law = Newton),
                specialise poisson($contact, law = Poisson, budget = 2),
                specialise stronge($contact, law = Stronge, e = 0.5),
                specialise all($contact, law = Stronge, mu = 0.7, e = 0.5),
                specialise none($contact),
            );

            #[test]
            fn $module() {
                use $module::{$machine, Coordinates, Speeds};
                let machine = $machine::<f64>::default();
                let mut random = Random::named(stringify!($module));
                let (mut hits, mut refused, mut stopped) = (0, 0, 0);
                for _ in 0..300 {
                    let mut q = <[f64; _]>::from(Coordinates::<f64>::default());
                    let mut u = <[f64; _]>::from(Speeds::<f64>::default());
                    q.iter_mut().for_each(|q| *q += 0.3 * random.number());
                    u.iter_mut().for_each(|u| *u = 2.0 * random.number());
                    let (q, u) = (Coordinates::from(q), Speeds::from(u));
                    let (mu, e) = (1.5 * random.number().abs(), random.number().abs());
                    let usual = |mu, e, law| machine.$collide($($time,)? &q, &u, &Surface { mu, e, law });
                    let text = |answer: &dyn std::fmt::Debug| format!("{answer:?}");
                    match usual(mu, e, Law::Newton) {
                        Ok(_) => hits += 1,
                        Err(_) => refused += 1,
                    }
                    assert_eq!(text(&usual(mu, e, Law::Newton)), text(&machine.newton($($time,)? &q, &u, mu, e)));
                    let within = Surface { mu, e, law: Law::Poisson }.with_budget(2);
                    let within = machine.$collide($($time,)? &q, &u, &within);
                    assert_eq!(text(&within), text(&machine.poisson($($time,)? &q, &u, mu, e)));
                    let budget = ImpactError::BudgetExceeded { quadratures: 2, normal_velocity: 0.0 }.kind();
                    stopped += u32::from(matches!(within, Err(CollisionError::Impact(error)) if error.kind() == budget));
                    assert_eq!(text(&usual(mu, 0.5, Law::Stronge)), text(&machine.stronge($($time,)? &q, &u, mu)));
                    assert_eq!(text(&usual(0.7, 0.5, Law::Stronge)), text(&machine.all($($time,)? &q, &u)));
                    for &law in Law::ALL {
                        assert_eq!(text(&usual(mu, e, law)), text(&machine.none($($time,)? &q, &u, mu, e, law)));
                    }
                    assert_eq!(text(&usual(-1.0, e, Law::Newton)), text(&machine.newton($($time,)? &q, &u, -1.0, e)));
                }
                assert!(hits > 50 && refused > 50, "{hits} {refused}");
                println!("{hits} collisions, {refused} states refused, {stopped} over budget");
            }
        )*
    };
}

collisions! {
    two_sleds TwoSleds "../models/two_sleds.mech" bc_ac collide_bc_ac ();
    four_bar FourBar "../models/four_bar.mech" coupler_wall collide_coupler_wall ();
    planar_double_pendulum PlanarDoublePendulum "../models/planar_double_pendulum.mech" tip_wall collide_tip_wall ();
    driven_rotary_pendulum DrivenRotaryPendulum "../models/driven_rotary_pendulum.mech" tip_wall collide_tip_wall (0.3);
    crossing_rails CrossingRails "models/crossing_rails.mech" upper_lower collide_upper_lower ();
    gantry Gantry "models/gantry.mech" tool_table collide_tool_table ();
    askew_gantry AskewGantry "models/askew_gantry.mech" tool_table collide_tool_table ();
    arm_7dof Arm7dof "../models/arm_7dof.mech" tool_plane collide_tool_plane ();
}
