"""Draws the figures of docs/theory.md: python3 figures.py (needs numpy and matplotlib)."""

import pathlib
import re

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).parent
plt.rcParams.update({
    "svg.hashsalt": "hodograph", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9,
    "axes.spines.top": False, "axes.spines.right": False, "figure.facecolor": "white",
})
BLUE, RED, GREEN, GREY = "#1f5fa8", "#b5392e", "#2c7a3f", "#888888"


def save(figure, name):
    figure.tight_layout()
    figure.savefig(HERE / name, metadata={"Date": None})
    plt.close(figure)
    # Tenths of a point are enough.
    text = (HERE / name).read_text()
    text = re.sub(r"-?\d+\.\d{2,}", lambda number: f"{float(number[0]):.1f}".removesuffix(".0"), text)
    (HERE / name).write_text("\n".join(line.rstrip() for line in text.splitlines()) + "\n")


class Contact:
    """A reduced matrix over m_nn, and a coefficient of friction."""

    def __init__(self, nn, nt, ns, tt, ts, ss, mu):
        self.beta = complex(nt, ns) / nn
        self.tau = (tt + ss) / (2 * nn)
        self.n = mu * complex((tt - ss) / 2, ts) / nn
        self.mu = mu

    def gh(self, phi):
        d = np.exp(-1j * phi)
        z = self.beta * d - self.mu * self.tau - self.n * d * d
        return z.real, z.imag

    def f(self, phi):
        return 1 - self.mu * (self.beta * np.exp(-1j * phi)).real

    def slope(self, phi):
        d = np.exp(-1j * phi)
        return (-self.beta * d + 2 * self.n * d * d).real

    def zeros(self):
        n, b = self.n, self.beta
        roots = np.roots([n.conjugate(), -b.conjugate(), 0, b, -n])
        return sorted(np.angle(r) % (2 * np.pi) for r in roots if abs(abs(r) - 1) < 1e-9)


SLEDS = (0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211)


def rates():
    c = Contact(*SLEDS, 1.1)
    phi = np.linspace(0, 2 * np.pi, 721)
    g, h = c.gh(phi)
    figure, axes = plt.subplots(figsize=(6.6, 2.9))
    axes.axhline(0, color="black", lw=0.7)
    for values, colour, name in ((c.f(phi), GREY, "f"), (g, GREEN, "g"), (h, BLUE, "h")):
        axes.plot(phi, values, color=colour, label=name)
    for zero in c.zeros():
        stable = c.slope(zero) < 0
        axes.plot(zero, 0, "o", color=BLUE, mfc=BLUE if stable else "white", ms=7)
        axes.annotate("stable" if stable else "unstable", (zero, 0), (zero, -0.42), ha="center", color=BLUE, fontsize=8)
    arrows = np.sort(np.concatenate([c.zeros(), [0, 2 * np.pi]]))
    for a, b in zip(arrows[:-1], arrows[1:]):
        if b - a > 0.3:
            m, s = (a + b) / 2, np.sign(c.gh((a + b) / 2)[1]) * 0.16
            axes.annotate("", (m + s, 0), (m - s, 0), arrowprops={"arrowstyle": "->", "color": BLUE, "lw": 1.6})
    axes.set_xticks(np.arange(5) * np.pi / 2, ["0", "pi/2", "pi", "3 pi/2", "2 pi"])
    axes.set_xlabel("direction of slip phi")
    axes.legend(frameon=False, ncol=3, loc="upper right")
    save(figure, "rates.svg")


def portrait(axes, field, rays, radius):
    grid = np.linspace(-radius, radius, 260)
    x, y = np.meshgrid(grid, grid)
    phi = np.arctan2(y, x)
    u, v = field(phi)
    axes.streamplot(grid, grid, u, v, color=GREY, linewidth=0.7, arrowsize=0.8, density=0.9)
    for angle, colour, style in rays:
        axes.plot([0, radius * np.cos(angle)], [0, radius * np.sin(angle)], color=colour, ls=style, lw=2)
    axes.set_aspect("equal")
    axes.set_xlim(-radius, radius)
    axes.set_ylim(-radius, radius)
    axes.set_xlabel("v_t")


def portraits():
    figure, both = plt.subplots(1, 2, figsize=(6.8, 3.4), sharey=True)
    for axes, mu in zip(both, (0.6, 1.6)):
        c = Contact(*SLEDS, mu)

        def field(phi):
            g, h = c.gh(phi)
            return g * np.cos(phi) - h * np.sin(phi), g * np.sin(phi) + h * np.cos(phi)

        rays = []
        for zero in c.zeros():
            grows = c.gh(zero)[0] > 0
            rays.append((zero, RED if grows else BLUE, "-" if c.slope(zero) < 0 else "--"))
        portrait(axes, field, rays, 1.2)
        axes.set_title(f"mu = {mu}", fontsize=9)
    both[0].set_ylabel("v_s")
    save(figure, "portraits.svg")


def reach():
    figure, axes = plt.subplots(figsize=(6.6, 2.6))
    theta, total = 1.9, 3.28
    start = -3.0
    for number in range(4):
        d = start
        away = np.hypot(d, theta)
        length = min(2 * (2 * total * away + 4 * d) / (total**2 - 4), 9.0)
        middle = start + length / 2
        major, minor = total / 2 * length / 2, np.sqrt((total / 2) ** 2 - 1) * length / 2
        t = np.linspace(0, 2 * np.pi, 200)
        colour = (BLUE, GREEN)[number % 2]
        axes.plot(middle + major * np.cos(t), minor * np.sin(t), color=colour, lw=0.9)
        axes.plot([start, start + length], [0, 0], color=colour, lw=3, solid_capstyle="butt")
        start += length
    axes.plot([0, 0], [theta, -theta], "x", color=RED, ms=8, mew=2)
    axes.axhline(0, color="black", lw=0.6)
    axes.set_aspect("equal")
    axes.set_xlim(-6, 14)
    axes.set_ylim(-5, 5)
    axes.set_xlabel("Re lambda, from the modulus of the zeros of q")
    axes.set_ylabel("Im lambda")
    save(figure, "reach.svg")


def several():
    b, t = np.array([3.8, -3.8]), np.array([[6.5, -1.91], [-1.91, 4.7]])
    nn, mu, beta_n, beta = 4.0, 0.6, -1.0, np.array([0.0, 1.5])

    def field(phi):
        c, s = np.cos(phi), np.sin(phi)
        normal = -beta_n / (nn - mu * (b[0] * c + b[1] * s))
        return (
            (b[0] - mu * (t[0, 0] * c + t[0, 1] * s)) * normal + beta[0],
            (b[1] - mu * (t[1, 0] * c + t[1, 1] * s)) * normal + beta[1],
        )

    phi = np.linspace(0, 2 * np.pi, 100001)
    u, v = field(phi)
    h = -u * np.sin(phi) + v * np.cos(phi)
    rays = []
    for k in np.flatnonzero(h[:-1] * h[1:] <= 0):
        grows = u[k] * np.cos(phi[k]) + v[k] * np.sin(phi[k]) > 0
        rays.append((phi[k], RED if grows else BLUE, "-" if h[k + 1] < h[k] else "--"))
    figure, axes = plt.subplots(figsize=(3.6, 3.4))
    portrait(axes, field, rays, 1.0)
    axes.set_ylabel("v_s")
    save(figure, "several_modes.svg")


def modes():
    """Which modes of a planar contact without slip fit, by the direction of its free acceleration."""
    a, b, t = 1.0, 0.8, 1.0
    angle = np.linspace(0, 2 * np.pi, 7201)
    beta_t, beta_n = np.cos(angle), np.sin(angle)
    figure, panels = plt.subplots(1, 2, figsize=(6.4, 3.4), subplot_kw={"projection": "polar"})
    names = ["separate", "stick", "slip begins along +t", "slip begins along -t"]
    for axes, mu in zip(panels, [0.6, 1.6]):
        determinant = a * t - b * b
        lambda_n = -(t * beta_n - b * beta_t) / determinant
        lambda_t = -(a * beta_t - b * beta_n) / determinant
        fits = [beta_n > 0, (lambda_n >= 0) & (abs(lambda_t) <= mu * lambda_n)]
        for d in [1, -1]:
            f = a - mu * b * d
            pressed = -beta_n / f
            gamma = ((b - mu * t * d) * pressed + beta_t) * d
            fits.append((pressed > 0) & (gamma > 0))
        for ring, (fit, colour) in enumerate(zip(fits, [GREY, GREEN, BLUE, RED])):
            radius = np.where(fit, 1.0 - 0.17 * ring, np.nan)
            axes.plot(angle, radius, color=colour, linewidth=7, solid_capstyle="butt", label=names[ring])
        count = sum(fit.astype(int) for fit in fits)
        print(f"mu |b| / m_nn = {mu * b / a:.2f}: {set(count[(angle % 0.1) > 0.01].tolist())} modes fit")
        axes.set_ylim(0, 1.1)
        axes.set_yticks([])
        axes.set_xticks([0, np.pi / 2, np.pi, 3 * np.pi / 2])
        axes.set_xticklabels(["$\\beta_t$", "$\\beta_n$", "", ""])
        axes.set_title(f"$\\mu |b|$ = {mu * b / a:.2f} $m_{{nn}}$", fontsize=9)
    panels[0].legend(loc="upper center", bbox_to_anchor=(1.15, -0.04), ncols=2, frameon=False)
    save(figure, "modes.svg")


def springs(velocities, n):
    """Balls of mass 1 that touch, on equal linear springs that are much stiffer than all else: their velocities after."""
    x, v, step = np.zeros(n), np.array(velocities, float), 1e-4
    force = lambda x: np.diff(np.concatenate(([0.0], np.maximum(-np.diff(x), 0.0), [0.0]))) * -1.0
    while True:
        v += 0.5 * step * force(x)
        x += step * v
        v += 0.5 * step * force(x)
        if (np.diff(x) > 0).all() and (np.diff(v) >= 0).all():
            return v


def struck_alone(w, v, mu, e, steps=2000):
    """The impulse (n, t) of one planar contact by Poisson's hypothesis: Routh's method in small steps."""
    p = np.zeros(2)
    size = -v[0] / w[0, 0] / steps
    end = np.inf
    while p[0] < end:
        now = v + w @ p
        if end == np.inf and now[0] >= 0:
            end = (1 + e) * p[0]
        hold = -w[0, 1] / w[1, 1]
        slip = now[1]
        if abs(slip) < 2 * size * w[1, 1] and abs(hold) <= mu:
            # It sticks: what is left of the slip goes, too.
            p += [size, hold * size - slip / w[1, 1]]
        else:
            direction = np.sign(slip) if abs(slip) > 2 * size * w[1, 1] else -np.sign(hold)
            p += [size, -mu * direction * size]
    return p


def thrown_flat(u, mu, e, ratio=1.0):
    """A box of mass 1 and half width 1 that falls flat with speed 1 and slides with u: its angular velocity after
    impacts of its corners one after the other, all at once by Moreau's law, and by Poisson's hypothesis."""
    h, inertia = ratio, (1 + ratio**2) / 3
    rows = [np.array([[0, 1, x], [1, 0, h]], float) for x in (-1.0, 1.0)]  # n and t by (vx, vz, omega)
    inverse = np.diag([1, 1, 1 / inertia])
    state = np.array([u, -1.0, 0.0])
    while True:
        normal = [(row @ state)[0] for row in rows]
        first = int(np.argmin(normal))
        if normal[first] > -1e-6:
            break
        row = rows[first]
        state = state + inverse @ row.T @ struck_alone(row @ inverse @ row.T, row @ state, mu, e)
    # Poisson: compression leaves (u - mu, 0, 0) or rest, and each corner half of the weight, more at the leading one.
    stopped = min(u, mu)
    left, turned = u - stopped, e * h * stopped
    friction = np.clip(-(left + h * turned / inertia) / (1 + h**2 / inertia), -mu * e, mu * e)
    return state[2], 0.0, (turned + h * friction) / inertia


def at_once():
    """Where the laws of impacts of several contacts differ."""
    figure, (balls, box) = plt.subplots(1, 2, figsize=(6.6, 2.9))
    rows = [
        ("one after the other", [0.0, 0.0, 1.0], BLUE),
        ("Moreau, Poisson", [-1 / 3, 2 / 3, 2 / 3], GREEN),
        ("Liu, Zhao, Brogliato", springs([1, 0, 0], 3), RED),
    ]
    for k, (name, speeds, colour) in enumerate(rows):
        print(name, np.round(speeds, 3))
        balls.bar(np.arange(3) + 0.25 * (k - 1), speeds, 0.22, color=colour, label=name)
    balls.axhline(0, color=GREY, linewidth=0.6)
    balls.set_xticks(range(3), ["struck with 1", "middle", "last"])
    balls.set_ylabel("speed after")
    balls.legend(frameon=False, fontsize=7.5, loc="upper left")
    slides = np.linspace(0, 1.5, 61)
    after = np.array([thrown_flat(u, 0.5, 0.5) for u in slides])
    for column, name, colour in [(0, "one after the other", BLUE), (1, "Moreau", GREY), (2, "Poisson", GREEN)]:
        box.plot(slides, after[:, column], color=colour, label=name)
    box.set_yticks([-0.1, 0, 0.1])
    box.set_xlabel("speed of sliding / speed of falling")
    box.set_ylabel("angular velocity after, in v / a")
    box.legend(frameon=False, fontsize=7.5)
    save(figure, "at_once.svg")


rates()
portraits()
reach()
several()
modes()
at_once()
