"""A set of tosses: split, table, flight, starts, errors. Everything here is the same for every simulator. See ../plan.md."""

import csv
import gzip
import hashlib
import io
import pickle
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

import flight

DATA = Path(__file__).parent.parent / "data"
FLIGHT_GAP = 0.006


@dataclass
class Problem:
    name: str
    numbers: np.ndarray  # of the tosses
    fitted: np.ndarray  # which are fitted; the others are judged
    block: np.ndarray  # calibration of each toss
    places: list  # per toss (frames, 7 or 8) in the table's frame: p, q, hinge
    raw: np.ndarray  # state of the first frame in the data, in the table's frame
    air: np.ndarray  # frames of flight
    rest: np.ndarray  # per toss: height of a resting centre over the zero of the data, and over the table with nominal edges
    extent: np.ndarray
    normal: np.ndarray
    scatter: list  # of the heights of resting bodies, m
    shared: np.ndarray = None  # constants of flight, per toss
    starts: np.ndarray = None
    deviations: np.ndarray = None  # standard errors of these constants; gravity of each block first
    flight_rms: float = None

    @property
    def judged(self):
        return ~self.fitted

    @property
    def body(self):
        return flight.Cube if self.name == "cube" else flight.Elbow

    def horizon(self, toss):
        return len(self.places[toss]) if self.name == "cube" else min(25, len(self.places[toss]))

    def height(self, factor):
        """What is added to z so that the table is z = 0 for bodies with edges of `factor` times the nominal: per toss."""
        return factor * self.extent - self.rest


HALVES = {"cube": np.array([0.0524] * 3), "elbow": np.array([0.05, 0.025, 0.025])}
SIGNS = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])


def boxes(name, places):
    """Centres and rotations of the boxes at places (rows, width)."""
    turn = flight.rotation(places[:, 3:7])
    found = [(places[:, :3], turn)]
    if name == "elbow":
        second = turn * Rotation.from_rotvec(places[:, 7:8] * np.array([[0.0, 1, 0]]))
        found.append((places[:, :3] + turn.apply(flight.Elbow.hinge) + second.apply([flight.Elbow.arm, 0, 0]), second))
    return found


def lowest(name, places):
    corners = SIGNS * HALVES[name]
    return np.min([centre[:, 2] + np.min([turn.apply(c)[:, 2] for c in corners], 0) for centre, turn in boxes(name, places)], 0)


def foot(last):
    """Height of the centre of the box with the lowest corner, and how far that corner is below it, with nominal edges: medians over frames.

    Each toss of the elbow was shifted so that the lowest corner of its last frame is at z = 0, in a frame that is not level.
    """
    corners = SIGNS * HALVES["elbow"]
    heights, depths = [], []
    for frame in last:
        parts = [(centre[0, 2], -min(turn.apply(c)[0, 2] for c in corners)) for centre, turn in boxes("elbow", frame[None])]
        height, depth = min(parts, key=lambda part: part[0] - part[1])
        heights.append(height)
        depths.append(depth)
    middle = int(np.argsort(np.array(heights) - depths)[len(last) // 2])
    return heights[middle], depths[middle]


def read(name):
    file = {"cube": "cube_550.csv.gz", "elbow": "elbow_360.csv.gz"}[name]
    text = gzip.decompress((DATA / file).read_bytes()).decode()
    rows = np.array([[float(cell) for cell in row] for row in list(csv.reader(io.StringIO(text)))[1:]])
    numbers = np.unique(rows[:, 0]).astype(int)
    return numbers, [rows[rows[:, 0] == number] for number in numbers]


def load(name):
    """The set, from a cache in `target` if this file, the equations of flight and the data are those of the cache."""
    sources = [Path(__file__).read_bytes(), Path(flight.__file__).read_bytes(), *(file.read_bytes() for file in sorted(DATA.glob("*.gz")))]
    cache = Path(__file__).parent.parent / "target" / f"{name}_{hashlib.sha256(b''.join(sources)).hexdigest()[:16]}.pickle"
    if cache.exists():
        return pickle.loads(cache.read_bytes())
    problem = prepare(name)
    cache.parent.mkdir(exist_ok=True)
    cache.write_bytes(pickle.dumps(problem))
    return problem


def prepare(name):
    numbers, tables = read(name)
    fitted = np.arange(len(numbers)) % 10 == 0
    block = (numbers > 320).astype(int) if name == "elbow" else np.zeros(len(numbers), int)
    world, velocities = [], []
    for table in tables:
        q = table[:, 2:6] / np.linalg.norm(table[:, 2:6], axis=1, keepdims=True)
        world.append(np.concatenate([table[:, 6:9], q] + ([table[:, 9:10]] if name == "elbow" else []), 1))
        velocities.append(np.concatenate([table[:, 12:15], table[:, 9:12]], 1) if name == "cube" else np.concatenate([table[:, 13:16], table[:, 10:13], table[:, 16:17]], 1))
    # The table, from fitted tosses that end at rest: normals first, then heights along them.
    count = block.max() + 1
    normals, heights, extents = [[] for _ in range(count)], [[] for _ in range(count)], [[] for _ in range(count)]
    for toss in np.flatnonzero(fitted):
        last = world[toss][-10:]
        turned = (flight.rotation(last[:1, 3:7]).inv() * flight.rotation(last[:, 3:7])).magnitude()
        hinge = np.ptp(np.unwrap(last[:, 7])) if name == "elbow" else 0.0
        if np.ptp(last[:, :3], axis=0).max() > 5e-4 or turned.max() > 5e-3 or hinge > 5e-3:
            continue
        for centre, turn in boxes(name, last):
            axes = turn.as_matrix()[:, 2, :].mean(0)
            axis = np.argmax(np.abs(axes))
            up = turn.as_matrix()[:, :, axis].mean(0) * np.sign(axes[axis])
            # A box that leans on an edge or on the other box shows no normal.
            if up[2] < np.cos(np.radians(6)):
                continue
            normals[block[toss]].append(up / np.linalg.norm(up))
            heights[block[toss]].append(centre.mean(0))
            extents[block[toss]].append(HALVES[name][axis])
    normal = np.array([np.mean(n, 0) / np.linalg.norm(np.mean(n, 0)) for n in normals])
    rest = np.array([np.mean(np.array(h) @ n) for h, n in zip(heights, normal)])[block]
    extent = np.array([np.mean(e) for e in extents])[block]
    scatter = [float(np.std(np.array(h) @ n)) for h, n in zip(heights, normal)]
    level = [Rotation.align_vectors([[0, 0, 1]], [n])[0] for n in normal]
    places, raw = [], []
    for toss, table in enumerate(world):
        turn = level[block[toss]]
        q = (turn * flight.rotation(table[:, 3:7])).as_quat(scalar_first=True)
        places.append(np.concatenate([turn.apply(table[:, :3]), q, table[:, 7:]], 1))
        speeds = velocities[toss].copy()
        speeds[:, :3] = turn.apply(speeds[:, :3])
        raw.append(np.concatenate([places[-1], speeds], 1))
    if name == "elbow":
        for toss, table in enumerate(places):
            rest[toss], extent[toss] = foot(table[-15:])
    problem = Problem(name, numbers, fitted, block, places, None, None, rest, extent, normal, scatter)
    # Flight, with nominal edges.
    air = []
    for toss, table in enumerate(places):
        near = np.flatnonzero(lowest(name, table) + problem.height(1.0)[toss] < FLIGHT_GAP)
        air.append(near[0] if len(near) else len(table))
    problem.air = np.array(air)
    body, size = problem.body, len(problem.body.names)
    # Constants of flight: all frames of flight of the cube; the last sixteen of the elbow, which some hands held before.
    use = np.flatnonzero(fitted & (problem.air >= 3))
    began = np.maximum(0, problem.air - 16) if name == "elbow" else 0 * problem.air
    shared = np.tile(body.start, (len(numbers), 1)).astype(float)
    groups = lambda use: np.array([[k if k >= 3 else 3 * block[toss] + k for k in range(3)] + list(3 * count + np.arange(size - 3)) for toss in use])
    for last in (False, True):
        measured, first, frames = cut(problem, raw, use, began)
        first = flight.fit(body, first, measured, frames, shared[use], rounds=3)[0]
        _, found, residual, deviations = flight.fit(body, first, measured, frames, shared[use], groups(use), rounds=6)
        for toss in range(len(numbers)):
            shared[toss] = found[np.flatnonzero(block[use] == block[toss])[0]]
        rms = np.sqrt((residual**2).sum(1) / frames / (problem.body.width - 1))
        if name == "cube" or last:
            break
        # Where a hand still held it, or the hinge struck its end.
        use = use[rms < 2 * np.median(rms)]
    freedom = frames.sum() * (body.width - 1) - residual.shape[0] * first.shape[1] - deviations.size
    problem.flight_rms, problem.flight_tosses = float(np.sqrt((residual**2).sum() / freedom)), len(use)
    problem.shared, problem.deviations = shared, deviations
    # Starts. The elbow starts three frames before the end of flight; its state is fitted to the last eight frames of flight.
    problem.window = np.maximum(0, problem.air - 8) if name == "elbow" else 0 * problem.air
    problem.raw = np.array([table[k] for table, k in zip(raw, problem.window)])
    problem.places = [table[k:] for table, k in zip(problem.places, problem.window)]
    problem.air = problem.air - problem.window
    problem.starts = start(problem)
    if name == "elbow":
        problem.lead = np.maximum(0, problem.air - 3)
        states = problem.starts.copy()
        for toss, lead in enumerate(problem.lead):
            if lead:
                states[toss] = at(problem, states[toss], problem.shared[toss], lead)
        problem.starts = states
        problem.places = [table[k:] for table, k in zip(problem.places, problem.lead)]
        problem.air = problem.air - problem.lead
    return problem


def at(problem, state, shared, frame):
    """The state of the elbow after so many frames of flight."""
    y = np.concatenate([state[:8], state[8:]])[None]
    h = flight.FRAME / 8
    rates = problem.body.rates
    for _ in range(8 * frame):
        a = rates(y, shared[None])
        b = rates(y + h / 2 * a, shared[None])
        c = rates(y + h / 2 * b, shared[None])
        d = rates(y + h * c, shared[None])
        y = y + h / 6 * (a + 2 * b + 2 * c + d)
    y[:, 3:7] /= np.linalg.norm(y[:, 3:7])
    return y[0]


def padded(tables, longest):
    return np.stack([np.pad(table[:longest], ((0, max(0, longest - len(table))), (0, 0)), "edge") for table in tables])


def cut(problem, raw, use, began):
    """Places in flight, first states and numbers of frames of some tosses."""
    frames = problem.air[use] - began[use]
    measured = padded([problem.places[toss][began[toss] :] for toss in use], frames.max())
    return measured, np.array([raw[toss][began[toss]] for toss in use]), frames


def start(problem):
    """States at the first frame: by flight, or as the data have them if there are fewer than three frames of it."""
    states = problem.raw.copy()
    use = np.flatnonzero(problem.air >= 3)
    measured = padded([problem.places[toss] for toss in use], problem.air[use].max())
    states[use] = flight.fit(problem.body, problem.raw[use], measured, problem.air[use], problem.shared[use], rounds=5)[0]
    return states


def errors(problem, toss, predicted):
    """Error of every frame of one prediction, which may end early: then nothing moves any more."""
    count = problem.horizon(toss)
    if len(predicted) < count:
        predicted = np.concatenate([predicted, np.repeat(predicted[-1:], count - len(predicted), 0)])
    measured = problem.places[toss][:count]
    predicted = predicted[:count]
    apart = ((predicted[:, :3] - measured[:, :3]) ** 2).sum(1)
    angle = (flight.rotation(measured[:, 3:7]).inv() * flight.rotation(predicted[:, 3:7])).magnitude()
    if problem.name == "cube":
        return apart / 0.0524 + angle**2
    return apart / 0.05 + angle**2 + flight.wrapped(predicted[:, 7] - measured[:, 7]) ** 2


def face(place):
    """Which axis of the body points up, with its sign: 0 to 5."""
    row = flight.rotation(place[3:7]).as_matrix()[2]
    axis = int(np.argmax(np.abs(row)))
    return 2 * axis + int(row[axis] > 0)
