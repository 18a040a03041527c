// The models in a page: which blocks are one, and the whole of those that show a few sections only.

import { readFileSync } from "node:fs";

/** Sections in the order of a file: the front end's list. */
const SECTIONS = (() => {
  const words = readFileSync(new URL("../../generator/model/src/words.rs", import.meta.url), "utf8");
  const list = /pub const SECTIONS[^=]*=([\s\S]*?)\n\];/.exec(words)[1];
  return [...list.matchAll(/word\(\s*"(\w+)"/g)].map((found) => found[1]);
})();

const split = (text) => {
  const parts = [];
  for (const line of text.split(/(?<=\n)/)) {
    const at = SECTIONS.indexOf(line.split(/[ {]/)[0]);
    if (at < 0 && parts.length) parts.at(-1).text += line;
    else parts.push({ at, text: line });
  }
  return parts;
};
const isWhole = (text) => /^(\/\/!.*\n|\/\/.*\n|import\s.*\n|\s*\n)*(part\b|mechanism\b)/.test(text);

/** The sections of an example in the place of those of a frame, as `explanations::within` of the front end has it. */
export const within = (frame, text) => {
  if (isWhole(text)) return text;
  const own = split(text);
  const parts = split(frame).filter((part) => part.at < 0 || own.every((other) => other.at !== part.at));
  return [...parts, ...own]
    .sort((a, b) => a.at - b.at)
    .map((part) => part.text)
    .join("");
};

/**
 * The block of a page as a whole model, or nothing where the block is none. `context` is the comment before it that
 * gives the sections which it leaves out; `frame` the model that examples of the page complete, where there is one.
 */
export const wholeModel = (text, { context = null, frame = null }) => {
  if (isWhole(text)) return text;
  const begins = SECTIONS.some((word) => new RegExp(`^${word}\\s*\\{`, "m").test(text));
  if (!begins) return null;
  if (context !== null) return within(`mechanism Example;\n${context}`, text);
  return frame === null ? null : within(frame, text);
};
