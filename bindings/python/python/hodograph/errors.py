"""Exceptions, and the mistakes of models. An exception carries ``kind`` (a stable lower-case name), ``place`` (what or where) and ``number`` (the value at fault, or None)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional


class HodographError(Exception):
    """What Hodograph cannot answer."""

    def __init__(self, message: str, *, kind: str = "", place: Optional[str] = None, number: Optional[float] = None) -> None:
        super().__init__(message)
        self.kind = kind
        self.place = place
        self.number = number

    def __reduce__(self) -> tuple[Any, ...]:
        # Other processes raise it with all that it carries.
        return _again, (type(self), str(self), self.__dict__)


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

    def __str__(self) -> str:
        return self.text


class ArgumentError(HodographError, ValueError):
    """An argument has the wrong shape, dtype or name; the message says what was expected."""


class ModelError(HodographError, ValueError):
    """A model has mistakes: ``diagnostics`` lists them."""

    _diagnostics: Any = ()

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """The mistakes, as :class:`hodograph.Diagnostic`."""
        return [Diagnostic(**entry) for entry in self._diagnostics]


class DerivationError(HodographError):
    """The derivation of a model is missing, stale or damaged."""


class ParameterError(HodographError, ValueError):
    """No mechanism has these parameters."""


class StateError(HodographError, ArithmeticError):
    """The mechanism has no answer in a state."""


class ImpactError(HodographError, ArithmeticError):
    """A collision has no outcome."""


class ContactError(HodographError, ArithmeticError):
    """A closed contact has no mode or force."""


def _again(kind: type[HodographError], message: str, carried: dict[str, Any]) -> HodographError:
    error = kind(message)
    error.__dict__.update(carried)
    return error
