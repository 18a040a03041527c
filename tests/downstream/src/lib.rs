//! A user's crate: `no_std`, the dependency renamed, a model in a file, one in the source, and one that is
//! ready-made.
#![no_std]
#![forbid(unsafe_code)]
#![deny(warnings, missing_docs, clippy::all, clippy::pedantic)]

contact::mechanism!("models/gate.mech");
contact::mechanism!("models/hopper.mech");

contact::mechanism! {
    //! A puck on a table.
    mechanism Puck;
    parameters { m: kg = 0.2, r: m = 0.05 }
    coordinates { q1: m, q2: m, q3: rad }
    speeds { u1: m/s, u2: m/s, u3: rad/s }
    frames { B = N.rotate(z, q3); }
    points { C = O + q1*N.x + q2*N.y; P = C + r*B.x; }
    bodies { Disc { frame: B, centre: C, mass: m, inertia: [m*r^2/4, m*r^2/4, m*r^2/2] } }
    contacts { rim { point: P of Disc, normal: -B.x } }
    evaluate at_the_rim(mass_matrix, contact_state_rim, velocity_p);
}

use contact::{CollisionError, Law, Surface};
use hodograph_models::two_sleds::{self, TwoSleds};
use hopper::{Coordinates, Hopper, Speeds};

/// The speeds after the foot has struck the ground.
///
/// # Errors
///
/// Where the collision has no outcome.
pub fn strike(q: &Coordinates<f32>, u: &Speeds<f32>) -> Result<Speeds<f32>, CollisionError<f32>> {
    let surface = Surface { mu: 0.6, e: 0.2, law: Law::Stronge };
    Ok(Hopper::default().collide_foot_ground(q, u, &surface)?.speeds)
}

/// All its parameters are fixed: nothing is computed at run time.
pub static GATE: gate::Gate<f32> = gate::Gate::MODEL;

/// The speeds of two sleds after they have struck each other.
///
/// # Errors
///
/// Where the collision has no outcome.
pub fn ready_made(u: &two_sleds::Speeds<f32>) -> Result<two_sleds::Speeds<f32>, CollisionError<f32>> {
    let surface = Surface { mu: 0.6, e: 0.8, law: Law::Stronge };
    Ok(TwoSleds::default().collide_bc_ac(&two_sleds::Coordinates::default(), u, &surface)?.speeds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_is_what_is_constructed() {
        assert_eq!(Ok(GATE), gate::Gate::new());
        assert_eq!(GATE, gate::Gate::default());
        assert_eq!(core::mem::size_of_val(&GATE), 0);
        let surface = Surface { mu: 0.3, e: 0.5, law: Law::Poisson };
        let (q, u) = (gate::Coordinates { q1: 0.0 }, gate::Speeds { u1: -1.0 });
        // The edge approaches with b u1 and leaves with e times that.
        assert!((GATE.collide_edge_post(&q, &u, &surface).unwrap().separation.x - 0.45).abs() < 1e-6);
    }

    #[test]
    fn sleds_strike_each_other() {
        let before = two_sleds::Speeds::default();
        let after = ready_made(&before).unwrap();
        assert!((after - before).iter().any(|(_, change)| change.abs() > 0.1));
    }

    #[test]
    fn the_foot_leaves_the_ground() {
        let hopper = Hopper::<f64>::default();
        let (q, u) = (Coordinates::default(), Speeds { u1: -2.0, u2: 0.1 });
        let surface = Surface { mu: 0.6, e: 0.2, law: Law::Newton };
        let hit = hopper.collide_foot_ground(&q, &u, &surface).unwrap();
        assert!((hit.separation.x + 0.2 * hit.approach.x).abs() < 1e-12);
        assert!(strike(&Coordinates::default(), &Speeds { u1: -2.0, u2: 0.1 }).unwrap().u1 > -2.0);
        let text = serde_json::to_string(&hit).unwrap();
        assert!(text.starts_with("{\"speeds\":{\"u1\":") && text.contains("\"path\":"), "{text}");
        assert_eq!(serde_json::from_str::<Speeds<f64>>("{\"u2\":3.5}").unwrap(), Speeds { u1: 0.0, u2: 3.5 });
        assert!(serde_json::from_str::<Speeds<f64>>("{\"u9\":3.5}").is_err());
        let (puck, q) = (puck::Puck::<f32>::default(), puck::Coordinates::default());
        let u = puck::Speeds { u1: 0.5, u2: -0.3, u3: 2.0 };
        let puck::AtTheRim { mass_matrix, contact_state_rim, velocity_p } = puck.at_the_rim(&q, &u).unwrap();
        assert_eq!(Ok(mass_matrix), puck.mass_matrix(&q));
        assert_eq!(
            (Ok(contact_state_rim), Ok(velocity_p)),
            (puck.contact_state_rim(&q, &u), puck.velocity_p(&q, &u))
        );
    }
}
