"""How well a mechanism predicts measured motions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Optional

import numpy as np

from . import hodograph_native as _native
from .arguments import Floats
from .errors import ArgumentError


class Validation:
    """Errors of predictions, one of each motion: ``errors`` (k,), the root of the mean square of the differences in their units, NaN where a motion cannot be
    predicted (``failed``: {place: why}); ``at_rest`` (k,) of the prediction that nothing moves; ``noise`` (k,) and ``floor`` (k,), where they were asked
    for; ``predictions``: of each motion an array (rows, columns) of ``outputs``, or None."""

    def __init__(self, found: dict[str, Any], outputs: list[str], samples: list[Floats]) -> None:
        self.outputs, self._samples = outputs, samples
        self.errors: Floats = found["errors"]
        self.at_rest: Floats = found["at_rest"]
        self.noise: Optional[Floats] = found["noise"]
        self.floor: Optional[Floats] = found["floor"]
        self.predictions: list[Optional[Floats]] = found["predictions"]
        self.failed: dict[int, str] = {place: why for place, why in enumerate(found["failed"]) if why is not None}

    @property
    def mean(self) -> float:
        """The mean error of the motions that are predicted."""
        return float(np.nanmean(self.errors))

    @property
    def standard_error(self) -> float:
        """Of the mean."""
        known = self.errors[~np.isnan(self.errors)]
        return float(known.std(ddof=1) / np.sqrt(len(known))) if len(known) > 1 else float("nan")

    @property
    def median(self) -> float:
        """The median error of the motions that are predicted."""
        return float(np.nanmedian(self.errors))

    def right(self, within: Mapping[str, float]) -> dict[str, Any]:
        """Of how many motions the last measured value of each of these outputs is predicted as near as the number says: ``right`` of ``count``, their
        ``share``, and its ``interval`` of 95 % (Wilson). What is not predicted is not right."""
        unknown = [name for name in within if name not in self.outputs]
        if unknown:
            raise ArgumentError(f"`{unknown[0]}` is not among the outputs {', '.join(self.outputs)}", kind="unknown_name", place="within")
        count, right = len(self.errors), 0
        for predicted, samples in zip(self.predictions, self._samples):
            near = predicted is not None
            for name, most in within.items():
                column = self.outputs.index(name)
                known = np.flatnonzero(~np.isnan(samples[:, column]))
                near = near and (not len(known) or bool(abs(predicted[known[-1], column] - samples[known[-1], column]) <= most))
            right += near
        return {"right": right, "count": count, "share": right / count, "interval": _native.wilson_interval(right, count)}

    def against(self, other: Validation) -> dict[str, Any]:
        """These errors less those of another prediction of the same motions: ``count``, ``mean``, ``standard_error``, ``median``, how many are ``nearer``,
        and Wilcoxon's two-sided ``p``."""
        if len(other.errors) != len(self.errors):
            message = f"{len(self.errors)} and {len(other.errors)} motions: expected predictions of the same motions"
            raise ArgumentError(message, kind="wrong_shape", place="other")
        differences = self.errors - other.errors
        differences = differences[~np.isnan(differences)]
        count = len(differences)
        p, _ = _native.signed_ranks(list(map(float, differences)))
        return {
            "count": count, "mean": float(differences.mean()) if count else float("nan"),
            "standard_error": float(differences.std(ddof=1) / np.sqrt(count)) if count > 1 else float("nan"),
            "median": float(np.median(differences)) if count else float("nan"), "nearer": int((differences < 0).sum()), "p": p,
        }  # fmt: skip

    def __repr__(self) -> str:
        failed = f", {len(self.failed)} failed" if self.failed else ""
        return f"<hodograph.Validation of {len(self.errors)} motions: mean {self.mean:.4g} +- {self.standard_error:.2g}, median {self.median:.4g}{failed}>"
