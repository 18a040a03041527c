"""No files of the package import each other in a circle: neither in Python, for types or late, nor in Rust."""

import ast
import re
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1]


def python_imports(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.level == 1 or node.module == "hodograph"):
            yield from ([node.module] if node.level == 1 and node.module else [alias.name for alias in node.names])


def rust_imports(path):
    for names in re.findall(r"\buse (?:crate|super)::(\{[^}]*\}|\w+)", path.read_text()):
        yield from re.findall(r"(?:^|[{,]\s*)(\w+)", names)


@pytest.mark.parametrize(
    "files, imports",
    [(FOLDER / "python/hodograph", python_imports), (FOLDER / "src", rust_imports)],
    ids=["python", "rust"],
)
def test_imports_have_no_circle(files, imports):
    paths = {path.stem: path for path in files.iterdir() if path.suffix in (".py", ".rs")}
    graph = {name: {used for used in imports(path) if used in paths} for name, path in paths.items()}
    order = list(TopologicalSorter(graph).static_order())
    assert sorted(order) == sorted(paths) and sum(map(len, graph.values())) > 15
