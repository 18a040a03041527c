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
    figure.savefig(file, metadata={"Date": None, "Creator": None}, bbox_inches="tight")
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


compass()
