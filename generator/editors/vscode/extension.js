// Starts the language server, and shows the pages that it writes beside the text.
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
  await client.start();
};

exports.deactivate = () => client && client.stop();
