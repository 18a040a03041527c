"""Draws the figures of docs/orbits.md: python3 docs/orbits/figures.py (needs hodograph, numpy and matplotlib)."""

import pathlib

import matplotlib

matplotlib.use("svg")
import hodograph
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).parent
MODELS = HERE.parent.parent / "simulation/gradients/tests/models"
plt.rcParams.update({"svg.hashsalt": "hodograph", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9, "figure.facecolor": "white"})
LEGS = {"q1": "q2", "q2": "q1", "u1": "u2", "u2": "u1"}
STEP = dict(event="collision", contact="second", reset=["x"], exchange=LEGS, mu=2.0, e=0.0, law="poisson")
COLOURS = ["#c0392b", "#2471a3"]


def save(figure, name):
    file = HERE / f"{name}.svg"
    figure.savefig(file, dpi=200, metadata={"Date": None, "Creator": None}, bbox_inches="tight")
    file.write_text("\n".join(line.rstrip() for line in file.read_text().splitlines()) + "\n")
    plt.close(figure)


def compass():
    """Left: a step of both legs. Right: multipliers through the incline."""
    walker = hodograph.load(MODELS / "compass_walker.mech")
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.4), layout="constrained")
    for degrees, style in [(3.0, "-"), (4.3, "--")]:
        other = walker.with_parameters(gamma=np.radians(degrees))
        step = other.orbit(**STEP) if degrees == 3.0 else other.orbit(last.q, last.u, **STEP)
        last = step
        motion = other.simulate(step.period * (1 - 1e-9), step.period / 200, q=step.q, u=step.u, mu=2.0, e=0.0, law="poisson")
        for leg, (name, colour) in enumerate(zip(["leg that stands", "leg that swings"], COLOURS)):
            left.plot(motion.q[:, 2 + leg], motion.u[:, 2 + leg], style, color=colour, linewidth=1, label=f"{name}, {degrees:g} degrees")
        left.plot([motion.q[-1, 2], step.q[3]], [motion.u[-1, 2], step.u[3]], ":", color="black", linewidth=0.8)
        left.plot([motion.q[-1, 3], step.q[2]], [motion.u[-1, 3], step.u[2]], ":", color="black", linewidth=0.8)
    left.set(xlabel="angle of the leg from the normal of the incline, rad", ylabel="its rate, rad/s")
    left.legend(frameon=False, fontsize=7, loc="center")
    branch = walker.branch("gamma", np.radians(3.0), np.radians(5.0), **STEP)
    degrees = np.degrees(branch.values)
    many = np.array([sorted(orbit.multipliers, key=abs)[-3:] for orbit in branch.orbits])
    right.plot(np.repeat(degrees, 3), many.real.ravel(), ".", color=COLOURS[0], markersize=3, label="real part")
    right.plot(np.repeat(degrees, 3), many.imag.ravel(), ".", color=COLOURS[1], markersize=3, label="imaginary part")
    for kind, value, _ in branch.changes:
        right.axvline(np.degrees(value), color="black", linewidth=0.8)
        right.annotate(f"{kind.replace('_', ' ')}\n{np.degrees(value):.4f}", (np.degrees(value), 0.75), ha="right", fontsize=7)
    right.axhline(-1, color="grey", linewidth=0.6)
    right.set(xlabel="incline, degrees", ylabel="multipliers of a step", ylim=(-1.5, 1.1))
    right.legend(frameon=False, fontsize=7, loc="lower left")
    save(figure, "compass")


def ball():
    """Impacts of the ball on the plate by its amplitude: phases after 300 periods, and those of the periodic motions."""
    locked, w, g, e = hodograph.load(MODELS / "ball_on_plate.mech"), 60.0, 9.81, 0.7
    period, surface = 2 * np.pi / w, dict(mu=0.0, e=e, law="newton")
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.4), layout="constrained", width_ratios=[2, 1])
    branches = []
    for end in (0.0042, 0.0015):
        found = locked.branch("a", 0.002, end, [0.0139], [0.14], time=0.05, period=period, **surface)
        branches.append(found)
        phase = [360 * (orbit.events[0][0] % period) / period for orbit in found.orbits]
        stable = np.array([orbit.stable for orbit in found.orbits])
        for kept, style in [(stable, "-"), (~stable, ":")]:
            left.plot(np.where(kept, 1e3 * found.values, np.nan), phase, style, color=COLOURS[1], linewidth=1.2)
        for kind, value, _ in found.changes:
            left.axvline(1e3 * value, color="grey", linewidth=0.6)
            left.annotate(f"{kind.replace('_', ' ')}\n{1e3 * value:.5f}", (1e3 * value, 104), fontsize=7, ha="left")
    start = branches[0].orbits[0]
    q, u = start.q, start.u
    struck = []
    for amplitude in np.linspace(0.0016, 0.0042, 261):
        plate = locked.with_parameters(a=amplitude)
        motion = plate.simulate(0.05 + 340 * period, period, q=q, u=u, time=0.05, **surface)
        times = np.array([event.time for event in motion.events if event.kind == "collision"])
        last = times[times > 0.05 + 300 * period]
        struck += [(1e3 * amplitude, 360 * (time % period) / period) for time in last]
    left.plot(*np.transpose(struck), ".", color="black", markersize=1, markeredgewidth=0, rasterized=True)
    left.set(xlabel="amplitude of the plate, mm", ylabel="phase of impacts, degrees", ylim=(-5, 120), xlim=(1.48, 4.22))
    values = np.concatenate([branch.values for branch in branches])
    many = np.array([orbit.multipliers.real for branch in branches for orbit in branch.orbits])
    order = np.argsort(values)
    right.plot(1e3 * np.repeat(values[order], 2), np.sort(many[order], axis=1).ravel(), ".", color=COLOURS[0], markersize=2)
    for limit in (-1, 1):
        right.axhline(limit, color="grey", linewidth=0.6)
    right.set(xlabel="amplitude of the plate, mm", ylabel="real parts of the multipliers", ylim=(-2.5, 2))
    save(figure, "ball")


def cycles():
    """Left: a step of a rimless wheel; middle: a peck; right: a hop."""
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(8.6, 3.0), layout="constrained")
    wheel = hodograph.load(MODELS / "rimless_wheel.mech")
    surface = dict(mu=2.0, e=0.0, law="poisson")
    step = wheel.orbit([0, 0.9239, -0.3927], [1.2, 0.4975, 1.3], event="collision", contact="second", reset=["x", "z", "q"], **surface)
    motion = wheel.simulate(step.period * (1 - 1e-9), step.period / 200, q=step.q, u=step.u, **surface)
    left.plot(motion.q[:, 2], motion.u[:, 2], color=COLOURS[1], linewidth=1)
    left.plot([motion.q[-1, 2], step.q[2]], [motion.u[-1, 2], step.u[2]], ":", color="black", linewidth=0.8)
    left.set(title="rimless wheel", xlabel="angle of the wheel, rad", ylabel="its rate, rad/s")
    bird = hodograph.load(MODELS / "woodpecker.mech")
    peck = bird.orbit([0, -0.10090092472, -0.44576], [0, 0, -1.1257], event="stick", contact="lower", reset=["y"])
    motion = bird.simulate(peck.period, peck.period / 4000, q=peck.q, u=peck.u)
    middle.plot(motion.q[:, 2], motion.u[:, 2], color=COLOURS[1], linewidth=1, label="bird")
    middle.plot(motion.q[:, 1], motion.u[:, 1], color=COLOURS[0], linewidth=0.8, label="sleeve")
    middle.set(title="woodpecker", xlabel="angle, rad", ylabel="its rate, rad/s")
    middle.legend(frameon=False, fontsize=7)
    hopper = hodograph.load(MODELS / "driven_hopper.mech")
    period = 2 * np.pi / 30
    hop = hopper.orbit([0, 0, 0.28], [0, 0, 0], period=period, reset=["x"])
    motion = hopper.simulate(3 * period, period / 200, q=hop.q, u=hop.u)
    right.plot(1e3 * motion.q[:, 0], 1e3 * motion.q[:, 1], color=COLOURS[1], linewidth=1, label="foot")
    slope = 0.3
    body = motion.q[:, :2] + (motion.q[:, 2:] - 0.29) * [np.sin(slope), np.cos(slope)]
    right.plot(1e3 * body[:, 0], 1e3 * body[:, 1], color=COLOURS[0], linewidth=0.8, label="body, 0.29 m nearer")
    right.set(title="driven hopper", xlabel="along the floor, mm", ylabel="above it, mm")
    right.legend(frameon=False, fontsize=7)
    save(figure, "cycles")


compass()
ball()
cycles()
