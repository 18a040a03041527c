"""Mechanisms."""

from __future__ import annotations

import html
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import hodograph_native as _native
from . import tables
from .arguments import Column, Floats, Rows, index, number, numbers, optional_number, unknown
from .description import Contact, Quantity
from .errors import ArgumentError, HodographError
from .gradients import Adjoint, Branch, Fit, MotionGradient, Orbit
from .validation import Validation
from .motion import Simulation, Simulations
from .results import Characteristics, ClosedContact, Collision, CollisionDerivative, Impact, ImpactDerivative

#: A function of a speed, a name with numbers, or pairs.
SpeedLaw = Union[None, str, Sequence[tuple[float, float]], Callable[[float], float]]
#: A function of time, coordinates and speeds.
Control = Callable[[float, Floats, Floats], Union[float, Sequence[float], Floats]]
# a period, s, and inputs (k, w)
Samples = tuple[float, Any]
Watched = Callable[[float, Floats, Floats], float]


class Derivatives(NamedTuple):
    """A value (p,) with its derivatives by independent coordinates, independent speeds and inputs, each (p, k)."""

    value: Floats
    by_coordinates: Floats
    by_speeds: Floats
    by_inputs: Floats


class Linearisation(NamedTuple):
    """x' = a x + b w for small deviations; x: independent coordinates, then independent speeds; w: inputs."""

    a: Floats
    b: Floats


class Mechanism(_native.Mechanism):
    """A mechanism with its equations. See :func:`hodograph.load`; :meth:`with_parameters` gives one with other parameters.

    Every method takes ``q`` (n,), ``u`` (p,), ``inputs`` (w,), ``time`` (s), or many of them, (k, n) and so on; arrays of one state serve all others.
    States without an answer raise :class:`StateError`; with ``errors='nan'`` their answers are NaN.
    """

    __slots__ = ("_known",)

    def _names_of(self, kind: str) -> list[str]:
        """The names of a kind of component, which do not change."""
        try:
            known = self._known
        except AttributeError:
            known = self._known = {}
        if kind not in known:
            known[kind] = [name for name, *_ in self._describe(kind)]
        names: list[str] = known[kind]
        return names

    def _quantities(self, kind: str) -> list[Quantity]:
        return [Quantity(*entry) for entry in self._describe(kind)]

    @property
    def parameters(self) -> list[Quantity]:
        """Parameters that can be changed."""
        return self._quantities("parameters")

    @property
    def coordinates(self) -> list[Quantity]:
        """Coordinates, with initial values."""
        return self._quantities("coordinates")

    @property
    def speeds(self) -> list[Quantity]:
        """Independent speeds, with initial values."""
        return self._quantities("speeds")

    @property
    def dependent_speeds(self) -> list[Quantity]:
        """Dependent speeds."""
        return self._quantities("dependent_speeds")

    @property
    def inputs(self) -> list[Quantity]:
        """Named inputs, with initial values."""
        return self._quantities("inputs")

    @property
    def points(self) -> list[str]:
        """Names of points."""
        return list(self._names_of("points"))

    @property
    def frames(self) -> list[str]:
        """Names of frames."""
        return list(self._names_of("frames"))

    @property
    def contacts(self) -> list[str]:
        """Names of contacts."""
        return list(self._names_of("contacts"))

    @property
    def quantities(self) -> dict[str, str]:
        """Names and units for :meth:`quantity`."""
        return {name: unit for name, unit, _ in self._describe("quantities")}

    def with_parameters(self, **parameters: Column) -> Mechanism:
        """This mechanism with other values of some parameters. Arrays (k,) make k machines, one for every row of a state: the
        answers are those of k mechanisms, row by row. Rows that follow each other with equal parameters share the work that depends on these alone.
        """
        values: dict[str, Any] = {quantity.name: quantity.value for quantity in self.parameters}
        for name, given in parameters.items():
            if name not in values:
                raise unknown("parameter", name, values)
            value = numbers(given, name)
            if value.ndim > 1:
                raise ArgumentError(
                    f"`{name}` has the shape {value.shape}: expected a number or (k,)", kind="wrong_shape", place=name
                )
            values[name] = value
        try:
            columns = np.broadcast_arrays(*values.values()) if values else []
        except ValueError:
            sizes = ", ".join(f"{name}: {len(value)}" for name, value in values.items() if np.ndim(value))
            raise ArgumentError(
                f"parameters have different numbers of rows ({sizes}): expected as many", kind="wrong_shape", place="parameters"
            ) from None
        matrix = np.ascontiguousarray(np.stack(columns, axis=-1)) if columns else np.zeros(0)
        return type(self)(self, None, matrix)

    def _columns_of_states(self) -> dict[str, list[Quantity]]:
        """What a state consists of, by the names of arguments."""
        return {"q": self.coordinates, "u": self.speeds, "inputs": self.inputs}

    def states(self, table: Any) -> dict[str, Floats]:
        """The arguments ``q``, ``u``, ``inputs`` and ``time`` of many states from a table of columns with the names of the model: a DataFrame of pandas or
        polars, a pyarrow Table, an xarray Dataset of one dimension, or a dictionary. What has no column is what the model states; other columns are
        left alone. ``m.accelerations(**m.states(table))``.
        """
        return tables.states(self._columns_of_states(), table)

    def tabulate(self, quantity: str, table: Any, *names: str, **options: Any) -> Any:
        """A quantity of all states of a table, as a table of the same kind (pandas with the same index, polars, pyarrow, xarray, or a dictionary) by
        column names: ``m.tabulate("accelerations", frame)``, ``m.tabulate("position", frame, "P")``,
        ``m.tabulate("collide", frame, "tip", mu=0.3, e=0.5, law="poisson")``. ``quantity`` is the name of a method that gives a number, a vector
        or a collision for a state; what else it needs follows. Columns with the names of parameters make one machine for every row. Rates have the name of
        their coordinate or speed and a prime, vectors x, y, z; a speed that is called like another column of a collision, such as ``path``, is ``after_path``.
        """
        if quantity not in _COLUMNS:
            raise unknown("quantity for a table", str(quantity), _COLUMNS)
        names_of = tables.column_names(table)
        variable = {quantity.name for quantity in self.parameters}
        machines = {name: numbers(table[name], name) for name in names_of if name in variable}
        states = tables.states(self._columns_of_states(), table, frozenset(variable))
        mechanism = self.with_parameters(**machines) if machines else self
        found = getattr(mechanism, quantity)(*names, **states, **options)
        columns: dict[str, Any]
        if quantity == "collide":
            outcome: dict[str, Any] = {}
            for name, axes in (("impulse", "nts"), ("velocity", "nts"), ("impulse_on_point", "xyz")):
                outcome.update({f"{name}_{axis}": column for axis, column in zip(axes, getattr(found, name).T)})
            for name in ("energy_change", "contact_work", "normal_work", "path", "kind"):
                outcome[name] = getattr(found, name)
            after = {f"after_{q.name}" if q.name in outcome else q.name: column for q, column in zip(self.speeds, found.speeds.T)}
            columns = {**after, **outcome}
        elif found.ndim == 1:
            columns = {quantity: found}
        else:
            columns = dict(zip(_COLUMNS[quantity](self), found.T))
        return tables.like(table, columns)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), *self._state())

    def __copy__(self) -> Mechanism:
        return self

    def __deepcopy__(self, memo: Any) -> Mechanism:
        # What is known of it never changes.
        return self

    def accelerations(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Rates u' of the independent speeds, (p,) or (k, p)."""
        return self._evaluate("accelerations", q, u, inputs, time, errors)

    def mass_matrix(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """M, (p, p) or (k, p, p)."""
        return self._evaluate("mass_matrix", q, u, inputs, time, errors)

    def forcing(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Forcing, (p,) or (k, p): M u' = forcing."""
        return self._evaluate("forcing", q, u, inputs, time, errors)

    def inverse_dynamics(self, accelerations: Rows, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Generalised forces, (p,) or (k, p), that must be added to the loads for these u': M u' - forcing."""
        return self._evaluate("inverse_dynamics", q, u, inputs, time, errors, accelerations)

    def coordinate_rates(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """q', (n,) or (k, n)."""
        return self._evaluate("coordinate_rates", q, u, inputs, time, errors)

    def compute_dependent_speeds(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Dependent speeds, (d,) or (k, d)."""
        return self._evaluate("dependent_speeds", q, u, inputs, time, errors)

    def kinetic_energy(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Kinetic energy, J."""
        return self._evaluate("kinetic_energy", q, u, inputs, time, errors)

    def potential_energy(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Potential energy of gravity and springs, J."""
        return self._evaluate("potential_energy", q, u, inputs, time, errors)

    def quantity(self, name: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """A quantity of the whole mechanism by its name, one of :attr:`quantities`, along N.x, N.y, N.z: ``momentum``, ``angular_momentum`` (about O),
        ``central_angular_momentum`` (about the mass centre), ``mass_centre_position``, ``mass_centre_velocity``; (3,) or (k, 3)."""
        known = self.quantities
        if name not in known:
            raise unknown("quantity", str(name), known)
        return self._evaluate(name, q, u, inputs, time, errors)

    def position(self, point: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Position of a point from O along N.x, N.y, N.z, m, (3,) or (k, 3)."""
        return self._of_point(point, "position", q, u, inputs, time, errors)

    def velocity(self, point: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Velocity of a point along N.x, N.y, N.z, m/s, (3,) or (k, 3)."""
        return self._of_point(point, "velocity", q, u, inputs, time, errors)

    def jacobian(self, point: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Partial velocities of a point, (3, p) or (k, 3, p)."""
        return self._of_point(point, "jacobian", q, u, inputs, time, errors)

    def acceleration(self, point: str, accelerations: Rows = None, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """Acceleration of a point along N.x, N.y, N.z, m/s^2, (3,) or (k, 3), under these rates u' of the independent speeds; without them, those of
        :meth:`accelerations`."""
        if accelerations is None:
            accelerations = self.accelerations(q, u, inputs, time, errors=errors)
        return self._of_point(point, "acceleration", q, u, inputs, time, errors, accelerations)

    def orientation(self, frame: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Floats:
        """The axes of a frame: the columns x, y, z along N.x, N.y, N.z, (3, 3) or (k, 3, 3)."""
        return self._evaluate(f"orientation {index('frame', frame, self._names_of('frames'))}", q, u, inputs, time, errors)

    def gap(self, contact: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Optional[Floats]:
        """The gap of a contact, m; None where the model states none."""
        place = index("contact", contact, self._names_of("contacts"))
        try:
            return self._evaluate(f"contact {place} gap", q, u, inputs, time, errors)
        except HodographError as error:
            if error.kind != "undefined":
                raise
            return None

    def _of_point(self, point: str, what: str, q: Rows, u: Rows, inputs: Rows, time: Optional[Column], errors: str, accelerations: Rows = None) -> Floats:
        place = index("point", point, self._names_of("points"))
        if place == 0:
            raise ArgumentError(f"{point} is the origin: it has no {what}", kind="unknown_name", place="point")
        return self._evaluate(f"point {place} {what}", q, u, inputs, time, errors, accelerations)

    def accelerations_derivatives(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Derivatives:
        """Accelerations and their derivatives, as :class:`Derivatives`."""
        return self._split(self._evaluate("accelerations_derivatives", q, u, inputs, time, errors))

    def inverse_dynamics_derivatives(self, accelerations: Rows, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Derivatives:
        """Inverse dynamics and its derivatives, as :class:`Derivatives`."""
        return self._split(self._evaluate("inverse_dynamics_derivatives", q, u, inputs, time, errors, accelerations))

    def _split(self, matrix: Floats) -> Derivatives:
        p, w = matrix.shape[-2], len(self.inputs)
        first = matrix.shape[-1] - p - w
        return Derivatives(
            matrix[..., 0], matrix[..., 1:first], matrix[..., first : first + p], matrix[..., first + p :]
        )

    def linearise(self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Linearisation:
        """The equations linearised about states, as :class:`Linearisation`."""
        rates = self._evaluate("rates_derivatives", q, u, inputs, time, errors)
        rows = self._evaluate("accelerations_derivatives", q, u, inputs, time, errors)
        both = np.concatenate([rates, rows[..., 1:]], axis=-2)
        states = both.shape[-2]
        return Linearisation(both[..., :states], both[..., states:])

    def contact(self, contact: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, errors: str = "raise") -> Contact:
        """Basis, velocity, reduced matrix (nn, n1, n2, 11, 12, 22), gap and matrices V (3, p), M^-1 V^T (p, 3) of a contact, as :class:`Contact`."""
        place = index("contact", contact, self._names_of("contacts"))
        of = lambda what: self._evaluate(f"contact {place} {what}", q, u, inputs, time, errors)  # noqa: E731
        basis = [of(what) for what in ("normal", "first", "second", "velocity", "reduced")]
        return Contact(*basis, self.gap(contact, q, u, inputs, time, errors=errors), of("partial_velocities"), of("response"))

    def surface(self, contact: str) -> Optional[dict[str, Any]]:
        """Friction and restitution that the model states for a contact (its name), as {"mu": .., "e": .., "law": ..}; None where it states none."""
        return self._surface(index("contact", contact, self._names_of("contacts")))

    def _of_contact(self, contact: str, mu: Any, e: Any, law: Any) -> tuple[Any, Any, Any]:
        """What is given of a surface, and for what is not, what the model states."""
        if mu is not None and e is not None and law is not None:
            return mu, e, law
        given = {"mu": mu, "e": e, "law": law}
        missing = [name for name, value in given.items() if value is None]
        stated = self.surface(contact)
        if stated is None:
            raise ArgumentError(
                f"contact {contact} has no surface: give mu, e and law, or state its `surface` in the model",
                kind="no_surface", place=missing[0],
            )  # fmt: skip
        given.update((name, stated[name]) for name in missing)
        return given["mu"], given["e"], given["law"]

    def _fields(self) -> tuple[tuple[str, int], ...]:
        """What a collision answers, which does not change."""
        self._names_of("speeds")
        if "fields" not in self._known:
            self._known["fields"] = (("speeds", len(self._names_of("speeds"))), *_native.COLLISION)
        fields: tuple[tuple[str, int], ...] = self._known["fields"]
        return fields

    def collide(
        self, contact: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *,
        mu: Optional[Column] = None, e: Optional[Column] = None, law: Optional[str] = None, errors: str = "raise", budget: Optional[int] = None,
    ) -> Collision:
        """Collisions of a contact (its name), as :class:`Collision`. ``mu``, ``e``: numbers or (k,); ``law``: 'newton', 'poisson', 'stronge'; what is
        not given is that of the model. ``budget``: a collision that would take more quadratures than this has no outcome."""
        place = index("contact", contact, self._names_of("contacts"))
        mu, e, law = self._of_contact(contact, mu, e, law)
        return Collision(self._collide(place, q, u, inputs, time, mu, e, law, errors, budget), self._fields())

    def collide_derivative(
        self, contact: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *,
        mu: Optional[Column] = None, e: Optional[Column] = None, law: Optional[str] = None, errors: str = "raise",
    ) -> CollisionDerivative:
        """The speeds after collisions with their derivatives by the state before and the surface, as :class:`CollisionDerivative`; the arguments are those
        of :meth:`collide`."""
        hit, _ = self._differentiated(contact, q, u, inputs, time, mu, e, law, errors)
        return hit

    def _differentiated(
        self, contact: str, q: Rows, u: Rows, inputs: Rows, time: Optional[Column], mu: Any, e: Any, law: Any, errors: str
    ) -> tuple[CollisionDerivative, Floats]:
        """The derivative of a collision, and that of its gap by coordinates, speeds and inputs (empty without one)."""
        place = index("contact", contact, self._names_of("contacts"))
        mu, e, law = self._of_contact(contact, mu, e, law)
        hit = self.collide(contact, q, u, inputs, time, mu=mu, e=e, law=law, errors=errors)
        of = self._evaluate(f"contact {place} derivatives", q, u, inputs, time, errors)
        p, w = hit.speeds.shape[-1], len(self.inputs)
        velocity, reduced = np.ascontiguousarray(of[..., :3, 0]), np.ascontiguousarray(of[..., 3:9, 0])
        response, by_response = of[..., 9 : 9 + 3 * p, 0], of[..., 9 : 9 + 3 * p, 1:]
        response = response.reshape(*response.shape[:-1], p, 3)
        by_response = by_response.reshape(*by_response.shape[:-2], p, 3, by_response.shape[-1])
        # In the basis of the contact.
        solved = Impact(_native.solve(reduced, velocity, mu, e, law, "nan"))
        outcome = ImpactDerivative(_native.derivative(reduced, velocity, mu, e, law, errors))
        along = np.einsum("...ij,...jk->...ik", outcome.impulse[..., :9], of[..., :9, 1:])
        by = np.einsum("...pi,...ik->...pk", response, along) + np.einsum("...pik,...i->...pk", by_response, solved.impulse)
        first = by.shape[-1] - p - w
        by_speeds = by[..., first : first + p] + np.eye(p)
        surface = np.einsum("...pi,...ik->...pk", response, outcome.impulse[..., 9:])
        parts = (by[..., :first], by_speeds, by[..., first + p :], surface[..., 0], surface[..., 1])
        return CollisionDerivative(hit.speeds, parts, outcome.smooth, hit.kind), of[..., 9 + 3 * p :, 1:]

    def saltation(
        self, contact: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *,
        mu: Optional[Column] = None, e: Optional[Column] = None, law: Optional[str] = None, errors: str = "raise",
    ) -> Floats:
        """The saltation matrix of collisions, (N, N) or (k, N, N), of the independent coordinates, then the independent speeds: to first order it maps the
        deviation of a neighbouring motion before the collision to that after it, at the same time. The contact must have a gap."""
        hit, gap = self._differentiated(contact, q, u, inputs, time, mu, e, law, errors)
        if gap.shape[-2] == 0:
            raise ArgumentError(f"{contact} has no gap: a saltation matrix needs one", kind="undefined", place=contact)
        p, n = hit.speeds.shape[-1], hit.by_coordinates.shape[-1]
        independent = self._independent
        rates = lambda u: np.concatenate(  # noqa: E731
            [
                self.coordinate_rates(q, u, inputs, time, errors=errors)[..., independent],
                self.accelerations(q, u, inputs, time, errors=errors),
            ],
            axis=-1,
        )
        before, after = np.broadcast_arrays(rates(u), rates(hit.speeds))
        reset = np.zeros((*hit.speeds.shape[:-1], n + p, n + p))
        reset[..., :n, :n] = np.eye(n)
        reset[..., n:, :n], reset[..., n:, n:] = hit.by_coordinates, hit.by_speeds
        gradient = np.zeros((*gap.shape[:-2], n + p))
        gradient[..., :n] = gap[..., 0, :n]
        closing = np.sum(gradient * before, axis=-1)
        if errors == "raise" and np.any(closing >= 0):
            raise ArgumentError(f"{contact} does not approach: its gap opens", kind="not_approaching", place=contact)
        jump = after - np.einsum("...ij,...j->...i", reset, before)
        with np.errstate(divide="ignore", invalid="ignore"):
            found: Floats = reset + jump[..., :, None] * gradient[..., None, :] / np.where(closing < 0, closing, np.nan)[..., None, None]
        return found

    def contact_mode(
        self, contact: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, mu: Optional[Column] = None, errors: str = "raise"
    ) -> ClosedContact:
        """Mode and force of a contact that is closed (its normal velocity is taken as zero), as :class:`ClosedContact`."""
        return self._closed_contact(contact, None, q, u, inputs, time, mu, errors)

    def contact_force(
        self, contact: str, mode: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *, mu: Optional[Column] = None, errors: str = "raise"
    ) -> ClosedContact:
        """The force of a contact in a mode: 'separate', 'slide', 'stick', 'begin_slip', as :class:`ClosedContact`; its margins say whether the mode holds."""
        return self._closed_contact(contact, mode, q, u, inputs, time, mu, errors)

    def _closed_contact(
        self, contact: str, mode: Optional[str], q: Rows, u: Rows, inputs: Rows, time: Optional[Column], mu: Optional[Column], errors: str
    ) -> ClosedContact:
        place = index("contact", contact, self._names_of("contacts"))
        mu, *_ = self._of_contact(contact, mu, 0.0, "newton")
        return ClosedContact(self._closed(place, (q, u, inputs, time), mu, mode, errors))

    def characteristics(
        self, contact: str, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *,
        mu: Optional[Column] = None, e: Optional[Column] = None, law: Optional[str] = None, errors: str = "raise",
    ) -> Characteristics:
        """Characteristic quantities of the collisions of :meth:`collide`, along its n, t, s, as :class:`Characteristics`."""
        mu, e, law = self._of_contact(contact, mu, e, law)
        hit = self.collide(contact, q, u, inputs, time, mu=mu, e=e, law=law, errors=errors)
        found = Characteristics(_native.characteristics(hit.reduced, hit.approach, mu, e, law, errors))
        # A state without a collision has the reason of the collision.
        found.kind = hit.kind
        return found

    def simulate(
        self, until: float, step: Optional[float] = None, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[float] = None, *,
        mu: Optional[float] = None, e: Optional[float] = None, law: Optional[str] = None, tolerance: Optional[float] = None,
        surfaces: Optional[Mapping[str, Mapping[str, Any]]] = None, control: Optional[Control] = None, period: Optional[float] = None,
        max_step: Optional[float] = None, mu_static: Optional[float] = None, mu_impact: Optional[float] = None, sliding: SpeedLaw = None,
        restitution: SpeedLaw = None, rolling: Optional[float] = None, spinning: Optional[float] = None,
        events: Optional[Mapping[str, Watched]] = None, stop: Union[None, str, Iterable[str]] = None, together: Optional[str] = None, seed: int = 0,
    ) -> Simulation:
        """A motion with impacts and contact that lasts, from a state to the time ``until``, told every ``step`` seconds, as :class:`Simulation`.

        ``mu``, ``e``, ``law``: the surface of all contacts; ``surfaces``: {contact: {"mu": .., "e": .., "law": ..}} for contacts with another one. A contact
        that can close (it has a gap) needs all three: what is not given is that of the model, if it states a ``surface``. The other defaults are those of the command line tool: ``step`` 0.01 s,
        ``tolerance`` 1e-12, ``max_step`` 0.05 s where something depends on time by itself, else unbounded.
        ``mu_static``: up to which a contact sticks (not less than ``mu``); ``mu_impact``: friction in impacts; ``sliding``: 'stribeck(SPEED)', or a function of
        the speed of slip; ``restitution``: e by the speed of approach, as 'threshold(SPEED)', 'power(SPEED, EXPONENT)', 'loss(SPEED, EXPONENT)', pairs
        (speed, e), or a function; ``rolling``, ``spinning``: lever arms (m) of the torques that resist rotation in the plane of contact and about its
        normal, for contacts whose surface in the model states them; also in ``surfaces``. What is left out is that of the model.
        ``control``: a function of time, q (n,) and u (p,) that gives the inputs (w,): with ``period`` (s) at these times and held in between, otherwise
        continuously (it must be smooth then). What it raises ends the motion, as Ctrl-C does; an exception that ends a motion under way has the attribute
        ``motion``, the :class:`Simulation` up to there. ``tolerance``: of the integration, relative and absolute; ``max_step``: s.
        ``events``: functions of time, q and u by name, whose zeros are events of that name; ``stop``: kinds or names of events at which the motion ends.
        ``together``: what contacts do that are struck at one time: 'approaching', 'sequential', 'simultaneous', 'lzb', 'stop', or 'sampled': groups and orders
        are drawn with this ``seed``.
        """
        if period is not None and control is None:
            raise ArgumentError("`period` is that of `control`, which is missing", kind="bad_option", place="period")
        choices = self._choices(
            surfaces, tolerance, max_step, control, period, events, stop, together, seed,
            mu=mu, e=e, law=law, mu_static=mu_static, mu_impact=mu_impact, sliding=sliding, restitution=restitution, rolling=rolling, spinning=spinning,
        )  # fmt: skip
        try:
            found = self._simulate((q, u, inputs, time), number(until, "until"), optional_number(step, "step"), choices)
            return Simulation(found, self)
        except BaseException as error:
            made = error.__dict__.pop("_motion", None)
            if made is not None:
                error.motion = Simulation(made, self)  # type: ignore[attr-defined]
            raise

    def _choices(
        self, own: Any, tolerance: Any, max_step: Any, control: Any = None, period: Any = None, events: Any = None, stop: Any = None,
        together: Any = None, seed: Any = 0, samples: Any = None, **all_contacts: Any,
    ) -> dict[str, Any]:
        """What a motion is to be like: the surfaces of all contacts and of those that have one of their own, and all else."""
        names = [stop] if isinstance(stop, str) else list(stop or ())
        _check_seed(seed)
        of = lambda given: (optional_number(given.get("mu"), "mu"), optional_number(given.get("e"), "e"), given.get("law"))  # noqa: E731
        some = lambda given, name: optional_number(given.get(name), name)  # noqa: E731
        law = lambda given: (  # noqa: E731
            some(given, "mu_static"), some(given, "mu_impact"), given.get("sliding"), given.get("restitution"), some(given, "rolling"), some(given, "spinning"),
        )  # fmt: skip
        known = ("mu", "e", "law", "mu_static", "mu_impact", "sliding", "restitution", "rolling", "spinning")
        for contact, given in (own or {}).items():
            for name in given:
                if name not in known:
                    raise unknown(f"property of the surface of {contact}", str(name), known)
        own = [(index("contact", contact, self._names_of("contacts")), given) for contact, given in (own or {}).items()]
        return {
            "surface": of(all_contacts), "law": law(all_contacts), "surfaces": [(contact, of(given)) for contact, given in own],
            "laws": [(contact, law(given)) for contact, given in own], "tolerance": optional_number(tolerance, "tolerance"),
            "max_step": optional_number(max_step, "max_step"), "control": control, "period": optional_number(period, "period"),
            "samples": _samples(samples), "events": list((events or {}).items()), "stop": [str(name) for name in names], "together": together, "seed": seed,
        }  # fmt: skip

    def simulate_many(
        self, until: float, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[Column] = None, *,
        mu: Optional[Column] = None, e: Optional[Column] = None, law: Optional[str] = None, mu_static: Optional[Column] = None,
        mu_impact: Optional[Column] = None, sliding: SpeedLaw = None, restitution: SpeedLaw = None, rolling: Optional[Column] = None,
        spinning: Optional[Column] = None, tolerance: Optional[float] = None, surfaces: Optional[Mapping[str, Mapping[str, Any]]] = None,
        max_step: Optional[float] = None, threads: Optional[int] = None, progress: Optional[Callable[[int, int], object]] = None,
        events: Optional[Mapping[str, Watched]] = None, stop: Union[None, str, Iterable[str]] = None, together: Optional[str] = None, seed: int = 0,
    ) -> Simulations:
        """Many motions to the time ``until``, one for each row of ``q`` (k, n), ``u``, ``inputs``, ``time`` (k,), of the parameters of a mechanism of
        :meth:`with_parameters`, and of ``mu``, ``e``, ``mu_static``, ``mu_impact``, ``rolling`` and ``spinning`` (numbers or (k,)), as
        :class:`Simulations`.

        Rows share the cores (``threads``: so many); outcomes have the same bits in any order and on any number of threads. What is wrong with a row is
        the outcome of that row. ``progress``: a function of the rows that are done and of all rows, called now and then; what it raises ends the batch, as
        Ctrl-C does. A motion ends at the first of its events that ``stop`` names ('rest', 'collision', .., or one of ``events``). With ``together`` 'sampled'
        each row draws with the seed ``seed`` plus its number. All else is as for :meth:`simulate`.
        """
        choices = self._choices(surfaces, tolerance, max_step, events=events, stop=stop, together=together, seed=seed, law=law, sliding=sliding, restitution=restitution)  # noqa: E501
        if threads is not None and (isinstance(threads, bool) or not isinstance(threads, int) or threads < 1):
            raise ArgumentError(f"`threads` is {threads!r}: expected a whole number, at least 1", kind="bad_option", place="threads")
        columns = (mu, e, mu_static, mu_impact, rolling, spinning)
        found = self._simulate_many((q, u, inputs, time), number(until, "until"), columns, choices, threads, progress)
        return Simulations(found, list(self._names_of("coordinates")), list(self._names_of("speeds")))

    def gradient(
        self, by: Sequence[str], at: Union[float, Sequence[float], Floats], q: Rows = None, u: Rows = None, inputs: Rows = None,
        time: Optional[float] = None, *, mu: Optional[float] = None, e: Optional[float] = None, law: Optional[str] = None,
        tolerance: Optional[float] = None, surfaces: Optional[Mapping[str, Mapping[str, Any]]] = None, max_step: Optional[float] = None,
        samples: Optional[Samples] = None,
    ) -> MotionGradient:
        """A motion at the times ``at``, which rise, with its exact derivatives by the variables ``by``: names of coordinates and speeds of the start, of
        parameters and held inputs, 'mu', 'e', or 'mu.CONTACT', 'e.CONTACT', through impacts and contact that lasts, as :class:`MotionGradient`.

        ``samples``: a period, s, and inputs (k, w) that are constant for a period each, from the start on, the last row to the end; 'INPUT[ROW]' is one of
        them, 'INPUT' all of them together."""
        names = (by,) if isinstance(by, str) else tuple(by)
        choices = self._choices(surfaces, tolerance, max_step, mu=mu, e=e, law=law, samples=samples)
        times = [float(value) for value in np.atleast_1d(numbers(at, "at"))]
        found = self._gradient((q, u, inputs, time), list(names), times, choices)
        return MotionGradient(found, names, len(self._names_of("coordinates")))

    def adjoint(
        self, by: Sequence[str], at: Union[float, Sequence[float], Floats], weights: Union[Floats, Callable[[Floats, Floats], Any]],
        q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[float] = None, *, mu: Optional[float] = None, e: Optional[float] = None,
        law: Optional[str] = None, tolerance: Optional[float] = None, surfaces: Optional[Mapping[str, Mapping[str, Any]]] = None,
        max_step: Optional[float] = None, samples: Optional[Samples] = None,
    ) -> Adjoint:
        """The derivatives of a function of the states at the times ``at`` by the variables ``by``, found backwards, as :class:`Adjoint`: at a cost that does
        not depend on their number. ``weights`` (k, n + p) is the gradient of the function by the coordinates and speeds at each time, or a function of
        these, q (k, n) and u (k, p), that returns it; first axes are several functions. All else is as for :meth:`gradient`. A motion without these
        derivatives raises a :class:`SimulationError`, ``not_differentiable``."""
        names = (by,) if isinstance(by, str) else tuple(by)
        choices = self._choices(surfaces, tolerance, max_step, mu=mu, e=e, law=law, samples=samples)
        times = [float(value) for value in np.atleast_1d(numbers(at, "at"))]
        n = len(self._names_of("coordinates"))
        first: list[tuple[int, ...]] = []

        def asked(states: Floats) -> Floats:
            found = numbers(weights(states[:, :n], states[:, n:]) if callable(weights) else weights, "weights")
            if found.ndim < 2:
                found = np.broadcast_to(found, states.shape)
            first.append(found.shape[:-2])
            return np.ascontiguousarray(found.reshape(-1, *found.shape[-2:]), dtype=np.float64)

        found = self._adjoint((q, u, inputs, time), list(names), times, asked, choices)
        states = found["states"]
        return Adjoint(np.array(times), states[:, :n], states[:, n:], found["by"].reshape(*first[0], len(names)))

    def orbit(
        self, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[float] = None, *, period: Optional[float] = None,
        event: Optional[str] = None, contact: Optional[str] = None, count: int = 1, reset: Sequence[str] = (), longest: float = 10.0, segments: int = 1,
        exchange: Optional[Mapping[str, str]] = None, by: Sequence[str] = (), mu: Optional[float] = None, e: Optional[float] = None, law: Optional[str] = None, tolerance: Optional[float] = None,
        surfaces: Optional[Mapping[str, Mapping[str, Any]]] = None, max_step: Optional[float] = None,
    ) -> Orbit:
        """The periodic motion next to a state, as :class:`Orbit`. It returns after ``period`` s, or just after the ``count``-th ``event`` ('collision',
        'lift_off', 'slip', 'stick') at ``contact`` or any; coordinates of ``reset`` take their values of the start again then, after coordinates and speeds
        of ``exchange`` took the values of others (``{"q1": "q2", "q2": "q1"}`` of legs that change, "-q2" with the sign turned). ``longest``: s that are
        waited for it. ``segments``: parts of a period, in which the motion is sought at the same time, more of them where deviations grow much in it. ``by``: variables of :meth:`gradient` for derivatives of the return."""
        choices = self._choices(surfaces, tolerance, max_step, mu=mu, e=e, law=law)
        of = self._periodicity(period, event, contact, count, reset, exchange, longest, segments, by)
        return Orbit(self._orbit((q, u, inputs, time), of, choices)["orbit"], len(self._names_of("coordinates")))

    def branch(
        self, variable: str, start: float, end: float, q: Rows = None, u: Rows = None, inputs: Rows = None, time: Optional[float] = None, *,
        period: Optional[float] = None, event: Optional[str] = None, contact: Optional[str] = None, count: int = 1, reset: Sequence[str] = (),
        exchange: Optional[Mapping[str, str]] = None, longest: float = 10.0, segments: int = 1, points: int = 200, mu: Optional[float] = None, e: Optional[float] = None, law: Optional[str] = None,
        tolerance: Optional[float] = None, surfaces: Optional[Mapping[str, Mapping[str, Any]]] = None, max_step: Optional[float] = None,
    ) -> Branch:
        """Periodic motions through the values of a parameter, 'mu' or 'e' from ``start`` to ``end``, by at most ``points`` points, as :class:`Branch`; the
        other arguments are those of :meth:`orbit`."""
        choices = self._choices(surfaces, tolerance, max_step, mu=mu, e=e, law=law)
        of = self._periodicity(period, event, contact, count, reset, exchange, longest, segments, ())
        of.update(follow=(variable, number(start, "start"), number(end, "end")), points=points)
        found = self._orbit((q, u, inputs, time), of, choices)
        n = len(self._names_of("coordinates"))
        changes = [(kind, value, Orbit(orbit, n)) for kind, value, orbit in found["changes"]]
        orbits = [Orbit(orbit, n) for _, orbit in found["points"]]
        return Branch(np.array([value for value, _ in found["points"]]), orbits, changes, found["ended"])

    def _periodicity(self, period: Any, event: Any, contact: Any, count: int, reset: Any, exchange: Any, longest: Any, segments: int, by: Any) -> dict[str, Any]:
        return {
            "period": optional_number(period, "period"), "event": event, "count": count, "longest": number(longest, "longest"),
            "segments": segments, "by": list(by),
            "contact": None if contact is None else index("contact", contact, self._names_of("contacts")),
            "reset": [index("coordinate", name, self._names_of("coordinates")) for name in reset], "follow": None, "points": 1,
            "exchange": [f"{to}={source}" for to, source in (exchange or {}).items()],
        }  # fmt: skip

    def fit(
        self, variables: Sequence[str], motions: Any, *, outputs: Optional[Sequence[str]] = None, errors: Optional[Mapping[str, float]] = None,
        bootstrap: int = 0, seed: int = 0, mu: Optional[float] = None, e: Optional[float] = None, law: Optional[str] = None,
        tolerance: Optional[float] = None, surfaces: Optional[Mapping[str, Mapping[str, Any]]] = None, max_step: Optional[float] = None,
        huber: Optional[float] = None, cap: Optional[float] = None, flight: Optional[float] = None, horizons: Sequence[float] = (), starts: int = 1,
    ) -> Fit:
        """Fits parameters, 'mu' and 'e' (or 'mu.CONTACT') to measured motions, from the values of the model and the options, as :class:`Fit`.

        ``motions``: a table, or a list of tables: columns ``time`` (or ``t``), s, and coordinates and independent speeds by name. The first row of each is
        its start, taken as it is unless ``flight`` s are given, in which nothing is struck: then fitted to the samples within them; NaN in later rows is what was not measured. ``outputs``: the columns that are compared (else all); ``errors``: by what the
        differences of a column are divided, by name (else the standard deviation of the column); ``bootstrap``: so often motions are drawn anew.
        ``horizons``: s from the start, increasing, up to which the motions are fitted one after the other, before all of them; ``starts``: so many starts,
        the first that of the model and the options, others at random, a quarter to four times its values (``minima`` of the answer).
        ``huber``: differences beyond so many errors count in proportion to their size, not to its square; ``cap``: as if they were so large."""
        compared = self._compared(motions, outputs, errors)
        _check_seed(seed)
        fitted = {
            **compared, "variables": list(variables),
            "huber": optional_number(huber, "huber"), "cap": optional_number(cap, "cap"), "bootstrap": bootstrap, "seed": seed,
            "flight": optional_number(flight, "flight"), "horizons": [number(horizon, "horizons") for horizon in horizons], "starts": starts,
        }  # fmt: skip
        if huber is not None and cap is not None:
            raise ArgumentError("`huber` and `cap` exclude each other", kind="bad_option", place="cap")
        return Fit(self._fit(fitted, self._choices(surfaces, tolerance, max_step, mu=mu, e=e, law=law)), tuple(variables))

    def _compared(self, motions: Any, outputs: Optional[Sequence[str]], errors: Optional[Mapping[str, float]]) -> dict[str, Any]:
        """Measured motions, the columns that are compared, and by what their differences are divided."""
        names = [*self._names_of("coordinates"), *self._names_of("speeds")]
        start = [quantity.value for quantity in (*self.coordinates, *self.speeds)]
        all_motions = list(motions) if isinstance(motions, (list, tuple)) else [motions]
        given = [_measured(motion, names) for motion in all_motions]
        found = [name for name in names if all(name in columns for _, columns in given)]
        wanted = found if outputs is None else list(outputs)
        for name in wanted:
            index("column of all motions", name, found)
        if not wanted:
            raise ArgumentError("no column of all motions holds a coordinate or speed", kind="bad_option", place="motions")
        trajectories = []
        for place, (times, columns) in enumerate(given):
            state = [float(columns[name][0]) if name in columns else value for name, value in zip(names, start)]
            samples = np.column_stack([columns[name][1:] for name in wanted])
            trajectories.append((str(place), float(times[0]), state, [float(time) for time in times[1:]], samples))
        deviation = lambda name: float(np.nanstd(np.concatenate([columns[name][1:] for _, columns in given]))) or 1.0  # noqa: E731
        for name in errors or {}:
            index("column that is compared", name, wanted)
        units = [number((errors or {}).get(name, deviation(name)), name) for name in wanted]
        if min(units) <= 0:
            raise ArgumentError("`errors`: expected positive numbers", kind="bad_option", place="errors")
        return {"trajectories": trajectories, "measured": [names.index(name) for name in wanted], "units": units}

    def validate(
        self, values: Mapping[str, float], motions: Any, *, outputs: Optional[Sequence[str]] = None, errors: Optional[Mapping[str, float]] = None,
        noise: Optional[Mapping[str, float]] = None, floor: bool = False, seed: int = 1, mu: Optional[float] = None, e: Optional[float] = None,
        law: Optional[str] = None, tolerance: Optional[float] = None, surfaces: Optional[Mapping[str, Mapping[str, Any]]] = None,
        max_step: Optional[float] = None,
    ) -> Validation:
        """How well the mechanism predicts measured motions with ``values`` by name, those of a :class:`Fit` or of the JSON of ``hodograph fit``, as
        :class:`Validation`. ``motions``, ``outputs``, ``errors`` and the surface are those of :meth:`fit`.

        ``noise``: standard deviations of measurement by column: the error of replicas in which nothing but these differs; ``floor``: the error that
        is left where each motion has values of its own."""
        compared = self._compared(motions, outputs, errors)
        _check_seed(seed)
        names = [*self._names_of("coordinates"), *self._names_of("speeds")]
        wanted = [names[place] for place in compared["measured"]]
        for name in noise or {}:
            index("column that is compared", name, wanted)
        judged = {
            **compared, "variables": list(values), "values": [number(value, name) for name, value in values.items()], "floor": bool(floor), "seed": seed,
            "noise": None if noise is None else [number(noise.get(name, 0.0), name) for name in wanted],
        }  # fmt: skip
        found = self._validate(judged, self._choices(surfaces, tolerance, max_step, mu=mu, e=e, law=law))
        return Validation(found, wanted, [samples for *_, samples in compared["trajectories"]])

    def equations(self, format: str = "text") -> str:
        """The equations to read: 'text', 'latex' or 'html' (a page)."""
        return self._equations(format)

    def __repr__(self) -> str:
        count = lambda all, noun: f"{len(all)} {noun}{'' if len(all) == 1 else 's'}"
        sizes = [count(self.coordinates, "coordinate"), count(self.speeds, "speed"), count(self.contacts, "contact")]
        return f"<hodograph.{type(self).__name__} {self.name}: {', '.join(sizes)}>"

    def _repr_html_(self) -> str:
        page = html.escape(self.equations("html"), quote=True)
        return f'<iframe srcdoc="{page}" style="width:100%;height:28em;border:1px solid #ccc"></iframe>'


class NumericMechanism(Mechanism):
    """A mechanism of a model without derivation: all of :class:`Mechanism` but what only derived equations have (named quantities, derivatives, gradients,
    equations to read), evaluated numerically, at some hundred times the cost; numbers agree but for rounding."""

    __slots__ = ()

    def __new__(cls, model: Any, derivation: Optional[str] = None, parameters: Any = None) -> NumericMechanism:
        model = os.fspath(model) if isinstance(model, os.PathLike) else model
        made: NumericMechanism = super().__new__(cls, model, None, parameters, True)
        return made


def _restored(kind: type[Mechanism], text: str, derivation: Optional[str], parameters: Floats) -> Mechanism:
    """A mechanism that was pickled."""
    return kind._restored(text, derivation, parameters)


def restored(text: str, derivation: Optional[str], parameters: Floats) -> Mechanism:
    """A mechanism of the texts of model and derivation, and its parameters."""
    return _restored(Mechanism if derivation is not None else NumericMechanism, text, derivation, parameters)


def _samples(samples: Any) -> Any:
    """A period and the rows of a table of inputs."""
    if samples is None:
        return None
    period, values = samples
    table = numbers(values, "samples")
    return float(period), np.atleast_2d(table).tolist()


def _check_seed(seed: Any) -> None:
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**64:
        raise ArgumentError(f"`seed` is {seed!r}: expected a whole number from 0 to 2^64 - 1", kind="bad_option", place="seed")


def _measured(motion: Any, names: Sequence[str]) -> tuple[Floats, dict[str, Floats]]:
    """The times of a motion, and its columns of coordinates and speeds."""
    table = motion.columns() if isinstance(motion, Simulation) else motion
    there = tables.column_names(table)
    time = next((name for name in ("time", "t") if name in there and name not in names), None)
    if time is None:
        raise unknown("column of a motion", "time", there)
    return numbers(table[time], time), {name: numbers(table[name], name) for name in names if name in there}


def _primed(quantities: str) -> Callable[[Mechanism], list[str]]:
    return lambda mechanism: [f"{quantity.name}'" for quantity in getattr(mechanism, quantities)]


def _named(quantities: str) -> Callable[[Mechanism], list[str]]:
    return lambda mechanism: [quantity.name for quantity in getattr(mechanism, quantities)]


def _axes(mechanism: Mechanism) -> list[str]:
    return ["x", "y", "z"]


# the methods whose answers are rows of a table, and the names of the columns; of numbers the name of the method
_COLUMNS: dict[str, Any] = {
    "accelerations": _primed("speeds"),
    "coordinate_rates": _primed("coordinates"),
    "forcing": _named("speeds"),
    "compute_dependent_speeds": _named("dependent_speeds"),
    "kinetic_energy": None,
    "potential_energy": None,
    "gap": None,
    "position": _axes,
    "velocity": _axes,
    "acceleration": _axes,
    "collide": None,
}
