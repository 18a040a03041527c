//! The mechanism of the errors that every door has.

hodograph::mechanism!("../../tests/data/doors/errors.mech");

hodograph_casadi::external!("errors" => errors::Errors(q, u, inputs));
