// Starts the language server, shows the pages that it writes beside the text, and the playground.
const { spawn } = require('child_process');
const fs = require('fs');
const vscode = require('vscode');
const { LanguageClient } = require('vscode-languageclient/node');

let client;

function show(title) {
  return async () => {
    const editor = vscode.window.activeTextEditor;
    if (!editor) return;
    await editor.document.save();
    const command = `hodograph.${title}`;
    const page = await client.sendRequest('workspace/executeCommand', {
      command,
      arguments: [client.code2ProtocolConverter.asUri(editor.document.uri)],
    });
    const options = { enableScripts: true };
    const panel = vscode.window.createWebviewPanel('hodograph', title, vscode.ViewColumn.Beside, options);
    panel.webview.html = fs.readFileSync(page.path, 'utf8');
  };
}

// The servers of `hodograph serve`, by the file that they show.
const served = new Map();

// The address of the playground with the model of a file; a server for it is started where there is none.
function serve(file) {
  const known = served.get(file);
  if (known) return known.address;
  const settings = vscode.workspace.getConfiguration('hodograph');
  const page = settings.get('page');
  const words = ['serve', file, '--port', '0', ...(page ? ['--page', page] : [])];
  const child = spawn(settings.get('path'), words, { stdio: ['ignore', 'ignore', 'pipe'] });
  const address = new Promise((found, failed) => {
    let said = '';
    child.stderr.on('data', (part) => {
      said += part;
      const address = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
      if (address) found(address[0]);
    });
    child.on('error', failed);
    child.on('exit', () => {
      if (served.get(file)?.child === child) served.delete(file);
      failed(new Error(said.trim() || 'hodograph serve has ended'));
    });
  });
  served.set(file, { child, address });
  return address;
}

async function playground() {
  const editor = vscode.window.activeTextEditor;
  if (!editor) return;
  await editor.document.save();
  try {
    const address = await serve(editor.document.uri.fsPath);
    await vscode.commands.executeCommand('simpleBrowser.api.open', vscode.Uri.parse(address), {
      viewColumn: vscode.ViewColumn.Beside,
      preserveFocus: true,
    });
  } catch (error) {
    vscode.window.showErrorMessage(`Hodograph: ${error.message}`);
  }
}

exports.activate = async (context) => {
  const settings = vscode.workspace.getConfiguration('hodograph');
  const server = { command: settings.get('path'), args: ['lsp'] };
  client = new LanguageClient('hodograph', 'Hodograph', server, {
    documentSelector: [{ language: 'hodograph' }],
    synchronize: { configurationSection: 'hodograph' },
    initializationOptions: { inlayHints: settings.get('inlayHints') },
  });
  for (const title of ['equations', 'simulate']) {
    context.subscriptions.push(vscode.commands.registerCommand(`hodograph.show.${title}`, show(title)));
  }
  context.subscriptions.push(vscode.commands.registerCommand('hodograph.show.playground', playground));
  await client.start();
};

exports.deactivate = () => {
  for (const { child } of served.values()) child.kill();
  served.clear();
  return client && client.stop();
};
