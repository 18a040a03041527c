"""Holds imported robots to Pinocchio: python robots.py HODOGRAPH FOLDER URDF:LINK..

Each robot is imported with a contact at the link, derived and evaluated at three random states by the tool; mass matrix, forward and inverse
dynamics and the contact matrix must agree with Pinocchio's to 1e-10 of the largest entry. Prints one row of a Markdown table per robot.
"""

import json
import pathlib
import re
import subprocess
import sys
import time

import numpy as np
import pinocchio


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr}\n{done.stdout}")
    return done.stdout


def identifier(name):
    """The tool's spelling of a joint."""
    return re.sub(r"[^A-Za-z0-9_]", "_", name)


def state(model, rng):
    """A random state as Pinocchio has it, and as the tool has it."""
    q, v, a, tau = pinocchio.neutral(model), *(rng.uniform(-1, 1, model.nv) for _ in range(3))
    named = {"q": {}, "u": {}, "inputs": {}}
    order = [None] * model.nv
    for index in range(1, model.njoints):
        joint, name = model.joints[index], identifier(model.names[index])
        if joint.nq == 7:
            x = rng.uniform(-1, 1, 7)
            x[3:] /= np.linalg.norm(x[3:])
            q[joint.idx_q:joint.idx_q + 7] = x
            for part, value in zip(["x", "y", "z", "e1", "e2", "e3", "e0"], x):
                named["q"]["q_base_" + part] = value
            names = ["base_" + part for part in ["x", "y", "z", "rx", "ry", "rz"]]
        else:
            angle = rng.uniform(-1, 1)
            q[joint.idx_q:joint.idx_q + joint.nq] = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
            named["q"]["q_" + name] = angle
            names = [name]
        for place, part in enumerate(names, joint.idx_v):
            named["u"]["u_" + part] = v[place]
            named["inputs"]["tau_" + part] = tau[place]
            order[place] = "u_" + part
    return q, v, a, tau, named, order


def error(found, expected):
    found, expected = np.asarray(found), np.asarray(expected)
    return float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))


def compare(tool, path, link, folder):
    urdf = pathlib.Path(path)
    model_file = folder / (identifier(urdf.stem) + ".mech")
    model_file.write_text(run(tool, "import", urdf, "--contact", link))
    start = time.monotonic()
    run(tool, "derive", "--force", model_file)
    seconds = time.monotonic() - start
    floating = "q_base_e0" in model_file.read_text()
    model = pinocchio.buildModelFromUrdf(str(urdf), *([pinocchio.JointModelFreeFlyer()] if floating else []))
    model.gravity.linear = np.array([0, 0, -9.80665])
    data, rng, worst = model.createData(), np.random.default_rng(1), 0.0
    for _ in range(3):
        q, v, a, tau, named, order = state(model, rng)
        text = run(tool, "eval", model_file, "--state", json.dumps(named))
        answer = json.loads(text)
        place = [answer["speeds"].index(name) for name in order]
        mass = np.array(answer["mass_matrix"])[np.ix_(place, place)]
        expected = pinocchio.crba(model, data, q)
        expected = np.triu(expected) + np.triu(expected, 1).T
        contact = answer["contacts"]["contact_" + identifier(link)]
        axes = np.array([contact[axis] for axis in ["normal", "tangent", "binormal"]])
        jacobian = axes.T @ np.array(contact["V"])[:, place]
        frame = pinocchio.computeFrameJacobian(
            model, data, q, model.getFrameId(link), pinocchio.LOCAL_WORLD_ALIGNED)[:3]
        nn, nt, ns, tt, ts, ss = contact["reduced"]
        reduced = axes.T @ np.array([[nn, nt, ns], [nt, tt, ts], [ns, ts, ss]]) @ axes
        inverse = mass @ a - (np.array(answer["forcing"])[place] - tau)
        worst = max(
            worst,
            error(mass, expected),
            error([answer["udot"][name] for name in order], pinocchio.aba(model, data, q, v, tau)),
            error(inverse, pinocchio.rnea(model, data, q, v, a)),
            error(jacobian, frame),
            error(reduced, frame @ np.linalg.solve(expected, frame.T)),
        )
    verdict = "agrees" if worst <= 1e-10 else "DIFFERS"
    print(f"| {urdf.stem} | {model.nv} | {seconds:.2f} | {worst:.1e} | {verdict} |", flush=True)
    return worst <= 1e-10


def main():
    tool, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    print("| robot | speeds | derivation (s) | largest relative difference from Pinocchio | |")
    print("| --- | ---: | ---: | ---: | --- |")
    agree = [compare(tool, *robot.rsplit(":", 1), folder) for robot in sys.argv[3:]]
    sys.exit(0 if all(agree) else 1)


main()
