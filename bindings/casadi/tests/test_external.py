"""The generated cart-pole as external functions of CasADi: values, Jacobians, refusals, and a trajectory that IPOPT finds through them."""

import ctypes
import json
import os
import sys
from pathlib import Path

import casadi
import hodograph
import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(FOLDER / "examples"))
import swing_up  # noqa: E402

LIBRARIES = FOLDER / "../target/release/examples"
WHEEL = hodograph.load(FOLDER / "examples/cart_pole.mech")
RANDOM = np.random.default_rng(17)
STATES = [RANDOM.normal(scale=2, size=6) for _ in range(20)]


def library(name):
    found = [path for path in LIBRARIES.glob(f"*{name}.*") if path.suffix in (".so", ".dylib", ".dll")]
    return str(found[0])


RATES = casadi.external("cart_pole", library("cart_pole"))
INVERSE = casadi.external("cart_pole_inverse_dynamics", library("cart_pole"))


def textbook(q, u, force):
    """The equations of motion of the cart-pole, by hand: Lagrange's equations, solved for the accelerations."""
    mc, mr, l, g, c = 1, 0.3, 1, 9.81, 0.02
    s, co = casadi.sin(q[1]), casadi.cos(q[1])
    a, b, d = mc + mr, mr * l / 2 * co, mr * l**2 / 3
    right = force + mr * l / 2 * s * u[1] ** 2, -mr * g * l / 2 * s - c * u[1]
    determinant = a * d - b**2
    return u, casadi.vertcat((d * right[0] - b * right[1]) / determinant, (a * right[1] - b * right[0]) / determinant)


def test_names_and_shapes():
    assert RATES.name_in() == ["q", "u", "inputs"] and RATES.name_out() == ["q_rates", "u_rates"]
    assert INVERSE.name_in() == ["q", "u", "acceleration", "inputs"] and INVERSE.name_out() == ["forces"]
    assert [RATES.size_in(i) for i in range(3)] == [(2, 1), (2, 1), (1, 1)]
    assert RATES.jacobian().name_out()[4] == "jac_u_rates_u" and RATES.jacobian().size_out(4) == (2, 2)


@pytest.mark.parametrize("x", STATES[:8])
def test_values_have_the_bits_of_the_wheel_and_agree_with_the_textbook(x):
    q, u, f = x[:2], x[2:4], x[4:5]
    q_rates, u_rates = (found.full().ravel() for found in RATES(q, u, f))
    np.testing.assert_array_equal(q_rates, WHEEL.coordinate_rates(q, u, f))
    np.testing.assert_array_equal(u_rates, WHEEL.accelerations(q, u, f))
    np.testing.assert_array_equal(flat(INVERSE(q, u, x[4:], f)), WHEEL.inverse_dynamics(x[4:], q, u, f))
    np.testing.assert_allclose(u_rates, flat(textbook(casadi.DM(q), casadi.DM(u), f[0])[1]), rtol=1e-12, atol=1e-12)


def test_twenty_states_have_the_bits_of_every_door():
    pendulum = casadi.external("planar_double_pendulum", library("planar_double_pendulum"))
    table = np.loadtxt(FOLDER.parents[1] / "tests/data/doors/planar_double_pendulum.csv", delimiter=",", skiprows=1)
    assert len(table) == 20
    for row in table:
        np.testing.assert_array_equal(flat(pendulum(row[:2], row[2:4])[1]), row[4:6])


def test_bad_input_has_the_errors_of_every_door():
    rates = casadi.external("errors", library("errors"))
    last_error = ctypes.CDLL(library("errors")).errors_last_error
    last_error.restype = ctypes.c_char_p
    mistakes = [m for m in json.loads((FOLDER.parents[1] / "tests/data/doors/errors.json").read_text()) if "casadi" in m["doors"]]
    assert len(mistakes) > 2
    q, u = {"s": 1.0, "z": 0.5, "a": 0.0}, {"us": 1.0, "uz": -1.0, "ua": 0.5}
    assert np.isfinite(flat(rates(list(q.values()), list(u.values()), [0]))).all()
    for mistake in mistakes:
        given = [[float(mistake.get(section, {}).get(name, value)) for name, value in of.items()] for section, of in (("q", q), ("u", u))]
        with pytest.raises(RuntimeError):
            rates(*given, [0])
        said = last_error().decode()
        assert said.startswith(mistake["kind"] + ": ") and mistake["words"] in said, (mistake, said)


def flat(found):
    """All numbers of an answer of CasADi."""
    return np.concatenate([block.full().ravel() for block in (found if isinstance(found, tuple) else (found,))])


def blocks(function, arguments):
    """The Jacobian of a function as one matrix, by its external Jacobian."""
    results = function(*arguments)
    results = results if isinstance(results, tuple) else (results,)
    found = function.jacobian()(*arguments, *results)
    found = [block.full() for block in (found if isinstance(found, tuple) else (found,))]
    width = len(arguments)
    return np.block([found[start : start + width] for start in range(0, len(found), width)])


@pytest.mark.parametrize("name", ["cart_pole", "cart_pole_inverse_dynamics"])
def test_jacobians_are_those_of_differences_of_the_wheel_and_of_automatic_differentiation(name):
    function = {"cart_pole": RATES, "cart_pole_inverse_dynamics": INVERSE}[name]
    # the same function, of which CasADi sees values alone
    differences = {"enable_jacobian": False, "enable_fd": True, "enable_forward": False, "enable_reverse": False, "fd_method": "central"}
    by_differences = casadi.external(name, library("cart_pole"), differences)
    column = by_differences.forward(1)
    for x in STATES:
        q, u, f = x[:2], x[2:4], x[4:5]
        arguments = (q, u, f) if function is RATES else (q, u, x[4:], f)
        exact = blocks(function, arguments)
        results = function(*arguments)
        results = results if isinstance(results, tuple) else (results,)
        ends = np.cumsum([len(argument) for argument in arguments])
        seeds = [np.split(seed, ends[:-1]) for seed in np.eye(ends[-1])]
        found = np.column_stack([flat(column(*arguments, *results, *seed)) for seed in seeds])
        np.testing.assert_allclose(exact, found, rtol=1e-6, atol=1e-5)
        if function is RATES:
            a, b = WHEEL.linearise(q, u, f)
            np.testing.assert_allclose(exact, np.hstack([a, b]), rtol=1e-13, atol=1e-13)
            t = casadi.SX.sym("t", 5)
            by_hand = casadi.vertcat(*textbook(t[:2], t[2:4], t[4]))
            automatic = casadi.Function("t", [t], [casadi.jacobian(by_hand, t)])(x[:5]).full()
            np.testing.assert_allclose(exact, automatic, rtol=1e-11, atol=1e-11)
        else:
            d = WHEEL.inverse_dynamics_derivatives(x[4:], q, u, f)
            of_wheel = np.hstack([d.by_coordinates, d.by_speeds, WHEEL.mass_matrix(q, u, f), d.by_inputs])
            np.testing.assert_array_equal(exact, of_wheel)


def test_numbers_that_are_none_fail_and_do_not_end_the_process():
    with pytest.raises(RuntimeError):
        RATES([0.0, np.nan], [0.0, 0.0], [1.0])
    with pytest.raises(RuntimeError):
        RATES.jacobian()([0.0, 0.0], [0.0, np.inf], [1.0], 0, 0)
    assert np.isfinite(flat(RATES([0, 0], [0, 0], [0]))).all()


def test_a_mechanism_with_loops_is_refused(capfd):
    with pytest.raises(RuntimeError, match="work"):
        casadi.external("four_bar", library("four_bar"))
    assert "closed loops" in capfd.readouterr().err


def test_many_states_at_once():
    many = np.array(STATES)[:, :5]
    found = RATES.map(len(many))(many[:, :2].T, many[:, 2:4].T, many[:, 4:].T)
    np.testing.assert_array_equal(found[1].full().T, WHEEL.accelerations(many[:, :2].copy(), many[:, 2:4].copy(), many[:, 4:].copy()))


def test_ipopt_swings_the_rod_up_as_with_equations_written_by_hand():
    q, u, f = casadi.SX.sym("q", 2), casadi.SX.sym("u", 2), casadi.SX.sym("f")
    by_hand = casadi.Function("by_hand", [q, u, f], list(textbook(q, u, f)))
    times, states, forces, cost = swing_up.solve(RATES)
    *_, cost_by_hand = swing_up.solve(by_hand)
    assert cost == pytest.approx(cost_by_hand, rel=1e-6)
    np.testing.assert_allclose(states[[0, -1]], [[0, 0, 0, 0], [0, np.pi, 0, 0]], atol=1e-8)
    assert abs(forces).max() < swing_up.GREATEST_FORCE * (1 + 1e-6) and abs(states[:, 0]).max() < swing_up.TRACK
    # energy from the force, less friction, is that of the standing rod: the work by Simpson's rule
    power = forces * states[:, 2] - 0.02 * states[:, 3] ** 2
    h = times[2] - times[0]
    work = h / 6 * (power[:-2:2] + 4 * power[1::2] + power[2::2]).sum()
    assert work == pytest.approx(0.3 * 9.81 * 1, rel=1e-3)
    # coarser intervals: the optimum is that of the motion and not of the grid
    *_, coarse = swing_up.solve(RATES, intervals=30)
    assert coarse == pytest.approx(cost, rel=2e-2)
    picture = os.environ.get("HODOGRAPH_PICTURES")
    if picture:
        swing_up.draw(times, states, forces, Path(picture) / "swing_up.png")
