//! Places and directions of links, as the formats state them.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Position and orientation of axes relative to other axes.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// its columns are the axes
    pub turn: Matrix3<f64>,
    /// the origin, m
    pub at: Vector3<f64>,
}

impl Pose {
    /// The pose of the axes relative to themselves.
    pub fn identity() -> Self {
        Pose { turn: Matrix3::identity(), at: Vector3::zeros() }
    }

    /// A translation without rotation.
    pub fn place(at: Vector3<f64>) -> Self {
        Pose { at, ..Pose::identity() }
    }

    /// The composition: the pose of `inner`, which is given relative to this pose, relative to the outer
    /// axes.
    pub fn then(&self, inner: &Pose) -> Pose {
        Pose { turn: self.turn * inner.turn, at: self.at + self.turn * inner.at }
    }

    /// The inverse pose.
    pub fn inverse(&self) -> Pose {
        let turn = self.turn.transpose();
        Pose { turn, at: -(turn * self.at) }
    }

    /// Whether it is the identity up to rounding.
    pub fn is_identity(&self) -> bool {
        self.at.amax() < 1e-12 && (self.turn - Matrix3::identity()).amax() < 1e-12
    }

    /// Roll, pitch and yaw, rad. Angles that are zero up to rounding are zero.
    pub fn rpy(&self) -> Vector3<f64> {
        let m = &self.turn;
        let level = m[(0, 0)].hypot(m[(1, 0)]);
        let pitch = (-m[(2, 0)]).atan2(level);
        // at a pitch of a right angle roll and yaw have the same axis
        let (roll, yaw) = match level > 1e-9 {
            true => (m[(2, 1)].atan2(m[(2, 2)]), m[(1, 0)].atan2(m[(0, 0)])),
            false => ((-m[(1, 2)]).atan2(m[(1, 1)]), 0.0),
        };
        Vector3::new(roll, pitch, yaw).map(|angle| if angle.abs() < 1e-15 { 0.0 } else { angle })
    }

    /// The rotation as a quaternion, scalar part first.
    pub fn quaternion(&self) -> [f64; 4] {
        let turn = nalgebra::Rotation3::from_matrix_unchecked(self.turn);
        let q = UnitQuaternion::from_rotation_matrix(&turn);
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        [q.w, q.i, q.j, q.k].map(|part| sign * part)
    }
}

/// The rotation of a quaternion, scalar part first; `None` for the zero quaternion.
pub fn of_quaternion([w, x, y, z]: [f64; 4]) -> Option<Matrix3<f64>> {
    let length = (w * w + x * x + y * y + z * z).sqrt();
    let q = Quaternion::new(w, x, y, z) / length;
    (length > 0.0).then(|| UnitQuaternion::new_unchecked(q).to_rotation_matrix().into_inner())
}

/// Sine and cosine of an angle; exact if the angle is a right angle to 10 digits.
fn sine_cosine(angle: f64) -> (f64, f64) {
    let quarters = angle / std::f64::consts::FRAC_PI_2;
    if (quarters - quarters.round()).abs() > 1e-10 || quarters.abs() > 1e9 {
        return angle.sin_cos();
    }
    [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][(quarters.round() as i64).rem_euclid(4) as usize]
}

/// The matrix of roll, pitch and yaw: its columns are the rotated axes.
pub fn rotation_of(rpy: &Vector3<f64>) -> Matrix3<f64> {
    let [(sr, cr), (sp, cp), (sy, cy)] = [rpy.x, rpy.y, rpy.z].map(sine_cosine);
    let roll = Matrix3::new(1.0, 0.0, 0.0, 0.0, cr, -sr, 0.0, sr, cr);
    let pitch = Matrix3::new(cp, 0.0, sp, 0.0, 1.0, 0.0, -sp, 0.0, cp);
    let yaw = Matrix3::new(cy, -sy, 0.0, sy, cy, 0.0, 0.0, 0.0, 1.0);
    yaw * pitch * roll
}

/// The rotation by an angle about an axis, x (0), y (1) or z (2).
pub fn about(axis: usize, angle: f64) -> Matrix3<f64> {
    let mut rpy = Vector3::zeros();
    rpy[axis] = angle;
    rotation_of(&rpy)
}

/// The smallest rotation that takes z to a direction; `None` for the zero vector.
pub fn along_z(direction: Vector3<f64>) -> Option<Matrix3<f64>> {
    let to = direction.try_normalize(0.0)?;
    let turn = nalgebra::Rotation3::rotation_between(&Vector3::z(), &to);
    Some(turn.map_or_else(|| about(0, std::f64::consts::PI), nalgebra::Rotation3::into_inner))
}
