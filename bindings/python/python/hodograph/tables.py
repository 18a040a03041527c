"""Tables in and out: dictionaries of columns, and those of pandas, polars, pyarrow and xarray."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .arguments import Floats, numbers, unknown
from .description import Quantity


def column_names(table: Any) -> list[str]:
    """The names of the columns of a table."""
    if _kind(table) == "xarray":
        return [str(name) for name in (*table.data_vars, *table.coords)]
    found = getattr(table, "column_names", None)
    if found is None:
        found = getattr(table, "columns", None)
    return [str(name) for name in (table.keys() if found is None or callable(found) else found)]


def states(groups: Mapping[str, Sequence[Quantity]], table: Any, only: frozenset[str] = frozenset()) -> dict[str, Floats]:
    """The arguments of many states; ``groups``: by argument, the quantities that may be columns. A table that has none of them may have columns of
    ``only`` instead."""
    names = set(column_names(table))
    column = lambda name: np.ravel(numbers(table[name], name))  # noqa: E731
    of_states = [quantity.name for group in groups.values() for quantity in group] + ["time"]
    found = [name for name in of_states if name in names]
    if not found and names and not only & names:
        raise unknown("column", sorted(names)[0], of_states)
    rows = len(column(found[0])) if found else len(column(next(iter(only & names)))) if only & names else 0
    answer: dict[str, Floats] = {}
    for argument, quantities in groups.items():
        if any(quantity.name in names for quantity in quantities):
            of = [column(q.name) if q.name in names else np.full(rows, q.value) for q in quantities]
            answer[argument] = np.column_stack(of)
    if "time" in names:
        answer["time"] = column("time")
    return answer


def like(table: Any, columns: dict[str, Any]) -> Any:
    """Columns as a table of the kind of another one."""
    kind = _kind(table)
    if kind == "pandas":
        return type(table)(columns, index=table.index)
    plain = {name: list(column) if column.dtype == object else column for name, column in columns.items()}
    if kind == "polars":
        return _eager(table)(plain)
    if kind == "pyarrow":
        return type(table).from_pydict(plain)
    if kind == "xarray":
        dimension = next(iter(table.sizes))
        found = type(table)({name: (dimension, column) for name, column in columns.items()})
        return found.assign_coords({name: table[name] for name in table.coords if table[name].dims == (dimension,)})
    return columns


def _kind(table: Any) -> str:
    return type(table).__module__.split(".")[0]


def _eager(table: Any) -> Any:
    import polars

    return polars.DataFrame
