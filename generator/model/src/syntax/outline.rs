//! Parses the outline of a model: documentation, name, sections and their order.

use super::parser::{Docs, Lost, Parser};
use super::token::TokenKind;
use super::tree::Section;
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::{suggest, vocabulary};

impl Parser<'_> {
    /// The whole model.
    pub(super) fn model(&mut self) {
        let mut docs = Docs::default();
        while let Some(token) = self.peek() {
            match token.kind {
                TokenKind::InnerDoc => docs.line(&token.text),
                TokenKind::OuterDoc => {
                    let error = Diagnostic::new(
                        codes::STRAY_DOCS,
                        token.span,
                        "`///` does not document the mechanism",
                    )
                    .help("the documentation of the mechanism begins with `//!`");
                    self.report(error);
                }
                _ => break,
            }
            self.at += 1;
        }
        self.tree.docs = docs.0;
        let before = self.diagnostics.len();
        if self.header().is_err() {
            while self.peek().is_some_and(|t| !t.is_sign(';') && Section::of_word(&t.text).is_none()) {
                self.at += 1;
            }
            self.take_sign(';');
        }
        let anything = |token: &&super::token::Token| {
            token.kind == TokenKind::Name && Section::of_word(&token.text).is_some()
        };
        if self.tree.name.is_none() && !self.tokens.iter().any(anything) {
            // it is no model at all, and of its words nothing more is to be said
            let words = [codes::BAD_TOKEN, codes::BAD_NUMBER];
            let mut said = self.diagnostics.split_off(before);
            said.truncate(1);
            // all of it may stand in a comment that is not closed
            if self.diagnostics.iter().any(|d| d.code == codes::UNBALANCED) {
                said.clear();
            }
            if !said.is_empty() {
                self.diagnostics.retain(|d| !words.contains(&d.code));
            }
            self.diagnostics.extend(said);
            return;
        }
        while self.peek().is_some() {
            if self.another_mechanism() {
                break;
            }
            self.section();
        }
        self.order();
    }

    /// `mechanism Name;`
    fn header(&mut self) -> Result<(), Lost> {
        if !self.is_word("mechanism") {
            let message = format!("a model begins with `mechanism Name;`, found {}", self.found());
            let quoted =
                self.peek().is_some_and(|token| matches!(token.text.as_str(), "hodograph" | "mechanism"));
            let help = match self.peek().map(|token| token.kind) {
                Some(TokenKind::Sign('<')) => "is it a URDF? `hodograph import` makes a model of it",
                _ if quoted => "a model file holds what stands between the braces of `mechanism! { .. }`",
                _ => "write `mechanism Name;` before the first section",
            };
            self.report(Diagnostic::new(codes::EXPECTED, self.here(), message).help(help));
            // `hodograph::mechanism! {`
            let ahead = self.tokens.iter().skip(self.at).take(8);
            let brace = ahead
                .take_while(|token| !token.is_sign(';'))
                .position(|token| token.kind == TokenKind::Open('{'));
            let Some(brace) = brace.filter(|_| quoted) else { return Err(Lost) };
            self.at += brace;
            self.unwrap_braces();
            while self
                .peek()
                .is_some_and(|token| matches!(token.kind, TokenKind::InnerDoc | TokenKind::OuterDoc))
            {
                self.at += 1;
            }
            if !self.is_word("mechanism") {
                return Err(Lost);
            }
        }
        self.at += 1;
        self.tree.name = Some(self.name("the name of the mechanism")?);
        if self.is_open('{') {
            let error = Diagnostic::new(codes::EXPECTED, self.here(), "expected `;`, found `{`")
                .help("write `mechanism Name;`: the sections follow it, without braces around them");
            self.report(error);
            self.unwrap_braces();
            return Ok(());
        }
        let ended = self.semicolon();
        if ended.is_err() {
            self.advise("a name is one word of letters, digits and `_`".to_owned());
        }
        ended
    }

    /// Reads on as if the braces that begin here were not there.
    fn unwrap_braces(&mut self) {
        let (open, around) = (self.at, self.nesting());
        let after = self.nesting[open + 1..].iter().position(|nesting| *nesting <= around);
        if let Some(close) = after.map(|n| open + 1 + n) {
            self.nesting[open + 1..close].iter_mut().for_each(|nesting| *nesting -= 1);
            self.tokens.remove(close);
            self.nesting.remove(close);
        }
        self.tokens.remove(open);
        self.nesting.remove(open);
    }

    /// Whether a second mechanism begins here, perhaps after its documentation. It is said once, and all of
    /// it is left alone.
    fn another_mechanism(&mut self) -> bool {
        let docs = |kind| matches!(kind, TokenKind::InnerDoc | TokenKind::OuterDoc);
        let ahead = self.tokens[self.at..].iter().take_while(|token| docs(token.kind)).count();
        let Some(word) = self.peek_at(ahead).filter(|token| token.is_word("mechanism")) else { return false };
        let named = self.peek_at(ahead + 1).filter(|token| token.kind == TokenKind::Name);
        let Some(first) = self.tree.name.clone() else {
            // the name of this one comes late, which was said at the beginning
            self.at += ahead + 1;
            self.tree.name = self.take_name();
            self.take_sign(';');
            return self.peek().is_none();
        };
        let span = named.map_or(word.span, |name| word.span.to(name.span));
        let error = Diagnostic::new(codes::SECOND_MECHANISM, span, "a second mechanism begins here")
            .related(first.span, format!("the first, `{}`, is here", first.text))
            .help("give each mechanism a file or a `mechanism!` of its own; nothing was read from here on");
        self.report(error);
        true
    }

    fn section(&mut self) {
        let docs = self.docs();
        let Some(token) = self.peek() else { return };
        if token.kind == TokenKind::InnerDoc {
            let error =
                Diagnostic::new(codes::STRAY_DOCS, token.span, "`//!` stands at the top of a model only")
                    .help("use `///` before what you document, or `//` for a plain comment");
            self.report(error);
            self.at += 1;
            return;
        }
        let section = Section::of_word(&token.text).filter(|_| token.kind == TokenKind::Name);
        let opens = self.peek_at(1).is_some_and(|next| next.kind == TokenKind::Open('{'));
        let Some(section) = section else {
            self.no_section(opens);
            return;
        };
        if !docs.is_empty() {
            let error =
                Diagnostic::new(codes::STRAY_DOCS, self.before(), "a section is not documented with `///`")
                    .help("use `//` for a plain comment");
            self.report(error);
        }
        self.at += 1;
        self.body(section, token.span);
    }

    /// What follows the word of a section.
    fn body(&mut self, section: Section, span: Span) {
        if let Some(&(_, first)) = self.tree.sections.iter().find(|(s, _)| *s == section) {
            let message = format!("the section `{}` appears twice", section.word());
            let error = Diagnostic::new(codes::SECTION_TWICE, span, message)
                .related(first, "first here")
                .help("put all entries into one section");
            self.report(error);
        }
        self.tree.sections.push((section, span));
        // `parameters: {` and `parameters = {`
        if (self.is_sign(':') || self.is_sign('='))
            && self.peek_at(1).is_some_and(|next| next.kind == TokenKind::Open('{'))
        {
            let _ = self.expected(&format!("`{{` after `{}`", section.word()));
            self.at += 1;
        }
        if self.open('{', &format!(" after `{}`", section.word())).is_err() {
            return;
        }
        self.entries(section);
        // the closing brace; what is before it has been read or passed over
        self.at += 1;
    }

    fn no_section(&mut self, opens: bool) {
        let Some(token) = self.peek() else { return };
        let (span, kind) = (token.span, token.kind);
        if kind == TokenKind::Name {
            let words = Section::ALL.map(Section::word);
            let error = Diagnostic::new(
                codes::SECTION_UNKNOWN,
                span,
                format!("there is no section `{}`", token.text),
            );
            let near =
                vocabulary::section(&token.text).or_else(|| suggest::nearest(&token.text, words.into_iter()));
            let error = match near {
                Some(word) => error.did_you_mean(word),
                None => error.help(format!("the sections are {}", words.join(", "))),
            };
            self.report(error);
            // read on as if it had been written right
            if let Some(section) = near.and_then(Section::of_word).filter(|_| opens) {
                let said = self.diagnostics.len();
                self.at += 1;
                self.body(section, span);
                // what does not read like that section is another
                if self.diagnostics.len() > said {
                    self.diagnostics.truncate(said);
                    self.tree.incomplete = true;
                }
                return;
            }
        } else {
            self.expected("a section such as `parameters { .. }`");
        }
        self.tree.incomplete = true;
        self.at += usize::from(!matches!(kind, TokenKind::Open(_)));
        // pass over to behind the next braces, or to the next section
        if opens || matches!(kind, TokenKind::Open(_)) {
            self.skip_group();
            // the entries belong to what could not be read
            if matches!(kind, TokenKind::Open('(' | '[')) && self.is_open('{') {
                self.skip_group();
            }
            return;
        }
        while let Some(token) = self.peek() {
            let opens = self.peek_at(1).is_some_and(|next| next.kind == TokenKind::Open('{'));
            if token.kind == TokenKind::Name && opens && Section::of_word(&token.text).is_some() {
                return;
            }
            if matches!(token.kind, TokenKind::Open(_)) {
                self.skip_group();
                return;
            }
            self.at += 1;
        }
    }

    /// Sections stand in one order. However many do not, that is one mistake: the fewest that must move are
    /// pointed out.
    fn order(&mut self) {
        let mut first: Vec<(Section, Span)> = Vec::new();
        for &(section, span) in &self.tree.sections {
            if first.iter().all(|(other, _)| *other != section) {
                first.push((section, span));
            }
        }
        let stays = longest_rise(&first);
        let moves: Vec<(Section, Span)> =
            (0..first.len()).filter(|i| !stays.contains(i)).map(|i| first[i]).collect();
        let Some(&(section, span)) = moves.first() else { return };
        let mut right: Vec<Section> = first.iter().map(|(section, _)| *section).collect();
        right.sort();
        let place = right.iter().position(|other| *other == section).unwrap_or(0);
        // its neighbours among those that stay
        let stay = |other: &&Section| stays.iter().any(|i| first[*i].0 == **other);
        let (before, after) = (right[..place].iter().rev().find(stay), right[place + 1..].iter().find(stay));
        let at = |other: &Section| first.iter().find(|(s, _)| s == other).map(|(_, span)| *span);
        let mut error = Diagnostic::new(
            codes::SECTION_ORDER,
            span,
            format!("the section `{}` is out of order", section.word()),
        );
        error = match (after, before) {
            (Some(after), _) if at(after).is_some_and(|place| place < span) => error
                .label(format!("this belongs before `{}`", after.word()))
                .related(at(after).unwrap_or(span), format!("`{}` is here", after.word())),
            (_, Some(before)) => error
                .label(format!("this belongs after `{}`", before.word()))
                .related(at(before).unwrap_or(span), format!("`{}` is here", before.word())),
            _ => error,
        };
        for (other, place) in &moves[1..] {
            error = error.related(*place, format!("`{}` is out of order too", other.word()));
        }
        let right: Vec<&str> = right.iter().map(|section| section.word()).collect();
        self.report(error.help(format!("the right order is {}", right.join(", "))));
    }
}

/// The indices of a longest rising sequence of sections.
fn longest_rise(sections: &[(Section, Span)]) -> Vec<usize> {
    let mut best: Vec<Vec<usize>> = Vec::new();
    for (i, (section, _)) in sections.iter().enumerate() {
        let before = (0..i).filter(|j| sections[*j].0 < *section).max_by_key(|j| (best[*j].len(), i - j));
        let mut rise = before.map_or(Vec::new(), |j| best[j].clone());
        rise.push(i);
        best.push(rise);
    }
    best.into_iter().rev().max_by_key(Vec::len).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sections_that_vocabulary_advises_exist() {
        for word in
            ["constants", "forces", "body", "holonomic", "impacts", "variables", "controls", "equations"]
        {
            assert!(vocabulary::section(word).and_then(Section::of_word).is_some(), "{word}");
        }
    }
}
