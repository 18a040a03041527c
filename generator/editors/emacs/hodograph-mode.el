;;; hodograph-mode.el --- models of mechanisms, with eglot  -*- lexical-binding: t -*-
;; (load "/path/to/hodograph-mode.el"); `M-x eglot' in a model starts the server, and so does the hook below.
(define-derived-mode hodograph-mode prog-mode "Hodograph"
  (setq-local comment-start "// ")
  (modify-syntax-entry ?/ ". 124b")
  (modify-syntax-entry ?* ". 23")
  (modify-syntax-entry ?\n "> b"))
(add-to-list 'auto-mode-alist '("\\.mech\\'" . hodograph-mode))
(with-eval-after-load 'eglot
  (add-to-list 'eglot-server-programs '(hodograph-mode . ("hodograph" "lsp"))))
(add-hook 'hodograph-mode-hook (lambda () (when (fboundp 'eglot-ensure) (eglot-ensure))))
(provide 'hodograph-mode)
