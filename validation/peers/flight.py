"""Flight without any simulator: its equations, and least squares of states and shared constants by them.

A state is (p, q, v, w[, hinge, hinge rate]): position of the (first) body's geometric centre, m; quaternion w x y z; velocity of
that centre, m/s, in the table's frame; angular velocity, rad/s, in the body's axes.
"""

import numpy as np
from scipy.spatial.transform import Rotation

FRAME = 1 / 148
NOISE_POSITION, NOISE_ANGLE, NOISE_HINGE = 1e-4, 1.3e-3, 2.5e-3


def rotation(quaternion):
    # What overflowed is no rotation, and counts as a worse fit.
    usable = np.isfinite(quaternion).all(-1, keepdims=True) & ((quaternion**2).sum(-1, keepdims=True) > 1e-9)
    return Rotation.from_quat(np.where(usable, quaternion, [1.0, 0, 0, 0]), scalar_first=True)


def wrapped(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


class Cube:
    """Equal moments of inertia: the angular velocity is constant, and the centre of mass moves on a parabola."""

    width, speeds = 7, slice(7, 13)
    names = ["gx", "gy", "gz", "cx", "cy", "cz"]
    start = np.array([0, 0, -9.81, 0, 0, 0])

    @staticmethod
    def possible(shared):
        return True

    @staticmethod
    def flight(states, shared, frames):
        """Places (rows, frames, 7) from states (rows, 13) and shared constants (rows, 6)."""
        t = np.arange(frames) * FRAME
        g, c = shared[:, :3], shared[:, 3:]
        p, turn, v, w = states[:, :3], rotation(states[:, 3:7]), states[:, 7:10], states[:, 10:13]
        centre, speed = p + turn.apply(c), v + turn.apply(np.cross(w, c))
        out = np.empty((len(states), frames, 7))
        for k, time in enumerate(t):
            now = turn * Rotation.from_rotvec(w * time)
            out[:, k, :3] = centre + speed * time + g * time**2 / 2 - now.apply(c)
            out[:, k, 3:] = now.as_quat(scalar_first=True)
        return out


class Elbow:
    """Two boxes and a hinge along y: Newton and Euler, projected on the eight (seven) speeds, by steps of Runge and Kutta."""

    width, speeds = 8, slice(8, 15)
    # Two equal boxes, with equal moments about the axes of their square section. Moments of inertia about the long axis and the others
    # over the mass of a box, m^2; damping over that mass.
    names = ["gx", "gy", "gz", "J along", "J across", "damping"]
    start = np.array([0, 0, -9.81, 0.05**2 / 6, 0.0125 / 12, 0.0])
    hinge, arm = np.array([-0.035, 0.06, 0.0]), 0.035
    steps = 1

    @staticmethod
    def possible(shared):
        return shared[:, 3:5].min() > 0

    @classmethod
    def rates(cls, y, shared):
        """y: p, q, hinge, v, w, hinge rate."""
        rows = len(y)
        turn = rotation(y[:, 3:7]).as_matrix()
        angle, v, w, rate = y[:, 7], y[:, 8:11], y[:, 11:14], y[:, 14]
        sine, cosine, zero, one = np.sin(angle), np.cos(angle), np.zeros(rows), np.ones(rows)
        # the second box in the first
        between = np.stack([np.stack([cosine, zero, sine], -1), np.stack([zero, one, zero], -1), np.stack([-sine, zero, cosine], -1)], -2)
        axis = np.array([0.0, 1, 0])
        lever = between @ np.array([cls.arm, 0, 0])
        r = cls.hinge + lever
        w2 = w + rate[:, None] * axis
        skew = lambda a: np.stack([np.stack([0 * a[:, 0], -a[:, 2], a[:, 1]], -1), np.stack([a[:, 2], 0 * a[:, 0], -a[:, 0]], -1), np.stack([-a[:, 1], a[:, 0], 0 * a[:, 0]], -1)], -2)
        # velocity of the second centre and rotation of the second box over (v, w, rate); v in the first box's axes here
        J2 = np.zeros((rows, 3, 7))
        J2[:, :, :3] = np.eye(3)
        J2[:, :, 3:6] = -skew(r)
        J2[:, :, 6] = np.cross(axis, lever)
        W2 = np.zeros((rows, 3, 7))
        W2[:, :, 3:6] = np.eye(3)
        W2[:, :, 6] = axis
        ratio, moments, damping = one, shared[:, [3, 4, 4]], shared[:, 5]
        I1 = np.eye(3) * moments[:, None, :]
        I2 = ratio[:, None, None] * between @ I1 @ between.transpose(0, 2, 1)
        M = np.zeros((rows, 7, 7))
        M[:, :3, :3] = np.eye(3)
        M[:, 3:6, 3:6] = I1
        M += ratio[:, None, None] * J2.transpose(0, 2, 1) @ J2 + W2.transpose(0, 2, 1) @ I2 @ W2
        g = np.einsum("nji,nj->ni", turn, shared[:, :3])
        of = lambda matrix, vector: np.einsum("nij,nj->ni", matrix, vector)
        # accelerations without those of the speeds; v' is that of the velocity in inertial axes, seen in the first box's
        lever_rate = np.cross(w2, lever)
        turning = rate[:, None] * np.cross(w, axis)  # rate of w2 in inertial axes, but for w' and the rate's
        a2 = np.cross(w, np.cross(w, np.broadcast_to(cls.hinge, w.shape))) + np.cross(turning, lever) + np.cross(w2, lever_rate)
        force = np.zeros((rows, 7))
        force[:, :3] = g
        force[:, 3:6] = -np.cross(w, of(I1, w))
        force += of(J2.transpose(0, 2, 1), ratio[:, None] * (g - a2))
        force += of(W2.transpose(0, 2, 1), -of(I2, turning) - np.cross(w2, of(I2, w2)))
        force[:, 6] -= damping * rate
        acceleration = np.linalg.solve(M, force[:, :, None])[:, :, 0]
        out = np.empty_like(y)
        out[:, :3] = v
        q0, q = y[:, 3], y[:, 4:7]
        out[:, 3] = -np.sum(q * w, 1) / 2
        out[:, 4:7] = (q0[:, None] * w + np.cross(q, w)) / 2
        out[:, 7] = rate
        out[:, 8:11] = of(turn, acceleration[:, :3])
        out[:, 11:] = acceleration[:, 3:]
        return out

    @classmethod
    def flight(cls, states, shared, frames):
        out = np.empty((len(states), frames, 8))
        y = states.copy()
        h = FRAME / cls.steps
        for k in range(frames):
            if k:
                for _ in range(cls.steps):
                    a = cls.rates(y, shared)
                    b = cls.rates(y + h / 2 * a, shared)
                    c = cls.rates(y + h / 2 * b, shared)
                    d = cls.rates(y + h * c, shared)
                    y = y + h / 6 * (a + 2 * b + 2 * c + d)
                    y[:, 3:7] /= np.linalg.norm(y[:, 3:7], axis=1, keepdims=True)
            out[:, k] = y[:, :8]
        return out


def moved(states, change, width):
    """States after a small change: of p, of the rotation (rad, body axes), of the rest."""
    out = states.copy()
    out[:, :3] += change[:, :3]
    out[:, 3:7] = (rotation(states[:, 3:7]) * Rotation.from_rotvec(change[:, 3:6])).as_quat(scalar_first=True)
    out[:, 7:] += change[:, 6:]
    return out


def differences(places, measured):
    """Differences over their noise: (rows, frames, 6 or 7)."""
    turn = (rotation(measured[..., 3:7].reshape(-1, 4)).inv() * rotation(places[..., 3:7].reshape(-1, 4))).as_rotvec()
    parts = [(places[..., :3] - measured[..., :3]) / NOISE_POSITION, turn.reshape(*places.shape[:-1], 3) / NOISE_ANGLE]
    if places.shape[-1] == 8:
        parts.append(wrapped(places[..., 7:] - measured[..., 7:]) / NOISE_HINGE)
    return np.concatenate(parts, -1)


def fit(body, first, measured, frames, shared, groups=None, rounds=8):
    """States at frame 0 by Gauss and Newton, and the shared constants with them if `groups` says which of all belong to which row.

    first: (rows, state) guesses; measured: (rows, longest, width), frames: the number of frames of each; shared: (rows, s).
    groups: None, or a matrix (rows, s) of indices into one vector of all shared constants.
    """
    states, shared = first.copy(), shared.copy()
    rows, n = states.shape[0], states.shape[1] - 1
    most = int(frames.max())
    measured = measured[:, :most]
    weight = (np.arange(most)[None] < frames[:, None]).astype(float)[:, :, None]
    measured = np.where(weight[..., None] > 0, measured[:, :, None], measured[:, :1, None])[:, :, 0]
    residual = lambda s, c: (differences(body.flight(s, c, most), measured) * weight).reshape(rows, -1)
    with np.errstate(all="ignore"):
        for _ in range(rounds):
            r = residual(states, shared)
            cost = (r**2).sum(1)
            local = np.empty((rows, r.shape[1], n))
            steps = np.repeat(1e-6 * np.eye(n), rows, 0)
            many = (differences(body.flight(moved(np.tile(states, (n, 1)), steps, body.width), np.tile(shared, (n, 1)), most), np.tile(measured, (n, 1, 1))) * np.tile(weight, (n, 1, 1))).reshape(n, rows, -1)
            for k in range(n):
                local[:, :, k] = (many[k] - r) / 1e-6
            if groups is None:
                change = np.stack([-np.linalg.lstsq(a, b, rcond=None)[0] for a, b in zip(local, r)])
                size = np.ones(rows)
                for _ in range(8):
                    trial = moved(states, size[:, None] * change, body.width)
                    worse = ~((residual(trial, shared) ** 2).sum(1) <= cost)
                    if not worse.any():
                        break
                    size[worse] /= 4
                size[worse] = 0
                states = moved(states, size[:, None] * change, body.width)
                continue
            s = shared.shape[1]
            common = np.empty((rows, r.shape[1], s))
            for k in range(s):
                step = shared.copy()
                size = 1e-6 * max(1e-2, abs(shared[:, k]).max())
                step[:, k] += size
                common[:, :, k] = (residual(states, step) - r) / size
            count = int(groups.max()) + 1
            normal, right = np.zeros((count, count)), np.zeros(count)
            for row in range(rows):
                q, _ = np.linalg.qr(local[row])
                rest = common[row] - q @ (q.T @ common[row])
                index = groups[row]
                normal[np.ix_(index, index)] += rest.T @ rest
                right[index] -= rest.T @ (r[row] - q @ (q.T @ r[row]))
            scale = 1 / np.sqrt(np.diag(normal))
            step = scale * np.linalg.solve(normal * np.outer(scale, scale), right * scale)
            deviations = scale * np.sqrt(np.diag(np.linalg.inv(normal * np.outer(scale, scale))))
            change = np.stack([-np.linalg.lstsq(local[row], r[row] + common[row] @ step[groups[row]], rcond=None)[0] for row in range(rows)])
            size = 1.0
            while size > 1e-3:
                trial = moved(states, size * change, body.width), shared + size * step[groups]
                if body.possible(trial[1]) and (residual(*trial) ** 2).sum() <= cost.sum():
                    states, shared = trial
                    break
                size /= 2
    return states, shared, residual(states, shared), (deviations if groups is not None else None)
