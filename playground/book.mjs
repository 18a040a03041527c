// Makes the book: the documents of the repository as a site whose models run. Run by `build`, after the page.
//
//   node book.mjs FOLDER
//
// Ends with an error where a link leads nowhere, or a model has mistakes that its page does not announce.

import * as esbuild from "esbuild";
import MiniSearch from "minisearch";
import { copyFileSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import { dirname, join, posix } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateRawSync } from "node:zlib";
import { PARTS, placeOf } from "./book/contents.js";
import { escape, isOutside, render } from "./book/markdown.js";
import { load } from "./tests/module.mjs";

const here = dirname(fileURLToPath(import.meta.url)),
  root = join(here, "..");
const dist = process.argv[2],
  folder = join(dist, "book");
const read = (...path) => readFileSync(join(...path), "utf8");
const ask = await load();
const pages = PARTS.flatMap((part) => part.pages);
const faults = [];
const count = { models: 0, mistaken: 0, carried: 0, links: 0, outside: 0 };

const put = (place, content) => {
  mkdirSync(dirname(join(folder, place)), { recursive: true });
  writeFileSync(join(folder, place), content);
};

// Files of the repository to which pages lead: pictures and folders' lists as they are, sources as text.
const carried = new Map();
const carry = (target, from) => {
  const path = join(root, target);
  if (!existsSync(path) || target.startsWith("..")) {
    faults.push(`${from}: ${target} is not there`);
    return target;
  }
  if (carried.has(target)) return carried.get(target);
  const isFolder = statSync(path).isDirectory();
  const shown = /\.(svg|png|jpg|html|jsonl|json|csv|txt)$/.test(target) && !isFolder;
  const place = isFolder ? posix.join(target, "files.txt") : shown ? target : `${target}.txt`;
  carried.set(target, place);
  if (isFolder) put(place, `${readdirSync(path).sort().join("\n")}\n`);
  else {
    mkdirSync(dirname(join(folder, place)), { recursive: true });
    copyFileSync(path, join(folder, place));
  }
  count.carried += 1;
  return place;
};

// The text of a model with its words in the colours of the editor.
const colour = (text) => {
  let html = "",
    at = 0;
  for (const [from, to, kind] of ask({ ask: "check", text }).colours) {
    html += `${escape(text.slice(at, from))}<span class="word-${kind}">${escape(text.slice(from, to))}</span>`;
    at = to;
  }
  return html + escape(text.slice(at));
};
// The button of a model, with its text in the address. Its page may announce that it has mistakes; then it must.
const runs = (text, where, up, name, announced = false) => {
  // The page reads one text: it does not follow imports, and a file of parts alone does not move.
  if (/^\s*import\b/m.test(text) || !/^\s*mechanism\b/m.test(text)) return null;
  const { findings } = ask({ ask: "check", text });
  const wrong = findings.filter((found) => found.error);
  if (announced && !findings.length) faults.push(`${where}: this model has no mistake, and its page says that it has`);
  if (wrong.length && !announced) faults.push(`${where}: ${wrong[0].code}: ${wrong[0].message.split("\n")[0]}`);
  count.models += 1;
  count.mistaken += wrong.length ? 1 : 0;
  const fragment = deflateRawSync(JSON.stringify({ text }), { level: 9 }).toString("base64url");
  return `<a class="run" href="${up}/play.html#m=${fragment}">${name}</a>`;
};
const models = new Map(
  readdirSync(join(root, "models"))
    .filter((file) => file.endsWith(".mech"))
    .map((file) => [file.slice(0, -5), read(root, "models", file)]),
);

rmSync(folder, { recursive: true, force: true });
const site = { pages: new Set(pages.map((page) => page.file)), carry, colour, runs, models, read: (file) => read(root, file) };
const made = new Map(pages.map(({ file, title }) => {
  const page = render(file, read(root, file), site);
  return [file, { ...page, title: title ?? page.title }];
}));

// Every document is a page.
for (const name of readdirSync(join(root, "docs")).filter((name) => name.endsWith(".md")))
  if (!made.has(`docs/${name}`)) faults.push(`docs/${name} stands in no part of book/contents.js`);

// Every link within the book leads to a page, a file or a heading.
for (const [file, page] of made)
  for (const link of page.links) {
    count.links += 1;
    const [path, anchor] = link.split("#");
    const target = path ? posix.normalize(posix.join(posix.dirname(file), decodeURI(path))) : file;
    if (!anchor || !made.has(target)) continue;
    if (!made.get(target).headings.some((heading) => heading.id === anchor))
      faults.push(`${file}: ${link}: no heading of ${target} is #${anchor}`);
  }

const template = read(here, "book", "page.html");
pages.forEach(({ file }, index) => {
  const page = made.get(file),
    up = page.root;
  const link = (other, current = false) =>
    `<a href="${up}/${placeOf(other)}"${current ? ' aria-current="page"' : ""}>${escape(made.get(other).title)}</a>`;
  const list = PARTS.map(
    (part) =>
      `<b>${part.title}</b><ul>${part.pages.map((one) => `<li>${link(one.file, one.file === file)}</li>`).join("")}</ul>`,
  ).join("");
  const contents = page.headings
    .filter(({ level }) => level === 2 || level === 3)
    .map(({ id, text, level }) => `<li class="level-${level}"><a href="#${id}">${escape(text)}</a></li>`)
    .join("");
  const [before, after] = [pages[index - 1], pages[index + 1]];
  const parts = {
    title: `${escape(page.title)}: Hodograph`,
    root: up,
    pages: list,
    text: page.html,
    contents: contents && `<b>On this page</b><ul>${contents}</ul>`,
    onward: `<span>${before ? `Before: ${link(before.file)}` : ""}</span><span>${after ? `Next: ${link(after.file)}` : ""}</span>`,
  };
  put(
    placeOf(file),
    Object.entries(parts).reduce((text, [mark, part]) => text.replaceAll(`<!-- ${mark} -->`, () => part), template),
  );
});

// The search knows each heading with the text below it.
const search = new MiniSearch({ fields: ["title", "text"], storeFields: ["title", "page", "place"] });
search.addAll(
  [...made].flatMap(([file, page]) =>
    page.headings.map(({ id, text, body }) => ({
      id: `${file}#${id}`,
      title: text,
      page: page.title,
      place: `${placeOf(file)}#${id}`,
      text: body.slice(1).join(" "),
    })),
  ),
);
put("search.js", `globalThis.hodographSearch=${JSON.stringify(search)};`);

const script = await esbuild.build({
  entryPoints: [join(here, "book", "book.js")],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  write: false,
  legalComments: "none",
});
put("book.js", script.outputFiles[0].text);
const style =
  read(root, "generator", "model", "src", "page.css") +
  read(root, "simulation", "animation", "page", "style.css") +
  read(here, "page", "words.css") +
  read(here, "book", "book.css");
put("book.css", (await esbuild.transform(style, { loader: "css", minify: true })).code);
copyFileSync(join(dist, "hodograph.html"), join(folder, "play.html"));
const licence = read(here, "node_modules", "minisearch", "LICENSE.txt").trim();
put("LICENCES.txt", `${read(dist, "LICENCES.txt").trimEnd()}\n\n---\n\nminisearch\n\n${licence}\n`);
put("index.html", '<!DOCTYPE html><meta charset="utf-8"><title>Hodograph</title><meta http-equiv="refresh" content="0; url=docs/index.html"><a href="docs/index.html">Hodograph</a>');

for (const text of made.values()) count.outside += (text.html.match(/href="https?:/g) ?? []).length;
console.log(
  `book: ${made.size} pages, ${count.models} models that run (${count.mistaken} with the mistakes that their pages announce), ` +
    `${count.carried} files beside them, ${count.links} links within, ${count.outside} outside`,
);
if (faults.length) {
  console.error(faults.join("\n"));
  process.exit(1);
}
