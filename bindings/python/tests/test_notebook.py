"""The notebooks run, and their numbers are those of the paper's example and what their texts say."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]


def run(name, monkeypatch):
    """The names that the cells of a notebook leave."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    monkeypatch.chdir(ROOT)
    notebook = json.loads((ROOT / f"bindings/python/notebooks/{name}.ipynb").read_text())
    names = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
    return names


def test_a_whole_session(monkeypatch):
    names = run("session", monkeypatch)
    plt, total = names["plt"], names["total"]
    assert len(plt.get_fignums()) == 2
    plt.close("all")
    # energy falls, at impacts alone
    assert names["motion"].events and (np.diff(total) < 1e-9).all() and total[-1] < total[0] - 1e-3
    assert set(names["many"].kind) == {"moving"} and (names["many"].impacts[:40] < 0).all()
    assert names["by"].shape == (4, 3) and np.isfinite(names["by"]).all()
    # the found start is the one of which the state was taken, where there is one alone
    assert abs(names["misses"][-1]) < 1e-12 < 1e-3 < abs(names["misses"][0])


def test_the_notebook_runs(monkeypatch):
    names = run("two_sleds", monkeypatch)
    plt = names["plt"]
    # Stronge's hypothesis at mu = 0.6, as the documentation of the crate hodograph-models has it
    assert names["outcomes"][0.6, "stronge"].velocity[0] == pytest.approx(0.51153, abs=1e-5)
    # the gain under Newton's hypothesis that docs/assumptions.md tells of
    assert names["outcomes"][1.6, "newton"].energy_change == pytest.approx(9.2, abs=0.1)
    assert (names["gained"]["newton"] > 1e-9).any() and not (names["gained"]["stronge"] > 1e-9).any()
    assert all(0 <= share < 1 for share in names["shares"].values()) and names["shares"][1.6] > 0
    figures = [plt.figure(number) for number in plt.get_fignums()]
    assert len(figures) == 3
    folder = os.environ.get("HODOGRAPH_PICTURES")
    for number, figure in enumerate(figures):
        if folder:
            figure.savefig(Path(folder) / f"notebook_{number}.png", dpi=70)
    plt.close("all")
