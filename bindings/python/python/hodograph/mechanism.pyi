from typing import Any, Callable, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from .results import Characteristics, Collision, Simulation, Simulations

Floats = NDArray[np.float64]
Rows = Union[Floats, Sequence[float], None]
Column = Union[Floats, float]

class Quantity(NamedTuple):
    name: str
    unit: str
    value: Union[float, Floats, None]

class Derivatives(NamedTuple):
    value: Floats
    by_coordinates: Floats
    by_speeds: Floats
    by_inputs: Floats

class Linearisation(NamedTuple):
    a: Floats
    b: Floats

class Contact(NamedTuple):
    normal: Floats
    first: Floats
    second: Floats
    velocity: Floats
    reduced: Floats
    gap: Optional[Floats]
    partial_velocities: Floats
    response: Floats

class Mechanism:
    name: str
    parameters: list[Quantity]
    coordinates: list[Quantity]
    speeds: list[Quantity]
    dependent_speeds: list[Quantity]
    inputs: list[Quantity]
    points: list[str]
    frames: list[str]
    contacts: list[str]
    quantities: dict[str, str]
    def __init__(
        self, model: Union[str, Mechanism], derivation: Optional[str] = ..., parameters: Union[Sequence[float], Floats, None] = ...
    ) -> None: ...
    def with_parameters(self, **parameters: Union[float, Floats]) -> Mechanism: ...
    def states(self, table: Any) -> dict[str, Floats]: ...
    def tabulate(self, quantity: str, table: Any, *names: str, **options: Any) -> Any: ...
    def accelerations(self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...) -> Floats: ...
    def mass_matrix(self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...) -> Floats: ...
    def forcing(self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...) -> Floats: ...
    def inverse_dynamics(
        self, accelerations: Rows, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Floats: ...
    def coordinate_rates(self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...) -> Floats: ...
    def compute_dependent_speeds(
        self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Floats: ...
    def kinetic_energy(self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...) -> Floats: ...
    def potential_energy(self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...) -> Floats: ...
    def quantity(
        self, name: str, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Floats: ...
    def position(
        self, point: str, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Floats: ...
    def velocity(
        self, point: str, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Floats: ...
    def jacobian(
        self, point: str, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Floats: ...
    def accelerations_derivatives(
        self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Derivatives: ...
    def inverse_dynamics_derivatives(
        self, accelerations: Rows, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Derivatives: ...
    def linearise(self, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...) -> Linearisation: ...
    def contact(
        self, contact: str, q: Rows = ..., u: Rows = ..., inputs: Rows = ..., time: Optional[Column] = ..., *, errors: str = ...
    ) -> Contact: ...
    def surface(self, contact: str) -> Optional[dict[str, Any]]: ...
    def collide(
        self,
        contact: str,
        q: Rows = ...,
        u: Rows = ...,
        inputs: Rows = ...,
        time: Optional[Column] = ...,
        *,
        mu: Optional[Column] = ...,
        e: Optional[Column] = ...,
        law: Optional[str] = ...,
        errors: str = ...,
    ) -> Collision: ...
    def characteristics(
        self,
        contact: str,
        q: Rows = ...,
        u: Rows = ...,
        inputs: Rows = ...,
        time: Optional[Column] = ...,
        *,
        mu: Optional[Column] = ...,
        e: Optional[Column] = ...,
        law: Optional[str] = ...,
        errors: str = ...,
    ) -> Characteristics: ...
    def simulate(
        self,
        until: float,
        step: Optional[float] = ...,
        q: Rows = ...,
        u: Rows = ...,
        inputs: Rows = ...,
        time: Optional[float] = ...,
        *,
        mu: Optional[float] = ...,
        e: Optional[float] = ...,
        law: Optional[str] = ...,
        tolerance: Optional[float] = ...,
        surfaces: Optional[Mapping[str, Mapping[str, Any]]] = ...,
        control: Optional[Callable[[float, Floats, Floats], Union[float, Sequence[float], Floats]]] = ...,
        period: Optional[float] = ...,
        max_step: Optional[float] = ...,
        mu_static: Optional[float] = ...,
        mu_impact: Optional[float] = ...,
        sliding: Union[None, str, Callable[[float], float]] = ...,
        restitution: Union[None, str, Sequence[tuple[float, float]], Callable[[float], float]] = ...,
        rolling: Optional[float] = ...,
        spinning: Optional[float] = ...,
    ) -> Simulation: ...
    def simulate_many(
        self,
        until: float,
        q: Rows = ...,
        u: Rows = ...,
        inputs: Rows = ...,
        time: Union[None, float, Floats] = ...,
        *,
        mu: Union[None, float, Floats] = ...,
        e: Union[None, float, Floats] = ...,
        law: Optional[str] = ...,
        mu_static: Union[None, float, Floats] = ...,
        mu_impact: Union[None, float, Floats] = ...,
        sliding: Union[None, str, Callable[[float], float]] = ...,
        restitution: Union[None, str, Sequence[tuple[float, float]], Callable[[float], float]] = ...,
        rolling: Union[None, float, Floats] = ...,
        spinning: Union[None, float, Floats] = ...,
        tolerance: Optional[float] = ...,
        surfaces: Optional[Mapping[str, Mapping[str, Any]]] = ...,
        max_step: Optional[float] = ...,
        threads: Optional[int] = ...,
        progress: Optional[Callable[[int, int], object]] = ...,
    ) -> Simulations: ...
    def equations(self, format: str = ...) -> str: ...

class NumericMechanism:
    def __init__(self, model: str) -> None: ...
    def mass_matrix(self, q: Rows, u: Rows, inputs: Rows = ..., time: float = ...) -> Floats: ...
    def forcing(self, q: Rows, u: Rows, inputs: Rows = ..., time: float = ...) -> Floats: ...
    def accelerations(self, q: Rows, u: Rows, inputs: Rows = ..., time: float = ...) -> Floats: ...
    def coordinate_rates(self, q: Rows, u: Rows, inputs: Rows = ..., time: float = ...) -> Floats: ...
    def kinetic_energy(self, q: Rows, u: Rows, inputs: Rows = ..., time: float = ...) -> float: ...
