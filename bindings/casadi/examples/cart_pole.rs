//! A cart-pole as a shared library for CasADi: `casadi.external("cart_pole", ..)` and
//! `casadi.external("cart_pole_inverse_dynamics", ..)`.

hodograph::mechanism!("examples/cart_pole.mech");

hodograph_casadi::external!("cart_pole" => cart_pole::CartPole(q, u, inputs));
