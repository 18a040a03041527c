"""Forward dynamics of a quadruped with 18 speeds at many states, on one core: columns of this package beside the generated Rust module, Pinocchio's Python binding and CasADi's
`map`, in turns in one run. `./throughput` builds what is needed and calls this; what counts is the ratios, of the best of many turns."""

import os

os.environ["RAYON_NUM_THREADS"] = "1"

import subprocess
import sys
import time
import timeit
import xml.etree.ElementTree as tree
from pathlib import Path

import casadi
import hodograph
import numpy as np
import pinocchio

ROOT = Path(__file__).resolve().parents[2]
URDF = ROOT / "tests/data/peers/anymal.urdf"
ROWS, TURNS = 2048, 15
GRAVITY = 9.80665


def articulated_bodies(path):
    """CasADi's expressions of the accelerations of a floating robot of a URDF, by articulated bodies (Featherstone), and the order of its joints.

    Inputs q: position, quaternion (scalar first), joints; u: velocity and angular velocity of the base along its axes, joints; tau. For robots whose
    joints are all revolute or fixed, about axes of coordinates, in frames that are parallel at rest.
    """
    root = tree.parse(path).getroot()
    vector = lambda text: np.array([float(word) for word in text.split()])
    cross = lambda a: casadi.vertcat(
        casadi.horzcat(0, -a[2], a[1]), casadi.horzcat(a[2], 0, -a[0]), casadi.horzcat(-a[1], a[0], 0)
    )
    inertias = {}
    for link in root.findall("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        m, i = float(inertial.find("mass").get("value")), inertial.find("inertia")
        c = np.array(cross(vector(inertial.find("origin").get("xyz"))), dtype=float)
        xx, xy, xz, yy, yz, zz = (float(i.get(name)) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
        rotational = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) - m * c @ c
        inertias[link.get("name")] = casadi.SX(casadi.DM(np.block([[rotational, m * c], [-m * c, m * np.eye(3)]])))
    joints = [joint for joint in root.findall("joint") if joint.get("type") != "fixed"]
    parent = {joint.find("child").get("link"): joint for joint in joints}
    q, u, tau = (casadi.SX.sym(name, 6 + len(joints) + extra) for name, extra in (("q", 1), ("u", 0), ("tau", 0)))
    places = {joint.get("name"): place for place, joint in enumerate(joints)}
    w, x, y, z = (q[k] for k in range(3, 7))
    to_world = casadi.vertcat(
        casadi.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        casadi.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        casadi.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    (base,) = (name for name in inertias if name not in parent)
    order = [base]
    while len(order) < len(inertias):
        order += [name for name in inertias if name not in order and parent[name].find("parent").get("link") in order]
    velocity = {base: casadi.vertcat(u[3:6], u[:3])}
    transform, axis, drift, bias = {}, {}, {}, {}
    motion = lambda v: casadi.vertcat(
        casadi.horzcat(cross(v[:3]), casadi.SX(3, 3)), casadi.horzcat(cross(v[3:]), cross(v[:3]))
    )
    for name in order:
        if name != base:
            joint = parent[name]
            place = places[joint.get("name")]
            along = vector(joint.find("axis").get("xyz"))
            s, c = casadi.sin(q[7 + place]), casadi.cos(q[7 + place])
            k = cross(along)
            rotation = casadi.SX(casadi.DM(np.outer(along, along))) * (1 - c) + c * casadi.SX.eye(3) - s * k
            offset = cross(vector(joint.find("origin").get("xyz")))
            transform[name] = casadi.vertcat(casadi.horzcat(rotation, casadi.SX(3, 3)), casadi.horzcat(-rotation @ offset, rotation))
            axis[name] = casadi.SX(casadi.DM(np.concatenate([along, np.zeros(3)])))
            of_joint = axis[name] * u[6 + place]
            velocity[name] = transform[name] @ velocity[joint.find("parent").get("link")] + of_joint
            drift[name] = motion(velocity[name]) @ of_joint
        bias[name] = -motion(velocity[name]).T @ (inertias[name] @ velocity[name])
    inertia, force, rest = dict(inertias), {}, {}
    for name in reversed(order[1:]):
        above = parent[name].find("parent").get("link")
        force[name] = inertia[name] @ axis[name]
        force_of_axis = axis[name].T @ force[name]
        rest[name] = tau[6 + places[parent[name].get("name")]] - axis[name].T @ bias[name], force_of_axis
        left = inertia[name] - force[name] @ force[name].T / force_of_axis
        pushed = bias[name] + left @ drift[name] + force[name] * (rest[name][0] / force_of_axis)
        inertia[above] = inertia[above] + transform[name].T @ left @ transform[name]
        bias[above] = bias[above] + transform[name].T @ pushed
    moment_and_force = casadi.vertcat(tau[3:6], tau[:3])
    fall = casadi.vertcat(casadi.SX(3, 1), to_world.T @ casadi.DM([0, 0, -GRAVITY]))
    acceleration = {base: casadi.solve(inertia[base], moment_and_force - bias[base])}
    found = [None] * len(joints)
    for name in order[1:]:
        carried = transform[name] @ acceleration[parent[name].find("parent").get("link")] + drift[name]
        rate = (rest[name][0] - force[name].T @ carried) / rest[name][1]
        acceleration[name] = carried + axis[name] * rate
        found[places[parent[name].get("name")]] = rate
    of_base = acceleration[base] + fall
    return casadi.Function("fd", [q, u, tau], [casadi.vertcat(of_base[3:], of_base[:3], *found)]), list(places)


def best(calls):
    """The least time of each of these calls, in turns, s."""
    least = dict.fromkeys(calls, np.inf)
    for _ in range(TURNS):
        for name, call in calls.items():
            start = time.perf_counter()
            told = call()
            least[name] = min(least[name], told if isinstance(told, float) else time.perf_counter() - start)
    return least


def main(benchmark):
    m = hodograph.load(ROOT / "tests/benchmarks/columns/quadruped.mech")
    random = np.random.default_rng(1)
    q = 0.4 * random.normal(size=(ROWS, 19)) + [x.value or 0 for x in m.coordinates]
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    u, tau = 2 * random.normal(size=(ROWS, 18)), 3 * random.normal(size=(ROWS, 18))

    robot = pinocchio.buildModelFromUrdf(str(URDF), pinocchio.JointModelFreeFlyer())
    robot.gravity.linear = np.array([0, 0, -GRAVITY])
    data = robot.createData()
    names = [x.name.removeprefix("q_") for x in m.coordinates[7:]]
    of_pin = [names.index(name) for name in robot.names[2:]]
    pin_q = np.hstack([q[:, :3], q[:, 4:7], q[:, 3:4], q[:, 7:][:, of_pin]])
    pin_u, pin_tau = (np.hstack([x[:, :6], x[:, 6:][:, of_pin]]) for x in (u, tau))
    back = [*range(6), *(6 + np.argsort(of_pin))]

    function, joints = articulated_bodies(URDF)
    assert joints == names
    mapped = function.map(ROWS, "serial")
    columns = [casadi.DM(x.T) for x in (q, u, tau)]

    found = m.accelerations(q, u, tau)
    of_pinocchio = lambda: [pinocchio.aba(robot, data, *row).copy() for row in zip(pin_q, pin_u, pin_tau)]
    for name, other in (("Pinocchio", np.array(of_pinocchio())[:, back]), ("CasADi", mapped(*columns).full().T)):
        error = abs(found - other).max() / abs(found).max()
        assert error < 1e-10, f"{name} differs by {error}"

    def emitted():
        told = subprocess.run([benchmark, "--seconds"], capture_output=True, text=True, check=True).stdout
        return ROWS * float(told)

    def columns_of_this_package():
        """As the program of the generated module does: the best of 40 turns."""
        return min(timeit.repeat(lambda: m.accelerations(q, u, tau), number=1, repeat=40))

    times = best({
        "this package, columns": columns_of_this_package,
        "generated Rust module": emitted,
        "this package, one call a state": lambda: [m.accelerations(a, b, c) for a, b, c in zip(q[:256], u[:256], tau[:256])],
        "Pinocchio, aba": of_pinocchio,
        "CasADi, map, serial": lambda: mapped(*columns),
    })  # fmt: skip
    times["this package, one call a state"] *= ROWS / 256
    reference = times["this package, columns"]
    print(f"forward dynamics of a quadruped, {ROWS} states, one core; hodograph {reference / ROWS * 1e6:.2f} us a state on this machine")
    print("| evaluated by | throughput, that of this package's columns = 1 | time a state, that of the generated Rust module = 1 |")
    print("| --- | --- | --- |")
    for name, seconds in times.items():
        print(f"| {name} | {reference / seconds:.3f} | {seconds / times['generated Rust module']:.2f} |")


if __name__ == "__main__":
    main(sys.argv[1])
