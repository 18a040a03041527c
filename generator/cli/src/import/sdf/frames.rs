//! The links, joints and frames of a model, whose poses are relative to axes of their choice.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use crate::import::poses::Pose;

/// The axes of the model itself.
pub(super) const MODEL: &str = "__model__";

/// A link, joint or frame.
pub(super) struct Frame {
    /// its place in the file
    pub(super) at: String,
    /// what its pose is relative to
    pub(super) within: String,
    pub(super) pose: Pose,
    /// what it moves with; `None` for a link
    pub(super) attached: Option<String>,
}

/// The links, joints and frames of a model.
#[derive(Default)]
pub(super) struct Frames {
    known: HashMap<String, Frame>,
    /// their names in the order of the file
    order: Vec<String>,
    /// the link that the axes of the model move with
    pub(super) canonical: String,
}

impl Frames {
    /// Records a link, joint or frame; the mistake if there is one of this name.
    pub(super) fn add(&mut self, name: &str, frame: Frame) -> Result<(), String> {
        match self.known.entry(name.to_owned()) {
            Entry::Occupied(_) => Err(format!("{}: a second `{name}`: rename one", frame.at)),
            Entry::Vacant(free) => {
                free.insert(frame);
                self.order.push(name.to_owned());
                Ok(())
            }
        }
    }

    /// The mistakes in what the poses are relative to and what frames move with, each once; such a pose is taken
    /// relative to the model from then on.
    pub(super) fn settle(&mut self) -> Vec<String> {
        let mut problems = Vec::new();
        let mut settled: HashMap<&str, usize> = HashMap::new();
        let mut wrong = Vec::new();
        for (number, name) in self.order.iter().enumerate() {
            let mut here = name.as_str();
            // the walk ends at the model, at what another walk has settled, or where it has been itself
            while here != MODEL {
                match settled.get(here) {
                    Some(&walk) if walk == number => {
                        let at = &self.known[here].at;
                        problems.push(format!(
                            "{at}: the pose of `{here}` is defined by itself: state one of these poses relative to the model"
                        ));
                        wrong.push(here.to_owned());
                        break;
                    }
                    Some(_) => break,
                    None => settled.insert(here, number),
                };
                let frame = &self.known[here];
                if frame.within != MODEL && !self.known.contains_key(&frame.within) {
                    problems.push(self.unknown(&frame.within, &frame.at));
                    wrong.push(here.to_owned());
                    break;
                }
                here = &frame.within;
            }
        }
        for name in wrong {
            if let Some(frame) = self.known.get_mut(&name) {
                MODEL.clone_into(&mut frame.within);
            }
        }
        for problem in self.order.iter().filter_map(|name| self.lost(name)) {
            if !problems.contains(&problem) {
                problems.push(problem);
            }
        }
        problems
    }

    /// The mistake of a frame or joint that moves with something that does not exist.
    fn lost(&self, name: &str) -> Option<String> {
        let frame = &self.known[name];
        let unknown = |to: &&String| *to != MODEL && !self.known.contains_key(*to);
        frame.attached.as_ref().filter(unknown).map(|to| self.unknown(to, &frame.at))
    }

    fn unknown(&self, name: &str, at: &str) -> String {
        let hint = crate::spelling::hint(name, self.order.iter().map(String::as_str));
        format!("{at}: there is no frame, link or joint `{name}`: {hint}")
    }

    /// The pose of a link, joint or frame relative to the model.
    pub(super) fn absolute(&self, name: &str, at: &str) -> Result<Pose, String> {
        let (mut pose, mut name) = (Pose::identity(), name);
        while name != MODEL {
            let frame = self.known.get(name).ok_or_else(|| self.unknown(name, at))?;
            pose = frame.pose.then(&pose);
            name = &frame.within;
        }
        Ok(pose)
    }

    /// The link that a link, joint or frame moves with; an unknown name, and the world, stay.
    pub(super) fn link_of(&self, name: &str) -> String {
        let attached = |name: &str| self.known.get(name).and_then(|frame| frame.attached.as_deref());
        let of_model = |name| if name == MODEL { self.canonical.as_str() } else { name };
        let mut here = of_model(name);
        for _ in 0..=self.order.len() {
            match attached(here) {
                // an unknown name is told where it stands
                Some(next) if next == MODEL || self.known.contains_key(next) => here = of_model(next),
                _ => break,
            }
        }
        here.to_owned()
    }
}
