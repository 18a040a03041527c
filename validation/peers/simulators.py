"""Hodograph, MuJoCo and Drake behind one interface.

`predict(problem, tosses, variant, constants, starts, fineness)` answers, for each toss, the places of the body at every frame of its
horizon, in the frame of the data's table (nominal height), or fewer where it failed, and a list of failures (toss, kind, message).
"""

import json
import os
import subprocess
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import flight
import problem as tosses_of

ROOT = Path(__file__).parent.parent
STEPS = 7  # of the peers in a frame: 0.965 ms
PATIENCE = 20.0
NOMINAL = {"cube": {"m": 0.37, "J": 0.00081}, "elbow": {"m": 0.37}}


def body_of(problem, toss, constants):
    """Masses, halves of edges, moments of inertia, centre, gravity of one toss, SI."""
    shared = problem.shared[toss]
    m = NOMINAL[problem.name]["m"]
    halves = tosses_of.HALVES[problem.name] * constants["edges"]
    if problem.name == "cube":
        # The moment of inertia scales with the square of the edges.
        J = NOMINAL["cube"]["J"] * constants["moments"] * constants["edges"] ** 2
        return {"m": m, "halves": halves, "J": np.full(3, J), "centre": shared[3:6], "gravity": shared[:3]}
    moments = shared[[3, 4, 4]] * constants["moments"] * m
    return {"m": m, "m2": m, "halves": halves, "J": moments, "K": moments, "damping": shared[5] * m * constants["moments"], "gravity": shared[:3]}


def raised(problem, toss, states, constants):
    """The state over the table of a body with these edges."""
    out = states.copy()
    out[2] += problem.height(constants["edges"])[toss]
    return out


class Hodograph:
    name = "Hodograph"
    variants = [{"law": law, "together": rule} for law in ("newton", "poisson", "stronge") for rule in ("sequential", "approaching")]

    def __init__(self):
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
        self.process = subprocess.Popen([target / "release/hodograph-tosses"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    @staticmethod
    def contact(problem, variant):
        return {"mu": (0.2, 0.02, 1.0), "e": (0.2, 0.001, 0.95)}

    def request(self, problem, tosses, variant, constants, starts, fineness=1, longest=10**6):
        by_gravity = {}
        for place, toss in enumerate(tosses):
            by_gravity.setdefault(tuple(problem.shared[toss]), []).append(place)
        for places in by_gravity.values():
            body = body_of(problem, tosses[places[0]], constants)
            if problem.name == "cube":
                parameters = {"m": body["m"], "h": body["halves"][0], "J": body["J"][0]} | dict(zip(("cx", "cy", "cz"), body["centre"]))
            else:
                parameters = {"m1": body["m"], "m2": body["m2"], "a": body["halves"][0], "b": body["halves"][1], "d": body["damping"]}
                parameters |= dict(zip(("J1", "J2", "J3", "K1", "K2", "K3"), [*body["J"], *body["K"]]))
            parameters |= dict(zip(("gx", "gy", "gz"), body["gravity"]))
            rows = []
            for place in places:
                state = raised(problem, tosses[place], starts[place], constants)
                width = problem.body.width
                # A frame more: the first is the start.
                rows.append({"coordinates": list(state[:width]), "speeds": list(state[width:]), "frames": min(longest, problem.horizon(tosses[place]))})
            yield places, {
                "mechanism": problem.name, "parameters": {k: float(v) for k, v in parameters.items()}, "mu": constants["mu"], "e": constants["e"],
                "law": variant["law"], "together": variant["together"], "seed": variant.get("seed", 0), "tolerance": 1e-9 if fineness == 1 else 1e-8, "patience": PATIENCE,
                "frame": flight.FRAME, "tosses": rows,
            }

    def predict(self, problem, tosses, variant, constants, starts, fineness=1, longest=10**6):
        out, failures = [None] * len(tosses), []
        for places, request in self.request(problem, tosses, variant, constants, starts, fineness, longest):
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
            answer = json.loads(self.process.stdout.readline())
            if "refused" in answer:
                raise RuntimeError(answer["refused"])
            for place, frames in zip(places, answer["frames"]):
                out[place] = np.array(frames)
            for failure in answer["failures"]:
                place = places[failure["index"]]
                alone = dict(request, tosses=[request["tosses"][failure["index"]]])
                failures.append({"toss": int(problem.numbers[tosses[place]]), "kind": failure["kind"], "time": failure["time"], "message": failure["message"], "request": alone})
        heights = problem.height(constants["edges"])
        for place, toss in enumerate(tosses):
            out[place][:, 2] -= heights[toss]
        return out, failures


class MuJoCo:
    name = "MuJoCo"
    variants = [{"cone": cone, "impratio": ratio} for cone in ("elliptic", "pyramidal") for ratio in (1, 10, 100)]

    def __init__(self):
        import mujoco

        self.mujoco = mujoco

    @staticmethod
    def contact(problem, variant):
        # `give` is 1 - d of solimp
        return {"mu": (0.2, 0.02, 1.0), "time": (0.01, 0.002, 0.1), "damping": (0.5, 0.02, 2.0), "give": (0.05, 1e-4, 0.5)}

    def model(self, problem, toss, variant, constants, fineness):
        body = body_of(problem, toss, constants)
        words = lambda values: " ".join(repr(float(value)) for value in values)
        d = 1 - constants["give"]
        contact = f'friction="{constants["mu"]} 0 0" condim="3" solref="{constants["time"]} {constants["damping"]}" solimp="{d} {d} 0.001 0.5 2"'
        geom = f'<geom type="box" size="{words(body["halves"])}" {contact}/>'
        if problem.name == "cube":
            inner = f'<inertial pos="{words(body["centre"])}" mass="{body["m"]}" diaginertia="{words(body["J"])}"/>{geom}'
        else:
            hinge, arm = words(flight.Elbow.hinge), flight.Elbow.arm
            # A body's frame is where its joint leaves it: the hinge's axis passes through the frame of the second body.
            second = geom.replace("<geom ", f'<geom pos="{arm} 0 0" ')
            inner = (
                f'<inertial pos="0 0 0" mass="{body["m"]}" diaginertia="{words(body["J"])}"/>{geom}'
                f'<body pos="{hinge}"><joint type="hinge" axis="0 1 0" damping="{body["damping"]}"/>'
                f'<inertial pos="{arm} 0 0" mass="{body["m2"]}" diaginertia="{words(body["K"])}"/>{second}</body>'
            )
        text = (
            f'<mujoco><option timestep="{flight.FRAME / (STEPS * fineness)!r}" gravity="{words(body["gravity"])}" cone="{variant["cone"]}" impratio="{variant["impratio"]}"/>'
            f'<worldbody><geom type="plane" size="5 5 1" {contact}/><body><freejoint/>{inner}</body></worldbody></mujoco>'
        )
        return self.mujoco.MjModel.from_xml_string(text)

    def predict(self, problem, tosses, variant, constants, starts, fineness=1, longest=10**6):
        models, out, failures = {}, [], []
        for place, toss in enumerate(tosses):
            key = tuple(problem.shared[toss])
            if key not in models:
                model = self.model(problem, toss, variant, constants, fineness)
                models[key] = model, self.mujoco.MjData(model)
            model, data = models[key]
            state, width = raised(problem, toss, starts[place], constants), problem.body.width
            self.mujoco.mj_resetData(model, data)
            data.qpos[:] = state[:width]
            data.qvel[:] = state[width:]
            count = min(longest, problem.horizon(toss))
            frames = np.empty((count, width))
            frames[0] = data.qpos
            for frame in range(1, count):
                self.mujoco.mj_step(model, data, STEPS * fineness)
                frames[frame] = data.qpos
            if not np.isfinite(frames).all() or sum(w.number for w in data.warning):
                failures.append({"toss": int(problem.numbers[toss]), "kind": "unstable", "message": "a warning of the simulator"})
                good = int(np.argmin(np.isfinite(frames).all(1))) or len(frames)
                frames = frames[:good]
            frames[:, 2] -= problem.height(constants["edges"])[toss]
            out.append(frames)
        return out, failures


class Drake:
    name = "Drake"
    variants = [{"contact": contact, "approximation": how} for contact in ("point", "hydroelastic") for how in ("sap", "similar", "lagged")]
    TIP = 0.0005  # radius of the spheres at the corners, m: a box on a half space has but one point of contact

    def __init__(self):
        import logging

        import pydrake.all as drake

        logging.getLogger("drake").setLevel(logging.ERROR)
        self.drake = drake

    @staticmethod
    def contact(problem, variant):
        stiffness = {"point": (1e4, 1e2, 1e7), "hydroelastic": (1e6, 1e4, 1e9)}[variant["contact"]]
        return {"mu": (0.2, 0.02, 1.0), "stiffness": stiffness, "dissipation": (1.0, 1e-3, 100.0)}

    def plant(self, problem, toss, variant, constants, fineness):
        drake = self.drake
        body = body_of(problem, toss, constants)
        config = drake.MultibodyPlantConfig(
            time_step=flight.FRAME / (STEPS * fineness),
            discrete_contact_approximation=variant["approximation"],
            contact_model="point" if variant["contact"] == "point" else "hydroelastic_with_fallback",
        )
        builder = drake.DiagramBuilder()
        plant, _ = drake.AddMultibodyPlant(config, builder)
        friction = drake.CoulombFriction(constants["mu"], constants["mu"])

        def properties(rigid):
            found = drake.ProximityProperties()
            if variant["contact"] == "point":
                # Half and half: two bodies in series have the stiffness asked for.
                drake.AddContactMaterial(dissipation=constants["dissipation"], point_stiffness=2 * constants["stiffness"], friction=friction, properties=found)
            else:
                drake.AddContactMaterial(dissipation=0.0 if rigid else constants["dissipation"], friction=friction, properties=found)
                if rigid:
                    drake.AddRigidHydroelasticProperties(0.1, found)
                else:
                    drake.AddCompliantHydroelasticProperties(0.1, constants["stiffness"], found)
            return found

        plant.RegisterCollisionGeometry(plant.world_body(), drake.RigidTransform(), drake.HalfSpace(), "table", properties(True))

        def box(name, mass, moments, centre, at):
            about = drake.UnitInertia(*(moments / mass)).ShiftFromCenterOfMass(centre)
            added = plant.AddRigidBody(name, drake.SpatialInertia(mass, centre, about))
            halves = body["halves"]
            if variant["contact"] == "point":
                for k, signs in enumerate(tosses_of.SIGNS):
                    where = drake.RigidTransform(at + signs * (halves - self.TIP))
                    plant.RegisterCollisionGeometry(added, where, drake.Sphere(self.TIP), f"{name}{k}", properties(False))
            else:
                plant.RegisterCollisionGeometry(added, drake.RigidTransform(at), drake.Box(*(2 * halves)), name, properties(False))
            return added

        if problem.name == "cube":
            first = box("first", body["m"], body["J"], body["centre"], np.zeros(3))
        else:
            first = box("first", body["m"], body["J"], np.zeros(3), np.zeros(3))
            arm = np.array([flight.Elbow.arm, 0, 0])
            second = box("second", body["m2"], body["K"], arm, arm)
            plant.AddJoint(drake.RevoluteJoint("hinge", plant.AddFrame(drake.FixedOffsetFrame("at", first, drake.RigidTransform(flight.Elbow.hinge))), second.body_frame(), [0, 1, 0], damping=body["damping"]))
        plant.mutable_gravity_field().set_gravity_vector(body["gravity"])
        plant.Finalize()
        diagram = builder.Build()
        return diagram, plant, first

    def predict(self, problem, tosses, variant, constants, starts, fineness=1, longest=10**6):
        drake, plants, out, failures = self.drake, {}, [], []
        for place, toss in enumerate(tosses):
            key = tuple(problem.shared[toss])
            if key not in plants:
                diagram, plant, first = self.plant(problem, toss, variant, constants, fineness)
                simulator = drake.Simulator(diagram)
                plants[key] = simulator, plant, first
            simulator, plant, first = plants[key]
            state, width = raised(problem, toss, starts[place], constants), problem.body.width
            context = simulator.get_mutable_context()
            context.SetTime(0.0)
            inner = plant.GetMyMutableContextFromRoot(context)
            turn = flight.rotation(state[3:7])
            positions = np.concatenate([state[3:7], state[:3], state[7:width]])
            velocities = np.concatenate([turn.apply(state[width + 3 : width + 6]), state[width : width + 3], state[width + 6 :]])
            plant.SetPositionsAndVelocities(inner, np.concatenate([positions, velocities]))
            count = min(longest, problem.horizon(toss))
            frames = []
            try:
                simulator.Initialize()
                for frame in range(count):
                    simulator.AdvanceTo(frame * flight.FRAME)
                    q = plant.GetPositions(inner)
                    frames.append(np.concatenate([q[4:7], q[:4], q[7:]]))
            except RuntimeError as error:
                failures.append({"toss": int(problem.numbers[toss]), "kind": "stopped", "message": str(error)[:200]})
                frames = frames or [state[:width]]
            frames = np.array(frames)
            frames[:, 2] -= problem.height(constants["edges"])[toss]
            out.append(frames)
        return out, failures


ALL = {"hodograph": Hodograph, "mujoco": MuJoCo, "drake": Drake}
BODY = {"edges": (1.0, 0.94, 1.04), "moments": (1.0, 0.6, 1.6)}
SCALES = {"edges": 0.02, "moments": 0.15}


class Workers:
    """A simulator in several processes, between which tosses are dealt; the predictions do not depend on their number."""

    def __init__(self, which, problem, count):
        kind = ALL[which]
        self.name, self.variants, self.contact = kind.name, list(kind.variants), kind.contact
        self.pool = ProcessPoolExecutor(count, initializer=_begin, initargs=(which, problem))
        self.count = count

    def predict(self, problem, tosses, variant, constants, starts, fineness=1, longest=10**6):
        hands = [range(k, len(tosses), self.count) for k in range(self.count)]
        jobs = [self.pool.submit(_predict, [tosses[k] for k in hand], variant, constants, [starts[k] for k in hand], fineness, longest) for hand in hands if len(hand)]
        out, failures = [None] * len(tosses), []
        for hand, job in zip(hands, jobs):
            frames, failed = job.result()
            failures += failed
            for place, one in zip(hand, frames):
                out[place] = one
        return out, sorted(failures, key=lambda failure: failure["toss"])


def _begin(which, problem):
    global _worker
    _worker = ALL[which](), problem


def _predict(tosses, variant, constants, starts, fineness, longest):
    simulator, problem = _worker
    return simulator.predict(problem, tosses, variant, constants, starts, fineness, longest)
