//! The language server in a real client: headless Neovim, with the file that the repository gives its users.

use std::path::Path;
use std::process::Command;

/// What the client does, and what it reports: a line for each step.
const SCRIPT: &str = r#"
local report = {}
local function say(text) table.insert(report, text) end
local function wait(what, condition)
  if not vim.wait(20000, condition, 20) then say('timeout: ' .. what) end
end
local function params() return vim.lsp.util.make_position_params(0, 'utf-16') end
local function ask(method, more)
  local answers = vim.lsp.buf_request_sync(0, method, vim.tbl_extend('force', params(), more or {}), 20000)
  for _, answer in pairs(answers or {}) do return answer.result, answer.error end
end
local ok, failed = pcall(function()
  vim.cmd('edit ' .. vim.env.MODEL)
  local buffer = vim.api.nvim_get_current_buf()
  wait('attached', function() return next(vim.lsp.buf_get_clients(buffer)) ~= nil end)
  wait('a mistake', function() return #vim.diagnostic.get(buffer) > 0 end)
  local found = vim.diagnostic.get(buffer)[1]
  say('mistake ' .. (found.code or '?') .. ' in line ' .. (found.lnum + 1))
  vim.api.nvim_win_set_cursor(0, { found.lnum + 1, found.col })
  -- mend it, as its author would
  vim.cmd('%s/l1x/l1/g')
  wait('no mistake', function() return #vim.diagnostic.get(buffer) == 0 end)
  say('mistakes ' .. #vim.diagnostic.get(buffer))
  vim.fn.search('l1\\/2')
  local hover = ask('textDocument/hover')
  say('hover ' .. (hover.contents.value:match('length of the crank') or '?'))
  vim.lsp.buf.rename('crank')
  wait('renamed', function() return vim.fn.search('crank\\/2', 'nw') > 0 end)
  say('renamed ' .. vim.fn.search('crank: m', 'nw'))
  vim.lsp.buf.rename('l2')
  vim.wait(500, function() return false end)
  say('clash ' .. vim.fn.search('crank\\/2', 'nw'))
  vim.cmd('%s/crank: m = /crank:m=/')
  local options = { tabSize = 4, insertSpaces = true }
  local edits = ask('textDocument/formatting', { options = options })
  vim.lsp.util.apply_text_edits(edits, buffer, 'utf-16')
  say('formatted ' .. (vim.fn.search('crank: *m *= 0.2', 'nw')))
end)
if not ok then say('failed: ' .. tostring(failed)) end
vim.fn.writefile(report, vim.env.REPORT)
vim.cmd('qall!')
"#;

#[test]
#[ignore = "needs Neovim"]
fn a_model_is_edited_in_neovim() {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(root.join("models/slider_crank.mech")).unwrap();
    let at = |path: &str| folder.path().join(path);
    std::fs::write(at("slider_crank.mech"), text.replacen("l1/2*A.x", "l1x/2*A.x", 1)).unwrap();
    std::fs::write(at("client.lua"), SCRIPT).unwrap();
    std::fs::create_dir(at("home")).unwrap();
    let path = format!("let g:hodograph_path = '{}'", crate::common::tool().display());
    let output = Command::new("nvim")
        .args(["--headless", "--clean", "--cmd", &path])
        .arg("--cmd")
        .arg(format!("luafile {}", root.join("generator/editors/neovim/hodograph.lua").display()))
        .arg("-c")
        .arg(format!("luafile {}", at("client.lua").display()))
        .env("MODEL", at("slider_crank.mech"))
        .env("REPORT", at("report"))
        .env("HOME", at("home"))
        .env("XDG_STATE_HOME", at("home"))
        .output()
        .expect("no Neovim here: install it (Debian: apt-get install neovim)");
    let report = std::fs::read_to_string(at("report"))
        .unwrap_or_else(|_| panic!("no report: {}", String::from_utf8_lossy(&output.stderr)));
    let line = |word: &str| 1 + text.lines().position(|line| line.contains(word)).unwrap();
    let declared = line("l1: m = 0.2");
    let expected = [
        format!("mistake E020 in line {}", line("l1/2*A.x")),
        "mistakes 0".to_owned(),
        "hover length of the crank".to_owned(),
        format!("renamed {declared}"),
        // the name is as it was, at its next place too
        format!("clash {}", line("N.y) + l1/2")),
        format!("formatted {declared}"),
    ];
    assert_eq!(report.lines().collect::<Vec<_>>(), expected, "{report}");
}
