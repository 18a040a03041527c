// The page in headless Chromium: from disk and from a server, at the widths of a laptop, a tablet and a phone.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import * as shared from "./browser.mjs";
import { FILE, dist, launch, moved, movesOn, put, serve, status, text } from "./browser.mjs";

const WIDTHS = [1280, 768, 390];
/** Compressed, in bytes: of the module, and of the folder with the editor. A change that needs more says so here. */
const MOST = { module: 853_000, folder: 987_000 };

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

const open = (address, options) => shared.open(browser, address, options);
const place = (page) =>
  page.$$eval("#stage .point", (all) => all.map((node) => node.getAttribute("cx")).join());

test("sizes stay within their limits", () => {
  const { parts, folder } = JSON.parse(readFileSync(new URL("sizes.json", dist), "utf8"));
  const module = parts[0].brotli;
  assert.ok(module <= MOST.module && folder.brotli <= MOST.folder, `${module}, ${folder.brotli}`);
  const licences = readFileSync(new URL("LICENCES.txt", dist), "utf8");
  for (const name of ["@codemirror/view", "@codemirror/state", "@lezer/common", "MIT"])
    assert.ok(licences.includes(name), name);
});

test("a picture and a motion are there, and nothing is loaded", async () => {
  const { page, asked } = await open(FILE);
  const picture = await page.evaluate(
    () =>
      performance.getEntriesByType("paint").find((one) => one.name === "first-contentful-paint")?.startTime,
  );
  const motion = await page.evaluate(() => performance.getEntriesByName("moved")[0].startTime);
  console.log(`first picture ${picture?.toFixed(0)} ms, first motion ${motion.toFixed(0)} ms`);
  assert.deepEqual(
    asked.filter((url) => !url.startsWith("file:") && !url.startsWith("blob:") && !url.startsWith("data:")),
    [],
  );
  assert.match(await status(page), /moments, \d+ events in .* evaluated numerically/);
  const one = await place(page);
  await page.waitForFunction(
    (one) =>
      [...document.querySelectorAll("#stage .point")].map((node) => node.getAttribute("cx")).join() !== one,
    {},
    one,
  );
  await page.click("#play");
  assert.equal(await page.$eval("#play", (node) => node.getAttribute("aria-label")), "Play");
  const stopped = await place(page);
  await new Promise((done) => setTimeout(done, 200));
  assert.equal(await place(page), stopped);
  await page.close();
});

test("mistakes are shown while one types, and the motion follows the text", async () => {
  const { page } = await open(FILE);
  const right = await text(page),
    before = await moved(page);
  await page.evaluate(() => {
    const { view } = globalThis.hodograph.editor;
    view.focus();
    view.dispatch({ selection: { anchor: view.state.doc.toString().indexOf("q1); }") } });
  });
  await page.keyboard.type("q");
  await page.waitForFunction(() => document.body.dataset.errors === "1", { timeout: 20_000 });
  assert.match(await page.$eval("#problems", (node) => node.textContent), /E020, line 17: .*qq1/);
  await page.waitForSelector(".cm-lintRange-error");
  assert.match(await status(page), /1 mistake/);
  await page.keyboard.press("Backspace");
  await movesOn(page, before);
  assert.equal(await text(page), right);
  assert.equal(await page.$eval("#problems", (node) => node.hidden), true);
  // another length makes another motion
  const now = await moved(page);
  await put(page, right.replace("= 0.5,", "= 0.6,"));
  await movesOn(page, now);
  assert.match(await text(page), /= 0\.6,/);
  await page.close();
});

test("completion, formatting and renaming are those of the language service", async () => {
  const { page } = await open(FILE);
  const at = (part) =>
    page.evaluate((part) => {
      const { view } = globalThis.hodograph.editor;
      view.focus();
      const from = view.state.doc.toString().indexOf(part);
      view.dispatch({ selection: { anchor: from } });
    }, part);
  await at("B.y;");
  await page.keyboard.down("Control");
  await page.keyboard.press("Space");
  await page.keyboard.up("Control");
  await page.waitForSelector(".cm-tooltip-autocomplete li");
  assert.ok((await page.$$eval(".cm-tooltip-autocomplete li", (all) => all.length)) > 2);
  await page.keyboard.press("Escape");
  page.once("dialog", (dialog) => dialog.accept("angle"));
  await at("q1: rad");
  await page.keyboard.press("F2");
  await page.waitForFunction(() => globalThis.hodograph.editor.text().includes("rotate(z, angle)"));
  await put(page, (await text(page)).replace("angle: rad = 0.3", "angle:   rad =0.3"));
  await page.click("#format");
  await page.waitForFunction(() => globalThis.hodograph.editor.text().includes("angle: rad = 0.3"));
  await page.close();
});

test("sliders change the motion, and an address holds model and numbers", async () => {
  const { page } = await open(FILE);
  const before = await moved(page),
    gap = () =>
      page.evaluate(
        () => globalThis.hodograph.latest().curves.find((one) => one.panel === "gap").values[0],
      );
  const first = await gap();
  await page.focus("#c-w--m-");
  for (let i = 0; i < 20; i++) await page.keyboard.press("ArrowRight");
  await movesOn(page, before);
  await page.waitForFunction(
    (first) => globalThis.hodograph.latest().curves.find((one) => one.panel === "gap").values[0] > first,
    { timeout: 20_000 },
    first,
  );
  await put(page, (await text(page)).replace("mechanism Pendulum", "mechanism Shared"));
  await page.waitForFunction(() => document.title.startsWith("Shared"), { timeout: 20_000 });
  await page.click("#share");
  await page.waitForFunction(() => location.hash.startsWith("#m="));
  const address = page.url(),
    shared = await text(page),
    values = await page.evaluate(() =>
      globalThis.hodograph.latest().animation.series[0].values.slice(0, 50),
    );
  await page.close();
  const { page: other } = await open(address);
  assert.equal(await text(other), shared);
  assert.deepEqual(
    await other.evaluate(() => globalThis.hodograph.latest().animation.series[0].values.slice(0, 50)),
    values,
  );
  assert.ok(address.length < 2500, String(address.length));
  await other.close();
  // an address that holds nonsense opens the page as it is
  const { page: nonsense } = await open(`${FILE}#m=abc`);
  assert.match(await text(nonsense), /mechanism Pendulum/);
  await nonsense.close();
});

test("a model of several files: mistakes at their places, fixes, and an address that holds all", async () => {
  const { page } = await open(FILE);
  const chain = `mechanism Chain;
import "parts/rod.mech";
parameters { g: m/s^2 = 9.81 }
loads { gravity: -g*N.y; }
use Rod as a(hinge: O, base: N);
use Rod as b(hinge: a.tip, base: a.B);
`;
  // what is imported and not there can be made
  let before = await moved(page);
  await put(page, chain);
  await page.waitForFunction(() => /E090, line 2/.test(document.querySelector("#problems").textContent), { timeout: 20_000 });
  await page.click("#problems button");
  await page.hover(".cm-lint-marker-error");
  await page.waitForSelector(".cm-diagnosticAction");
  assert.equal(await page.$eval(".cm-diagnosticAction", (node) => node.textContent), "Make the file parts/rod.mech");
  await page.click(".cm-diagnosticAction");
  await movesOn(page, before);
  const tabs = () => page.$$eval("#files [role=tab]", (all) => all.map((node) => `${node.textContent} ${node.ariaSelected}`));
  assert.deepEqual(await tabs(), ["model.mech false", "parts/rod.mech true"]);
  // a mistake in the part stands there, and names its file
  await page.evaluate(() => {
    const { view } = globalThis.hodograph.editor;
    const from = view.state.doc.toString().indexOf("l*B.y");
    view.dispatch({ changes: { from, to: from + 1, insert: "ll" } });
  });
  await page.waitForFunction(() => document.body.dataset.errors === "1", { timeout: 20_000 });
  assert.match(await page.$eval("#problems", (node) => node.textContent), /^E020, parts\/rod.mech line 7: .*ll/);
  await page.waitForSelector(".cm-lintRange-error");
  await page.click("#files [role=tab]");
  await page.waitForFunction(() => document.querySelectorAll(".cm-lintRange-error").length > 0);
  // its fix is offered at the use, and changes the part
  before = await moved(page);
  const fixed = await page.evaluate(async () => {
    const { words, editor } = globalThis.hodograph;
    const answer = await words.ask({ ...editor.asked(0), ask: "check" });
    return answer.findings[0].fixes[0];
  });
  assert.deepEqual([fixed.title, fixed.file], ["Change to `l`", "parts/rod.mech"]);
  await page.click("#problems button");
  assert.deepEqual(await tabs(), ["model.mech false", "parts/rod.mech true"]);
  await page.keyboard.type("l");
  await movesOn(page, before);
  // F12 leads from the use into the part
  await page.click("#files [role=tab]");
  await page.evaluate(() => {
    const { view } = globalThis.hodograph.editor;
    view.focus();
    view.dispatch({ selection: { anchor: view.state.doc.toString().indexOf("Rod as b") } });
  });
  await page.keyboard.press("F12");
  await page.waitForFunction(() => globalThis.hodograph.editor.active() === 1);
  // F2 changes a name of the part in both texts, and each text is undone by itself
  const texts = () => page.evaluate(() => [0, 1].map((i) => globalThis.hodograph.editor.asked(i).text));
  const [, rod] = await texts();
  before = await moved(page);
  page.once("dialog", (dialog) => dialog.accept("pivot"));
  await page.evaluate(() => {
    const { view } = globalThis.hodograph.editor;
    view.dispatch({ selection: { anchor: view.state.doc.toString().indexOf("hinge: point") } });
  });
  await page.keyboard.press("F2");
  await page.waitForFunction(() => globalThis.hodograph.editor.text().includes("a(pivot: O"));
  assert.deepEqual(await texts(), [chain.replaceAll("hinge:", "pivot:"), rod.replace("hinge: point", "pivot: point").replace("= hinge", "= pivot")]);
  await movesOn(page, before);
  const undo = async () => {
    await page.keyboard.down("Control");
    await page.keyboard.press("z");
    await page.keyboard.up("Control");
  };
  await undo();
  await page.click("#files [role=tab]");
  await page.evaluate(() => globalThis.hodograph.editor.view.focus());
  await undo();
  assert.deepEqual(await texts(), [chain, rod]);
  await page.click("#share");
  await page.waitForFunction(() => location.hash.startsWith("#m="));
  const address = page.url();
  await page.close();
  const { page: other } = await open(address);
  assert.deepEqual(await other.evaluate(() => globalThis.hodograph.editor.names()), ["model.mech", "parts/rod.mech"]);
  assert.equal(await text(other), chain);
  assert.match(await status(other), /moments/);
  await other.close();
});

test("each of several contacts has numbers of its own", async () => {
  const { page } = await open(FILE);
  const two = (await text(page)).replace(
    /contacts \{[\s\S]*$/,
    `contacts {
    left { point: P of Rod, normal: N.x, gap: dot(position(P), N.x) + w, surface: { mu: 0.3, e: 0.7, law: stronge } },
    right { point: P of Rod, normal: -N.x, gap: w - dot(position(P), N.x), surface: { mu: 0.1, e: 0.4, law: newton } }
}
`,
  );
  let before = await moved(page);
  await put(page, two);
  await movesOn(page, before);
  const used = () =>
    page.evaluate(() => {
      const { collisions, animation } = globalThis.hodograph.latest();
      const found = {};
      for (const one of collisions) found[animation.events[one.event].contact] ??= [one.mu, one.e, one.law];
      return found;
    });
  assert.deepEqual(await used(), { left: [0.3, 0.7, "stronge"], right: [0.1, 0.4, "newton"] });
  const set = async (id, value) => {
    before = await moved(page);
    await page.$eval(
      id,
      (node, value) => {
        node.value = value;
        node.dispatchEvent(new Event(node.localName === "select" ? "change" : "input", { bubbles: true }));
      },
      value,
    );
    await movesOn(page, before);
  };
  await set("#c-left-restitution-e", 0.25);
  await set("#law-right", "poisson");
  assert.deepEqual(await used(), { left: [0.3, 0.25, "stronge"], right: [0.1, 0.4, "poisson"] });
  // that of all contacts holds where none is set
  await set("#c-restitution-e", 0.5);
  assert.deepEqual(await used(), { left: [0.3, 0.25, "stronge"], right: [0.1, 0.5, "poisson"] });
  assert.equal(await page.$eval("#c-right-restitution-e", (node) => Number(node.value)), 0.5);
  await page.close();
});

test("events are stepped through, and the hodograph is that of the collision", async () => {
  const { page } = await open(FILE);
  await page.waitForSelector("#course svg");
  await page.click("#play");
  await page.$eval("#stage", (node) => node.focus());
  await page.keyboard.press("Home");
  await page.keyboard.press(".");
  const time = () => page.$eval("#time", (node) => Number(node.value));
  const events = await page.evaluate(() => globalThis.hodograph.latest().events.map((one) => one.t));
  assert.ok(Math.abs((await time()) - events[0]) < 1e-9);
  await page.keyboard.press(".");
  assert.ok(Math.abs((await time()) - events[1]) < 1e-9);
  await page.keyboard.press(",");
  assert.ok(Math.abs((await time()) - events[0]) < 1e-9);
  assert.match(await page.$eval("#course h2", (node) => node.textContent), /tip_wall.*0\.3.*0\.7.*stronge/);
  await page.close();
});

test("a motion that takes too long is stopped and says so, and typing goes on meanwhile", async () => {
  const { page } = await open(FILE);
  const long = await page.evaluate(() => document.querySelector("#examples-data").textContent);
  const whipple = JSON.parse(long).find((one) => one.name === "arm_7dof").text;
  await page.$eval("#until", (node) => {
    node.value = 1000;
    node.dispatchEvent(new Event("change"));
  });
  await put(page, whipple);
  await page.waitForFunction(() => document.getElementById("status").className === "busy", {
    timeout: 30_000,
  });
  // the language answers while the motion is computed
  const began = Date.now();
  const answer = await page.evaluate(() =>
    globalThis.hodograph.words.ask({
      ask: "hover",
      text: globalThis.hodograph.editor.text(),
      at: globalThis.hodograph.editor.text().indexOf("q1"),
    }),
  );
  assert.ok(answer?.text, "no hover");
  console.log(`a hover while a motion is computed: ${Date.now() - began} ms`);
  await page.waitForFunction(() => /stopped at t = /.test(document.getElementById("status").textContent), {
    timeout: 60_000,
  });
  await page.close();
});

test("the page fits its window, can be read, and every control has a name", async () => {
  for (const [width, scheme] of WIDTHS.flatMap((width) => [[width, "light"], [width, "dark"]])) {
    const { page } = await open(FILE, { width, scheme });
    // with a mistake and a warning, whose colours are others
    await page.evaluate(() => {
      const { editor } = globalThis.hodograph;
      editor.replace(editor.text().replace("m: kg = 1,", "m: kg = 1, spare: kg = 2,").replace("q1); }", "qq1); }"));
    });
    await page.waitForFunction(() => document.body.dataset.errors === "1", { timeout: 20_000 });
    await page.waitForSelector(".cm-lintRange-error");
    const wrong = await page.evaluate(() => {
      const found = [];
      if (document.documentElement.scrollWidth > innerWidth)
        found.push(`wider than the window: ${document.documentElement.scrollWidth}`);
      for (const node of document.querySelectorAll("button, select, input, [tabindex]")) {
        const named =
          node.getAttribute("aria-label") || node.textContent.trim() || node.labels?.length || node.title;
        if (!named) found.push(`without a name: ${node.outerHTML.slice(0, 80)}`);
      }
      // contrast of texts with what is behind them
      const canvas = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
      const colour = (text) => {
        canvas.clearRect(0, 0, 1, 1);
        canvas.fillStyle = text;
        canvas.fillRect(0, 0, 1, 1);
        return [...canvas.getImageData(0, 0, 1, 1).data];
      };
      const light = ([r, g, b]) =>
        [r, g, b]
          .map((x) => x / 255)
          .map((x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4))
          .reduce((sum, x, i) => sum + x * [0.2126, 0.7152, 0.0722][i], 0);
      const behind = (node) => {
        for (let at = node; at; at = at.parentElement) {
          const found = colour(getComputedStyle(at).backgroundColor);
          if (found[3] > 250) return found;
        }
        return [255, 255, 255, 255];
      };
      const seen = new Set();
      for (const node of document.querySelectorAll("body *")) {
        const own = [...node.childNodes].some((child) => child.nodeType === 3 && child.data.trim());
        if (!own || !node.checkVisibility() || node.closest("option, noscript, script, style")) continue;
        const svg = node.namespaceURI.includes("svg"),
          style = getComputedStyle(node);
        const [a, b] = [light(colour(svg ? style.fill : style.color)), light(behind(node))];
        const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05),
          key = `${node.className.baseVal ?? node.className} ${node.localName}`;
        if (ratio < 4.5 && !seen.has(key)) {
          seen.add(key);
          found.push(`contrast ${ratio.toFixed(2)}: ${key} ${node.textContent.slice(0, 20)}`);
        }
      }
      return found;
    });
    assert.deepEqual(wrong, [], `at ${width}, ${scheme}`);
    await page.close();
  }
});

test("the keyboard reaches every control", async () => {
  const { page } = await open(FILE);
  const wanted = await page.$$eval(
    "button, select, input, #stage, summary",
    (all) =>
      all
        .filter((node) => node.checkVisibility({ visibilityProperty: true }) && !node.closest(".cm-editor"))
        .map((node) => (node.dataset.n = Math.random())).length,
  );
  await page.evaluate(() => document.body.focus());
  const reached = new Set();
  for (let i = 0; i < wanted + 60; i++) {
    await page.keyboard.press("Tab");
    const at = await page.evaluate(() => ({
      n: document.activeElement.dataset.n,
      editor: !!document.activeElement.closest(".cm-editor"),
    }));
    if (at.n) reached.add(at.n);
    // Escape, then Tab leaves the editor
    if (at.editor) await page.keyboard.press("Escape");
  }
  assert.equal(reached.size, wanted);
  await page.close();
});

test("who wants less motion sees a still picture", async () => {
  const { page } = await open(FILE, { still: true });
  assert.equal(await page.$eval("#play", (node) => node.getAttribute("aria-label")), "Play");
  const one = await place(page);
  await new Promise((done) => setTimeout(done, 300));
  assert.equal(await place(page), one);
  await page.close();
});

test("a web server serves the folder", async () => {
  const { home, end } = await serve();
  const { page, asked } = await open(home);
  assert.deepEqual(
    asked.filter((url) => !url.startsWith(home) && !url.startsWith("blob:") && !url.startsWith("data:")),
    [],
  );
  await page.close();
  end();
});
