// The extension of VS Code, with a stand-in for the editor: its playground is the tool's, at the address it tells.

import assert from "node:assert/strict";
import { writeFileSync, mkdtempSync, rmSync } from "node:fs";
import Module, { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

const tool = process.env.HODOGRAPH_TOOL;
const page = new URL("../dist/hodograph.html", import.meta.url).pathname;

test("the command opens a server of the file, once, and ends it", async () => {
  const folder = mkdtempSync(join(tmpdir(), "hodograph-"));
  const model = join(folder, "pendulum.mech");
  writeFileSync(model, "mechanism Pendulum;\n");
  const opened = [],
    messages = [],
    commands = new Map();
  let settings = { path: tool, page };
  const vscode = {
    workspace: { getConfiguration: () => ({ get: (name) => settings[name] }) },
    window: {
      activeTextEditor: { document: { save: async () => true, uri: { fsPath: model } } },
      showErrorMessage: (text) => messages.push(text),
    },
    commands: {
      registerCommand: (name, run) => commands.set(name, run),
      executeCommand: async (name, address) => opened.push([name, address]),
    },
    Uri: { parse: (text) => text },
    ViewColumn: { Beside: -2 },
  };
  class LanguageClient {
    async start() {}
    async stop() {}
  }
  const load = Module._load;
  Module._load = (name, ...rest) =>
    name === "vscode" ? vscode : name.startsWith("vscode-languageclient") ? { LanguageClient } : load(name, ...rest);
  try {
    const require = createRequire(import.meta.url);
    const extension = require("../../generator/editors/vscode/extension.js");
    await extension.activate({ subscriptions: [] });
    const show = commands.get("hodograph.show.playground");
    await show();
    await show();
    assert.equal(opened.length, 2);
    assert.equal(opened[0][0], "simpleBrowser.api.open");
    assert.equal(opened[0][1], opened[1][1]);
    const answer = await fetch(opened[0][1]);
    assert.match(await answer.text(), /data-served/);
    await extension.deactivate();
    await assert.rejects(async () => {
      for (let tries = 0; tries < 100; tries += 1) {
        await fetch(opened[0][1]);
        await new Promise((done) => setTimeout(done, 50));
      }
    });
    settings = { path: tool, page: join(folder, "nothing.html") };
    await show();
    assert.match(messages.join(), /there is no page at/);
  } finally {
    Module._load = load;
    rmSync(folder, { recursive: true });
  }
});
