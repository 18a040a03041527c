//! A box is thrown, tumbles on its corners and comes to rest on a face.
//!
//!   cargo run --release -p hodograph-simulation --example tumbling_box -- --svg box.svg

mod story;

use hodograph::{Law, Mechanism, Surface};
use hodograph_simulation::Options;
use story::{Start, Told};
use tumbling_box::TumblingBox;

hodograph::mechanism!("models/tumbling_box.mech");

/// The corners along each edge; corners are numbered in binary: 1 along B.x, 2 along B.y, 4 along B.z.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    story::show(&tell()?)
}

/// The story of the box.
pub fn tell() -> Told {
    let body = TumblingBox::<f64>::default();
    let start = Start::of(&body)?;
    let surface = Surface { mu: 0.4, e: 0.4, law: Law::Stronge };
    let options = Options { surface: Some(surface), ..Options::default() };
    let corners: Vec<usize> = (1..=8)
        .filter_map(|k| Mechanism::index(&body, hodograph::ComponentKind::Point, &format!("P{k}")))
        .collect();
    let mut story = story::follow(&body, &start, options, (20.0, 0.08), |simulation, story| {
        let state = hodograph::State {
            time: simulation.time(),
            coordinates: simulation.coordinates(),
            speeds: simulation.speeds(),
            inputs: &[],
        };
        for edge in EDGES {
            // From the side, a little from above.
            let points = edge.map(|end| {
                let place = Mechanism::position(&body, corners[end], &state).unwrap_or_default();
                [place.x + 0.3 * place.y, place.z + 0.15 * place.y]
            });
            story.picture.line(&points, if simulation.time() == 0.0 { "#c33" } else { "#37a" });
        }
    })?;
    let (q, u) = &story.end;
    let parameters = [("B.x", 0.3), ("B.y", 0.2), ("B.z", 0.15)];
    let face =
        parameters.iter().find(|(_, half)| (q[2] - half).abs() < 1e-9).map_or("no face", |(axis, _)| axis);
    let impacts = story.events.iter().filter(|event| event.kind.name() == "collision").count();
    story.text = format!(
        "A box, 0.6 x 0.4 x 0.3 m, falls on a floor with mu = 0.4, e = 0.4 (Stronge).\n\n{}\n{}\n{impacts} impacts. The box lies on the face across {face}: its centre is at the height {} m,\n\
         its speeds are {u:?}. A rigid body at rest moves by nothing, not by little.\n\n\
         To see it move: hodograph simulate simulation/models/tumbling_box.mech --until 3 --mu 0.4 --e 0.4 --law stronge --html box.html",
        story::lines(&body, &story.events),
        story::account(&story.energy),
        q[2]
    );
    Ok(story)
}
