"""Tables and pictures of docs/validation.md from results/: `report.py [--check]`."""

import csv
import json
import sys
from pathlib import Path

import numpy as np
from scipy import stats

ROOT = Path(__file__).parent.parent
RESULTS, DOCS = ROOT / "results", ROOT.parent / "docs"
SIMULATORS = ["hodograph", "mujoco", "drake"]
TARGETS = {"cube": (0.235, 0.030), "elbow": (0.95, 0.42)}


def read(name, which):
    with open(RESULTS / f"{name}_{which}_errors.csv") as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def mean(values):
    return f"{np.mean(values):.3f} ± {np.std(values, ddof=1) / np.sqrt(len(values)):.3f}"


def number(value):
    return f"{value:.4g}"


def tables(name):
    present = [which for which in SIMULATORS if (RESULTS / f"{name}_{which}.json").exists()]
    found = {which: json.loads((RESULTS / f"{name}_{which}.json").read_text()) for which in present}
    errors = {which: read(name, which) for which in [*present, "frozen"]}
    data = json.loads((RESULTS / f"{name}_data.json").read_text())
    faces = name == "cube"
    out = [f"{data['judged']} judged tosses, constants from {data['fitted']} others:", ""]
    out.append("| | mean | median | quartiles |" + (" on the right face |" if faces else "") + " failures | mean after flight | mean with the other step |")
    out.append("| --- | --- | --- | --- |" + (" --- |" if faces else "") + " --- | --- | --- |")
    for which, e in errors.items():
        title = found[which]["simulator"] if which in found else "nothing moves"
        low, middle, high = np.percentile(e["error"], [25, 50, 75])
        row = [title, mean(e["error"]), f"{middle:.3f}", f"{low:.3f}, {high:.3f}"]
        row += [f"{100 * e['right_face'].mean():.1f} %"] if faces else []
        row += [str(len(found[which]["failures_judged"])) if which in found else "", f"{np.nanmean(e['after_flight']):.3f}", f"{e['other_step'].mean():.3f}" if which in found else ""]
        out.append("| " + " | ".join(row) + " |")
    out += ["", "| Hodograph minus | mean | in standard errors | median | share of tosses nearer | p of Wilcoxon's test |", "| --- | --- | --- | --- | --- | --- |"]
    for which in present[1:]:
        assert (errors["hodograph"]["toss"] == errors[which]["toss"]).all()
        d = errors["hodograph"]["error"] - errors[which]["error"]
        size = np.mean(d) / (np.std(d, ddof=1) / np.sqrt(len(d)))
        out.append(f"| {found[which]['simulator']} | {mean(d)} | {size:.1f} | {np.median(d):.4f} | {100 * (d < 0).mean():.1f} % | {stats.wilcoxon(d).pvalue:.1e} |")
    own = errors["hodograph"]["error"]
    limits = TARGETS[name]
    out += ["", "| set beforehand | outcome | met |", "| --- | --- | --- |"]
    met = lambda holds: "yes" if holds else "**no**"
    out.append(f"| mean at most {limits[0]} | {own.mean():.3f} | {met(own.mean() <= limits[0])} |")
    out.append(f"| median at most {limits[1]:.4f} | {np.median(own):.4f} | {met(np.median(own) <= limits[1])} |")
    for which in present[1:]:
        d = own - errors[which]["error"]
        size = np.mean(d) / (np.std(d, ddof=1) / np.sqrt(len(d)))
        out.append(f"| better than {found[which]['simulator']} by more than two standard errors | {-size:.1f} | {met(size < -2)} |")
    if (RESULTS / f"{name}_noise.json").exists():
        noise = json.loads((RESULTS / f"{name}_noise.json").read_text())
        out += ["", f"Noise replicate: a perfect simulator would have a mean of {noise['mean']:.3f} ± {noise['standard_error']:.3f} and a median of {noise['median']:.4f}."]
    out += ["", "Constants, as each simulator identified them (`edges`: factor of the nominal edges; `moments`: factor of the moments of inertia):", ""]
    out += ["| | variant | objective | constants | evaluations |", "| --- | --- | --- | --- | --- |"]
    for which in present:
        f = found[which]
        variant = ", ".join(str(value) if key != "impratio" else f"impratio {value}" for key, value in f["variant"].items())
        constants = ", ".join(f"{key} {number(value)}" for key, value in f["constants"].items())
        out.append(f"| {f['simulator']} | {variant} | {f['objective']:.4f} | {constants} | {f['evaluations']} |")
    out += ["", "Least objective on the fitted tosses in the ten evaluations of each variant (judged tosses take no part):", "", "| | variant: objective |", "| --- | --- |"]
    for which in present:
        f = found[which]
        parts = [f"{' '.join(str(value) for value in v['variant'].values())}: {v['objective']:.3f}" for v in f["variants"]]
        out.append(f"| {f['simulator']} | {'; '.join(parts)} |")
    flight = ", ".join(f"{key} {value:.4g} ± {error:.2g}" for key, (value, error) in data["flight"].items())
    out += ["", f"Measured without a simulator, from flight and rest of the fitted tosses (SI units): {flight}. Differences of flight are {data['flight_rms']:.2f} of the noise that the plan states."]
    return out


NEAR = 0.001  # m


def outcomes(name):
    """What the set of outcomes holds."""
    with open(RESULTS / f"{name}_outcomes.csv") as file:
        rows = list(csv.DictReader(file))
    column = lambda key: np.array([float(row[key]) for row in rows])
    share = lambda holds: f"{100 * np.mean(holds):.1f} %"
    several = column("faces") > 1
    return [
        "| of the judged tosses | share |",
        "| --- | --- |",
        f"| the drawn ends are more than 1 mm apart | {share(column('width') > NEAR)} |",
        f"| the drawn ends are on several faces | {share(several)} |",
        f"| the measured face is that of the single prediction | {share(column('face_single'))} |",
        f"| the measured face is among the drawn ones | {share(column('face_drawn'))} |",
        f"| the measured centre is within 1 mm of the single prediction, along both horizontal axes | {share(column('off_single') <= NEAR)} |",
        f"| the measured centre is within 1 mm of the range of the drawn ones | {share(column('outside') <= NEAR)} |",
        "",
        f"Median distance of the measured centre from the single prediction {1000 * np.median(column('off_single')):.1f} mm, from the range of the drawn ones {1000 * np.median(column('outside')):.1f} mm. Tosses with a motion that failed: {int(column('failed').sum())}.",
    ]


LAWS_OF_IMPACTS = {
    "coulomb": "Coulomb and Poisson, mu and e",
    "speed": "the same, e falls with the speed to the power 1/4",
    "springs": "springs in the contact, that e, ratio 0.8",
    "free springs": "the same, the ratio is a third constant",
    "each": "Coulomb and Poisson with the best mu and e of each impact",
}


def impacts():
    """What laws leave of clean impacts."""
    with open(RESULTS / "elbow_impacts.csv") as file:
        rows = list(csv.DictReader(file))
    constants = json.loads((RESULTS / "elbow_impacts.json").read_text())
    half = np.array([int(row["toss"]) % 2 for row in rows])
    column = lambda name: np.array([float(row[name]) for row in rows])
    percent = lambda values: f"{100 * values.mean():.1f}"
    lines = [
        f"{(half == 0).sum()} impacts of tosses with even numbers, from which the constants are, and {(half == 1).sum()} others, in per cent of the energy of the change of velocity:",
        "",
        "| law | constants | first half | second half | its median |",
        "| --- | --- | --- | --- | --- |",
        f"| any impulse at the corner | | {percent(column('any impulse')[half == 0])} | {percent(column('any impulse')[half == 1])} | {100 * np.median(column('any impulse')[half == 1]):.1f} |",
    ]
    for name, title in LAWS_OF_IMPACTS.items():
        values = column(name)
        judged = values[half == 1]
        given = ", ".join(f"{key} {value:.2f}" for key, value in constants.get(name, {}).items())
        error = judged.std(ddof=1) / np.sqrt(len(judged))
        lines.append(f"| {title} | {given} | {percent(values[half == 0])} | {percent(judged)} ± {100 * error:.1f} | {100 * np.median(judged):.1f} |")
    quartiles = lambda name: " to ".join(f"{value:.2f}" for value in np.percentile(column(name), [25, 75]))
    lines += ["", f"The tangential impulse is {quartiles('ratio')} of the normal one (quartiles), e {quartiles('e')}."]
    return lines


def picture(name):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "hodograph", "svg.fonttype": "none", "font.size": 9})
    import matplotlib.pyplot as plt

    present = [which for which in SIMULATORS if (RESULTS / f"{name}_{which}.json").exists()]
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
    colours = {"hodograph": "#c0392b", "mujoco": "#2471a3", "drake": "#7d8b34", "frozen": "#999999"}
    titles = {"hodograph": "Hodograph", "mujoco": "MuJoCo", "drake": "Drake", "frozen": "nothing moves"}
    for which in [*present, "frozen"]:
        e = np.sort(read(name, which)["error"])
        left.step(e, np.arange(1, len(e) + 1) / len(e), where="post", color=colours[which], label=titles[which])
    left.set(xscale="log", xlabel="error of a toss", ylabel="share of judged tosses", xlim=(1e-3 if name == "cube" else 1e-2, 10), ylim=(0, 1))
    left.legend(frameon=False, loc="upper left")
    own = read(name, "hodograph")["error"]
    for which in present[1:]:
        right.plot(read(name, which)["error"], own, ".", markersize=2.5, color=colours[which], label=titles[which])
    low = 1e-3 if name == "cube" else 1e-2
    right.plot([low, 10], [low, 10], color="black", linewidth=0.6)
    right.set(xscale="log", yscale="log", xlabel="error of the peer", ylabel="error of Hodograph", xlim=(low, 10), ylim=(low, 10))
    right.legend(frameon=False, loc="lower right")
    (DOCS / "validation").mkdir(exist_ok=True)
    file = DOCS / "validation" / f"{name}.svg"
    figure.savefig(file, metadata={"Date": None, "Creator": None})
    file.write_text("\n".join(line.rstrip() for line in file.read_text().splitlines()) + "\n")
    plt.close(figure)


def main():
    check = "--check" in sys.argv
    page = DOCS / "validation.md"
    text = before = page.read_text()
    begin, end = "<!-- outcomes of the cube -->\n", "<!-- end of the outcomes of the cube -->\n"
    head, rest = text.split(begin)
    text = head + begin + "\n" + "\n".join(outcomes("cube")) + "\n\n" + end + rest.split(end)[1]
    begin, end = "<!-- impacts of the elbow -->\n", "<!-- end of the impacts of the elbow -->\n"
    head, rest = text.split(begin)
    text = head + begin + "\n" + "\n".join(impacts()) + "\n\n" + end + rest.split(end)[1]
    for name in TARGETS:
        begin, end = f"<!-- results of the {name} -->\n", f"<!-- end of the results of the {name} -->\n"
        if begin not in text:
            continue
        head, rest = text.split(begin)
        text = head + begin + "\n" + "\n".join(tables(name)) + "\n\n" + end + rest.split(end)[1]
        if not check:
            picture(name)
    if check and text != before:
        sys.exit("docs/validation.md does not have the numbers of validation/results: run validation/report")
    page.write_text(text)


if __name__ == "__main__":
    main()
