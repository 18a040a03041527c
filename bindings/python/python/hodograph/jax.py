"""Functions of JAX that carry the exact derivatives: ``import hodograph.jax``. Needs jax, with doubles (``jax.config.update("jax_enable_x64", True)``).

Each function here makes one of a mechanism. What is made can be compiled (``jit``), mapped over rows (``vmap``, or rows as a first axis) and differentiated
once, forward and backward; rows without an answer are NaN. Derivatives are those by independent coordinates: dependent ones follow.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import jax
import jax.numpy as jnp

from .differentiable import Differentiable
from .errors import ArgumentError
from .functions import Functions

__all__ = ["accelerations", "collide", "inverse_dynamics", "motion"]

Array = Any


def _call(of: Differentiable, function: Callable[..., Any], shapes: Sequence[tuple[int, ...]], *arrays: Array) -> Any:
    """Calls a function of rows outside of JAX; it answers arrays of the ``shapes`` for each row."""
    if not jax.config.read("jax_enable_x64"):
        raise ArgumentError(
            'JAX computes with float32: expected `jax.config.update("jax_enable_x64", True)` before', kind="wrong_dtype", place="jax_enable_x64"
        )
    given = [jnp.asarray(array, dtype=jnp.float64) for array in arrays]
    lead = of.leading(*given)
    answers = tuple(jax.ShapeDtypeStruct(lead + shape, jnp.float64) for shape in shapes)
    return jax.pure_callback(lambda *rows: of.over_rows(function, shapes, *map(np.asarray, rows)), answers, *given, vmap_method="broadcast_all")


def _function(of: Differentiable) -> Callable[..., Array]:
    """The function with its derivatives."""

    @jax.custom_jvp
    def found(*arrays: Array) -> Array:
        return _call(of, of.values, [of.shape], *arrays)[0]

    @found.defjvp
    def _(primals: Any, tangents: Any) -> Any:
        value, *by = _call(of, of.derivatives, of.shapes, *primals)
        change = jnp.zeros_like(value)
        for part, tangent, own in zip(by, tangents, of.arguments):
            across = (..., *[None] * len(of.shape))
            if own:
                # one axis of the direction is summed over
                change += jnp.sum(part * tangent[(*across, slice(None))], axis=-1)
            else:
                change += part * tangent[across]
        return value, change

    return lambda *arrays: found(*(jnp.asarray(array, jnp.float64) for array in arrays))


_functions = Functions(_function)
accelerations = _functions.accelerations
collide = _functions.collide
inverse_dynamics = _functions.inverse_dynamics
motion = _functions.motion
