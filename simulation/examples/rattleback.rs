//! A rattleback that is spun against its preferred sense on a floor it could slip on and leave: it rattles,
//! and turns back.
//!
//!   cargo run --release -p hodograph-simulation --example rattleback -- --svg rattleback.svg

mod story;

use std::sync::Arc;

use hodograph::{Contacts, Law, Surface};
use hodograph_simulation::{EventKind, Options};
use rattleback_on_floor::RattlebackOnFloor;
use story::{Start, Told};

hodograph::mechanism!("models/rattleback_on_floor.mech");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    story::show(&tell()?)
}

/// The story of the rattleback.
pub fn tell() -> Told {
    let celt = RattlebackOnFloor::<f64>::default();
    let mut start = Start::of(&celt)?;
    start.speeds[2] = -2.0;
    // On the floor, and rolling: the height closes the gap, the velocity of the mass centre stops the lowest
    // point.
    start.coordinates[5] -= Contacts::gap(&celt, 0, &start.state())?.unwrap_or(0.0);
    let here = Contacts::contact_state(&celt, 0, &start.state())?;
    let slip = here.normal * here.velocity.x + here.first * here.velocity.y + here.second * here.velocity.z;
    for (speed, slip) in start.speeds[3..6].iter_mut().zip(&slip) {
        *speed -= slip;
    }
    let options = Options {
        surface: Some(Surface { mu: 0.8, e: 0.0, law: Law::Newton }),
        // An event of our own: the spin is zero.
        events: vec![Arc::new(|_, _, u: &[f64]| u[2])],
        ..Options::default()
    };
    let mut table = String::from("  t (s)   spin (rad/s)   heading (rad)   contact\n");
    let mut path: Vec<[f64; 2]> = Vec::new();
    let mut count = 0;
    let mut story = story::follow(&celt, &start, options, (12.0, 0.05), |simulation, _| {
        let (q, u) = (simulation.coordinates(), simulation.speeds());
        path.push([simulation.time(), 0.5 + 0.1 * u[2]]);
        if count % 20 == 0 {
            let phase = simulation.phase(0);
            table += &format!(
                "{:7.1} {:14.4} {:15.3}   {}\n",
                simulation.time(),
                u[2],
                q[0],
                phase.map_or(String::new(), |phase| format!("{phase:?}").to_lowercase())
            );
        }
        count += 1;
    })?;
    story.picture.line(&path, "#37a");
    // While it rattles the spin trembles: its zeros stand close together.
    let zeros: Vec<f64> = story
        .events
        .iter()
        .filter(|event| matches!(event.kind, EventKind::Zero(_)))
        .map(|event| event.time)
        .collect();
    let turned = match (zeros.first(), zeros.last()) {
        (Some(first), Some(last)) => format!(
            "The spin is zero {} times from t = {first:.6} s to {last:.6} s, for it trembles.",
            zeros.len()
        ),
        _ => "It does not turn back.".to_owned(),
    };
    let rolls = story.events.len() == zeros.len() + 1;
    let [before, after] = story.energy.map(|energy| energy.total().unwrap_or(f64::NAN));
    let kept = after - before;
    story.text = format!(
        "A rattleback on a floor with mu = 0.8 is spun with {} rad/s.\n\n{table}\n{turned}\n{}\nThe energy, {:.6} J, changes by {kept:.1e} J.\n\n\
         The picture shows the spin over time. To see the like move:\n  hodograph simulate simulation/models/rattleback_on_floor.mech --until 12 --mu 0.8 --e 0 --law newton --html rattleback.html",
        start.speeds[2],
        if rolls {
            "It rolls all the time, though nothing but friction makes it."
        } else {
            "It slips or leaves the floor in between."
        },
        before
    );
    Ok(story)
}
