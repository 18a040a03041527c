"""Functions of PyTorch: values, derivatives beside differences and known ones, rows, and a rod that is thrown to a target."""

from pathlib import Path

import hodograph
import numpy as np
import pytest

torch = pytest.importorskip("torch")
import hodograph.torch as functions  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]


def model(name):
    return hodograph.load(ROOT / f"models/{name}.mech")


def leaf(array):
    return torch.tensor(array, dtype=torch.float64, requires_grad=True)


def check(function, arguments, rtol=1e-5):
    """Derivatives agree with central differences along random directions."""
    random = np.random.default_rng(0)
    arguments = [leaf(argument) for argument in arguments]
    directions = [torch.tensor(random.normal(size=argument.shape)) for argument in arguments]
    found = function(*arguments)
    weights = torch.tensor(random.normal(size=found.shape))
    gradients = torch.autograd.grad((weights * found).sum(), arguments)
    along = sum((gradient * direction).sum() for gradient, direction in zip(gradients, directions))
    h = 1e-6
    moved = lambda s: function(*[a.detach() + s * d for a, d in zip(arguments, directions)])
    difference = ((moved(h) - moved(-h)) / (2 * h) * weights).sum()
    assert abs(along - difference) < rtol * sum(abs(gradient * direction).sum() for gradient, direction in zip(gradients, directions))


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
    np.testing.assert_array_equal(f(*rows), m.accelerations(*rows))
    # one state and many speeds: the gradient of the state is summed over the rows
    one, many = leaf(rows[0][0]), leaf(rows[1])
    f(one, many).sum().backward()
    by = m.accelerations_derivatives(np.tile(rows[0][0], (5, 1)), rows[1])
    np.testing.assert_allclose(one.grad, by.by_coordinates.sum(axis=(0, 1)), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(many.grad, by.by_speeds.sum(axis=1), rtol=1e-12, atol=1e-12)
    jacobian = torch.autograd.functional.jacobian(lambda u: f(q, u), torch.tensor(u))
    np.testing.assert_allclose(jacobian, m.accelerations_derivatives(q, u).by_speeds, rtol=1e-13, atol=1e-13)
    with pytest.raises(hodograph.ArgumentError, match="float64"):
        f(torch.zeros(7), torch.zeros(7))


def test_collisions():
    m = model("free_box_corner")
    contact = m.contacts[0]
    f = functions.collide(m, contact, "stronge")
    q = np.array([x.value for x in m.coordinates])
    u = np.array([0.3, -0.2, -1.0, 0.5, 0.4, -0.3][: len(m.speeds)])
    np.testing.assert_array_equal(f(q, u, 0.3, 0.5), m.collide(contact, q, u, mu=0.3, e=0.5, law="stronge").speeds)
    check(f, (q, u, 0.3, 0.5))
    mus = np.linspace(0.1, 0.5, 4)
    np.testing.assert_array_equal(f(q, u, mus, 0.5), m.collide(contact, q, u, mu=mus, e=0.5, law="stronge").speeds)
    check(lambda mu: f(q, u, mu, 0.5), (mus,))
    assert torch.isnan(f(q, -u * np.array([1, 1, 1, 0, 0, 0][: len(u)]), 0.3, 0.5)).all()


def test_a_rod_is_thrown_to_a_target():
    # A rod falls, bounces on the floor, and its centre must come to a place at a time: an optimiser of torch learns its first speeds.
    m = model("slender_rod_5dof")
    names = [x.name for x in m.coordinates]
    q = np.array([{"z": 1.0}.get(x.name, x.value) for x in m.coordinates])
    speeds = [x.name for x in m.speeds][:3]
    throw = functions.motion(m, speeds, 1.0, q=q, mu=0.2, e=0.6, law="poisson", tolerance=1e-9)
    place = [names.index(name) for name in ("x", "y", "z")]
    target = throw(torch.tensor([0.3, -0.2, -0.6], dtype=torch.float64))[0, place]
    check(throw, ([0.1, 0.05, -0.2],), rtol=1e-4)
    values = leaf([0.1, 0.05, -0.2])
    optimiser = torch.optim.LBFGS([values], line_search_fn="strong_wolfe", max_iter=60, tolerance_grad=1e-10, tolerance_change=1e-14)
    losses = []

    def missed():
        optimiser.zero_grad()
        loss = ((throw(values)[0, place] - target) ** 2).sum()
        loss.backward()
        losses.append(float(loss))
        return loss

    optimiser.step(missed)
    assert losses[0] > 1e-2 and losses[-1] < 1e-12, losses
    many = throw(torch.stack([values.detach(), 0.5 * values.detach()]))
    np.testing.assert_array_equal(many[0], throw(values.detach()))
    with pytest.raises(hodograph.ArgumentError, match="no derivative by `nothing`"):
        functions.motion(m, ["nothing"], 1.0, q=q, mu=0.2, e=0.6, law="poisson")
