// The book in headless Chromium, from disk: its models run, its search finds, its pages fit.

import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { after, before, test } from "node:test";
import puppeteer from "puppeteer-core";

const book = new URL("../dist/book/", import.meta.url);
const named = process.env.HODOGRAPH_CHROMIUM;
const executablePath =
  named || ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);

let browser;
before(async () => {
  browser = await puppeteer.launch({ executablePath, args: ["--no-sandbox", "--disable-gpu"] });
});
after(() => browser.close());

const open = async (place, width = 1280) => {
  const page = await browser.newPage(),
    asked = [];
  page.on("request", (request) => asked.push(request.url()));
  page.on("pageerror", (error) => asked.push(`error: ${error.message}`));
  await page.setViewport({ width, height: width < 500 ? 844 : 900 });
  await page.goto(new URL(place, book).href);
  return { page, asked };
};
const pages = readdirSync(book, { recursive: true })
  .map(String)
  .filter((file) => file.endsWith(".html") && !/^(index|play)\.html$/.test(file));

test("a model of the tutorial runs in its place, and nothing is loaded from elsewhere", async () => {
  const { page, asked } = await open("docs/tutorial.html");
  const buttons = await page.$$("a.run");
  assert.equal(buttons.length, 3);
  await buttons[2].click();
  const frame = await (await page.waitForSelector("iframe.live")).contentFrame();
  await frame.waitForFunction(() => document.body.dataset.moved, { timeout: 60_000 });
  assert.match(await frame.evaluate(() => globalThis.hodograph.editor.text()), /tip_wall/);
  assert.match(await frame.$eval("#status", (node) => node.textContent), /moments, \d+ events/);
  await buttons[2].click();
  assert.equal(await page.$("iframe.live"), null);
  assert.deepEqual(
    asked.filter((address) => !/^(file|blob|data|about):/.test(address)),
    [],
  );
  await page.close();
});

test("a model with a mistake shows it", async () => {
  const { page } = await open("docs/tutorial.html");
  await (await page.$("a.run")).click();
  const frame = await (await page.waitForSelector("iframe.live")).contentFrame();
  await frame.waitForFunction(() => Number(document.body.dataset.errors) > 0, { timeout: 60_000 });
  assert.match(await frame.$eval("#problems", (node) => node.textContent), /E073/);
  await page.close();
});

test("every mechanism of the gallery has its button", async () => {
  const { page } = await open("docs/gallery.html");
  const models = readdirSync(new URL("../../models/", import.meta.url)).filter((file) => file.endsWith(".mech"));
  const headed = await page.$$eval("h2 + a.run", (all) => all.length);
  assert.equal(headed, models.length);
  await page.close();
});

test("the search leads to a heading", async () => {
  const { page } = await open("docs/index.html");
  await page.type("#search", "dependent coordinate");
  await page.waitForSelector("#found a");
  const address = await page.$eval("#found a", (link) => link.href);
  const file = new URL(address);
  assert.ok(readFileSync(new URL(file.pathname, "file://"), "utf8").includes(`id="${file.hash.slice(1)}"`), address);
  await page.close();
});

test("no page is wider than its window, at the widths of a laptop, a tablet and a phone", async () => {
  assert.ok(pages.length > 25, String(pages.length));
  for (const width of [1280, 768, 390]) {
    const { page, asked } = await open("docs/index.html", width);
    for (const place of pages) {
      await page.goto(new URL(place, book).href);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(wide <= 0, `${place} at ${width}: ${wide}`);
    }
    assert.deepEqual(
      asked.filter((address) => address.startsWith("error")),
      [],
    );
    await page.close();
  }
});
