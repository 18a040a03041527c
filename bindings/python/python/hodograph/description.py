"""What a mechanism consists of: its quantities, and its contacts in a state."""

from __future__ import annotations

from typing import Any, NamedTuple, Optional

from .arguments import Floats


class Quantity(NamedTuple):
    """A quantity of a model: its name, its unit ('1' without one) and its value or initial value; of machines of many rows, the values."""

    name: str
    unit: str
    value: Any


class Contact(NamedTuple):
    """A contact in a state: unit vectors along N.x, N.y, N.z; the rest along normal, first, second (1/kg, m/s, m, m/s^2)."""

    normal: Floats
    first: Floats
    second: Floats
    velocity: Floats
    reduced: Floats
    gap: Optional[Floats]
    partial_velocities: Floats
    response: Floats
