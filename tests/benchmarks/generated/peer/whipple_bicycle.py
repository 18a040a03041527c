"""Writes the C code of the bicycle's 3 x 3 mass matrix with CasADi: partial velocities of all bodies for lean rate, spin of the rear wheel and steering rate, after
the three constraints of the front wheel are solved. Vectors along the axes of the leaned frame R; the numbers of the model are folded in.

Argument: folder. Coordinates in the order of their names: q1 (yaw, which does not enter), q2 (lean), q4 (pitch), q5 (steer).
"""

import sys
from math import cos, pi, sin

from casadi import SX, sqrt
from vectors import add, apply, cross, dense, lower, dot, product, reciprocal, sub, times, transposed, vector, write

ANGLE = 2 * pi / 5


def turned_inertia(xx, yy, zz, zx):
    """An inertia given in axes turned back by the angle of the steering axis about y, in the axes before."""
    c, s = cos(-ANGLE), sin(-ANGLE)
    turn = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    own = [[xx, 0, zx], [0, yy, 0], [zx, 0, zz]]
    return [vector(row) for row in product(product(turn, own), transposed(turn))]


def diagonal(xx, yy, zz):
    return [vector([xx, 0, 0]), vector([0, yy, 0]), vector([0, 0, zz])]


def inverse_times(matrix, right):
    """The solutions of a 3 x 3 system for several right sides, by cofactors and one division."""
    a, b, c = transposed(matrix)
    cofactors = [cross(b, c), cross(c, a), cross(a, b)]
    factor = reciprocal(dot(a, cofactors[0]))
    return [[factor * dot(row, side) for row in cofactors] for side in right]


def mass_matrix(s, c):
    """Sines and cosines of lean, pitch of Frame, steer."""
    unit = [vector(row) for row in ([1, 0, 0], [0, 1, 0], [0, 0, 1])]
    vertical = [SX(0), s[0], c[0]]
    frame = [[c[1], SX(0), -s[1]], unit[1], [s[1], SX(0), c[1]]]
    y, z = frame[1], frame[2]
    fork = [frame[0], add(times(c[2], y), times(s[2], z)), sub(times(c[2], z), times(s[2], y))]

    def along(axes, x, y, z):
        parts = [times(SX(f), axis) for f, axis in zip((x, y, z), axes) if f != 0]
        return parts[0] if len(parts) == 1 else add(*parts)

    none = vector([0, 0, 0])
    # partial angular velocities for u1 .. u6
    of_frame = [vertical, unit[0], none, unit[1], none, none]
    rear = of_frame[:2] + [unit[1], unit[1], none, none]
    of_fork = of_frame[:4] + [frame[0], none]
    front = of_fork[:5] + [fork[1]]

    def moved(velocities, turns, arm):
        return [add(v, cross(w, arm)) for v, w in zip(velocities, turns)]

    rear_centre = moved([none] * 6, rear, times(SX(0.3), unit[2]))
    frame_centre = moved(rear_centre, of_frame, along(frame, -0.47792881146460797, 0, 0.4707271515135146))
    steer = moved(rear_centre, of_frame, along(frame, 0, 0, 0.9534570696121847))
    fork_centre = moved(steer, of_fork, along(fork, -0.10230731158060874, 0, 0.026100592803432465))
    front_centre = moved(steer, of_fork, along(fork, 0.2676445084476887, 0, 0.03207142672761931))
    height = dot(fork[1], vertical)
    down = sub(times(height, fork[1]), vertical)
    touching = times(0.35 * reciprocal(sqrt(1 - height * height)), down)
    contact = moved(front_centre, front, touching)

    dependent, independent = (0, 3, 5), (1, 2, 4)
    columns = [contact[k] for k in dependent]
    solved = inverse_times(transposed(columns), [contact[k] for k in independent])

    def projected(partials):
        """For the independent speeds alone."""
        return [
            sub(partials[k], add(*(times(x, partials[d]) for x, d in zip(part, dependent))))
            for k, part in zip(independent, solved)
        ]

    def in_axes(axes, vectors):
        return [[dot(axis, v) for axis in axes] for v in vectors]

    bodies = [
        (85.0, frame_centre, in_axes(frame, projected(of_frame)), turned_inertia(9.2, 11, 2.8, -2.4)),
        (4.0, fork_centre, in_axes(fork, projected(of_fork)), turned_inertia(0.05892, 0.06, 0.00708, 0.00756)),
        (3.0, front_centre, in_axes(fork, projected(front)), diagonal(0.1405, 0.28, 0.1405)),
        (2.0, rear_centre, in_axes(frame, projected(rear)), diagonal(0.0603, 0.12, 0.0603)),
    ]
    m = [[SX(0)] * 3 for _ in range(3)]
    for mass, velocities, turns, inertia in bodies:
        velocities = projected(velocities)
        spins = [apply(inertia, w) for w in turns]
        for i in range(3):
            for k in range(i, 3):
                m[i][k] = m[i][k] + mass * dot(velocities[i], velocities[k]) + dot(turns[i], spins[k])
    return [[m[min(i, k)][max(i, k)] for k in range(3)] for i in range(3)]


def main(folder):
    q, u, x = SX.sym("q", 4), SX.sym("u", 3), SX.sym("x", 3)
    sines, cosines = SX.sym("s", 3), SX.sym("c", 3)
    s, c = ([symbols[k] for k in range(3)] for symbols in (sines, cosines))
    angles = ["q[1]", f"q[2] + {ANGLE!r}", "q[3]"]
    write(folder, [q, sines, cosines, u, x], {"m": lambda: dense(mass_matrix(s, c)), "ml": lambda: lower(mass_matrix(s, c))}, lambda _: angles)


main(*sys.argv[1:])
