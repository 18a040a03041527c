"""The example notebook runs, and its numbers are those of the paper's example."""

import json
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


def test_the_notebook_runs(monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    monkeypatch.chdir(ROOT)
    notebook = json.loads((ROOT / "bindings/python/notebooks/two_sleds.ipynb").read_text())
    names = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
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
