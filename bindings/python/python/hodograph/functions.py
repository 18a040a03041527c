"""The functions of a mechanism that :mod:`hodograph.jax` and :mod:`hodograph.torch` offer, each for its kind of arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from . import differentiable
from .differentiable import Differentiable, given_inputs
from .mechanism import Mechanism


@dataclass(frozen=True)
class Functions:
    """Makes functions of arrays. ``wrap`` gives a function of rows the arrays and the derivatives of a library."""

    wrap: Callable[[Differentiable], Callable[..., Any]]

    def accelerations(self, mechanism: Mechanism) -> Callable[..., Any]:
        """``f(q, u, inputs=None)``: the rates u' of :meth:`Mechanism.accelerations`."""
        found = self.wrap(differentiable.accelerations(mechanism))
        return lambda q, u, inputs=None: found(q, u, given_inputs(mechanism, inputs))

    def inverse_dynamics(self, mechanism: Mechanism) -> Callable[..., Any]:
        """``f(accelerations, q, u, inputs=None)``: the generalised forces of :meth:`Mechanism.inverse_dynamics`."""
        found = self.wrap(differentiable.inverse_dynamics(mechanism))
        return lambda a, q, u, inputs=None: found(a, q, u, given_inputs(mechanism, inputs))

    def collide(self, mechanism: Mechanism, contact: str, law: str) -> Callable[..., Any]:
        """``f(q, u, mu, e, inputs=None)``: the speeds after collisions of :meth:`Mechanism.collide` at a contact, under a law of restitution."""
        found = self.wrap(differentiable.collide(mechanism, contact, law))
        return lambda q, u, mu, e, inputs=None: found(q, u, mu, e, given_inputs(mechanism, inputs))

    def motion(self, mechanism: Mechanism, by: Sequence[str], at: Any, **options: Any) -> Callable[[Any], Any]:
        """``f(values)``: the states at the times ``at``, coordinates and then speeds, of the motion in which the variables ``by`` (names as those of
        :meth:`Mechanism.gradient`, which also has the ``options``) have these ``values`` (.., v); (.., k, n + p). Derivatives go through impacts and contact that
        lasts; they are NaN where the motion has none."""
        return self.wrap(differentiable.motion(mechanism, by, at, options))
