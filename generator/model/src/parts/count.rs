//! Whole numbers that are known when a model is read: counts, indices and the ends of ranges.

use super::text::shown;
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::suggest;
use crate::syntax::MAX_DEPTH;
use crate::syntax::token::{Token, TokenKind};

/// Counts and indices by name; the last of a name counts.
pub type Numbers = Vec<(String, i64)>;

/// What a name stands for.
pub fn number(numbers: &Numbers, name: &str) -> Option<i64> {
    numbers.iter().rev().find(|(known, _)| known == name).map(|(_, value)| *value)
}

/// The value of an expression of whole numbers.
///
/// # Errors
///
/// It is no such expression, or too large.
pub fn evaluate(tokens: &[Token], numbers: &Numbers, at: Span) -> Result<i64, Box<Diagnostic>> {
    let mut reader = Reader { tokens, at: 0, depth: 0, numbers, place: at };
    let value = reader.sum()?;
    match reader.peek() {
        None => Ok(value),
        Some(token) => Err(reader.wrong(token.span, &format!("{} cannot stand here", token.describe()))),
    }
}

struct Reader<'a> {
    tokens: &'a [Token],
    at: usize,
    depth: usize,
    numbers: &'a Numbers,
    place: Span,
}

impl Reader<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    fn take(&mut self, sign: char) -> bool {
        let there = self.peek().is_some_and(|token| token.is_sign(sign));
        self.at += usize::from(there);
        there
    }

    fn whole(&self) -> Span {
        match (self.tokens.first(), self.tokens.last()) {
            (Some(first), Some(last)) => first.span.to(last.span),
            _ => self.place,
        }
    }

    fn wrong(&self, span: Span, message: &str) -> Box<Diagnostic> {
        let help = "counts and indices are made of whole numbers, counts, `+`, `-`, `*`, `/` and brackets";
        Box::new(Diagnostic::new(codes::COUNT, span, message).help(help))
    }

    fn bounded(&self, value: Option<i64>) -> Result<i64, Box<Diagnostic>> {
        let fits = value.filter(|value| value.unsigned_abs() < 1 << 53);
        fits.ok_or_else(|| self.wrong(self.whole(), &format!("`{}` is too large", shown(self.tokens))))
    }

    fn sum(&mut self) -> Result<i64, Box<Diagnostic>> {
        let mut sum = self.product()?;
        loop {
            if self.take('+') {
                let next = self.product()?;
                sum = self.bounded(sum.checked_add(next))?;
            } else if self.take('-') {
                let next = self.product()?;
                sum = self.bounded(sum.checked_sub(next))?;
            } else {
                return Ok(sum);
            }
        }
    }

    fn product(&mut self) -> Result<i64, Box<Diagnostic>> {
        let mut product = self.factor()?;
        loop {
            if self.take('*') {
                let next = self.factor()?;
                product = self.bounded(product.checked_mul(next))?;
            } else if self.take('/') {
                let next = self.factor()?;
                let whole = product.checked_rem(next) == Some(0);
                product = match product.checked_div(next).filter(|_| whole) {
                    Some(quotient) => quotient,
                    None => {
                        let message = format!("{product}/{next} is no whole number");
                        return Err(self.wrong(self.whole(), &message));
                    }
                };
            } else {
                return Ok(product);
            }
        }
    }

    fn factor(&mut self) -> Result<i64, Box<Diagnostic>> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.wrong(self.whole(), "brackets are nested too deeply"));
        }
        let value = self.operand();
        self.depth -= 1;
        value
    }

    fn operand(&mut self) -> Result<i64, Box<Diagnostic>> {
        if self.take('-') {
            return self.factor().map(|value| -value);
        }
        if self.take('+') {
            return self.factor();
        }
        let Some(token) = self.peek().cloned() else {
            return Err(self.wrong(self.whole(), "a whole number is missing here"));
        };
        self.at += 1;
        match token.kind {
            TokenKind::Number => match token.text.parse::<i64>() {
                Ok(value) => self.bounded(Some(value)),
                Err(_) => Err(self.wrong(token.span, &format!("`{}` is no whole number", token.text))),
            },
            TokenKind::Name => number(self.numbers, &token.text).ok_or_else(|| {
                let message = format!("`{}` is no count", token.text);
                let near = suggest::nearest(&token.text, self.numbers.iter().map(|(name, _)| name.as_str()));
                let error = *self.wrong(token.span, &message);
                Box::new(match near {
                    Some(near) => error.did_you_mean(near),
                    None => error.help(
                        "a count is stated before the sections, `count n = 5;`, is the index of a `for`, or is \
                         given to a part whose argument is `n: count`",
                    ),
                })
            }),
            TokenKind::Open('(') => {
                let value = self.sum()?;
                match self.peek().map(|token| token.kind) {
                    Some(TokenKind::Close(')')) => {
                        self.at += 1;
                        Ok(value)
                    }
                    _ => Err(self.wrong(self.whole(), "`)` is missing here")),
                }
            }
            _ => Err(self.wrong(token.span, &format!("{} is no whole number", token.describe()))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::lexer;

    fn value(text: &str) -> Result<i64, String> {
        let numbers = vec![("n".to_owned(), 7), ("i".to_owned(), 1), ("i".to_owned(), 2)];
        let found = evaluate(&lexer::tokens(text, 1000), &numbers, Span::default());
        found.map_err(|error| error.message)
    }

    #[test]
    fn whole_numbers_are_evaluated() {
        for (text, expected) in
            [("3", 3), ("n-i", 5), ("-(n + 1)*2/4", -4), ("2*(i - -1)", 6), ("10 - 3 - 2", 5)]
        {
            assert_eq!(value(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_whole_number_is_refused() {
        for text in
            ["", "n/2", "1/0", "0.5", "m", "n n", "(n", "9007199254740993", "n*9007199254740990", "sin(n)"]
        {
            assert!(value(text).is_err(), "{text}");
        }
        let deep = "(".repeat(10_000) + "1";
        assert!(value(&deep).is_err() && value(&"-".repeat(100_000)).is_err());
    }
}
