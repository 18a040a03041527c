//! A mechanism with a closed loop, which CasADi is refused.

hodograph::mechanism!("../../models/four_bar.mech");

hodograph_casadi::external!("four_bar" => four_bar::FourBar(q, u));
