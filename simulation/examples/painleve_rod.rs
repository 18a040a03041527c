//! Painleve's rod: a rod slides on a rough floor, and no finite force can hold it.
//!
//!   cargo run --release -p hodograph-simulation --example painleve_rod -- --svg rod.svg

mod story;

use hodograph::{ComponentKind, Contacts, Law, Mechanism, State, Surface, contact_mode};
use hodograph_simulation::Options;
use nalgebra::Vector2;
use painleve_rod::PainleveRod;
use story::{Start, Told};

hodograph::mechanism!("models/painleve_rod.mech");

const MU: f64 = 1.6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    story::show(&tell()?)
}

/// The story of the rod.
pub fn tell() -> Told {
    let rod = PainleveRod::<f64>::default();
    let mut start = Start::of(&rod)?;
    start.speeds[0] = -1.0;
    // What the floor would have to do, for some coefficients of friction.
    let here = Contacts::contact_state(&rod, 0, &start.state())?;
    let beta = Contacts::free_acceleration(&rod, 0, &start.state())?;
    let slip = Vector2::new(here.velocity.y, here.velocity.z);
    let d = slip.normalize();
    let mut table = String::new();
    for mu in [0.5, 1.0, 1.3, MU] {
        let f = here.reduced.nn - mu * (here.reduced.nt * d.x + here.reduced.ns * d.y);
        let answer = match contact_mode(&here.reduced, &beta, &slip, mu) {
            Ok(answer) => format!("{}, lambda_n = {:.2} N", answer.mode.name(), answer.force.x),
            Err(error) => format!("none: {}", error.kind()),
        };
        table += &format!("  mu = {mu:.1}   f = {f:+.3} 1/kg   {answer}\n");
    }
    let options =
        Options { surface: Some(Surface { mu: MU, e: 0.5, law: Law::Poisson }), ..Options::default() };
    let ends: Vec<usize> =
        ["P", "Q"].iter().filter_map(|name| Mechanism::index(&rod, ComponentKind::Point, name)).collect();
    let mut story = story::follow(&rod, &start, options, (3.0, 0.04), |simulation, story| {
        let (q, u) = (simulation.coordinates(), simulation.speeds());
        let state = State { time: simulation.time(), coordinates: q, speeds: u, inputs: &[] };
        let points: Vec<[f64; 2]> = ends
            .iter()
            .map(|&end| Mechanism::position(&rod, end, &state).map_or([0.0; 2], |place| [place.x, place.z]))
            .collect();
        story.picture.line(&points, if simulation.time() == 0.0 { "#c33" } else { "#37a" });
    })?;
    story.text = format!(
        "A rod stands at an angle on a rough floor (tangent 2) and its tip slides with 1 m/s, away from the side to which it leans.\n\
         Its weight alone would accelerate the tip downwards with {:.2} m/s^2. A normal force lambda_n changes that by f lambda_n:\n\n{table}\n\
         With f < 0 friction turns the rod into the floor faster than the force lifts it: any force makes it worse. Rigid bodies\n\
         then suffer an impact, though nothing approaches:\n\n{}\n{}\n\
         To see it move: hodograph simulate simulation/models/painleve_rod.mech --state '{{\"u\":{{\"u1\":-1}}}}' --until 2 --mu {MU} --e 0.5 --law poisson --html rod.html",
        -beta.x,
        story::lines(&rod, &story.events),
        story::account(&story.energy)
    );
    Ok(story)
}
