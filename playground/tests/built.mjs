// What the built page holds.

import { readFileSync } from "node:fs";

const html = readFileSync(new URL("../dist/site/index.html", import.meta.url), "utf8");
export const examples = JSON.parse(/id="examples-data">(.*?)<\/script>/s.exec(html)[1]);
