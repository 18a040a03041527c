"""Derivatives of a motion through its impacts, and a fit of e to measured motions."""

from pathlib import Path

import hodograph
import numpy as np

MODELS = Path(__file__).resolve().parents[3] / "models"

pendulum = hodograph.load(MODELS / "planar_double_pendulum.mech")
gradient = pendulum.gradient(["q1", "m1", "e"], [0.25, 0.5], mu=0.2, e=0.6, law="poisson")
print("the end by q1, m1 and e:", gradient.q_by[-1].tolist(), gradient.undefined)

measured = [pendulum.simulate(0.5, 0.02, u=[-0.3, 2.0 + 0.3 * row], mu=0.2, e=0.6, law="poisson").columns() for row in range(3)]
noise = np.random.default_rng(1)
for motion in measured:
    for name in ("q1", "q2"):
        motion[name][1:] += 1e-3 * noise.normal(size=len(motion[name]) - 1)
fit = pendulum.fit(["e"], measured, outputs=["q1", "q2"], errors={"q1": 1e-3, "q2": 1e-3}, mu=0.2, e=0.5, law="poisson")
print(fit)
assert abs(fit.values["e"] - 0.6) < 5 * fit.errors["e"]
