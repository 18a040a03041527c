// Shows a motion in an element: the mechanism, its clock, curves and events. `data` is what `Animation` writes.
// `kept` is what the answer's `keep()` gave for a motion shown before: place in time, view, choices; with
// `onTime` it is told of the time that is shown, and of the event before it.
function showMotion(root, data, kept = {}) {
  root.innerHTML = MOTION;
  const byId = (id) => root.querySelector("#" + id);
  const ended = new AbortController(), signal = ended.signal;
  const stage = byId("stage"), slider = byId("time"), clock = byId("now");
  const times = data.times, count = times.length;
  const first = count ? times[0] : 0, last = count ? times[count - 1] : 0;
  // Where the time lies between two moments: at an impact, after it.
  const moment = (t) => {
    let low = 0, high = count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= t) low = middle; else high = middle - 1;
    }
    const next = Math.min(low + 1, count - 1), step = times[next] - times[low];
    return { low, next, part: step > 0 ? (t - times[low]) / step : 0 };
  };
  const between = (list, m) => {
    const a = list[m.low], b = list[m.next];
    if (!a || !finite(a)) return null;
    if (!b || !finite(b)) return a;
    return a.map((x, i) => x + (b[i] - x) * m.part);
  };

  const up = unit(data.up) || [0, 0, 1];
  const side = unit(cross(up, Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
  const other = cross(side, up);
  const places = data.points.flatMap((p) => p.places.filter((v) => v && finite(v)));
  const marks = places.concat(data.events.map((e) => e.at).filter((v) => v && finite(v)));
  // Shapes reach beyond the points: those of some moments count too.
  const located = (shape, v, m) => {
    if (shape.frame === null) return v;
    const f = data.frames[shape.frame], e = f.axes[m], at = data.points[f.at].places[m];
    return e && at && finite(at) ? at.map((x, i) => x + v[0] * e[0][i] + v[1] * e[1][i] + v[2] * e[2][i]) : null;
  };
  const thin = [0, 1, 2].filter((i) => {
    let low = Infinity, high = -Infinity;
    for (const v of marks) { if (v[i] < low) low = v[i]; if (v[i] > high) high = v[i]; }
    return low <= high && data.points.length > 0 && high - low <= 0;
  });
  const seldom = Math.max(1, Math.floor(count / 40));
  data.shapes.filter((s) => !s.ground).forEach((s) => {
    for (let m = 0; m < count; m += seldom) s.core.forEach((v) => {
      const at = located(s, v, m);
      if (!at) return;
      if (!s.round) marks.push(at);
      else [0, 1, 2].forEach((i) => [-1, 1].forEach((sign) => marks.push(at.map((x, k) => (k === i ? x + sign * s.round : x)))));
      }
    );
  });
  const spread = (axis) => {
    let low = Infinity, high = -Infinity;
    for (const v of marks) { const x = dot(v, axis); if (x < low) low = x; if (x > high) high = x; }
    return low <= high ? [low, high] : [-1, 1];
  };
  const box = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(spread);
  const middle = box.map((b) => (b[0] + b[1]) / 2);
  const extent = Math.max(...box.map((b) => b[1] - b[0])) || 1;
  let reach = 0;
  for (const v of marks) reach = Math.max(reach, norm(plus(v, scaled(middle, -1))));
  reach = reach || 1;
  // A plane motion is looked at from straight before it.
  const home = () => {
    const flat = [0, 1, 2].filter((i) => thin.includes(i) || box[i][1] - box[i][0] < 1e-3 * extent);
    const upAxis = [0, 1, 2].find((i) => Math.abs(up[i]) > 0.99);
    if (flat.length === 1 && flat[0] !== upAxis) {
      const from = [0, 0, 0]; from[flat[0]] = flat[0] === 1 ? -1 : 1;
      return { turn: Math.atan2(dot(from, other), dot(from, side)), tilt: 0, zoom: 1, pan: [0, 0] };
    }
    if (flat.length === 1) {
      // From above, with N.x to the right; N.y where that is upwards.
      const ahead = cross(flat[0] === 0 ? [0, 1, 0] : [1, 0, 0], up);
      return { turn: Math.atan2(dot(ahead, other), dot(ahead, side)), tilt: Math.PI / 2 - 0.001, zoom: 1, pan: [0, 0] };
    }
    return { turn: 0.6, tilt: 0.35, zoom: 1, pan: [0, 0] };
  };
  let view = kept.view ? { ...kept.view } : home();
  const camera = () => {
    const flat = plus(scaled(side, Math.cos(view.turn)), scaled(other, Math.sin(view.turn)));
    const towards = plus(scaled(flat, Math.cos(view.tilt)), scaled(up, Math.sin(view.tilt)));
    const right = unit(cross(up, flat));
    return { right, above: cross(towards, right) };
  };
  // The axes of N stand beside the mechanism, in a column so wide.
  const TRIAD = 88;
  let size = [600, 400];
  const projector = () => {
    const { right, above } = camera();
    const width = Math.max(...spread(right).map((x) => Math.abs(x - dot(middle, right)))) || reach;
    const height = Math.max(...spread(above).map((x) => Math.abs(x - dot(middle, above)))) || reach;
    const half = (size[0] - TRIAD) / 2;
    const room = Math.min((half - 40) / Math.max(width, 0.02 * reach), (size[1] / 2 - 40) / Math.max(height, 0.02 * reach));
    const scale = Math.max(room, 1e-9) * view.zoom;
    const place = (v) => {
      const d = plus(v, scaled(middle, -1));
      return [TRIAD + half + view.pan[0] + scale * dot(d, right), size[1] / 2 + view.pan[1] - scale * dot(d, above)];
    };
    return { place, scale };
  };

  // What stands on the stage.
  const world = make(stage, "g"), solids = make(stage, "g"), trails = make(stage, "g"), lines = make(stage, "g"), arrows = make(stage, "g");
  const dots = make(stage, "g"), names = make(stage, "g");
  const axes = ["x", "y", "z"].map((name) => ({
    name, line: make(world, "path", "world", { fill: "none" }), text: make(world, "text", "number", { "text-anchor": "middle" }),
  }));
  axes.forEach((a) => { a.text.textContent = "N." + a.name; });
  const shapes = data.shapes.slice().sort((a, b) => b.ground - a.ground).map((s) => {
    const node = make(solids, "g", s.ground ? "solid ground" : "solid");
    make(node, "title").textContent = s.name;
    const body = make(node, "path", "body"), edges = make(node, "path", "edges");
    body.style.fill = body.style.stroke = edges.style.stroke = s.colour;
    return { shape: s, node, body, edges };
  });
  const drawShapes = (m, place, scale) => shapes.forEach(({ shape, node, body, edges }) => {
    const put = (v) => {
      const a = located(shape, v, m.low), b = located(shape, v, m.next);
      return a && place(b ? a.map((x, i) => x + (b[i] - x) * m.part) : a);
    };
    const core = shape.core.map(put).filter((p) => p);
    show(node, core.length > 0 || shape.frame === null || !!put([0, 0, 0]));
    const r = scale * shape.round;
    const wide = r > 0 ? core.flatMap((p) => rounds.map(([c, s]) => [p[0] + r * c, p[1] + r * s])) : core;
    body.setAttribute("d", written(hull(wide), "Z"));
    edges.setAttribute("d", shape.lines.map((line) => written(line.map(put).filter((p) => p), "")).join(""));
  });
  const segments = data.segments.map(() => make(lines, "line", "segment"));
  const points = data.points.map((p) => {
    const node = make(dots, "circle", p.quiet ? "point quiet" : "point", { r: p.quiet ? 2 : 4 });
    make(node, "title").textContent = p.name;
    const text = make(names, "text", "name");
    text.textContent = p.name;
    return { node, text, chosen: 0, trail: make(trails, "path", "trail") };
  });
  const frames = data.frames.map(() => [0, 1, 2].map(() => make(arrows, "path", "arrow frame")));
  const forces = data.forces.map(() => make(arrows, "path", "arrow force"));
  const happenings = data.events.map(() => ({ ring: make(arrows, "circle", "happening", { r: 9 }), arrow: make(arrows, "path", "arrow impulse") }));
  const moving = data.points.map((p) => {
    const start = p.places.find((v) => v && finite(v));
    return !!start && p.places.some((v) => v && finite(v) && norm(plus(v, scaled(start, -1))) > 1e-6 * extent);
  });
  const largest = (vectors) => vectors.reduce((most, v) => (v && finite(v) ? Math.max(most, norm(v)) : most), 0);
  const most = { impulse: largest(data.events.map((e) => e.impulse)), force: largest(data.forces.flatMap((f) => f.force)) };
  // An event is shown for a while after it.
  const hold = Math.max(0.04 * (last - first), 1e-9);

  const pointed = (node, at, vector, longest, place) => {
    const from = at && finite(at) ? place(at) : null;
    const ok = from && vector && finite(vector) && longest > 0;
    show(node, !!ok);
    if (!ok) return;
    const { right, above } = camera();
    const length = 0.22 * Math.min(size[0], size[1]) / longest;
    const to = [from[0] + length * dot(vector, right), from[1] - length * dot(vector, above)];
    node.setAttribute("d", arrow(from, to));
  };

  const corners = [[8, -8, "start"], [8, 16, "start"], [-8, -8, "end"], [-8, 16, "end"], [0, -13, "middle"], [0, 22, "middle"], [13, 4, "start"], [-13, 4, "end"]];
  const widths = data.points.map((p) => 7.6 * p.name.length + 3);
  const label = (taken, index, at) => {
    const point = points[index], width = widths[index];
    const order = [point.chosen, ...corners.keys()];
    for (const choice of order) {
      const [dx, dy, anchor] = corners[choice], x = at[0] + dx, y = at[1] + dy;
      const left = anchor === "start" ? x : anchor === "end" ? x - width : x - width / 2;
      const rect = [left, y - 12, left + width, y + 4];
      const inside = rect[0] >= 1 && rect[1] >= 1 && rect[2] <= size[0] - 1 && rect[3] <= size[1] - 1;
      if (inside && taken.every((r) => rect[2] < r[0] || r[2] < rect[0] || rect[3] < r[1] || r[3] < rect[1])) {
        taken.push(rect);
        point.chosen = choice;
        set(point.text, { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor });
        return true;
      }
    }
    return false;
  };

  const drawTrails = () => {
    const { place } = projector();
    points.forEach((p, i) => {
      const drawn = moving[i] && !data.points[i].quiet;
      show(p.trail, drawn && byId("trails").checked);
      if (!drawn) return;
      let path = "", pen = false, before = [NaN, NaN];
      for (const v of data.points[i].places) {
        if (!v || !finite(v)) { pen = false; continue; }
        const at = place(v);
        if (pen && Math.hypot(at[0] - before[0], at[1] - before[1]) < 0.7) continue;
        path += `${pen ? "L" : "M"}${at[0].toFixed(1)} ${at[1].toFixed(1)}`;
        pen = true; before = at;
      }
      p.trail.setAttribute("d", path);
    });
    const long = 24, { right, above } = camera(), foot = [TRIAD / 2 + 2, size[1] - 46], taken = [];
    axes.forEach((a, i) => {
      const e = [0, 0, 0]; e[i] = 1;
      const d = [dot(e, right), -dot(e, above)], n = Math.hypot(d[0], d[1]);
      const to = [foot[0] + long * d[0], foot[1] + long * d[1]];
      a.line.setAttribute("d", arrow(foot, to));
      const x = n > 0.05 ? Math.max(14, to[0] + 11 * d[0] / n) : 0, y = n > 0.05 ? to[1] + 11 * d[1] / n + 4 : 0;
      const free = n > 0.25 && taken.every((t) => Math.abs(t[0] - x) > 26 || Math.abs(t[1] - y) > 14);
      show(a.text, free);
      if (free) { taken.push([x, y]); set(a.text, { x: x.toFixed(1), y: y.toFixed(1) }); }
    });
  };

  let now = first, announced = NaN;
  const draw = () => {
    const m = moment(now), { place, scale } = projector();
    const at = data.points.map((p) => { const v = between(p.places, m); return v ? place(v) : null; });
    drawShapes(m, place, scale);
    data.segments.forEach(([a, b], i) => {
      const shown = at[a] && at[b];
      show(segments[i], !!shown);
      if (shown) set(segments[i], { x1: at[a][0].toFixed(2), y1: at[a][1].toFixed(2), x2: at[b][0].toFixed(2), y2: at[b][1].toFixed(2) });
    });
    const taken = [];
    points.forEach((p, i) => {
      show(p.node, !!at[i]);
      if (at[i]) set(p.node, { cx: at[i][0].toFixed(2), cy: at[i][1].toFixed(2) });
      show(p.text, !!at[i] && !data.points[i].quiet && byId("names").checked && label(taken, i, at[i]));
    });
    const { right, above } = camera();
    data.frames.forEach((f, i) => [0, 1, 2].forEach((axis) => {
      const e = f.axes[m.low] && f.axes[m.low][axis], from = at[f.at];
      show(frames[i][axis], !!(e && from));
      if (e && from) frames[i][axis].setAttribute("d", arrow(from, [from[0] + 26 * dot(e, right), from[1] - 26 * dot(e, above)]));
    }));
    data.forces.forEach((f, i) => pointed(forces[i], f.at[m.low], f.force[m.low], most.force, place));
    data.events.forEach((e, i) => {
      const shown = e.time <= now && now < e.time + hold && e.at && finite(e.at);
      show(happenings[i].ring, !!shown);
      if (shown) { const [cx, cy] = place(e.at); set(happenings[i].ring, { cx: cx.toFixed(1), cy: cy.toFixed(1) }); }
      if (shown) pointed(happenings[i].arrow, e.at, e.impulse, most.impulse, place); else show(happenings[i].arrow, false);
    });
    slider.value = now;
    clock.value = minus(now.toFixed(digits)) + " s";
    slider.setAttribute("aria-valuetext", clock.value);
    follow();
    cursors.forEach((c) => c());
    let current = -1;
    data.events.forEach((e, i) => { if (e.time <= now) current = i; });
    if (current !== marked) {
      if (buttons[marked]) buttons[marked].removeAttribute("aria-current");
      if (buttons[current]) buttons[current].setAttribute("aria-current", "true");
      marked = current;
    }
    if (kept.onTime && announced !== now) kept.onTime(announced = now, current);
  };
  const digits = Math.max(2, Math.min(9, 3 - Math.floor(Math.log10(Math.max(last - first, 1e-6)))));

  // An event in words.
  const told = (e) => {
    const impulse = e.impulse && finite(e.impulse) ? `, impulse ${norm(e.impulse).toPrecision(4)} N\u00b7s` : "";
    return `${minus(e.time.toFixed(Math.max(digits, 4)))} s: ${e.label}${e.contact ? ` at ${e.contact}` : ""}${impulse}`;
  };

  // Curves below: one chart for each panel, all over the same part of the time, which can be narrowed.
  const cursors = [], charts = [];
  let left = 60, shown = [first, last];
  const drawCharts = () => {
    left = Math.max(60, ...charts.map((chart) => chart.measure()));
    charts.forEach((chart) => chart.draw());
    cursors.forEach((c) => c());
  };
  // The part of the time so many times as long, around a time that stays where it is.
  const narrow = (by, around) => {
    const whole = last - first, length = Math.min(whole, Math.max(whole / 1e6, (shown[1] - shown[0]) * by));
    const share = (around - shown[0]) / (shown[1] - shown[0] || 1);
    const from = Math.min(last - length, Math.max(first, around - share * length));
    shown = [from, from + length];
    drawCharts();
  };
  // Where time has run out of the part that is shown, the part follows.
  const follow = () => {
    if (now >= shown[0] && now <= shown[1]) return;
    const length = shown[1] - shown[0];
    const from = Math.min(last - length, Math.max(first, now - 0.1 * length));
    shown = [from, from + length];
    drawCharts();
  };
  const panels = [...new Set(data.series.map((s) => s.panel))];
  panels.forEach((panel) => {
    const all = data.series.filter((s) => s.panel === panel), units = [...new Set(all.map((s) => s.unit))];
    const heading = document.createElement("h2");
    heading.textContent = panel + (units.length === 1 && units[0] ? ` [${units[0]}]` : "");
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("class", "chart");
    svg.setAttribute("role", "img");
    svg.setAttribute("aria-label", `${panel} over time: ${all.map((s) => s.name).join(", ")}`);
    const key = document.createElement("ul");
    key.className = "key";
    all.forEach((s, i) => {
      const item = document.createElement("li"), sample = document.createElementNS(SVG, "svg");
      sample.setAttribute("viewBox", "0 0 36 10");
      sample.setAttribute("aria-hidden", "true");
      make(sample, "path", "curve", { d: "M0 5L36 5", ...look(i) });
      item.append(sample, s.name + (units.length > 1 && s.unit ? ` [${s.unit}]` : ""));
      key.append(item);
    });
    byId("curves").append(heading, svg, key);
    let low = -1, high = 1, width = 100, height = 100;
    const x = (t) => left + (shown[1] > shown[0] ? (t - shown[0]) / (shown[1] - shown[0]) : 0) * (width - left - 12);
    const y = (v) => 8 + (high - v) / (high - low) * (height - 36);
    const cursor = document.createElementNS(SVG, "line");
    cursor.setAttribute("class", "cursor");
    // The range of what is shown.
    const measure = () => {
      low = Infinity; high = -Infinity;
      const see = (v) => { if (v < low) low = v; if (v > high) high = v; };
      for (const s of all) {
        s.values.forEach((v, k) => { if (v !== null && times[k] >= shown[0] && times[k] <= shown[1]) see(v); });
        // Between two moments the curves are straight.
        for (const end of shown) {
          const m = moment(end), a = s.values[m.low], b = s.values[m.next];
          if (a !== null && a !== undefined && b !== null) see(a + (b - a) * m.part);
        }
      }
      if (!(low <= high)) { low = -1; high = 1; }
      const margin = Math.max(0.06 * (high - low), 1e-6 * Math.max(Math.abs(low), Math.abs(high))) || 1;
      low -= margin; high += margin;
      return 16 + 7 * Math.max(...numbers(low, high, 5).map((r) => r[1].length), 1);
    };
    const draw = () => {
      width = svg.clientWidth || 600; height = svg.clientHeight || 170;
      svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      svg.replaceChildren();
      numbers(low, high, 5).forEach(([v, text]) => {
        make(svg, "line", v === 0 ? "axis" : "grid", { x1: left, x2: width - 12, y1: y(v).toFixed(1), y2: y(v).toFixed(1) });
        make(svg, "text", "number", { x: left - 7, y: (y(v) + 4).toFixed(1), "text-anchor": "end" }).textContent = text;
      });
      if (shown[1] > shown[0]) numbers(shown[0], shown[1], Math.max(2, Math.floor(width / 110))).forEach(([t, text]) => {
        make(svg, "line", "grid", { x1: x(t).toFixed(1), x2: x(t).toFixed(1), y1: 8, y2: height - 28 });
        const anchor = x(t) > width - 34 ? "end" : "middle";
        make(svg, "text", "number", { x: Math.min(x(t), width - 4).toFixed(1), y: height - 12, "text-anchor": anchor }).textContent = text + " s";
      });
      // What is outside of the part that is shown is cut off.
      const inner = Math.max(width - left - 12, 1);
      // Where the style sheet does not size nested pictures the attributes do.
      const plot = make(svg, "svg", "", { x: left, y: 0, width: inner, height, viewBox: `${left} 0 ${inner} ${height}` });
      plot.style.width = `${inner}px`; plot.style.height = `${height}px`;
      let before = -9;
      data.events.forEach((e) => {
        const at = x(e.time);
        if (e.time < shown[0] || e.time > shown[1] || at - before < 1) return;
        before = at;
        const line = make(svg, "line", "mark", { x1: at.toFixed(1), x2: at.toFixed(1), y1: 8, y2: height - 28 });
        make(line, "title").textContent = told(e);
      });
      all.forEach((s, i) => {
        let path = "", pen = false, before = -1e9, beforeY = -9;
        s.values.forEach((v, k) => {
          if (v === null) { pen = false; return; }
          // What is far outside of the part shown is left out, but for one place on either side.
          if ((times[k + 1] < shown[0]) || (times[k - 1] > shown[1])) { pen = false; return; }
          const px = x(times[k]), py = y(v);
          if (pen && px - before < 0.3 && Math.abs(py - beforeY) < 0.3 && k < count - 1) return;
          path += `${pen ? "L" : "M"}${px.toFixed(2)} ${py.toFixed(2)}`;
          pen = true; before = px; beforeY = py;
        });
        make(plot, "path", "curve", { d: path, ...look(i) });
      });
      svg.append(cursor);
      set(cursor, { y1: 8, y2: height - 28 });
    };
    charts.push({ measure, draw });
    cursors.push(() => {
      show(cursor, now >= shown[0] && now <= shown[1]);
      set(cursor, { x1: x(now).toFixed(2), x2: x(now).toFixed(2) });
    });
    const timeAt = (event) => {
      const at = (event.clientX - svg.getBoundingClientRect().left - left) / Math.max(width - left - 12, 1);
      return shown[0] + Math.min(1, Math.max(0, at)) * (shown[1] - shown[0]);
    };
    const seek = (event) => go(timeAt(event));
    svg.addEventListener("pointerdown", (event) => { svg.setPointerCapture(event.pointerId); pause(); seek(event); });
    svg.addEventListener("pointermove", (event) => { if (event.buttons) seek(event); });
    // The wheel scrolls the page, unless a key says that it is for the time.
    svg.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      narrow(Math.exp((event.deltaY || event.deltaX) / 300), timeAt(event));
    }, { passive: false });
    svg.addEventListener("dblclick", () => { shown = [first, last]; drawCharts(); });
  });
  show(byId("zoom"), data.series.length > 0 && last > first);
  byId("closer").addEventListener("click", () => narrow(0.5, Math.min(shown[1], Math.max(shown[0], now))));
  byId("farther").addEventListener("click", () => narrow(2, Math.min(shown[1], Math.max(shown[0], now))));
  byId("whole").addEventListener("click", () => { shown = [first, last]; drawCharts(); });
  data.notes.forEach((text) => {
    const note = document.createElement("p");
    note.className = "help";
    note.textContent = text;
    byId("curves").append(note);
  });

  // Events, each a button that leads to its time.
  const buttons = [];
  let marked = -2;
  if (data.events.length) {
    const heading = document.createElement("h2"), list = document.createElement("ol");
    heading.textContent = `Events (${data.events.length})`;
    data.events.forEach((e) => {
      const item = document.createElement("li"), button = document.createElement("button");
      button.type = "button";
      button.textContent = told(e);
      button.addEventListener("click", () => { pause(); go(e.time); });
      item.append(button); list.append(item); buttons.push(button);
    });
    byId("events").append(heading, list);
  }
  const keyed = (kind, text) => {
    const item = document.createElement("li"), sample = document.createElementNS(SVG, "svg");
    sample.setAttribute("viewBox", "0 0 36 10");
    sample.setAttribute("aria-hidden", "true");
    make(sample, "path", `arrow ${kind}`, { d: arrow([1, 5], [35, 5]) });
    item.append(sample, text);
    byId("key").append(item);
  };
  if (most.impulse > 0) keyed("impulse", `impulse, longest ${most.impulse.toPrecision(3)} N\u00b7s`);
  if (most.force > 0) keyed("force", `force, longest ${most.force.toPrecision(3)} N`);

  // Time runs.
  const speeds = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
  const wanted = last - first >= 2 && last - first <= 30 ? 1 : (last - first) / 8;
  const nearest = speeds.reduce((best, s) => (Math.abs(Math.log(s / wanted)) < Math.abs(Math.log(best / wanted)) ? s : best), 1);
  const speed = byId("speed");
  speeds.filter((s) => s >= nearest / 110 && s <= nearest * 11).forEach((s) => {
    const option = document.createElement("option");
    option.value = s; option.textContent = `${s}\u00d7`; option.selected = s === (kept.speed || nearest);
    speed.append(option);
  });
  let running = false, clockBefore = 0;
  const play = byId("play");
  // The signs are drawn: not every font has them.
  const sign = make(play, "svg", "", { viewBox: "0 0 20 20", "aria-hidden": "true" });
  const outline = make(sign, "path", "");
  const shape = (text, path) => { play.setAttribute("aria-label", text); outline.setAttribute("d", path); };
  const pause = () => { running = false; shape("Play", "M4 2L18 10L4 18Z"); };
  const start = () => {
    if (now >= last) now = first;
    running = true; clockBefore = performance.now();
    shape("Pause", "M4 2H8V18H4ZM12 2H16V18H12Z");
    requestAnimationFrame(tick);
  };
  pause();
  const tick = () => {
    if (!running) return;
    const clockNow = performance.now();
    now = Math.min(last, now + (clockNow - clockBefore) / 1000 * Number(speed.value));
    clockBefore = clockNow;
    draw();
    if (now >= last) pause(); else requestAnimationFrame(tick);
  };
  const go = (t) => { now = Math.min(last, Math.max(first, t)); draw(); };
  // To the event after or before the time that is shown, and there stands.
  const jump = (by) => {
    pause();
    const all = data.events.map((e) => e.time);
    const to = by > 0 ? all.find((t) => t > now) : all.reverse().find((t) => t < now);
    go(to === undefined ? (by > 0 ? last : first) : to);
  };
  byId("before").addEventListener("click", () => jump(-1));
  byId("after").addEventListener("click", () => jump(1));
  const hop = (by) => {
    pause();
    const m = moment(now);
    let index = by > 0 ? m.low + 1 : m.part > 0 ? m.low : m.low - 1;
    // Moments at the same time look alike in the picture: go on to another time.
    while (by < 0 && index > 0 && times[index] >= now) index--;
    go(times[Math.min(count - 1, Math.max(0, index))]);
  };
  play.addEventListener("click", () => (running ? pause() : start()));
  set(slider, { min: first, max: last });
  slider.addEventListener("input", () => { pause(); go(Number(slider.value)); });
  document.addEventListener("keydown", (event) => {
    const field = event.target.closest("button, select, input");
    if (event.target !== document.body && !root.contains(event.target)) return;
    if (event.altKey || event.ctrlKey || event.metaKey || event.target === speed) return;
    const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (event.shiftKey && turn) { rotate(turn[0], turn[1]); }
    else if (event.key === " " && !(field && field !== slider)) { running ? pause() : start(); }
    else if (event.key === "ArrowLeft") hop(-1);
    else if (event.key === "ArrowRight") hop(1);
    else if (event.key === "+" || event.key === "=") closer(1.25);
    else if (event.key === "-") closer(0.8);
    else if (event.key === "." || event.key === ",") jump(event.key === "." ? 1 : -1);
    else if (event.key === "Home") { pause(); go(first); }
    else if (event.key === "End") { pause(); go(last); }
    else return;
    event.preventDefault();
  }, { signal });

  // The view turns with a pointer and comes closer with two, or a wheel.
  const pointers = new Map();
  const rotate = (turn, tilt) => {
    view.turn -= turn;
    view.tilt = Math.min(Math.PI / 2 - 0.001, Math.max(-Math.PI / 2 + 0.001, view.tilt + tilt));
    drawTrails(); draw();
  };
  const shift = (x, y) => { view.pan = [view.pan[0] + x, view.pan[1] + y]; drawTrails(); draw(); };
  const closer = (by) => { view.zoom = Math.min(50, Math.max(0.1, view.zoom * by)); drawTrails(); draw(); };
  stage.addEventListener("pointerdown", (event) => { stage.setPointerCapture(event.pointerId); pointers.set(event.pointerId, [event.clientX, event.clientY]); });
  stage.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const after = [event.clientX, event.clientY];
    const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
    pointers.set(event.pointerId, after);
    if (others.length) {
      const away = (p) => Math.hypot(p[0] - others[0][0], p[1] - others[0][1]);
      if (away(before) > 5) closer(away(after) / away(before));
      shift((after[0] - before[0]) / 2, (after[1] - before[1]) / 2);
    } else if (event.shiftKey || event.buttons > 1) shift(after[0] - before[0], after[1] - before[1]);
    else rotate((after[0] - before[0]) / 150, (after[1] - before[1]) / 150);
  });
  ["pointerup", "pointercancel"].forEach((name) => stage.addEventListener(name, (event) => pointers.delete(event.pointerId)));
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener("wheel", (event) => { event.preventDefault(); closer(Math.exp(-event.deltaY / 600)); }, { passive: false });
  byId("view").addEventListener("click", () => { view = home(); drawTrails(); draw(); });
  ["names", "trails"].forEach((id) => byId(id).addEventListener("change", () => { drawTrails(); draw(); }));

  // Events on the slider, whose knob keeps half its width from the ends.
  const ticks = byId("marks");
  const drawMarks = () => {
    const width = slider.clientWidth || 300, knob = 8;
    ticks.setAttribute("viewBox", `0 0 ${width} 8`);
    ticks.style.width = `${width}px`;
    ticks.replaceChildren();
    let before = -9;
    data.events.forEach((e) => {
      const at = knob + (last > first ? (e.time - first) / (last - first) : 0) * (width - 2 * knob);
      if (at - before < 1) return;
      before = at;
      make(ticks, "line", "mark", { x1: at.toFixed(1), x2: at.toFixed(1), y1: 0, y2: 8 });
    });
  };

  ["names", "trails"].forEach((id) => { if (kept[id] === false) byId(id).checked = false; });
  const layout = () => {
    size = [stage.clientWidth || 600, stage.clientHeight || 400];
    stage.setAttribute("viewBox", `0 0 ${size[0]} ${size[1]}`);
    drawMarks(); drawCharts(); drawTrails(); draw();
  };
  const watching = new ResizeObserver(layout);
  if (count) {
    if (kept.now !== undefined) now = Math.min(last, Math.max(first, kept.now));
    watching.observe(root);
    layout();
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (kept.running === undefined ? !still : kept.running) start();
  }
  return {
    go: (t) => { pause(); go(t); },
    pause,
    // What a motion that is shown in place of this one begins with.
    keep: () => ({
      ...kept, view: { ...view }, now, running, speed: Number(speed.value), names: byId("names").checked, trails: byId("trails").checked,
    }),
    end: () => { pause(); ended.abort(); watching.disconnect(); root.replaceChildren(); },
  };
}
