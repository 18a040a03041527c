"""Clean impacts of one corner of the elbow, and what laws with few constants leave of them: `impacts.py` writes results/elbow_impacts.json and .csv, `impacts.py
--check` only compares two ways to compute them. See ../plan.md, "Clean impacts"."""

import csv
import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import flight
import problem as tosses_of

RESULTS = Path(__file__).parent.parent / "results"
EDGES = 0.979
FRAMES = 5
RESIDUAL, APART, LEFT = 6.0, 300.0, 0.005
DIP, CLEAR, LOWER = 0.008, 0.001, 0.004
APPROACH, IMPULSE = 0.2, 0.4
HALVES = EDGES * tosses_of.HALVES["elbow"]
AXIS = np.array([0.0, 1, 0])


@dataclass
class Impact:
    """In units of the mass of a box: velocities in m/s along x, y, z (up) of the table."""

    toss: int
    before: np.ndarray  # velocity of the corner
    after: np.ndarray
    reduced: np.ndarray  # (3, 3): change of that velocity by an impulse
    impulse: np.ndarray  # that explains most of the change of all velocities
    left: float  # part of the energy of that change that no impulse at the corner explains
    energy: float  # du.M du


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def second(angle):
    """Axes of the second box, and its centre from the hinge, in the first box's axes."""
    sine, cosine = np.sin(angle), np.cos(angle)
    axes = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    return axes, axes @ [flight.Elbow.arm, 0, 0]


def corner_velocity(angle, corner):
    """Velocity of a corner over (v, w, hinge rate), all in the first box's axes."""
    local = tosses_of.SIGNS[corner % 8] * HALVES
    axes, lever = second(angle)
    place = local if corner < 8 else flight.Elbow.hinge + lever + axes @ local
    last = np.zeros(3) if corner < 8 else np.cross(AXIS, lever + axes @ local)
    return np.concatenate([np.eye(3), -skew(place), last[:, None]], 1)


def mass_matrix(angle, shared):
    axes, lever = second(angle)
    moved = np.concatenate([np.eye(3), -skew(flight.Elbow.hinge + lever), np.cross(AXIS, lever)[:, None]], 1)
    turned = np.concatenate([np.zeros((3, 3)), np.eye(3), AXIS[:, None]], 1)
    inertia = np.diag(shared[[3, 4, 4]])
    first = np.zeros((7, 7))
    first[:3, :3], first[3:6, 3:6] = np.eye(3), inertia
    return first + moved.T @ moved + turned.T @ axes @ inertia @ axes.T @ turned


def heights(place):
    """Heights of the sixteen corners."""
    return np.concatenate([centre[0, 2] + turn.apply(tosses_of.SIGNS * HALVES)[:, 2] for centre, turn in [(c, Rotation.concatenate([t])[0]) for c, t in tosses_of.boxes("elbow", place[None, :8])]])


def carried(states, shared, times, steps):
    """States after so much flight."""
    y, h = states, (times / steps)[:, None]
    rates = flight.Elbow.rates
    for _ in range(steps):
        a = rates(y, shared)
        b = rates(y + h / 2 * a, shared)
        c = rates(y + h / 2 * b, shared)
        d = rates(y + h * c, shared)
        y = y + h / 6 * (a + 2 * b + 2 * c + d)
    y = y.copy()
    y[:, 3:7] /= np.linalg.norm(y[:, 3:7], axis=1, keepdims=True)
    return y


def whole(problem):
    """States of all frames in the data, in the table's frame."""
    numbers, tables = tosses_of.read("elbow")
    level = [Rotation.align_vectors([[0, 0, 1]], [normal])[0] for normal in problem.normal]
    rise = problem.height(EDGES)
    out = []
    for toss, table in enumerate(tables):
        turn = level[problem.block[toss]]
        places = turn.apply(table[:, 6:9])
        places[:, 2] += rise[toss]
        quaternions = (turn * flight.rotation(table[:, 2:6])).as_quat(scalar_first=True)
        out.append(np.concatenate([places, quaternions, table[:, 9:10], turn.apply(table[:, 13:16]), table[:, 10:13], table[:, 16:17]], 1))
    return numbers, out


def fitted(problem, states, moments, offset):
    """States at the first of five frames by flight, and the residuals over their noise."""
    measured = np.stack([states[toss][at + offset : at + offset + FRAMES, :8] for toss, at in moments])
    first = np.stack([states[toss][at + offset] for toss, at in moments])
    shared = problem.shared[[toss for toss, _ in moments]]
    found, _, residual, _ = flight.fit(flight.Elbow, first, measured, np.full(len(moments), FRAMES), shared, rounds=6)
    return found, np.sqrt((residual**2).sum(1) / (FRAMES * 7 - 14))


def impacts():
    """The clean impacts: see the plan."""
    problem = tosses_of.load("elbow")
    numbers, states = whole(problem)
    moments = []
    for toss, table in enumerate(states):
        low = np.array([heights(row).min() for row in table])
        for at in range(FRAMES - 1, len(table) - FRAMES):
            near = low[at - FRAMES + 1 : at + FRAMES + 1]
            inner = slice(FRAMES - 2, FRAMES + 2)
            if near[inner].min() < DIP and np.delete(near, inner).min() > CLEAR:
                moments.append((toss, at))
    before, left = fitted(problem, states, moments, 1 - FRAMES)
    after, right = fitted(problem, states, moments, 1)
    # Of moments next to each other the one with the least residuals.
    best = {}
    for row, (toss, at) in enumerate(moments):
        if max(left[row], right[row]) >= RESIDUAL:
            continue
        key = next((key for key in best if key[0] == toss and abs(key[1] - at) <= 3), (toss, at))
        if key not in best or left[row] ** 2 + right[row] ** 2 < left[best[key]] ** 2 + right[best[key]] ** 2:
            best[key] = row
    rows = [best[key] for key in sorted(best)]
    shared = problem.shared[[moments[row][0] for row in rows]]
    one = np.full(len(rows), flight.FRAME)
    last = carried(before[rows], shared, (FRAMES - 1) * one, 16)
    places = np.linspace(-0.2, 1.2, 57)
    apart = []
    for place in places:
        one_way, other_way = carried(last, shared, place * one, 2), carried(after[rows], shared, (place - 1) * one, 2)
        apart.append((flight.differences(other_way[:, None, :8], one_way[:, None, :8])[:, 0] ** 2).sum(1))
    apart = np.array(apart)
    place = places[apart.argmin(0)]
    came, went = carried(last, shared, place * one, 4), carried(after[rows], shared, (place - 1) * one, 4)
    found = []
    for k, row in enumerate(rows):
        height = heights(came[k])
        corner = int(height.argmin())
        if apart[:, k].min() >= APART or not 0 <= place[k] <= 1 or np.sort(height)[1] - height[corner] <= LOWER:
            continue
        axes, angle = flight.rotation(came[k][None, 3:7]).as_matrix()[0], came[k][7]
        speeds = [np.concatenate([axes.T @ y[8:11], y[11:]]) for y in (came[k], went[k])]
        mass, change = mass_matrix(angle, shared[k]), speeds[1] - speeds[0]
        velocity = axes @ corner_velocity(angle, corner)
        response = np.linalg.solve(mass, velocity.T)
        reduced = velocity @ response
        impulse = np.linalg.solve(reduced, velocity @ change)
        rest, energy = change - response @ impulse, change @ mass @ change
        impact = Impact(int(numbers[moments[row][0]]), velocity @ speeds[0], velocity @ speeds[1], reduced, impulse, rest @ mass @ rest / energy, energy)
        if impact.left < LEFT and impact.before[2] < -APPROACH and impulse[2] > IMPULSE:
            found.append(impact)
    return found


def coulomb(impact, mu, e, steps=200):
    """The impulse by Coulomb's law and Poisson's hypothesis, followed in small steps of the normal impulse."""
    reduced, v, impulse = impact.reduced, impact.before.copy(), np.zeros(3)
    h = -v[2] / max(reduced[2, 2] - mu * np.hypot(*reduced[:2, 2]), 0.2 * reduced[2, 2]) * 1.5 / steps
    held = np.linalg.solve(reduced[:2, :2], -reduced[:2, 2])
    size = np.hypot(*held)
    end = None
    for _ in range(20 * steps):
        speed = np.hypot(*v[:2])
        if speed > h * abs(reduced[:2]).max() / 2:
            friction = -mu * v[:2] / speed
        else:
            friction = held if size <= mu else mu * held / size
        push = np.array([*friction, 1.0])
        step = h
        if end is None and v[2] + (reduced @ push)[2] * h >= 0:
            step = -v[2] / (reduced @ push)[2]
            end = (1 + e) * (impulse[2] + step)
        elif end is not None and impulse[2] + h >= end:
            return impulse + push * (end - impulse[2])
        impulse, v = impulse + push * step, v + reduced @ push * step
    return impulse


def springs(impact, mu, e, ratio, steps=150):
    """The impulse with springs in the contact: along the tangents `ratio` times as stiff as along the normal."""
    v, impulse, stretch, depth, deepest = impact.before.copy(), np.zeros(3), np.zeros(2), 0.0, None
    h = 1.5 * np.pi / np.sqrt(impact.reduced[2, 2]) / steps
    for _ in range(40 * steps):
        depth -= v[2] * h
        if deepest is None and v[2] >= 0:
            deepest = depth
        normal = depth if deepest is None else deepest - (deepest - depth) / max(e, 1e-3) ** 2
        if normal <= 0:
            break
        stretch = stretch + v[:2] * h
        friction = -ratio * stretch
        size = np.hypot(*friction)
        if size > mu * normal:
            friction = friction * mu * normal / size
            stretch = -friction / ratio
        push = h * np.array([*friction, normal])
        impulse, v = impulse + push, v + impact.reduced @ push
    return impulse


def slower(impact, e):
    return min(0.98, e * (-impact.before[2]) ** -0.25)


LAWS = {
    "coulomb": (["mu", "e"], [0.19, 0.4], lambda i, mu, e: coulomb(i, mu, min(e, 1))),
    "speed": (["mu", "e1"], [0.19, 0.4], lambda i, mu, e: coulomb(i, mu, slower(i, e))),
    "springs": (["mu", "e1"], [0.19, 0.4], lambda i, mu, e: springs(i, mu, slower(i, e), 0.8)),
    "free springs": (["mu", "e1", "ratio"], [0.19, 0.4, 0.8], lambda i, mu, e, ratio: springs(i, mu, slower(i, e), max(ratio, 1e-2))),
}


def left(impact, impulse):
    off = impulse - impact.impulse
    return impact.left + off @ impact.reduced @ off / impact.energy


def least(impacts, law, start):
    objective = lambda x: np.mean([left(impact, law(impact, *np.abs(x))) for impact in impacts])
    return np.abs(minimize(objective, start, method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-5, "maxfev": 300}).x)


def check():
    """A puck that slides throughout: its friction is mu times the normal impulse. Stiff tangents stick like a great mu."""
    puck = Impact(0, np.array([3.0, 4.0, -1.0]), np.zeros(3), np.eye(3), np.zeros(3), 0.0, 1.0)
    expected = np.array([-0.6 * 0.2 * 1.4, -0.8 * 0.2 * 1.4, 1.4])
    assert abs(coulomb(puck, 0.2, 0.4) - expected).max() < 1e-9
    assert abs(springs(puck, 0.2, 0.4, 0.8, 4000) - expected).max() < 5e-3
    # It sticks at once, and its tangential velocity is gone.
    slow = Impact(0, np.array([0.03, 0.04, -1.0]), np.zeros(3), np.eye(3), np.zeros(3), 0.0, 1.0)
    assert abs(coulomb(slow, 0.9, 0.4) - [-0.03, -0.04, 1.4]).max() < 5e-3


def main():
    check()
    if "--check" in sys.argv:
        return
    found = impacts()
    first = [impact for impact in found if impact.toss % 2 == 0]
    constants, columns = {}, {}
    for name, (names, start, law) in LAWS.items():
        values = least(first, law, start)
        constants[name] = dict(zip(names, map(float, values)))
        columns[name] = [left(impact, law(impact, *values)) for impact in found]
        print(name, constants[name], np.mean(columns[name]), flush=True)
    names, start, law = LAWS["coulomb"]
    columns["each"] = [left(impact, law(impact, *least([impact], law, start))) for impact in found]
    (RESULTS / "elbow_impacts.json").write_text(json.dumps(constants, indent=1) + "\n")
    with open(RESULTS / "elbow_impacts.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["toss", "approach", "slip", "e", "ratio", "any impulse", *columns])
        for row, impact in enumerate(found):
            slip, ratio = np.hypot(*impact.before[:2]), np.hypot(*impact.impulse[:2]) / impact.impulse[2]
            numbers = [-impact.before[2], slip, -impact.after[2] / impact.before[2], ratio, impact.left, *(column[row] for column in columns.values())]
            writer.writerow([impact.toss, *(f"{number:.6g}" for number in numbers)])


if __name__ == "__main__":
    main()
