"""Writes the C code of a robot's dynamics with CasADi: what the generated routines are timed against.

The recursions of Featherstone's *Rigid Body Dynamics Algorithms* (2008), in axes of the bodies: composite bodies for the mass matrix, Newton-Euler for
inverse dynamics, articulated bodies and the factor of the mass matrix for forward dynamics (both are written; the caller counts), the factor for contact
matrices. Derivatives are those of the inverse dynamics, solved with the factor. For planar chains the mass matrix is also written with absolute angles. All parameters are numbers; `casadi.cse` shares what is common.

Arguments: URDF, `fixed` or `floating`, folder. Each routine becomes a function of (q, sines, cosines, u, x), where x is the forces or accelerations;
coordinates and speeds in Pinocchio's order and conventions.
"""

import sys

import numpy as np
import pinocchio
from casadi import SX, jtimes, substitute, vertcat
from vectors import add, apply, cholesky, clean, cross, dense, dot, lower, product, reciprocal, skew, sub, symmetric, times, transposed, vector, write

GRAVITY = 9.80665


class Joint:
    """How a body stands on its parent: a constant placement, then a turn about a coordinate axis or a shift along it."""

    def __init__(self, model, index):
        placement = model.jointPlacements[index]
        self.base = [vector(row) for row in clean(placement.rotation)]
        self.offset = vector(clean(placement.translation))
        name = model.joints[index].shortname()
        self.axis = "XYZ".index(name[-1])
        self.turns = name.startswith("JointModelR")
        assert name[:-1] in ("JointModelR", "JointModelP"), name
        self.number = model.joints[index].idx_v
        self.q = model.joints[index].idx_q
        self.parent = model.parents[index]

    def set(self, q, sine, cosine):
        """The values that it takes."""
        self.sine, self.cosine = sine, cosine
        if not self.turns:
            along = [self.base[row][self.axis] * q for row in range(3)]
            self.offset = add(self.offset, along)

    def turned(self, a, sign=1):
        """From the axes after the turn to those before it; with sign -1 back."""
        if not self.turns:
            return a
        j, k = (self.axis + 1) % 3, (self.axis + 2) % 3
        found = list(a)
        found[j] = self.cosine * a[j] - sign * self.sine * a[k]
        found[k] = sign * self.sine * a[j] + self.cosine * a[k]
        return found

    def up(self, a):
        """A vector in the parent's axes."""
        return apply(self.base, self.turned(a))

    def down(self, a):
        """A vector of the parent in the body's axes."""
        return self.turned(apply(transposed(self.base), a), -1)

    def up_symmetric(self, a):
        """A symmetric matrix in the parent's axes: five products where the plain way takes twelve."""
        if self.turns:
            i, j, k = self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3
            s, c = self.sine, self.cosine
            h = s * (a[j][j] - a[k][k]) + 2 * (c * a[j][k])
            b = [[None] * 3 for _ in range(3)]
            b[i][i] = a[i][i]
            b[j][j], b[k][k] = a[j][j] - s * h, a[k][k] + s * h
            b[j][k] = b[k][j] = c * h - a[j][k]
            b[i][j] = b[j][i] = c * a[i][j] - s * a[i][k]
            b[i][k] = b[k][i] = s * a[i][j] + c * a[i][k]
            a = b
        half = product(self.base, a)
        return symmetric(lambda i, j: dot(half[i], self.base[j]))

    def up_matrix(self, a):
        """Any matrix in the parent's axes."""
        rows = [self.turned(row) for row in a]
        columns = transposed([self.turned(column) for column in transposed(rows)])
        return product(product(self.base, columns), transposed(self.base))

    def shift(self):
        """The offset, where forces and moments change their point."""
        return self.offset


class Robot:
    """The recursions. Body 0 of a floating robot is its base."""

    def __init__(self, path, floating):
        arguments = [str(path)] + ([pinocchio.JointModelFreeFlyer()] if floating else [])
        model = pinocchio.buildModelFromUrdf(*arguments)
        self.floating = floating
        first = 2 if floating else 1
        self.joints = {i: Joint(model, i) for i in range(first, model.njoints)}
        self.count = model.nv
        self.q, self.u, self.x = SX.sym("q", model.nq), SX.sym("u", model.nv), SX.sym("x", model.nv)
        turning = [joint for joint in self.joints.values() if joint.turns]
        self.angles = [joint.q for joint in turning]
        self.sines, self.cosines = SX.sym("s", max(1, len(turning))), SX.sym("c", max(1, len(turning)))
        for joint in self.joints.values():
            place = turning.index(joint) if joint.turns else None
            sine, cosine = (None, None) if place is None else (self.sines[place], self.cosines[place])
            joint.set(self.q[joint.q], sine, cosine)
        bodies = ([1] if floating else []) + list(self.joints)
        self.bodies = {}
        for i in bodies:
            inertia = model.inertias[i]
            about_joint = inertia.inertia - inertia.mass * pinocchio.skew(inertia.lever) @ pinocchio.skew(inertia.lever)
            moment = vector(inertia.mass * inertia.lever)
            self.bodies[i] = (SX(inertia.mass), moment, [vector(row) for row in about_joint])
        self.children = {i: [k for k in self.joints if self.joints[k].parent == i] for i in [0, *bodies]}
        self.base = bodies[0] if floating else None
        frame = model.frames[model.getFrameId("ee")]
        self.tip, self.tip_place = frame.parentJoint, vector(clean(frame.placement.translation))
        self.model = model

    def attitude(self):
        x, y, z, w = (self.q[k] for k in range(3, 7))
        return [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]

    def unit(self, i):
        return vector(np.eye(3)[self.joints[i].axis])

    def twist(self, i, value):
        """(angular, linear) part that a joint adds."""
        along, zero = times(value, self.unit(i)), vector([0, 0, 0])
        return (along, zero) if self.joints[i].turns else (zero, along)

    def composite(self):
        """Mass, first moment and inertia of each body with all that it carries, about its joint."""
        found = dict(self.bodies)
        for i in reversed(self.joints):
            joint = self.joints[i]
            if joint.parent not in found:
                continue
            mass, moment, inertia = found[i]
            turned, at = joint.up(moment), joint.offset
            rotated = joint.up_symmetric(inertia)
            # -[p][h] - [h][p] - m [p][p], with k = h + m p / 2
            k = add(turned, times(mass / 2, at))
            product = dot(at, k)
            moved = symmetric(
                lambda a, b: rotated[a][b] - (at[a] * k[b] + k[a] * at[b]) + (2 * product if a == b else 0)
            )
            above = found[joint.parent]
            found[joint.parent] = (
                above[0] + mass,
                add(above[1], turned, times(mass, at)),
                [[x + y for x, y in zip(*rows)] for rows in zip(above[2], moved)],
            )
        return found

    def mass_matrix(self):
        found = self.composite()
        m = [[SX(0)] * self.count for _ in range(self.count)]
        for i in reversed(self.joints):
            joint = self.joints[i]
            mass, moment, inertia = found[i]
            if joint.turns:
                force, couple = cross(self.unit(i), moment), [row[joint.axis] for row in inertia]
            else:
                force, couple = times(mass, self.unit(i)), cross(moment, self.unit(i))
            m[joint.number][joint.number] = (couple if joint.turns else force)[joint.axis]
            below = i
            while True:
                way = self.joints[below]
                force = way.up(force)
                couple = add(way.up(couple), cross(way.offset, force))
                below = way.parent
                if below not in self.joints:
                    break
                above = self.joints[below]
                entry = (couple if above.turns else force)[above.axis]
                m[joint.number][above.number] = m[above.number][joint.number] = entry
            if below == self.base:
                for axis in range(3):
                    m[axis][joint.number] = m[joint.number][axis] = force[axis]
                    m[3 + axis][joint.number] = m[joint.number][3 + axis] = couple[axis]
        if self.floating:
            mass, moment, inertia = found[self.base]
            coupling = skew(moment)
            for a in range(3):
                m[a][a] = mass
                for b in range(3):
                    m[3 + a][b] = m[b][3 + a] = coupling[a][b]
                    m[3 + a][3 + b] = inertia[a][b]
        return m

    def newton_euler(self, accelerations):
        """Forces for accelerations (zero: what u and gravity take)."""
        zero = vector([0, 0, 0])
        omega, alpha, a = {0: zero}, {0: zero}, {0: vector([0, 0, GRAVITY])}
        if self.floating:
            v = [self.u[k] for k in range(6)]
            attitude = self.attitude()
            omega[self.base] = v[3:]
            alpha[self.base] = [accelerations[k] for k in range(3, 6)]
            lift = times(SX(GRAVITY), attitude[2])
            a[self.base] = add([accelerations[k] for k in range(3)], cross(v[3:], v[:3]), lift)
        force, couple = {}, {}

        def spread(i):
            w, s = omega[i], alpha[i]
            square = [w[0] * w[0], w[1] * w[1], w[2] * w[2]]
            xy, yz, zx = w[0] * w[1], w[1] * w[2], w[2] * w[0]
            return [
                [-(square[1] + square[2]), xy - s[2], zx + s[1]],
                [xy + s[2], -(square[0] + square[2]), yz - s[0]],
                [zx - s[1], yz + s[0], -(square[0] + square[1])],
            ]

        spreads = {i: spread(i) for i in omega}

        def inertial(i):
            mass, moment, inertia = self.bodies[i]
            force[i] = add(times(mass, a[i]), apply(spreads[i], moment))
            spin = apply(inertia, omega[i])
            couple[i] = add(apply(inertia, alpha[i]), cross(omega[i], spin), cross(moment, a[i]))

        if self.floating:
            inertial(self.base)
        for i, joint in self.joints.items():
            up = joint.parent
            value, rate = self.u[joint.number], accelerations[joint.number]
            turned = joint.down(omega[up])
            origin = joint.down(add(a[up], apply(spreads[up], joint.offset)))
            unit = self.unit(i)
            if joint.turns:
                turn = times(value, unit)
                omega[i] = add(turned, turn)
                alpha[i] = add(joint.down(alpha[up]), cross(turned, turn), times(rate, unit))
                a[i] = origin
            else:
                omega[i], alpha[i] = turned, joint.down(alpha[up])
                a[i] = add(origin, times(2 * value, cross(turned, unit)), times(rate, unit))
            spreads[i] = spread(i)
            inertial(i)
        found = [SX(0)] * self.count
        for i in reversed(self.joints):
            joint = self.joints[i]
            found[joint.number] = (couple if joint.turns else force)[i][joint.axis]
            if joint.parent in self.bodies:
                lifted = joint.up(force[i])
                force[joint.parent] = add(force[joint.parent], lifted)
                couple[joint.parent] = add(couple[joint.parent], joint.up(couple[i]), cross(joint.offset, lifted))
        if self.floating:
            found[:6] = [*force[self.base], *couple[self.base]]
        return found

    def ancestors(self):
        """The speed above each speed in the tree; -1: none."""
        above = [-1] * self.count
        if self.floating:
            above[1:6] = range(5)
        for joint in self.joints.values():
            up = joint.parent
            if up in self.joints:
                above[joint.number] = self.joints[up].number
            elif up == self.base:
                above[joint.number] = 5
        return above

    def factor(self, m):
        """M = L^T D L by the tree (Featherstone, table 6.3): L, and the inverse of D."""
        above, h = self.ancestors(), [list(row) for row in m]
        inverse = [None] * self.count
        for k in reversed(range(self.count)):
            inverse[k] = reciprocal(h[k][k])
            i = above[k]
            while i >= 0:
                part = h[k][i] * inverse[k]
                j = i
                while j >= 0:
                    h[i][j] = h[i][j] - part * h[k][j]
                    j = above[j]
                h[k][i] = part
                i = above[i]
        return h, inverse, above

    def by_factor(self):
        """Accelerations by the mass matrix and its factor."""
        factor, inverse, above = self.factor(self.mass_matrix())
        return self.solve(factor, inverse, above, sub([self.x[k] for k in range(self.count)], self.newton_euler([SX(0)] * self.count)))

    def solve(self, factor, inverse, above, x):
        """M^-1 x"""
        x = list(x)
        for k in reversed(range(self.count)):
            i = above[k]
            while i >= 0:
                x[i] = x[i] - factor[k][i] * x[k]
                i = above[i]
        x = [a * b for a, b in zip(x, inverse)]
        for k in range(self.count):
            i = above[k]
            while i >= 0:
                x[k] = x[k] - factor[k][i] * x[i]
                i = above[i]
        return x

    def derivatives(self, backward):
        """Accelerations, then their derivatives by all coordinates and by all speeds (by columns): those of the inverse dynamics, solved with the factor.

        They are found forward, one sweep for each column, or backward, one for each row.
        """
        a = self.by_factor()
        found = vertcat(*self.newton_euler([self.x[k] for k in range(self.count)]))
        given = vertcat(self.q, self.sines, self.cosines, self.u)
        size, places = self.q.numel(), self.sines.numel()
        # how what is given changes with coordinates and speeds
        along = SX(given.numel(), size + self.count)
        for k in range(size):
            along[k, k] = 1
        for place, coordinate in enumerate(self.angles):
            along[size + place, coordinate] = self.cosines[place]
            along[size + places + place, coordinate] = -self.sines[place]
        for k in range(self.count):
            along[size + 2 * places + k, size + k] = 1
        if backward:
            columns = jtimes(found, given, SX.eye(self.count), True).T @ along
        else:
            columns = jtimes(found, given, along)
        columns = substitute(columns, self.x, vertcat(*a))
        factor, inverse, above = self.factor(self.mass_matrix())
        entries = list(a)
        for column in range(columns.shape[1]):
            entries += self.solve(factor, inverse, above, [-columns[k, column] for k in range(self.count)])
        return entries

    def by_articulated_bodies(self):
        """Accelerations by articulated bodies: inertia [[I, H], [H^T, M]], bias force (couple, force)."""
        zero = vector([0, 0, 0])
        omega, speed, drift = {0: zero}, {0: zero}, {}
        full, bias = {}, {}

        def body(i):
            mass, moment, inertia = self.bodies[i]
            diagonal = [[mass if a == b else SX(0) for b in range(3)] for a in range(3)]
            full[i] = (inertia, skew(moment), diagonal)
            w, v = omega[i], speed[i]
            momentum = add(times(mass, v), cross(w, moment))
            spin = add(apply(inertia, w), cross(moment, v))
            bias[i] = (add(cross(w, spin), cross(v, momentum)), cross(w, momentum))

        if self.floating:
            speed[self.base], omega[self.base] = [self.u[k] for k in range(3)], [self.u[k] for k in range(3, 6)]
            body(self.base)
        for i, joint in self.joints.items():
            value, unit = self.u[joint.number], self.unit(i)
            w = joint.down(omega[joint.parent])
            v = joint.down(add(speed[joint.parent], cross(omega[joint.parent], joint.offset)))
            along = times(value, unit)
            if joint.turns:
                omega[i], speed[i] = add(w, along), v
                drift[i] = (cross(w, along), cross(v, along))
            else:
                omega[i], speed[i] = w, add(v, along)
                drift[i] = (zero, cross(w, along))
            body(i)
        kept = {}
        for i in reversed(self.joints):
            joint, k = self.joints[i], self.joints[i].axis
            inertia, coupling, mass = full[i]
            couple, force = bias[i]
            if joint.turns:
                row = ([inertia[a][k] for a in range(3)], [coupling[k][a] for a in range(3)])
                divisor, left = row[0][k], self.x[joint.number] - couple[k]
            else:
                row = ([coupling[a][k] for a in range(3)], [mass[a][k] for a in range(3)])
                divisor, left = row[1][k], self.x[joint.number] - force[k]
            inverse = reciprocal(divisor)
            part = (times(inverse, row[0]), times(inverse, row[1]))
            kept[i] = (row, inverse, left)
            if joint.parent not in self.bodies:
                continue
            inertia = symmetric(lambda a, b: inertia[a][b] - part[0][a] * row[0][b])
            mass = symmetric(lambda a, b: mass[a][b] - part[1][a] * row[1][b])
            coupling = [[coupling[a][b] - part[0][a] * row[1][b] for b in range(3)] for a in range(3)]
            w, v = drift[i]
            couple = add(couple, apply(inertia, w), apply(coupling, v), times(left, part[0]))
            force = add(force, apply(transposed(coupling), w), apply(mass, v), times(left, part[1]))
            inertia, mass, coupling = joint.up_symmetric(inertia), joint.up_symmetric(mass), joint.up_matrix(coupling)
            at = skew(joint.offset)
            shifted = product(at, mass)
            # I + [p] H^T + (..)^T - [p] M [p], H + [p] M
            moved = [[x + y for x, y in zip(*rows)] for rows in zip(coupling, shifted)]
            one, other = product(at, transposed(coupling)), product(moved, at)
            inertia = symmetric(lambda a, b: inertia[a][b] + one[a][b] - other[a][b])
            lifted = joint.up(force)
            above = full[joint.parent]
            full[joint.parent] = tuple(
                [[x + y for x, y in zip(*rows)] for rows in zip(*pair)] for pair in zip(above, (inertia, moved, mass))
            )
            before = bias[joint.parent]
            bias[joint.parent] = (
                add(before[0], joint.up(couple), cross(joint.offset, lifted)),
                add(before[1], lifted),
            )
        found = [SX(0)] * self.count
        rate, fall = {0: zero}, {0: vector([0, 0, GRAVITY])}
        if self.floating:
            inertia, coupling, mass = full[self.base]
            couple, force = bias[self.base]
            # forces first: the order of the speeds
            h = [mass[a] + transposed(coupling)[a] for a in range(3)] + [coupling[a] + inertia[a] for a in range(3)]
            x = [self.x[a] - f for a, f in enumerate([*force, *couple])]
            solved = cholesky(h, x)
            fall[self.base], rate[self.base] = solved[:3], solved[3:]
            lift = times(SX(GRAVITY), self.attitude()[2])
            found[:6] = [*sub(solved[:3], lift), *solved[3:]]
        for i, joint in self.joints.items():
            up = joint.parent
            w = add(joint.down(rate[up]), drift[i][0])
            v = add(joint.down(add(fall[up], cross(rate[up], joint.offset))), drift[i][1])
            row, inverse, left = kept[i]
            value = (left - (dot(row[0], w) + dot(row[1], v))) * inverse
            found[joint.number] = value
            along = times(value, self.unit(i))
            rate[i], fall[i] = (add(w, along), v) if joint.turns else (w, add(v, along))
        return found

    def jacobian(self):
        """Of the link `ee`: rows are the axes of the world."""
        columns = [vector([0, 0, 0]) for _ in range(self.count)]
        way, i = [], self.tip
        while i in self.joints:
            way.append(i)
            i = self.joints[i].parent
        place = self.tip_place
        base_rows = [vector(row) for row in np.eye(3)]
        found, partial = {}, []
        for i in way:
            joint = self.joints[i]
            partial.append((joint.number, cross(self.unit(i), place) if joint.turns else self.unit(i)))
            partial = [(number, joint.up(a)) for number, a in partial]
            place = add(joint.up(place), joint.offset)
        if self.floating:
            for k in range(3):
                partial.append((k, base_rows[k]))
                partial.append((3 + k, cross(base_rows[k], place)))
            attitude = self.attitude()
            partial = [(number, apply(attitude, a)) for number, a in partial]
        for number, a in partial:
            columns[number] = a
        return transposed(columns)

    def jacobian_downwards(self):
        """The same from the base on: every axis and place in the world, then one product for each joint."""
        way, i = [], self.tip
        while i in self.joints:
            way.insert(0, i)
            i = self.joints[i].parent
        axes = self.attitude() if self.floating else [vector(row) for row in np.eye(3)]
        at = vector([0, 0, 0])
        columns = [vector([0, 0, 0]) for _ in range(self.count)]
        kept = []
        for i in way:
            joint = self.joints[i]
            at = add(at, apply(axes, joint.offset))
            based = product(axes, joint.base)
            axes = [joint.turned(row, -1) for row in based]
            kept.append((joint, at, [row[joint.axis] for row in based]))
        tip = add(at, apply(axes, self.tip_place))
        for joint, at, along in kept:
            columns[joint.number] = cross(along, sub(tip, at)) if joint.turns else along
        if self.floating:
            attitude = transposed(self.attitude())
            for k in range(3):
                columns[k] = attitude[k]
                columns[3 + k] = cross(attitude[k], tip)
        return transposed(columns)

    def contact(self, jacobian):
        """J and J M^-1 J^T, by the factor; rows along z, y, x of the world."""
        jacobian = jacobian[::-1]
        factor, inverse, above = self.factor(self.mass_matrix())
        rows = [list(row) for row in jacobian]
        for row in rows:
            for k in reversed(range(self.count)):
                i = above[k]
                while i >= 0:
                    row[i] = row[i] - factor[k][i] * row[k]
                    i = above[i]
        scaled = [[a * b for a, b in zip(row, inverse)] for row in rows]
        pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
        reduced = [sum((x * y for x, y in zip(scaled[i], rows[j])), SX(0)) for i, j in pairs]
        return [entry for row in jacobian for entry in row] + reduced

    def planar(self):
        """The mass matrix of a chain in a plane, by absolute angles and sums over what each joint carries; `None` for other robots."""
        chain = list(self.joints.values())
        turning = [joint for joint in chain if joint.turns]
        parallel = all(joint.parent == i for i, joint in enumerate(chain)) and not self.floating
        planar = parallel and all(joint.axis == turning[0].axis for joint in turning)
        flat = planar and all(np.allclose(np.array(self.model.jointPlacements[i].rotation), np.eye(3)) for i in self.joints)
        if not flat or any(not joint.turns for joint in chain[1:]):
            return None
        # the vector from each joint to the next, in the world; the sines and cosines given are those of absolute angles
        m = [[SX(0)] * self.count for _ in range(self.count)]
        mass, moment, inertia = SX(0), vector([0, 0, 0]), SX(0)
        about = {}
        axis = turning[0].axis
        for i in reversed(self.joints):
            joint = self.joints[i]
            own = self.bodies[i]
            # what it carries, about its joint
            moment = add(moment, joint.turned(own[1]) if joint.turns else own[1])
            inertia, mass = inertia + own[2][axis][axis], mass + own[0]
            about[i] = (mass, moment, inertia)
            if joint.parent in self.joints:
                below = self.joints[joint.parent]
                at = below.turned(joint.offset) if below.turns else joint.offset
                at[axis] = SX(0)
                inertia = inertia + 2 * dot(at, moment) + mass * dot(at, at)
                moment = add(moment, times(mass, at))
        for i in self.joints:
            joint, (mass, moment, inertia) = self.joints[i], about[i]
            unit = self.unit(i)
            force = cross(unit, moment) if joint.turns else times(mass, unit)
            couple = inertia if joint.turns else cross(moment, unit)[axis]
            k = i
            m[joint.number][joint.number] = couple if joint.turns else force[joint.axis]
            while self.joints[k].parent in self.joints:
                way = self.joints[k]
                below = self.joints[way.parent]
                at = below.turned(way.offset) if below.turns else way.offset
                couple = couple + cross(at, force)[axis]
                entry = couple if below.turns else force[below.axis]
                m[joint.number][below.number] = m[below.number][joint.number] = entry
                k = way.parent
        return m


def main(path, kind, folder):
    robot = Robot(path, kind == "floating")
    given = [robot.x[k] for k in range(robot.count)]
    routines = {
        "fd_factor": robot.by_factor,
        "fd_articulated": robot.by_articulated_bodies,
        "id": lambda: robot.newton_euler(given),
        "cm_up": lambda: robot.contact(robot.jacobian()),
        "cm_down": lambda: robot.contact(robot.jacobian_downwards()),
        "m": lambda: dense(robot.mass_matrix()),
        "ml": lambda: lower(robot.mass_matrix()),
        "dfd_forward": lambda: robot.derivatives(False),
        "dfd_backward": lambda: robot.derivatives(True),
    }
    planar = robot.planar()
    if planar is not None:
        routines["m_absolute"] = lambda: dense(planar)
        routines["ml_absolute"] = lambda: lower(planar)

    def angles(name):
        each = [f"q[{coordinate}]" for coordinate in robot.angles]
        return [" + ".join(each[: place + 1]) for place in range(len(each))] if name.endswith("absolute") else each

    write(folder, [robot.q, robot.sines, robot.cosines, robot.u, robot.x], routines, angles)


main(*sys.argv[1:])
