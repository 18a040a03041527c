//! The examples tell what they promise.
#![allow(clippy::duplicate_mod)] // each example has the module `story`

#[path = "../examples/biped_landing.rs"]
#[allow(dead_code)]
mod biped_landing;
#[path = "../examples/hopper_control.rs"]
#[allow(dead_code)]
mod hopper_control;
#[path = "../examples/juggling/main.rs"]
#[allow(dead_code)]
mod juggling;
#[path = "../examples/painleve_rod.rs"]
#[allow(dead_code)]
mod painleve_rod;
#[path = "../examples/rattleback.rs"]
#[allow(dead_code)]
mod rattleback;
#[path = "../examples/tumbling_box.rs"]
#[allow(dead_code)]
mod tumbling_box;

/// The times of events of a name.
macro_rules! times {
    ($story:expr, $name:expr) => {
        $story
            .events
            .iter()
            .filter(|event| event.kind.name() == $name)
            .map(|event| event.time)
            .collect::<Vec<f64>>()
    };
}

#[test]
fn the_box_comes_to_rest_on_a_face() {
    let story = tumbling_box::tell().unwrap();
    assert_eq!(times!(story, "rest").len(), 1);
    assert_eq!(story.end.1, [0.0; 6]);
    assert!([0.3, 0.2, 0.15].iter().any(|half| (story.end.0[2] - half).abs() < 1e-9), "{}", story.text);
    let [before, after] = story.energy;
    let off = after.total().unwrap() - before.total().unwrap() - after.impacts - after.friction;
    assert!(off.abs() < 1e-9 && after.impacts < -1.0, "{}", story.text);
    assert!(story.text.contains("lies on the face across B."), "{}", story.text);
    let picture = story.picture.svg();
    assert!(picture.starts_with("<svg ") && picture.contains("polyline") && !picture.contains("NaN"));
}

#[test]
fn the_rattleback_reverses() {
    let story = rattleback::tell().unwrap();
    assert!(!times!(story, "zero").is_empty(), "{}", story.text);
    // It began with -5 rad/s.
    assert!(story.end.1[2] > 1.0, "{}", story.text);
    let [before, after] = story.energy;
    assert!((after.total().unwrap() - before.total().unwrap()).abs() < 1e-10, "{}", story.text);
}

#[test]
fn the_rod_jumps() {
    let story = painleve_rod::tell().unwrap();
    assert_eq!(times!(story, "impact_without_collision"), [0.0], "{}", story.text);
    assert_eq!(times!(story, "rest").len(), 1, "{}", story.text);
    assert!(story.text.contains("none: impact_without_collision"), "{}", story.text);
    assert!(story.energy[1].impacts < 0.0);
}

#[test]
fn the_biped_lands_and_rests() {
    let story = biped_landing::tell().unwrap();
    assert_eq!(times!(story, "rest").len(), 1, "{}", story.text);
    assert_eq!(story.end.1, [0.0; 9]);
    // Its weight stands on its feet, and its hips where the springs hold them.
    let weight: f64 = story
        .text
        .split(" N)")
        .filter_map(|part| part.rsplit_once('(').and_then(|(_, number)| number.parse::<f64>().ok()))
        .sum();
    assert!((weight - 16.0 * 9.81).abs() < 0.05, "{weight} {}", story.text);
    assert!(story.end.0[1] > 0.6 && story.end.0[1] < 0.75, "{}", story.text);
}

#[test]
fn the_hopper_reaches_the_heights() {
    let story = hopper_control::tell().unwrap();
    let top = |from: f64, to: f64| {
        let tops: Vec<f64> = story
            .events
            .iter()
            .filter(|event| event.kind.name() == "zero" && event.time > from && event.time < to)
            .map(|event| event.coordinates[1])
            .collect();
        tops.into_iter().fold(0.0, f64::max)
    };
    for (from, to, height) in [(5.0, 6.0, 1.0), (12.0, 13.0, 1.3), (19.0, 20.0, 0.9)] {
        assert!((top(from, to) - height).abs() < 0.02, "{} {height}\n{}", top(from, to), story.text);
    }
}

/// The tops of the ball's flight: time, height, distance from the middle.
fn tops(events: &[hodograph_simulation::Event]) -> Vec<[f64; 3]> {
    let zero =
        |event: &&hodograph_simulation::Event| matches!(event.kind, hodograph_simulation::EventKind::Zero(_));
    let top = |event: &hodograph_simulation::Event| {
        let q = &event.coordinates;
        [event.time, q[5], q[3].hypot(q[4])]
    };
    events.iter().filter(zero).map(top).collect()
}

#[test]
fn the_juggler_reaches_the_heights_that_are_asked_for() {
    let story = juggling::tell().unwrap();
    let tops = tops(&story.events);
    assert!(tops.len() > 16, "{}", story.text);
    for [time, height, beside] in tops {
        // From the third bounce on it knows the restitution; the first top after another height is asked for
        // belongs to the one before.
        if time > 2.0 && (time % 4.0) > 0.85 {
            let asked = juggling::trial::command(time);
            assert!((height - asked).abs() < 0.05 * asked && beside < 1e-3, "{time} {height} {beside}");
        }
    }
}

#[test]
fn the_juggler_in_firmware_moves_as_the_simulated_one() {
    let story = juggling::tell().unwrap();
    let simulated: Vec<[f64; 3]> = tops(&story.events).into_iter().filter(|top| top[0] > 0.1).collect();
    let (parameters, surface) = juggling::trial::truth();
    let (coordinates, speeds) = juggling::trial::start();
    let juggler = juggling::juggler::Juggler::new(parameters).unwrap();
    let mut plant = juggling::plant::Plant { juggler, surface, coordinates, speeds };
    let mut control = juggling::trial::control::<f64>();
    let mut highest: Vec<f64> = Vec::new();
    for sample in 0..(1e3 * juggling::trial::UNTIL) as usize {
        let time = 1e-3 * sample as f64;
        let inputs = control.act(&plant.coordinates, &plant.speeds, juggling::trial::command(time));
        let before = plant.speeds.uz;
        plant.advance(&inputs, 1e-3).unwrap();
        if sample > 100 && before > 0.0 && plant.speeds.uz <= 0.0 {
            // Half a millisecond from the top it lacks g t^2 / 2 = 5e-6 m at most.
            highest.push(plant.coordinates.z + plant.speeds.uz.powi(2) / (2.0 * 9.81));
        }
    }
    assert_eq!(highest.len(), simulated.len());
    for (plant, [time, height, _]) in highest.iter().zip(&simulated) {
        assert!((plant - height).abs() < 1e-6, "{time}: {plant} {height}");
    }
}
