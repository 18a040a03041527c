"""What calls answer, with pictures for notebooks."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import hodograph_native as _native
from .arguments import Floats
from .figures import plot

#: A word, or one for each row.
Words = Union[str, NDArray[np.object_]]


@lru_cache(maxsize=None)
def _places(fields: tuple[tuple[str, int], ...]) -> dict[str, tuple[int, int]]:
    """Where the numbers of each name stand, and how many they are."""
    places, start = {}, 0
    for name, size in fields:
        places[name] = (start, size)
        start += size
    return places


class Answer:
    """Arrays under their names, made where they are asked for. ``path``: the phases that each row went through; ``kind``: why there is no outcome, ''
    where there is one."""

    _names: tuple[str, ...] = ()

    def __init__(self, found: tuple[Floats, Any, Any], fields: tuple[tuple[str, int], ...]) -> None:
        self._numbers, self._paths, self._kinds = found
        self._fields = fields

    def __getattr__(self, name: str) -> Any:
        # Of names that are not yet known; copies ask before there is anything.
        place = None if name.startswith("_") else _places(self._fields).get(name)
        if place is None:
            raise AttributeError(f"{type(self).__name__} has no {name!r}")
        value = self.__dict__[name] = self._shaped(name, *place)
        return value

    def _shaped(self, name: str, start: int, size: int) -> Any:
        numbers, scalar = self._numbers, size == 1 and name != "speeds"
        if numbers.ndim == 1:
            return numbers[start] if scalar else numbers[start : start + size]
        return numbers[:, start].copy() if scalar else np.ascontiguousarray(numbers[:, start : start + size])

    @cached_property
    def path(self) -> Words:
        return _words(_native.PATHS, self._paths)

    @cached_property
    def kind(self) -> Words:
        return _words(_native.KINDS, self._kinds)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *_places(self._fields)]

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={np.array2string(np.asarray(getattr(self, name)), threshold=12)}" for name in self._names)
        return f"<hodograph.{type(self).__name__} {shown}>"


def _words(names: list[str], codes: Any) -> Words:
    """The names of codes; '' of those that have none."""
    if not isinstance(codes, np.ndarray):
        return names[codes] if codes < len(names) else ""
    all_words = np.full(256, "", dtype=object)
    all_words[: len(names)] = names
    words: NDArray[np.object_] = all_words[codes]
    return words


class Impact(Answer):
    """Outcomes of collisions along n, t, s: ``impulse`` N s, ``velocity`` of separation m/s, (3,) or (n, 3); ``contact_work``, ``normal_work`` J;
    ``energy_gained`` J, 0 where none is, beyond rounding; ``path`` the phases gone through; ``kind`` why there is no outcome, '' where there is one."""

    impulse: Floats
    velocity: Floats
    contact_work: Floats
    normal_work: Floats
    energy_gained: Floats
    _names = ("impulse", "velocity", "contact_work", "normal_work", "path")

    def __init__(self, found: Any, fields: Any = tuple(_native.IMPACT)) -> None:
        super().__init__(found, fields)


_SENSITIVITY = ("near_mu_c", "grazing", "unstable_direction", "no_slip", "jam")


class Collision(Impact):
    """Outcomes of collisions of a mechanism: ``speeds`` after them, (p,) or (k, p); ``normal``, ``tangent``, ``binormal``, ``impulse_on_point`` along
    N.x, N.y, N.z; ``approach``, ``velocity`` (of separation), ``impulse``, ``reduced`` (nn, nt, ns, tt, ts, ss) along n, t, s; ``energy_change``,
    ``contact_work``, ``normal_work``, ``energy_gained`` J; ``compressions``: how often compression ended; ``sensitivity``: names of what makes the outcome
    change by much with its input; ``path``; ``kind``, '' where there is an outcome."""

    speeds: Floats
    normal: Floats
    tangent: Floats
    binormal: Floats
    approach: Floats
    reduced: Floats
    impulse_on_point: Floats
    energy_change: Floats
    compressions: Floats
    _names = ("speeds", "impulse", "velocity", "energy_change", "path")

    @cached_property
    def sensitivity(self) -> Any:
        """The names of the flags, as a tuple; of many collisions, an array of tuples."""
        start, _ = _places(self._fields)["sensitivity"]
        names = lambda bits: tuple(name for place, name in enumerate(_SENSITIVITY) if int(bits) >> place & 1)  # noqa: E731
        bits = np.nan_to_num(self._numbers[..., start])
        if bits.ndim == 0:
            return names(bits)
        found = np.empty(len(bits), dtype=object)
        found[:] = [names(row) for row in bits]
        return found


class ImpactDerivative(Answer):
    """Derivatives of ``impulse`` and ``velocity``, (3, 11) or (n, 3, 11), by v_n, v_t, v_s, m_nn, m_nt, m_ns, m_tt, m_ts, m_ss, mu, e; ``smooth``:
    False where they are one-sided only."""

    impulse: Floats
    velocity: Floats
    smooth: Any
    _names = ("impulse", "velocity", "smooth", "path")

    def __init__(self, found: Any) -> None:
        super().__init__(found, tuple(_native.DERIVATIVE))

    def _shaped(self, name: str, start: int, size: int) -> Any:
        value = super()._shaped(name, start, size)
        return value == 1.0 if name == "smooth" else value.reshape(value.shape[:-1] + (3, 11))


class Characteristics(Answer):
    """Characteristic quantities of collisions by the paper's names, numbers or (n,), NaN where one does not exist: ``c_n``, ``c_t``, ``c_s`` (41) kg;
    ``mu_c``, ``phi_c`` (43); ``mu_s``; ``phi_hat`` rad with ``f_hat``, ``g_hat`` (46) and ``dh_hat`` = dh/dphi there, 1/kg; ``phi_bar`` rad; ``I_nC``
    N s and ``E_nC`` J at the end of the latest compression; ``I_nS`` N s, ``v_nS`` m/s and ``E_nS`` J where slip stops; ``path``; ``kind``."""

    c_n: Floats
    c_t: Floats
    c_s: Floats
    mu_c: Floats
    phi_c: Floats
    mu_s: Floats
    phi_hat: Floats
    f_hat: Floats
    g_hat: Floats
    dh_hat: Floats
    phi_bar: Floats
    I_nC: Floats
    E_nC: Floats
    I_nS: Floats
    v_nS: Floats
    E_nS: Floats
    _names = ("c_n", "c_t", "c_s", "mu_c", "phi_c", "mu_s", "phi_hat", "phi_bar", "I_nC", "E_nC", "I_nS", "v_nS", "E_nS")

    def __init__(self, found: Any) -> None:
        super().__init__(found, tuple(_native.CHARACTERISTICS))


class ClosedContact:
    """Mode and force of a closed contact: ``mode`` ('separate', 'slide', 'stick', 'begin_slip'), ``selection`` ('unique', 'several_modes', ..); ``force``
    N and ``acceleration`` m/s^2 of its point along ``normal``, ``first``, ``second``; ``force_on_point`` along N.x, N.y, N.z; ``velocity``, ``reduced``,
    ``free_acceleration``; ``direction`` of slip along N.x, N.y, N.z (NaN without); ``margins``: lambda_n N, f 1/kg, cone N, s m/s, NaN where the mode has
    none: it ends where one is zero; ``is_unique``: whether no other force gives this acceleration; ``accelerations`` u' under the force; ``kind``."""

    normal: Floats
    first: Floats
    second: Floats
    velocity: Floats
    reduced: Floats
    free_acceleration: Floats
    force: Floats
    force_on_point: Floats
    acceleration: Floats
    accelerations: Floats
    direction: Floats
    margins: Floats
    is_unique: Any
    mode: Words
    selection: Words
    kind: Words

    def __init__(self, found: dict[str, Any]) -> None:
        for name, value in found.items():
            setattr(self, name, np.array(value, dtype=object) if isinstance(value, list) else value)
        self.is_unique = found["is_unique"] == 1.0

    def __repr__(self) -> str:
        return f"<hodograph.ClosedContact {self.mode}: force={self.force}>"


class CollisionDerivative:
    """Derivatives of ``speeds`` after collisions at one configuration, (p,) or (k, p): ``by_speeds`` (.., p, p), ``by_coordinates`` (.., p, n) of the
    independent ones, ``by_inputs`` (.., p, w), ``by_mu``, ``by_e`` (.., p); ``smooth``: False where they are one-sided only; ``kind``."""

    def __init__(
        self,
        speeds: Floats,
        by: tuple[Floats, Floats, Floats, Floats, Floats],
        smooth: Any,
        kind: Words,
    ) -> None:
        self.speeds = speeds
        self.by_coordinates, self.by_speeds, self.by_inputs, self.by_mu, self.by_e = by
        self.smooth, self.kind = smooth, kind

    def __repr__(self) -> str:
        return f"<hodograph.CollisionDerivative of {self.speeds.shape} speeds>"


class Hodograph:
    """The course of a collision: ``impulse`` (k, 3) N s and ``velocity`` (k, 3) m/s along n, t, s, ``contact_work``, ``normal_work`` (k,) J, ``motion`` of
    each point; ``compression_end``, ``slip_end``: normal impulses, N s, or None."""

    impulse: Floats
    velocity: Floats
    contact_work: Floats
    normal_work: Floats
    motion: list[str]
    path: str
    compression_end: Optional[float]
    slip_end: Optional[float]

    def __init__(self, found: dict[str, Any]) -> None:
        for name, value in found.items():
            setattr(self, name, value)

    def __repr__(self) -> str:
        return f"<hodograph.Hodograph {self.path}: {len(self.impulse)} points>"

    def _repr_html_(self) -> str:
        curve = plot([(self.velocity[:, 1], self.velocity[:, 2], "")], "v_t, m/s", "v_s, m/s")
        impulse = self.impulse[:, 0]
        slip = np.hypot(self.velocity[:, 1], self.velocity[:, 2])
        lines = [(impulse, self.velocity[:, 0], "v_n"), (impulse, slip, "slip")]
        return curve + plot(lines, "normal impulse, N s", "m/s")
