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
    surfaces = {},
    known = "",
    // of each contact, what is to be shown anew where that of all contacts changes
    follow = [];

  const row = ({ label, of = "", title, low, high, value, step, changed, set, unset }) => {
    const id = `c-${(of ? `${of}-${label}` : label).replace(/\W/g, "-")}`,
      name = of ? `${of}: ${label}` : label;
    const slider = element("input", {
      type: "range",
      min: low,
      max: high,
      step: "any",
      id,
      "aria-label": name,
    });
    const field = element("input", { type: "number", step: "any", "aria-label": `${name}, exactly` });
    const back = element(
      "button",
      { type: "button", class: "back", title: "as in the model", "aria-label": `${name} as in the model` },
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
      told();
    });
    field.addEventListener("input", () => {
      if (!Number.isFinite(field.valueAsNumber)) return;
      set(field.valueAsNumber);
      put(field.valueAsNumber, true);
      told();
    });
    const again = () => {
      const now = changed();
      put(now === undefined ? value() : now, now !== undefined);
    };
    back.addEventListener("click", () => {
      unset();
      again();
      told();
    });
    again();
    if (of) follow.push(again);
    return element(
      "div",
      { class: "row", title: title || undefined },
      element("label", { for: id }, label),
      slider,
      field,
      back,
    );
  };
  const told = () => {
    follow.forEach((again) => again());
    onChange();
  };
  const group = (title, rows, open) =>
    element("details", open ? { open: "" } : {}, element("summary", {}, title), ...rows);

  return {
    /** What was changed, as a motion is asked for. */
    asked: () => ({ values, surface, ...(Object.keys(surfaces).length ? { surfaces } : {}) }),
    /** Sets what was changed, as of an address. */
    take(asked) {
      values = { ...asked?.values };
      surface = { ...asked?.surface };
      surfaces = structuredClone(asked?.surfaces ?? {});
      known = "";
    },
    clear() {
      values = {};
      surface = {};
      surfaces = {};
      known = "";
    },
    /** Shows the quantities of a model; changes of those that it has no more are forgotten. */
    show(model) {
      const names = new Set(model.quantities.map((one) => one.name));
      for (const name of Object.keys(values)) if (!names.has(name)) delete values[name];
      const touching = new Set(model.contacts.map((one) => one.name));
      for (const name of Object.keys(surfaces)) if (!touching.has(name)) delete surfaces[name];
      const now = JSON.stringify(model);
      if (now === known) return;
      known = now;
      follow = [];
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
              value: () => one.value,
              changed: () => values[one.name],
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
            value: () => stated[name],
            changed: () => surface[name],
            set: (value) => {
              surface[name] = value;
            },
            unset: () => {
              delete surface[name];
            },
          });
        const lawOf = (id, named, usual, list) => {
          const laws = element(
            "select",
            {
              id,
              "aria-label": named,
              onchange: () => {
                if (laws.value) list().law = laws.value;
                else delete list().law;
                told();
              },
            },
            element("option", { value: "" }, usual),
            ...LAWS.map((law) => element("option", { value: law }, law)),
          );
          laws.value = list().law || "";
          return element("div", { class: "row" }, element("label", { for: id }, "law"), laws);
        };
        if (!model.contacts.some((one) => one.surface)) surface = { ...stated, ...surface };
        nodes.push(
          group(
            "Contacts",
            [
              part("mu", "friction \u03bc", 1.5),
              part("e", "restitution e", 1),
              lawOf("law", "law of all contacts", `of the model (${stated.law})`, () => surface),
            ],
            opened.get("Contacts") ?? true,
          ),
        );
        // each by itself, where there are several: what is not set here is that of all
        const some = model.contacts.some((one) => one.surface);
        for (const one of model.contacts.length > 1 ? model.contacts : []) {
          if (some && !one.surface) surfaces[one.name] = { ...stated, ...surfaces[one.name] };
          const own = () => (surfaces[one.name] ??= {});
          const tidy = () => {
            if (!Object.keys(own()).length) delete surfaces[one.name];
          };
          const part = (name, label, high) =>
            row({
              label,
              of: one.name,
              title: `of ${one.name} alone`,
              low: 0,
              high,
              value: () => surface[name] ?? (one.surface ?? stated)[name],
              changed: () => surfaces[one.name]?.[name],
              set: (value) => {
                own()[name] = value;
              },
              unset: () => {
                delete own()[name];
                tidy();
              },
            });
          const title = `Contact ${one.name}`;
          nodes.push(
            group(
              title,
              [
                part("mu", "friction \u03bc", 1.5),
                part("e", "restitution e", 1),
                lawOf(`law-${one.name}`, `law of ${one.name}`, "as of all contacts", own),
              ],
              opened.get(title) ?? false,
            ),
          );
          tidy();
        }
      }
      root.replaceChildren(...nodes);
    },
  };
}
