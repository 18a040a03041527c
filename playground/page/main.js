// The page: a model on one side, its motion on the other.

import { showMotion } from "drawing";
import WORKER from "worker";
import { asker } from "./asker.js";
import { makeControls } from "./controls.js";
import { showCourse } from "./course.js";
import { makeEditor } from "./editor.js";
import { findings, makeTabs } from "./files.js";
import { derivationOf, loadModule } from "./module.js";
import { saveModel, savePicture, saveTable } from "./save.js";
import { fromFragment, toFragment } from "./share.js";
import { watchFile } from "./watch.js";

/** A motion is computed for so long at most, in milliseconds. */
const LIMIT = 10_000;
/** What is done of it after so long is shown before the whole. */
const QUICK = 700;
const byId = (id) => document.getElementById(id);
const examples = JSON.parse(byId("examples-data").textContent);
const say = (text, kind = "") => {
  const node = byId("status");
  node.textContent = text;
  node.className = kind;
};
const later = (wait, run) => {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(run, wait);
  };
};

async function begin() {
  // In a page of the book, which has a heading and models of its own.
  document.body.classList.toggle("embedded", self !== top);
  const served = watchFile((file) => {
    if (file.fault) return say(file.fault, "error");
    derive(file.derivation || "");
    editor.replace(file.text, file.files, file.name);
  });
  const derive = (text) => {
    derivation = text;
    byId("equations").hidden = !text;
  };
  const [module, shared, file] = await Promise.all([loadModule(), fromFragment(location.hash), served]);
  const words = asker(WORKER, module),
    motions = asker(WORKER, module);
  let derivation = "",
    model = null,
    shown = null,
    latest = null,
    round = 0,
    course = -2,
    begun = null;

  derive(file?.derivation || "");
  const first = file?.text ? file : (shared ?? examples[0]);
  const editor = makeEditor(
    byId("editor"),
    "",
    (question) => words.ask(question, { limit: 5000 }),
    () => {
      tabs.show();
      checkSoon();
    },
  );
  const tabs = makeTabs(byId("files"), editor);
  editor.onAnnounce((text) => say(text, "warning"));
  const controls = makeControls(byId("controls"), () => moveSoon());
  controls.take(shared);
  if (shared?.until) byId("until").value = shared.until;
  byId("name").textContent = file?.name || "";

  let listed = "";
  const problems = (found) => {
    const list = byId("problems");
    // a button that is pressed stays
    const now = JSON.stringify([editor.names(), found.map((one) => [one.file, one.from, one.to, one.message])]);
    if (now === listed) return;
    listed = now;
    list.replaceChildren(
      ...found.slice(0, 30).map((one) => {
        const item = document.createElement("li"),
          button = document.createElement("button");
        button.type = "button";
        button.className = one.error ? "error" : "warning";
        const index = editor.names().indexOf(one.file);
        const line = (index < 0 ? "" : editor.asked(index).text).slice(0, one.from).split("\n").length;
        const where = index > 0 ? `${one.file} line` : "line";
        button.textContent = `${one.code}, ${where} ${line}: ${one.message.split("\n")[0]}`;
        button.addEventListener("click", () => editor.select(one.from, one.to, one.file));
        item.append(button);
        return item;
      }),
    );
    list.hidden = !found.length;
  };

  const check = async () => {
    const version = editor.version(),
      asked = (index) => words.ask({ ...editor.asked(index), ask: "check" }, { limit: 5000 });
    const [answer, own] = await Promise.all([asked(0), editor.active() ? asked(editor.active()) : null]);
    if (!answer || editor.version() !== version) return;
    if (answer.fault) return say(answer.fault, "error");
    const { here, all } = findings(editor, answer, own ?? answer, tabs.add);
    editor.show({ findings: here, colours: (own ?? answer).colours });
    problems(all);
    const count = all.filter((found) => found.error).length;
    document.body.dataset.errors = count;
    if (answer.errors) {
      motions.drop();
      return say(
        count === 1
          ? "1 mistake: the motion is that of the model before it"
          : `${count} mistakes: the motion is that of the model before them`,
        "error",
      );
    }
    const described = await words.ask({ ...editor.asked(0), ask: "describe" }, { limit: 5000 });
    if (!described || described.fault || editor.version() !== version) return;
    model = described;
    controls.show(model);
    document.title = `${model.name}: Hodograph`;
    move();
  };
  const checkSoon = later(60, check);

  const move = async () => {
    const mine = ++round;
    if (!model) return;
    motions.drop();
    begun = null;
    const span = Number(byId("until").value);
    const question = {
      ...editor.asked(0),
      ask: "move",
      derivation,
      ...controls.asked(),
      ...(span > 0 ? { until: span } : {}),
    };
    const progress = (time) => {
      if (mine === round) say(`computing: t = ${time.toFixed(2)} s`, "busy");
    };
    say("computing", "busy");
    const began = performance.now();
    for (const limit of [QUICK, LIMIT]) {
      const answer = await motions.ask(question, { limit, progress });
      if (!answer || mine !== round) return;
      if (answer.fault) return say(answer.fault, "error");
      const done = answer.stopped === null || limit === LIMIT;
      present(answer, done);
      if (!done) continue;
      const spent = ((performance.now() - began) / 1000).toFixed(2);
      const road = answer.road === "derivation" ? "from its derivation" : "evaluated numerically";
      if (answer.stopped !== null)
        say(
          `stopped at t = ${answer.stopped.toFixed(3)} s: this motion takes longer than ${LIMIT / 1000} s to compute`,
          "warning",
        );
      else if (answer.ended) say(`the motion ends: ${answer.ended}`, "warning");
      else say(`${answer.times.length} moments, ${answer.events.length} events in ${spent} s, ${road}`);
      document.body.dataset.moved = String(Number(document.body.dataset.moved || 0) + 1);
      return;
    }
  };

  // Shows a motion in the place of the one before it, as that was looked at; of one that is not done yet the whole
  // takes its place next.
  const present = (answer, done) => {
    latest = answer;
    latest.curves = answer.animation.series.filter((one) => one.values.length === answer.times.length);
    const last = shown?.keep();
    const kept = begun || last || {};
    // Another model is looked at anew.
    if (kept.name !== model.name) for (const key of ["view", "now", "speed", "running"]) delete kept[key];
    if (begun && last) {
      kept.view = last.view;
      kept.now ??= last.now;
    }
    kept.name = model.name;
    begun = done ? null : { ...kept };
    shown?.end();
    course = -2;
    shown = showMotion(byId("motion"), answer.animation, {
      ...kept,
      onTime: (time, event) => follow(event),
    });
    performance.mark("moved");
  };
  const moveSoon = later(40, move);

  // The collision at the cursor: the last one before the time that is shown, else the first.
  const follow = async (event) => {
    const all = latest.collisions;
    const found = all.filter((one) => one.event <= event).pop() || all[0];
    const index = found ? found.event : -1;
    if (index === course) return;
    course = index;
    byId("course").hidden = !found;
    if (!found) return;
    const answer = await words.ask({ ask: "hodograph", ...found }, { limit: 5000 });
    if (!answer?.points || course !== index) return;
    showCourse(byId("course"), found, answer, latest.animation.events[index].contact);
  };

  // The menu, the buttons.
  examples.forEach((one, index) => byId("examples").append(new Option(one.name, index)));
  let choice = 0;
  byId("examples").addEventListener("change", async (event) => {
    const chosen = examples[event.target.value],
      own = ++choice;
    if (!chosen) return;
    event.target.value = "";
    const found = await derivationOf(chosen.name);
    // Another model was chosen meanwhile.
    if (own !== choice) return;
    derive(found);
    controls.clear();
    history.replaceState(null, "", location.pathname + location.search);
    editor.replace(chosen.text, chosen.files);
  });
  byId("until").addEventListener("change", move);
  byId("format").addEventListener("click", editor.format);
  byId("share").addEventListener("click", async () => {
    const span = Number(byId("until").value);
    const { text, files } = editor.asked(0);
    const fragment = await toFragment({
      text,
      ...(Object.keys(files).length ? { files } : {}),
      ...controls.asked(),
      ...(span > 0 ? { until: span } : {}),
    });
    history.replaceState(null, "", fragment);
    const copied = await navigator.clipboard?.writeText(location.href).then(
      () => true,
      () => false,
    );
    say(
      copied
        ? "the address of this model is copied"
        : "the address of the page now holds this model: copy it",
      "good",
    );
  });
  byId("save").addEventListener("change", (event) => {
    const kind = event.target.value,
      name = model?.name || "model";
    event.target.value = "";
    if (kind === "model") editor.names().forEach((file, i) => saveModel(i ? file : `${name}.mech`, editor.asked(i).text));
    if (kind === "svg" && shown) savePicture(name, byId("motion").querySelector("#stage"));
    if (kind === "csv" && latest) saveTable(name, latest);
  });
  byId("stop").addEventListener("click", () => {
    motions.drop();
    say("stopped", "warning");
  });
  byId("equations").addEventListener("click", async () => {
    const answer = await words.ask({ ...editor.asked(0), ask: "equations", derivation }, { limit: 8000 });
    // In the dialog: the line of status belongs to the motion, which may say something at any time.
    const [frame, said] = [byId("equations-frame"), byId("equations-said")];
    frame.srcdoc = answer?.page || "";
    frame.hidden = !answer?.page;
    said.textContent = answer?.page ? "" : answer?.fault || "the equations were not computed: ask again";
    said.hidden = !!answer?.page;
    byId("equations-box").showModal();
  });
  byId("close").addEventListener("click", () => byId("equations-box").close());
  addEventListener("hashchange", async () => {
    const own = ++choice,
      other = await fromFragment(location.hash);
    if (!other || own !== choice) return;
    derive("");
    controls.take(other);
    byId("until").value = other.until || "";
    editor.replace(other.text, other.files);
  });
  globalThis.hodograph = { words, motions, editor, latest: () => latest };
  editor.replace(first.text, first.files, first.name?.endsWith(".mech") ? first.name : undefined);
}

begin().catch((error) => say(`the page cannot begin: ${error.message || error}`, "error"));
