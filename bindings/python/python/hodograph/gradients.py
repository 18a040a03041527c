"""Derivatives of motions, periodic motions and fits, as calls answer them."""

from __future__ import annotations

from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from .arguments import Floats


class EventGradient(NamedTuple):
    """An event with the derivatives of its time, (v,), and of the state there before and after it, (n + p, v), which move with it; None where there are
    none."""

    time: float
    kind: str
    contact: Optional[str]
    q: Floats
    u: Floats
    time_by: Optional[Floats]
    before_by: Optional[Floats]
    after_by: Optional[Floats]


class MotionGradient:
    """A motion at the times asked for with its derivatives by v variables: ``by``, their names; ``time`` (k,), ``q`` (k, n), ``u`` (k, p); ``q_by`` (k, n, v)
    and ``u_by`` (k, p, v), NaN from where there are none: ``undefined`` says since when, at which contact and why, or is None; ``events``."""

    def __init__(self, found: dict[str, Any], by: tuple[str, ...], coordinates: int) -> None:
        self.by = by
        samples = found["samples"]
        states = np.array([state for _, state, _ in samples])
        none = np.full((states.shape[-1], len(by)), np.nan)
        derivatives = np.array([none if derivative is None else derivative for *_, derivative in samples])
        self.time: Floats = np.array([time for time, *_ in samples])
        self.q: Floats = states[:, :coordinates]
        self.u: Floats = states[:, coordinates:]
        self.q_by: Floats = derivatives[:, :coordinates]
        self.u_by: Floats = derivatives[:, coordinates:]
        self.events = [EventGradient(*event, *derivatives) for event, *derivatives in found["events"]]
        self.undefined: Optional[tuple[float, Optional[str], str]] = found["undefined"]

    def __repr__(self) -> str:
        why = "" if self.undefined is None else f", {self.undefined[2]}"
        return f"<hodograph.MotionGradient by {', '.join(self.by)} at {len(self.time)} times{why}>"


class Adjoint(NamedTuple):
    """A motion at the times asked for, ``time`` (k,), ``q`` (k, n), ``u`` (k, p), and the derivatives of functions of it by v variables, ``by`` (.., v)."""

    time: Floats
    q: Floats
    u: Floats
    by: Floats


class Orbit:
    """A periodic motion: ``q``, ``u`` at its beginning, its ``period``, s; ``multipliers``, the greatest first, and whether all are within the unit circle
    (``stable``); ``matrix`` (n + p, n + p): derivatives of the state when it has returned by that at the beginning; ``by`` (n + p, v): by the variables asked
    for; ``residual``: the relative difference of both states; ``events``: (time, kind, contact, q, u); ``nodes``: (time, q, u) at the beginning of
    each segment of the period."""

    def __init__(self, found: dict[str, Any], coordinates: int) -> None:
        self.q: Floats = found["state"][:coordinates]
        self.u: Floats = found["state"][coordinates:]
        self.nodes: list[tuple[float, Floats, Floats]] = [(time, state[:coordinates], state[coordinates:]) for time, state in found["nodes"]]
        self.period: float = found["period"]
        self.matrix: Floats = found["matrix"]
        self.by: Floats = found["by"]
        self.multipliers: NDArray[np.complex128] = np.array([complex(*parts) for parts in found["multipliers"]])
        self.stable: bool = found["stable"]
        self.residual: float = found["residual"]
        self.events: list[Any] = found["events"]

    def __repr__(self) -> str:
        return f"<hodograph.Orbit of {self.period} s, {'stable' if self.stable else 'unstable'}>"


class Branch(NamedTuple):
    """A branch of periodic motions through a variable: ``values`` (k,) and ``orbits``; ``changes``: (kind, value, orbit) where the branch folds, doubles its
    period or crosses another; ``ended``: why it was not followed to the end of the range, or None."""

    values: Floats
    orbits: list[Orbit]
    changes: list[tuple[str, float, Orbit]]
    ended: Optional[str]


class Fit:
    """Fitted values: ``values``, their standard ``errors`` and, with draws, their ``spread``, by name; ``correlations`` (v, v); ``undetermined``: directions in
    which the values change no difference; ``rms`` of the ``differences`` in their units, of which ``outliers`` cost less than their squares; ``surfaces``:
    {contact: mu, e, law} with these values; ``without_derivatives``: names of motions that were fitted by differences; ``steps``; ``minima``: (values, rms)
    at the minimum of each start, the least first; ``starts``, with ``flight``: for each motion its start state, the standard errors of its components and their
    covariance (n + p, n + p), and the rms of the flight."""

    def __init__(self, found: dict[str, Any], names: tuple[str, ...]) -> None:
        named = lambda numbers: dict(zip(names, (float(number) for number in numbers)))  # noqa: E731
        self.values: dict[str, float] = named(found["values"])
        self.errors: dict[str, float] = named(found["errors"])
        self.spread: Optional[dict[str, float]] = None if found["spread"] is None else named(found["spread"])
        self.correlations: Floats = found["correlations"]
        self.undetermined: list[dict[str, float]] = [named(direction) for direction in found["undetermined"]]
        self.rms: float = found["rms"]
        self.differences: int = found["differences"]
        self.outliers: int = found["outliers"]
        self.without_derivatives: list[str] = found["without_derivatives"]
        self.steps: int = found["steps"]
        self.minima: list[tuple[dict[str, float], float]] = [(named(values), rms) for values, rms in found["minima"]]
        self.starts: dict[str, tuple[Floats, Floats, Floats, float]] = {
            name: (np.array(state), np.array(errors), covariance, rms) for name, (state, errors, covariance, rms) in found["starts"].items()
        }
        self.surfaces: dict[str, dict[str, Any]] = {
            contact: {"mu": mu, "e": e, "law": law} for contact, mu, e, law in found["surfaces"]
        }

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={value:.6g} +- {self.errors[name]:.2g}" for name, value in self.values.items())
        return f"<hodograph.Fit {shown}>"
