"""Mechanisms by Kane's equations, and exact frictional impacts in three dimensions.

States are float64 arrays: ``q`` coordinates (n,), ``u`` independent speeds (p,), ``inputs`` (w,), each in the order and the units of the model; with
a first axis they are many states, and so are the answers. What is left out is what the model states. ``mu`` and ``e`` are numbers or arrays.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Optional, Union

import numpy as np

from . import hodograph_native as _native
from .arguments import Column, Floats, Rows
from .description import Contact, Quantity
from .errors import (
    ArgumentError,
    ContactError,
    DerivationError,
    Diagnostic,
    HodographError,
    ImpactError,
    ModelError,
    ParameterError,
    StateError,
)
from .gradients import Adjoint, Branch, EventGradient, Fit, MotionGradient, Orbit
from .mechanism import Derivatives, Linearisation, Mechanism, NumericMechanism, restored
from .motion import Event, Simulation, SimulationError, Simulations, read_motion
from .results import Characteristics, ClosedContact, Collision, CollisionDerivative, Hodograph, Impact, ImpactDerivative
from .validation import Validation

__version__: str = _native.__version__

__all__ = [
    "Adjoint", "ArgumentError", "Branch", "Characteristics", "ClosedContact", "Collision", "CollisionDerivative", "Contact", "ContactError", "DerivationError",
    "Derivatives", "Diagnostic", "Event", "EventGradient", "Fit", "Hodograph", "HodographError", "Impact", "ImpactDerivative", "ImpactError",
    "Linearisation", "Mechanism", "ModelError", "MotionGradient", "NumericMechanism", "Orbit", "ParameterError", "Quantity", "Simulation",
    "SimulationError", "Simulations", "StateError", "Validation", "__version__", "characteristics", "check", "derivative", "hodograph", "load", "load_motion", "solve",
]  # fmt: skip

Path = Union[str, "os.PathLike[str]"]


def check(model: Path) -> list[Diagnostic]:
    """All mistakes and warnings of a model (a path, or a text of several lines), as a list of :class:`Diagnostic`."""
    return [Diagnostic(**entry) for entry in _native.check(_text(model))]


def load(model: Path, derivation: Optional[Path] = None) -> Mechanism:
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


def solve(matrix: Rows, velocity: Rows, *, mu: Column, e: Column, law: str, errors: str = "raise") -> Impact:
    """Solves collisions of two bodies at a point.

    ``matrix`` (6,) or (n, 6): reduced matrix nn, nt, ns, tt, ts, ss, 1/kg. ``velocity`` (3,) or (n, 3): velocity of approach along n, t, s,
    m/s. ``law``: 'newton', 'poisson' or 'stronge'. Rows without an outcome raise :class:`ImpactError`; with ``errors='nan'`` they hold NaN and
    their ``kind`` says why. Returns :class:`Impact`.
    """
    return Impact(_native.solve(matrix, velocity, mu, e, law, errors))


def derivative(matrix: Rows, velocity: Rows, *, mu: Column, e: Column, law: str, errors: str = "raise") -> ImpactDerivative:
    """Derivatives of the outcomes of collisions; the arguments are those of :func:`solve`. Returns :class:`ImpactDerivative`."""
    return ImpactDerivative(_native.derivative(matrix, velocity, mu, e, law, errors))


def characteristics(matrix: Rows, velocity: Rows, *, mu: Column, e: Column, law: str, errors: str = "raise") -> Characteristics:
    """Characteristic quantities of collisions; the arguments are those of :func:`solve`. Returns :class:`Characteristics`."""
    return Characteristics(_native.characteristics(matrix, velocity, mu, e, law, errors))


def hodograph(
    matrix: Rows, velocity: Rows, *, mu: float, e: float, law: str, points: int = 201, impulses: Union[None, float, Sequence[float], Floats] = None
) -> Hodograph:
    """The course of one collision at equal steps of the normal impulse, or at the normal ``impulses`` (k,), N s, beyond the end by the law, too; the
    other arguments are those of :func:`solve`. Returns :class:`Hodograph`."""
    at = None if impulses is None else [float(impulse) for impulse in np.atleast_1d(impulses)]
    return Hodograph(_native.hodograph(matrix, velocity, mu, e, law, points, at))


def load_motion(path: Path) -> Simulation:
    """The motion of a file that :meth:`Simulation.save` wrote, with its mechanism. Needs pyarrow."""
    return read_motion(path, restored)


def _text(model: Path) -> str:
    return model if isinstance(model, str) else str(model)
