"""Bad input has one kind and the same words through every door: tests/data/doors/errors.json. Of what it lacks, Python is compared with the command line tool."""

import json
import os
import subprocess
from pathlib import Path

import hodograph
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
MODEL = ROOT / "models/two_sleds.mech"
TOOL = os.environ.get("HODOGRAPH_TOOL")
SURFACE = dict(mu=0.3, e=0.5, law="newton")
AWAY = [-5.0, 0.0, -1.0, 0.0]
MATRIX, APPROACH = [1.0, 0.2, 0.0, 2.0, 0.0, 3.0], [-1.0, 0.5, 0.0]


def by_the_tool(*arguments, given=""):
    """Kind and text of an error."""
    if not TOOL:
        pytest.skip("HODOGRAPH_TOOL names no tool")
    said = subprocess.run([TOOL, *map(str, arguments)], input=given, capture_output=True, text=True).stdout
    error = json.loads(said.splitlines()[0])["error"]
    return error["kind"], error["message"]


def by_python(call):
    with pytest.raises(hodograph.HodographError) as caught:
        call()
    return caught.value.kind, str(caught.value)


def collide(**surface):
    return by_the_tool("collide", MODEL, *[f"--{name}={value}" for name, value in {**SURFACE, **surface}.items()])


@pytest.mark.parametrize("surface", [dict(mu=-1), dict(e=1.5), dict(e=-0.25)])
def test_surfaces(surface):
    m = hodograph.load(MODEL)
    assert by_python(lambda: m.collide("BcAc", **{**SURFACE, **surface})) == collide(**surface)


def test_states():
    m = hodograph.load(MODEL)
    names = [speed.name for speed in m.speeds]
    state = ",".join(f"{name}={value}" for name, value in zip(names, AWAY))
    expected = by_the_tool("collide", MODEL, "--mu", 0.3, "--e", 0.5, "--law", "newton", "--state", state)
    assert by_python(lambda: m.collide("BcAc", u=AWAY, **SURFACE)) == expected
    # What is no number is told with the place that each door knows.
    kind, _ = by_the_tool("eval", MODEL, "--state", f"{names[0]}=nan")
    assert by_python(lambda: m.accelerations(u=[np.nan, 0, 0, 0]))[0] == kind == "not_finite"


def test_collisions_by_themselves():
    for matrix, approach, mu in ((MATRIX, APPROACH, -0.5), (MATRIX, [1.0, 0.5, 0.0], 0.3), ([-1.0, 0, 0, 1, 0, 1], APPROACH, 0.3)):
        line = json.dumps({"m": matrix, "v": approach, "mu": mu, "e": 0.5, "law": "newton"})
        expected = by_the_tool("solve", given=line + "\n")
        assert by_python(lambda: hodograph.solve(matrix, approach, mu=mu, e=0.5, law="newton")) == expected


def test_models():
    wrong = "mechanism M;\nspeeds { u1: rad/s }\npoints { P = O + nowhere*N.x; }\n"
    if not TOOL:
        pytest.skip("HODOGRAPH_TOOL names no tool")
    path = ROOT / "bindings/python/target/wrong.mech"
    path.write_text(wrong)
    said = subprocess.run([TOOL, "check", str(path)], capture_output=True, text=True)
    found = [d for d in hodograph.check(path) if d.severity == "error"]
    assert len(found) > 1 and all(d.code in said.stdout + said.stderr and d.message in said.stdout + said.stderr for d in found)
    assert by_python(lambda: hodograph.load(path))[0] == found[0].code


MISTAKES = json.loads((ROOT / "tests/data/doors/errors.json").read_text())


@pytest.mark.parametrize("mistake", [m for m in MISTAKES if "python" in m["doors"]], ids=lambda mistake: mistake["name"].replace(" ", "_"))
def test_bad_input_has_the_errors_of_every_door(mistake):
    m = hodograph.load(ROOT / "tests/data/doors/errors.mech")
    surface = {name: mistake[name] for name in ("mu", "e", "law") if name in mistake}

    def state(section, quantities):
        given = mistake.get(section, {})
        return [float(given.get(quantity.name, quantity.value)) for quantity in quantities]

    def call():
        machine = m.with_parameters(**{name: float(value) for name, value in mistake.get("parameters", {}).items()})
        q, u = state("q", m.coordinates)[: mistake.get("count")], state("u", m.speeds)
        if mistake["call"] == "accelerations":
            return machine.accelerations(q, u)
        if mistake["call"] == "collide":
            return machine.collide(mistake.get("contact", "floor"), q, u, **surface)
        if "contact" in mistake:
            surface.update(surfaces={mistake["contact"]: dict(surface)})
        return machine.simulate(0.1, q=q, u=u, **surface, **{name: mistake[name] for name in ("tolerance",) if name in mistake})

    kind, words = by_python(call)
    assert (kind, mistake["words"] in words) == (mistake["kind"], True), words


def test_a_contact_without_a_gap_is_told_in_the_same_words():
    path, note = ROOT / "tests/data/doors/errors.mech", "contact brush has no gap in the model: it is never seen to close"
    with pytest.warns(UserWarning, match=note):
        hodograph.load(path).simulate(0.01, **SURFACE)
    if TOOL:
        surface = [f"--{name}={value}" for name, value in SURFACE.items()]
        said = subprocess.run([TOOL, "simulate", str(path), "--until", "0.01", *surface], capture_output=True, text=True)
        assert note in said.stderr, said.stderr
