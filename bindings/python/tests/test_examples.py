"""The examples run, and users' type checkers find nothing in them."""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).resolve().parents[1] / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_examples_run(example, tmp_path):
    done = subprocess.run([sys.executable, str(example), *([str(tmp_path / "motion.html")] if example.stem == "first_motion" else [])], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout, done.stderr
    assert example.stem != "first_motion" or "<html" in (tmp_path / "motion.html").read_text()


def test_mypy_is_content():
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--no-incremental", *map(str, EXAMPLES)], capture_output=True, text=True, cwd="/")
    assert done.returncode == 0, done.stdout + done.stderr
    # and they see the types
    reveal = "import hodograph\nreveal_type(hodograph.load('m').collide('c').speeds)\nhodograph.load('m').accelerations(u='text')\n"
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--no-incremental", "-c", reveal], capture_output=True, text=True, cwd="/")
    assert "float64" in done.stdout and "incompatible type" in done.stdout, done.stdout


def test_pyright_is_content():
    pytest.importorskip("basedpyright")
    done = subprocess.run([sys.executable, "-m", "basedpyright", "--level", "error", "--pythonpath", sys.executable, *map(str, EXAMPLES)], capture_output=True, text=True, cwd="/")
    assert done.returncode == 0, done.stdout + done.stderr
