// The hodograph of a collision: the velocity of slip during contact, and the normal velocity over the impulse.

const NS = "http://www.w3.org/2000/svg";
const node = (parent, tag, attributes, text) => {
  const made = document.createElementNS(NS, tag);
  for (const name in attributes) made.setAttribute(name, attributes[name]);
  if (text) made.textContent = text;
  return parent.appendChild(made);
};
const short = (x) => {
  const small = x !== 0 && Math.abs(x) < 1e-3;
  return (small ? x.toExponential(1) : String(+x.toPrecision(3))).replaceAll("-", "\u2212");
};

// A panel with axes; `equal`: the same scale along both.
const panel = (label, points, names, equal, marks) => {
  const [w, h, pad] = [300, 240, 46];
  const svg = document.createElementNS(NS, "svg");
  svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", label);
  const bound = (i) => points.reduce(([a, b], p) => [Math.min(a, p[i]), Math.max(b, p[i])], [0, 0]);
  let [[x0, x1], [y0, y1]] = [bound(0), bound(1)];
  const least = 1e-9 + 0.02 * Math.max(x1 - x0, y1 - y0);
  if (equal) {
    const size = Math.max((x1 - x0) / (w - 2 * pad), (y1 - y0) / (h - 2 * pad), least / w);
    const grow = (a, b, room) => [(a + b) / 2 - (size * room) / 2, (a + b) / 2 + (size * room) / 2];
    [x0, x1] = grow(x0, x1, w - 2 * pad);
    [y0, y1] = grow(y0, y1, h - 2 * pad);
  } else {
    if (x1 - x0 < least) x1 = x0 + least;
    if (y1 - y0 < least) y1 = y0 + least;
  }
  const x = (v) => pad + ((v - x0) / (x1 - x0)) * (w - 2 * pad);
  const y = (v) => h - pad - ((v - y0) / (y1 - y0)) * (h - 2 * pad);
  node(svg, "line", { class: "axis", x1: pad, x2: w - pad, y1: y(0), y2: y(0) });
  node(svg, "line", { class: "axis", x1: x(0), x2: x(0), y1: pad - 12, y2: h - pad });
  node(svg, "text", { class: "number", x: w - pad, y: h - 12, "text-anchor": "end" }, names[0]);
  node(svg, "text", { class: "number", x: pad - 8, y: 22 }, names[1]);
  for (const [v, at] of [
    [x0, x(x0)],
    [x1, x(x1)],
  ])
    node(svg, "text", { class: "number", x: at, y: h - pad + 16, "text-anchor": "middle" }, short(v));
  for (const v of [y0, y1])
    node(svg, "text", { class: "number", x: pad - 6, y: y(v) + 4, "text-anchor": "end" }, short(v));
  node(svg, "path", {
    class: "curve",
    style: "stroke:var(--c0)",
    d: points.map((p, i) => `${i ? "L" : "M"}${x(p[0]).toFixed(1)} ${y(p[1]).toFixed(1)}`).join(""),
  });
  const dot = (p, kind, title) =>
    node(node(svg, "circle", { class: kind, cx: x(p[0]), cy: y(p[1]), r: 4.5 }), "title", {}, title);
  dot(points[0], "begin", "approach");
  dot(points[points.length - 1], "end", "separation");
  for (const [title, p] of marks) if (p) dot(p, "point", title);
  return svg;
};

/** Shows a course in an element. */
export function showCourse(root, collision, course, name) {
  const points = course.points;
  const near = (impulse) =>
    impulse === null || impulse === undefined
      ? null
      : points.reduce((best, p) => (Math.abs(p[3] - impulse) < Math.abs(best[3] - impulse) ? p : best));
  const [slip, compressed] = [near(course.slip_end), near(course.compression_end)];
  root.replaceChildren();
  const heading = document.createElement("h2");
  heading.textContent = `Collision at ${name}: \u03bc = ${short(collision.mu)}, e = ${short(collision.e)}, ${collision.law}`;
  const panels = document.createElement("div");
  panels.className = "panels";
  panels.append(
    panel(
      "The hodograph: slip velocity v_s over v_t",
      points.map((p) => [p[0], p[1]]),
      ["v\u209c [m/s]", "v\u209b [m/s]"],
      true,
      [["slip ends", slip && [slip[0], slip[1]]]],
    ),
    panel(
      "The normal velocity over the normal impulse",
      points.map((p) => [p[3], p[2]]),
      ["normal impulse [N\u00b7s]", "v\u2099 [m/s]"],
      false,
      [
        ["slip ends", slip && [slip[3], slip[2]]],
        ["compression ends", compressed && [compressed[3], compressed[2]]],
      ],
    ),
  );
  const note = document.createElement("p");
  note.className = "help";
  note.textContent =
    "First the hodograph, how the velocity of slip changes during contact; then the normal velocity over the normal impulse. " +
    "Full dot: approach; ring: separation.";
  root.append(heading, panels, note);
}
