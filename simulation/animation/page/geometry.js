"use strict";
// Vectors, paths and numbers of drawings. A written page and the playground join these files to one script.

// A written page names no address: the parser knows this one.
const SVG = new DOMParser().parseFromString("<svg></svg>", "text/html").body.firstChild.namespaceURI;
const finite = (v) => v !== null && v.every((x) => x !== null);
const make = (parent, tag, kind, attributes) => {
  const node = document.createElementNS(SVG, tag);
  if (kind) node.setAttribute("class", kind);
  for (const name in attributes || {}) node.setAttribute(name, attributes[name]);
  return parent.appendChild(node);
};
const set = (node, attributes) => { for (const name in attributes) node.setAttribute(name, attributes[name]); };
const show = (node, shown) => { node.style.display = shown ? "" : "none"; };
const minus = (text) => text.replace("-", "\u2212");
const dashes = ["", "7 3", "8 3 1.5 3", "2 2.5", "13 3", "5 2 1.5 2 1.5 2"];
// After the last colour they begin anew, with other dashes.
const look = (i) => ({ style: `stroke:var(--c${i % 6})`, "stroke-dasharray": dashes[(i + Math.floor(i / 6)) % 6] });

// Vectors, and the direction from which one looks.
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const scaled = (a, s) => a.map((x) => x * s);
const plus = (a, b) => a.map((x, i) => x + b[i]);
const unit = (a) => { const n = norm(a); return n > 0 ? scaled(a, 1 / n) : null; };
// The outline of points on the stage: the smallest convex polygon that holds them.
const hull = (list) => {
  const sorted = list.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turns = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  const half = (points) => {
    const out = [];
    for (const p of points) {
      while (out.length > 1 && turns(out[out.length - 2], out[out.length - 1], p) <= 0) out.pop();
      out.push(p);
    }
    return out.slice(0, -1);
  };
  return sorted.length < 3 ? sorted : half(sorted).concat(half(sorted.reverse()));
};
const written = (list, end) => (list.length ? "M" + list.map((p) => `${p[0].toFixed(1)} ${p[1].toFixed(1)}`).join("L") + end : "");
const rounds = [...Array(32).keys()].map((k) => [Math.cos(k * Math.PI / 16), Math.sin(k * Math.PI / 16)]);
const arrow = (from, to) => {
  const d = [to[0] - from[0], to[1] - from[1]], n = Math.hypot(d[0], d[1]);
  if (n < 1) return "";
  const [x, y] = [d[0] / n, d[1] / n], h = Math.min(10, 0.5 * n), w = 0.45 * h;
  const at = (u, v) => `${(to[0] - h * u * x - v * w * y).toFixed(1)} ${(to[1] - h * u * y + v * w * x).toFixed(1)}`;
  return `M${from[0].toFixed(1)} ${from[1].toFixed(1)}L${to[0].toFixed(1)} ${to[1].toFixed(1)}M${at(1, 1)}L${at(0, 0)}L${at(1, -1)}`;
};
const step = (width, most) => {
  const rough = width / most, power = 10 ** Math.floor(Math.log10(rough)), times = rough / power;
  return (times <= 1 ? 1 : times <= 2 ? 2 : times <= 5 ? 5 : 10) * power;
};
const numbers = (low, high, most) => {
  const by = step(high - low, most), list = [];
  const places = Math.max(0, -Math.floor(Math.log10(by) + 1e-9));
  const text = (x) => {
    const largest = Math.max(Math.abs(low), Math.abs(high));
    if (largest >= 1e5 || largest < 1e-3) return x === 0 ? "0" : minus(String(+x.toPrecision(3)).includes("e") ? x.toExponential(1) : String(+x.toPrecision(4)));
    return minus((Math.abs(x) < by / 1e6 ? 0 : x).toFixed(Math.min(places, 9)));
  };
  for (let k = Math.ceil(low / by - 1e-9); k * by <= high + 1e-9 * by && list.length < 50; k++) list.push([k * by, text(k * by)]);
  return list;
};
