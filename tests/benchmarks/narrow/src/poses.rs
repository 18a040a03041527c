//! Random poses of the free body near the fixed one.

use hodograph::{Contacts, Distance, State};
use hodograph_random::Random;

use crate::Failure;

/// A place, m, and a quaternion.
pub type Pose = [f64; 7];

/// Poses at which the bodies are apart by up to a tenth of a metre: a direction and a rotation are chosen, and the place
/// along that direction is found by bisection.
pub fn of(pair: &str, machine: &dyn Contacts<f64>, count: usize) -> Result<Vec<Pose>, Failure> {
    let mut random = Random::named(pair);
    let contacts: Vec<usize> = (0..machine.count(hodograph::ComponentKind::Contact)).collect();
    let mut distances = vec![Distance { gap: None, validity: None }; contacts.len()];
    let mut out = Vec::new();
    while out.len() < count {
        let [e0, e1, e2, e3] = random.rotation();
        let along = [0, 1, 2].map(|_| random.number());
        let along = [along[0], along[1], if pair.ends_with("plane") { 1.0 } else { along[2] }];
        let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
        let wanted = random.between(0.0, 0.1);
        let at = |far: f64| -> Pose {
            let [x, y, z] = along.map(|part| part / length * far);
            [x, y, z, e0, e1, e2, e3]
        };
        // bodies that overlap have a negative gap, or none
        let mut gap = |far: f64| -> f64 {
            let pose = at(far);
            let state = State { time: 0.0, coordinates: &pose, speeds: &[0.0; 6], inputs: &[] };
            if machine.gaps(&contacts, &state, &mut distances).is_err() {
                return -1.0;
            }
            distances.iter().filter_map(|distance| distance.gap).fold(f64::INFINITY, f64::min)
        };
        let (mut near, mut far) = (0.0, 3.0);
        for _ in 0..40 {
            let middle = 0.5 * (near + far);
            if gap(middle) > wanted { far = middle } else { near = middle }
        }
        out.push(at(far));
    }
    Ok(out)
}

/// As text: a pose on each line.
pub fn written(poses: &[Pose]) -> String {
    let line = |pose: &Pose| pose.map(|x| format!("{x:e}")).join(" ") + "\n";
    poses.iter().map(line).collect()
}

/// From text.
pub fn read(text: &str) -> Result<Vec<Pose>, Failure> {
    let pose = |line: &str| -> Result<Pose, Failure> {
        let numbers: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        numbers.try_into().map_err(|_| "a pose has seven numbers".into())
    };
    text.lines().map(pose).collect()
}
