//! Elements of MJCF with the default values of their classes.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

use crate::import::poses::{self, Pose};

/// The values of attributes.
type Values = BTreeMap<String, String>;

/// The default values of each class.
#[derive(Default)]
pub struct Defaults(BTreeMap<String, Class>);

/// Largest depth of nested defaults.
const MAX_DEPTH: usize = 200;

/// The default values of a class.
#[derive(Clone, Default)]
struct Class {
    /// by the names of elements
    values: BTreeMap<String, Values>,
    /// the defaults of actuators, each with its name: those of the outermost class first, those of this class
    /// last
    actuators: Vec<Vec<(String, Values)>>,
}

/// The kinds of actuators.
const ACTUATORS: [&str; 9] =
    ["general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion"];

/// The attributes that actuators of all kinds have, and share their defaults of.
const OF_ALL_ACTUATORS: [&str; 14] = [
    "group",
    "ctrllimited",
    "forcelimited",
    "actlimited",
    "ctrlrange",
    "forcerange",
    "actrange",
    "lengthrange",
    "gear",
    "cranklength",
    "user",
    "actdim",
    "actearly",
    "delay",
];

impl Defaults {
    /// Reads a `<default>` and those inside it, which inherit its values; `at` returns the place of an
    /// element.
    ///
    /// # Errors
    ///
    /// Defaults are nested too deep.
    pub fn read(&mut self, node: Node, at: &dyn Fn(Node) -> String) -> Result<(), String> {
        self.read_in(node, None, 1, at)
    }

    fn read_in(
        &mut self,
        node: Node,
        outer: Option<&str>,
        depth: usize,
        at: &dyn Fn(Node) -> String,
    ) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err(format!(
                "{}: defaults are nested more than {MAX_DEPTH} deep: name them side by side",
                at(node)
            ));
        }
        let class = node.attribute("class").unwrap_or("main").to_owned();
        let mut all = self.0.get(outer.unwrap_or(&class)).cloned().unwrap_or_default();
        if outer.is_some() || all.actuators.is_empty() {
            all.actuators.push(Vec::new());
        }
        for element in node.children().filter(Node::is_element) {
            let name = element.tag_name().name();
            if ACTUATORS.contains(&name) {
                all.actuators
                    .last_mut()
                    .expect("a level of this class")
                    .push((name.to_owned(), stated(element)));
                let (shared, own): (Values, Values) = stated(element)
                    .into_iter()
                    .partition(|(name, _)| OF_ALL_ACTUATORS.contains(&name.as_str()));
                ACTUATORS.iter().for_each(|kind| all.add(kind, shared.clone()));
                all.add(name, own);
            } else if name != "default" {
                all.add(name, stated(element));
            }
        }
        self.0.insert(class.clone(), all);
        for inner in node.children().filter(|part| part.tag_name().name() == "default") {
            self.read_in(inner, Some(&class), depth + 1, at)?;
        }
        Ok(())
    }

    /// An element of a class; its own attribute `class` takes precedence.
    ///
    /// # Errors
    ///
    /// The class does not exist.
    pub fn element(&self, node: Node, class: &str, at: String) -> Result<Element, String> {
        let name = node.tag_name().name();
        let class = node.attribute("class").unwrap_or(class);
        let given = self.0.get(class);
        if given.is_none() && class != "main" {
            return Err(format!("{at}: there is no <default class=\"{class}\">"));
        }
        let mut values = given.and_then(|given| given.values.get(name)).cloned().unwrap_or_default();
        set(&mut values, stated(node));
        Ok(Element::of(at, name, values))
    }

    /// The defaults of actuators of the classes from the outermost to that of the actuator, and last the
    /// actuator with its own attributes alone.
    pub fn of_actuator(&self, node: Node, at: &str) -> Vec<Vec<Element>> {
        let class = self.0.get(node.attribute("class").unwrap_or("main"));
        let defaults = class.iter().flat_map(|class| class.actuators.iter().cloned());
        let own = vec![(node.tag_name().name().to_owned(), stated(node))];
        let elements = |level: Vec<(String, Values)>| {
            level.into_iter().map(|(kind, values)| Element::of(at.to_owned(), &kind, values)).collect()
        };
        defaults.chain([own]).map(elements).collect()
    }
}

impl Class {
    fn add(&mut self, kind: &str, values: Values) {
        set(self.values.entry(kind.to_owned()).or_default(), values);
    }
}

/// The attributes that state an orientation, of which an element has one.
const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Sets attributes over those of a class: an orientation takes the place of one in any form, and a `size`
/// with fewer numbers leaves the others as they are.
fn set(values: &mut Values, own: Values) {
    if ORIENTATIONS.iter().any(|name| own.contains_key(*name)) {
        ORIENTATIONS.iter().for_each(|name| drop(values.remove(*name)));
    }
    let size = values.get("size").cloned().unwrap_or_default();
    values.extend(own);
    if let Some(own) = values.get_mut("size") {
        let rest: Vec<&str> = size.split_whitespace().skip(own.split_whitespace().count()).collect();
        if !rest.is_empty() {
            *own = format!("{own} {}", rest.join(" "));
        }
    }
}

/// The attributes of an element.
fn stated(node: Node) -> Values {
    node.attributes().map(|a| (a.name().to_owned(), a.value().to_owned())).collect()
}

/// An element.
pub struct Element {
    /// its place in the file
    pub at: String,
    /// its name, as `geom`
    pub kind: String,
    values: Values,
    /// the attributes that were read
    known: RefCell<BTreeSet<String>>,
}

impl Element {
    fn of(at: String, kind: &str, values: Values) -> Self {
        let known = RefCell::new(BTreeSet::from(["class".to_owned(), "name".to_owned()]));
        Element { at, kind: kind.to_owned(), values, known }
    }

    /// Takes the attributes that another one of this kind has read as read.
    pub fn read_like(&self, other: &Element) {
        if self.kind == other.kind {
            self.known.borrow_mut().extend(other.known.borrow().iter().cloned());
        }
    }

    /// The value of an attribute.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.known.borrow_mut().insert(name.to_owned());
        self.values.get(name).map(String::as_str)
    }

    /// Whether it has no attribute of this name, or one with this value.
    pub fn is_or_lacks(&self, name: &str, value: &str) -> bool {
        self.text(name).is_none_or(|text| text == value)
    }

    /// The attributes that were never read.
    pub fn unknown(&self) -> Vec<String> {
        let known = self.known.borrow();
        self.values.keys().filter(|name| !known.contains(*name)).cloned().collect()
    }

    /// A sentence about this element.
    pub fn wrong(&self, message: &str) -> String {
        let name = self.values.get("name").map_or(String::new(), |name| format!(" `{name}`"));
        format!("{}: <{}>{name}: {message}", self.at, self.kind)
    }

    /// All numbers of an attribute.
    ///
    /// # Errors
    ///
    /// A part of the attribute is not a finite number.
    pub fn list(&self, name: &str) -> Result<Option<Vec<f64>>, String> {
        let Some(text) = self.text(name) else { return Ok(None) };
        let read: Option<Vec<f64>> = text
            .split_whitespace()
            .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        let wrong =
            || self.wrong(&format!("`{name}=\"{text}\"`: write finite numbers with spaces between them"));
        read.map(Some).ok_or_else(wrong)
    }

    /// A fixed number of numbers.
    ///
    /// # Errors
    ///
    /// Those of [`Element::list`]; or the count is another.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, String> {
        let Some(list) = self.list(name)? else { return Ok(None) };
        let count = list.len();
        let wrong = |_| self.wrong(&format!("`{name}` has {count} numbers, not {N}"));
        list.try_into().map(Some).map_err(wrong)
    }

    /// A number.
    ///
    /// # Errors
    ///
    /// Those of [`Element::numbers`].
    pub fn number(&self, name: &str, default: f64) -> Result<f64, String> {
        Ok(self.numbers::<1>(name)?.map_or(default, |[number]| number))
    }

    /// A number that is not negative.
    ///
    /// # Errors
    ///
    /// Those of [`Element::numbers`]; or the number is negative.
    pub fn amount(&self, name: &str, default: f64) -> Result<f64, String> {
        let number = self.number(name, default)?;
        if number >= 0.0 { Ok(number) } else { Err(self.wrong(&format!("`{name}` is negative"))) }
    }
}

/// How angles are stated, according to `<compiler>`.
pub struct Angles {
    /// whether they are in degrees
    pub degrees: bool,
    /// the axes of Euler angles; small letters for axes that rotate with the body
    pub sequence: String,
}

impl Angles {
    /// An angle, rad.
    pub fn radians(&self, angle: f64) -> f64 {
        if self.degrees { angle.to_radians() } else { angle }
    }

    /// Whether an element states an orientation.
    pub fn turns(&self, element: &Element) -> bool {
        ORIENTATIONS.iter().any(|name| element.text(name).is_some())
    }

    /// The pose of an element in its body.
    ///
    /// # Errors
    ///
    /// The mistake in the numbers.
    pub fn pose(&self, element: &Element) -> Result<Pose, String> {
        let at = element.numbers::<3>("pos")?.map_or(Vector3::zeros(), Vector3::from);
        Ok(Pose { turn: self.turn(element)?, at })
    }

    fn turn(&self, element: &Element) -> Result<Matrix3<f64>, String> {
        if ORIENTATIONS.map(|name| element.text(name).is_some()).into_iter().filter(|given| *given).count()
            > 1
        {
            return Err(element.wrong("its orientation is stated twice: keep one"));
        }
        let zero = || element.wrong("its orientation has a direction of length 0");
        if let Some(quaternion) = element.numbers::<4>("quat")? {
            return poses::of_quaternion(quaternion).ok_or_else(zero);
        }
        if let Some([x, y, z, angle]) = element.numbers::<4>("axisangle")? {
            let axis = Vector3::new(x, y, z).try_normalize(0.0).ok_or_else(zero)?;
            let half = 0.5 * self.radians(angle);
            let [x, y, z] = (axis * half.sin()).into();
            return poses::of_quaternion([half.cos(), x, y, z]).ok_or_else(zero);
        }
        if let Some(angles) = element.numbers::<3>("euler")? {
            let mut turn = Matrix3::identity();
            for (letter, angle) in self.sequence.chars().zip(angles) {
                let axis = match letter.to_ascii_lowercase() {
                    'x' => 0,
                    'y' => 1,
                    _ => 2,
                };
                let next = poses::about(axis, self.radians(angle));
                turn = if letter.is_ascii_lowercase() { turn * next } else { next * turn };
            }
            return Ok(turn);
        }
        if let Some([a, b, c, d, e, f]) = element.numbers::<6>("xyaxes")? {
            let x = Vector3::new(a, b, c).try_normalize(0.0).ok_or_else(zero)?;
            let y = Vector3::new(d, e, f);
            let y = (y - x * x.dot(&y)).try_normalize(0.0).ok_or_else(zero)?;
            return Ok(Matrix3::from_columns(&[x, y, x.cross(&y)]));
        }
        if let Some(axis) = element.numbers::<3>("zaxis")? {
            return poses::along_z(Vector3::from(axis)).ok_or_else(zero);
        }
        Ok(Matrix3::identity())
    }
}
