"""Functions of JAX: values, derivatives beside differences, rows, and a small training loop."""

from pathlib import Path

import hodograph
import numpy as np
import pytest

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)
import hodograph.jax as functions  # noqa: E402
import jax.numpy as jnp  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]


def model(name):
    return hodograph.load(ROOT / f"models/{name}.mech")


def check(function, arguments, rtol=1e-5):
    """Forward and backward derivatives agree with central differences along random directions."""
    random = np.random.default_rng(0)
    arguments = tuple(jnp.asarray(argument) for argument in arguments)
    directions = tuple(jnp.asarray(random.normal(size=argument.shape)) for argument in arguments)
    _, forward = jax.jvp(function, arguments, directions)
    h = 1e-6
    moved = lambda s: np.asarray(function(*[a + s * d for a, d in zip(arguments, directions)]))
    difference = (moved(h) - moved(-h)) / (2 * h)
    np.testing.assert_allclose(forward, difference, rtol=rtol, atol=rtol * abs(difference).max())
    weights = random.normal(size=difference.shape)
    gradients = jax.grad(lambda *a: jnp.sum(weights * function(*a)), argnums=tuple(range(len(arguments))))(*arguments)
    backward = sum(np.sum(g * d) for g, d in zip(gradients, directions))
    np.testing.assert_allclose(backward, np.sum(weights * np.asarray(forward)), rtol=1e-9)


def test_dynamics():
    m = model("arm_7dof")
    random = np.random.default_rng(1)
    a, q, u = random.normal(size=(3, 7))
    f, g = functions.accelerations(m), functions.inverse_dynamics(m)
    w = np.array([x.value for x in m.inputs])
    np.testing.assert_array_equal(f(q, u), m.accelerations(q, u))
    check(f, (q, u, w))
    check(g, (a, q, u, w))
    rows = random.normal(size=(2, 5, 7))
    expected = m.accelerations(*rows)
    np.testing.assert_array_equal(jax.jit(jax.vmap(f))(*rows), expected)
    np.testing.assert_array_equal(jax.vmap(f, in_axes=(0, None))(rows[0], u), m.accelerations(rows[0], u))
    np.testing.assert_array_equal(f(*rows), expected)
    jacobian = jax.vmap(jax.jacfwd(f, argnums=1))(*rows)
    np.testing.assert_allclose(jacobian, m.accelerations_derivatives(*rows).by_speeds, rtol=1e-12, atol=1e-12)


def test_collisions():
    m = model("free_box_corner")
    contact = m.contacts[0]
    f = functions.collide(m, contact, "stronge")
    q = np.array([x.value for x in m.coordinates])
    u = np.array([0.3, -0.2, -1.0, 0.5, 0.4, -0.3][: len(m.speeds)])
    hit = m.collide(contact, q, u, mu=0.3, e=0.5, law="stronge")
    np.testing.assert_array_equal(f(q, u, 0.3, 0.5), hit.speeds)
    check(lambda *a: f(*a), (q, u, 0.3, 0.5))
    mus = jnp.linspace(0.1, 0.5, 4)
    found = jax.vmap(f, in_axes=(None, None, 0, None))(q, u, mus, 0.5)
    np.testing.assert_array_equal(found, m.collide(contact, q, u, mu=np.asarray(mus), e=0.5, law="stronge").speeds)
    away = f(q, -u * np.array([1, 1, 1, 0, 0, 0][: len(u)]), 0.3, 0.5)
    assert np.isnan(away).all()


def test_a_rod_is_thrown_to_a_target():
    # A rod falls, bounces on the floor, and its centre must come to a place at a time: its first speeds are learned.
    m = model("slender_rod_5dof")
    names = [x.name for x in m.coordinates]
    start = {"z": 1.0}
    q = np.array([start.get(x.name, x.value) for x in m.coordinates])
    speeds = [x.name for x in m.speeds][:3]
    throw = functions.motion(m, speeds, 1.0, q=q, mu=0.2, e=0.6, law="poisson", tolerance=1e-9)
    place = jnp.array([names.index(name) for name in ("x", "y", "z")])
    target = throw(jnp.array([0.3, -0.2, -0.6]))[0, place]
    values = jnp.array([0.1, 0.05, -0.2])
    check(throw, (values,), rtol=1e-4)
    missed = lambda first: throw(first)[0, place] - target
    before = jnp.linalg.norm(missed(values))
    # by the method of Gauss and Newton, with shorter steps where one leads away
    for _ in range(12):
        left = missed(values)
        if jnp.linalg.norm(left) < 1e-9:
            break
        step = jnp.linalg.solve(jax.jacfwd(missed)(values), left)
        while jnp.linalg.norm(missed(values - step)) > jnp.linalg.norm(left):
            step = 0.5 * step
        values = values - step
    assert jnp.linalg.norm(missed(values)) < 1e-9 and before > 0.1
    # and backward: the gradient of what is missed vanishes there
    gradient = jax.grad(lambda first: jnp.sum(missed(first) ** 2))
    assert jnp.linalg.norm(gradient(values)) < 1e-8 < jnp.linalg.norm(gradient(0.9 * values))
    many = jax.vmap(throw)(jnp.stack([values, 0.5 * values]))
    np.testing.assert_array_equal(many[0], throw(values))
    with pytest.raises(hodograph.ArgumentError, match="no derivative by `nothing`"):
        functions.motion(m, ["nothing"], 1.0, q=q, mu=0.2, e=0.6, law="poisson")
