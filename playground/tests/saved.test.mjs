// What the page gives away: files of the model, the picture and the numbers, as the browser saves them; and the
// equations, which are the tool's.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { FILE, launch, moved, movesOn, open, put, serve, text } from "./browser.mjs";

const tool = process.env.HODOGRAPH_TOOL || "../target/debug/hodograph";
let browser, folder, server;
before(async () => {
  browser = await launch();
  server = await serve();
  folder = mkdtempSync(join(tmpdir(), "hodograph-saved-"));
  const session = await browser.target().createCDPSession();
  await session.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder });
});
after(async () => {
  server.end();
  await browser.close();
  rmSync(folder, { recursive: true });
});

/** Chooses what to save, and waits for the files of these names; their texts. */
const saved = async (page, kind, names) => {
  await page.select("#save", kind);
  for (let tries = 0; tries < 100; tries++) {
    const there = readdirSync(folder);
    if (names.every((name) => there.includes(name)) && !there.some((name) => name.endsWith(".crdownload"))) {
      assert.deepEqual(there.sort(), [...names].sort());
      return names.map((name) => {
        const content = readFileSync(join(folder, name), "utf8");
        rmSync(join(folder, name));
        return content;
      });
    }
    await new Promise((done) => setTimeout(done, 100));
  }
  throw new Error(`${names} were not saved, but ${readdirSync(folder)}`);
};

test("the model is saved as it is written, and with its files", async () => {
  const { page } = await open(browser, FILE);
  const model = `${await text(page)}// π: not ASCII\n`;
  let before = await moved(page);
  await put(page, model);
  await movesOn(page, before);
  assert.deepEqual(await saved(page, "model", ["Pendulum.mech"]), [model]);
  before = await moved(page);
  await page.select("#examples", await page.$$eval("#examples option", (all) => all.find((one) => one.textContent === "quadruped").value));
  await movesOn(page, before);
  const parts = new URL("../../tests/data/parts/", import.meta.url);
  const texts = ["quadruped.mech", "leg.mech"].map((name) => readFileSync(new URL(name, parts), "utf8"));
  assert.deepEqual(await saved(page, "model", ["Quadruped.mech", "leg.mech"]), texts);
  await page.close();
});

test("the table holds the numbers that the page shows, and they are the mechanism's", async () => {
  const { page } = await open(browser, FILE);
  const [table] = await saved(page, "csv", ["Pendulum.csv"]);
  const [head, ...rows] = table.trimEnd().split("\n").map((line) => line.split(","));
  assert.deepEqual(head.slice(0, 3), ["t [s]", "q1 [rad]", "u1 [rad/s]"]);
  const shown = await page.evaluate(() => {
    const { times, states, curves } = globalThis.hodograph.latest();
    return { times, columns: [...states, ...curves].map((one) => one.values) };
  });
  assert.equal(rows.length, shown.times.length);
  assert.equal(head.length, shown.columns.length + 1);
  rows.forEach((row, i) => {
    assert.equal(Number(row[0]), shown.times[i]);
    shown.columns.forEach((column, k) => assert.equal(row[k + 1], column[i] === null ? "" : String(column[i])));
  });
  // of the tip of a rod of 0.5 m, whose wall is 0.2 m from the pivot; energies of its speed and height
  const column = (name) => head.findIndex((one) => one === name);
  const at = (row, name) => {
    assert.ok(column(name) > 0, `${name} in ${head}`);
    return Number(row[column(name)]);
  };
  for (const row of rows) {
    const [q, u] = [at(row, "q1 [rad]"), at(row, "u1 [rad/s]")];
    const gap = head.find((one) => one.startsWith("gap "));
    assert.ok(Math.abs(at(row, gap) - (0.2 - 0.5 * Math.sin(q))) < 1e-12, row.join());
    const kinetic = head.find((one) => /^energ.* kinetic/.test(one));
    assert.ok(Math.abs(at(row, kinetic) - (0.25 / 3) * u * u / 2) < 1e-11, row.join());
  }
  assert.ok(rows.length > 100 && Math.abs(at(rows[0], "q1 [rad]") - 0.3) < 1e-15 && at(rows[0], "u1 [rad/s]") === 6);
  await page.close();
});

test("the picture is a file of its own that looks as the page does", async () => {
  for (const scheme of ["light", "dark"]) {
    const { page } = await open(browser, FILE, { scheme });
    await page.click("#play");
    await page.$eval("#time", (node) => {
      node.value = 0.1;
      node.dispatchEvent(new Event("input"));
    });
    const points = (root) =>
      page.evaluate((svg) => {
        const from = svg ? new DOMParser().parseFromString(svg, "image/svg+xml") : document;
        if (from.querySelector("parsererror")) return "is no XML";
        const stage = svg ? from.documentElement : document.querySelector("#stage");
        return [...stage.querySelectorAll("circle")].map((node) => `${node.getAttribute("cx")} ${node.getAttribute("cy")}`);
      }, root);
    const [svg] = await saved(page, "svg", ["Pendulum.svg"]);
    const [own, stage] = [await points(svg), await points("")];
    // what is not shown is left out
    assert.ok(Array.isArray(own) && own.length >= 2 && own.every((one) => stage.includes(one)), `${own}; ${stage}`);
    assert.doesNotMatch(svg, /class=|var\(|href=|url\(/);
    // shown by itself it has the pixels of the page, but for the rim of the stage
    const clip = await page.$eval("#stage", (node) => {
      const { x, y } = node.getBoundingClientRect();
      const [left, top] = [x + node.clientLeft + 4, y + node.clientTop + scrollY + 4];
      return { x: left, y: top, width: node.clientWidth - 8, height: node.clientHeight - 8 };
    });
    const seen = await page.screenshot({ clip, captureBeyondViewport: true, encoding: "base64" });
    const alone = await browser.newPage();
    await alone.setViewport({ width: 1280, height: 900 });
    await alone.setContent(`<style>body { margin: 0 }</style>${svg}`);
    const size = await alone.$eval("svg", (node) => [node.clientWidth, node.clientHeight]);
    const within = { x: 4, y: 4, width: clip.width, height: clip.height };
    const other = await alone.screenshot({ clip: within, encoding: "base64" });
    const differing = await alone.evaluate(async (...pictures) => {
      const pixels = await Promise.all(
        pictures.map(async (data) => {
          const picture = new Image();
          picture.src = `data:image/png;base64,${data}`;
          await picture.decode();
          const canvas = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
          canvas.drawImage(picture, 0, 0);
          return canvas.getImageData(0, 0, picture.width, picture.height).data;
        }),
      );
      let [unlike, drawn] = [0, 0];
      const ground = pixels[0].slice(0, 3);
      for (let i = 0; i < pixels[0].length; i += 4) {
        const far = (a, b) => Math.max(...[0, 1, 2].map((k) => Math.abs(a[k] - b[k]))) > 48;
        unlike += far(pixels[0].slice(i, i + 3), pixels[1].slice(i, i + 3));
        drawn += far(pixels[0].slice(i, i + 3), ground);
      }
      return { unlike, drawn, same: pixels[0].length === pixels[1].length, dark: ground[0] + ground[1] + ground[2] < 384 };
    }, seen, other);
    assert.ok(size[0] > 200 && differing.same, `${size}`);
    assert.equal(differing.dark, scheme === "dark");
    assert.ok(differing.drawn > 500 && differing.unlike < differing.drawn / 20, `${scheme}: ${JSON.stringify(differing)}`);
    await alone.close();
    await page.close();
  }
});

test("equations are those of the tool, and are not offered without a derivation", async () => {
  const { page } = await open(browser, server.home);
  assert.equal(await page.$eval("#equations", (node) => node.checkVisibility()), false);
  const before = await moved(page);
  await page.select("#examples", await page.$$eval("#examples option", (all) => all.find((one) => one.textContent === "planar_double_pendulum").value));
  await movesOn(page, before);
  await page.waitForFunction(() => document.querySelector("#equations").checkVisibility(), { timeout: 20_000 });
  await page.click("#equations");
  await page.waitForFunction(() => document.querySelector("#equations-box").open);
  const shown = await page.$eval("#equations-frame", (node) => node.srcdoc);
  const model = new URL("../../models/planar_double_pendulum.mech", import.meta.url).pathname;
  assert.equal(shown, execFileSync(tool, ["explain", model, "--format", "html"], { encoding: "utf8" }));
  const frame = await (await page.$("#equations-frame")).contentFrame();
  await frame.waitForSelector("math");
  assert.match(await frame.$eval("h1", (node) => node.textContent), /PlanarDoublePendulum/);
  await page.click("#close");
  assert.equal(await page.$eval("#equations-box", (node) => node.open), false);
  // with another text they would be those of another model
  const changed = (await text(page)).replace("rotate(z, q1)", "rotate(z, 2*q1)");
  assert.notEqual(changed, await text(page));
  await put(page, changed);
  await page.click("#equations");
  await page.waitForFunction(() => document.querySelector("#equations-box").open);
  assert.match(await page.$eval("#equations-said", (node) => node.checkVisibility() && node.textContent), /the derivation .*hodograph derive/);
  assert.equal(await page.$eval("#equations-frame", (node) => node.checkVisibility() || node.srcdoc), "");
  await page.close();
});
