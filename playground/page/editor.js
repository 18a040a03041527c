// The editor: CodeMirror with the language service of the module.

import {
  autocompletion,
  closeBrackets,
  closeBracketsKeymap,
  completionKeymap,
} from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, indentOnInput, indentUnit } from "@codemirror/language";
import { lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState, StateEffect, StateField } from "@codemirror/state";
import {
  Decoration,
  EditorView,
  drawSelection,
  highlightActiveLine,
  hoverTooltip,
  keymap,
  lineNumbers,
} from "@codemirror/view";

const recolour = StateEffect.define();
const colours = StateField.define({
  create: () => Decoration.none,
  update(marks, change) {
    marks = marks.map(change.changes);
    for (const effect of change.effects) if (effect.is(recolour)) marks = effect.value;
    return marks;
  },
  provide: (field) => EditorView.decorations.from(field),
});
const marks = new Map();
const mark = (kind) => {
  if (!marks.has(kind)) marks.set(kind, Decoration.mark({ class: `word-${kind}` }));
  return marks.get(kind);
};

// The little Markdown that hovers have: code between lines of ``` or single signs, and bold.
const written = (text) => {
  const node = document.createElement("div");
  node.className = "told";
  text.split(/```\w*\n([\s\S]*?)```/).forEach((part, index) => {
    if (index % 2) {
      const code = document.createElement("pre");
      code.textContent = part.trimEnd();
      return node.append(code);
    }
    part
      .split(/\n+/)
      .filter((line) => line.trim())
      .forEach((line) => {
        const paragraph = document.createElement("p");
        line.split(/(`[^`]*`|\*\*[^*]*\*\*)/).forEach((piece) => {
          const tag = piece.startsWith("`") ? "code" : piece.startsWith("**") ? "strong" : null;
          if (!tag) return paragraph.append(piece);
          const inner = document.createElement(tag);
          inner.textContent = piece.replace(/^(`|\*\*)|(`|\*\*)$/g, "");
          paragraph.append(inner);
        });
        node.append(paragraph);
      });
  });
  return node;
};

const KINDS = {
  section: "namespace",
  field: "property",
  function: "function",
  member: "method",
  unit: "constant",
  word: "keyword",
  name: "variable",
  coordinate: "variable",
  speed: "variable",
  parameter: "constant",
  frame: "class",
  point: "text",
  body: "class",
};

/**
 * The editor in an element: of a model and the files that it imports, one of which is shown. `service` asks the language
 * service; `onText` is told of a new text, and of another file that is shown.
 */
export function makeEditor(parent, text, service, onText) {
  let files = [{ name: "model.mech", state: null }],
    active = 0,
    version = 0;
  const textOf = (index) => (index === active ? view.state : files[index].state).doc.toString();
  // A file and the others, as a question has them.
  const asked = (index) => ({
    text: textOf(index),
    name: files[index].name,
    files: Object.fromEntries(files.map((file, i) => [file.name, textOf(i)]).filter((_, i) => i !== index)),
  });
  const ask = (question) => service({ ...asked(active), ...question });
  const complete = async (context) => {
    const word = context.matchBefore(/[\p{L}\p{N}_]*/u);
    if (
      !context.explicit &&
      word.from === word.to &&
      !/[.({:]\s?$/.test(context.state.sliceDoc(Math.max(0, context.pos - 2), context.pos))
    )
      return null;
    const answer = await ask({ ask: "complete", at: context.pos });
    if (!answer?.proposals?.length) return null;
    const options = answer.proposals.map((one, index) => ({
      label: one.label,
      detail: one.detail,
      type: KINDS[one.kind] || "text",
      boost: Math.max(-99, 50 - index),
      info: one.docs ? () => written(one.docs) : undefined,
    }));
    return { from: word.from, options, validFor: /^[\p{L}\p{N}_]*$/u };
  };
  const hover = hoverTooltip(async (view, at) => {
    const answer = await ask({ ask: "hover", at });
    if (!answer?.text) return null;
    return { pos: answer.from, end: answer.to, above: true, create: () => ({ dom: written(answer.text) }) };
  });
  const apply = (edits, file = files[active].name) => {
    const index = files.findIndex((one) => one.name === file);
    if (index !== active) open(index);
    view.dispatch({ changes: edits, userEvent: "input.fix" });
  };
  const rename = () => {
    const at = view.state.selection.main.head,
      now = version;
    ask({ ask: "rename", at }).then(async (can) => {
      if (!can?.name) return announce(can?.refused || "nothing here can be renamed");
      const name = prompt(`A new name for ${can.name}`, can.name);
      if (!name || name === can.name) return;
      const done = await ask({ ask: "rename", at, new: name });
      if (!done?.changes || version !== now) return announce(done?.refused || "the text has changed");
      done.changes.forEach(({ file, edits }) => {
        const index = files.findIndex((one) => one.name === file);
        const change = { changes: edits, userEvent: "input.rename" };
        if (index === active) view.dispatch(change);
        else files[index].state = files[index].state.update(change).state;
      });
      changed();
    });
    return true;
  };
  const jump = () => {
    ask({ ask: "definition", at: view.state.selection.main.head }).then((place) => {
      if (place) select(place.from, place.to, place.file || files[active].name);
    });
    return true;
  };
  const format = () => {
    const now = view.state.doc.toString();
    ask({ ask: "format" }).then((answer) => {
      if (answer?.text === undefined) return announce(answer?.refused || "not formatted");
      if (view.state.doc.toString() === now) replace(answer.text);
    });
    return true;
  };
  let announce = () => {};
  const fresh = (doc) =>
    EditorState.create({
      doc,
      extensions: [
        lineNumbers(),
        lintGutter(),
        history(),
        drawSelection(),
        indentUnit.of("    "),
        indentOnInput(),
        bracketMatching(),
        closeBrackets(),
        autocompletion({ override: [complete], icons: false }),
        highlightActiveLine(),
        highlightSelectionMatches(),
        hover,
        colours,
        EditorView.lineWrapping,
        EditorView.contentAttributes.of({
          "aria-label": "The model",
          spellcheck: "false",
          autocapitalize: "off",
          autocorrect: "off",
        }),
        keymap.of([
          { key: "F2", run: rename },
          { key: "F12", run: jump },
          { key: "Shift-Alt-f", run: format },
          ...closeBracketsKeymap,
          ...defaultKeymap,
          ...searchKeymap,
          ...historyKeymap,
          ...completionKeymap,
          ...lintKeymap,
          // Tab indents; Escape, then Tab leaves the editor, as CodeMirror's own help says.
          indentWithTab,
        ]),
        EditorView.updateListener.of((update) => {
          if (update.docChanged) changed();
        }),
      ],
    });
  const changed = () => {
    version++;
    onText();
  };
  const open = (index) => {
    files[active].state = view.state;
    active = index;
    view.setState(files[index].state);
    changed();
  };
  files[0].state = fresh(text);
  const view = new EditorView({ parent, state: files[0].state });
  const select = (from, to, file) => {
    const index = files.findIndex((one) => one.name === file);
    if (index >= 0 && index !== active) open(index);
    const within = (at) => Math.min(at, view.state.doc.length);
    view.dispatch({ selection: { anchor: within(from), head: within(to) }, scrollIntoView: true });
    view.focus();
  };
  // The least change, so that the cursor and the history stay.
  const replace = (text) => {
    const now = view.state.doc.toString();
    let from = 0,
      end = 0;
    const most = Math.min(now.length, text.length);
    while (from < most && now[from] === text[from]) from++;
    while (end < most - from && now[now.length - 1 - end] === text[text.length - 1 - end]) end++;
    if (from < now.length || from < text.length) {
      view.dispatch({
        changes: { from, to: now.length - end, insert: text.slice(from, text.length - end) },
      });
    }
  };
  return {
    view,
    format,
    rename,
    select,
    /** Counts changes of texts. */
    version: () => version,
    /** The text of the model itself. */
    text: () => textOf(0),
    /** The names of the files; the model comes first. */
    names: () => files.map((file) => file.name),
    active: () => active,
    /** The text of a file and the others, as a question has them. */
    asked,
    open,
    /** Another model, with the files that it imports by their names. */
    replace(text, others = {}, name = "model.mech") {
      if (active) open(0);
      files = [
        { ...files[0], name },
        ...Object.entries(others).map(([name, text]) => ({ name, state: fresh(text) })),
      ];
      const before = version;
      replace(text);
      if (version === before) changed();
    },
    /** One more file; it is shown. */
    add(name, text) {
      files.push({ name, state: fresh(text) });
      open(files.length - 1);
    },
    remove(index) {
      if (active === index) open(0);
      if (active > index) active--;
      files.splice(index, 1);
      changed();
    },
    onAnnounce: (told) => {
      announce = told;
    },
    /** Shows findings and colours of the file that is shown. */
    show(answer) {
      const length = view.state.doc.length;
      const within = (at) => Math.min(at, length);
      const list = answer.findings.map((found) => ({
        from: within(found.from),
        to: within(found.to),
        severity: found.error ? "error" : "warning",
        source: found.code,
        message: found.message,
        actions: found.fixes.map((fix) => ({ name: fix.title, apply: fix.apply ?? (() => apply(fix.edits, fix.file)) })),
      }));
      const words = answer.colours
        .filter(([from, to]) => from < to && to <= length)
        .map(([from, to, kind]) => mark(kind).range(from, to));
      view.dispatch(setDiagnostics(view.state, list));
      view.dispatch({ effects: recolour.of(Decoration.set(words, true)) });
    },
  };
}
