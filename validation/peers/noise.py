"""The error that a perfect simulator would have: Hodograph's own prediction, measured with noise. `noise.py SET` writes results/SET_noise.json."""

import copy
import json
import os
import sys
from pathlib import Path

import numpy as np

import flight
import problem as tosses_of
import simulators

RESULTS = Path(__file__).parent.parent / "results"


def main():
    name = sys.argv[1]
    problem = tosses_of.load(name)
    found = json.loads((RESULTS / f"{name}_hodograph.json").read_text())
    simulator = simulators.Workers("hodograph", problem, int(os.environ.get("HODOGRAPH_WORKERS", 2)))
    judged = np.flatnonzero(problem.judged)
    predict = lambda starts: simulator.predict(problem, judged, found["variant"], found["constants"], starts[judged])[0]
    random = np.random.default_rng(1)
    noisy = copy.copy(problem)
    noisy.places, noisy.raw = list(problem.places), problem.starts.copy()
    for toss, table in zip(judged, predict(problem.starts)):
        count = problem.horizon(toss)
        # A motion that ended early stays in its last frame, as it is judged.
        table = np.concatenate([table, np.repeat(table[-1:], max(0, count - len(table)), 0)])
        table[:, :3] += random.normal(0, flight.NOISE_POSITION, (len(table), 3))
        turn = flight.rotation(table[:, 3:7]) * flight.Rotation.from_rotvec(random.normal(0, flight.NOISE_ANGLE, (len(table), 3)))
        table[:, 3:7] = turn.as_quat(scalar_first=True)
        table[:, 7:] += random.normal(0, flight.NOISE_HINGE, table[:, 7:].shape)
        noisy.places[toss] = table
    noisy.starts = tosses_of.start(noisy)
    errors = np.array([tosses_of.errors(noisy, toss, frames).mean() for toss, frames in zip(judged, predict(noisy.starts))])
    answer = {"mean": errors.mean(), "standard_error": errors.std(ddof=1) / np.sqrt(len(errors)), "median": float(np.median(errors))}
    (RESULTS / f"{name}_noise.json").write_text(json.dumps(answer, indent=1) + "\n")


if __name__ == "__main__":
    main()
