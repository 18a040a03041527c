//! Writes equations as an HTML page with MathML, which browsers display without scripts and without a
//! network.
//!
//! An equation is a row of three columns, so that the equal signs of a section are aligned. The page is also
//! well-formed XML.

mod escape;
mod mathml;

use escape::plain;
use hodograph_model::page;
use mathml::{Writer, identifier, math};

use super::symbols::{Form, form, unit};
use super::{Document, Equation, Place, Rank, Section, Term, text};

const STYLE: &str = include_str!("page.css");

pub fn write(document: &Document) -> String {
    let title = plain(&document.title);
    let writer = Writer { symbols: &document.symbols };
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\"/>\n<title>{title}: equations</title>\n<style>\n{}{STYLE}</style>\n</head>\n<body>\n\
         <div class=\"page\">\n<header>\n<h1>{title}</h1>\n{}</header>\n{}<main>\n{}{}</main>\n</div>\n</body>\n</html>\n",
        page::STYLE,
        paragraphs(&document.docs),
        contents(document),
        names(document, &writer),
        sections(document, &writer),
    )
}

/// Text in which parts between backticks are marked as code.
fn prose(text: &str) -> String {
    let parts: Vec<String> = text.split('`').map(plain).collect();
    if parts.len().is_multiple_of(2) {
        return plain(text);
    }
    let marked = |(index, part): (usize, &String)| match index % 2 {
        1 => format!("<code>{part}</code>"),
        _ => part.clone(),
    };
    parts.iter().enumerate().map(marked).collect()
}

fn paragraphs(docs: &str) -> String {
    let paragraphs = docs.split("\n\n").map(str::trim).filter(|paragraph| !paragraph.is_empty());
    paragraphs.map(|paragraph| format!("<p>{}</p>\n", prose(paragraph))).collect()
}

/// Units in words; each word is marked separately.
fn units(text: &str) -> String {
    text.split(' ').map(unit).collect::<Vec<_>>().join(" ")
}

/// Groups of sections under one heading: the title of the only section, or the name of the contact, point or
/// frame.
fn groups(document: &Document) -> Vec<Vec<(usize, &Section)>> {
    let mut groups: Vec<Vec<(usize, &Section)>> = Vec::new();
    for (index, section) in document.sections.iter().enumerate() {
        match groups.last_mut() {
            Some(group) if !section.group.is_empty() && group[0].1.group == section.group => {
                group.push((index, section));
            }
            _ => groups.push(vec![(index, section)]),
        }
    }
    groups
}

fn contents(document: &Document) -> String {
    let mut out = "<nav aria-label=\"Contents\">\n<h2>Contents</h2>\n<ul>\n".to_owned();
    if !document.names.is_empty() {
        out += "<li><a href=\"#symbols\">Symbols</a></li>\n";
    }
    for group in groups(document) {
        let (first, section) = group[0];
        if section.group.is_empty() {
            out += &format!("<li><a href=\"#section-{first}\">{}</a></li>\n", plain(&section.title));
            continue;
        }
        out += &format!("<li><a href=\"#group-{first}\">{}</a>\n<ul>\n", plain(&section.group));
        for (index, section) in group {
            out += &format!("<li><a href=\"#section-{index}\">{}</a></li>\n", plain(&section.title));
        }
        out += "</ul></li>\n";
    }
    out + "</ul>\n</nav>\n"
}

fn names(document: &Document, writer: &Writer<'_>) -> String {
    if document.names.is_empty() {
        return String::new();
    }
    let mut out = "<section aria-labelledby=\"symbols\">\n<h2 id=\"symbols\">Symbols</h2>\n".to_owned();
    for (title, entries) in &document.names {
        out += &format!(
            "<h3>{title}</h3>\n<table class=\"names\">\n<thead><tr><th scope=\"col\">Symbol</th><th scope=\"col\">In the model</th><th \
             scope=\"col\">Value</th><th scope=\"col\">Unit</th><th scope=\"col\">Meaning</th></tr></thead>\n<tbody>\n"
        );
        for entry in entries {
            let unit = unit(&entry.unit);
            out += &format!(
                "<tr><td>{}</td><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                math(&writer.name(&entry.name)),
                plain(&entry.name),
                entry.value.map_or(String::new(), |value| digits(value, writer)),
                if unit.is_empty() { "1".to_owned() } else { plain(&unit) },
                prose(&entry.docs)
            );
        }
        out += "</tbody>\n</table>\n";
    }
    out + "</section>\n"
}

/// A value in a table. It is written as text, which browsers wrap at the edge of a column; they cut off a
/// formula that is too wide.
fn digits(value: f64, writer: &Writer<'_>) -> String {
    let text = |digits: &str| plain(&digits.replace('-', "\u{2212}"));
    match form(value) {
        Form::Decimal(digits) => text(&digits),
        Form::Power(mantissa, exponent) => {
            format!("{} \u{00b7} 10<sup>{}</sup>", text(&mantissa), text(&exponent.to_string()))
        }
        Form::Ratio(..) => math(&writer.term(&Term::Number(value), Rank::Sum)),
    }
}

fn sections(document: &Document, writer: &Writer<'_>) -> String {
    let mut out = String::new();
    for group in groups(document) {
        let (first, section) = group[0];
        let grouped = !section.group.is_empty();
        let label = if grouped { format!("group-{first}") } else { format!("section-{first}") };
        out += &format!("<section aria-labelledby=\"{label}\">\n");
        if grouped {
            out += &format!("<h2 id=\"{label}\">{}</h2>\n", plain(&section.group));
        }
        for (index, section) in group {
            let level = if grouped { 3 } else { 2 };
            out += &format!("<h{level} id=\"section-{index}\">{}</h{level}>\n", plain(&section.title));
            out += &equations(document, section, writer);
        }
        out += "</section>\n";
    }
    out
}

fn equations(document: &Document, section: &Section, writer: &Writer<'_>) -> String {
    let mut out = String::new();
    if !section.unit.is_empty() {
        out += &format!("<p class=\"unit\">in {}</p>\n", plain(&units(&section.unit)));
    }
    let (places, below) = section.laid_out();
    if !places.is_empty() {
        out += &matrix(section, &places, writer);
    }
    if below.is_empty() {
        return out;
    }
    out += "<div class=\"equations\">\n";
    for equation in below {
        out += &row(document, equation, writer);
    }
    out + "</div>\n"
}

/// An equation: its left side, the sign, and its right side in pieces.
fn row(document: &Document, equation: &Equation, writer: &Writer<'_>) -> String {
    let pieces: Vec<String> = writer.pieces(&equation.right).iter().map(|piece| math(piece)).collect();
    format!(
        "<div class=\"equation\" role=\"math\" aria-label=\"{}\"><span class=\"left\">{}</span><span \
         class=\"sign\">{}</span><span class=\"right\">{}</span></div>\n",
        plain(&text::equation(document, equation)),
        math(&writer.left(&equation.left)),
        math("<mo>=</mo>"),
        pieces.join("<wbr/>")
    )
}

fn matrix(section: &Section, places: &[Vec<Place<'_>>], writer: &Writer<'_>) -> String {
    let cell = |place: &Place<'_>| {
        let inner = match place {
            Place::Term(term) => writer.term(term, Rank::Sum),
            Place::Symbol(left) => writer.left(left),
        };
        format!("<mtd>{inner}</mtd>")
    };
    let rows = places.iter().map(|row| format!("<mtr>{}</mtr>", row.iter().map(cell).collect::<String>()));
    let rows: String = rows.collect();
    let symbol =
        section.symbol.as_ref().map_or(String::new(), |symbol| format!("{}<mo>=</mo>", identifier(symbol)));
    format!(
        "<div class=\"matrix\" tabindex=\"0\" role=\"group\" aria-label=\"{}\"><math display=\"block\"><mrow>{symbol}<mrow><mo \
         form=\"prefix\" stretchy=\"true\">[</mo><mtable>{rows}</mtable><mo form=\"postfix\" stretchy=\"true\">]</mo></mrow></mrow></math></div>\n",
        plain(&section.title),
    )
}
