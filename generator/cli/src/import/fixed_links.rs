//! Combines links that are fixed to each other into one body.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::description::{Inertial, Robot};
use super::poses::rotation_of;
use super::symmetric::symmetric;
use super::tree::{Motion, Tree};

/// The inertia of a body.
#[derive(Clone, Debug)]
pub struct MassProperties {
    /// kg
    pub mass: f64,
    /// mass centre in the axes of the link, from its origin, m
    pub centre: Vector3<f64>,
    /// central inertia matrix in the axes of the link, kg m^2
    pub inertia: Matrix3<f64>,
}

impl MassProperties {
    /// The reason why no body can have this inertia, if it is impossible.
    fn fault(&self) -> Option<String> {
        if self.mass <= 0.0 {
            return Some("its mass is 0, but its inertia is not: give a mass".to_owned());
        }
        if !self.inertia.iter().chain(self.centre.iter()).all(|number| number.is_finite()) {
            return Some("its inertia is too large a number".to_owned());
        }
        let principal = self.inertia.symmetric_eigenvalues();
        let (least, total) = (principal.min(), principal.sum());
        let slack = 1e-9 * total.abs().max(self.inertia.amax());
        let moments = principal.as_slice();
        if least < -slack {
            Some(format!(
                "no body has the principal moments of inertia {moments:?}: none may be negative; correct its <inertia>"
            ))
        } else if 2.0 * principal.max() > total + slack {
            Some(format!(
                "no body has the principal moments of inertia {moments:?}: the largest may be at most {}, the sum of the \
                 others; correct its <inertia>",
                total - principal.max()
            ))
        } else {
            None
        }
    }
}

/// A moving link, with all links fixed to it.
#[derive(Clone, Debug)]
pub struct Group {
    /// the link that gives the group its name and axes (index into `Tree::links`)
    pub link: usize,
    /// the links fixed to that link
    pub fixed: Vec<usize>,
    /// its inertia; `None`: it has no inertia, or is the ground
    pub properties: Option<MassProperties>,
    /// whether it is the ground.
    pub ground: bool,
}

/// The groups of a robot in the order of their links, and the group of each link.
#[derive(Clone, Debug)]
pub struct Groups {
    /// the groups
    pub groups: Vec<Group>,
    /// index into `groups`, per link
    pub of_link: Vec<usize>,
}

/// Forms the groups.
///
/// # Errors
///
/// Impossible inertias, and links that would move without inertia.
pub fn combined(tree: &Tree, document: &Robot, notes: &mut Vec<String>) -> Result<Groups, Vec<String>> {
    let mut problems = Vec::new();
    let mut groups: Vec<Group> = Vec::new();
    let mut of_link = Vec::new();
    let mut poses: Vec<(Matrix3<f64>, Vector3<f64>)> = Vec::new();
    let mut parts: Vec<Vec<MassProperties>> = Vec::new();
    let mut faulty: Vec<bool> = Vec::new();
    for (here, link) in tree.links.iter().enumerate() {
        let fixed_to = match link.joint.motion {
            Motion::Fixed => link.parent,
            _ => None,
        };
        let (group, pose) = match fixed_to {
            Some(parent) => {
                let (axes, origin) = poses[parent];
                let group: usize = of_link[parent];
                groups[group].fixed.push(here);
                (group, (axes * rotation_of(&link.joint.rpy), origin + axes * link.joint.offset))
            }
            None => {
                let ground = link.joint.motion == Motion::Fixed;
                groups.push(Group { link: here, fixed: Vec::new(), properties: None, ground });
                parts.push(Vec::new());
                faulty.push(false);
                (groups.len() - 1, (Matrix3::identity(), Vector3::zeros()))
            }
        };
        of_link.push(group);
        poses.push(pose);
        let before = problems.len();
        let part = read_inertial(tree, here, document, notes, &mut problems);
        faulty[group] |= problems.len() > before;
        if let Some(part) = part {
            match groups[group].ground {
                true => notes.push(format!(
                    "{}: ignored the inertia of link `{}`, which is fixed to the ground",
                    document.links[link.index].at, link.name
                )),
                false => parts[group].push(in_axes_of_group(&part, &pose)),
            }
        }
    }
    for (group, parts) in groups.iter_mut().zip(&parts) {
        group.properties = combined_parts(parts);
    }
    let largest = groups
        .iter()
        .flat_map(|group| &group.properties)
        .map(|properties| properties.inertia.amax())
        .fold(0.0, f64::max);
    for (group, parts) in groups.iter_mut().zip(&parts) {
        let link = &tree.links[group.link];
        if let Some(properties) = group.properties.as_mut().filter(|all| is_rounding(all, parts, largest)) {
            if parts.iter().any(|part| part.inertia != Matrix3::zeros()) {
                notes.push(format!(
                    "{}: the inertia of link `{}` is so small that only rounding can have left it: taken as a particle",
                    document.links[link.index].at, link.name
                ));
            }
            properties.inertia = Matrix3::zeros();
        }
        // Files often have odd numbers for small fixed parts; only the combined body matters.
        if let Some(fault) = group.properties.as_ref().and_then(MassProperties::fault) {
            let with = if group.fixed.is_empty() { "" } else { " with what is fixed to it" };
            problems.push(format!("{}: link `{}`{with}: {fault}", document.links[link.index].at, link.name));
        }
    }
    for (index, group) in groups.iter().enumerate() {
        if group.properties.is_some() || group.ground || faulty[index] {
            continue;
        }
        let link = &tree.links[group.link];
        let place = &document.links[link.index].at;
        let carries_more = tree.links.iter().enumerate().any(|(other, link)| {
            link.parent.is_some_and(|parent| of_link[parent] == index) && of_link[other] != index
        });
        match carries_more {
            true => notes.push(format!("{place}: link `{}` moves, but has no inertia of its own", link.name)),
            false => problems.push(format!(
                "{place}: link `{}` moves, but neither it nor what is fixed to it has a mass: give it an <inertial>, \
                 or make its joint fixed",
                link.name
            )),
        }
    }
    if groups.iter().all(|group| group.ground) {
        problems.push(format!("{}: nothing moves: there is no joint but fixed ones", document.file));
    }
    if problems.is_empty() { Ok(Groups { groups, of_link }) } else { Err(problems) }
}

/// The inertia of a link in its own axes, if it has one.
fn read_inertial(
    tree: &Tree,
    here: usize,
    document: &Robot,
    notes: &mut Vec<String>,
    problems: &mut Vec<String>,
) -> Option<MassProperties> {
    let link = &tree.links[here];
    let place = &document.links[link.index].at;
    let Inertial { mass, centre, rpy, inertia } = document.links[link.index].inertial.as_ref()?;
    let (mass, centre) = (*mass, *centre);
    let mut problem = |message: String| {
        problems.push(format!("{place}: link `{}`: {message}", link.name));
        None
    };
    if mass < 0.0 {
        return problem(format!("its mass is {mass}: give a positive one"));
    }
    if mass == 0.0 && inertia.iter().all(|&number| number == 0.0) {
        notes.push(format!("{place}: link `{}` has mass 0: taken as massless", link.name));
        return None;
    }
    let turn = rotation_of(rpy);
    Some(MassProperties { mass, centre, inertia: symmetric(&(turn * inertia * turn.transpose())) })
}

/// The inertia with respect to the axes of the group.
fn in_axes_of_group(part: &MassProperties, (axes, origin): &(Matrix3<f64>, Vector3<f64>)) -> MassProperties {
    MassProperties {
        mass: part.mass,
        centre: origin + axes * part.centre,
        inertia: symmetric(&(axes * part.inertia * axes.transpose())),
    }
}

/// The inertia of all parts as one body, by the parallel-axis theorem.
fn combined_parts(parts: &[MassProperties]) -> Option<MassProperties> {
    if let [only] = parts {
        return Some(only.clone());
    }
    if parts.is_empty() {
        return None;
    }
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    if mass <= 0.0 {
        return parts.first().cloned();
    }
    let centre = parts.iter().map(|part| part.centre * part.mass).sum::<Vector3<f64>>() / mass;
    let inertia: Matrix3<f64> = parts
        .iter()
        .map(|part| {
            let arm = part.centre - centre;
            part.inertia + (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * part.mass
        })
        .sum();
    Some(MassProperties { mass, centre, inertia: symmetric(&inertia) })
}

/// Whether an inertia is what rounding leaves of none: next to nothing beside the mass at its distance from the
/// origin, or impossible and next to nothing beside the largest inertia of the robot.
fn is_rounding(whole: &MassProperties, parts: &[MassProperties], largest: f64) -> bool {
    let size = whole.inertia.amax();
    let at_distance: f64 = parts.iter().map(|part| part.mass.abs() * part.centre.norm_squared()).sum();
    size > 0.0 && (size <= 1e-15 * at_distance || (size <= 1e-12 * largest && whole.fault().is_some()))
}

/// Two unit vectors perpendicular to a third, right-handed: for x they are y and z, and so on cyclically.
pub fn perpendicular(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    for (index, unit) in [Vector3::x(), Vector3::y(), Vector3::z()].iter().enumerate() {
        if (axis - unit).norm() < 1e-12 {
            let round = [Vector3::y(), Vector3::z(), Vector3::x()];
            return [round[index], round[(index + 1) % 3]];
        }
    }
    let turn = Rotation3::rotation_between(&Vector3::z(), axis)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    [turn * Vector3::x(), turn * Vector3::y()]
}
