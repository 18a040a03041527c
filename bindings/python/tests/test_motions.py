"""All that Rust tells of contacts and motions: modes, forces, energies, own events, derivatives, orbits, fits; pages, figures and recordings."""

from pathlib import Path

import hodograph
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
SURFACE = dict(mu=0.3, e=0.5, law="stronge")


def model(name):
    return hodograph.load(ROOT / f"models/{name}.mech")


BALL = """
//! A ball over a floor.
mechanism Ball;
parameters { m: kg = 1, g: m/s^2 = 10 }
coordinates { x: m = 0, z: m = 1 }
speeds { vx: m/s = 0, vz: m/s = 0 }
points { P = O + x*N.x + z*N.z; }
particles { Ball { point: P, mass: m } }
loads { gravity: -g*N.z; }
kinematics { d(x)/dt = vx; d(z)/dt = vz; }
contacts { floor { point: P, normal: N.z, gap: z } }
"""


@pytest.fixture(scope="module")
def box():
    return model("free_box_corner")


def test_orientations_and_accelerations_of_points():
    m = model("arm_7dof")
    rng = np.random.default_rng(1)
    q, u = rng.normal(size=(5, len(m.coordinates))), rng.normal(size=(5, len(m.speeds)))
    turned = m.orientation(m.frames[-1], q)
    np.testing.assert_allclose(turned @ np.swapaxes(turned, -1, -2), np.tile(np.eye(3), (5, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(turned), 1, atol=1e-12)
    # the acceleration is the rate of the velocity along the motion
    point, h = m.points[-1], 1e-6
    rates, accelerations = m.coordinate_rates(q, u), m.accelerations(q, u)
    difference = (m.velocity(point, q + h * rates, u + h * accelerations) - m.velocity(point, q - h * rates, u - h * accelerations)) / (2 * h)
    np.testing.assert_allclose(m.acceleration(point, q=q, u=u), difference, rtol=1e-6, atol=1e-6)
    change = m.acceleration(point, accelerations + 1.0, q, u) - m.acceleration(point, accelerations, q, u)
    np.testing.assert_allclose(change, m.jacobian(point, q, u).sum(axis=-1), rtol=1e-9, atol=1e-9)
    with pytest.raises(hodograph.ArgumentError, match="no frame `nowhere`"):
        m.orientation("nowhere")


def test_modes_and_forces_of_closed_contacts(box):
    contact = box.contacts[0]
    at_rest = np.zeros(len(box.speeds))
    held = box.contact_mode(contact, u=at_rest, mu=0.9)
    n, one, two = held.normal, held.first, held.second
    np.testing.assert_allclose(held.force @ np.array([n, one, two]), held.force_on_point, atol=1e-12)
    assert held.force[0] > 0 and held.mode in ("stick", "begin_slip") and held.selection == "unique"
    # what the force does to the speeds is M^-1 V^T of it
    of = box.contact(contact, u=at_rest)
    np.testing.assert_allclose(held.accelerations, box.accelerations(u=at_rest) + of.response @ held.force, rtol=1e-12)
    np.testing.assert_allclose(of.partial_velocities @ held.accelerations - of.partial_velocities @ box.accelerations(u=at_rest), held.acceleration - held.free_acceleration, atol=1e-9)
    many = box.contact_mode(contact, u=at_rest, mu=np.array([0.0, 0.3, 0.9]))
    assert many.force.shape == (3, 3) and many.mode[0] == "begin_slip" and abs(many.force[0, 1:]).max() == 0
    np.testing.assert_array_equal(many.force[2], held.force)
    apart = box.contact_force(contact, "separate", u=at_rest, mu=0.3)
    assert not apart.force.any() and apart.mode == "separate"
    with pytest.raises(hodograph.ArgumentError, match="'glide'.*stick"):
        box.contact_force(contact, "glide", mu=0.3)
    with pytest.raises(hodograph.HodographError):
        box.contact_mode(contact, u=at_rest, mu=-1.0)
    assert box.contact_mode(contact, u=np.tile(at_rest, (2, 1)), mu=np.array([0.1, -1.0]), errors="nan").kind[1] == "negative_friction"


@pytest.mark.parametrize("name", ["free_box_corner", "spherical_pendulum", "planar_double_pendulum"])
def test_derivatives_of_collisions_are_those_of_differences(name):
    m = model(name)
    contact = m.contacts[0]
    rng = np.random.default_rng(2)
    rows = 30
    q0 = np.array([q.value for q in m.coordinates])
    q = q0 + 0.05 * rng.normal(size=(rows, len(q0)))
    u = rng.normal(size=(rows, len(m.speeds)))
    hits = m.collide(contact, q, u, **SURFACE, errors="nan")
    # quaternions have four columns of independent components; differences leave the sphere, derivatives do as well
    found = m.collide_derivative(contact, q, u, **SURFACE, errors="nan")
    good = (hits.kind == "") & found.smooth & np.array([not flags for flags in hits.sensitivity])
    assert good.sum() > 5
    np.testing.assert_array_equal(found.speeds, hits.speeds)
    h = 1e-6
    after = lambda q, u, **surface: m.collide(contact, q, u, **{**SURFACE, **surface}, errors="nan").speeds
    close = lambda by, plus, minus: np.testing.assert_allclose(by[good], (plus - minus)[good] / (2 * h), rtol=2e-5, atol=2e-5)
    for k in range(u.shape[1]):
        step = h * np.eye(u.shape[1])[k]
        close(found.by_speeds[..., k], after(q, u + step), after(q, u - step))
    for column, k in enumerate(m._independent):
        step = h * np.eye(q.shape[1])[k]
        close(found.by_coordinates[..., column], after(q + step, u), after(q - step, u))
    close(found.by_mu, after(q, u, mu=0.3 + h), after(q, u, mu=0.3 - h))
    close(found.by_e, after(q, u, e=0.5 + h), after(q, u, e=0.5 - h))
    one = int(np.flatnonzero(good)[0])
    np.testing.assert_allclose(m.collide_derivative(contact, q[one], u[one], **SURFACE).by_speeds, found.by_speeds[one], rtol=1e-12)


def test_saltation_is_that_of_the_whole_motion():
    m = model("planar_double_pendulum")
    surface = dict(mu=0.2, e=0.6, law="poisson")
    before = m.simulate(2.0, 0.01, **surface, stop="collision")
    hit = before.events[-1]
    assert hit.kind == "collision" and before.time[-1] == hit.time
    matrix = m.saltation(hit.contact, hit.q, hit.speeds_before, **surface)
    # an instant before and after, by the derivatives of a motion
    start = m.simulate(hit.time - 1e-4, 0.01, **surface)
    gradient = m.gradient(["q1", "q2", "u1", "u2"], [hit.time + 1e-4], q=start.q[-1], u=start.u[-1], time=start.time[-1], **surface)
    found = np.concatenate([gradient.q_by[0], gradient.u_by[0]])
    np.testing.assert_allclose(found, matrix, atol=5e-2 * abs(matrix).max())
    assert abs(matrix - np.eye(4)).max() > 0.1


def test_what_is_told_of_a_motion(box):
    motion = box.simulate(2.0, 0.01, mu=0.3, e=0.0, law="poisson", tolerance=1e-9)
    k, c = len(motion.time), len(box.contacts)
    assert motion.forces.shape == (k, c, 3) and motion.phases.shape == (k, c) and motion.inputs.shape == (k, len(box.inputs))
    assert not motion.forces[motion.phases == "open"].any()
    closed = motion.phases != "open"
    assert closed.any() and (motion.forces[closed][:, 0] >= 0).all()
    sliding = motion.phases == "slide"
    friction = np.linalg.norm(motion.forces[sliding][:, 1:], axis=-1)
    np.testing.assert_allclose(friction, 0.3 * motion.forces[sliding][:, 0], rtol=1e-6, atol=1e-9)
    gaps = motion.gaps()
    assert set(gaps) == {name for name in box.contacts} and all((gap > -1e-7).all() for gap in gaps.values())
    energies = motion.energies()
    np.testing.assert_allclose(energies["total"], energies["kinetic"] + energies["potential"])
    account = motion.account
    change = account["kinetic"] + account["potential"] - energies["total"][0]
    # what was lost at the start is no part of the first sample's energy
    started = sum(event.energy_change or 0.0 for event in motion.events if event.time == 0)
    assert change == pytest.approx(account["friction"] + account["impacts"] + account["inputs"] - started, abs=1e-6)
    first = motion.events[0]
    assert first.speeds_before is not None and first.speeds_before.shape == first.u.shape
    contact = next((event for event in motion.events if event.kind == "contact"), None)
    assert contact is None or contact.mode in ("stick", "slide", "begin_slip")


def test_own_events_and_stops():
    with pytest.warns(UserWarning, match="numerically"):
        ball = hodograph.load(BALL)
    speeds = dict(u=[1, 3], mu=0.0, e=0.8, law="newton", tolerance=1e-10)
    motion = ball.simulate(3.0, events={"apex": lambda t, q, u: u[1]}, **speeds)
    apex = [event for event in motion.events if event.kind == "apex"]
    assert apex[0].time == pytest.approx(0.3, abs=1e-9) and apex[0].q[1] == pytest.approx(1.45, abs=1e-9)
    first = ball.simulate(3.0, stop="collision", **speeds)
    assert first.events[-1].kind == "collision" and first.time[-1] == first.events[-1].time < 1
    second = ball.simulate(3.0, events={"apex": lambda t, q, u: u[1]}, stop=["apex"], **speeds)
    assert second.time[-1] == pytest.approx(0.3, abs=1e-9)
    many = ball.simulate_many(3.0, q=[[0, 1], [0, 2], [0, 3]], mu=0.0, e=0.5, law="newton", tolerance=1e-10, stop="collision")
    assert set(many.kind) == {"stopped"}
    np.testing.assert_allclose(many.time, np.sqrt(2 * np.array([1, 2, 3]) / 10), atol=1e-9)
    assert (many.collisions == 1).all()
    for wrong in (dict(stop="apex"), dict(events={"rest": lambda t, q, u: 1.0}), dict(stop=["colision"])):
        with pytest.raises(hodograph.ArgumentError):
            ball.simulate(1.0, **wrong, **speeds)
    class Wrong(Exception):
        pass
    def fails(t, q, u):
        raise Wrong("no number")
    with pytest.raises(Wrong):
        ball.simulate(1.0, events={"apex": fails}, **speeds)


def test_gradients_of_motions_are_those_of_differences():
    m = model("planar_double_pendulum")
    by = ["q1", "u2", "m1", "mu", "e"]
    surface = dict(mu=0.2, e=0.6, law="poisson")
    found = m.gradient(by, [0.1, 0.5], **surface)
    assert found.q_by.shape == (2, 2, 5) and found.undefined is None and found.by == tuple(by)
    struck = [event for event in found.events if event.kind == "collision"]
    assert struck and struck[0].time_by.shape == (5,) and struck[0].after_by.shape == (4, 5)
    h = 1e-6
    names = {q.name: q.value for q in (*m.coordinates, *m.speeds)}
    def end(**change):
        state = {name: change.get(name, value) for name, value in names.items()}
        parameters = {name: value for name, value in change.items() if name not in names and name not in ("mu", "e")}
        other = m.with_parameters(**parameters) if parameters else m
        motion = other.simulate(0.5, 0.5, q=[state["q1"], state["q2"]], u=[state["u1"], state["u2"]], **{**surface, **{k: v for k, v in change.items() if k in ("mu", "e")}})
        return np.concatenate([motion.q[-1], motion.u[-1]])
    values = {**names, "m1": next(p.value for p in m.parameters if p.name == "m1"), **surface}
    for column, name in enumerate(by):
        difference = (end(**{name: values[name] + h}) - end(**{name: values[name] - h})) / (2 * h)
        exact = np.concatenate([found.q_by[-1], found.u_by[-1]])[:, column]
        np.testing.assert_allclose(exact, difference, rtol=1e-4, atol=1e-4)
    with pytest.raises(hodograph.ArgumentError, match="no derivative by `nothing`"):
        m.gradient(["nothing"], [0.1], **surface)


def test_gradients_backwards_are_those_forwards():
    m = model("planar_double_pendulum")
    by = [c.name for c in (*m.coordinates, *m.speeds, *m.parameters)] + ["mu", "e"]
    surface, times = dict(mu=0.2, e=0.6, law="poisson"), [0.1, 0.5]
    forwards = m.gradient(by, times, **surface)
    every = np.concatenate([forwards.q_by, forwards.u_by], axis=1)
    weights = np.random.default_rng(5).normal(size=(3, 2, 4))
    backwards = m.adjoint(by, times, weights, **surface)
    np.testing.assert_allclose(backwards.by, np.einsum("mkx,kxv->mv", weights, every), rtol=1e-9, atol=1e-9 * abs(every).max())
    # the gradient of half the squares of the states
    squares = m.adjoint(by, times, lambda q, u: np.concatenate([q, u], axis=1), **surface)
    states = np.concatenate([squares.q, squares.u], axis=1)
    assert squares.by.shape == (len(by),)
    np.testing.assert_allclose(squares.by, np.einsum("kx,kxv->v", states, every), rtol=1e-9, atol=1e-9 * abs(every).max())
    with pytest.raises(hodograph.ArgumentError, match="expected"):
        m.adjoint(by, times, np.zeros((2, 3)), **surface)
    # four corners that strike at once
    cube = hodograph.load(ROOT / "simulation/models/measured_cube.mech")
    with pytest.raises(hodograph.SimulationError, match="several contacts") as raised:
        cube.adjoint(["mu"], 0.5, np.ones(13), q=[0, 0, 0.3, 1, 0, 0, 0], u=np.zeros(6), mu=0.2, e=0.4, law="poisson")
    assert raised.value.kind == "not_differentiable"


def test_gradients_by_samples_of_inputs():
    hopper = hodograph.load(ROOT / "simulation/models/hopper.mech")
    values = np.array([[0.3, 0.6], [-0.5, 0.605], [0.8, 0.61], [0.1, 0.6]])
    by = ["tau[0]", "rest[1]", "tau", "rest[3]"]
    start = dict(q=[0, 0.68, 0.05, -0.04, 0.6], u=[0.2, 0, 0.1, 0, 0], mu=0.9, e=0.0, law="newton")
    def at(values):
        found = hopper.gradient(by, 0.19, **start, samples=(0.05, values))
        assert found.undefined is None
        return found
    found = at(values)
    every = np.concatenate([found.q_by[0], found.u_by[0]])
    for column, (rows, input) in enumerate([(0, 0), (1, 1), (slice(None), 0), (3, 1)]):
        h = 1e-6
        def end(h, rows=rows, input=input):
            changed = values.copy()
            changed[rows, input] += h
            other = at(changed)
            return np.concatenate([other.q[0], other.u[0]])
        np.testing.assert_allclose(every[:, column], (end(h) - end(-h)) / (2 * h), rtol=1e-4, atol=1e-4 * abs(every[:, column]).max())
    weights = np.arange(10.0)
    backwards = hopper.adjoint(by, 0.19, weights, **start, samples=(0.05, values))
    np.testing.assert_allclose(backwards.by, weights @ every, rtol=1e-8, atol=1e-8 * abs(every).max())
    with pytest.raises(hodograph.ArgumentError, match="there is no sample 4"):
        hopper.gradient("tau[4]", 0.1, **start, samples=(0.05, values))


def test_a_compass_walks_as_its_legs_change():
    compass = hodograph.load(ROOT / "simulation/gradients/tests/models/compass_walker.mech")
    legs = {"q1": "q2", "q2": "q1", "u1": "u2", "u2": "u1"}
    walk = dict(event="collision", contact="second", reset=["x"], mu=2.0, e=0.0, law="poisson")
    step = compass.orbit(exchange=legs, **walk)
    assert step.period == pytest.approx(0.734346391159, abs=1e-10) and step.stable
    assert step.multipliers[2].real == pytest.approx(0.131572624, abs=1e-8)
    divided = compass.orbit(exchange=legs, segments=3, **walk)
    assert divided.period == pytest.approx(step.period, abs=1e-11) and len(divided.nodes) == 3
    time, q, u = divided.nodes[1]
    assert 0 < time < step.period and q.shape == (4,) and u.shape == (4,)
    with pytest.raises(hodograph.ArgumentError, match="at least one segment"):
        compass.orbit(exchange=legs, segments=0, **walk)
    with pytest.raises(hodograph.ArgumentError, match="no coordinate or independent speed `q7`"):
        compass.orbit(exchange={"q1": "-q7"}, **walk)


def test_orbits_and_branches_of_the_bouncing_ball_on_a_plate():
    m = hodograph.load(ROOT / "simulation/gradients/tests/models/ball_on_plate.mech")
    a, g, w, e = 0.002, 9.81, 60.0, 0.7
    # It leaves the plate with the speed of half a period of flight, where the plate has the speed (1 - e)/(1 + e) of it.
    period, plate = 2 * np.pi / w, g * np.pi / w * (1 - e) / (1 + e)
    phase = np.arccos(plate / (a * w))
    begin = phase / w + 0.01
    flight = 0.01
    exact = [a * np.sin(phase) + g * np.pi / w * flight - g * flight**2 / 2, g * np.pi / w - g * flight]
    surface = dict(time=begin, period=period, mu=0.0, e=e, law="newton")
    orbit = m.orbit([exact[0] + 2e-4], [exact[1] - 5e-3], by=["a"], **surface)
    np.testing.assert_allclose([*orbit.q, *orbit.u], exact, atol=1e-12)
    assert np.prod(orbit.multipliers).real == pytest.approx(e**2, abs=1e-11) and orbit.stable and orbit.by.shape == (2, 1)
    assert [event[1] for event in orbit.events] == ["collision"]
    branch = m.branch("a", a, 0.004, exact[:1], exact[1:], **surface)
    doubling = np.hypot(2 * g * (1 + e * e) / ((1 + e) ** 2 * w * w), plate / w)
    assert [kind for kind, *_ in branch.changes] == ["period_doubling"] and branch.changes[0][1] == pytest.approx(doubling, abs=1e-11)
    assert branch.ended is None and branch.values[-1] > 0.0039 and len(branch.orbits) == len(branch.values)
    with pytest.raises(hodograph.ArgumentError, match="'rest'.*collision"):
        m.orbit(exact[:1], exact[1:], event="rest", mu=0.0, e=e, law="newton")
    with pytest.raises(hodograph.SimulationError, match="does not return") as caught:
        m.orbit(exact[:1], exact[1:], time=begin, event="stick", longest=0.05, mu=0.0, e=e, law="newton")
    assert caught.value.kind == "no_return"


def thrown(m, rng, count, until, surface):
    """Motions from starts near that of the model and outside of what it can touch, as tables."""
    drawn = np.array([[q.value + 0.1 * rng.normal() for q in m.coordinates] for _ in range(10 * count)])
    starts = drawn[m.gap(m.contacts[0], drawn) > 0][:count]
    assert len(starts) == count
    return [m.simulate(until, 0.02, q=start, **surface).columns() for start in starts]


def measured(motion, rng):
    """The same with an error of 1e-3 in all rows but the first."""
    error = lambda column: 1e-3 * np.r_[0, rng.normal(size=len(column) - 1)]
    return {name: column if name == "time" else column + error(column) for name, column in motion.items()}


def test_starts_are_fitted_to_flight_and_several_are_tried():
    m, surface, rng = model("planar_double_pendulum"), dict(mu=0.2, e=0.6, law="poisson"), np.random.default_rng(7)
    motions = thrown(m, rng, 3, 0.6, surface)
    flights = [min(event.time for event in m.simulate(0.6, 0.02, q=[motion[q.name][0] for q in m.coordinates], **surface).events) for motion in motions]
    flight = 0.9 * min(flights)
    names = [*(q.name for q in m.coordinates), *(u.name for u in m.speeds)]
    exact = [np.array([motion[name][0] for name in names]) for motion in motions]
    for motion in motions:
        for name in names:
            motion[name] = motion[name].copy()
            motion[name][0] += 1e-4
    found = m.fit("e", motions, errors={name: 1e-4 for name in names}, flight=flight, starts=3, horizons=[0.4], seed=2, **{**surface, "e": 0.5})
    assert found.values["e"] == pytest.approx(0.6, abs=1e-3) and 1 <= len(found.minima) <= 3
    assert found.minima[0][1] == found.rms <= found.minima[-1][1]
    for place, (state, errors, covariance, rms) in enumerate(found.starts.values()):
        # One row of many is off, so the fit is nearer to the truth than that row.
        assert np.all(np.abs(state - exact[place]) < 1e-4) and covariance.shape == (len(names), len(names)) and rms < 1.0
        np.testing.assert_allclose(errors, np.sqrt(np.diag(covariance)))
    with pytest.raises(hodograph.ArgumentError, match="shorter flight"):
        m.fit("e", motions, flight=10.0, **surface)


def test_parameters_are_fitted_to_motions():
    m, surface, rng = model("planar_double_pendulum"), dict(mu=0.2, e=0.6, law="poisson"), np.random.default_rng(7)
    motions = thrown(m, rng, 4, 0.6, surface)
    mass = next(p.value for p in m.parameters if p.name == "m1")
    fit = m.with_parameters(m1=1.1 * mass).fit(["m1", "e"], motions, mu=0.2, e=0.55, law="poisson")
    assert fit.values["m1"] == pytest.approx(mass, rel=1e-6) and fit.values["e"] == pytest.approx(0.6, abs=1e-6)
    assert fit.surfaces[m.contacts[0]]["e"] == fit.values["e"] and fit.rms < 1e-6 and fit.correlations.shape == (2, 2)
    noisy = [measured(motion, rng) for motion in motions]
    fit = m.fit(["e"], noisy, outputs=["q1", "q2"], errors={"q1": 1e-3, "q2": 1e-3}, bootstrap=3, **{**surface, "e": 0.55})
    assert abs(fit.values["e"] - 0.6) < 5 * fit.errors["e"] and fit.rms == pytest.approx(1.0, abs=0.3) and fit.spread["e"] > 0
    noisy[1]["q1"] = noisy[1]["q1"] + 0.2
    robust = m.fit(["e"], noisy, outputs=["q1", "q2"], errors={"q1": 1e-3, "q2": 1e-3}, huber=3.0, **{**surface, "e": 0.55})
    assert robust.outliers > 10 and fit.outliers == 0 and abs(robust.values["e"] - 0.6) < 0.01
    with pytest.raises(hodograph.ArgumentError, match="exclude each other"):
        m.fit(["e"], noisy, huber=3.0, cap=3.0, **surface)
    with pytest.raises(hodograph.ArgumentError, match="there is no column of a motion `time`"):
        m.fit(["e"], [{"q1": [0.0]}], **surface)


def test_predictions_of_motions_are_judged():
    m, surface, rng = model("planar_double_pendulum"), dict(mu=0.2, e=0.6, law="poisson"), np.random.default_rng(11)
    motions = [measured(motion, rng) for motion in thrown(m, rng, 6, 0.5, surface)]
    compared = dict(outputs=["q1", "q2"], errors={"q1": 1e-3, "q2": 1e-3}, **surface)
    judged = m.validate({"e": 0.6}, motions, noise={"q1": 1e-3, "q2": 1e-3}, floor=True, **compared)
    assert judged.mean == pytest.approx(1.0, abs=0.2) and judged.median < 2 and not judged.failed and (judged.at_rest > 50).all()
    assert (judged.floor <= judged.errors + 1e-9).all() and (judged.noise > 0.5).all() and judged.predictions[0].shape == (25, 2)
    # the error of a motion is what its predictions say
    off = (judged.predictions[2] - np.column_stack([motions[2]["q1"], motions[2]["q2"]])[1:]) / 1e-3
    assert judged.errors[2] == pytest.approx(np.sqrt((off**2).mean()), rel=1e-12)
    wrong = m.validate({"e": 0.1}, motions, **compared)
    difference = judged.against(wrong)
    assert difference["count"] == 6 and difference["mean"] == pytest.approx(judged.mean - wrong.mean) and difference["mean"] < 0
    assert difference["p"] == pytest.approx(2 / 2**6) if difference["nearer"] == 6 else difference["p"] > 2 / 2**6
    right = judged.right({"q1": 5e-3})
    assert right["right"] == right["count"] == 6 and right["interval"][0] < 1 == right["share"]
    assert judged.right({"q1": 1e-9})["right"] == 0 and "Validation of 6 motions" in repr(judged)
    with pytest.raises(hodograph.ArgumentError, match="q9"):
        judged.right({"q9": 1.0})
    with pytest.raises(hodograph.ArgumentError, match="expected predictions of the same motions"):
        judged.against(m.validate({"e": 0.6}, motions[:2], **compared))
    with pytest.raises(hodograph.ArgumentError, match="nothing"):
        m.validate({"nothing": 0.6}, motions, **compared)
    with pytest.raises(hodograph.ArgumentError, match="seed"):
        m.validate({"e": 0.6}, motions, seed=-1, **compared)


def test_pages_figures_and_recordings_of_motions_whatever_made_them(tmp_path):
    m = model("puma_560")
    q0 = np.array([q.value for q in m.coordinates])
    hold = lambda time, q, u: m.inverse_dynamics(-100.0 * (q - q0) - 20.0 * u, q, u, np.zeros(6))
    held = m.simulate(0.1, 0.02, q=q0, u=np.zeros(6), mu=0.0, e=0.0, law="poisson", control=hold, period=0.01, tolerance=1e-6)
    assert abs(held.inputs).max() > 0
    struck = model("free_box_corner").simulate(0.3, **SURFACE)
    for motion in (held, struck):
        page = motion.html(tmp_path / "motion.html")
        assert page.startswith("<!") and motion.mechanism.name in page and (tmp_path / "motion.html").read_text() == page
        assert "<svg" in motion.figure(tmp_path / "motion.svg.html") and "coordinates" in motion.figure()
        recording = motion.mcap(tmp_path / "motion.mcap")
        assert recording.startswith(b"\x89MCAP0\r\n") and (tmp_path / "motion.mcap").read_bytes() == recording
    assert "collision" in struck.html()
    with pytest.raises(hodograph.ArgumentError, match="times in a recording"):
        model("free_box_corner").simulate(0.0, time=-1.0, **SURFACE).mcap()


def test_the_page_is_that_of_the_tool(tmp_path):
    import os
    import subprocess

    tool = os.environ.get("HODOGRAPH_TOOL")
    if not tool:
        pytest.skip("HODOGRAPH_TOOL names no tool")
    path = tmp_path / "tool.html"
    model_path = str(ROOT / "models/free_box_corner.mech")
    subprocess.run([tool, "simulate", model_path, "--until", "0.3", "--mu", "0.3", "--e", "0.5", "--law", "stronge", "--html", str(path), "--mcap", str(tmp_path / "tool.mcap")], check=True, capture_output=True)
    motion = hodograph.load(model_path).simulate(0.3, **SURFACE)
    assert motion.html() == path.read_text()
    assert motion.mcap() == (tmp_path / "tool.mcap").read_bytes()
