"""Many states, collisions and motions at once, as arrays and as tables."""

from pathlib import Path

import hodograph
import numpy as np

MODELS = Path(__file__).resolve().parents[3] / "models"

sleds: hodograph.Mechanism = hodograph.load(MODELS / "two_sleds.mech")
u = np.random.default_rng(0).normal(size=(10_000, 4))
rates = sleds.accelerations(u=u)
hits = sleds.collide("BcAc", u=u, mu=0.6, e=0.8, law="stronge", errors="nan")
paths, counts = np.unique(hits.path, return_counts=True)
print(rates.shape, dict(zip(paths, counts)))

box = hodograph.load(MODELS / "free_box_corner.mech")
mus = np.linspace(0.1, 0.9, 5)
motions = box.simulate_many(0.5, mu=mus, e=0.4, law="poisson", tolerance=1e-9, progress=lambda done, rows: None)
for mu, kind, lost in zip(mus, motions.kind, motions.impacts + motions.friction):
    print(f"mu = {mu:.1f}: {kind}, {lost:+.4f} J")

heavier = sleds.with_parameters(**{sleds.parameters[0].name: np.array([1.0, 2.0, 3.0])})
print(heavier.kinetic_energy())
