"""Exceptions. Each carries ``kind`` (a stable lower-case name), ``place`` (what or where) and ``number`` (the value at fault, or None)."""

from __future__ import annotations


class HodographError(Exception):
    """What Hodograph cannot answer."""

    def __init__(self, message, *, kind="", place=None, number=None):
        super().__init__(message)
        self.kind = kind
        self.place = place
        self.number = number


class ArgumentError(HodographError, ValueError):
    """An argument has the wrong shape, dtype or name; the message says what was expected."""


class ModelError(HodographError, ValueError):
    """A model has mistakes: ``diagnostics`` lists them."""

    _diagnostics = ()

    @property
    def diagnostics(self):
        """The mistakes, as :class:`hodograph.Diagnostic`."""
        from hodograph import Diagnostic

        return [Diagnostic(**entry) for entry in self._diagnostics]


class DerivationError(HodographError):
    """The derivation of a model is missing, stale or damaged."""


class ParameterError(HodographError, ValueError):
    """No mechanism has these parameters."""


class StateError(HodographError, ArithmeticError):
    """The mechanism has no answer in a state."""


class ImpactError(HodographError, ArithmeticError):
    """A collision has no outcome."""


class SimulationError(HodographError, ArithmeticError):
    """A motion cannot be followed; ``number`` is the time, s. ``motion``: the :class:`hodograph.Simulation` up to there, None where it never began."""

    motion = None
