//! Sections and entries as lines.

use super::entries::{Entry, behind, entries};
use super::items::{Item, Kind};
use super::line::{joined, lines};
use super::{INDENT, WIDTH};
use crate::syntax::token::TokenKind;
use crate::syntax::tree::Section;

/// The text of a model.
pub fn model(items: &[Item<'_>]) -> String {
    let mut text = Text::default();
    text.statements(items, 0);
    text.finish()
}

/// Words that begin a statement whose braces hold statements.
const BLOCKS: [&str; 2] = ["part", "for"];

/// Whether the word at the beginning of a statement makes it one that holds statements in its braces.
fn is_block(items: &[Item<'_>]) -> bool {
    let [word, name, ..] = items else { return false };
    word.is(TokenKind::Name) && name.is(TokenKind::Name) && BLOCKS.contains(&word.text)
}

#[derive(Default)]
struct Text {
    lines: Vec<String>,
}

/// A declaration as columns: its name, its unit, what follows.
struct Columns {
    name: String,
    unit: String,
    value: String,
}

impl Text {
    fn push(&mut self, indent: usize, line: &str) {
        let line = line.trim_end();
        self.lines.push(if line.is_empty() {
            String::new()
        } else {
            format!("{}{line}", " ".repeat(indent))
        });
    }

    fn blank(&mut self) {
        if self.lines.last().is_some_and(|line| !line.is_empty()) {
            self.lines.push(String::new());
        }
    }

    fn finish(mut self) -> String {
        while self.lines.last().is_some_and(String::is_empty) {
            self.lines.pop();
        }
        let mut text = self.lines.join("\n");
        if !text.is_empty() {
            text.push('\n');
        }
        text
    }

    /// A comment on lines of its own. Lines within a comment between `/*` and `*/` stay where they are.
    fn remark(&mut self, item: &Item<'_>, indent: usize) {
        for (i, line) in item.text.lines().enumerate() {
            self.push(if i == 0 { indent } else { 0 }, line);
        }
    }

    /// Adds comments to the last line.
    fn behind(&mut self, remarks: &[&Item<'_>]) {
        for remark in remarks {
            let mut parts = remark.text.lines();
            if let (Some(line), Some(first)) = (self.lines.last_mut(), parts.next()) {
                line.push(' ');
                line.push_str(first.trim_end());
            }
            for part in parts {
                self.push(0, part);
            }
        }
    }

    /// Statements and sections, with the comments between them.
    fn statements(&mut self, items: &[Item<'_>], indent: usize) {
        let mut at = 0;
        while at < items.len() {
            if items[at].breaks > 1 && at > 0 {
                self.blank();
            }
            at += if items[at].is_remark() {
                self.remark(&items[at], indent);
                1
            } else {
                self.statement(&items[at..], indent)
            };
        }
    }

    /// `mechanism Name;`, a section, a part or a use, with what follows on its line. The value is the number of
    /// items.
    fn statement(&mut self, items: &[Item<'_>], indent: usize) -> usize {
        let (mut depth, mut end) = (0_usize, items.len());
        let block = is_block(items);
        for (i, item) in items.iter().enumerate() {
            // the brackets of arguments end nothing
            let closes = item.is(TokenKind::Close('}'));
            match item.kind {
                Kind::Token(TokenKind::Open(_)) => depth += 1,
                Kind::Token(TokenKind::Close(_)) => depth = depth.saturating_sub(1),
                Kind::Token(TokenKind::Sign(';')) if depth == 0 => {}
                _ => continue,
            }
            if depth == 0 && (closes || item.is(TokenKind::Sign(';'))) {
                end = i + 1;
                break;
            }
        }
        let statement = &items[..end];
        let section = statement.first().and_then(|word| Section::of_word(word.text));
        match block {
            true => self.block(statement, indent),
            false => self.body(statement, indent, section.is_some_and(declares)),
        }
        let remarks: Vec<&Item<'_>> = items[end..].iter().take_while(|item| behind(item)).collect();
        self.behind(&remarks);
        end + remarks.len()
    }

    /// A statement whose braces hold statements.
    fn block(&mut self, items: &[Item<'_>], indent: usize) {
        let open = items.iter().position(|item| item.is(TokenKind::Open('{')));
        let Some(open) = open.filter(|_| items.last().is_some_and(|last| last.is(TokenKind::Close('}'))))
        else {
            return self.wrapped(items, indent);
        };
        let (head, inner) = (&items[..=open], &items[open + 1..items.len() - 1]);
        match head.iter().any(Item::is_remark) {
            true => self.as_written(head, indent),
            false => self.wrapped(head, indent),
        }
        self.statements(inner, indent + INDENT);
        self.push(indent, "}");
    }

    /// Tokens that may hold braces: in one line if they were written so and fit, else each entry of the
    /// braces on its own.
    fn body(&mut self, items: &[Item<'_>], indent: usize, aligned: bool) {
        let open = items.iter().position(|item| item.is(TokenKind::Open('{')));
        let remarks = items.iter().any(Item::is_remark);
        let Some(open) = open else {
            return if remarks { self.as_written(items, indent) } else { self.wrapped(items, indent) };
        };
        let close = items.iter().rposition(|item| item.is(TokenKind::Close('}'))).unwrap_or(items.len() - 1);
        if partner(items, open) != Some(close) {
            return self.as_written(items, indent);
        }
        let inner = &items[open + 1..close];
        let one_line = inner.first().is_none_or(|first| first.breaks == 0) && !remarks;
        let line = if remarks { String::new() } else { joined(items) };
        if one_line && (inner.is_empty() || indent + line.chars().count() <= WIDTH) {
            return self.push(indent, &line);
        }
        let (head, tail) = (&items[..open], &items[close..]);
        if head.iter().chain(tail).any(Item::is_remark) {
            return self.as_written(items, indent);
        }
        self.push(indent, &format!("{} {{", joined(head)));
        self.list(&entries(inner), indent + INDENT, aligned);
        self.push(indent, &joined(tail));
    }

    /// Entries on lines of their own.
    fn list(&mut self, entries: &[Entry<'_, '_>], indent: usize, aligned: bool) {
        let columns: Vec<Option<Columns>> =
            entries.iter().map(|entry| if aligned { columns(entry.items, indent) } else { None }).collect();
        let mut at = 0;
        while at < entries.len() {
            // a group: declarations on adjacent lines
            let joins =
                |i: &usize| columns[*i].is_some() && entries[*i].before.is_empty() && !entries[*i].apart();
            let more = (at + 1..entries.len()).take_while(joins).count();
            let end = if columns[at].is_some() { at + 1 + more } else { at + 1 };
            let group = &columns[at..end];
            let widest = |of: fn(&Columns) -> &String| {
                group.iter().flatten().map(|columns| of(columns).chars().count()).max().unwrap_or(0)
            };
            let (name, unit) = (widest(|columns| &columns.name), widest(|columns| &columns.unit));
            for (entry, columns) in entries[at..end].iter().zip(group) {
                if entry.apart() && at > 0 {
                    self.blank();
                }
                self.before(&entry.before, entry.items.first(), indent);
                match columns {
                    Some(columns) => self.push(indent, &columns.padded(name, unit)),
                    None if entry.items.is_empty() => {}
                    None => self.body(entry.items, indent, false),
                }
                self.behind(&entry.behind);
                at += 1;
            }
        }
    }

    /// Documentation and comments before an entry, each on its line, with the empty lines between them.
    fn before(&mut self, remarks: &[&Item<'_>], entry: Option<&Item<'_>>, indent: usize) {
        for (i, remark) in remarks.iter().enumerate() {
            if i > 0 && remark.breaks > 1 {
                self.blank();
            }
            self.remark(remark, indent);
        }
        if !remarks.is_empty() && entry.is_some_and(|item| item.breaks > 1) {
            self.blank();
        }
    }

    /// Tokens on as few lines as hold them.
    fn wrapped(&mut self, items: &[Item<'_>], indent: usize) {
        for (i, line) in lines(items, indent, indent + INDENT, WIDTH).iter().enumerate() {
            self.push(if i == 0 { indent } else { indent + INDENT }, line);
        }
    }

    /// Tokens with comments between them: lines are broken where the author broke them.
    fn as_written(&mut self, items: &[Item<'_>], indent: usize) {
        let mut start = 0;
        let mut fresh = true;
        for i in 0..items.len() {
            let ends = i + 1 == items.len() || items[i + 1].breaks > 0 || items[i + 1].is_remark();
            let column = if start == 0 && fresh { indent } else { indent + INDENT };
            if items[i].is_remark() {
                let apart = items[i].breaks > 0 || i == 0;
                if apart {
                    self.remark(&items[i], column)
                } else {
                    self.behind(&[&items[i]])
                }
                start = i + 1;
            } else if ends {
                let mut line = joined(&items[start..=i]);
                // `1.` at the end of a line would be one number
                if let [.., number, point] = &items[start..=i]
                    && number.is(TokenKind::Number)
                    && point.is(TokenKind::Sign('.'))
                {
                    line.insert(line.len() - 1, ' ');
                }
                // what follows a comment on its line stays there
                let follows = start > 0 && items[start].breaks == 0 && !items[start - 1].ends_line();
                match self.lines.last_mut().filter(|_| follows) {
                    Some(last) => {
                        last.push(' ');
                        last.push_str(&line);
                    }
                    None => self.push(column, &line),
                }
                start = i + 1;
            } else {
                continue;
            }
            fresh = false;
        }
    }
}

/// Where the brace is closed that is opened here.
fn partner(items: &[Item<'_>], open: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for (i, item) in items.iter().enumerate().skip(open) {
        match item.kind {
            Kind::Token(TokenKind::Open('{')) => depth += 1,
            Kind::Token(TokenKind::Close('}')) => {
                depth -= 1;
                if depth == 0 {
                    return Some(i);
                }
            }
            _ => {}
        }
    }
    None
}

/// Whether a section declares quantities: names with units and values.
fn declares(section: Section) -> bool {
    use Section::*;
    matches!(section, Parameters | Inputs | Coordinates | Speeds | Dependent)
}

/// The columns of a declaration that fits on a line and holds no comment.
fn columns(items: &[Item<'_>], indent: usize) -> Option<Columns> {
    let braces = |item: &Item<'_>| item.is(TokenKind::Open('{'));
    if items.is_empty() || items.iter().any(|item| item.is_remark() || braces(item)) {
        return None;
    }
    let colon = items.iter().position(|item| item.is(TokenKind::Sign(':')))?;
    let equals = items.iter().position(|item| item.is(TokenKind::Sign('='))).unwrap_or(items.len());
    // without a value the separator belongs to the unit
    let columns = Columns {
        name: joined(&items[..=colon]),
        unit: joined(items.get(colon + 1..equals)?),
        value: joined(&items[equals..]),
    };
    let length = columns.padded(0, 0).chars().count();
    (indent + length <= WIDTH).then_some(columns)
}

impl Columns {
    fn padded(&self, name: usize, unit: usize) -> String {
        let Columns { name: own, unit: of, value } = self;
        if value.is_empty() { format!("{own:name$} {of}") } else { format!("{own:name$} {of:unit$} {value}") }
    }
}
