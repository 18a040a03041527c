// The module in node, as the page's worker has it.

import { readFileSync } from "node:fs";

/** Asks the module; `goOn` is told how far a motion is, and says whether to go on. */
export async function load(goOn = () => true) {
  const host = { go_on: (time) => (goOn(time) ? 1 : 0) };
  const bytes = readFileSync(new URL("../dist/site/hodograph.wasm", import.meta.url));
  const { exports } = (await WebAssembly.instantiate(bytes, { host })).instance;
  return (question) => {
    const bytes = new TextEncoder().encode(
      typeof question === "string" ? question : JSON.stringify(question),
    );
    const place = exports.room(bytes.length);
    new Uint8Array(exports.memory.buffer, place, bytes.length).set(bytes);
    const length = exports.ask(place, bytes.length);
    return JSON.parse(
      new TextDecoder().decode(new Uint8Array(exports.memory.buffer, exports.answer(), length)),
    );
  };
}
