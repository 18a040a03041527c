"""What Python users see: names, shapes, tables, errors, pictures."""

import os
import signal
import threading
import time as clock
from pathlib import Path

import hodograph
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]


def model(name):
    return hodograph.load(ROOT / f"models/{name}.mech")


SLEDS = model("two_sleds")
RANDOM = np.random.default_rng(5)
SURFACE = dict(mu=0.6, e=0.8, law="stronge")
MATRIX, APPROACH = np.array([0.25, -0.125, 0.0, 0.5, 0.0, 0.5]), np.array([-1.0, 0.5, 0.0])


def test_names_units_and_defaults():
    assert SLEDS.name == "TwoSleds" and SLEDS.contacts == ["BcAc"]
    assert [u.name for u in SLEDS.speeds] == ["u1", "u3", "u4", "u6"]
    assert all(isinstance(p.value, float) and p.unit for p in SLEDS.parameters)
    assert "TwoSleds" in repr(SLEDS)


def test_the_outcome_in_the_readme_and_momentum():
    hit = SLEDS.collide("BcAc", **SURFACE)
    contact = SLEDS.contact("BcAc")
    before = np.array([u.value for u in SLEDS.speeds])
    # the impulse along the contact basis from that on the point
    basis = np.stack([contact.normal, contact.first, contact.second])
    np.testing.assert_allclose(hit.speeds, before + contact.response @ (basis @ hit.impulse_on_point), rtol=1e-12)
    np.testing.assert_allclose(
        contact.partial_velocities @ contact.response,
        np.array([[contact.reduced[i] for i in row] for row in ([0, 1, 2], [1, 3, 4], [2, 4, 5])]),
        atol=1e-12,
    )
    energy = SLEDS.kinetic_energy(u=hit.speeds) - SLEDS.kinetic_energy()
    assert energy == pytest.approx(hit.energy_change) and hit.path in ("sliding", "sliding, then sticking", "sliding, then renewal")


def test_linearise_and_derivatives_agree_with_differences():
    m = model("spherical_pendulum")
    q, u = (np.array([x.value for x in xs]) for xs in (m.coordinates, m.speeds))
    d, h = m.accelerations_derivatives(q, u), 1e-6
    for k in range(len(u)):
        step = np.eye(len(u))[k] * h
        difference = (m.accelerations(q, u + step) - m.accelerations(q, u - step)) / (2 * h)
        np.testing.assert_allclose(d.by_speeds[:, k], difference, atol=1e-7)
    a, b = m.linearise(np.tile(q, (3, 1)), u)
    assert a.shape == (3, len(q) + len(u), len(q) + len(u)) and b.shape[-1] == len(m.inputs)
    np.testing.assert_array_equal(a[0, len(q) :, len(q) :], d.by_speeds)


def test_inverse_dynamics_inverts():
    m = model("arm_7dof")
    u = np.linspace(-1, 1, 7)
    forces = m.inverse_dynamics(u, u=u)
    np.testing.assert_allclose(m.mass_matrix(u=u) @ u - m.forcing(u=u), forces, atol=1e-12)


def test_solve_derivative_hodograph():
    one = hodograph.solve(MATRIX, APPROACH, **SURFACE)
    many = hodograph.solve(np.tile(MATRIX, (50, 1)), APPROACH, mu=np.linspace(0, 2, 50), e=0.8, law="stronge")
    assert one.impulse.shape == (3,) and many.impulse.shape == (50, 3) and many.path.shape == (50,)
    full = np.array([[MATRIX[i] for i in row] for row in ([0, 1, 2], [1, 3, 4], [2, 4, 5])])
    np.testing.assert_allclose(APPROACH + full @ one.impulse, one.velocity, atol=1e-14)
    d = hodograph.derivative(MATRIX, APPROACH, **SURFACE)
    h = 1e-6
    change = [hodograph.solve(MATRIX, APPROACH, **{**SURFACE, "mu": 0.6 + s}).impulse for s in (h, -h)]
    np.testing.assert_allclose(d.impulse[:, 9], (change[0] - change[1]) / (2 * h), atol=1e-7)
    course = hodograph.hodograph(MATRIX, APPROACH, **SURFACE)
    np.testing.assert_array_equal(course.impulse[-1], one.impulse)
    assert course._repr_html_().count("<svg") == 2 and "nan" not in course._repr_html_()


def test_characteristics_are_those_of_the_paper():
    found = SLEDS.characteristics("BcAc", mu=1.1, e=0.8, law="newton")
    # section 5 and the end of section 6 of the paper; s = n x t, there t x n
    printed = dict(c_n=42.59, c_t=37.3, c_s=-35.8, mu_c=1.21, mu_s=1.086, f_hat=0.0425, phi_bar=-0.432, E_nC=-1.295, E_nS=-1.291, v_nS=0.0533)
    for name, value in printed.items():
        assert getattr(found, name) == pytest.approx(value, rel=5e-3), name
    assert found.dh_hat < -found.g_hat < 0 and found.path == "sliding, then renewal" and found.kind == ""
    hit = SLEDS.collide("BcAc", mu=1.1, e=0.8, law="newton")
    assert hit.energy_gained == hit.contact_work > 1
    many = hodograph.characteristics(hit.reduced, hit.approach, mu=np.array([0.6, 1.1, 1.6]), e=0.8, law="stronge")
    assert many.mu_c.shape == (3,) and many.mu_c[1] == found.mu_c
    np.testing.assert_array_equal(np.isnan(many.phi_hat), [False, False, True])
    np.testing.assert_array_equal(np.isnan(many.v_nS), [True, False, False])
    away = hodograph.characteristics(hit.reduced, -hit.approach, mu=1.1, e=0.8, law="stronge", errors="nan")
    assert away.kind == "not_approaching" and np.isnan(away.mu_c)


def test_states_at_given_impulses():
    hit = SLEDS.collide("BcAc", mu=1.6, e=0.8, law="stronge")
    course = hodograph.hodograph(hit.reduced, hit.approach, mu=1.6, e=0.8, law="stronge", impulses=[0.0, hit.impulse[0], 100.0])
    np.testing.assert_array_equal(course.velocity[0], hit.approach)
    np.testing.assert_allclose(course.velocity[1], hit.velocity, atol=1e-12)
    assert course.motion == ["sliding", "sticking", "sticking"] and course.velocity[2, 0] > course.velocity[1, 0]


def test_rounding_is_no_gain_of_energy():
    random = np.random.default_rng(1)
    b = random.normal(size=(3000, 3, 3))
    m = b @ b.transpose(0, 2, 1)
    matrix = np.stack([m[:, 0, 0], m[:, 0, 1], m[:, 0, 2], m[:, 1, 1], m[:, 1, 2], m[:, 2, 2]], axis=1)
    hits = hodograph.solve(matrix, [-1.0, 0.5, 0.2], mu=0.0, e=1.0, law="stronge")
    assert np.count_nonzero(hits.contact_work > 0) > 100 and not hits.energy_gained.any()


def test_simulate():
    m = model("planar_double_pendulum")
    motion = m.simulate(0.2, 0.01, mu=0.3, e=0.5, law="stronge")
    assert motion.time.shape == (21,) and motion.q.shape == (21, 2)
    energy = m.kinetic_energy(motion.q, motion.u) + m.potential_energy(motion.q)
    # Energy changes by what the collisions take, and by nothing else.
    struck = [event for event in motion.events if event.kind == "collision"]
    assert len(struck) > 0 and all(event.energy_change < 0 for event in struck)
    left = [sum(event.energy_change for event in struck if event.time <= time) for time in motion.time]
    np.testing.assert_allclose(energy, energy[0] + left, rtol=1e-8, atol=1e-10)
    assert motion._repr_html_().count("<svg") == 2
    with pytest.raises(hodograph.ArgumentError, match="step"):
        m.simulate(1.0, 0.0)


def test_simulate_contacts_with_surfaces_and_events():
    m = model("free_box_corner")
    contact = m.contacts[0]
    motion = m.simulate(0.05, 0.01, mu=0.3, e=0.5, law="stronge")
    same = m.simulate(0.05, 0.01, surfaces={contact: dict(mu=0.3, e=0.5, law="stronge")})
    other = m.simulate(0.05, 0.01, mu=0.3, e=0.5, law="stronge", surfaces={contact: {"e": 0.0}})
    np.testing.assert_array_equal(motion.u, same.u)
    first = motion.events[0]
    assert first.kind == "collision" and first.contact == contact and first.q.shape == (len(m.coordinates),)
    # the box touches the floor at the start
    hit = m.collide(contact, mu=0.3, e=0.5, law="stronge")
    assert first.time == 0
    np.testing.assert_allclose(first.u, hit.speeds, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(first.impulse_on_point, hit.impulse_on_point, rtol=1e-12, atol=1e-12)
    assert first.energy_change == pytest.approx(hit.energy_change)
    assert not np.array_equal(motion.u, other.u)
    assert list(motion.columns())[0] == "time" and len(motion.columns()) == 1 + motion.q.shape[1] + motion.u.shape[1]
    with pytest.raises(hodograph.ArgumentError, match="there are: |did you mean"):
        m.simulate(0.1, 0.01, surfaces={"nowhere": {}})
    with pytest.raises(hodograph.ArgumentError, match="no property of the surface of corner `friction`"):
        m.simulate(0.1, 0.01, surfaces={contact: {"friction": 1}})


def test_surfaces_and_tolerances_have_the_defaults_of_the_tool():
    m = model("free_box_corner")
    whole = dict(mu=0.3, e=0.5, law="stronge")
    for name in whole:
        part = {key: value for key, value in whole.items() if key != name}
        with pytest.raises(hodograph.ArgumentError, match=f"no surface: {name} is missing"):
            m.simulate(0.05, 0.01, **part)
    with pytest.raises(hodograph.ArgumentError, match="has no surface"):
        m.simulate(0.05)
    np.testing.assert_array_equal(m.simulate(0.05, **whole).q, m.simulate(0.05, 0.01, tolerance=1e-12, **whole).q)
    for name, value in (("tolerance", 1e-22), ("tolerance", 0.0), ("mu", -1.0), ("e", 1.2), ("mu", "0.3"), ("e", np.ma.masked)):
        with pytest.raises(hodograph.ArgumentError):
            m.simulate(0.05, 0.01, **{**whole, name: value})
    # a contact that cannot close needs no surface
    assert model("rolling_disc").simulate(0.02).time.shape == (3,)


def test_what_is_no_number_is_refused():
    m = model("two_sleds")
    u = np.ones(4)
    masked = np.ma.masked_array(u, mask=[0, 1, 0, 0])
    for call in (
        lambda: m.accelerations(u=masked),
        lambda: m.collide("BcAc", mu=np.ma.masked_array([0.1, 0.2], [1, 0]), e=0.5, law="newton"),
        lambda: m.with_parameters(m=np.ma.masked_array([1.0, 2.0], [0, 1])),
        lambda: m.states({"u1": np.ma.masked_array([1.0], [1])}),
    ):
        with pytest.raises(hodograph.ArgumentError, match="masked"):
            call()
    np.testing.assert_array_equal(m.accelerations(u=np.ma.masked_array(u)), m.accelerations(u=u))
    for call in (
        lambda: m.with_parameters(m="3"),
        lambda: m.with_parameters(m=np.array(["3"])),
        lambda: m.states({"u1": ["1.0"]}),
        lambda: m.tabulate("accelerations", {"u1": ["1.0"]}),
        lambda: m.accelerations(u=["1", "1", "1", "1"]),
        lambda: m.with_parameters(m=True),
    ):
        with pytest.raises(hodograph.ArgumentError):
            call()
    # the sleds do not use the time
    for time in (np.nan, np.inf):
        with pytest.raises(hodograph.StateError, match="time"):
            m.accelerations(time=time)
        with pytest.raises(hodograph.HodographError, match="time"):
            m.collide("BcAc", time=time, mu=0.3, e=0.5, law="newton")
        with pytest.raises(hodograph.ArgumentError):
            m.simulate(1.0, 0.1, time=time)
    rows = m.accelerations(time=np.array([0.0, np.nan]), errors="nan")
    assert np.isfinite(rows[0]).all() and np.isnan(rows[1]).all()


def test_surfaces_that_the_model_states(tmp_path):
    name, surface = "spherical_pendulum", dict(mu=0.3, e=0.7, law="stronge")
    text = (ROOT / f"models/{name}.mech").read_text()
    stated = text.replace("+ 0.9*L }", "+ 0.9*L, surface: { mu: 0.3, e: 0.7, law: stronge } }")
    assert stated != text
    (tmp_path / f"{name}.mech").write_text(stated)
    # equations do not depend on surfaces: the derivation is the same
    (tmp_path / f"{name}.derivation").write_text((ROOT / f"models/{name}.derivation").read_text())
    m, plain = hodograph.load(tmp_path / f"{name}.mech"), model(name)
    assert m.surface("tip") == surface and plain.surface("tip") is None
    np.testing.assert_array_equal(m.collide("tip").speeds, plain.collide("tip", **surface).speeds)
    np.testing.assert_array_equal(m.collide("tip", e=0.1).speeds, plain.collide("tip", **{**surface, "e": 0.1}).speeds)
    np.testing.assert_array_equal(m.simulate(0.5, 0.1).q, plain.simulate(0.5, 0.1, **surface).q)
    with pytest.raises(hodograph.ArgumentError, match="mu"):
        plain.collide("tip")


def test_figures_keep_names_beside_lines():
    m = model("planar_double_pendulum")
    text = m.simulate(0.2, 0.01, mu=0.0, e=1.0, law="newton")._repr_html_()
    assert ">-0<" not in text and ">q1<" in text
    assert "1 contact>" in repr(m) and "2 speeds" in repr(m)


def test_simulate_under_control():
    m = model("puma_560")
    q0 = np.array([q.value for q in m.coordinates])
    # torques that make deviations die out
    hold = lambda time, q, u: m.inverse_dynamics(-100.0 * (q - q0) - 20.0 * u, q, u, np.zeros(6))
    rest = dict(q=q0, u=np.zeros(6), mu=0.0, e=0.0, law="poisson")
    for period in (None, 0.002):
        motion = m.simulate(0.1, 0.02, **rest, control=hold, period=period, tolerance=1e-6)
        assert abs(motion.q - q0).max() < 1e-2, period
    assert abs(m.simulate(0.1, 0.02, **rest, tolerance=1e-6).q - q0).max() > 0.02
    class Wrong(Exception):
        pass
    def wrong(time, q, u):
        raise Wrong("no torque")
    with pytest.raises(Wrong, match="no torque"):
        m.simulate(0.1, 0.02, **rest, control=wrong)
    with pytest.raises(hodograph.ArgumentError, match="gave 2 numbers: expected 6"):
        m.simulate(0.1, 0.02, **rest, control=lambda *state: [1.0, 2.0])
    with pytest.raises(hodograph.SimulationError) as caught:
        m.simulate(0.1, 0.02, **rest, control=lambda *state: [np.nan] * 6)
    assert caught.value.kind == "bad_input" and caught.value.number == 0.0
    with pytest.raises(hodograph.ArgumentError, match="period"):
        m.simulate(0.2, 0.02, period=0.1)


def test_tables_by_column_name():
    pandas, pyarrow = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    columns = {"u1": np.linspace(0.5, 1, 5), "u6": np.linspace(0, 0.2, 5)}
    expected = SLEDS.accelerations(**SLEDS.states(columns))
    assert expected.shape == (5, 4)
    for table in (pandas.DataFrame(columns), pyarrow.table(columns)):
        np.testing.assert_array_equal(SLEDS.accelerations(**SLEDS.states(table)), expected)
    with pytest.raises(hodograph.ArgumentError, match="no column `u9`.*u1") as caught:
        SLEDS.states({"u9": [1.0]})
    assert caught.value.place == "u9" and caught.value.kind == "unknown_name"


def test_parameters_by_row_are_those_of_one_mechanism_each():
    m = model("planar_double_pendulum")
    rows = 70
    masses, lengths = np.repeat(np.linspace(0.5, 2, rows // 2), 2), np.linspace(0.3, 0.8, rows)
    q, u = RANDOM.normal(size=(rows, 2)), RANDOM.normal(size=(rows, 2))
    for many, of in ((m.with_parameters(m2=masses, l1=0.6), [dict(m2=x, l1=0.6) for x in masses]), (m.with_parameters(m2=masses, l1=lengths), [dict(m2=x, l1=y) for x, y in zip(masses, lengths)])):
        alone = [m.with_parameters(**parameters) for parameters in of]
        for call in (
            lambda m, *s: m.accelerations(*s),
            lambda m, *s: m.mass_matrix(*s),
            lambda m, *s: m.linearise(*s).a,
            lambda m, *s: m.position("P2", *s),
            lambda m, *s: m.collide("tip_wall", *s, mu=0.2, e=0.6, law="stronge", errors="nan").speeds,
        ):
            found = call(many, q, u)
            assert len(found) == rows
            for row in range(rows):
                try:
                    expected = call(alone[row], q[row], u[row])
                except hodograph.ImpactError:
                    expected = np.full(2, np.nan)
                np.testing.assert_array_equal(found[row], expected)
    # one state serves all machines
    np.testing.assert_array_equal(many.accelerations()[3], alone[3].accelerations())
    assert many.parameters[1].name == "m2" and many.parameters[1].value.shape == (rows,)


def test_parameters_by_row_that_are_wrong():
    m = model("planar_double_pendulum")
    masses = np.ones(5)
    masses[3] = -1
    many = m.with_parameters(m1=masses)
    with pytest.raises(hodograph.ParameterError, match="row 3.*1 of 5") as caught:
        many.accelerations()
    assert caught.value.place == "row 3"
    found = many.accelerations(errors="nan")
    assert np.isnan(found[3]).all() and np.isfinite(np.delete(found, 3, axis=0)).all()
    with pytest.raises(hodograph.ParameterError, match="row 3"):
        many.collide("tip_wall", mu=0, e=1, law="newton")
    hits = many.collide("tip_wall", mu=0, e=1, law="newton", errors="nan")
    assert np.isnan(hits.speeds[3]).all() and hits.kind[3] != "" and hits.kind[0] == ""
    with pytest.raises(hodograph.ArgumentError, match="5 rows.*expected as many"):
        many.accelerations(np.zeros((4, 2)))
    with pytest.raises(hodograph.ArgumentError, match="different numbers of rows.*m1: 5.*m2: 4"):
        m.with_parameters(m1=np.ones(5), m2=np.ones(4))
    with pytest.raises(hodograph.ArgumentError, match=r"\(2, 2\)"):
        m.with_parameters(m1=np.ones((2, 2)))


def test_tables_in_and_out():
    pandas, pyarrow = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    columns = {"u1": np.linspace(0.5, 1, 5), "u6": np.linspace(0, 0.2, 5)}
    expected = SLEDS.accelerations(**SLEDS.states(columns))
    frame = pandas.DataFrame(columns, index=list("abcde"))
    found = SLEDS.tabulate("accelerations", frame)
    assert list(found.columns) == ["u1'", "u3'", "u4'", "u6'"] and list(found.index) == list("abcde")
    np.testing.assert_array_equal(found.to_numpy(), expected)
    found = SLEDS.tabulate("accelerations", pyarrow.table(columns))
    assert isinstance(found, pyarrow.Table)
    np.testing.assert_array_equal(np.column_stack([found[name] for name in found.column_names]), expected)
    assert SLEDS.tabulate("kinetic_energy", columns)["kinetic_energy"].shape == (5,)
    for table in (frame, pyarrow.table(columns)):
        hits = SLEDS.tabulate("collide", table, "BcAc", **SURFACE, errors="nan")
        direct = SLEDS.collide("BcAc", **SLEDS.states(columns), **SURFACE, errors="nan")
        np.testing.assert_array_equal(np.asarray(hits["u4"]), direct.speeds[:, 2])
        assert [str(word) for word in np.asarray(hits["kind"])] == list(direct.kind)
    # a column of parameters
    name = next(p.name for p in SLEDS.parameters if p.unit == "kg")
    masses = np.linspace(1, 2, 5)
    heavier = SLEDS.tabulate("accelerations", frame.assign(**{name: masses}))
    many = SLEDS.with_parameters(**{name: masses})
    np.testing.assert_array_equal(heavier.to_numpy(), many.accelerations(**SLEDS.states(columns)))
    assert not np.array_equal(heavier.to_numpy(), expected)
    with pytest.raises(hodograph.ArgumentError, match="mass_matrix.*there are: "):
        SLEDS.tabulate("mass_matrix", frame)


def test_parameters():
    first = SLEDS.parameters[0]
    other = SLEDS.with_parameters(**{first.name: first.value * 2})
    assert other.parameters[0].value == first.value * 2 and SLEDS.parameters[0].value == first.value
    assert not np.array_equal(other.mass_matrix(), SLEDS.mass_matrix())
    with pytest.raises(hodograph.ArgumentError, match="there are: |did you mean"):
        SLEDS.with_parameters(nonsense=1)
    mass = next(p.name for p in SLEDS.parameters if p.unit == "kg")
    with pytest.raises(hodograph.ParameterError):
        SLEDS.with_parameters(**{mass: -1.0})


@pytest.mark.parametrize(
    "call, kind, words",
    [
        (lambda: SLEDS.accelerations(u=np.zeros(3)), "wrong_length", "it must have 4 numbers, (4,) or (n, 4)"),
        (lambda: SLEDS.accelerations(u=np.zeros((2, 2, 4))), "wrong_shape", "(2, 2, 4)"),
        (lambda: SLEDS.accelerations(u=np.zeros(4, dtype=np.float32)), "wrong_dtype", "expected float64"),
        (lambda: SLEDS.accelerations(u=[1, 2]), "wrong_length", "(2,)"),
        (lambda: SLEDS.accelerations(u="text"), "wrong_type", "float64 array"),
        (lambda: SLEDS.accelerations(np.zeros((3, len(SLEDS.coordinates))), np.zeros((2, 4))), "wrong_shape", "3"),
        (lambda: SLEDS.collide("wall", **SURFACE), "unknown_name", "BcAc"),
        (lambda: SLEDS.collide("BcAc", mu=0.1, e=0.1, law="hooke"), "unknown_law", "there is no law `hooke`: give one of newton, poisson, stronge"),
        (lambda: SLEDS.collide("BcAc", mu=np.zeros((2, 2)), e=0.1, law="newton"), "wrong_type", "(n,)"),
        (lambda: SLEDS.accelerations(errors="ignore"), "unknown_option", "'nan'"),
        (lambda: SLEDS.position("nowhere"), "unknown_name", "nowhere"),
    ],
)
def test_wrong_arguments_say_what_was_expected(call, kind, words):
    with pytest.raises(hodograph.ArgumentError) as caught:
        call()
    assert caught.value.kind == kind and words in str(caught.value), str(caught.value)
    assert isinstance(caught.value, ValueError)


def test_numbers_that_are_none():
    u = np.tile([1.0, 0.1, 1.0, 0.1], (40, 1))
    u[35, 2] = np.nan
    with pytest.raises(hodograph.StateError, match="row 35.*NaN for u4.*1 of 40") as caught:
        SLEDS.accelerations(u=u)
    assert (caught.value.kind, caught.value.place) == ("not_finite", "row 35, u4") and np.isnan(caught.value.number)
    found = SLEDS.accelerations(u=u, errors="nan")
    assert np.isnan(found[35]).all() and np.isfinite(np.delete(found, 35, axis=0)).all()
    hits = SLEDS.collide("BcAc", u=u, errors="nan", **SURFACE)
    assert hits.kind[35] == "not_finite" and hits.path[35] == "" and hits.kind[0] == ""
    with pytest.raises(hodograph.ImpactError, match="lie between 0 and 1") as caught:
        hodograph.solve(MATRIX, APPROACH, mu=0.3, e=1.5, law="newton")
    assert caught.value.kind == "restitution_out_of_range" and caught.value.number == 1.5


def test_zero_rows_and_other_layouts():
    assert SLEDS.accelerations(u=np.zeros((0, 4))).shape == (0, 4)
    u = np.random.default_rng(1).normal(size=(4, 10)).T
    np.testing.assert_array_equal(SLEDS.accelerations(u=u), SLEDS.accelerations(u=np.ascontiguousarray(u)))
    np.testing.assert_array_equal(SLEDS.accelerations(u=u[::2]), SLEDS.accelerations(u=u)[::2])


def test_check_and_mistakes():
    assert hodograph.check(ROOT / "models/two_sleds.mech") == [] or hodograph.check(ROOT / "models/two_sleds.mech")[0].severity == "warning"
    wrong = "mechanism M;\nspeeds { u1: rad/s }\npoints { P = O + nowhere*N.x; }\n"
    diagnostics = hodograph.check(wrong)
    assert any(d.severity == "error" and d.line == 3 and d.code.startswith("E") for d in diagnostics)
    with pytest.raises(hodograph.ModelError) as caught:
        hodograph.load(wrong)
    assert caught.value.diagnostics and "line" in caught.value.place and caught.value.kind.startswith("E")


def test_a_model_without_derivation_is_evaluated_numerically(tmp_path):
    path = tmp_path / "m.mech"
    path.write_text((ROOT / "models/two_sleds.mech").read_text())
    with pytest.warns(UserWarning, match="numerically"):
        numeric = hodograph.load(path)
    q, u = ([x.value for x in xs] for xs in (SLEDS.coordinates, SLEDS.speeds))
    np.testing.assert_allclose(numeric.accelerations(q, u), SLEDS.accelerations(), atol=1e-12)
    (tmp_path / "m.derivation").write_text("nonsense")
    with pytest.raises(hodograph.DerivationError) as caught:
        hodograph.load(path)
    assert caught.value.kind == "damaged_derivation"


def test_threads_share_a_mechanism():
    u = np.random.default_rng(2).normal(size=(5000, 4))
    expected, found = SLEDS.accelerations(u=u), [None] * 4
    def work(i):
        found[i] = SLEDS.accelerations(u=u)
    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    [t.start() for t in threads], [t.join() for t in threads]
    assert all(np.array_equal(expected, f) for f in found)


def test_html_of_models():
    page = SLEDS._repr_html_()
    assert page.startswith("<iframe") and "math" in page and "\\" in SLEDS.equations("latex")


def test_everything_that_users_see_is_documented_and_annotated():
    import inspect

    for cls in (hodograph.Mechanism, hodograph.Simulation, hodograph.Simulations):
        for name, method in vars(cls).items():
            function = method.fget if isinstance(method, property) else method
            if inspect.isfunction(function) and not name.startswith("_"):
                assert name == "phases" or function.__doc__, name
                parameters = list(inspect.signature(function).parameters.values())[1:]
                assert all(p.annotation is not inspect.Parameter.empty for p in parameters), name
                assert "return" in function.__annotations__, name


def test_rolling_and_spinning_friction():
    m = model("shapes/billiard_balls")
    v, r, rolling, spinning = 1.0, 0.0286, 0.001, 0.0005
    q = [0, 0, r, 1, 0, 0, 0, 0, 5, r, 1, 0, 0, 0]
    u = [v, 0, 0, 0, v / r, 20, 0, 0, 0, 0, 0, 0]
    ends = v / (rolling / r * 9.81 / 1.4), 0.4 * r**2 * 20 / (spinning * 9.81)
    whole = dict(mu=0.3, e=0.5, law="poisson")
    motion = m.simulate(10.0, q=q, u=u, **whole, rolling=rolling, spinning=spinning)
    times = [next(event.time for event in motion.events if event.kind == kind) for kind in ("roll_ends", "spin_ends")]
    np.testing.assert_allclose(times, ends, rtol=1e-9)
    own = {contact: dict(whole, rolling=rolling, spinning=spinning) for contact in m.contacts}
    np.testing.assert_allclose(m.simulate(10.0, q=q, u=u, surfaces=own).q[-1], motion.q[-1], rtol=0, atol=1e-12)
    many = m.simulate_many(10.0, q=q, u=u, **whole, rolling=np.array([rolling, 2 * rolling]), spinning=spinning)
    np.testing.assert_allclose(many.q[0], motion.q[-1], rtol=0, atol=1e-12)
    assert many.q[1, 0] < 0.51 * many.q[0, 0]
    with pytest.raises(hodograph.HodographError, match="lever arm"):
        m.simulate(1.0, **whole, rolling=-1)
    with pytest.raises(hodograph.HodographError, match="derive it anew"):
        model("free_box_corner").simulate(1.0, **whole, spinning=0.1)


def test_laws_of_contact():
    m = model("free_box_corner")
    whole = dict(mu=0.3, e=0.5, law="stronge")
    plain = m.simulate(0.3, **whole)
    speed = -m.contact(m.contacts[0]).velocity[0]
    # the same numbers by a table, a function and a text
    for same in ([(0.0, 0.5)], lambda v: 0.5, "constant", "threshold(1e-9)"):
        motion = m.simulate(0.3, **whole, restitution=same, mu_impact=0.3, mu_static=0.3)
        np.testing.assert_allclose(motion.u, plain.u, rtol=1e-12, atol=1e-12)
    other = m.simulate(0.0, mu=0.3, e=0.9, law="stronge", restitution=[(0.0, 0.9), (2 * speed, 0.1)])
    by_hand = m.simulate(0.0, mu=0.3, e=0.5, law="stronge")
    np.testing.assert_allclose(other.events[0].u, by_hand.events[0].u, rtol=1e-12, atol=1e-12)
    one = m.simulate(0.0, surfaces={m.contacts[0]: dict(whole, mu_impact=0.1)})
    np.testing.assert_allclose(one.events[0].u, m.collide(m.contacts[0], mu=0.1, e=0.5, law="stronge").speeds, rtol=1e-12, atol=1e-12)
    for wrong in (dict(mu_static=0.1), dict(restitution="power(1)"), dict(restitution=3), dict(sliding="stribeck(0.1)")):
        with pytest.raises(hodograph.HodographError):
            m.simulate(0.3, **whole, **wrong)
    class Wrong(Exception):
        pass
    def fails(speed):
        if speed != 1.0:
            raise Wrong("no e")
        return 0.5
    with pytest.raises(Wrong, match="no e"):
        m.simulate(0.3, **whole, restitution=fails)


def test_draws_find_every_outcome_of_a_tie():
    m = hodograph.load(ROOT / "tests/data/many_contacts/groove_drop.mech")
    start = [0.0 if coordinate.name == "y" else coordinate.value or 0.0 for coordinate in m.coordinates]
    whole = dict(q=np.tile(start, (60, 1)), mu=0.0, e=0.5, law="newton")
    drawn = m.simulate_many(0.22, **whole, together="sampled", seed=7)
    ends = sorted(set(np.round(drawn.u[:, 1], 9)))
    assert len(ends) == 3 and ends[1] == 0.0 and ends[0] == -ends[2] < -0.1
    assert drawn.digest == m.simulate_many(0.22, **whole, together="sampled", seed=7, threads=1).digest
    one = m.simulate(0.22, q=start, mu=0.0, e=0.5, law="newton", together="sampled", seed=9)
    np.testing.assert_array_equal(one.u[-1], drawn.u[2])
    sequential = m.simulate(0.22, q=start, mu=0.0, e=0.5, law="newton", together="sequential")
    assert abs(sequential.u[-1, 1]) > 0.1
    with pytest.raises(hodograph.ArgumentError, match="expected one of approaching, sequential"):
        m.simulate(0.1, **SURFACE, together="random")
    for seed in (-1, 1.5, True):
        with pytest.raises(hodograph.ArgumentError, match="seed"):
            m.simulate(0.1, **SURFACE, together="sampled", seed=seed)


def test_simulate_many():
    m = model("free_box_corner")
    rows = 24
    mu = np.linspace(0.0, 0.9, rows)
    u = np.tile([speed.value or 0.0 for speed in m.speeds], (rows, 1))
    u[:, 0] += np.linspace(-1, 1, rows)
    all = m.simulate_many(0.4, u=u, mu=mu, e=0.4, law="poisson", threads=2)
    assert len(all) == rows and all.q.shape == (rows, len(m.coordinates)) and set(all.kind) <= {"rest", "moving"}
    back = m.simulate_many(0.4, u=u[::-1].copy(), mu=mu[::-1].copy(), e=0.4, law="poisson", threads=1)
    np.testing.assert_array_equal(all.q, back.q[::-1])
    assert all.digest == m.simulate_many(0.4, u=u, mu=mu, e=0.4, law="poisson").digest != back.digest
    one = m.simulate(0.4, 0.4, u=u[7], mu=mu[7], e=0.4, law="poisson")
    np.testing.assert_allclose(all.u[7], one.u[-1], rtol=1e-7, atol=1e-7)
    # a row that is wrong is wrong alone
    mu[3] = -1.0
    part = m.simulate_many(0.4, u=u, mu=mu, e=0.4, law="poisson")
    assert part.kind[3] == "negative_friction" and part.message[3] and np.isnan(part.q[3]).all()
    np.testing.assert_array_equal(np.delete(part.q, 3, axis=0), np.delete(all.q, 3, axis=0))
    assert list(part.columns())[0] == "kind" and "negative_friction" in repr(part)
    # parameters by rows
    name = m.parameters[0].name
    heavy = m.with_parameters(**{name: np.array([1.0, 2.0, 4.0]) * m.parameters[0].value})
    assert len(heavy.simulate_many(0.2, mu=0.3, e=0.2, law="newton")) == 3
    with pytest.raises(hodograph.ArgumentError, match="rows"):
        m.simulate_many(0.2, u=u, mu=mu[:4].copy(), e=0.2, law="newton")
    with pytest.raises(hodograph.ArgumentError, match="threads"):
        m.simulate_many(0.2, mu=0.3, e=0.2, law="newton", threads=0)
    def stop(done, rows):
        raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        m.simulate_many(60.0, u=np.tile(u, (40, 1)), mu=0.4, e=0.4, law="poisson", progress=stop)


def test_states_that_are_not_finite_are_refused_also_where_they_are_not_read():
    m = model("two_sleds")
    n, p = len(m.coordinates), len(m.speeds)
    calls = {
        "accelerations": m.accelerations, "mass_matrix": m.mass_matrix, "kinetic_energy": m.kinetic_energy,
        "position": lambda **state: m.position("P", **state) if "P" in m.points else m.position(m.points[1], **state),
        "collide": lambda **state: m.collide("BcAc", mu=0.6, e=0.8, law="stronge", **state),
    }
    for name, call in calls.items():
        for argument, width in (("q", n), ("u", p)):
            for index in range(width):
                for bad in (np.nan, np.inf):
                    numbers = np.ones(width)
                    numbers[index] = bad
                    with pytest.raises(hodograph.HodographError, match=f"`{argument}` holds"):
                        call(**{argument: numbers})
                    rows = np.ones((3, width))
                    rows[1, index] = bad
                    with pytest.raises(hodograph.HodographError, match="row 1"):
                        call(**{argument: rows})
        rows = np.tile([q.value for q in m.coordinates], (3, 1))
        rows[1, -1] = np.nan
        found = call(q=rows, errors="nan")
        found = found.impulse if name == "collide" else found
        assert np.isnan(found[1]).all() and np.isfinite(found[[0, 2]]).all(), name
    with pytest.raises(hodograph.StateError, match="`accelerations` holds"):
        m.inverse_dynamics(np.full(p, np.nan))


def test_motion_up_to_an_error_or_an_interrupt_is_kept():
    class Wrong(Exception):
        pass
    arm = model("puma_560")
    rest = dict(mu=0.0, e=0.0, law="poisson")
    def stops(time, q, u):
        if time > 0.05:
            raise Wrong("late")
        return np.zeros(6)
    with pytest.raises(Wrong, match="late") as caught:
        arm.simulate(0.1, 0.01, **rest, control=stops, period=0.01)
    assert 0.04 <= caught.value.motion.time[-1] <= 0.06
    whole = arm.simulate(0.04, 0.01, **rest, control=lambda *_: np.zeros(6), period=0.01)
    np.testing.assert_array_equal(caught.value.motion.q[:5], whole.q)
    # one that never began has none
    with pytest.raises(hodograph.SimulationError) as caught:
        model("planar_double_pendulum").simulate(1.0, 0.1, q=np.full(2, np.nan), mu=0.1, e=0.5, law="newton")
    assert caught.value.motion is None


def test_control_c_ends_a_motion():
    m = model("planar_double_pendulum")
    timer = threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT))
    # A shell that starts tests in the background has them ignore Ctrl-C.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    begin = clock.monotonic()
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt) as caught:
            # hours, if it were followed to its end
            m.simulate(1e6, 1e5, mu=0.3, e=0.99, law="stronge", tolerance=1e-12)
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    assert clock.monotonic() - begin < 30.0
    assert caught.value.motion.time[0] == 0.0 and len(caught.value.motion.time) >= 1


def test_contacts_without_gap_are_told():
    with pytest.warns(UserWarning, match="contact BcAc has no gap in the model: it is never seen to close"):
        model("two_sleds").simulate(0.01, 0.01)
    with pytest.warns(UserWarning, match="never seen to close"):
        model("two_sleds").simulate_many(0.01)
