"""What the set of outcomes holds of the measured tosses: `outcomes.py SET [--quick FOLDER]` writes results/SET_outcomes.csv.

Where several corners strike at one time the order is drawn (`sampled`), COUNT times for each judged toss, with the constants that were identified before.
A row tells of the drawn ends and of the single prediction: how many different faces the body ends on, whether the measured one is among them, and by how much the
measured centre is outside of the range of the drawn ones (m, along each horizontal axis, 0 within).
"""

import csv
import json
import os
import sys
from pathlib import Path

import numpy as np

import problem as tosses_of
import simulators

RESULTS = Path(__file__).parent.parent / "results"
COUNT = 20


def main():
    name = sys.argv[1]
    quick = "--quick" in sys.argv
    problem = tosses_of.load(name)
    found = json.loads((RESULTS / f"{name}_hodograph.json").read_text())
    simulator = simulators.Workers("hodograph", problem, int(os.environ.get("HODOGRAPH_WORKERS", 2)))
    judged = np.flatnonzero(problem.judged)
    judged, count = (judged[:6], 4) if quick else (judged, COUNT)

    def ends(variant):
        predicted, failures = simulator.predict(problem, judged, variant, found["constants"], problem.starts[judged])
        last = [frames[min(len(frames), problem.horizon(toss)) - 1] for toss, frames in zip(judged, predicted)]
        return np.array(last), {failure["toss"] for failure in failures}

    single, failed = ends(found["variant"])
    drawn = []
    for seed in range(count):
        last, some = ends(found["variant"] | {"together": "sampled", "seed": 1000 * seed})
        failed |= some
        drawn.append(last)
        print(f"{name}: {seed + 1} of {count}", flush=True)
    drawn = np.array(drawn)
    rows = []
    for place, toss in enumerate(judged):
        measured = problem.places[toss][problem.horizon(toss) - 1]
        faces = [tosses_of.face(end) for end in drawn[:, place]]
        low, high = drawn[:, place, :2].min(0), drawn[:, place, :2].max(0)
        outside = np.maximum(np.maximum(low - measured[:2], measured[:2] - high), 0)
        rows.append({
            "toss": int(problem.numbers[toss]), "faces": len(set(faces)), "face_drawn": int(tosses_of.face(measured) in faces),
            "face_single": int(tosses_of.face(single[place]) == tosses_of.face(measured)), "width": (high - low).max(), "outside": outside.max(),
            "off_single": np.abs(single[place, :2] - measured[:2]).max(), "failed": int(problem.numbers[toss] in failed),
        })
    folder = Path(sys.argv[sys.argv.index("--quick") + 1]) if quick else RESULTS
    folder.mkdir(exist_ok=True)
    with open(folder / f"{name}_outcomes.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()} for row in rows)


if __name__ == "__main__":
    main()
