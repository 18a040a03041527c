-- For Neovim: `require('hodograph')`, with this file in a folder `lua` of the runtime path.
vim.cmd([[autocmd BufRead,BufNewFile *.mech setfiletype hodograph]])
vim.api.nvim_create_autocmd('FileType', {
  pattern = 'hodograph',
  callback = function(event)
    vim.bo[event.buf].commentstring = '// %s'
    local id = vim.lsp.start_client({
      name = 'hodograph',
      cmd = { vim.g.hodograph_path or 'hodograph', 'lsp' },
      root_dir = vim.fn.getcwd(),
    })
    vim.lsp.buf_attach_client(event.buf, id)
  end,
})
