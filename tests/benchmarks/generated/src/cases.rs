//! The mechanisms that are measured.

/// A mechanism.
pub struct Case {
    /// short name, also of the module
    pub name: String,
    /// for readers
    pub title: String,
    /// where its model comes from
    pub origin: Origin,
    /// the contact whose matrices are measured
    pub contact: &'static str,
    /// whether it has named inputs.
    pub inputs: bool,
}

impl Case {
    /// Whether others computed it too, from the same URDF.
    pub fn has_peers(&self) -> bool {
        matches!(self.origin, Origin::Peer | Origin::Chain(20))
    }
}

/// Where a model comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// `tests/data/peers/<name>.urdf`, with states in `expected.json`
    Peer,
    /// a cart with this many links, see [`crate::chain`]
    Chain(usize),
    /// `models/<name>.mech`
    Model,
}

/// The chains for the plot.
pub const CHAINS: [usize; 6] = [1, 2, 5, 10, 20, 40];

/// All mechanisms.
pub fn all() -> Vec<Case> {
    let peer = |name: &str, title: &str| Case {
        name: name.to_owned(),
        title: title.to_owned(),
        origin: Origin::Peer,
        contact: "contact_ee",
        inputs: true,
    };
    let mut cases = vec![
        peer("dpend", "double pendulum"),
        peer("cart5", "5 links on a cart"),
        peer("panda", "7-joint arm"),
        peer("anymal", "quadruped, 18 speeds"),
        Case {
            name: "whipple_bicycle".to_owned(),
            title: "Whipple bicycle".to_owned(),
            origin: Origin::Model,
            contact: "handlebar_wall",
            inputs: false,
        },
    ];
    cases.extend(CHAINS.map(|links| Case {
        name: format!("chain{links}"),
        title: format!("chain of {links} on a cart"),
        origin: Origin::Chain(links),
        contact: "contact_ee",
        inputs: true,
    }));
    cases
}
