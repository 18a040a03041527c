-- For Neovim: `require('hodograph')`, with this file in a folder `lua` of the runtime path.
local client -- one server for all models, so that a file and what it imports know each other
vim.cmd([[autocmd BufRead,BufNewFile *.mech setfiletype hodograph]])
vim.api.nvim_create_autocmd('FileType', {
  pattern = 'hodograph',
  callback = function(event)
    vim.bo[event.buf].commentstring = '// %s'
    client = client or vim.lsp.start_client({
      name = 'hodograph',
      cmd = { vim.g.hodograph_path or 'hodograph', 'lsp' },
      root_dir = vim.fn.getcwd(),
      on_exit = function() client = nil end,
    })
    vim.lsp.buf_attach_client(event.buf, client)
  end,
})
