"""Motions: their samples, events, forces and energies; pages, recordings and files of them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import hodograph_native as _native
from .arguments import Floats
from .errors import ArgumentError, HodographError
from .figures import plot

_PHASES = np.array(["open", "stick", "slide"], dtype=object)
#: What a file of a motion is marked with.
_MARK = b"hodograph motion"
_FORMAT = 1


class Event(NamedTuple):
    """An event of a motion: its time, s; its ``kind`` ('collision', 'impact_without_collision', 'struck_together', 'contact', 'lift_off', 'slip', 'stick',
    'roll', 'roll_ends', 'spin', 'spin_ends', 'rest', 'singular', or the name of an own event); the name of the contact, or None; the state after it,
    ``q`` (n,), ``u`` (p,). Of impacts, otherwise None: ``impulse_on_point`` (3,) along N.x, N.y, N.z, N s; ``energy_change``, J; ``speeds_before`` (p,).
    Of contact that begins its ``mode``; of slip and rolling the ``direction`` (2,) along the tangential axes, and ``along`` (3,), the same along
    N.x, N.y, N.z; of events that choose modes the
    ``selection`` ('unique', 'several_modes', ..); of contacts that strike together the ``shares``: dictionaries with contact, impulse, .."""

    time: float
    kind: str
    contact: Optional[str]
    q: Floats
    u: Floats
    impulse_on_point: Optional[Floats]
    energy_change: Optional[float]
    speeds_before: Optional[Floats] = None
    mode: Optional[str] = None
    direction: Optional[Floats] = None
    along: Optional[Floats] = None
    selection: Optional[str] = None
    shares: tuple[dict[str, Any], ...] = ()


class Simulation:
    """A motion: ``time`` (k,), ``q`` (k, n), ``u`` (k, p), ``inputs`` (k, w); ``events``: a list of :class:`Event`; ``forces`` (k, contacts, 3) along n, t, s of
    each contact, N, zero where it is open; ``phases`` (k, contacts): 'open', 'stick', 'slide'; ``account``: the energies and the works of friction, impacts
    and inputs since the start at the end of the last step, J; ``mechanism``: the :class:`hodograph.Mechanism` that moves. ``columns()`` gives all by name, for a table."""

    time: Floats
    q: Floats
    u: Floats
    inputs: Floats
    forces: Floats
    account: dict[str, Optional[float]]
    events: list[Event]
    mechanism: Any

    def __init__(self, found: dict[str, Any], mechanism: Any) -> None:
        self.time, self.q, self.u, self.inputs = (found[name] for name in ("time", "q", "u", "inputs"))
        self.forces, self.account = found["forces"], found["account"]
        self._codes, self._record = found["phases"], found["record"]
        self.mechanism = mechanism
        self.coordinates = [quantity.name for quantity in mechanism.coordinates]
        self.speeds = [quantity.name for quantity in mechanism.speeds]
        self.events = [
            Event(*first, *then[:-1], tuple(then[-1])) for first, then in self._record.events()
        ]

    @property
    def phases(self) -> NDArray[np.object_]:
        words: NDArray[np.object_] = _PHASES[self._codes]
        return words

    def gaps(self) -> dict[str, Floats]:
        """The gaps of the contacts that have one, (k,) each, m."""
        found = {}
        for contact in self.mechanism.contacts:
            gap = self.mechanism.gap(contact, self.q, self.u, self.inputs, self.time, errors="nan")
            if gap is not None:
                found[contact] = gap
        return found

    def energies(self) -> dict[str, Floats]:
        """``kinetic``, and where the model has one ``potential`` energy and the ``total`` of both, (k,) each, J."""
        states = dict(q=self.q, u=self.u, inputs=self.inputs, time=self.time, errors="nan")
        found = {"kinetic": self.mechanism.kinetic_energy(**states)}
        try:
            found["potential"] = self.mechanism.potential_energy(**states)
        except HodographError as error:
            if error.kind != "undefined":
                raise
            return found
        found["total"] = found["kinetic"] + found["potential"]
        return found

    def columns(self) -> dict[str, Floats]:
        """Time, coordinates and speeds by name, each (k,): ``pandas.DataFrame(motion.columns())``."""
        names = ["time", *self.coordinates, *self.speeds]
        return dict(zip(names, [self.time, *self.q.T, *self.u.T]))

    def dataset(self) -> Any:
        """The motion as an ``xarray.Dataset`` over ``time``: coordinates, speeds and inputs by name, ``forces`` by contact and axis, ``phases``."""
        import xarray

        variables: dict[str, Any] = {name: ("time", column) for name, column in self.columns().items() if name != "time"}
        names = [quantity.name for quantity in self.mechanism.inputs]
        variables.update({name: ("time", column) for name, column in zip(names, self.inputs.T)})
        variables["forces"] = (("time", "contact", "axis"), self.forces)
        variables["phases"] = (("time", "contact"), self.phases.astype(str))
        coordinates = {"time": self.time, "contact": self.mechanism.contacts, "axis": ["n", "t", "s"]}
        return xarray.Dataset(variables, coordinates, {"mechanism": self.mechanism.name})

    def html(self, path: Union[str, os.PathLike[str], None] = None) -> str:
        """A page on which the mechanism moves, as text; written to ``path`` where one is given. It loads nothing from elsewhere."""
        page: str = self._shown("html")
        if path is not None:
            _write(path, page.encode())
        return page

    def mcap(self, path: Union[str, os.PathLike[str], None] = None) -> bytes:
        """A recording for viewers of robots (Foxglove, Rerun), as bytes; written to ``path`` where one is given."""
        recording: bytes = self._shown("mcap")
        if path is not None:
            _write(path, recording)
        return recording

    def figure(self, path: Union[str, os.PathLike[str], None] = None) -> str:
        """Coordinates, speeds, energies, gaps and normal forces over time as SVG pictures in one page, as text; written to ``path`` where one is given."""
        time, curves = self._shown("curves")
        panels: dict[tuple[str, str], list[Any]] = {}
        for panel, name, unit, values in curves:
            panels.setdefault((panel, unit), []).append((time, values, name))
        text = "".join(plot(lines, "time, s", panel if unit in ("", "1") else f"{panel}, {unit}") for (panel, unit), lines in panels.items())
        if path is not None:
            _write(path, f"<!DOCTYPE html>\n<meta charset=utf-8>\n<title>{self.mechanism.name}</title>\n{text}\n".encode())
        return text

    def _shown(self, what: str) -> Any:
        arrays = (self.time, self.q, self.u, self.inputs, self.forces)
        return self.mechanism._shown(what, self._record, tuple(np.ascontiguousarray(array) for array in arrays))

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the motion to a Parquet file, with its mechanism: :func:`hodograph.load_motion` reads it. Needs pyarrow. Other programs see columns by
        name: time, coordinates, speeds, inputs, ``force.CONTACT.n``, ``.t``, ``.s``, ``phase.CONTACT``."""
        import pyarrow
        import pyarrow.parquet

        columns: dict[str, Any] = dict(self.columns())
        columns.update(zip((quantity.name for quantity in self.mechanism.inputs), self.inputs.T))
        for place, contact in enumerate(self.mechanism.contacts):
            for axis, name in enumerate("nts"):
                columns[f"force.{contact}.{name}"] = self.forces[:, place, axis]
            columns[f"phase.{contact}"] = self._codes[:, place]
        text, derivation, parameters = self.mechanism._state()
        kept = {
            "format": _FORMAT, "version": _native.__version__, "model": text, "derivation": derivation,
            "parameters": parameters.tolist(), "account": self.account, "events": self._record.text(),
        }  # fmt: skip
        table = pyarrow.table({name: np.ascontiguousarray(column) for name, column in columns.items()})
        table = table.replace_schema_metadata({_MARK: json.dumps(kept)})
        partial = f"{os.fspath(path)}.partial"
        try:
            pyarrow.parquet.write_table(table, partial)
            os.replace(partial, path)
        finally:
            if os.path.exists(partial):
                os.remove(partial)

    def __getstate__(self) -> dict[str, Any]:
        state = dict(self.__dict__)
        state["_record"] = self._record.text()
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._record = _native.Record.from_text(state["_record"])

    def __repr__(self) -> str:
        return f"<hodograph.Simulation to {self.time[-1]} s: {len(self.time)} states, {len(self.events)} events>"

    def _repr_html_(self) -> str:
        return "".join(
            plot([(self.time, column, name) for column, name in zip(matrix.T, names)], "time, s", axis)
            for matrix, names, axis in ((self.q, self.coordinates, "coordinates"), (self.u, self.speeds, "speeds"))
        )


class SimulationError(HodographError, ArithmeticError):
    """A motion cannot be followed; ``number`` is the time, s. ``motion``: the :class:`Simulation` up to there, None where it never began."""

    motion: Optional[Simulation] = None


def read_motion(path: Union[str, os.PathLike[str]], restored: Callable[[str, Optional[str], Floats], Any]) -> Simulation:
    """The motion of a file that :meth:`Simulation.save` wrote; ``restored`` makes its mechanism of the texts of model and derivation, and parameters."""
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path)
    kept = (table.schema.metadata or {}).get(_MARK)
    if kept is None:
        raise ArgumentError(f"{os.fspath(path)} holds no motion: expected a file of `Simulation.save`", kind="bad_file", place="path")
    kept = json.loads(kept)
    if kept["format"] != _FORMAT:
        raise ArgumentError(
            f"{os.fspath(path)} has format {kept['format']}, written by version {kept['version']}: expected {_FORMAT}", kind="bad_file", place="path"
        )
    mechanism = restored(kept["model"], kept["derivation"], np.array(kept["parameters"], dtype=float))
    column = lambda name: table[name].to_numpy()  # noqa: E731
    rows = len(table)
    of = lambda quantities: np.column_stack([column(q.name) for q in quantities]) if quantities else np.zeros((rows, 0))  # noqa: E731
    contacts = mechanism.contacts
    forces = [[column(f"force.{contact}.{axis}") for axis in "nts"] for contact in contacts]
    phases = [column(f"phase.{contact}") for contact in contacts]
    found = {
        "time": column("time"), "q": of(mechanism.coordinates), "u": of(mechanism.speeds), "inputs": of(mechanism.inputs),
        "forces": np.moveaxis(np.array(forces), -1, 0) if contacts else np.zeros((rows, 0, 3)),
        "phases": np.column_stack(phases) if contacts else np.zeros((rows, 0), dtype=np.uint8),
        "account": kept["account"], "record": _native.Record.from_text(kept["events"]),
    }  # fmt: skip
    return Simulation(found, mechanism)


def _write(path: Union[str, os.PathLike[str]], data: bytes) -> None:
    """Writes a file whole, or not at all."""
    partial = f"{os.fspath(path)}.partial"
    try:
        with open(partial, "wb") as file:
            file.write(data)
        os.replace(partial, path)
    finally:
        if os.path.exists(partial):
            os.remove(partial)


class Simulations:
    """The outcomes of many motions, by rows: ``kind``: 'rest', 'stopped', 'moving', or why a motion ended early, which ``message`` tells; ``time``: when it
    ended; ``rest``: since when nothing moves (NaN where something does); ``q`` (k, n) and ``u`` (k, p) then; ``closed``: the names of the contacts that are
    closed then; ``kinetic``, ``potential`` energy and the works ``friction``, ``impacts``, ``input_work``, J; numbers of ``collisions`` and ``events``;
    ``several_modes``: whether an event said that other modes fit; ``digest``: a number made of all bits."""

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

    def __init__(self, found: dict[str, Any], coordinates: list[str], speeds: list[str]) -> None:
        for name, value in found.items():
            setattr(self, name, value)
        self.closed = [tuple(names) for names in self.closed]
        self.coordinates, self.speeds = coordinates, speeds

    def __len__(self) -> int:
        return len(self.kind)

    def columns(self) -> dict[str, Any]:
        """All by name, each (k,): ``pandas.DataFrame(motions.columns())``, ``pyarrow.table(motions.columns())``.

        Coordinates and speeds at the end have their names in the model; one that is called like a column of the outcome,
        such as ``time``, is ``end_time``.
        """
        names = ("kind", "time", "rest", "kinetic", "potential", "friction", "impacts", "input_work", "collisions", "events", "several_modes", "message")
        columns = {name: getattr(self, name) for name in names}
        columns["closed"] = ["+".join(names) for names in self.closed]
        for name, column in zip(self.coordinates + self.speeds, [*self.q.T, *self.u.T]):
            columns[f"end_{name}" if name in columns else name] = column
        return columns

    def __repr__(self) -> str:
        counts = {kind: self.kind.count(kind) for kind in dict.fromkeys(self.kind)}
        return f"<hodograph.Simulations: {', '.join(f'{count} {kind}' for kind, count in counts.items())}>"
