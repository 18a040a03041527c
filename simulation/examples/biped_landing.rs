//! A biped drops on its feet: toes and heels strike, the joints give way, and it comes to rest.
//!
//!   cargo run --release -p hodograph-simulation --example biped_landing -- --svg biped.svg

mod story;

use biped::Biped;
use hodograph::{ComponentKind, Contacts, Law, Mechanism, State, Surface};
use hodograph_simulation::{Options, Simulation};
use story::{Start, Told};

hodograph::mechanism!("models/biped.mech");

/// Points along the trunk and the legs.
const LIMBS: [&[&str]; 3] =
    [&["Head", "H"], &["H", "K1", "A1", "Heel1", "Toe1", "A1"], &["H", "K2", "A2", "Heel2", "Toe2", "A2"]];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    story::show(&tell()?)
}

/// The story of the biped.
pub fn tell() -> Told {
    tell_until(15.0)
}

/// The beginning of the story of the biped.
pub fn tell_until(until: f64) -> Told {
    let biped = Biped::<f64>::default();
    let mut start = Start::of(&biped)?;
    // The toes point down, and the left leg is stretched a little more.
    let mut set = |name: &str, value: f64| {
        if let Some(place) = Mechanism::index(&biped, ComponentKind::Coordinate, name) {
            start.coordinates[place] = value;
        }
    };
    set("qa1", -0.25);
    set("qa2", -0.3);
    set("qh2", -0.35);
    let options = Options {
        surface: Some(Surface { mu: 0.8, e: 0.0, law: Law::Newton }),
        compare_orders: false,
        ..Options::default()
    };
    let mut forces = String::new();
    let mut drawn = 0;
    let mut story = story::follow(&biped, &start, options, (until, 0.06), |simulation, story| {
        if drawn % 2 == 0 && drawn < 12 || drawn == 40 {
            draw(&biped, simulation, story, 0.5 * f64::from(drawn.min(12)));
        }
        drawn += 1;
        forces = pressures(&biped, simulation);
    })?;
    let rest = story.events.iter().find(|event| event.kind.name() == "rest");
    let end = rest.map_or("It does not come to rest.".to_owned(), |rest| {
        format!("At rest after {:.2} s, on {forces}.", rest.time)
    });
    story.text = format!(
        "A biped of 16 kg drops 0.3 m on a floor with mu = 0.8, e = 0.\n\n{}\n{}\n{end}\n\
         Heel and toe of a foot share its friction in any way that rigid bodies allow: their normal forces are unique, the shares are not.\n\n\
         To see it move: hodograph simulate simulation/models/biped.mech --state '{{\"q\":{{\"qa1\":-0.25,\"qa2\":-0.3,\"qh2\":-0.35}}}}' --until 2 --mu 0.8 --e 0 --law newton --html biped.html",
        story::lines(&biped, &story.events),
        story::account(&story.energy)
    );
    Ok(story)
}

/// The normal forces, in words.
fn pressures(biped: &dyn Contacts<f64>, simulation: &Simulation<'_>) -> String {
    let forces = simulation.contact_forces().map_or(Vec::new(), |(forces, _)| forces);
    let parts: Vec<String> = forces
        .iter()
        .filter_map(|(contact, force)| {
            let name = biped.component(ComponentKind::Contact, *contact)?.name;
            Some(format!("{name} ({:.2} N)", force.x))
        })
        .collect();
    parts.join(", ")
}

/// The stick figure, moved to the right by so much.
fn draw(biped: &dyn Contacts<f64>, simulation: &Simulation<'_>, story: &mut story::Story, shift: f64) {
    let inputs = [0.0; 6];
    let (q, u) = (simulation.coordinates(), simulation.speeds());
    let state = State { time: simulation.time(), coordinates: q, speeds: u, inputs: &inputs };
    for (limb, colour) in LIMBS.iter().zip(["#555", "#37a", "#c73"]) {
        let points: Vec<[f64; 2]> = limb
            .iter()
            .filter_map(|name| biped.index(ComponentKind::Point, name))
            .filter_map(|point| biped.position(point, &state).ok())
            .map(|place| [place.x + shift, place.z])
            .collect();
        story.picture.line(&points, colour);
    }
}
