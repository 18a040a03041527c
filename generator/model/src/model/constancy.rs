//! Which gravity and which springs are the same wherever the mechanism is.

use super::mechanism::*;

/// Whether the load is gravity or a spring, with coefficients (acceleration; stiffness, length or rest) that
/// depend on nothing but parameters and time. Without stiffness it does not matter where a spring is slack.
pub fn has_constant_coefficients(m: &Mechanism, load: &LoadKind) -> bool {
    let constancy = &mut Constancy { m, definitions: vec![None; m.definitions.len()] };
    match load {
        LoadKind::Gravity(vector) => constancy.vector(vector),
        LoadKind::Spring { stiffness, length: rest, .. } | LoadKind::Torsion { stiffness, rest, .. } => {
            is_zero(stiffness) || constancy.scalar(stiffness) && constancy.scalar(rest)
        }
        LoadKind::Force { .. } | LoadKind::Torque { .. } => false,
    }
}

/// Whether it is the number 0, as a stiffness that is left out.
pub fn is_zero(scalar: &Scalar) -> bool {
    matches!(scalar, Scalar::Number(number) if number.is_zero())
}

/// Which expressions depend on neither coordinates, speeds nor inputs: of vectors, as seen in N.
struct Constancy<'m> {
    m: &'m Mechanism,
    definitions: Vec<Option<bool>>,
}

impl Constancy<'_> {
    fn scalar(&mut self, scalar: &Scalar) -> bool {
        match scalar {
            Scalar::Number(_) | Scalar::Pi | Scalar::Time | Scalar::Parameter(_) => true,
            Scalar::Input(_) | Scalar::Coordinate(_) | Scalar::Speed(_) => false,
            Scalar::Definition(id) => self.definition(*id),
            Scalar::Rate(inner) | Scalar::Neg(inner) => self.scalar(inner),
            Scalar::Add(parts) | Scalar::Mul(parts) | Scalar::Call(_, parts) => {
                parts.iter().all(|part| self.scalar(part))
            }
            Scalar::Div(a, b, _) | Scalar::Pow(a, b) => self.scalar(a) && self.scalar(b),
            Scalar::Dot(a, b) => self.vector(a) && self.vector(b),
            Scalar::Norm(v) => self.vector(v),
        }
    }

    fn vector(&mut self, vector: &Vector) -> bool {
        match vector {
            Vector::Zero => true,
            Vector::Components(frame, components) => {
                let along = components.each_ref().map(|component| !is_zero(component));
                components.iter().all(|component| self.scalar(component)) && self.directions(*frame, along)
            }
            Vector::Definition(id) => self.definition(*id),
            Vector::Neg(inner) | Vector::Unit(inner, _) => self.vector(inner),
            Vector::Add(parts) => parts.iter().all(|part| self.vector(part)),
            Vector::Scale(factor, inner) => self.scalar(factor) && self.vector(inner),
            Vector::Cross(a, b) => self.vector(a) && self.vector(b),
            Vector::Position { of, from } => of == from || self.place(*of) && self.place(*from),
            Vector::Velocity(_) | Vector::AngularVelocity { .. } => false,
        }
    }

    fn definition(&mut self, id: DefinitionId) -> bool {
        if let Some(known) = self.definitions[id.0] {
            return known;
        }
        let m = self.m;
        let constant = match &m.definitions[id.0].value {
            DefinitionValue::Scalar(scalar) => self.scalar(scalar),
            DefinitionValue::Vector(vector) => self.vector(vector),
        };
        self.definitions[id.0] = Some(constant);
        constant
    }

    /// Those of the axes of a frame along which there is something.
    fn directions(&mut self, frame: FrameId, mut along: [bool; 3]) -> bool {
        let m = self.m;
        let mut at = frame;
        while let (true, Some(parent)) = (along.contains(&true), m.frames[at.0].parent) {
            match &m.frames[at.0].orientation {
                Orientation::Aligned => {}
                // the axis of the rotation is an axis of the parent
                Orientation::Simple { axis, .. } if (0..3).all(|i| i == *axis as usize || !along[i]) => {}
                orientation if self.orientation(orientation) => along = [true; 3],
                _ => return false,
            }
            at = parent;
        }
        true
    }

    fn orientation(&mut self, orientation: &Orientation) -> bool {
        match orientation {
            Orientation::Aligned => true,
            Orientation::Simple { angle, .. } => self.scalar(angle),
            Orientation::About { axis, angle } => {
                self.scalar(angle) && axis.iter().all(|component| self.scalar(component))
            }
            Orientation::Euler { angles, .. } => angles.iter().all(|angle| self.scalar(angle)),
            Orientation::Quaternion(_) | Orientation::Spin(_) => false,
        }
    }

    /// The position of a point from O.
    fn place(&mut self, point: PointId) -> bool {
        let m = self.m;
        let mut at = point;
        loop {
            match &m.points[at.0].place {
                Place::Origin => return true,
                Place::Velocity(_) => return false,
                Place::Offset { from, by } | Place::Material { from, by, .. } => {
                    if !self.vector(by) {
                        return false;
                    }
                    at = *from;
                }
            }
        }
    }
}
