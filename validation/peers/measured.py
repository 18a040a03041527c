"""What was measured without a simulator, and the prediction that nothing moves: `measured.py SET` writes results/SET_data.json and .._frozen_errors.csv."""

import csv
import json
import sys
from pathlib import Path

import numpy as np

import problem as tosses_of
import simulators

RESULTS = Path(__file__).parent.parent / "results"


def main():
    name = sys.argv[1]
    problem = tosses_of.load(name)
    blocks = range(int(problem.block.max()) + 1)
    first = [int(np.flatnonzero(problem.block == block)[0]) for block in blocks]
    names = [f"{axis} of block {block}" for block in blocks for axis in ("gx", "gy", "gz")] + problem.body.names[3:]
    values = [problem.shared[toss][k] for toss in first for k in range(3)] + list(problem.shared[0][3:])
    data = {
        "tosses": len(problem.numbers), "fitted": int(problem.fitted.sum()), "judged": int(problem.judged.sum()),
        "flight": {key: [float(value), float(error)] for key, value, error in zip(names, values, problem.deviations)},
        "flight_rms": problem.flight_rms, "flight_tosses": problem.flight_tosses,
        "normals": problem.normal.tolist(), "scatter_of_heights": problem.scatter, "height_at_rest": float(problem.rest[0]),
        "frames_of_flight": {"median": float(np.median(problem.air)), "least": int(problem.air.min())}, "without_flight": int((problem.air < 3).sum()),
    }
    (RESULTS / f"{name}_data.json").write_text(json.dumps(data, indent=1) + "\n")
    with open(RESULTS / f"{name}_frozen_errors.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["toss", "error", "after_flight", "other_step", "right_face"])
        for toss in np.flatnonzero(problem.judged):
            places, count = problem.places[toss], problem.horizon(toss)
            errors = tosses_of.errors(problem, toss, places[:1])
            after = errors[problem.air[toss] :]
            same = int(tosses_of.face(places[0]) == tosses_of.face(places[count - 1]))
            writer.writerow([int(problem.numbers[toss]), f"{errors.mean():.9g}", f"{after.mean() if len(after) else np.nan:.9g}", f"{errors.mean():.9g}", same])


if __name__ == "__main__":
    main()
