"""Mechanisms."""

from __future__ import annotations

import html
from numbers import Real
from typing import NamedTuple, Optional

import numpy as np

from . import hodograph_native as _native
from .errors import ArgumentError, HodographError
from .results import Characteristics, Collision, Simulation, Simulations


class Quantity(NamedTuple):
    """A quantity of a model: its name, its unit ('1' without one) and its value or initial value."""

    name: str
    unit: str
    value: Optional[float]


class Derivatives(NamedTuple):
    """A value (p,) with its derivatives by independent coordinates, independent speeds and inputs, each (p, k)."""

    value: np.ndarray
    by_coordinates: np.ndarray
    by_speeds: np.ndarray
    by_inputs: np.ndarray


class Linearisation(NamedTuple):
    """x' = a x + b w for small deviations; x: independent coordinates, then independent speeds; w: inputs."""

    a: np.ndarray
    b: np.ndarray


class Contact(NamedTuple):
    """A contact in a state: unit vectors along N.x, N.y, N.z; the rest along normal, first, second (1/kg, m/s, m, m/s^2)."""

    normal: np.ndarray
    first: np.ndarray
    second: np.ndarray
    velocity: np.ndarray
    reduced: np.ndarray
    gap: Optional[np.ndarray]
    partial_velocities: np.ndarray
    response: np.ndarray


class Mechanism(_native.Mechanism):
    """A mechanism with its equations. See :func:`hodograph.load`; :meth:`with_parameters` gives one with other parameters.

    Every method takes ``q`` (n,), ``u`` (p,), ``inputs`` (w,), ``time`` (s), or many of them, (k, n) and so on; arrays of one state serve all others.
    States without an answer raise :class:`StateError`; with ``errors='nan'`` their answers are NaN.
    """

    __slots__ = ()

    parameters = property(lambda self: self._quantities("parameters"), doc="Parameters that can be changed.")
    coordinates = property(lambda self: self._quantities("coordinates"), doc="Coordinates, with initial values.")
    speeds = property(lambda self: self._quantities("speeds"), doc="Independent speeds, with initial values.")
    dependent_speeds = property(lambda self: self._quantities("dependent_speeds"), doc="Dependent speeds.")
    inputs = property(lambda self: self._quantities("inputs"), doc="Named inputs, with initial values.")
    points = property(lambda self: [name for name, *_ in self._describe("points")], doc="Names of points.")
    frames = property(lambda self: [name for name, *_ in self._describe("frames")], doc="Names of frames.")
    contacts = property(lambda self: [name for name, *_ in self._describe("contacts")], doc="Names of contacts.")

    quantities = property(
        lambda self: {name: unit for name, unit, _ in self._describe("quantities")}, doc="Names and units for :meth:`quantity`."
    )

    def _quantities(self, kind):
        return [Quantity(*entry) for entry in self._describe(kind)]

    def with_parameters(self, **parameters):
        """This mechanism with other values of some parameters, as :class:`Mechanism`. Arrays (k,) make k machines, one for every row of a state: the
        answers are those of k mechanisms, row by row. Rows that follow each other with equal parameters share the work that depends on these alone.
        """
        values = {quantity.name: quantity.value for quantity in self.parameters}
        for name, value in parameters.items():
            if name not in values:
                raise _unknown("parameter", name, values)
            value = _numbers(value, name)
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
        return Mechanism(self, None, matrix)

    def states(self, table):
        """The arguments ``q``, ``u``, ``inputs`` and ``time`` of many states from a table of columns with the names of the model: a pandas
        DataFrame, a pyarrow Table, or a dictionary. What has no column is what the model states. ``m.accelerations(**m.states(table))``.
        """
        names = list(getattr(table, "column_names", None) or table.keys())
        column = lambda name: _numbers(table[name], name)
        known = {q.name for q in [*self.coordinates, *self.speeds, *self.inputs]} | {"time"}
        for name in names:
            if name not in known:
                raise _unknown("column", str(name), known)
        rows = len(column(names[0])) if names else 0
        states = {}
        for argument, quantities in (("q", self.coordinates), ("u", self.speeds), ("inputs", self.inputs)):
            if any(quantity.name in names for quantity in quantities):
                of = [column(q.name) if q.name in names else np.full(rows, q.value) for q in quantities]
                states[argument] = np.column_stack(of)
        if "time" in names:
            states["time"] = column("time")
        return states

    def tabulate(self, quantity, table, *names, **options):
        """A quantity of all states of a table, as a table of the same kind (pandas DataFrame with the same index, pyarrow Table, or dictionary) by
        column names: ``m.tabulate("accelerations", frame)``, ``m.tabulate("position", frame, "P")``,
        ``m.tabulate("collide", frame, "tip", mu=0.3, e=0.5, law="poisson")``. ``quantity`` is the name of a method that gives a number, a vector
        or a collision for a state; what else it needs follows. Columns with the names of parameters make one machine for every row. Rates have the name of their coordinate or speed and a prime, vectors x, y, z.
        """
        if quantity not in _COLUMNS:
            raise _unknown("quantity for a table", str(quantity), _COLUMNS)
        names_of = getattr(table, "column_names", None) or table.keys()
        variable = {quantity.name for quantity in self.parameters}
        machines = {name: _numbers(table[name], name) for name in names_of if name in variable}
        states = self.states({name: table[name] for name in names_of if name not in variable})
        mechanism = self.with_parameters(**machines) if machines else self
        found = getattr(mechanism, quantity)(*names, **states, **options)
        if quantity == "collide":
            columns = {q.name: column for q, column in zip(self.speeds, found.speeds.T)}
            for name, axes in (("impulse", "nts"), ("velocity", "nts"), ("impulse_on_point", "xyz")):
                columns.update({f"{name}_{axis}": column for axis, column in zip(axes, getattr(found, name).T)})
            for name in ("energy_change", "contact_work", "normal_work", "path", "kind"):
                columns[name] = getattr(found, name)
        elif found.ndim == 1:
            columns = {quantity: found}
        else:
            columns = dict(zip(_COLUMNS[quantity](self), found.T))
        return _like(table, columns)

    def accelerations(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Rates u' of the independent speeds, (p,) or (k, p)."""
        return self._evaluate("accelerations", q, u, inputs, time, errors)

    def mass_matrix(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """M, (p, p) or (k, p, p)."""
        return self._evaluate("mass_matrix", q, u, inputs, time, errors)

    def forcing(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Forcing, (p,) or (k, p): M u' = forcing."""
        return self._evaluate("forcing", q, u, inputs, time, errors)

    def inverse_dynamics(self, accelerations, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Generalised forces, (p,) or (k, p), that must be added to the loads for these u': M u' - forcing."""
        return self._evaluate("inverse_dynamics", q, u, inputs, time, errors, accelerations)

    def coordinate_rates(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """q', (n,) or (k, n)."""
        return self._evaluate("coordinate_rates", q, u, inputs, time, errors)

    def compute_dependent_speeds(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Dependent speeds, (d,) or (k, d)."""
        return self._evaluate("dependent_speeds", q, u, inputs, time, errors)

    def kinetic_energy(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Kinetic energy, J."""
        return self._evaluate("kinetic_energy", q, u, inputs, time, errors)

    def potential_energy(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Potential energy of gravity and springs, J."""
        return self._evaluate("potential_energy", q, u, inputs, time, errors)

    def quantity(self, name, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """A quantity of the whole mechanism by its name, one of :attr:`quantities`, along N.x, N.y, N.z: ``momentum``, ``angular_momentum`` (about O),
        ``central_angular_momentum`` (about the mass centre), ``mass_centre_position``, ``mass_centre_velocity``; (3,) or (k, 3)."""
        known = self.quantities
        if name not in known:
            raise _unknown("quantity", str(name), known)
        return self._evaluate(name, q, u, inputs, time, errors)

    def position(self, point, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Position of a point from O along N.x, N.y, N.z, m, (3,) or (k, 3)."""
        return self._of_point(point, "position", q, u, inputs, time, errors)

    def velocity(self, point, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Velocity of a point along N.x, N.y, N.z, m/s, (3,) or (k, 3)."""
        return self._of_point(point, "velocity", q, u, inputs, time, errors)

    def jacobian(self, point, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Partial velocities of a point, (3, p) or (k, 3, p)."""
        return self._of_point(point, "jacobian", q, u, inputs, time, errors)

    def _of_point(self, point, what, q, u, inputs, time, errors):
        index = _index("point", point, self.points)
        if index == 0:
            raise ArgumentError(f"{point} is the origin: it has no {what}", kind="unknown_name", place="point")
        return self._evaluate(f"point {index} {what}", q, u, inputs, time, errors)

    def accelerations_derivatives(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Accelerations and their derivatives, as :class:`Derivatives`."""
        return self._split(self._evaluate("accelerations_derivatives", q, u, inputs, time, errors))

    def inverse_dynamics_derivatives(self, accelerations, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Inverse dynamics and its derivatives, as :class:`Derivatives`."""
        return self._split(self._evaluate("inverse_dynamics_derivatives", q, u, inputs, time, errors, accelerations))

    def _split(self, matrix):
        p, w = matrix.shape[-2], len(self.inputs)
        first = matrix.shape[-1] - p - w
        return Derivatives(
            matrix[..., 0], matrix[..., 1:first], matrix[..., first : first + p], matrix[..., first + p :]
        )

    def linearise(self, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """The equations linearised about states, as :class:`Linearisation`."""
        rates = self._evaluate("rates_derivatives", q, u, inputs, time, errors)
        rows = self._evaluate("accelerations_derivatives", q, u, inputs, time, errors)
        both = np.concatenate([rates, rows[..., 1:]], axis=-2)
        states = both.shape[-2]
        return Linearisation(both[..., :states], both[..., states:])

    def contact(self, contact, q=None, u=None, inputs=None, time=None, *, errors="raise"):
        """Basis, velocity, reduced matrix (nn, n1, n2, 11, 12, 22), gap and matrices V (3, p), M^-1 V^T (p, 3) of a contact, as :class:`Contact`."""
        index = _index("contact", contact, self.contacts)
        of = lambda what: self._evaluate(f"contact {index} {what}", q, u, inputs, time, errors)
        basis = [of(what) for what in ("normal", "first", "second", "velocity", "reduced")]
        try:
            gap = of("gap")
        except HodographError as error:
            if error.kind != "undefined":
                raise
            gap = None
        return Contact(*basis, gap, of("partial_velocities"), of("response"))

    def surface(self, contact):
        """Friction and restitution that the model states for a contact (its name), as {"mu": .., "e": .., "law": ..}; None where it states none."""
        return self._surface(_index("contact", contact, self.contacts))

    def _of_contact(self, contact, mu, e, law):
        """What is given of a surface, and for what is not, what the model states."""
        given = {"mu": mu, "e": e, "law": law}
        missing = [name for name, value in given.items() if value is None]
        if missing:
            stated = self.surface(contact)
            if stated is None:
                raise ArgumentError(
                    f"{contact} has no {missing[0]}: give mu, e and law, or state its `surface` in the model",
                    kind="bad_option", place=missing[0],
                )  # fmt: skip
            given.update((name, stated[name]) for name in missing)
        return given["mu"], given["e"], given["law"]

    def collide(self, contact, q=None, u=None, inputs=None, time=None, *, mu=None, e=None, law=None, errors="raise"):
        """Collisions of a contact (its name), as :class:`Collision`. ``mu``, ``e``: numbers or (k,); ``law``: 'newton', 'poisson', 'stronge'; what is
        not given is that of the model."""
        index = _index("contact", contact, self.contacts)
        mu, e, law = self._of_contact(contact, mu, e, law)
        return Collision(self._collide(index, (q, u, inputs, time), mu, e, law, errors))

    def characteristics(self, contact, q=None, u=None, inputs=None, time=None, *, mu=None, e=None, law=None, errors="raise"):
        """Characteristic quantities of the collisions of :meth:`collide`, along its n, t, s, as :class:`Characteristics`."""
        mu, e, law = self._of_contact(contact, mu, e, law)
        hit = self.collide(contact, q, u, inputs, time, mu=mu, e=e, law=law, errors=errors)
        found = Characteristics(_native.characteristics(hit.reduced, hit.approach, mu, e, law, errors))
        # A state without a collision has the reason of the collision.
        found.kind = hit.kind
        return found

    def simulate(
        self, until, step=None, q=None, u=None, inputs=None, time=None, *, mu=None, e=None, law=None, tolerance=None,
        surfaces=None, control=None, period=None, max_step=None, mu_static=None, mu_impact=None, sliding=None, restitution=None,
        rolling=None, spinning=None,
    ):
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
        """
        number = lambda value, name: None if value is None else float(_number(value, name))
        if period is not None and control is None:
            raise ArgumentError("`period` is that of `control`, which is missing", kind="bad_option", place="period")
        choices = {
            **self._surfaces(surfaces, mu=mu, e=e, law=law, mu_static=mu_static, mu_impact=mu_impact, sliding=sliding, restitution=restitution,
                rolling=rolling, spinning=spinning),
            "tolerance": number(tolerance, "tolerance"), "max_step": number(max_step, "max_step"), "control": control, "period": number(period, "period"),
        }  # fmt: skip
        names = [quantity.name for quantity in self.coordinates], [quantity.name for quantity in self.speeds]
        try:
            return Simulation(self._simulate((q, u, inputs, time), float(_number(until, "until")), number(step, "step"), choices), *names)
        except BaseException as error:
            made = error.__dict__.pop("_motion", None)
            if made is not None:
                error.motion = Simulation(made, *names)
            raise

    def _surfaces(self, own, **all):
        """What is given of the surfaces of all contacts, and of those that have one of their own."""
        number = lambda given, name: None if given.get(name) is None else float(_number(given[name], name))
        of = lambda given: (number(given, "mu"), number(given, "e"), given.get("law"))
        law = lambda given: (
            number(given, "mu_static"), number(given, "mu_impact"), given.get("sliding"), given.get("restitution"), number(given, "rolling"),
            number(given, "spinning"),
        )  # fmt: skip
        known = ("mu", "e", "law", "mu_static", "mu_impact", "sliding", "restitution", "rolling", "spinning")
        for contact, given in (own or {}).items():
            for name in given:
                if name not in known:
                    raise _unknown(f"property of the surface of {contact}", str(name), known)
        own = [(_index("contact", contact, self.contacts), given) for contact, given in (own or {}).items()]
        return {
            "surface": of(all), "law": law(all), "surfaces": [(contact, of(given)) for contact, given in own],
            "laws": [(contact, law(given)) for contact, given in own],
        }  # fmt: skip

    def simulate_many(
        self, until, q=None, u=None, inputs=None, time=None, *, mu=None, e=None, law=None, mu_static=None, mu_impact=None, sliding=None,
        restitution=None, rolling=None, spinning=None, tolerance=None, surfaces=None, max_step=None, threads=None, progress=None,
    ):
        """Many motions to the time ``until``, one for each row of ``q`` (k, n), ``u``, ``inputs``, ``time`` (k,), of the parameters of a mechanism of
        :meth:`with_parameters`, and of ``mu``, ``e``, ``mu_static``, ``mu_impact``, ``rolling`` and ``spinning`` (numbers or (k,)), as
        :class:`Simulations`.

        Rows share the cores (``threads``: so many); outcomes have the same bits in any order and on any number of threads. What is wrong with a row is
        the outcome of that row. ``progress``: a function of the rows that are done and of all rows, called now and then; what it raises ends the batch, as
        Ctrl-C does. All else is as for :meth:`simulate`.
        """
        number = lambda value, name: None if value is None else float(_number(value, name))
        choices = {
            **self._surfaces(surfaces, law=law, sliding=sliding, restitution=restitution),
            "tolerance": number(tolerance, "tolerance"), "max_step": number(max_step, "max_step"), "control": None, "period": None,
        }  # fmt: skip
        if threads is not None and (isinstance(threads, bool) or not isinstance(threads, int) or threads < 1):
            raise ArgumentError(f"`threads` is {threads!r}: expected a whole number, at least 1", kind="bad_option", place="threads")
        columns = (mu, e, mu_static, mu_impact, rolling, spinning)
        found = self._simulate_many((q, u, inputs, time), float(_number(until, "until")), columns, choices, threads, progress)
        names = [quantity.name for quantity in self.coordinates], [quantity.name for quantity in self.speeds]
        return Simulations(found, *names)

    def equations(self, format="text"):
        """The equations to read: 'text', 'latex' or 'html' (a page)."""
        return self._equations(format)

    def __repr__(self):
        count = lambda all, noun: f"{len(all)} {noun}{'' if len(all) == 1 else 's'}"
        sizes = [count(self.coordinates, "coordinate"), count(self.speeds, "speed"), count(self.contacts, "contact")]
        return f"<hodograph.Mechanism {self.name}: {', '.join(sizes)}>"

    def _repr_html_(self):
        page = html.escape(self.equations("html"), quote=True)
        return f'<iframe srcdoc="{page}" style="width:100%;height:28em;border:1px solid #ccc"></iframe>'


class NumericMechanism:
    """A model without derivation, evaluated numerically: one state at a time, and fewer methods than :class:`Mechanism`."""

    def __init__(self, model):
        self._model = model

    def _of(self, what, q, u, inputs, time):
        lists = [[float(number) for number in np.asarray(given).ravel()] for given in (q, u, inputs)]
        return np.array(_native.numeric(self._model, *lists, float(time))[what])

    def mass_matrix(self, q, u, inputs=(), time=0.0):
        """M, (p, p)."""
        return self._of("mass_matrix", q, u, inputs, time)

    def forcing(self, q, u, inputs=(), time=0.0):
        """Forcing, (p,): M u' = forcing."""
        return self._of("forcing", q, u, inputs, time)

    def accelerations(self, q, u, inputs=(), time=0.0):
        """Rates u' of the independent speeds, (p,)."""
        return np.linalg.solve(self.mass_matrix(q, u, inputs, time), self.forcing(q, u, inputs, time))

    def coordinate_rates(self, q, u, inputs=(), time=0.0):
        """q', (n,)."""
        return self._of("coordinate_rates", q, u, inputs, time)

    def kinetic_energy(self, q, u, inputs=(), time=0.0):
        """Kinetic energy, J."""
        return float(self._of("kinetic_energy", q, u, inputs, time))


def _numbers(value, name):
    """An array of doubles of numbers: strings are none, and entries that a mask hides have none."""
    if np.ma.is_masked(value):
        raise ArgumentError(
            f"`{name}` has masked entries: fill them (`.filled(value)`), or leave their rows out", kind="masked", place=name
        )
    found = np.asarray(value)
    real = found.dtype.kind in "fiu" or (
        found.dtype.kind == "O" and all(isinstance(entry, Real) and not isinstance(entry, bool) for entry in found.flat)
    )
    if not real:
        raise ArgumentError(
            f"`{name}` has the dtype {found.dtype}: expected numbers", kind="wrong_dtype", place=name
        )
    return found.astype(np.float64)


def _number(value, name):
    """One number."""
    found = _numbers(value, name)
    if found.ndim:
        raise ArgumentError(f"`{name}` has the shape {found.shape}: expected a number", kind="wrong_shape", place=name)
    return found


def _primed(quantities):
    return lambda mechanism: [f"{quantity.name}'" for quantity in getattr(mechanism, quantities)]


def _named(quantities):
    return lambda mechanism: [quantity.name for quantity in getattr(mechanism, quantities)]


_AXES = lambda mechanism: "xyz"
_NUMBER = None
# the methods whose answers are rows of a table, and the names of the columns
_COLUMNS = {
    "accelerations": _primed("speeds"),
    "coordinate_rates": _primed("coordinates"),
    "forcing": _named("speeds"),
    "compute_dependent_speeds": _named("dependent_speeds"),
    "kinetic_energy": _NUMBER,
    "potential_energy": _NUMBER,
    "position": _AXES,
    "velocity": _AXES,
    "collide": None,
}


def _like(table, columns):
    """Columns as a table of the kind of another one."""
    kind = type(table).__module__.split(".")[0]
    if kind == "pandas":
        return type(table)(columns, index=table.index)
    if kind == "pyarrow":
        return type(table).from_pydict({name: list(c) if c.dtype == object else c for name, c in columns.items()})
    return columns


def _unknown(kind, name, known):
    import difflib

    near = difflib.get_close_matches(name, list(known), 1)
    hint = f" (did you mean {near[0]}?):" if near else ":"
    return ArgumentError(
        f"there is no {kind} {name!r}{hint} expected one of: {', '.join(sorted(known))}", kind="unknown_name", place=name
    )


def _index(kind, name, names):
    if name in names:
        return names.index(name)
    raise _unknown(kind, str(name), names)
