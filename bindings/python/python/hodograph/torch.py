"""Functions of PyTorch that carry the exact derivatives: ``import hodograph.torch``. Needs torch, and tensors of doubles.

Each function here makes one of a mechanism. What is made takes rows as first axes, which are broadcast, and can be differentiated once, backward
(``backward``, ``torch.autograd.grad``, ``torch.autograd.functional.jacobian``); rows without an answer are NaN. Derivatives are those by independent
coordinates: dependent ones follow. What is computed is on the processor, whatever the device of the tensors is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import torch

from .differentiable import Differentiable
from .errors import ArgumentError
from .functions import Functions

__all__ = ["accelerations", "collide", "inverse_dynamics", "motion"]

Tensor = Any


class _Function(torch.autograd.Function):  # type: ignore[misc, unused-ignore]
    """The values of a function, and its derivatives where some are asked for."""

    @staticmethod
    def forward(ctx: Any, of: Differentiable, *tensors: Tensor) -> Tensor:
        wanted = any(ctx.needs_input_grad[1:])
        arrays = [tensor.detach().cpu().numpy() for tensor in tensors]
        function, shapes = (of.derivatives, of.shapes) if wanted else (of.values, [of.shape])
        value, *by = (torch.from_numpy(part.copy()).to(tensors[0].device) for part in of.over_rows(function, shapes, *arrays))
        ctx.save_for_backward(*by)
        ctx.of, ctx.shapes = of, [tensor.shape for tensor in tensors]
        return value

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, gradient: Tensor) -> Any:
        found = []
        for place, (by, own, shape) in enumerate(zip(ctx.saved_tensors, ctx.of.arguments, ctx.shapes)):
            if not ctx.needs_input_grad[place + 1]:
                found.append(None)
                continue
            # The axes of the answer are summed over, then those along which the argument was repeated.
            weights = gradient[(..., *[None] * len(own))] * by
            axes = len(ctx.of.shape)
            summed = weights.sum(dim=tuple(range(-axes - len(own), -len(own))))
            found.append(summed.sum_to_size(shape))
        return (None, *found)


def _function(of: Differentiable) -> Callable[..., Tensor]:
    """The function of tensors; numbers and arrays are taken, too."""

    def found(*given: Any) -> Tensor:
        known = next((tensor for tensor in given if isinstance(tensor, torch.Tensor)), None)
        device = None if known is None else known.device
        tensors = [tensor if isinstance(tensor, torch.Tensor) else torch.as_tensor(tensor, dtype=torch.float64, device=device) for tensor in given]
        for tensor in tensors:
            if tensor.dtype != torch.float64:
                raise ArgumentError(f"a tensor has the dtype {tensor.dtype}: expected torch.float64 (`.double()` converts)", kind="wrong_dtype", place="dtype")
        return _Function.apply(of, *tensors)

    return found


_functions = Functions(_function)
accelerations = _functions.accelerations
collide = _functions.collide
inverse_dynamics = _functions.inverse_dynamics
motion = _functions.motion
