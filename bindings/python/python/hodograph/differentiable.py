"""Functions of rows with their derivatives, in numpy: what :mod:`hodograph.jax` and :mod:`hodograph.torch` make functions of their kind of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np

from .arguments import number, numbers
from .mechanism import Mechanism

Rows = Callable[..., Any]


@dataclass(frozen=True)
class Differentiable:
    """A function of arrays of rows. ``values`` answers (n, *shape); ``derivatives`` the same and, for each argument, the derivatives by it, (n, *shape,
    *argument). ``arguments`` are the shapes of a row of each argument: () or (k,). Rows without an answer are NaN."""

    values: Rows
    derivatives: Rows
    shape: tuple[int, ...]
    arguments: Sequence[tuple[int, ...]]

    @property
    def shapes(self) -> list[tuple[int, ...]]:
        """The shapes of a row of what ``derivatives`` answers."""
        return [self.shape, *(self.shape + argument for argument in self.arguments)]

    def leading(self, *arrays: Any) -> tuple[int, ...]:
        """The axes before those of a row, which all arguments share after broadcasting."""
        return np.broadcast_shapes(*(tuple(array.shape)[: len(array.shape) - len(own)] for array, own in zip(arrays, self.arguments)))

    def over_rows(self, function: Rows, shapes: Sequence[tuple[int, ...]], *arrays: Any) -> tuple[Any, ...]:
        """Calls ``values`` or ``derivatives`` with arrays of any leading axes."""
        lead = self.leading(*arrays)
        count, flat = int(np.prod(lead)), []
        for array, own in zip(arrays, self.arguments):
            flat.append(np.ascontiguousarray(np.broadcast_to(array, lead + own)).reshape(count, *own))
        found = function(*flat)
        return tuple(np.asarray(part).reshape(lead + shape) for part, shape in zip(found, shapes))


def held_inputs(mechanism: Mechanism) -> Any:
    """The inputs of the model."""
    return np.array([quantity.value for quantity in mechanism.inputs], dtype=np.float64)


def _sizes(mechanism: Mechanism) -> tuple[int, int, int]:
    return len(mechanism.coordinates), len(mechanism.speeds), len(mechanism.inputs)


def _by_all(mechanism: Mechanism, by: Any) -> Any:
    """Derivatives by all coordinates: those by the dependent ones, which follow, are zero."""
    full = np.zeros((*by.shape[:-1], len(mechanism.coordinates)))
    full[..., np.array(mechanism._independent, dtype=int)] = by
    return full


def accelerations(mechanism: Mechanism) -> Differentiable:
    """u' of q, u and inputs."""
    n, p, w = _sizes(mechanism)

    def values(q: Any, u: Any, inputs: Any) -> Any:
        return (mechanism.accelerations(q, u, inputs, errors="nan"),)

    def derivatives(q: Any, u: Any, inputs: Any) -> Any:
        value, by_q, by_u, by_inputs = mechanism.accelerations_derivatives(q, u, inputs, errors="nan")
        return value, _by_all(mechanism, by_q), by_u, by_inputs

    return Differentiable(values, derivatives, (p,), [(n,), (p,), (w,)])


def inverse_dynamics(mechanism: Mechanism) -> Differentiable:
    """Generalised forces of u', q, u and inputs."""
    n, p, w = _sizes(mechanism)

    def values(a: Any, q: Any, u: Any, inputs: Any) -> Any:
        return (mechanism.inverse_dynamics(a, q, u, inputs, errors="nan"),)

    def derivatives(a: Any, q: Any, u: Any, inputs: Any) -> Any:
        value, by_q, by_u, by_inputs = mechanism.inverse_dynamics_derivatives(a, q, u, inputs, errors="nan")
        return value, mechanism.mass_matrix(q, u, inputs, errors="nan"), _by_all(mechanism, by_q), by_u, by_inputs

    return Differentiable(values, derivatives, (p,), [(p,), (n,), (p,), (w,)])


def collide(mechanism: Mechanism, contact: str, law: str) -> Differentiable:
    """The speeds after a collision, of q, u, mu, e and inputs."""
    n, p, w = _sizes(mechanism)

    def values(q: Any, u: Any, mu: Any, e: Any, inputs: Any) -> Any:
        return (mechanism.collide(contact, q, u, inputs, mu=mu, e=e, law=law, errors="nan").speeds,)

    def derivatives(q: Any, u: Any, mu: Any, e: Any, inputs: Any) -> Any:
        hit = mechanism.collide_derivative(contact, q, u, inputs, mu=mu, e=e, law=law, errors="nan")
        return hit.speeds, _by_all(mechanism, hit.by_coordinates), hit.by_speeds, hit.by_mu, hit.by_e, hit.by_inputs

    return Differentiable(values, derivatives, (p,), [(n,), (p,), (), (), (w,)])


def motion(mechanism: Mechanism, by: Sequence[str], at: Any, options: dict[str, Any]) -> Differentiable:
    """The states at times of a motion, of the values of variables by name. Tells of names that are none."""
    names = tuple(by)
    times = np.atleast_1d(numbers(at, "at"))
    coordinates, speeds = mechanism.coordinates, mechanism.speeds
    width, places = len(coordinates) + len(speeds), {q.name: i for i, q in enumerate((*coordinates, *speeds))}
    start = np.array([q.value for q in (*coordinates, *speeds)])
    for place, given in (("q", slice(0, len(coordinates))), ("u", slice(len(coordinates), width))):
        if options.get(place) is not None:
            start[given] = numbers(options.pop(place), place)
    parameters = {quantity.name for quantity in mechanism.parameters}
    inputs = {quantity.name: i for i, quantity in enumerate(mechanism.inputs)}
    held = held_inputs(mechanism) if options.get("inputs") is None else numbers(options.pop("inputs"), "inputs")

    def one(values: Any, wanted: Sequence[str]) -> Any:
        state, machine, given = start.copy(), {}, dict(options)
        now, own = held.copy(), {name: dict(surface) for name, surface in (options.get("surfaces") or {}).items()}
        for name, value in zip(names, values):
            value = number(value, name)
            if name in places:
                state[places[name]] = value
            elif name in parameters:
                machine[name] = value
            elif name in inputs:
                now[inputs[name]] = value
            elif name in ("mu", "e"):
                given[name] = value
            else:
                part, _, contact = name.partition(".")
                own.setdefault(contact, {})[part] = value
        if own:
            given["surfaces"] = own
        other = mechanism.with_parameters(**machine) if machine else mechanism
        n = len(coordinates)
        return other.gradient(wanted, times, q=state[:n], u=state[n:], inputs=now, **given)

    def values_of(values: Any) -> Any:
        rows = [one(row, ()) for row in values]
        return (np.array([np.concatenate([row.q, row.u], axis=-1) for row in rows]),)

    def derivatives_of(values: Any) -> Any:
        rows = [one(row, names) for row in values]
        states = np.array([np.concatenate([row.q, row.u], axis=-1) for row in rows])
        return states, np.array([np.concatenate([row.q_by, row.u_by], axis=-2) for row in rows])

    n, begin = len(coordinates), times[:1] * 0 + float(options.get("time") or 0.0)
    mechanism.gradient(names, begin, q=start[:n], u=start[n:], inputs=held, **options)
    return Differentiable(values_of, derivatives_of, (len(times), width), [(len(names),)])


def given_inputs(mechanism: Mechanism, inputs: Optional[Any]) -> Any:
    """The inputs of the model, where none are given."""
    return held_inputs(mechanism) if inputs is None else inputs
