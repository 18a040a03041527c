"""A short comparison: flight of every simulator beside the equations of flight, the split, and ten evaluations on four tosses of the cube."""

import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

try:
    import cma  # noqa: F401
    import numpy as np
    import scipy  # noqa: F401
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(2)

import flight
import simulators


def free(name, body, count=4, frames=25):
    """Random bodies far above the table."""
    random = np.random.default_rng(0)
    q = random.normal(size=(count, 4))
    parts = [random.uniform(5, 6, (count, 3)), q / np.linalg.norm(q, axis=1, keepdims=True)]
    parts += [random.uniform(-1, 1, (count, 1))] * (name == "elbow")
    parts += [random.normal(size=(count, 3)), 5 * random.normal(size=(count, 3))] + [3 * random.normal(size=(count, 1))] * (name == "elbow")
    shared = [0.3, -0.2, -9.6] + ([0.001, -0.002, 0.003] if name == "cube" else [4.9e-4, 1.2e-3, 0.002])
    problem = SimpleNamespace(name=name, shared=np.tile(shared, (count, 1)), body=body, height=lambda factor: np.zeros(count), horizon=lambda toss: frames, numbers=np.arange(count))
    return problem, np.concatenate(parts, 1)


def check(holds, what):
    if not holds:
        sys.exit(f"wrong: {what}")


def main():
    missing = []
    for which, kind in simulators.ALL.items():
        try:
            simulator = kind()
        except ImportError:
            missing.append(kind.name)
            print(f"WARNING: NO {kind.name.upper()} HERE: it was NOT compared.", file=sys.stderr)
            continue
        for name, body in (("cube", flight.Cube), ("elbow", flight.Elbow)):
            problem, states = free(name, body)
            expected = body.flight(states, problem.shared, 25)
            variant = simulator.variants[0]
            constants = {"edges": 1.0, "moments": 1.0} | {key: value[0] for key, value in simulator.contact(problem, variant).items()}
            apart = []
            for fineness in (1, 4):
                predicted, failures = simulator.predict(problem, np.arange(4), variant, constants, states, fineness)
                check(not failures, f"{which} {name}: {failures}")
                apart.append(np.abs(flight.differences(np.array(predicted), expected)).max())
            if which == "hodograph":
                check(apart[0] < 1e-2, f"flight of {which} {name} differs: {apart}")
            else:
                # Steps of first order: a quarter of the step, a quarter of the difference.
                check(3 < apart[0] / apart[1] < 5 and apart[1] < 15, f"flight of {which} {name} differs: {apart}")
            print(f"{kind.name}, {name}: flight agrees ({apart[0]:.1e}, then {apart[1]:.1e} of the noise)")
    import problem as tosses_of

    problem = tosses_of.load("cube")
    check((problem.fitted.sum(), problem.judged.sum()) == (55, 495), "the split")
    check(np.abs(np.linalg.norm(problem.shared[0][:3]) - 9.6) < 0.1, "gravity")
    with tempfile.TemporaryDirectory() as folder:
        for which, kind in simulators.ALL.items():
            if kind.name not in missing:
                subprocess.run([sys.executable, Path(__file__).parent / "identify.py", "cube", which, "--quick", folder], check=True)
                rows = (Path(folder) / f"cube_{which}_errors.csv").read_text().splitlines()[1:]
                check(len(rows) == 6 and all(float(row.split(",")[1]) < 5 for row in rows), f"errors of {which}: {rows}")
        subprocess.run([sys.executable, Path(__file__).parent / "impacts.py", "--check"], check=True)
        subprocess.run([sys.executable, Path(__file__).parent / "outcomes.py", "cube", "--quick", folder], check=True)
        rows = (Path(folder) / "cube_outcomes.csv").read_text().splitlines()[1:]
        check(len(rows) == 6 and all(row.endswith(",0") for row in rows), f"drawn outcomes: {rows}")


if __name__ == "__main__":
    main()
