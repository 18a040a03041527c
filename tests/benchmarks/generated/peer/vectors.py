"""Vectors and matrices of CasADi's scalars as lists, and how a routine becomes C code."""

import json
from pathlib import Path

import casadi
import numpy as np
from casadi import SX, vertcat
from others import GENERATORS, written


def clean(matrix):
    """Rounded where rounding is all that is there."""
    rounded = np.round(matrix)
    return np.where(np.abs(matrix - rounded) < 1e-12, rounded, matrix)


def vector(numbers):
    return [SX(float(x)) for x in numbers]


def add(*vectors):
    return [sum(parts[1:], parts[0]) for parts in zip(*vectors)]


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def times(factor, a):
    return [factor * x for x in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def apply(matrix, a):
    return [dot(row, a) for row in matrix]


def transposed(matrix):
    return [list(row) for row in zip(*matrix)]


def skew(a):
    zero = SX(0)
    return [[zero, -a[2], a[1]], [a[2], zero, -a[0]], [-a[1], a[0], zero]]


def product(a, b):
    columns = transposed(b)
    return [[dot(row, column) for column in columns] for row in a]


def reciprocal(x):
    """1 / x. CasADi makes a quotient of every product with a reciprocal, and so many divisions of one; `main` writes this function as what it is."""
    return 1 / x if x.is_constant() else casadi.erf(x)


def cholesky(m, x):
    """The solution of M y = x, by M = L^T D L."""
    n = len(x)
    h, x, inverse = [list(row) for row in m], list(x), [None] * n
    for k in reversed(range(n)):
        inverse[k] = reciprocal(h[k][k])
        for i in reversed(range(k)):
            part = h[k][i] * inverse[k]
            for j in range(i + 1):
                h[i][j] = h[i][j] - part * h[k][j]
            x[i] = x[i] - part * x[k]
            h[k][i] = part
    for k in range(n):
        x[k] = x[k] * inverse[k]
        for i in range(k):
            x[k] = x[k] - h[k][i] * x[i]
    return x


def symmetric(entry):
    """A symmetric matrix, each entry of it written once."""
    upper = {(i, j): entry(i, j) for i in range(3) for j in range(i, 3)}
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def dense(matrix):
    return [entry for row in zip(*matrix) for entry in row]


def lower(matrix):
    """One triangle of a symmetric matrix, row by row."""
    return [entry for row, entries in enumerate(matrix) for entry in entries[: row + 1]]


def write(folder, inputs, routines, angles):
    """Each routine as `<name>.c`, and `<name>_<generator>.c` for other generators of the same graph, with a function of
    the inputs (the second and third are sines and cosines); `routines.json` lists them.

    `angles` gives for a routine its angles, as C expressions of the coordinates `q`.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    listed = {}
    for name, routine in routines.items():
        result = casadi.cse(casadi.densify(vertcat(*routine())))
        function = casadi.Function(f"peer_{name}", inputs, [result])
        generator = casadi.CodeGenerator(f"{name}.c", {"casadi_int": "int"})
        generator.add(function)
        generator.generate(f"{folder}/")
        source = folder / f"{name}.c"
        source.write_text(source.read_text().replace("erf(", "1./("))
        used = {symbol.name() for symbol in casadi.symvar(result)}
        needed = [place for place in range(inputs[1].numel()) if not used.isdisjoint((names(inputs[1])[place], names(inputs[2])[place]))]
        listed[name] = {"length": result.numel(), "angles": [[place, angles(name)[place]] for place in needed]}
        for generator in GENERATORS:
            text, other = written(generator, function), f"{name}_{generator}"
            if text is not None:
                (folder / f"{other}.c").write_text(text)
                listed[other] = listed[name]
    (folder / "routines.json").write_text(json.dumps(listed))


def names(symbols):
    return [symbols[place].name() for place in range(symbols.numel())]
