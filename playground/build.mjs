// Bundles the page. Run by `build`, which compiles the module first.
//
//   node build.mjs WASM FOLDER

import { brotliCompressSync, gzipSync } from "node:zlib";
import { copyFileSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

const here = dirname(fileURLToPath(import.meta.url)),
  root = join(here, "..");
const [wasmFile, folder] = process.argv.slice(2);
const read = (...path) => readFileSync(join(...path), "utf8");
const shared = (name) => read(root, "simulation", "animation", "page", name);

// The drawing of a motion is what written pages have: the same files, joined in the same order.
const drawing =
  ["geometry.js", "body.js", "motion.js"].map(shared).join("\n") + "\nexport { showMotion };\n";
const worker = (
  await esbuild.transform(read(here, "page", "worker.js"), { minify: true, target: "es2022" })
).code;
const given = {
  name: "given",
  setup(build) {
    build.onResolve({ filter: /^(drawing|worker)$/ }, ({ path }) => ({ path, namespace: "given" }));
    build.onLoad({ filter: /.*/, namespace: "given" }, ({ path }) =>
      path === "drawing" ? { contents: drawing, loader: "js" } : { contents: worker, loader: "text" },
    );
  },
};
const bundle = await esbuild.build({
  entryPoints: [join(here, "page", "main.js")],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  write: false,
  plugins: [given],
  legalComments: "none",
  metafile: true,
});
const script = bundle.outputFiles[0].text.replaceAll("</script", "<\\/script");
const style = (
  await esbuild.transform(
    read(root, "generator", "model", "src", "page.css") +
      shared("style.css") +
      read(here, "page", "words.css") +
      read(here, "page", "page.css"),
    { loader: "css", minify: true },
  )
).code;

// The models of the menu: small ones first, then those of the gallery.
const models = join(root, "models");
const FIRST = ["planar_double_pendulum", "two_sleds", "rattleback", "rolling_disc", "spherical_pendulum"];
const names = readdirSync(models)
  .filter((file) => file.endsWith(".mech"))
  .map((file) => file.slice(0, -5));
const order = [
  ...FIRST.filter((name) => names.includes(name)),
  ...names.filter((name) => !FIRST.includes(name)).sort(),
];
const examples = [
  { name: "pendulum", text: read(here, "page", "pendulum.mech") },
  ...order.map((name) => ({ name, text: read(models, `${name}.mech`) })),
];
// One whose parts are in a file of their own.
const partsFolder = join(root, "tests", "data", "parts");
examples.push({
  name: "quadruped",
  text: read(partsFolder, "quadruped.mech"),
  files: { "leg.mech": read(partsFolder, "leg.mech") },
});
const json = (value) => JSON.stringify(value).replace(/</g, "\\u003c");

// Licences of what is bundled, beside it.
const packages = [
  ...new Set(
    Object.keys(bundle.metafile.inputs).flatMap(
      (file) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(file)?.[1] ?? [],
    ),
  ),
].sort();
const licence = (name) => {
  const at = join(here, "node_modules", name);
  const file = readdirSync(at).find((file) => /^licen[cs]e/i.test(file));
  if (!file) throw new Error(`${name} has no licence text`);
  return `${name} ${JSON.parse(read(at, "package.json")).version}\n\n${read(at, file).trim()}\n`;
};
const licences = `The page bundles these packages; Hodograph itself is under MIT or Apache 2.0.\n\n${packages.map(licence).join("\n---\n\n")}`;

const wasm = readFileSync(wasmFile);
const packed = gzipSync(wasm, { level: 9 });
const html = read(here, "page", "index.html").replace("<!-- examples -->", () => json(examples));
const page = (parts) =>
  Object.entries(parts).reduce((text, [mark, part]) => text.replace(`<!-- ${mark} -->`, () => part), html);
const single = page({
  style: `<style>${style}</style>`,
  module: `<script type="application/octet-stream" id="wasm">${packed.toString("base64")}</script>`,
  script: `<script>${script}</script>`,
});
const apart = page({
  style: '<link rel="stylesheet" href="style.css">',
  module: "",
  script: '<script src="page.js" defer></script>',
});

rmSync(folder, { recursive: true, force: true });
mkdirSync(join(folder, "site", "models"), { recursive: true });
const put = (name, content) => writeFileSync(join(folder, name), content);
put("hodograph.html", single);
put("LICENCES.txt", licences);
put("site/index.html", apart);
put("site/style.css", style);
put("site/page.js", script);
put("site/hodograph.wasm", wasm);
put("site/LICENCES.txt", licences);
// The folder has the derivations of the examples: these then have the numbers and equations of the tool.
for (const name of order)
  copyFileSync(join(models, `${name}.derivation`), join(folder, "site", "models", `${name}.derivation`));
copyFileSync(join(partsFolder, "quadruped.derivation"), join(folder, "site", "models", "quadruped.derivation"));

const size = (name, bytes) => {
  const buffer = Buffer.from(bytes);
  const [gzip, brotli] = [gzipSync(buffer, { level: 9 }).length, brotliCompressSync(buffer).length];
  console.log(
    `${name.padEnd(24)} ${String(buffer.length).padStart(8)} bytes, gzip ${String(gzip).padStart(7)}, brotli ${String(brotli).padStart(7)}`,
  );
  return { name, bytes: buffer.length, gzip, brotli };
};
const parts = [
  ["module (wasm)", wasm],
  ["script", script],
  ["style", style],
  ["page", apart],
].map(([name, bytes]) => size(name, bytes));
const sum = (kind) => parts.reduce((all, part) => all + part[kind], 0);
console.log(
  `${"folder, all of it".padEnd(24)} ${" ".repeat(15)} gzip ${String(sum("gzip")).padStart(7)}, brotli ${String(sum("brotli")).padStart(7)}`,
);
console.log(`one file (hodograph.html)  ${single.length} bytes`);
put(
  "sizes.json",
  JSON.stringify({ parts, folder: { gzip: sum("gzip"), brotli: sum("brotli") }, file: single.length }),
);
