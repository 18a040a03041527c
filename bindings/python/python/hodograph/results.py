"""What calls answer, with pictures for notebooks."""

from __future__ import annotations

import html
from typing import NamedTuple, Optional

import numpy as np

from . import hodograph_native as _native


class _Answer:
    """Arrays under their names; ``path`` and ``kind`` in words."""

    _names = ()

    def __init__(self, found):
        for name, value in found.items():
            setattr(self, name, value)
        self.path = _words(_native.PATHS, self.path, None)
        self.kind = _words(_native.KINDS, self.kind, "")

    def __repr__(self):
        shown = ", ".join(f"{name}={np.array2string(np.asarray(getattr(self, name)), threshold=12)}" for name in self._names)
        return f"<hodograph.{type(self).__name__} {shown}>"


def _words(names, codes, none):
    if not isinstance(codes, np.ndarray):
        return names[codes] if codes < len(names) else none
    all_words = np.full(256, none, dtype=object)
    all_words[: len(names)] = names
    return all_words[codes]


class Impact(_Answer):
    """Outcomes of collisions along n, t, s: ``impulse`` N s, ``velocity`` of separation m/s, (3,) or (n, 3); ``contact_work``, ``normal_work`` J;
    ``energy_gained`` J, 0 where none is, beyond rounding; ``path`` the phases gone through; ``kind`` why there is no outcome, '' where there is one."""

    _names = ("impulse", "velocity", "contact_work", "normal_work", "path")


class Collision(_Answer):
    """Outcomes of collisions of a mechanism: ``speeds`` after them, (p,) or (k, p); ``normal``, ``tangent``, ``binormal``, ``impulse_on_point`` along
    N.x, N.y, N.z; ``approach``, ``velocity`` (of separation), ``impulse``, ``reduced`` (nn, nt, ns, tt, ts, ss) along n, t, s; ``energy_change``,
    ``contact_work``, ``normal_work``, ``energy_gained`` J; ``path``; ``kind``, '' where there is an outcome."""

    _names = ("speeds", "impulse", "velocity", "energy_change", "path")


class ImpactDerivative(_Answer):
    """Derivatives of ``impulse`` and ``velocity``, (3, 11) or (n, 3, 11), by v_n, v_t, v_s, m_nn, m_nt, m_ns, m_tt, m_ts, m_ss, mu, e; ``smooth``:
    False where they are one-sided only."""

    _names = ("impulse", "velocity", "smooth", "path")

    def __init__(self, found):
        for name in ("impulse", "velocity"):
            flat = found[name]
            found[name] = flat.reshape(flat.shape[:-1] + (3, 11))
        found["smooth"] = found["smooth"] == 1.0
        super().__init__(found)


class Characteristics(_Answer):
    """Characteristic quantities of collisions by the paper's names, numbers or (n,), NaN where one does not exist: ``c_n``, ``c_t``, ``c_s`` (41) kg;
    ``mu_c``, ``phi_c`` (43); ``mu_s``; ``phi_hat`` rad with ``f_hat``, ``g_hat`` (46) and ``dh_hat`` = dh/dphi there, 1/kg; ``phi_bar`` rad; ``I_nC``
    N s and ``E_nC`` J at the end of the latest compression; ``I_nS`` N s, ``v_nS`` m/s and ``E_nS`` J where slip stops; ``path``; ``kind``."""

    _names = ("c_n", "c_t", "c_s", "mu_c", "phi_c", "mu_s", "phi_hat", "phi_bar", "I_nC", "E_nC", "I_nS", "v_nS", "E_nS")


class Hodograph:
    """The course of a collision: ``impulse`` (k, 3) N s and ``velocity`` (k, 3) m/s along n, t, s, ``contact_work``, ``normal_work`` (k,) J, ``motion`` of
    each point; ``compression_end``, ``slip_end``: normal impulses, N s, or None."""

    def __init__(self, found):
        for name, value in found.items():
            setattr(self, name, value)

    def __repr__(self):
        return f"<hodograph.Hodograph {self.path}: {len(self.impulse)} points>"

    def _repr_html_(self):
        curve = _plot([(self.velocity[:, 1], self.velocity[:, 2], "")], "v_t, m/s", "v_s, m/s")
        impulse = self.impulse[:, 0]
        slip = np.hypot(self.velocity[:, 1], self.velocity[:, 2])
        lines = [(impulse, self.velocity[:, 0], "v_n"), (impulse, slip, "slip")]
        return curve + _plot(lines, "normal impulse, N s", "m/s")


class Event(NamedTuple):
    """An event of a motion: its time, s; its ``kind`` ('collision', 'impact_without_collision', 'struck_together', 'contact', 'lift_off', 'slip', 'stick',
    'rest'); the name of the contact, or None; the state after it, ``q`` (n,), ``u`` (p,). Of impacts, otherwise None: ``impulse_on_point`` (3,) along N.x,
    N.y, N.z, N s, and ``energy_change``, J."""

    time: float
    kind: str
    contact: Optional[str]
    q: np.ndarray
    u: np.ndarray
    impulse_on_point: Optional[np.ndarray]
    energy_change: Optional[float]


class Simulation:
    """A motion: ``time`` (k,), ``q`` (k, n), ``u`` (k, p), ``events``: a list of :class:`Event`. ``columns()`` gives them by name, for a table."""

    def __init__(self, found, coordinates, speeds):
        for name, value in found.items():
            setattr(self, name, value)
        self.events = [Event(*event) for event in self.events]
        self.coordinates, self.speeds = coordinates, speeds

    def columns(self):
        """Time, coordinates and speeds by name, each (k,): ``pandas.DataFrame(motion.columns())``."""
        names = ["time", *self.coordinates, *self.speeds]
        return dict(zip(names, [self.time, *self.q.T, *self.u.T]))

    def __repr__(self):
        return f"<hodograph.Simulation to {self.time[-1]} s: {len(self.time)} states, {len(self.events)} events>"

    def _repr_html_(self):
        return "".join(
            _plot([(self.time, column, name) for column, name in zip(matrix.T, names)], "time, s", axis)
            for matrix, names, axis in ((self.q, self.coordinates, "coordinates"), (self.u, self.speeds, "speeds"))
        )


class Simulations:
    """The outcomes of many motions, by rows: ``kind``: 'rest', 'moving', or why a motion ended early, which ``message`` tells; ``time``: when it ended;
    ``rest``: since when nothing moves (NaN where something does); ``q`` (k, n) and ``u`` (k, p) then; ``closed``: the names of the contacts that are closed
    then; ``kinetic``, ``potential`` energy and the works ``friction``, ``impacts``, ``input_work``, J; numbers of ``collisions`` and ``events``;
    ``several_modes``: whether an event said that other modes fit; ``digest``: a number made of all bits."""

    def __init__(self, found, coordinates, speeds):
        for name, value in found.items():
            setattr(self, name, value)
        self.closed = [tuple(names) for names in self.closed]
        self.coordinates, self.speeds = coordinates, speeds

    def __len__(self):
        return len(self.kind)

    def columns(self):
        """All by name, each (k,): ``pandas.DataFrame(motions.columns())``."""
        names = ("kind", "time", "rest", "kinetic", "potential", "friction", "impacts", "input_work", "collisions", "events", "several_modes", "message")
        columns = {name: getattr(self, name) for name in names}
        columns["closed"] = ["+".join(names) for names in self.closed]
        return {**columns, **dict(zip(self.coordinates, self.q.T)), **dict(zip(self.speeds, self.u.T))}

    def __repr__(self):
        counts = {kind: self.kind.count(kind) for kind in dict.fromkeys(self.kind)}
        return f"<hodograph.Simulations: {', '.join(f'{count} {kind}' for kind, count in counts.items())}>"


_COLOURS = ("#1f5fa8", "#c2451e", "#2f7d3b", "#7a4b9e", "#a07a12", "#3f8f8f")


def _plot(lines, x_label, y_label, width=420, height=300):
    """An SVG picture of lines (x, y, name)."""
    # The names of the lines stand above the plot.
    names = [(number, line[2]) for number, line in enumerate(lines) if line[2]]
    each = 22 + 7 * max((len(name) for _, name in names), default=0)
    in_row = max(1, (width - 70) // each)
    left, right, top, bottom = 58, 12, 12 + 16 * -(-len(names) // in_row), 42
    finite = lambda arrays: np.concatenate([np.asarray(a, float)[np.isfinite(a)] for a in arrays] or [np.zeros(1)])
    (x0, x1), (y0, y1) = (_range(finite([line[axis] for line in lines])) for axis in (0, 1))
    px = lambda x: left + (np.asarray(x) - x0) / (x1 - x0) * (width - left - right)
    py = lambda y: height - bottom - (np.asarray(y) - y0) / (y1 - y0) * (height - top - bottom)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="11">']
    for tick in _ticks(x0, x1):
        parts.append(f'<path d="M{px(tick):.1f} {top}V{height - bottom}" stroke="#e4e4e4"/>')
        parts.append(f'<text x="{px(tick):.1f}" y="{height - bottom + 15}" text-anchor="middle">{_text(tick)}</text>')
    for tick in _ticks(y0, y1):
        parts.append(f'<path d="M{left} {py(tick):.1f}H{width - right}" stroke="#e4e4e4"/>')
        parts.append(f'<text x="{left - 5}" y="{py(tick) + 4:.1f}" text-anchor="end">{_text(tick)}</text>')
    for number, (x, y, name) in enumerate(lines):
        colour = _COLOURS[number % len(_COLOURS)]
        points = " ".join(f"{a:.2f},{b:.2f}" for a, b in zip(px(x), py(y)) if np.isfinite(a) and np.isfinite(b))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
    for place, (number, name) in enumerate(names):
        colour, x, y = _COLOURS[number % len(_COLOURS)], left + each * (place % in_row), 12 + 16 * (place // in_row)
        parts.append(f'<path d="M{x} {y - 1}h14" stroke="{colour}" stroke-width="1.6"/>')
        parts.append(f'<text x="{x + 18}" y="{y + 3}" fill="{colour}">{html.escape(name)}</text>')
    middle = (top + height - bottom) / 2
    parts.append(f'<text x="{(left + width - right) / 2}" y="{height - 8}" text-anchor="middle">{x_label}</text>')
    parts.append(f'<text transform="translate(13 {middle}) rotate(-90)" text-anchor="middle">{y_label}</text>')
    return "".join(parts) + "</svg>"


def _text(number):
    """A number of an axis; zero has no sign."""
    return f"{number + 0.0:g}"


def _range(numbers):
    low, high = (float(numbers.min()), float(numbers.max())) if numbers.size else (0.0, 1.0)
    margin = 0.05 * (high - low) or max(abs(low), 1.0) * 0.1
    return low - margin, high + margin


def _ticks(low, high):
    raw = (high - low) / 5
    step = 10.0 ** np.floor(np.log10(raw))
    step *= next(factor for factor in (1, 2, 5, 10) if factor * step >= raw)
    return np.round(np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step, 12)
