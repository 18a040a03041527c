"""A cart-pole swings up with the least effort: direct collocation, solved by IPOPT through the generated module's equations of motion and Jacobians.

`python examples/swing_up.py ../target/release/examples/libcart_pole.so picture.png` after `cargo build --release --example cart_pole`.
"""

from __future__ import annotations

import sys

import casadi
import numpy as np

DURATION, INTERVALS, GREATEST_FORCE, TRACK = 2.0, 50, 15.0, 1.5  # s, 1, N, m


def solve(rates, intervals=INTERVALS):
    """Minimises the integral of the squared force from hanging to standing, both at rest.

    ``rates``: function of q (2), u (2), inputs (1) that gives q' and u'. Collocation after Hermite and Simpson: state x and force f at the ends of the
    intervals and in their middles; the force is linear in each half, and x is the cubic through both ends that satisfies x' = rates in the middle.
    Returns times, states (k, 4), forces (k,) of all these points, and the cost, N^2 s.
    """
    x, f = casadi.MX.sym("x", 4, 2 * intervals + 1), casadi.MX.sym("f", 1, 2 * intervals + 1)
    one = casadi.MX.sym("one", 5)
    q_rates, u_rates = rates(one[:2], one[2:4], one[4])
    every = casadi.Function("every", [one], [casadi.vertcat(q_rates, u_rates)]).map(2 * intervals + 1)
    slope = every(casadi.vertcat(x, f))
    h = DURATION / intervals
    left, middle, right = (slice(start, stop, 2) for start, stop in ((0, -2), (1, None), (2, None)))
    x0, xm, x1 = x[:, left], x[:, middle], x[:, right]
    s0, sm, s1 = slope[:, left], slope[:, middle], slope[:, right]
    equations = casadi.vertcat(
        casadi.vec(x1 - x0 - h / 6 * (s0 + 4 * sm + s1)),
        casadi.vec(xm - (x0 + x1) / 2 - h / 8 * (s0 - s1)),
        x[:, 0],
        x[:, -1] - casadi.DM([0, np.pi, 0, 0]),
    )
    cost = h / 6 * (casadi.sumsqr(f[left]) + 4 * casadi.sumsqr(f[middle]) + casadi.sumsqr(f[right]))
    unknowns = casadi.vertcat(casadi.vec(x), casadi.vec(f))
    options = {
        "print_time": False,
        # second derivatives are estimated from the gradients
        "ipopt": {"hessian_approximation": "limited-memory", "tol": 1e-9, "max_iter": 2000, "print_level": 0, "sb": "yes"},
    }
    solver = casadi.nlpsol("swing_up", "ipopt", {"x": unknowns, "f": cost, "g": equations}, options)
    share = np.linspace(0, 1, 2 * intervals + 1)
    start = np.stack([0 * share, np.pi * share, 0 * share, 0 * share + np.pi / DURATION])
    bound = np.concatenate([np.tile([TRACK, np.inf, np.inf, np.inf], share.size), np.full(share.size, GREATEST_FORCE)])
    found = solver(x0=np.concatenate([start.ravel(order="F"), 0 * share]), lbx=-bound, ubx=bound, lbg=0, ubg=0)
    if not solver.stats()["success"]:
        raise RuntimeError(f"IPOPT: {solver.stats()['return_status']}")
    numbers = found["x"].full().ravel()
    return DURATION * share, numbers[: 4 * share.size].reshape(-1, 4), numbers[4 * share.size :], float(found["f"])


def draw(times, states, forces, picture):
    """The motion as a strip of poses, and the force over time."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (poses, curves) = plt.subplots(2, 1, figsize=(8, 7), constrained_layout=True)
    for index in range(0, len(times), 4):
        cart, angle = states[index, :2]
        colour = plt.cm.viridis(index / len(times))
        poses.plot([cart, cart + np.sin(angle)], [0, -np.cos(angle)], color=colour, lw=1.5)
        poses.plot(cart, 0, "s", color=colour, ms=5)
    poses.set(xlabel="x, m", ylabel="y, m", aspect="equal", title="the cart-pole every 0.08 s, from dark to light")
    curves.plot(times, forces, label="force, N")
    curves.plot(times, states[:, 0], label="q1, m")
    curves.plot(times, states[:, 1], label="q2, rad")
    curves.set_xlabel("time, s")
    curves.legend()
    curves.grid(alpha=0.3)
    figure.savefig(picture, dpi=80)


if __name__ == "__main__":
    library, picture = sys.argv[1:]
    times, states, forces, cost = solve(casadi.external("cart_pole", library))
    print(f"least integral of the squared force: {cost:.6f} N^2 s; greatest force {abs(forces).max():.3f} N, cart within {abs(states[:, 0]).max():.3f} m")
    draw(times, states, forces, picture)
