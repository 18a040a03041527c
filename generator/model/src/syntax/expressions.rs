//! Parses expressions.

use super::parser::{Lost, MAX_DEPTH, Parser};
use super::token::TokenKind;
use super::tree::{Expr, ExprKind, Name};
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;

impl Parser<'_> {
    /// A sum.
    pub(super) fn expression(&mut self) -> Result<Expr, Lost> {
        self.depth += 1;
        let result = if self.depth > MAX_DEPTH { Err(self.too_deep()) } else { self.sum() };
        self.depth -= 1;
        result
    }

    fn too_deep(&mut self) -> Lost {
        let message = format!("expressions may be nested at most {MAX_DEPTH} deep");
        let error = Diagnostic::new(codes::TOO_DEEP, self.here(), message)
            .help("name parts of the expression under `definitions`");
        self.report(error);
        Lost
    }

    fn sum(&mut self) -> Result<Expr, Lost> {
        let first = self.product()?;
        if !self.is_sign('+') && !self.is_sign('-') {
            return Ok(first);
        }
        let mut span = first.span;
        let mut terms = vec![(false, first)];
        loop {
            let negative = self.is_sign('-');
            if !negative && !self.is_sign('+') {
                return Ok(Expr { kind: ExprKind::Sum(terms), span });
            }
            self.at += 1;
            let term = self.product()?;
            span = span.to(term.span);
            terms.push((negative, term));
        }
    }

    fn product(&mut self) -> Result<Expr, Lost> {
        let first = self.signed()?;
        if !self.is_sign('*') && !self.is_sign('/') {
            return Ok(first);
        }
        let mut span = first.span;
        let mut factors = vec![(false, first)];
        loop {
            let divides = self.is_sign('/');
            if !divides && !self.is_sign('*') {
                return Ok(Expr { kind: ExprKind::Product(factors), span });
            }
            self.at += 1;
            let power = !divides && self.is_sign('*');
            if power {
                let error = Diagnostic::new(
                    codes::BAD_EXPRESSION,
                    self.before().to(self.here()),
                    "`**` is not an operator",
                )
                .help("write `^` for a power");
                self.report(error);
                self.at += 1;
            }
            let mut factor = self.signed()?;
            span = span.to(factor.span);
            if power {
                factor.kind = ExprKind::Error;
            }
            factors.push((divides, factor));
        }
    }

    /// `-a^b` is `-(a^b)`.
    fn signed(&mut self) -> Result<Expr, Lost> {
        let start = self.here();
        if self.take_sign('-') {
            let inner = self.deeper(Self::signed)?;
            let span = start.to(inner.span);
            return Ok(Expr { kind: ExprKind::Neg(Box::new(inner)), span });
        }
        if self.take_sign('+') {
            return self.deeper(Self::signed);
        }
        self.power()
    }

    fn deeper(&mut self, read: fn(&mut Self) -> Result<Expr, Lost>) -> Result<Expr, Lost> {
        self.depth += 1;
        let result = if self.depth > MAX_DEPTH { Err(self.too_deep()) } else { read(self) };
        self.depth -= 1;
        result
    }

    fn power(&mut self) -> Result<Expr, Lost> {
        let base = self.postfix()?;
        if !self.take_sign('^') {
            return Ok(base);
        }
        // to the right: a^b^c is a^(b^c); the exponent may carry a sign
        let exponent = self.deeper(Self::signed)?;
        let span = base.span.to(exponent.span);
        Ok(Expr { kind: ExprKind::Power(Box::new(base), Box::new(exponent)), span })
    }

    fn postfix(&mut self) -> Result<Expr, Lost> {
        let mut base = self.primary()?;
        while self.is_sign('\'') {
            let _ = self.expected("an operator or the end of the expression");
            self.at += 1;
            base.kind = ExprKind::Error;
        }
        let mut length = 0;
        while self.take_sign('.') {
            length += 1;
            if length > MAX_DEPTH {
                return Err(self.too_deep());
            }
            let member = self.name("the name of an axis or of an operation after `.`")?;
            let base_span = base.span;
            base = if self.is_open('(') {
                let arguments = self.arguments()?;
                let span = base_span.to(self.before());
                Expr { kind: ExprKind::Method(Box::new(base), member, arguments), span }
            } else {
                let span = base_span.to(member.span);
                Expr { kind: ExprKind::Field(Box::new(base), member), span }
            };
        }
        Ok(base)
    }

    fn primary(&mut self) -> Result<Expr, Lost> {
        let Some(token) = self.peek() else { return Err(self.expected("an expression")) };
        let start = token.span;
        match token.kind {
            TokenKind::Number => {
                self.at += 1;
                Ok(Expr { kind: ExprKind::Number(token.text.clone()), span: start })
            }
            TokenKind::Bad(_) => {
                // a message says so already
                self.at += 1;
                Ok(Expr { kind: ExprKind::Error, span: start })
            }
            TokenKind::Open('(') => {
                self.at += 1;
                let mut inner = self.expression()?;
                self.close_expression()?;
                inner.span = start.to(self.before());
                Ok(inner)
            }
            TokenKind::Open('[') => {
                self.at += 1;
                let items = self.items()?;
                Ok(Expr { kind: ExprKind::List(items), span: start.to(self.before()) })
            }
            TokenKind::Name => {
                self.at += 1;
                let name = Name { text: token.text.clone(), span: start };
                if !self.is_open('(') {
                    return Ok(Expr { kind: ExprKind::Name(name.text), span: start });
                }
                let mut arguments = self.arguments()?;
                let span = start.to(self.before());
                if name.text == "d" && arguments.len() == 1 {
                    let inner = arguments.remove(0);
                    return self.rate(inner, span);
                }
                Ok(Expr { kind: ExprKind::Call(name, arguments), span })
            }
            _ => Err(self.expected("an expression")),
        }
    }

    /// What follows `d(E)`: `/dt`.
    fn rate(&mut self, inner: Expr, span: Span) -> Result<Expr, Lost> {
        let divides = self.is_sign('/') && self.peek_at(1).is_some_and(|token| token.is_word("dt"));
        if !divides {
            let error = Diagnostic::new(codes::BAD_EXPRESSION, span, "`d(..)` must be followed by `/dt`")
                .help("a time derivative is written `d(q1)/dt`");
            self.report(error);
            return Err(Lost);
        }
        self.at += 2;
        let span = span.to(self.before());
        if self.is_sign('^') {
            let error = Diagnostic::new(
                codes::BAD_EXPRESSION,
                self.here(),
                "is the power of `dt` or of the rate?",
            )
            .help("for the power of a rate write `(d(q1)/dt)^2`; there are no second derivatives in a model");
            self.report(error);
            return Err(Lost);
        }
        Ok(Expr { kind: ExprKind::Rate(Box::new(inner)), span })
    }

    /// A bracket that closes; what else could follow an operand is `expected`.
    fn close_operand(&mut self, expected: &str) -> Result<(), Lost> {
        let comma = self.is_sign(',');
        let closed = self.close(expected);
        if closed.is_err() && comma {
            self.advise("a vector of three components is `N.vec(a, b, c)`".to_owned());
        }
        if closed.is_err() && self.at_operand() {
            self.advise("a product is written `a*b`".to_owned());
        }
        closed
    }

    fn close_expression(&mut self) -> Result<(), Lost> {
        self.close_operand("an operator or the closing bracket")
    }

    fn arguments(&mut self) -> Result<Vec<Expr>, Lost> {
        self.open('(', "")?;
        self.items()
    }

    /// Expressions with commas between them, up to and with the closing bracket.
    fn items(&mut self) -> Result<Vec<Expr>, Lost> {
        let mut items = Vec::new();
        while !self.is_close() {
            items.push(self.expression()?);
            if !self.take_sign(',') {
                break;
            }
        }
        self.close_operand("`,`, an operator or the closing bracket")?;
        Ok(items)
    }
}
