// A headless Chromium, and the page in it: what the tests of the page share.

import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import puppeteer from "puppeteer-core";

export const dist = new URL("../dist/", import.meta.url);
export const FILE = new URL("hodograph.html", dist).href;
const executablePath =
  process.env.HODOGRAPH_CHROMIUM ||
  ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const kinds = { html: "text/html", css: "text/css", js: "text/javascript", wasm: "application/wasm" };

export const launch = () =>
  puppeteer.launch({
    executablePath,
    args: ["--no-sandbox", "--disable-gpu", "--force-prefers-reduced-motion=0"],
  });

/** Opens the page at an address and waits for its first motion; with it, all that it asked for. */
export const open = async (browser, address, { width = 1280, still = false, scheme = "light" } = {}) => {
  const page = await browser.newPage(),
    asked = [];
  page.on("request", (request) => asked.push(request.url()));
  page.on("pageerror", (error) => asked.push(`error: ${error.message}`));
  await page.setViewport({ width, height: width < 500 ? 844 : 900 });
  await page.emulateMediaFeatures([
    { name: "prefers-reduced-motion", value: still ? "reduce" : "no-preference" },
    { name: "prefers-color-scheme", value: scheme },
  ]);
  await page.goto(address);
  await page.waitForFunction(() => document.body.dataset.moved, { timeout: 60_000 });
  return { page, asked };
};

/** Serves the folder; its address, and how to end it. */
export const serve = async () => {
  const server = createServer((request, response) => {
    const name = request.url === "/" ? "index.html" : request.url.slice(1);
    const file = new URL(`site/${name}`, dist);
    if (!existsSync(file)) return response.writeHead(404).end();
    response
      .writeHead(200, { "content-type": kinds[name.split(".").pop()] || "text/plain" })
      .end(readFileSync(file));
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return { home: `http://127.0.0.1:${server.address().port}/`, end: () => server.close() };
};

export const moved = (page) => page.evaluate(() => Number(document.body.dataset.moved));
export const movesOn = (page, from) =>
  page.waitForFunction((from) => Number(document.body.dataset.moved) > from, { timeout: 60_000 }, from);
export const status = (page) => page.$eval("#status", (node) => node.textContent);
export const put = (page, text) => page.evaluate((text) => globalThis.hodograph.editor.replace(text), text);
export const text = (page) => page.evaluate(() => globalThis.hodograph.editor.text());
