"""Draws the figures of docs/sweeps.md from the answers of sweeps/queries: python3 figures.py DIRECTORY (needs numpy and matplotlib).

DIRECTORY holds energy_gain.csv, phases.csv and tolerances.csv, which `hodograph-sweep run sweeps/queries/NAME.sql --out NAME.csv` writes."""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).parent
plt.rcParams.update({
    "svg.hashsalt": "hodograph", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9, "figure.facecolor": "white",
    "image.cmap": "viridis",
})


def rows(name):
    with open(pathlib.Path(sys.argv[1]) / f"{name}.csv", newline="") as file:
        return list(csv.DictReader(file))


def save(figure, name):
    for end in ["svg", *sys.argv[2:]]:
        metadata = {"Date": None} if end == "svg" else None
        figure.savefig(HERE / f"{name}.{end}", metadata=metadata, dpi=90, bbox_inches="tight")
    plt.close(figure)


def energy_gain():
    found = rows("energy_gain")
    size = int(round(len(found) ** 0.5))
    values = {name: np.array([float(row[name] or "nan") for row in found]).reshape(size, size) for name in ["gain", "stronge"]}
    figure, axes = plt.subplots(1, 2, figsize=(8.6, 3.9), sharey=True)
    most = np.nanmax(np.abs(values["gain"]))
    for axis, (name, title) in zip(axes, [("gain", "Newton's hypothesis"), ("stronge", "Stronge's hypothesis")]):
        image = axis.imshow(values[name], origin="lower", extent=[-180, 180, -180, 180], vmin=-most, vmax=most, cmap="RdBu_r")
        if np.nanmax(values[name]) > 0:
            shown = np.where(np.isfinite(values[name]), values[name], -1)
            axis.contour(shown, levels=[0], extent=[-180, 180, -180, 180], colors="black", linewidths=0.8)
        axis.set(title=title, xlabel="direction of (u1, u4), degrees", xticks=range(-180, 181, 90), yticks=range(-180, 181, 90))
        axis.set_facecolor("#dddddd")
    axes[0].set_ylabel("direction of (u3, u6), degrees")
    figure.colorbar(image, ax=axes, label="change of energy / kinetic energy before")
    save(figure, "energy_gain")


def phases():
    found = rows("phases")
    mu = sorted({float(row["mu"]) for row in found})
    angle = sorted({float(row["q6"]) for row in found})
    place = {value: index for index, value in enumerate(mu)}
    row_of = {value: index for index, value in enumerate(angle)}
    figure, axes = plt.subplots(1, 3, figsize=(8.6, 3.1), sharey=True)
    for axis, (name, title) in zip(axes, [("slides", "sliding throughout"), ("sticks", "sticking at the end"), ("renews", "renewed slip at the end")]):
        share = np.full((len(angle), len(mu)), np.nan)
        for row in found:
            if int(row["solved"]):
                share[row_of[float(row["q6"])], place[float(row["mu"])]] = int(row[name]) / int(row["solved"])
        image = axis.imshow(share, origin="lower", extent=[0, 2, 0, 360], aspect="auto", vmin=0, vmax=1)
        axis.set(title=title, xlabel="coefficient of friction", yticks=range(0, 361, 90))
    axes[0].set_ylabel("angle q6 of sled B, degrees")
    figure.colorbar(image, ax=axes, label="share of the collisions")
    save(figure, "phases")


def tolerances():
    found = {row["which"]: row for row in rows("tolerances")}
    figure, axes = plt.subplots(1, 2, figsize=(8.6, 3.1))
    labels = {"separation": "speed of separation of the tip, m/s", "rate": "rate u2 of the lower rod after the collision, rad/s"}
    ranges = {"separation": (0.64, 0.76), "rate": (-1.85, -1.65)}
    for axis, name in zip(axes, labels):
        low, high = ranges[name]
        for which in ["all", "m1", "m2", "l1", "l2"]:
            counts = np.array([int(count) for count in found[which][name].strip("[]").split(",")])
            assert counts[0] == counts[-1] == 0, f"{name} of {which} leaves the bins"
            edges = np.linspace(low, high, len(counts) - 1)
            middle = (edges[:-1] + edges[1:]) / 2
            share = counts[1:-1] / counts.sum()
            mean = (share * middle).sum()
            spread = ((share * (middle - mean) ** 2).sum()) ** 0.5
            print(f"{name:11} {which:4} mean {mean:.4f} standard deviation {spread:.4f}")
            axis.step(middle, share, where="mid", label=f"{which}: {spread:.4f}", linewidth=2 if which == "all" else 1)
        axis.set(xlabel=labels[name], yscale="log", ylim=(1e-5, 1.5))
        axis.legend(title="tolerance of: std. deviation", fontsize=8, title_fontsize=8)
    axes[0].set_ylabel("share of the collisions per bin")
    save(figure, "tolerances")


energy_gain()
phases()
tolerances()
