//! Writes the solids of links as shapes, and contacts of their origins.

use super::{LinkFrame, Writer, comment};
use crate::import::collision::{Collision, Solid};
use crate::import::description::Robot;
use crate::import::formulas::rotation;

impl Writer<'_> {
    /// Writes the shape of a solid of a link.
    pub(super) fn shape(&mut self, here: usize, collision: &Collision) {
        let link = &self.tree.links[here];
        let group = self.groups.of_link[here];
        let LinkFrame { axes, origin } = self.called[here].clone();
        let name = self.names.give(&format!("{}_shape", link.name));
        let at = match self.offset(["sx", "sy", "sz"], &name, &collision.offset, &axes) {
            None => origin,
            Some(offset) => format!("{origin} + {offset}"),
        };
        let own = match (collision.solid, rotation(&collision.rpy)) {
            (Solid::Sphere(_), _) | (_, None) => axes.clone(),
            (_, Some(turn)) => self.frame(&format!("{name}_axes"), &axes, &turn),
        };
        let mut length =
            |letter: &str, value: f64| self.parameter(&format!("{letter}_{name}"), "m", value, "");
        let solid = match collision.solid {
            Solid::Sphere(r) => format!("sphere: {}", length("r", r)),
            Solid::Cylinder([r, l]) => {
                format!("cylinder: [{}, {}], axis: {own}.z", length("r", r), length("l", l))
            }
            Solid::Capsule([r, l]) => {
                format!("capsule: [{}, {}], axis: {own}.z", length("r", r), length("l", l))
            }
            Solid::Ellipsoid([a, b, c]) => {
                format!(
                    "ellipsoid: [{}, {}, {}], axes: {own}",
                    length("a", a),
                    length("b", b),
                    length("c", c)
                )
            }
            Solid::Plane => format!("plane: {own}.z"),
            Solid::Box([a, b, c]) => {
                format!("box: [{}, {}, {}], axes: {own}", length("a", a), length("b", b), length("c", c))
            }
        };
        let group = &self.groups.groups[group];
        let rigid = group.properties.as_ref().is_some_and(|properties| {
            let i = &properties.inertia;
            i.iter().any(|&number| number != 0.0)
        });
        let of = match &self.bodies[self.groups.of_link[here]] {
            _ if group.ground => String::new(),
            Some(body) if rigid => format!("of: {body}, "),
            _ => format!("of: {axes}, "),
        };
        self.out.shapes.push(format!("{name} {{ {of}at: {at}, {solid} }},"));
    }

    /// Writes the contact of the own origin of a link.
    pub(super) fn contact(&mut self, wanted: &str, document: &Robot, problems: &mut Vec<String>) {
        let links = &self.tree.links;
        let called = |name: &str| links.iter().position(|link| link.name == name);
        let own = |link: usize| {
            let frame = document.links[links[link].index].frame.as_ref();
            frame.and_then(|frame| called(frame)).unwrap_or(link)
        };
        let Some(here) = called(wanted).map(own) else {
            let hint = crate::spelling::hint(wanted, links.iter().map(|link| link.name.as_str()));
            problems.push(format!("--contact {wanted}: there is no such link: {hint}"));
            return;
        };
        let group = self.groups.of_link[here];
        if self.groups.groups[group].ground {
            problems
                .push(format!("--contact {wanted}: this link is fixed to the ground and strikes nothing"));
            return;
        }
        let origin = self.called[here].origin.clone();
        let of = match (&self.bodies[group], &self.groups.groups[group].properties) {
            (Some(body), Some(properties)) if properties.inertia.amax() > 0.0 => format!(" of {body}"),
            _ => String::new(),
        };
        let name = self.names.give(&format!("contact_{wanted}"));
        let above = comment(&format!("the origin of link `{wanted}` strikes the plane through O across N.z"));
        self.out.contacts.push(format!(
            "{above}\n    {name} {{ point: {origin}{of}, \
             normal: N.z, gap: dot(position({origin}), N.z) }},"
        ));
    }
}
