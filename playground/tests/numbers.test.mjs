// The numbers of the page are those of the tool.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { load } from "./module.mjs";

const models = new URL("../../models/", import.meta.url);
const tool = process.env.HODOGRAPH_TOOL || "../target/debug/hodograph";
const surface = { mu: 0.3, e: 0.5, law: "stronge" };
const UNTIL = 0.5,
  STEP = 0.01;

/**
 * How far states and times of events may differ, of their size above 1. With a derivation equations and collisions
 * have the same bits; the integrator chooses its steps by the platform's `pow`, whose last bit differs in WebAssembly.
 * Without one the equations are another computation.
 */
const BOUND = { derivation: 1e-12, numeric: 1e-9 };

// Motions with loops, quaternions, rolling, time, lasting contact and impacts.
const CASES = [
  "two_sleds",
  "planar_double_pendulum",
  "four_bar",
  "free_box_quaternion",
  "rolling_disc",
  "chaplygin_sleigh",
  "spring_damper_cart_rod",
  "driven_rotary_pendulum",
];

const byTool = (name) => {
  const options = [
    "--until",
    UNTIL,
    "--step",
    STEP,
    "--mu",
    surface.mu,
    "--e",
    surface.e,
    "--law",
    surface.law,
    "--format",
    "json",
  ].map(String);
  const path = new URL(`${name}.mech`, models).pathname;
  const lines = execFileSync(tool, ["simulate", path, ...options], {
    stdio: ["ignore", "pipe", "ignore"],
    encoding: "utf8",
  });
  const all = lines
    .trim()
    .split("\n")
    .map((line) => JSON.parse(line));
  return { states: all.filter((line) => line.q && !line.event), events: all.filter((line) => line.event) };
};
const text = (name) => readFileSync(new URL(name, models), "utf8");

// The page's states at the times of the tool's samples: after an event, where there are two.
const sampled = (answer, times) => {
  const at = new Map(answer.times.map((t, index) => [t, index]));
  const of = (panel, index) =>
    Object.fromEntries(
      answer.states.filter((one) => one.panel === panel).map((one) => [one.name, one.values[index]]),
    );
  return times.map((t) => {
    assert.ok(at.has(t), `the page has no sample at ${t}`);
    return { t, q: of("coordinates", at.get(t)), u: of("speeds", at.get(t)) };
  });
};

for (const name of CASES) {
  test(`${name}: states and events are those of the tool, with and without its derivation`, async () => {
    const ask = await load(),
      known = byTool(name),
      models = { derivation: text(`${name}.derivation`), numeric: "" };
    assert.ok(known.states.length > 40);
    const off = {};
    for (const road in models) {
      const answer = ask({
        ask: "move",
        text: text(`${name}.mech`),
        derivation: models[road],
        until: UNTIL,
        step: STEP,
        surface,
      });
      assert.equal(answer.fault, undefined, answer.fault);
      assert.equal(answer.road, road);
      assert.deepEqual(
        answer.events.map((one) => one.event),
        known.events.map((one) => one.event),
      );
      let worst = 0;
      const compare = (value, expected) => {
        worst = Math.max(worst, Math.abs(value - expected) / Math.max(1, Math.abs(expected)));
      };
      answer.events.forEach((one, index) => compare(one.t, known.events[index].t));
      sampled(
        answer,
        known.states.map((state) => state.t),
      ).forEach((state, index) => {
        for (const part of ["q", "u"])
          for (const key in known.states[index][part])
            compare(state[part][key], known.states[index][part][key]);
      });
      off[road] = worst;
      assert.ok(worst <= BOUND[road], `${name}, ${road}: off by ${worst}`);
    }
    console.log(
      `${name}: off by ${off.derivation.toExponential(1)} with its derivation, ${off.numeric.toExponential(1)} without`,
    );
  });
}

test("twenty states have the kinetic energies of every door, to the bit", async () => {
  const ask = await load();
  const path = new URL("../../tests/data/doors/planar_double_pendulum.csv", import.meta.url);
  const [head, ...rows] = readFileSync(path, "utf8")
    .trim()
    .split("\n")
    .map((line) => line.split(","));
  assert.equal(rows.length, 20);
  for (const row of rows) {
    const values = Object.fromEntries(head.slice(0, 4).map((name, index) => [name, Number(row[index])]));
    const answer = ask({
      ask: "move",
      text: text("planar_double_pendulum.mech"),
      derivation: text("planar_double_pendulum.derivation"),
      values,
      until: 0.001,
      surface,
    });
    assert.equal(answer.fault, undefined, answer.fault);
    const kinetic = answer.animation.series.find((one) => one.name === "kinetic");
    assert.equal(kinetic.values[0], Number(row[6]));
  }
});

test("every model of the gallery is described, checked without mistakes, and moves", async () => {
  const ask = await load();
  const { examples } = await import("./built.mjs");
  for (const { name, text, files } of examples) {
    const checked = ask({ ask: "check", text, files });
    assert.equal(checked.errors, false, name);
    assert.ok(ask({ ask: "describe", text, files }).quantities.length > 0, name);
    const moved = ask({ ask: "move", text, files, until: 0.02, tolerance: 1e-6, surface });
    assert.equal(moved.fault, undefined, `${name}: ${moved.fault}`);
    assert.ok(moved.times.length >= 3, name);
  }
});

test("a motion that is told to end says where it did, and what is no question is answered by a fault", async () => {
  let calls = 0;
  const ask = await load(() => ++calls < 20);
  const pendulum = readFileSync(new URL("../page/pendulum.mech", import.meta.url), "utf8");
  const answer = ask({ ask: "move", text: pendulum, until: 10 });
  assert.ok(answer.stopped > 0 && answer.stopped < 1, String(answer.stopped));
  assert.ok(answer.times.length >= 19);
  for (const wrong of [
    "",
    "{",
    "[]",
    '{"ask":"fly"}',
    '{"ask":"move"}',
    '{"ask":"check","text":7}',
    '{"ask":"move","text":"mechanism"}',
  ]) {
    assert.equal(typeof ask(wrong).fault, "string", wrong);
  }
  const numbers = { ask: "move", text: pendulum, values: { m: -1 } };
  assert.match(ask(numbers).fault, /Rod/);
  assert.match(ask({ ask: "move", text: pendulum, surface: { e: 2 } }).fault, /restitution/);
});

test("what is no model is answered, whatever it is", async () => {
  const ask = await load();
  const texts = ["\u0000\u0001\ufffdPK\u0003\u0004", "x".repeat((4 << 20) + 1), "a\rb\rc", "(".repeat(100_000), "\ufeff", "\ud800"];
  for (const text of texts) {
    for (const question of ["check", "complete", "hover", "format", "describe", "move"]) {
      const answer = ask({ ask: question, text, at: 1, files: { "a.mech": text } });
      if (answer?.fault === undefined && question === "check") assert.ok(answer.findings.length > 0, text.slice(0, 5));
      if (["describe", "move"].includes(question)) assert.equal(typeof answer.fault, "string", text.slice(0, 5));
    }
  }
  // a file that imports itself, and one that is missing
  const text = 'mechanism A;\nimport "a.mech";\nimport "b.mech";\n';
  const { findings } = ask({ ask: "check", text, files: { "a.mech": 'import "a.mech";\npart P() { }\n' } });
  const there = findings.map((found) => [found.code, found.there?.file ?? ""].join(" "));
  assert.ok(there.includes("E091 a.mech") && there.includes("E090 "), there.join());
});

test("the language service counts as JavaScript does", async () => {
  const ask = await load();
  const text = "//! \u{1f600}\nmechanism A;\nparameters { \u03b1: kg = 1, b: m = qq }\n";
  const { findings } = ask({ ask: "check", text });
  assert.ok(
    findings.some((found) => text.slice(found.from, found.to) === "qq"),
    JSON.stringify(findings),
  );
  const hover = ask({ ask: "hover", text, at: text.indexOf("\u03b1") });
  assert.equal(text.slice(hover.from, hover.to), "\u03b1");
});
