"""Pictures of lines, as SVG."""

from __future__ import annotations

import html
from collections.abc import Sequence
from typing import Any

import numpy as np

Line = tuple[Any, Any, str]
COLOURS = ("#1f5fa8", "#c2451e", "#2f7d3b", "#7a4b9e", "#a07a12", "#3f8f8f")


def plot(lines: Sequence[Line], x_label: str, y_label: str, width: int = 420, height: int = 300) -> str:
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
        colour = COLOURS[number % len(COLOURS)]
        points = " ".join(f"{a:.2f},{b:.2f}" for a, b in zip(px(x), py(y)) if np.isfinite(a) and np.isfinite(b))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
    for place, (number, name) in enumerate(names):
        colour, x, y = COLOURS[number % len(COLOURS)], left + each * (place % in_row), 12 + 16 * (place // in_row)
        parts.append(f'<path d="M{x} {y - 1}h14" stroke="{colour}" stroke-width="1.6"/>')
        parts.append(f'<text x="{x + 18}" y="{y + 3}" fill="{colour}">{html.escape(name)}</text>')
    middle = (top + height - bottom) / 2
    parts.append(f'<text x="{(left + width - right) / 2}" y="{height - 8}" text-anchor="middle">{x_label}</text>')
    parts.append(f'<text transform="translate(13 {middle}) rotate(-90)" text-anchor="middle">{y_label}</text>')
    return "".join(parts) + "</svg>"


def _text(number: float) -> str:
    """A number of an axis; zero has no sign."""
    return f"{number + 0.0:g}"


def _range(numbers: Any) -> tuple[float, float]:
    low, high = (float(numbers.min()), float(numbers.max())) if numbers.size else (0.0, 1.0)
    margin = 0.05 * (high - low) or max(abs(low), 1.0) * 0.1
    return low - margin, high + margin


def _ticks(low: float, high: float) -> Any:
    raw = (high - low) / 5
    step = 10.0 ** np.floor(np.log10(raw))
    step *= next(factor for factor in (1, 2, 5, 10) if factor * step >= raw)
    return np.round(np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step, 12)
