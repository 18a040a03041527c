"""Names and numbers that are given, and what is said of those that cannot be."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from numbers import Real
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from .errors import ArgumentError

Floats = NDArray[np.float64]
Integers = NDArray[np.integer[Any]]
#: A state, or many by rows: arrays of doubles or whole numbers, lists, or what gives an array. None: what the model states.
Rows = Union[Floats, Integers, Sequence[float], Sequence[Sequence[float]], None]
#: One number for all rows, or one for each.
Column = Union[float, Floats, Integers, Sequence[float]]


def numbers(value: Any, name: str) -> Floats:
    """An array of doubles of numbers: strings are none, and entries that a mask hides have none."""
    if np.ma.is_masked(value):
        raise ArgumentError(
            f"`{name}` has masked entries: fill them (`.filled(value)`), or leave their rows out", kind="masked", place=name
        )
    found = np.asarray(value)
    real = found.dtype.kind in "fiu" or (
        found.dtype.kind == "O" and all(isinstance(entry, Real) and not isinstance(entry, bool) for entry in found.flat)
    )
    if not real:
        raise ArgumentError(f"`{name}` has the dtype {found.dtype}: expected numbers", kind="wrong_dtype", place=name)
    return found.astype(np.float64)


def number(value: Any, name: str) -> float:
    """One number."""
    found = numbers(value, name)
    if found.ndim:
        raise ArgumentError(f"`{name}` has the shape {found.shape}: expected a number", kind="wrong_shape", place=name)
    return float(found)


def optional_number(value: Any, name: str) -> Optional[float]:
    """One number, or none."""
    return None if value is None else number(value, name)


def unknown(kind: str, name: str, known: Iterable[str]) -> ArgumentError:
    """The exception of a name that there is not."""
    known = list(known)
    near = difflib.get_close_matches(name, known, 1)
    hint = f"did you mean `{near[0]}`?" if near else f"there are: {', '.join(known)}" if known else "there are none"
    return ArgumentError(f"there is no {kind} `{name}`: {hint}", kind="unknown_name", place=name)


def index(kind: str, name: Any, names: Sequence[str]) -> int:
    """The place of a name."""
    if name in names:
        return names.index(name)
    raise unknown(kind, str(name), names)
