// Sliders for what a model leaves open: parameters, the start, surfaces of contacts.

const LAWS = ["newton", "poisson", "stronge"];
const TITLES = {
  parameter: "Parameters",
  input: "Inputs",
  coordinate: "Start: coordinates",
  speed: "Start: speeds",
};

const element = (tag, attributes = {}, ...children) => {
  const node = document.createElement(tag);
  for (const name in attributes) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), attributes[name]);
    else if (attributes[name] !== undefined) node.setAttribute(name, attributes[name]);
  }
  node.append(...children);
  return node;
};

// What a slider reaches: parameters that are positive stay so, others go to both sides.
const range = ({ kind, value, typical }) => {
  const size = Math.abs(value) || typical || 1;
  return kind === "parameter" && value > 0 ? [0, 3 * size] : [value - 3 * size, value + 3 * size];
};
const short = (value) => String(+value.toPrecision(6));

/** Controls in an element; `onChange` is told of every change. */
export function makeControls(root, onChange) {
  let values = {},
    surface = {},
    known = "";

  const row = ({ label, title, low, high, value, step, changed, set, unset }) => {
    const id = `c-${label.replace(/\W/g, "-")}`;
    const slider = element("input", {
      type: "range",
      min: low,
      max: high,
      step: "any",
      id,
      "aria-label": label,
    });
    const field = element("input", { type: "number", step: "any", "aria-label": `${label}, exactly` });
    const back = element(
      "button",
      { type: "button", class: "back", title: "as in the model", "aria-label": `${label} as in the model` },
      "\u21ba",
    );
    const put = (now, own) => {
      if (now < Number(slider.min)) slider.min = now;
      if (now > Number(slider.max)) slider.max = now;
      slider.value = now;
      if (document.activeElement !== field) field.value = short(now);
      slider.setAttribute("aria-valuetext", short(now));
      back.style.visibility = own ? "visible" : "hidden";
    };
    slider.step = step || (high - low) / 300;
    slider.addEventListener("input", () => {
      set(+Number(slider.value).toPrecision(5));
      put(Number(slider.value), true);
      onChange();
    });
    field.addEventListener("input", () => {
      if (!Number.isFinite(field.valueAsNumber)) return;
      set(field.valueAsNumber);
      put(field.valueAsNumber, true);
      onChange();
    });
    back.addEventListener("click", () => {
      unset();
      put(value, false);
      onChange();
    });
    put(changed === undefined ? value : changed, changed !== undefined);
    return element(
      "div",
      { class: "row", title: title || undefined },
      element("label", { for: id }, label),
      slider,
      field,
      back,
    );
  };
  const group = (title, rows, open) =>
    element("details", open ? { open: "" } : {}, element("summary", {}, title), ...rows);

  return {
    /** What was changed, as a motion is asked for. */
    asked: () => ({ values, surface }),
    /** Sets what was changed, as of an address. */
    take(asked) {
      values = { ...asked?.values };
      surface = { ...asked?.surface };
      known = "";
    },
    clear() {
      values = {};
      surface = {};
      known = "";
    },
    /** Shows the quantities of a model; changes of those that it has no more are forgotten. */
    show(model) {
      const names = new Set(model.quantities.map((one) => one.name));
      for (const name of Object.keys(values)) if (!names.has(name)) delete values[name];
      const now = JSON.stringify(model);
      if (now === known) return;
      known = now;
      const opened = new Map(
        [...root.querySelectorAll("details")].map((node) => [node.firstChild.textContent, node.open]),
      );
      const nodes = [];
      for (const kind of ["parameter", "input", "coordinate", "speed"]) {
        const rows = model.quantities
          .filter((one) => one.kind === kind)
          .map((one) => {
            const [low, high] = range(one);
            const unit = one.unit && one.unit !== "1" ? ` [${one.unit}]` : "";
            return row({
              label: one.name + unit,
              title: one.docs,
              low,
              high,
              value: one.value,
              changed: values[one.name],
              set: (value) => {
                values[one.name] = value;
              },
              unset: () => {
                delete values[one.name];
              },
            });
          });
        if (rows.length)
          nodes.push(
            group(
              TITLES[kind],
              rows,
              opened.get(TITLES[kind]) ?? (kind !== "parameter" || rows.length < 9),
            ),
          );
      }
      if (model.contacts.length) {
        const stated = model.contacts.find((one) => one.surface)?.surface || {
          mu: 0.3,
          e: 0.5,
          law: "stronge",
        };
        const part = (name, label, high) =>
          row({
            label,
            title: "of all contacts",
            low: 0,
            high,
            value: stated[name],
            changed: surface[name],
            set: (value) => {
              surface[name] = value;
            },
            unset: () => {
              delete surface[name];
            },
          });
        const laws = element(
          "select",
          {
            id: "law",
            onchange: () => {
              if (laws.value) surface.law = laws.value;
              else delete surface.law;
              onChange();
            },
          },
          element("option", { value: "" }, `of the model (${stated.law})`),
          ...LAWS.map((law) => element("option", { value: law }, law)),
        );
        laws.value = surface.law || "";
        if (!model.contacts.some((one) => one.surface)) surface = { ...stated, ...surface };
        nodes.push(
          group(
            "Contacts",
            [
              part("mu", "friction \u03bc", 1.5),
              part("e", "restitution e", 1),
              element("div", { class: "row" }, element("label", { for: "law" }, "law"), laws),
            ],
            opened.get("Contacts") ?? true,
          ),
        );
      }
      root.replaceChildren(...nodes);
    },
  };
}
