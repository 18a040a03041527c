//! A model in the source.
#![no_std]
#![deny(warnings, missing_docs)]

hodograph::mechanism! {
    //! A puck on a table, and the wall beside it.
    //!
    //!         wall |      ( o )   puck
    //!
    //! ```
    //! this is no Rust
    //! ```
    mechanism Puck;
    parameters {
        m: kg = 0.2,
        /// radius
        ///
        ///     r = d/2, measured at its widest
        r: m = 0.05,
    }
    coordinates { q1: m, q2: m, q3: rad }
    speeds { u1: m/s, u2: m/s, u3: rad/s }
    frames { B = N.rotate(z, q3); }
    points { C = O + q1*N.x + q2*N.y; P = C + r*N.x; }
    bodies { Disc { frame: B, centre: C, mass: m, inertia: [m*r^2/4, m*r^2/4, m*r^2/2] } }
    contacts { wall { point: P of Disc, normal: -N.x } }
}
