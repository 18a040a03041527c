//! Sets of axes, and the transformation of vectors and dyadics from one set to another, one rotation at a
//! time.

use super::linear_forms::{Triple, cross, dot, name, scale, zero};
use crate::algebra::{Expr, Intermediates};
use hodograph_model::arithmetic::Function;
use hodograph_model::model::mechanism::{Axis, FrameId};

/// Index of a set of axes.
pub type AxesId = usize;

/// The rotation of a set of axes relative to its parent.
#[derive(Clone, Debug)]
pub enum Turn {
    /// right-handed, about an axis of the parent: sine and cosine of the angle
    Simple {
        /// 0, 1, 2
        axis: usize,
        /// the angle, rad
        angle: Expr,
        /// its sine
        sine: Expr,
        /// its cosine
        cosine: Expr,
    },
    /// rows: components along the parent's axes of .. columns: the unit vectors of these axes
    Matrix(Box<[Triple; 3]>),
}

/// A set of axes.
#[derive(Clone, Debug)]
pub struct Axes {
    /// the axes relative to which it is rotated; `None` for those of N
    pub parent: Option<(AxesId, Turn)>,
    /// the frame whose angular velocity it has
    pub owner: FrameId,
    depth: usize,
}

/// All sets of axes.
#[derive(Clone, Debug)]
pub struct AxesTree {
    axes: Vec<Axes>,
}

impl AxesTree {
    /// The axes of N alone, with index 0.
    pub fn new() -> Self {
        AxesTree { axes: vec![Axes { parent: None, owner: FrameId::N, depth: 0 }] }
    }

    /// The axes of N.
    pub const N: AxesId = 0;

    /// Adds axes that are rotated relative to others.
    pub fn push(&mut self, parent: AxesId, turn: Turn, owner: FrameId) -> AxesId {
        let depth = self.axes[parent].depth + 1;
        self.axes.push(Axes { parent: Some((parent, turn)), owner, depth });
        self.axes.len() - 1
    }

    /// The rotation of a set of axes relative to its parent; `None` for N.
    pub fn turn(&self, axes: AxesId) -> Option<&Turn> {
        self.axes[axes].parent.as_ref().map(|(_, turn)| turn)
    }

    /// The frame whose angular velocity a set of axes has.
    pub fn owner(&self, axes: AxesId) -> FrameId {
        self.axes[axes].owner
    }

    /// The parent, or `None` for N.
    pub fn parent(&self, axes: AxesId) -> Option<AxesId> {
        self.axes[axes].parent.as_ref().map(|(parent, _)| *parent)
    }

    /// Whether the axes `below` are rotated, in any number of steps, relative to the axes `above`.
    pub fn descends(&self, mut below: AxesId, above: AxesId) -> bool {
        while self.axes[below].depth > self.axes[above].depth {
            below = self.parent(below).unwrap_or(Self::N);
        }
        below == above
    }

    /// The deepest common ancestor of two sets of axes.
    pub fn common(&self, mut a: AxesId, mut b: AxesId) -> AxesId {
        while a != b {
            if self.axes[a].depth >= self.axes[b].depth {
                a = self.parent(a).unwrap_or(Self::N);
            } else {
                b = self.parent(b).unwrap_or(Self::N);
            }
        }
        a
    }

    /// Number of rotations between two sets of axes.
    pub fn distance(&self, from: AxesId, to: AxesId) -> usize {
        let top = self.common(from, to);
        self.axes[from].depth + self.axes[to].depth - 2 * self.axes[top].depth
    }

    /// The unit vectors of one set of axes along another; each matrix on the way is formed once and stored.
    pub fn columns(&self, z: &mut Intermediates, from: AxesId, to: AxesId) -> [Triple; 3] {
        if from == to {
            return std::array::from_fn(unit);
        }
        if !self.descends(to, from)
            && let Some((parent, turn)) = &self.axes[from].parent
        {
            let known = self.columns(z, *parent, to);
            return std::array::from_fn(|j| {
                let along = up(turn, &unit(j));
                let parts = (0..3).map(|i| scale(&along[i], &known[i]));
                let sum = parts.fold(zero(), |sum, part| super::linear_forms::add(&sum, &part));
                name(z, sum)
            });
        }
        let Some((parent, turn)) = &self.axes[to].parent else { return std::array::from_fn(unit) };
        let known = self.columns(z, from, *parent);
        known.map(|column| name(z, down(turn, &column)))
    }

    /// Like `convert`, but with the matrix between the axes if it is shared by many vectors on a long way.
    pub fn convert_far(&self, z: &mut Intermediates, v: &Triple, from: AxesId, to: AxesId) -> Triple {
        if self.distance(from, to) < 2 || super::linear_forms::is_zero(v) {
            return self.convert(z, v, from, to);
        }
        let columns = self.columns(z, from, to);
        let parts = (0..3).map(|i| scale(&v[i], &columns[i]));
        let sum = parts.fold(zero(), |sum, part| super::linear_forms::add(&sum, &part));
        name(z, sum)
    }

    /// The same vector along other axes; its components are named on the way.
    pub fn convert(&self, z: &mut Intermediates, v: &Triple, from: AxesId, to: AxesId) -> Triple {
        if from == to || super::linear_forms::is_zero(v) {
            return v.clone();
        }
        self.way(from, to)
            .fold(v.clone(), |v, (turn, back)| name(z, if back { down(turn, &v) } else { up(turn, &v) }))
    }

    /// The rotations from one set of axes to another: up to the common ancestor, then down.
    fn way(&self, from: AxesId, to: AxesId) -> impl Iterator<Item = (&Turn, bool)> {
        let top = self.common(from, to);
        let below = move |from: AxesId| {
            let axes = std::iter::successors(Some(from), |&at| Some(self.axes[at].parent.as_ref()?.0));
            axes.take_while(move |&at| at != top)
                .filter_map(|at| self.axes[at].parent.as_ref())
                .map(|(_, turn)| turn)
        };
        let back: Vec<&Turn> = below(to).collect();
        below(from).map(|turn| (turn, false)).chain(back.into_iter().rev().map(|turn| (turn, true)))
    }
}

/// A symmetric matrix: xx, yy, zz, xy, yz, zx.
pub type Symmetric = [Expr; 6];

/// Row and column of each entry of a symmetric matrix.
pub const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// Which of two numbers is much smaller than the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smaller {
    /// the first
    First,
    /// the second
    Second,
    /// neither
    Neither,
}

/// Whether the dyadic is a multiple of the unit dyadic, the same along any axes.
pub fn is_isotropic(m: &Symmetric) -> bool {
    m[0] == m[1] && m[1] == m[2] && m[3..].iter().all(Expr::is_zero)
}

/// Index of the entry (i, j) of a symmetric matrix.
pub fn entry(i: usize, j: usize) -> usize {
    // the axis that is neither i nor j: z -> xy, x -> yz, y -> zx
    if i == j { i } else { [4, 5, 3][3 - i - j] }
}

impl AxesTree {
    /// The same dyadic along other axes; its components are named on the way.
    pub fn convert_symmetric(
        &self,
        z: &mut Intermediates,
        m: &Symmetric,
        from: AxesId,
        to: AxesId,
    ) -> Symmetric {
        self.convert_graded(z, m, from, to, |_, _, _| Smaller::Neither)
    }

    /// Like `convert_symmetric`, with one to three more operations per rotation that keep the digits of small
    /// components beside large ones: `smaller` tells which of two is.
    pub fn convert_graded(
        &self,
        z: &mut Intermediates,
        m: &Symmetric,
        from: AxesId,
        to: AxesId,
        mut smaller: impl FnMut(&Intermediates, &Expr, &Expr) -> Smaller,
    ) -> Symmetric {
        if is_isotropic(m) {
            return m.clone();
        }
        self.way(from, to).fold(m.clone(), |m, (turn, back)| up_symmetric(z, turn, &m, back, &mut smaller))
    }
}

/// A dyadic from rotated axes to the parent's, or back.
fn up_symmetric(
    z: &mut Intermediates,
    turn: &Turn,
    m: &Symmetric,
    back: bool,
    smaller: &mut impl FnMut(&Intermediates, &Expr, &Expr) -> Smaller,
) -> Symmetric {
    match turn {
        Turn::Simple { axis, sine, cosine, .. } => {
            let sine = if back { sine.neg() } else { sine.clone() };
            let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
            let (jj, kk, jk) = (&m[j], &m[k], &m[entry(j, k)]);
            // With w = c (jj - kk) - 2 s jk and v = s (jj - kk) + 2 c jk: jj' = kk + c w = jj - s v,
            // kk' = jj - c w = kk + s v, jk' = jk + s w.
            let difference = z.name(jj.sub(kk));
            let twice = jk.mul(&Expr::integer(2));
            let w = z.name(cosine.mul(&difference).sub(&sine.mul(&twice)));
            let cw = z.name(cosine.mul(&w));
            let mut result = m.clone();
            let smaller = smaller(z, jj, kk);
            // A small component is computed from small ones: near a multiple of a right angle the other terms
            // vanish.
            let sv = if smaller == Smaller::Neither {
                Expr::zero()
            } else {
                let v = z.name(sine.mul(&difference).add(&cosine.mul(&twice)));
                z.name(sine.mul(&v))
            };
            result[j] = z.name(if smaller == Smaller::First { jj.sub(&sv) } else { kk.add(&cw) });
            result[k] = z.name(if smaller == Smaller::Second { kk.add(&sv) } else { jj.sub(&cw) });
            result[entry(j, k)] = z.name(jk.add(&sine.mul(&w)));
            let (ja, ka) = (&m[entry(j, *axis)], &m[entry(k, *axis)]);
            result[entry(j, *axis)] = z.name(cosine.mul(ja).sub(&sine.mul(ka)));
            result[entry(k, *axis)] = z.name(sine.mul(ja).add(&cosine.mul(ka)));
            result
        }
        Turn::Matrix(_) => {
            let turned = |v: &Triple| if back { down(turn, v) } else { up(turn, v) };
            // first the columns, then the rows
            let columns: [Triple; 3] = std::array::from_fn(|j| {
                let column = std::array::from_fn(|i| m[entry(i, j)].clone());
                name(z, turned(&column))
            });
            let rows: [Triple; 3] =
                std::array::from_fn(|i| turned(&std::array::from_fn(|j| columns[j][i].clone())));
            ENTRIES.map(|(i, j)| z.name(rows[i][j].clone()))
        }
    }
}

impl Default for AxesTree {
    fn default() -> Self {
        Self::new()
    }
}

/// From rotated axes to the parent's.
fn up(turn: &Turn, v: &Triple) -> Triple {
    match turn {
        Turn::Simple { axis, sine, cosine, .. } => turned(*axis, sine, cosine, v),
        Turn::Matrix(rows) => std::array::from_fn(|i| dot(&rows[i], v)),
    }
}

/// From the parent's axes to the rotated ones.
fn down(turn: &Turn, v: &Triple) -> Triple {
    match turn {
        Turn::Simple { axis, sine, cosine, .. } => turned(*axis, &sine.neg(), cosine, v),
        Turn::Matrix(rows) => {
            std::array::from_fn(|j| dot(&[rows[0][j].clone(), rows[1][j].clone(), rows[2][j].clone()], v))
        }
    }
}

fn turned(axis: usize, sine: &Expr, cosine: &Expr, v: &Triple) -> Triple {
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut result = v.clone();
    result[j] = cosine.mul(&v[j]).sub(&sine.mul(&v[k]));
    result[k] = sine.mul(&v[j]).add(&cosine.mul(&v[k]));
    result
}

/// The index of an axis.
pub fn index(axis: Axis) -> usize {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

/// The unit vector along an axis.
pub fn unit(i: usize) -> Triple {
    let mut v = zero();
    v[i] = Expr::one();
    v
}

/// A simple rotation.
pub fn simple(z: &mut Intermediates, axis: Axis, negative: bool, angle: &Expr) -> Turn {
    let angle = if negative { angle.neg() } else { angle.clone() };
    let sine = z.call(Function::Sin, vec![angle.clone()]);
    let cosine = z.call(Function::Cos, vec![angle.clone()]);
    Turn::Simple { axis: index(axis), angle, sine, cosine }
}

/// Rotation about a unit vector `e`: cos 1 + sin `[e]`x + (1 - cos) e e'.
pub fn about(z: &mut Intermediates, e: &Triple, angle: &Expr) -> Turn {
    let sine = z.call(Function::Sin, vec![angle.clone()]);
    let cosine = z.call(Function::Cos, vec![angle.clone()]);
    let versine = z.name(Expr::one().sub(&cosine));
    let rows = std::array::from_fn(|i| {
        let row = unit(i);
        // row i of the matrix: what each unit vector contributes along axis i
        std::array::from_fn(|j| {
            let turned = &cross(e, &unit(j))[i];
            let entry = cosine.mul(&row[j]).add(&sine.mul(turned)).add(&versine.mul(&e[i].mul(&e[j])));
            let entry = z.simplify(&entry);
            z.name(entry)
        })
    });
    Turn::Matrix(Box::new(rows))
}

/// The matrix of a unit quaternion, scalar part first.
pub fn quaternion(z: &mut Intermediates, e: &[Expr; 4]) -> Turn {
    let two = Expr::integer(2);
    let [w, v @ ..] = e;
    let rows = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let (a, b) = ((i + 1) % 3, (i + 2) % 3);
            let entry = if i == j {
                let squares = v[a].mul(&v[a]).add(&v[b].mul(&v[b]));
                Expr::one().sub(&scale(&two, &[squares, Expr::zero(), Expr::zero()])[0])
            } else {
                let k = 3 - i - j;
                let sign = if (i + 1) % 3 == j { Expr::integer(-1) } else { Expr::one() };
                let sum = v[i].mul(&v[j]).add(&sign.mul(&w.mul(&v[k])));
                two.mul(&z.name(sum))
            };
            z.name(entry)
        })
    });
    Turn::Matrix(Box::new(rows))
}
