// The files of a model: a tab for each, and what is wrong with all of them.

/** What a new file of parts holds. */
const PART = `/// A rod on a hinge.
part Rod(hinge: point, base: frame) {
    parameters { l: m = 1, m: kg = 1 }
    coordinates { q: rad = 0.1 }
    speeds { u: rad/s }
    frames { B = base.rotate(z, q); }
    points { tip = hinge - l*B.y; }
    particles { Bob { point: tip, mass: m } }
}
`;
const plain = (name) => /^(?!\/)[\w. /-]+$/.test(name);

/** Tabs in an element for the files of an editor. */
export function makeTabs(root, editor) {
  const button = (text, run, attributes = {}) => {
    const node = document.createElement("button");
    node.type = "button";
    node.textContent = text;
    for (const name in attributes) node.setAttribute(name, attributes[name]);
    node.addEventListener("click", run);
    return node;
  };
  const add = (asked) => {
    const name = (asked ?? prompt("The name of a file of parts, as `import` gives it", "part.mech") ?? "").trim();
    if (!name) return;
    const at = editor.names().indexOf(name);
    if (at >= 0) return editor.open(at);
    if (plain(name)) editor.add(name, PART);
  };
  let known = "";
  return {
    /** Makes a file of this name, if there is none. */
    add,
    show() {
      const names = editor.names();
      // a button that is pressed stays
      const now = JSON.stringify([names, editor.active()]);
      if (now === known) return;
      known = now;
      const tabs = names.map((name, index) =>
        button(name, () => editor.open(index), {
          role: "tab",
          "aria-selected": String(index === editor.active()),
        }),
      );
      const others = names.slice(1).map((name, index) =>
        button("\u00d7", () => confirm(`Remove ${name}?`) && editor.remove(index + 1), {
          class: "remove",
          "aria-label": `Remove ${name}`,
          title: `Remove ${name}`,
        }),
      );
      const list = document.createElement("div");
      list.setAttribute("role", "tablist");
      list.setAttribute("aria-label", "Files");
      list.append(...tabs);
      const shown = others.slice(editor.active() - 1, editor.active());
      root.replaceChildren(list, ...shown, button("+ file", () => add()));
    },
  };
}

/**
 * What is found in the file that is shown, and in all: `ofModel` is what the model and its imports have, `own` what the
 * file has by itself.
 */
export function findings(editor, ofModel, own, add) {
  const names = editor.names(),
    shown = names[editor.active()];
  const placed = (answer, name) =>
    answer.findings.map((found) => ({
      ...found,
      file: name,
      fixes: found.fixes.map((fix) => ({ ...fix, file: fix.file || name })),
    }));
  const there = (found) =>
    found.there ? { ...found, file: found.there.file, from: found.there.from, to: found.there.to } : found;
  const ofAll = placed(ofModel, names[0]);
  let here = ofAll;
  if (own !== ofModel) {
    const inIt = ofAll.map(there).filter((found) => found.file === shown);
    const more = placed(own, shown).filter(
      (found) => !inIt.some((other) => other.code === found.code && other.from === found.from),
    );
    here = [...inIt, ...more];
  }
  for (const found of here) {
    const path = found.code === "E090" && /^`([^`]+)` is no file of this page/.exec(found.message)?.[1];
    if (path) found.fixes.push({ title: `Make the file ${path}`, apply: () => add(path) });
  }
  const all = ofAll.map(there);
  const same = (one, other) => one.from === other.from && one.file === other.file && one.code === other.code;
  all.push(...here.filter((found) => found.file !== names[0] && !all.some((other) => same(found, other))));
  return { here, all };
}
