"""C code of a CasADi function by other generators, each from the same graph, by its own rules of simplification and its own search for what is common:
wrenfold and SymForce."""

import multiprocessing
import queue
import re

import casadi
import symengine
from symforce.internal import symbolic as symforce
from wrenfold import code_generation, sym, type_annotations

NAMES = {getattr(casadi, name): name.removeprefix("OP_") for name in dir(casadi) if name.startswith("OP_")}

STEPS = {
    "ADD": lambda a, b: a + b,
    "SUB": lambda a, b: a - b,
    "MUL": lambda a, b: a * b,
    "DIV": lambda a, b: a / b,
    "NEG": lambda a: -a,
    "SQ": lambda a: a * a,
    "TWICE": lambda a: 2 * a,
    "INV": lambda a: 1 / a,
    # what `vectors.reciprocal` writes
    "ERF": lambda a: 1 / a,
}

# What a generator may take for a routine, s: SymForce would take hours for the larger ones.
PATIENCE = 60

# The compiler may take the answer to lie apart from all arguments.
FRAME = """#include <math.h>
static void casadi_f0(const double** arg, double** res, int* iw, double* w, int mem) {{
const double *restrict a = arg[0], *restrict b = arg[1], *restrict c = arg[2], *restrict d = arg[3], *restrict e = arg[4];
double *restrict out = res[0];
{}
}}
"""


def follow(function, given, constant, system):
    """The answers of a function in the expressions of another system; `given` has a list of symbols for each argument."""
    known, answers = {}, [None] * function.numel_out(0)
    for place in range(function.n_instructions()):
        name = NAMES[function.instruction_id(place)]
        to, of = function.instruction_output(place), function.instruction_input(place)
        if name == "CONST":
            known[to[0]] = constant(function.instruction_constant(place))
        elif name == "INPUT":
            known[to[0]] = given[of[0]][of[1]]
        elif name == "OUTPUT":
            answers[to[1]] = known[of[0]]
        else:
            step = STEPS[name] if name in STEPS else getattr(system, name.lower())
            known[to[0]] = step(*(known[place] for place in of))
    return answers


def sizes(function):
    return [function.numel_in(place) for place in range(function.n_in())]


def by_wrenfold(function):
    """wrenfold's C++, in the words of C."""

    def constant(value):
        return sym.integer(int(value)) if value == int(value) else sym.float_constant(value)

    def routine(a, b, c, d, e):
        given = [[vector[place] for place in range(size)] for vector, size in zip((a, b, c, d, e), sizes(function))]
        answers = [constant(answer) if isinstance(answer, (int, float)) else answer for answer in follow(function, given, constant, sym)]
        return [code_generation.OutputArg(expression=sym.vector(*answers), name="out")]

    vectors = [type_annotations.Annotated[sym.MatrixExpr, type_annotations.Shape(rows=size, cols=1)] for size in sizes(function)]
    routine.__annotations__ = dict(zip("abcde", vectors))
    text = str(code_generation.generate_function(routine, code_generation.CppGenerator()))
    lines = [line.strip() for line in text.splitlines()]
    kept = [line for line in lines if line.startswith(("const Scalar", "_out("))]
    text = "\n".join(kept).replace("const Scalar", "const double").replace("static_cast<Scalar>", "").replace("std::", "")
    return FRAME.format(re.sub(r"\b_(\w+)\((\d+), 0\)", r"\1[\2]", text))


def by_symforce(function):
    """SymForce's expressions, shared by its own search."""

    def constant(value):
        return symforce.S(int(value)) if value == int(value) else symforce.S(value)

    given = [[symforce.Symbol(f"{name}{entry}_") for entry in range(size)] for name, size in zip("abcde", sizes(function))]
    answers = [symforce.S(answer) for answer in follow(function, given, constant, symforce)]
    shared, rest = symforce.cse(answers)
    lines = [f"const double {name} = {symengine.ccode(value)};" for name, value in shared]
    lines += [f"out[{place}] = {symengine.ccode(value)};" for place, value in enumerate(rest)]
    return FRAME.format(re.sub(r"\b([a-e])(\d+)_", r"\1[\2]", "\n".join(lines)))


GENERATORS = {"wrenfold": by_wrenfold, "symforce": by_symforce}


def written(generator, function):
    """The C code, or `None` where it takes too long."""
    answers = multiprocessing.Queue()
    # A process of its own can be ended at any time.
    work = multiprocessing.get_context("fork").Process(target=lambda: answers.put(GENERATORS[generator](function)))
    work.start()
    try:
        text = answers.get(timeout=PATIENCE)
    except queue.Empty:
        if not work.is_alive():
            raise RuntimeError(f"{generator} failed") from None
        text = None
    work.kill()
    work.join()
    return text
