//! Builds the tree of links and joints, and checks it.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::description::{self, Actuator, Mimic, Robot, long_spring};

/// The motion that a joint allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// none
    Fixed,
    /// about the axis
    Turn,
    /// along the axis
    Slide,
    /// in the plane across the axis
    Planar,
    /// about all axes of one point
    Ball,
    /// freely
    Free,
}

/// A joint.
#[derive(Clone, Debug)]
pub struct Joint {
    /// its name as spelled; `None` for the joint between ground and root
    pub name: Option<String>,
    /// the motion that it allows
    pub motion: Motion,
    /// its origin in the parent link, m
    pub offset: Vector3<f64>,
    /// roll, pitch and yaw of its axes in the parent link, rad
    pub rpy: Vector3<f64>,
    /// unit vector in the joint's axes
    pub axis: Vector3<f64>,
    /// N m s/rad or N s/m
    pub damping: f64,
    /// N m/rad or N/m, and the coordinate at which the spring exerts no force
    pub spring: [f64; 2],
    /// the initial coordinates; empty if all are zero
    pub start: Vec<f64>,
    /// the joint that its coordinate follows
    pub mimics: Option<Mimic>,
    /// its actuators; `None`: the joint has an input of its own
    pub actuators: Option<Vec<Actuator>>,
}

/// A link and the joint that carries it.
#[derive(Clone, Debug)]
pub struct Link {
    /// its name as spelled
    pub name: String,
    /// index of its description in the file
    pub index: usize,
    /// the link that carries it (index into [`Tree::links`], always lower); `None` for the root
    pub parent: Option<usize>,
    /// the joint that carries it
    pub joint: Joint,
}

/// A robot: every link comes after the one that carries it, branch by branch.
#[derive(Clone, Debug)]
pub struct Tree {
    /// the links
    pub links: Vec<Link>,
    /// whether the root has an inertia.
    root_has_inertial: bool,
}

impl Tree {
    /// Decides whether the root is free, if the description does not say so.
    pub fn choose_base(&mut self, floating: Option<bool>, notes: &mut Vec<String>) {
        let root = &mut self.links[0];
        let free = floating.unwrap_or(self.root_has_inertial);
        root.joint.motion = if free { Motion::Free } else { Motion::Fixed };
        if floating.is_none() {
            notes.push(match free {
                true => format!(
                    "the root link `{}` has an inertia and so moves freely; `--base fixed` would fix it to the ground",
                    root.name
                ),
                false => format!(
                    "the root link `{}` has no inertia and so is fixed to the ground; `--base floating` would free it",
                    root.name
                ),
            });
        }
    }
}

/// Builds the tree.
///
/// # Errors
///
/// Everything that prevents a tree, and all joints that cannot be imported.
pub fn build(document: &Robot, notes: &mut Vec<String>) -> Result<Tree, Vec<String>> {
    let mut problems = Vec::new();
    let known = links(document, &mut problems);
    let mut carried_by: HashMap<usize, usize> = HashMap::new();
    let mut carries: Vec<Vec<usize>> = vec![Vec::new(); document.links.len()];
    let mut joints = Vec::new();
    let mut names: HashMap<&str, usize> = HashMap::new();
    for (index, joint) in document.joints.iter().enumerate() {
        let at = &joint.at;
        if let Some(first) = names.insert(&joint.name, index) {
            let first = &document.joints[first].at;
            problems
                .push(format!("{at}: a second joint `{}`; the first is at {first}: rename one", joint.name));
        }
        joints.push(read_joint(joint, at, notes, &mut problems));
        let mut end = |role: &str, name: &str| {
            let found = known.get(name).copied();
            if found.is_none() {
                let hint = crate::spelling::hint(name, known.keys().copied());
                problems.push(format!(
                    "{at}: {role} of joint `{}` is the unknown link `{name}`: {hint}",
                    joint.name
                ));
            }
            found
        };
        let (parent, child) = (end("parent", &joint.parent), end("child", &joint.child));
        let (Some(parent), Some(child)) = (parent, child) else { continue };
        if let Some(&other) = carried_by.get(&child) {
            // two links of one name are told already
            if document.links.iter().filter(|link| link.name == joint.child).count() == 1 {
                problems.push(format!(
                    "{at}: joint `{}` carries link `{}`, which joint `{}` ({}) carries already: links form a tree, so \
                     cut the loop here and close it by constraints in the model",
                    joint.name,
                    joint.child,
                    document.joints[other].name,
                    document.joints[other].at
                ));
            }
            continue;
        }
        carried_by.insert(child, index);
        carries[parent].push(index);
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    mimics(document, &joints)?;
    let root = root(document, &carried_by)?;
    let ground = Joint {
        name: None,
        motion: Motion::Fixed,
        offset: Vector3::zeros(),
        rpy: Vector3::zeros(),
        axis: Vector3::z(),
        damping: 0.0,
        spring: [0.0; 2],
        start: Vec::new(),
        mimics: None,
        actuators: None,
    };
    let mut links = Vec::new();
    let mut reached = vec![false; document.links.len()];
    let mut open = vec![(root, None, ground)];
    while let Some((link, parent, joint)) = open.pop() {
        reached[link] = true;
        let here = links.len();
        links.push(Link { name: document.links[link].name.clone(), index: link, parent, joint });
        for &index in carries[link].iter().rev() {
            let child = known[document.joints[index].child.as_str()];
            open.push((child, Some(here), joints[index].clone()));
        }
    }
    if let Some(lost) = reached.iter().position(|reached| !reached) {
        let name = &document.links[lost].name;
        return Err(vec![format!(
            "{}: link `{name}` is part of a cycle of joints that the root `{}` does not reach: cut the cycle",
            document.links[lost].at, document.links[root].name
        )]);
    }
    Ok(Tree { links, root_has_inertial: document.links[root].inertial.is_some() })
}

/// Checks joints that mimic others.
fn mimics(document: &Robot, joints: &[Joint]) -> Result<(), Vec<String>> {
    let mut problems = Vec::new();
    for (joint, description::Joint { at, name, .. }) in joints.iter().zip(&document.joints) {
        let Some(mimic) = &joint.mimics else { continue };
        let follows = &mimic.joint;
        let mut problem = |message: String| problems.push(format!("{at}: joint `{name}`: {message}"));
        let about_one = |joint: &Joint| matches!(joint.motion, Motion::Turn | Motion::Slide);
        let other = joints.iter().find(|other| other.name.as_ref() == Some(follows));
        match other {
            None => {
                let names = document.joints.iter().map(|joint| joint.name.as_str());
                let hint = crate::spelling::hint(follows, names);
                problem(format!("it mimics the unknown joint `{follows}`: {hint}"));
            }
            Some(other) if other.mimics.is_some() => {
                problem(format!("it mimics `{follows}`, which mimics another: name the one that moves"));
            }
            Some(other) if !about_one(joint) || !about_one(other) => {
                problem(format!("it mimics `{follows}`: both must turn or slide about one axis"));
            }
            Some(_) => {}
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

/// The links by their names, which must differ.
fn links<'a>(document: &'a Robot, problems: &mut Vec<String>) -> HashMap<&'a str, usize> {
    let mut known: HashMap<&str, usize> = HashMap::new();
    for (index, link) in document.links.iter().enumerate() {
        if let Some(first) = known.insert(&link.name, index) {
            let (at, first) = (&link.at, &document.links[first].at);
            problems
                .push(format!("{at}: a second link `{}`; the first is at {first}: rename one", link.name));
        }
    }
    if document.links.is_empty() {
        problems.push(format!("{}: there is no link", document.file));
    }
    known
}

/// The only link without a parent joint.
fn root(document: &Robot, carried_by: &HashMap<usize, usize>) -> Result<usize, Vec<String>> {
    let roots: Vec<usize> = (0..document.links.len()).filter(|link| !carried_by.contains_key(link)).collect();
    match roots[..] {
        [root] => Ok(root),
        [] => Err(vec![format!(
            "{}: the links form a cycle (every one is carried by a joint): one link must be the root",
            document.links[0].at
        )]),
        [first, second, ..] => Err(vec![format!(
            "{}: link `{}` has no parent joint, nor has `{}` ({}): connect all but one",
            document.links[second].at,
            document.links[second].name,
            document.links[first].name,
            document.links[first].at
        )]),
    }
}

fn read_joint(
    joint: &description::Joint,
    at: &str,
    notes: &mut Vec<String>,
    problems: &mut Vec<String>,
) -> Joint {
    let name = &joint.name;
    let mut problem = |message: String| problems.push(format!("{at}: joint `{name}`: {message}"));
    let motion = match joint.kind.as_str() {
        "revolute" | "continuous" => Motion::Turn,
        "prismatic" => Motion::Slide,
        "planar" => Motion::Planar,
        "ball" => Motion::Ball,
        "floating" => Motion::Free,
        // The readers have refused all other types but "fixed".
        _ => Motion::Fixed,
    };
    let description::Joint { offset, rpy, mut axis, mut damping, mut stiffness, .. } = *joint;
    let about_one = matches!(motion, Motion::Turn | Motion::Slide);
    if joint.friction != 0.0 {
        notes.push(format!("{at}: ignored the friction of joint `{name}`: only its damping is linear"));
    }
    if damping < 0.0 {
        problem(format!("its damping is {damping}: give a number that is not negative"));
    }
    for (what, number) in [("damping", &mut damping), ("stiffness", &mut stiffness)] {
        if *number != 0.0 && !about_one {
            notes.push(format!(
                "{at}: ignored the {what} of joint `{name}`, which neither turns nor slides about one axis"
            ));
            *number = 0.0;
        }
    }
    if stiffness != 0.0 && motion == Motion::Slide {
        let long = long_spring(joint.spring_rests_at);
        notes.push(format!(
            "{at}: the spring of joint `{name}` is a long one along its axis, so that it stores energy: it is exact while the \
             coordinate is above -{long} m"
        ));
    }
    for (word, angle) in ["roll", "pitch", "yaw"].into_iter().zip(rpy.iter()) {
        let off = (angle / std::f64::consts::FRAC_PI_2).fract().abs();
        let off = off.min(1.0 - off) * std::f64::consts::FRAC_PI_2;
        if off > 1e-10 && off < 2e-3 {
            notes.push(format!(
                "{at}: the {word} {angle} of joint `{name}` is kept as it is; if a right angle is meant, write pi/2 in the \
                 model: exact right angles make shorter equations"
            ));
        }
    }
    if matches!(motion, Motion::Turn | Motion::Slide | Motion::Planar) {
        let length = axis.norm();
        // Exporters write six digits; a larger deviation is a mistake.
        let is_unit = (length - 1.0).abs() <= 1e-5;
        if !is_unit {
            let [x, y, z] = joint.axis.into();
            let unit = axis / length;
            let advice = match length > 0.0 && length.is_finite() {
                true => format!("for this direction write `{} {} {}`", unit.x, unit.y, unit.z),
                false => "give its direction".to_owned(),
            };
            problem(format!("its axis `{x} {y} {z}` has length {length}, not 1: {advice}"));
        }
        axis /= length;
    }
    Joint {
        name: Some(name.clone()),
        motion,
        offset,
        rpy,
        axis,
        damping,
        spring: [stiffness, joint.spring_rests_at],
        start: joint.start.clone(),
        mimics: joint.mimics.clone(),
        actuators: joint.actuators.clone(),
    }
}
