from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Words = Union[str, NDArray[np.object_], None]

class Impact:
    impulse: Floats
    velocity: Floats
    contact_work: Floats
    normal_work: Floats
    energy_gained: Floats
    path: Words
    kind: Words

class Characteristics:
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
    path: Words
    kind: Words

class Collision(Impact):
    speeds: Floats
    normal: Floats
    tangent: Floats
    binormal: Floats
    approach: Floats
    reduced: Floats
    impulse_on_point: Floats
    energy_change: Floats

class ImpactDerivative:
    impulse: Floats
    velocity: Floats
    smooth: Any
    path: Words
    kind: Words

class Hodograph:
    impulse: Floats
    velocity: Floats
    contact_work: Floats
    normal_work: Floats
    motion: list[str]
    path: str
    compression_end: Optional[float]
    slip_end: Optional[float]
    def _repr_html_(self) -> str: ...

class Event(NamedTuple):
    time: float
    kind: str
    contact: Optional[str]
    q: Floats
    u: Floats
    impulse_on_point: Optional[Floats]
    energy_change: Optional[float]

class Simulations:
    kind: list[str]
    message: list[Optional[str]]
    time: Floats
    rest: Floats
    q: Floats
    u: Floats
    closed: list[tuple[str, ...]]
    kinetic: Floats
    potential: Floats
    friction: Floats
    impacts: Floats
    input_work: Floats
    collisions: Any
    events: Any
    several_modes: Any
    digest: int
    coordinates: list[str]
    speeds: list[str]
    def __len__(self) -> int: ...
    def columns(self) -> dict[str, Any]: ...

class Simulation:
    time: Floats
    q: Floats
    u: Floats
    events: list[Event]
    coordinates: list[str]
    speeds: list[str]
    def columns(self) -> dict[str, Floats]: ...
    def _repr_html_(self) -> str: ...
