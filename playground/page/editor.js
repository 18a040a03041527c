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

/** The editor in an element; `ask` asks the language service, `onText` is told of a new text. */
export function makeEditor(parent, text, ask, onText) {
  const complete = async (context) => {
    const word = context.matchBefore(/[\p{L}\p{N}_]*/u);
    if (
      !context.explicit &&
      word.from === word.to &&
      !/[.({:]\s?$/.test(context.state.sliceDoc(Math.max(0, context.pos - 2), context.pos))
    )
      return null;
    const answer = await ask({ ask: "complete", text: context.state.doc.toString(), at: context.pos });
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
    const answer = await ask({ ask: "hover", text: view.state.doc.toString(), at });
    if (!answer?.text) return null;
    return { pos: answer.from, end: answer.to, above: true, create: () => ({ dom: written(answer.text) }) };
  });
  const apply = (edits) => view.dispatch({ changes: edits, userEvent: "input.fix" });
  const rename = () => {
    const at = view.state.selection.main.head,
      now = view.state.doc.toString();
    ask({ ask: "rename", text: now, at }).then(async (can) => {
      if (!can?.name) return announce(can?.refused || "nothing here can be renamed");
      const name = prompt(`A new name for ${can.name}`, can.name);
      if (!name || name === can.name) return;
      const done = await ask({ ask: "rename", text: now, at, name });
      if (done?.edits && view.state.doc.toString() === now) apply(done.edits);
      else announce(done?.refused || "the text has changed");
    });
    return true;
  };
  const jump = () => {
    ask({ ask: "definition", text: view.state.doc.toString(), at: view.state.selection.main.head }).then(
      (place) => {
        if (place) view.dispatch({ selection: { anchor: place[0], head: place[1] }, scrollIntoView: true });
      },
    );
    return true;
  };
  const format = () => {
    const now = view.state.doc.toString();
    ask({ ask: "format", text: now }).then((answer) => {
      if (answer?.text === undefined) return announce(answer?.refused || "not formatted");
      if (view.state.doc.toString() === now) replace(answer.text);
    });
    return true;
  };
  let announce = () => {};
  const view = new EditorView({
    parent,
    state: EditorState.create({
      doc: text,
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
          if (update.docChanged) onText(update.state.doc.toString());
        }),
      ],
    }),
  });
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
    replace,
    format,
    rename,
    text: () => view.state.doc.toString(),
    onAnnounce: (told) => {
      announce = told;
    },
    /** Shows what `check` answered, if it is of the text that is there. */
    show(answer, of) {
      if (view.state.doc.toString() !== of) return;
      const length = view.state.doc.length;
      const within = (at) => Math.min(at, length);
      const list = answer.findings.map((found) => ({
        from: within(found.from),
        to: within(found.to),
        severity: found.error ? "error" : "warning",
        source: found.code,
        message: found.message,
        actions: found.fixes.map((fix) => ({ name: fix.title, apply: () => apply(fix.edits) })),
      }));
      const words = answer.colours
        .filter(([from, to]) => from < to && to <= length)
        .map(([from, to, kind]) => mark(kind).range(from, to));
      view.dispatch(setDiagnostics(view.state, list));
      view.dispatch({ effects: recolour.of(Decoration.set(words, true)) });
    },
    select(from, to) {
      view.dispatch({ selection: { anchor: from, head: to }, scrollIntoView: true });
      view.focus();
    },
  };
}
