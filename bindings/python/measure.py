"""What calls cost: `target/test-environment/bin/python measure.py` after `./test`. Times are the best of many; on a machine with other load only the ratios count."""

import timeit
from pathlib import Path

import hodograph
import numpy as np

ROOT = Path(__file__).resolve().parents[2]


def best(call, number):
    return min(timeit.repeat(call, number=number, repeat=60)) / number


a, b = np.eye(3), np.ones(3)
numpys = best(lambda: np.linalg.solve(a, b), 200)
print(f"numpy.linalg.solve, 3 x 3: {numpys * 1e6:.2f} us")
for name in ("spherical_pendulum", "two_sleds", "slender_rod_5dof", "arm_7dof"):
    m = hodograph.load(ROOT / f"models/{name}.mech")
    q, u = (np.array([x.value for x in xs]) for xs in (m.coordinates, m.speeds))
    one = best(lambda: m.accelerations(q, u), 200)
    rows = 4096
    many_q, many_u = np.tile(q, (rows, 1)), np.tile(u, (rows, 1))
    many = best(lambda: m.accelerations(many_q, many_u), 2) / rows
    print(f"{name}: accelerations {one * 1e6:.2f} us a call ({one / numpys:.2f} of numpy's), {many * 1e6:.3f} us a row in a batch of {rows}")

SURFACE = {"mu": 0.6, "e": 0.8, "law": "stronge", "errors": "nan"}
for name in ("spherical_pendulum", "two_sleds", "free_box_corner", "arm_7dof"):
    m = hodograph.load(ROOT / f"models/{name}.mech")
    contact = m.contacts[0]
    q, u = (np.array([x.value for x in xs]) for xs in (m.coordinates, m.speeds))
    one = best(lambda: m.collide(contact, q, u, **SURFACE), 200)
    rows = 4096
    many_q, many_u = np.tile(q, (rows, 1)), np.tile(u, (rows, 1))
    many = best(lambda: m.collide(contact, many_q, many_u, **SURFACE), 2) / rows
    print(f"{name}: collide {one * 1e6:.2f} us a call ({one / numpys:.2f} of numpy's), {many * 1e6:.3f} us a row in a batch of {rows}")
