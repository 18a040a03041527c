"""The wheel answers with the bits of generated Rust modules, for one state and for many."""

import struct
from collections import defaultdict
from pathlib import Path

import hodograph
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
REFERENCE = ROOT / "bindings/python/target/reference.txt"
MODELS = sorted(path.stem for path in (ROOT / "models").glob("*.mech"))


def load_reference():
    found = defaultdict(lambda: defaultdict(dict))
    for line in REFERENCE.read_text().splitlines():
        model, routine, row, *bits = line.split(" ")
        numbers = [struct.unpack(">d", bytes.fromhex(word))[0] for word in bits if word]
        found[model][routine][int(row)] = np.array(numbers)
    return found


REFERENCE_NUMBERS = load_reference()


def same(found, expected):
    assert np.ascontiguousarray(found).ravel().tobytes() == np.ascontiguousarray(expected).ravel().tobytes()


def test_all_models_are_there():
    assert sorted(REFERENCE_NUMBERS) == MODELS


@pytest.mark.parametrize("model", MODELS)
def test_bits_are_those_of_rust(model):
    m = hodograph.load(ROOT / f"models/{model}.mech")
    of = REFERENCE_NUMBERS[model]
    rows = sorted(of["q"])
    q, u, inputs = (np.array([of[name][row] for row in rows]) for name in ("q", "u", "inputs"))
    time = 0.1 * np.arange(len(rows))
    calls = {
        "accelerations": lambda *s, **k: m.accelerations(*s, **k),
        "mass_matrix": lambda *s, **k: m.mass_matrix(*s, **k),
        "forcing": lambda *s, **k: m.forcing(*s, **k),
        "coordinate_rates": lambda *s, **k: m.coordinate_rates(*s, **k),
        "inverse_dynamics": lambda q, u, *s, **k: m.inverse_dynamics(u, q, u, *s, **k),
    }
    compared = 0
    for name, call in calls.items():
        many = call(q, u, inputs, time, errors="nan")
        for row in rows:
            if row in of[name]:
                same(many[row], of[name][row])
                same(call(q[row], u[row], inputs[row], time[row]), of[name][row])
                compared += 1
            else:
                assert np.isnan(many[row]).all()
                with pytest.raises(hodograph.StateError):
                    call(q[row], u[row], inputs[row], time[row])
    assert compared > 100
    for index, contact in enumerate(m.contacts):
        mu = 0.1 * (np.arange(len(rows)) % 8)
        hits = m.collide(contact, q, u, inputs, time, mu=mu, e=0.7, law="stronge", errors="nan")
        for row in rows:
            if row in of[f"collide{index}"]:
                assert hits.kind[row] == ""
                same(hits.speeds[row], of[f"collide{index}"][row])
            else:
                assert hits.kind[row] != "" and np.isnan(hits.speeds[row]).all()


def test_twenty_states_have_the_bits_of_every_door():
    table = np.loadtxt(ROOT / "tests/data/doors/planar_double_pendulum.csv", delimiter=",", skiprows=1)
    assert table.shape == (20, 7)
    m = hodograph.load(ROOT / "models/planar_double_pendulum.mech")
    q, u = table[:, :2], table[:, 2:4]
    same(m.accelerations(q, u), table[:, 4:6])
    same(m.kinetic_energy(q, u), table[:, 6])
    for row in table:
        same(m.accelerations(row[:2], row[2:4]), row[4:6])
