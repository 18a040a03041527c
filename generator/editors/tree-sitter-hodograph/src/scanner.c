// Block comments nest, which regular expressions cannot say.
#include "tree_sitter/parser.h"

void *tree_sitter_hodograph_external_scanner_create(void) { return NULL; }
void tree_sitter_hodograph_external_scanner_destroy(void *payload) { (void)payload; }
unsigned tree_sitter_hodograph_external_scanner_serialize(void *payload, char *buffer) {
    (void)payload;
    (void)buffer;
    return 0;
}
void tree_sitter_hodograph_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
    (void)payload;
    (void)buffer;
    (void)length;
}

bool tree_sitter_hodograph_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid_symbols) {
    (void)payload;
    if (!valid_symbols[0]) return false;
    while (lexer->lookahead == ' ' || (lexer->lookahead >= '\t' && lexer->lookahead <= '\r')) lexer->advance(lexer, true);
    if (lexer->lookahead != '/') return false;
    lexer->advance(lexer, false);
    if (lexer->lookahead != '*') return false;
    lexer->advance(lexer, false);
    unsigned depth = 1;
    while (depth > 0) {
        if (lexer->eof(lexer)) return false;
        int32_t first = lexer->lookahead;
        lexer->advance(lexer, false);
        if (first == '*' && lexer->lookahead == '/') {
            lexer->advance(lexer, false);
            depth--;
        } else if (first == '/' && lexer->lookahead == '*') {
            lexer->advance(lexer, false);
            depth++;
        }
    }
    lexer->result_symbol = 0;
    return true;
}
