//! What a derivation delivers: named quantities, each an array of nodes.

use super::graph::{Graph, Node};
use crate::interpret::Inputs;

/// A quantity that a program computes. Shapes: `p` independent speeds, `d` dependent speeds, `n` coordinates, `c` configuration
/// equations (as many as dependent coordinates). Matrices are stored by rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// q' (n)
    CoordinateRates,
    /// dependent speeds (d)
    DependentSpeeds,
    /// M (p x p), all entries
    MassMatrix,
    /// forcing (p): M u' = forcing
    Forcing,
    /// u' of the independent speeds (p)
    Accelerations,
    /// u' of the dependent speeds (d)
    DependentAccelerations,
    /// generalized forces (p) that must be added to the loads for the given u' (inputs `Acceleration`): M u' - forcing
    InverseDynamics,
    /// derivative of the rates of the independent coordinates and of the accelerations along a direction (inputs
    /// `Tangent`): a column of the linearised equations (number of independent coordinates + p)
    StateTangent,
    /// kinetic energy (1), J
    KineticEnergy,
    /// potential energy of gravity and springs (1), J
    PotentialEnergy,
    /// residual of the configuration equations (c)
    ConfigurationResidual,
    /// its derivatives with respect to the dependent coordinates (c x c)
    ConfigurationJacobian,
    /// residual of the velocity constraints with dependent speeds inserted (d), zero up to rounding
    ConstraintResidual,
    /// a quantity of a contact (index into `Mechanism::contacts`)
    Contact(u32, ContactQuantity),
    /// a quantity of a point (index into `Mechanism::points`)
    Point(u32, PointQuantity),
    /// components of the axes of a frame in N (3 x 3: columns are the frame's x, y, z; index into `Mechanism::frames`)
    Orientation(u32),
}

/// Quantities of a contact. The contact basis is `normal`, `first`, `second`, right-handed (second = normal x first).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ContactQuantity {
    /// n along N.x, N.y, N.z (3)
    Normal,
    /// first tangential axis along N.x, N.y, N.z (3)
    First,
    /// second tangential axis along N.x, N.y, N.z (3)
    Second,
    /// v^R in the contact basis (3)
    Velocity,
    /// rows: contact basis, columns: independent speeds (3 x p); the paper's V_n, V_t, V_s
    PartialVelocities,
    /// v_t^R in the contact basis (3)
    Remainder,
    /// reduced matrix V M^-1 V^T in the contact basis: nn, n1, n2, 11, 12, 22 (6)
    Reduced,
    /// change of the independent speeds per unit impulse, M^-1 V^T (p x 3)
    Response,
    /// change of the dependent speeds per unit impulse (d x 3)
    DependentResponse,
    /// gap (1), only where the model gives one
    Gap,
    /// sum over bodies of (m v_t . dv) per unit impulse (3): the work of prescribed motion in (24)
    PrescribedWork,
    /// derivatives of velocity (3), reduced matrix (6), response (3 p, by rows) and gap (1, where there is one) along a direction
    /// (inputs `Tangent`), where none of them depends on time by itself
    Tangent,
}

/// Quantities of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PointQuantity {
    /// position from O along N.x, N.y, N.z (3)
    Position,
    /// velocity in N along N.x, N.y, N.z (3)
    Velocity,
    /// partial velocities along N.x, N.y, N.z (3 x p)
    Jacobian,
}

/// A quantity and its nodes.
#[derive(Clone, Debug)]
pub struct Output {
    /// what it is
    pub quantity: Quantity,
    /// number of rows
    pub rows: usize,
    /// number of columns
    pub columns: usize,
    /// rows * columns nodes, by rows
    pub nodes: Vec<Node>,
}

/// A value that must not vanish: whoever uses it is told when it does.
#[derive(Clone, Debug)]
pub struct Guard {
    /// the value
    pub value: Node,
    /// what it is compared with: it counts as zero where |value| <= 2^-40 |scale|; `None`: where it is exactly zero or not finite
    pub scale: Option<Node>,
    /// what is wrong when it vanishes, for instance `the constraints cannot be solved for u2, u3`
    pub message: String,
}

/// The structure of a reduced matrix that its symbols show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Structure {
    /// none
    General,
    /// n1 may be anything; n2 = 12 = 0 and no velocity along `second`: planar
    Planar,
    /// n1 = n2 = 0
    Balanced,
    /// n1 = n2 = 12 = 0
    Diagonal,
    /// 12 = 0 and 11 = 22
    Isotropic,
}

/// The result of deriving a mechanism.
#[derive(Clone, Debug)]
pub struct Derived {
    /// the nodes
    pub graph: Graph,
    /// what they are for
    pub outputs: Vec<Output>,
    /// what must not vanish
    pub guards: Vec<Guard>,
    /// per contact, in file order
    pub structures: Vec<Structure>,
    /// arbitrary states, at which passes weigh what rounding costs; none where it does not matter
    pub samples: Vec<Inputs>,
}
