"""Mechanisms by Kane's equations, and exact frictional impacts in three dimensions.

States are float64 arrays: ``q`` coordinates (n,), ``u`` independent speeds (p,), ``inputs`` (w,), each in the order and the units of the model; with
a first axis they are many states, and so are the answers. What is left out is what the model states. ``mu`` and ``e`` are numbers or arrays.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Optional

import numpy as np

from . import hodograph_native as _native
from .errors import (
    ArgumentError,
    DerivationError,
    HodographError,
    ImpactError,
    ModelError,
    ParameterError,
    SimulationError,
    StateError,
)
from .mechanism import Contact, Derivatives, Linearisation, Mechanism, NumericMechanism, Quantity
from .results import Characteristics, Collision, Event, Hodograph, Impact, ImpactDerivative, Simulation, Simulations

__all__ = [
    "ArgumentError", "Characteristics", "Collision", "Contact", "DerivationError", "Derivatives", "Diagnostic", "Event", "Hodograph", "HodographError",
    "Impact", "ImpactDerivative", "ImpactError", "Linearisation", "Mechanism", "ModelError", "NumericMechanism", "ParameterError",
    "Quantity", "Simulation", "SimulationError", "Simulations", "StateError", "characteristics", "check", "derivative", "hodograph", "load", "solve",
]  # fmt: skip


@dataclass(frozen=True)
class Diagnostic:
    """A mistake in a model, or a warning. ``line`` and ``column`` count from 1; ``text`` is all of it with the lines of the model."""

    code: str
    severity: str
    message: str
    line: Optional[int]
    column: Optional[int]
    label: str
    help: Optional[str]
    text: str

    def __str__(self):
        return self.text


def check(model):
    """All mistakes and warnings of a model (a path, or a text of several lines), as a list of :class:`Diagnostic`."""
    return [Diagnostic(**entry) for entry in _native.check(_text(model))]


def load(model, derivation=None):
    """A mechanism from a model file or text and its derivation (by default the file ``.derivation`` beside the model).

    A model for which no derivation can be read becomes a :class:`NumericMechanism`, with a warning: it is slower, and has fewer methods.
    A derivation that is stale, damaged, or named and missing raises :class:`DerivationError`.
    """
    try:
        return Mechanism(_text(model), None if derivation is None else str(derivation))
    except DerivationError as error:
        if error.kind != "no_derivation" or derivation is not None:
            raise
        warnings.warn(f"{error}: evaluated numerically, without the derived equations", UserWarning, stacklevel=2)
        return NumericMechanism(_text(model))


def solve(matrix, velocity, *, mu, e, law, errors="raise"):
    """Solves collisions of two bodies at a point.

    ``matrix`` (6,) or (n, 6): reduced matrix nn, nt, ns, tt, ts, ss, 1/kg. ``velocity`` (3,) or (n, 3): velocity of approach along n, t, s,
    m/s. ``law``: 'newton', 'poisson' or 'stronge'. Rows without an outcome raise :class:`ImpactError`; with ``errors='nan'`` they hold NaN and
    their ``kind`` says why. Returns :class:`Impact`.
    """
    return Impact(_native.solve(matrix, velocity, mu, e, law, errors))


def derivative(matrix, velocity, *, mu, e, law, errors="raise"):
    """Derivatives of the outcomes of collisions; the arguments are those of :func:`solve`. Returns :class:`ImpactDerivative`."""
    return ImpactDerivative(_native.derivative(matrix, velocity, mu, e, law, errors))


def characteristics(matrix, velocity, *, mu, e, law, errors="raise"):
    """Characteristic quantities of collisions; the arguments are those of :func:`solve`. Returns :class:`Characteristics`."""
    return Characteristics(_native.characteristics(matrix, velocity, mu, e, law, errors))


def hodograph(matrix, velocity, *, mu, e, law, points=201, impulses=None):
    """The course of one collision at equal steps of the normal impulse, or at the normal ``impulses`` (k,), N s, beyond the end by the law, too; the
    other arguments are those of :func:`solve`. Returns :class:`Hodograph`."""
    impulses = None if impulses is None else [float(impulse) for impulse in np.atleast_1d(impulses)]
    return Hodograph(_native.hodograph(matrix, velocity, mu, e, law, points, impulses))


def _text(model):
    return model if isinstance(model, str) else str(model)
