"""How much rounding costs Pinocchio: python rounding.py FOLDER NAME:URDF..

FOLDER holds, per robot, states and answers in twice the digits of a double, as the benchmark writes them, a line each. Prints the errors
relative to the largest entry of an answer, as JSON: the content of `tests/data/peers/rounding.json`. `worst` is the largest of a set of
states, median over the sets, `of_all` the largest of all states.
"""

import json
import pathlib
import sys

import numpy as np
import pinocchio


def error(found, exact):
    high, low = (np.array([number[i] for number in exact]) for i in range(2))
    return float(np.max(np.abs((np.ravel(found) - high) - low)) / np.max(np.abs(high)))


def measure(path, urdf):
    lines = path.open()
    data = json.loads(next(lines))
    free = "q_base_e0" in data["coordinates"]
    model = pinocchio.buildModelFromUrdf(urdf, *([pinocchio.JointModelFreeFlyer()] if free else []))
    model.gravity.linear = np.array([0, 0, -9.80665])
    work = model.createData()
    # Pinocchio's place of each of our coordinates and speeds.
    places = {}
    for index in range(1, model.njoints):
        joint, name = model.joints[index], model.names[index]
        parts = [("base_" + part, i) for i, part in enumerate(["x", "y", "z", "e1", "e2", "e3", "e0"])]
        places |= {"q_" + part: joint.idx_q + i for part, i in (parts if joint.nq == 7 else [(name, 0)])}
        parts = [("base_" + part, i) for i, part in enumerate(["x", "y", "z", "rx", "ry", "rz"])]
        places |= {"u_" + part: joint.idx_v + i for part, i in (parts if joint.nq == 7 else [(name, 0)])}
    of_q = [places[name] for name in data["coordinates"]]
    order = [places[name] for name in data["speeds"]]
    link = model.getFrameId("ee")
    # From the world's axes to those of the contact: normal z, then as the model has them.
    basis = np.array(data["basis"])
    errors = {routine: [] for routine in ["FD", "ID", "CM", "M"]}
    for state in map(json.loads, lines):
        q, v, a, tau = pinocchio.neutral(model), *(np.zeros(model.nv) for _ in range(3))
        q[of_q] = state["q"]
        v[order], a[order], tau[order] = state["v"], state["a"], state["tau"]
        forward, inverse = pinocchio.aba(model, work, q, v, tau), pinocchio.rnea(model, work, q, v, a)
        errors["FD"].append(error(forward[order], state["FD"]))
        errors["ID"].append(error(inverse[order], state["ID"]))
        mass = np.triu(pinocchio.crba(model, work, q))
        mass = mass + np.triu(mass, 1).T
        errors["M"].append(error(mass[np.ix_(order, order)], state["M"]))
        frame = pinocchio.computeFrameJacobian(model, work, q, link, pinocchio.LOCAL_WORLD_ALIGNED)[:3]
        pinocchio.cholesky.decompose(model, work)
        columns = np.array([pinocchio.cholesky.solve(model, work, row) for row in frame]).T
        reduced = basis @ frame @ columns @ basis.T
        errors["CM"].append(error(reduced[np.triu_indices(3)], state["CM"]))
    return {routine: summary(np.array(list_), data["set"]) for routine, list_ in errors.items()}


def summary(errors, of_a_set):
    sets = errors.reshape(-1, of_a_set).max(axis=1)
    return {"worst": float(np.median(sets)), "of_all": float(errors.max()), "mean": float(errors.mean())}


folder = pathlib.Path(sys.argv[1])
robots = [robot.split(":", 1) for robot in sys.argv[2:]]
print(json.dumps({name: measure(folder / (name + ".jsonl"), urdf) for name, urdf in robots}, indent=1))
