// The page in headless Chromium: from disk and from a server, at the widths of a laptop, a tablet and a phone.

import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { after, before, test } from "node:test";
import puppeteer from "puppeteer-core";

const dist = new URL("../dist/", import.meta.url);
const FILE = new URL("hodograph.html", dist).href;
const named = process.env.HODOGRAPH_CHROMIUM;
const executablePath =
  named || ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const WIDTHS = [1280, 768, 390];
/** Compressed, in bytes: of the module, and of the folder with the editor. A change that needs more says so here. */
const MOST = { module: 705_000, folder: 838_000 };
const kinds = { html: "text/html", css: "text/css", js: "text/javascript", wasm: "application/wasm" };

let browser;
before(async () => {
  browser = await puppeteer.launch({
    executablePath,
    args: ["--no-sandbox", "--disable-gpu", "--force-prefers-reduced-motion=0"],
  });
});
after(() => browser.close());

const open = async (address, { width = 1280, still = false } = {}) => {
  const page = await browser.newPage(),
    asked = [];
  page.on("request", (request) => asked.push(request.url()));
  page.on("pageerror", (error) => asked.push(`error: ${error.message}`));
  await page.setViewport({ width, height: width < 500 ? 844 : 900 });
  await page.emulateMediaFeatures([
    { name: "prefers-reduced-motion", value: still ? "reduce" : "no-preference" },
  ]);
  await page.goto(address);
  await page.waitForFunction(() => document.body.dataset.moved, { timeout: 60_000 });
  return { page, asked };
};
const moved = (page) => page.evaluate(() => Number(document.body.dataset.moved));
const status = (page) => page.$eval("#status", (node) => node.textContent);
const movesOn = (page, from) =>
  page.waitForFunction((from) => Number(document.body.dataset.moved) > from, { timeout: 60_000 }, from);
const place = (page) =>
  page.$$eval("#stage .point", (all) => all.map((node) => node.getAttribute("cx")).join());
const put = (page, text) => page.evaluate((text) => globalThis.hodograph.editor.replace(text), text);
const text = (page) => page.evaluate(() => globalThis.hodograph.editor.text());

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
  for (const width of WIDTHS) {
    const { page } = await open(FILE, { width });
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
    assert.deepEqual(wrong, [], `at ${width}`);
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
  const server = createServer((request, response) => {
    const name = request.url === "/" ? "index.html" : request.url.slice(1);
    const file = new URL(`site/${name}`, dist);
    if (!existsSync(file)) return response.writeHead(404).end();
    response
      .writeHead(200, { "content-type": kinds[name.split(".").pop()] || "text/plain" })
      .end(readFileSync(file));
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const home = `http://127.0.0.1:${server.address().port}/`;
  const { page, asked } = await open(home);
  assert.deepEqual(
    asked.filter((url) => !url.startsWith(home) && !url.startsWith("blob:") && !url.startsWith("data:")),
    [],
  );
  await page.close();
  server.close();
});
