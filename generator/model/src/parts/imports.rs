//! Reads the files that a mechanism imports, each once, and those that these import. This crate opens no
//! files: who reads models says how.

use super::outline::Outline;
use super::places::{Place, Places};
use super::reader;
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::syntax::token::Token;
use crate::syntax::tree::Section;
use crate::syntax::{self, lexer};

/// A mechanism imports at most this many files, those included that its imports import.
const MOST_FILES: usize = 200;

/// A file that was read.
#[derive(Clone, Debug)]
pub struct Imported {
    /// what it is known by: a file has one key however its path is written
    pub key: String,
    /// what messages call it
    pub name: String,
    /// its text
    pub text: String,
}

/// Reads the files that models import.
pub trait Files {
    /// The file at a path that is relative to the importing file: another import, or the model itself.
    ///
    /// # Errors
    ///
    /// It cannot be read: why, as the rest of a sentence about the path.
    fn read(&self, importing: Option<&Imported>, path: &str) -> Result<Imported, String>;
}

/// For models whose text does not come from a file.
#[derive(Clone, Copy, Debug)]
pub struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _: Option<&Imported>, _: &str) -> Result<Imported, String> {
        Err("cannot be imported here: this text comes from no file".to_owned())
    }
}

/// A file with its outline.
#[derive(Debug)]
pub struct Read {
    /// absent for the model itself
    pub file: Option<Imported>,
    /// what it holds
    pub outline: Outline,
    /// the files that it imports
    pub imports: Vec<usize>,
}

/// The model and all that it imports; the model comes first.
pub fn read_all(
    root: Outline,
    files: &dyn Files,
    most: usize,
    places: &mut Places,
    mistakes: &mut Vec<Diagnostic>,
) -> Vec<Read> {
    let mut reader = Importer {
        files,
        left: most,
        all: vec![Read { file: None, outline: root, imports: vec![] }],
        places,
        mistakes,
    };
    reader.imports_of(0, &mut vec![(0, Span::default())]);
    reader.all
}

struct Importer<'a> {
    files: &'a dyn Files,
    /// how many tokens may still be read
    left: usize,
    all: Vec<Read>,
    places: &'a mut Places,
    mistakes: &'a mut Vec<Diagnostic>,
}

impl Importer<'_> {
    /// Reads what a file imports. `open` are the files on the way to it, each with the import that led there.
    fn imports_of(&mut self, importing: usize, open: &mut Vec<(usize, Span)>) {
        for import in self.all[importing].outline.imports.clone() {
            let read = self.files.read(self.all[importing].file.as_ref(), &import.path);
            let file = match read {
                Ok(file) => file,
                Err(why) => {
                    let message = format!("`{}` {why}", import.path);
                    let help = "the path is relative to the file that imports it";
                    self.mistakes.push(Diagnostic::new(codes::IMPORT, import.span, message).help(help));
                    continue;
                }
            };
            let known =
                self.all.iter().position(|read| read.file.as_ref().is_some_and(|read| read.key == file.key));
            if let Some(known) = known {
                match open.iter().position(|(open, _)| *open == known) {
                    Some(from) => self.cycle(&import.path, import.span, &open[from + 1..]),
                    None => self.all[importing].imports.push(known),
                }
                continue;
            }
            if self.all.len() > MOST_FILES {
                let message = format!("a mechanism imports at most {MOST_FILES} files");
                self.mistakes.push(Diagnostic::new(codes::REPETITION, import.span, message));
                return;
            }
            let outline = self.outline(&file, import.span).unwrap_or_default();
            let index = self.all.len();
            self.all.push(Read { file: Some(file), outline, imports: vec![] });
            self.all[importing].imports.push(index);
            open.push((index, import.span));
            self.imports_of(index, open);
            open.pop();
        }
    }

    fn cycle(&mut self, path: &str, span: Span, between: &[(usize, Span)]) {
        let message = format!("`{path}` imports itself");
        let mut error = Diagnostic::new(codes::IMPORT_CYCLE, span, message);
        for (_, import) in between.iter().take(5) {
            error = error.related(*import, "through this import");
        }
        self.mistakes.push(error.help("move the parts that both files use to a third one"));
    }

    /// The outline of an imported file.
    fn outline(&mut self, file: &Imported, import: Span) -> Option<Outline> {
        let index = self.all.len() as u32;
        let mut tokens = lexer::tokens(&file.text, self.left);
        if tokens.len() > self.left {
            let message = "the mechanism and what it imports are too large together";
            self.mistakes.push(Diagnostic::new(codes::TOO_LARGE, import, message));
            return None;
        }
        self.left -= tokens.len();
        place(&mut tokens, index, self.places);
        if let Some(head) = is_mechanism(&tokens) {
            let message = "this file is a mechanism, and cannot be imported";
            let error = Diagnostic::new(codes::IMPORT, head, message);
            let help = "an imported file holds parts: move them to a file of their own";
            self.mistakes.push(error.related(import, "it is imported here").help(help));
            return None;
        }
        if let Some(error) = unbalanced(&tokens) {
            self.mistakes.push(error);
            return None;
        }
        Some(reader::read(&tokens, false, self.mistakes))
    }
}

/// Gives the tokens of a file places of this list.
pub fn place(tokens: &mut [Token], file: u32, places: &mut Places) {
    for token in tokens {
        token.span = places.add(Place { file, span: token.span, site: None });
    }
}

/// Where the head of a mechanism, or a section, stands outside of parts.
pub fn is_mechanism(tokens: &[Token]) -> Option<Span> {
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate() {
        let opens = tokens.get(i + 1).is_some_and(|next| next.kind == syntax::token::TokenKind::Open('{'));
        match token.kind {
            syntax::token::TokenKind::Open(_) => depth += 1,
            syntax::token::TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ if depth > 0 => {}
            _ if token.is_word("mechanism") => return Some(token.span),
            syntax::token::TokenKind::Name if opens && Section::of_word(&token.text).is_some() => {
                return Some(token.span);
            }
            _ => {}
        }
    }
    None
}

/// What is wrong with the brackets of a text.
pub fn unbalanced(tokens: &[Token]) -> Option<Diagnostic> {
    let (_, mistakes) = syntax::parse(tokens);
    mistakes.into_iter().find(|mistake| mistake.code == codes::UNBALANCED)
}
