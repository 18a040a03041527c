// A page of the repository as HTML: headings with anchors, links that lead on within the book, models that run.

import MarkdownIt from "markdown-it";
import { posix } from "node:path";
import { placeOf } from "./contents.js";
import { wholeModel } from "./models.js";

export const escape = (text) =>
  text.replace(/[&<>"]/g, (letter) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[letter]);

/** The anchor of a heading, as repositories show it: small letters, no punctuation, hyphens for spaces. */
const slug = (text) =>
  text
    .trim()
    .toLowerCase()
    .replace(/[^\p{L}\p{N}\p{M}\p{Pc}\- ]/gu, "")
    .replace(/ /g, "-");

const plain = (inline) =>
  inline.children.map((child) => (child.type === "softbreak" ? " " : child.content)).join("");

/** Whether a link leads out of the repository. */
export const isOutside = (href) => /^[a-z][a-z+.-]*:/i.test(href);

/**
 * Renders one page. `site` says what the book has: `pages`, the set of files that are pages; `runs`, which makes the
 * button of a model, told whether its page announces a mistake; `colour`, which makes the text of a model HTML; `models`, the models of the gallery by name; `read`, which
 * reads a file.
 * The answer has `html`, `title`, `headings`, the text under each for the search, and `links` as they were written.
 */
export function render(file, source, site) {
  const md = new MarkdownIt({ html: true });
  const tokens = md.parse(source, {});
  const here = posix.dirname(file);
  const root = posix.relative(posix.dirname(placeOf(file)), "") || ".";
  const links = [],
    headings = [],
    used = new Map(),
    faults = [];

  const lead = (href) => {
    if (isOutside(href)) return href;
    links.push(href);
    const [path, anchor] = href.split("#");
    if (!path) return href;
    const target = posix.normalize(posix.join(here, decodeURI(path)));
    const place = site.pages.has(target) ? placeOf(target) : site.carry(target, file);
    return `${root}/${place}${anchor ? `#${anchor}` : ""}`;
  };

  tokens.forEach((token, index) => {
    if (token.type === "heading_open") {
      const text = plain(tokens[index + 1]);
      const base = slug(text),
        count = used.get(base) ?? 0;
      used.set(base, count + 1);
      const id = count ? `${base}-${count}` : base;
      token.attrSet("id", id);
      headings.push({ id, text, level: Number(token.tag[1]), body: [] });
    } else if (token.type === "inline") {
      if (file === "docs/gallery.md") withRuns(token, tokens, index, here, site, root);
      for (const child of token.children) {
        if (child.type === "link_open") child.attrSet("href", lead(child.attrGet("href")));
        if (child.type === "image") child.attrSet("src", lead(child.attrGet("src")));
        if (child.type === "html_inline" && !child.meta) child.content = withLinks(child.content, lead);
      }
      headings.at(-1)?.body.push(plain(token));
    } else if (token.type === "html_block") token.content = withLinks(token.content, lead);
  });

  // The sections that complete an example stand in a comment before it, as the tests of the language's page read it;
  // examples of errors complete the first model of their page.
  let context = null,
    frame = null,
    mistaken = false;
  const blocks = new Map();
  for (const token of tokens) {
    if (token.type === "html_block" && token.content.startsWith("<!-- step: has a mistake")) mistaken = true;
    const comment = token.type === "html_block" && /^<!-- context\n([\s\S]*?)-->/.exec(token.content);
    if (comment) context = comment[1];
    if (token.type !== "fence") continue;
    const whole = token.info.trim() === "text" ? wholeModel(token.content, { context, frame }) : null;
    // Examples of errors say which of them are wrong.
    mistaken ||= token.content.startsWith("// wrong");
    if (whole !== null) blocks.set(token, { whole, mistaken });
    if (whole !== null && file === "docs/errors.md") frame ??= whole;
    context = null;
    mistaken = false;
  }
  md.renderer.rules.fence = (all, index) => {
    const token = all[index],
      block = blocks.get(token);
    const code = block === undefined ? escape(token.content) : site.colour(token.content);
    const body = `<pre tabindex="0"><code>${code}</code></pre>`;
    if (block === undefined) return `${body}\n`;
    const run = site.runs(block.whole, `${file}:${token.map[0] + 1}`, root, "Edit and run", block.mistaken);
    return `<figure class="model">${body}${run ?? ""}</figure>\n`;
  };
  // Each mechanism of the gallery moves: its heading names its model.
  md.renderer.rules.heading_close = (all, index) => {
    const name = all[index - 1].content;
    const model = file === "docs/gallery.md" ? site.models.get(name) : undefined;
    const run = model === undefined ? "" : site.runs(model, `models/${name}.mech`, root, "Move it");
    return `</${all[index].tag}>\n${run ?? ""}`;
  };
  md.renderer.rules.table_open = () => '<div class="wide" tabindex="0"><table>\n';
  md.renderer.rules.table_close = () => "</table></div>\n";
  const html = md.renderer.render(tokens, md.options, {});
  return { html, root, title: headings[0]?.text ?? file, headings, links, faults };
}

/** Adds to a link in a table that leads to a model the button that runs it. */
const withRuns = (inline, tokens, index, here, site, root) => {
  if (tokens[index - 1].type !== "td_open") return;
  const links = inline.children.filter((child) => child.type === "link_open");
  for (const link of links) {
    const target = posix.normalize(posix.join(here, link.attrGet("href")));
    const run = target.endsWith(".mech") ? site.runs(site.read(target), target, root, "Move it") : null;
    if (run === null) continue;
    const html = new link.constructor("html_inline", "", 0);
    html.content = ` ${run}`;
    html.meta = { isLed: true };
    inline.children.splice(inline.children.indexOf(link) + 3, 0, html);
  }
};

/** HTML in a page, with its sources and addresses led on. */
const withLinks = (html, lead) =>
  html.replace(/\b(src|href)="([^"]*)"/g, (_, name, address) => `${name}="${lead(address)}"`);
