// Saves what the page shows: the model, the picture, the numbers.

const save = (name, type, text) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};

/** A table of the states: time, coordinates, speeds, and the curves, at every moment. */
export function table(answer) {
  const columns = [...answer.states, ...answer.curves];
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  const head = [
    "t [s]",
    ...columns.map(
      (one) =>
        (one.panel === "coordinates" || one.panel === "speeds" ? "" : `${one.panel} `) +
        one.name +
        (one.unit && one.unit !== "1" ? ` [${one.unit}]` : ""),
    ),
  ];
  const lines = answer.times.map((t, row) => [t, ...columns.map((one) => one.values[row] ?? "")].join(","));
  return [head.map(quoted).join(","), ...lines].join("\n") + "\n";
}

/** The stage as a file of its own: with the colours that the style sheet gives. */
export function picture(stage) {
  const copy = stage.cloneNode(true);
  const kept = [
    "fill",
    "stroke",
    "stroke-width",
    "stroke-dasharray",
    "stroke-linecap",
    "stroke-linejoin",
    "fill-opacity",
    "stroke-opacity",
    "opacity",
    "display",
    "font-family",
    "font-size",
    "paint-order",
  ];
  const from = [stage, ...stage.querySelectorAll("*")],
    to = [copy, ...copy.querySelectorAll("*")];
  from.forEach((node, index) => {
    const style = getComputedStyle(node);
    to[index].removeAttribute("class");
    to[index].setAttribute(
      "style",
      kept.map((name) => `${name}:${style.getPropertyValue(name)}`).join(";"),
    );
  });
  copy.querySelectorAll('[style*="display:none"]').forEach((node) => node.remove());
  copy.removeAttribute("id");
  copy.removeAttribute("tabindex");
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", stage.clientWidth);
  copy.setAttribute("height", stage.clientHeight);
  const ground = document.createElementNS("http://www.w3.org/2000/svg", "rect");
  ground.setAttribute("width", "100%");
  ground.setAttribute("height", "100%");
  ground.setAttribute("fill", getComputedStyle(stage).backgroundColor);
  copy.prepend(ground);
  return new XMLSerializer().serializeToString(copy);
}

export const saveModel = (name, text) => save(name.split("/").pop(), "text/plain", text);
export const saveTable = (name, answer) => save(`${name}.csv`, "text/csv", table(answer));
export const savePicture = (name, stage) => save(`${name}.svg`, "image/svg+xml", picture(stage));
