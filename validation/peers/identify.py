"""Identifies the constants of one simulator on the fitted tosses, and predicts the judged ones: `identify.py SET SIMULATOR [--effort TIMES] [--quick FOLDER]`.

Writes results/SET_SIMULATOR.json (constants, counts), .._search.csv (every evaluation) and .._errors.csv (error of every toss).
"""

import csv
import json
import os
import sys
import time
from pathlib import Path

import cma
import numpy as np

import problem as tosses_of
import simulators

RESULTS = Path(__file__).parent.parent / "results"
POPULATION, SEED = 10, 1
SCREEN, REFINE = 10, 40  # evaluations of each of the six variants, and of the best one after these
FRAMES = 75  # of these the search takes the error at most
LIMIT = {"cube": 0.06, "elbow": 0.5}


def objective(name, errors):
    return float(np.mean(errors / (errors + LIMIT[name])))


class Search:
    def __init__(self, problem, simulator):
        self.problem, self.simulator = problem, simulator
        self.use = np.flatnonzero(problem.fitted)
        self.log, self.failures, self.began = [], [], time.time()

    def ranges(self, variant):
        # Lengths in the data are short by the ratio of gravity in flight to the true one.
        edges = float(np.linalg.norm(self.problem.shared[0][:3]) / 9.81)
        body = dict(simulators.BODY, edges=(edges, *simulators.BODY["edges"][1:]))
        return body | self.simulator.contact(self.problem, variant)

    def evaluate(self, variant, constants):
        predicted, failures = self.simulator.predict(self.problem, self.use, variant, constants, self.problem.starts[self.use], longest=FRAMES)
        errors = np.array([tosses_of.errors(self.problem, toss, frames)[:FRAMES].mean() for toss, frames in zip(self.use, predicted)])
        value = objective(self.problem.name, errors)
        self.failures += [failure | {"variant": variant} for failure in failures]
        self.log.append({**variant, **constants, "objective": value, "mean": errors.mean(), "median": np.median(errors), "failures": len(failures), "seconds": time.time() - self.began})
        if len(self.log) % 10 == 0:
            print(f"{self.problem.name} {self.simulator.name} {len(self.log)}: {variant} {value:.4f}, {self.log[-1]['seconds']:.0f} s", flush=True)
        return value

    def run(self, variant, start, count, sigma):
        """The best constants of `count` evaluations from `start`, by CMA-ES."""
        ranges = self.ranges(variant)
        names = list(ranges)
        scale = np.array([simulators.SCALES.get(name, 0.5) for name in names])
        low, high = (np.log([ranges[name][k] for name in names]) / scale for k in (1, 2))
        x0 = np.log([start[name] for name in names]) / scale
        options = {"seed": SEED, "popsize": POPULATION, "bounds": [low, high], "verbose": -9, "maxfevals": count}
        # A start on a bound would leave the bounds by rounding.
        search = cma.CMAEvolutionStrategy(np.clip(x0, low + 1e-9, high - 1e-9), sigma, options)
        search.inject([np.clip(x0, low + 1e-9, high - 1e-9)], force=True)  # the start itself is tried
        best = (np.inf, start)
        for _ in range(count // POPULATION):
            points = search.ask()
            constants = [dict(zip(names, map(float, np.exp(scale * np.array(x))))) for x in points]
            values = [self.evaluate(variant, c) for c in constants]
            search.tell(points, values)
            best = min([best, *zip(values, constants)], key=lambda pair: pair[0])
        return best


def main():
    name, which = sys.argv[1:3]
    quick = "--quick" in sys.argv
    problem = tosses_of.load(name)
    simulator = simulators.Workers(which, problem, int(os.environ.get("HODOGRAPH_WORKERS", 2)))
    search = Search(problem, simulator)
    folder = RESULTS
    screen, refine, judged = SCREEN, REFINE, np.flatnonzero(problem.judged)
    if quick:
        folder = Path(sys.argv[sys.argv.index("--quick") + 1])
        screen, refine, search.use, judged = POPULATION, POPULATION, search.use[:4], judged[:6]
        simulator.variants = simulator.variants[:2]
    # For information: a peer with several times the effort.
    effort = int(sys.argv[sys.argv.index("--effort") + 1]) if "--effort" in sys.argv else 1
    screen, refine = effort * screen, effort * refine
    folder.mkdir(exist_ok=True)
    screened = []
    for variant in simulator.variants:
        start = {key: value[0] for key, value in search.ranges(variant).items()}
        value, constants = search.run(variant, start, screen, 0.5)
        screened.append((value, variant, constants))
    value, variant, constants = min(screened, key=lambda entry: entry[0])
    refined = search.run(variant, constants, refine, 1 / 3)
    value, constants = min([(value, constants), refined], key=lambda pair: pair[0])
    out = folder / (f"{name}_{which}" + (f"_{effort}" if effort > 1 else ""))
    keys = list(dict.fromkeys(key for row in search.log for key in row))
    with open(f"{out}_search.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, keys)
        writer.writeheader()
        writer.writerows({key: f"{v:.9g}" if isinstance(v, float) else v for key, v in row.items()} for row in search.log)
    print(f"{name} {simulator.name}: {variant} {constants} {value:.4f}", flush=True)

    def judge(variant, constants, fineness=1, starts=problem.starts):
        predicted, failures = simulator.predict(problem, judged, variant, constants, starts[judged], fineness)
        errors = [tosses_of.errors(problem, toss, frames) for toss, frames in zip(judged, predicted)]
        return predicted, errors, failures

    predicted, errors, failures = judge(variant, constants)
    _, finer, _ = judge(variant, constants, 2)
    rows = []
    for place, toss in enumerate(judged):
        after = errors[place][problem.air[toss] :]
        last = predicted[place][-1] if len(predicted[place]) < problem.horizon(toss) else predicted[place][problem.horizon(toss) - 1]
        rows.append({
            "toss": int(problem.numbers[toss]), "error": errors[place].mean(), "after_flight": after.mean() if len(after) else float("nan"),
            "other_step": finer[place].mean(), "right_face": int(tosses_of.face(last) == tosses_of.face(problem.places[toss][problem.horizon(toss) - 1])),
        })
    with open(f"{out}_errors.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows({key: f"{v:.9g}" if isinstance(v, float) else v for key, v in row.items()} for row in rows)
    answer = {
        "set": name, "simulator": simulator.name, "variant": variant, "constants": constants, "objective": value,
        "evaluations": len(search.log), "seconds_of_search": time.time() - search.began,
        "failures_judged": [{k: v for k, v in failure.items() if k != "request"} for failure in failures], "failures_in_search": len(search.failures),
        "variants": [{"variant": v, "objective": o, "constants": c} for o, v, c in screened],
    }
    kept = {(failure["toss"], failure["kind"]): failure for failure in failures + search.failures if "request" in failure}
    if kept:
        (folder / f"{name}_{which}_failures.json").write_text(json.dumps(list(kept.values())[:60]) + "\n")
    Path(f"{out}.json").write_text(json.dumps(answer, indent=1) + "\n")


if __name__ == "__main__":
    main()
