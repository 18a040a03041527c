//! Renaming where a name is one of a part, or of a model that uses parts. Such a name stands in several texts:
//! that of the model, those that it imports, and the other models that import these. All are changed together,
//! and read again with the change before it is offered: each place must stand for the same name as before, and
//! `check` must say the same.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

use hodograph_model::diagnostics::Diagnostic;
use hodograph_model::model::names::speeds_of;
use hodograph_model::parts::names::{Names, Owned, Scope, names};
use hodograph_model::parts::{Files, Imported};
use hodograph_model::source::MAX_TOKENS;
use hodograph_model::span::Span;
use hodograph_model::syntax::lexer;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::Section;

use crate::Document;
use crate::new_name::valid_name;
use crate::statements::partner;
use crate::text::{Edit, apply};

/// A model, and what its file is known by: what [`Imported::key`] is where others import it.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// the key
    pub key: &'a str,
    /// the model
    pub document: &'a Document,
}

/// The changes of one text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Renamed {
    /// what its file is known by
    pub key: String,
    /// the text before the change
    pub text: String,
    /// the changes
    pub edits: Vec<Edit>,
}

/// Whether a text ends a string with the name of a file.
fn names_file(text: &str, key: &str) -> bool {
    let name = key.rsplit(['/', '\\']).next().unwrap_or(key);
    text.contains(&format!("{name}\""))
}

/// A name, the same in all models.
type Global = (String, Scope, String);

/// Files, of which some have another text.
struct Overlaid {
    files: Rc<dyn Files>,
    texts: HashMap<String, String>,
}

impl Files for Overlaid {
    fn read(&self, importing: Option<&Imported>, path: &str) -> Result<Imported, String> {
        let mut file = self.files.read(importing, path)?;
        if let Some(text) = self.texts.get(&file.key) {
            text.clone_into(&mut file.text);
        }
        Ok(file)
    }
}

/// A model with the places of its names.
struct View<'a> {
    known: Known<'a>,
    names: Names,
}

impl View<'_> {
    fn key(&self, file: u32) -> &str {
        let imported = (file as usize).checked_sub(1).and_then(|file| self.names.files.get(file));
        imported.map_or(self.known.key, |file| file.key.as_str())
    }

    fn text(&self, file: u32) -> &str {
        let imported = (file as usize).checked_sub(1).and_then(|file| self.names.files.get(file));
        imported.map_or(self.known.document.text.as_str(), |file| file.text.as_str())
    }

    fn global(&self, name: usize) -> Global {
        let Owned { file, scope, text } = &self.names.names[name];
        (self.key(*file).to_owned(), scope.clone(), text.clone())
    }
}

impl Document {
    /// Where its names stand; nothing where it has no parts, or cannot be read.
    fn names(&self) -> Option<Names> {
        self.source.expansion()?;
        names(self.tokens(), &*self.files, MAX_TOKENS)
    }

    /// The name at a place of a model with parts that can be changed, and its place.
    ///
    /// # Errors
    ///
    /// The reason why it cannot be changed.
    pub(crate) fn renameable_with_parts(&self, offset: u32) -> Result<(String, Span), String> {
        let names = self.names().ok_or(UNREAD)?;
        let (place, name) = at(&names, offset).ok_or_else(|| self.no_name(offset))?;
        Ok((names.names[name].text.clone(), place))
    }

    fn no_name(&self, offset: u32) -> String {
        match self.token_at(offset) {
            Some((_, token)) if GIVEN.contains(&token.text.as_str()) => is_given(&token.text),
            _ => "no name of the model stands here".to_owned(),
        }
    }
}

/// Names that no model declares.
const GIVEN: [&str; 4] = ["N", "O", "time", "pi"];

fn is_given(name: &str) -> String {
    format!("`{name}` is given: it is declared in no model")
}

const UNREAD: &str = "the model cannot be read: correct its mistakes first";

/// The name of the model's own text at a place.
fn at(names: &Names, offset: u32) -> Option<(Span, usize)> {
    let holds = |span: Span| span.start <= offset && offset <= span.end;
    let place = names.places.iter().find(|place| place.file == 0 && holds(place.span))?;
    Some((place.span, *place.names.first()?))
}

/// The changes that give the name at a place of the model `of` another name, in all texts where it stands.
/// `others` are the models that may import what this one imports, or its own text; those that do not are left
/// out.
///
/// # Errors
///
/// The reason why this is impossible: the name is taken or invalid, a model would change its meaning, or one
/// that has the name cannot be read.
pub fn rename(of: Known<'_>, offset: u32, new: &str, others: &[Known<'_>]) -> Result<Vec<Renamed>, String> {
    let Known { key, document } = of;
    if !document.has_parts() {
        let (text, edits) = (document.text.as_str().to_owned(), document.rename(offset, new)?);
        let renamed = Renamed { key: key.to_owned(), text, edits };
        return Ok(if renamed.edits.is_empty() { Vec::new() } else { vec![renamed] });
    }
    let own = View { known: of, names: document.names().ok_or(UNREAD)? };
    let (_, name) = at(&own.names, offset).ok_or_else(|| document.no_name(offset))?;
    let old = own.names.names[name].text.clone();
    if new == old {
        return Ok(Vec::new());
    }
    valid_name(new)?;
    if GIVEN.contains(&new) {
        return Err(is_given(new));
    }
    let begin = own.global(name);
    let (mut views, mut unread) = (vec![own], Vec::new());
    for known in others.iter().filter(|other| other.key != key) {
        match known.document.names() {
            Some(names) => views.push(View { known: *known, names }),
            None => unread.push(known),
        }
    }
    let same = all_of(&views, begin);
    free(&views, &same, new)?;
    let keys: BTreeSet<&str> = same.iter().map(|(key, ..)| key.as_str()).collect();
    let imports = |known: &&&Known<'_>| {
        let source = &known.document.source;
        match source.expansion() {
            Some(expansion) => expansion.files.iter().any(|file| keys.contains(file.key.as_str())),
            // Where the imports of a text cannot be read, it may import what it names the file of.
            None => source.text().is_some_and(|text| keys.iter().any(|key| names_file(text, key))),
        }
    };
    if let Some(known) = unread.iter().find(imports) {
        let name = known.document.source.name();
        return Err(format!(
            "`{name}` may have this name too, and cannot be read: correct its mistakes first"
        ));
    }
    let stands =
        |view: &View<'_>| view.names.names.iter().enumerate().any(|(i, _)| same.contains(&view.global(i)));
    views.retain(stands);
    let changed = changes(&views, &same, new)?;
    let Err(why) = same_after(&views, &changed) else { return Ok(list(changed)) };
    // `q` and `u` belong together by their names; an equation can state this instead
    let stated = with_rates(&views, &same, &old, new, changed).ok_or_else(|| why.clone())?;
    same_after(&views, &stated).map_err(|_| why)?;
    Ok(list(stated))
}

/// All names that are one with this: what a part shares with the mechanism, and members of several parts that
/// one place stands for.
fn all_of(views: &[View<'_>], begin: Global) -> BTreeSet<Global> {
    let mut groups: Vec<Vec<Global>> = Vec::new();
    for view in views {
        let pairs = view.names.shared.iter().map(|(own, outer)| vec![view.global(*own), view.global(*outer)]);
        groups.extend(pairs);
        let several = view.names.places.iter().filter(|place| place.names.len() > 1);
        groups.extend(several.map(|place| place.names.iter().map(|name| view.global(*name)).collect()));
    }
    let mut all = BTreeSet::from([begin]);
    loop {
        let before = all.len();
        for group in &groups {
            if group.iter().any(|name| all.contains(name)) {
                all.extend(group.iter().cloned());
            }
        }
        if all.len() == before {
            return all;
        }
    }
}

/// Whether no part or mechanism that is concerned has the new name.
fn free(views: &[View<'_>], same: &BTreeSet<Global>, new: &str) -> Result<(), String> {
    let taken = |name: &Global| {
        name.2 == new && same.iter().any(|(key, scope, _)| (key, scope) == (&name.0, &name.1))
    };
    let all = views.iter().flat_map(|view| (0..view.names.names.len()).map(|name| view.global(name)));
    match all.into_iter().find(taken) {
        None => Ok(()),
        Some((_, scope, _)) => Err(match scope {
            Scope::Part(part) => format!("the part `{part}` has a name `{new}` already"),
            Scope::File => format!("there is a part `{new}` already"),
            Scope::Mechanism | Scope::Repetition(_) => format!("the mechanism has a name `{new}` already"),
        }),
    }
}

/// The changes of each text: key, text before, changes.
type Changes = BTreeMap<String, (String, Vec<Edit>)>;

fn list(changes: Changes) -> Vec<Renamed> {
    changes.into_iter().map(|(key, (text, edits))| Renamed { key, text, edits }).collect()
}

fn changes(views: &[View<'_>], same: &BTreeSet<Global>, new: &str) -> Result<Changes, String> {
    let mut changed = Changes::new();
    for view in views {
        for place in &view.names.places {
            let Some(name) =
                place.names.iter().map(|name| view.global(*name)).find(|name| same.contains(name))
            else {
                continue;
            };
            let text = view.text(place.file);
            if text.get(place.span.range()) != Some(name.2.as_str()) {
                return Err(format!("`{}` is spelled in two ways: spell it in one first", name.2));
            }
            let (_, edits) = changed
                .entry(view.key(place.file).to_owned())
                .or_insert_with(|| (text.to_owned(), Vec::new()));
            edits.push(Edit { span: place.span, text: new.to_owned() });
        }
    }
    for (_, edits) in changed.values_mut() {
        edits.sort_by_key(|edit| edit.span);
        edits.dedup();
    }
    Ok(changed)
}

/// Whether each model means the same after the changes, and has the same mistakes.
fn same_after(views: &[View<'_>], changed: &Changes) -> Result<(), String> {
    let texts: HashMap<String, String> =
        changed.iter().map(|(key, (text, edits))| (key.clone(), apply(text, edits))).collect();
    for view in views {
        let Known { key, document } = view.known;
        let files = Rc::new(Overlaid { files: document.files.clone(), texts: texts.clone() });
        let own = texts.get(key).map_or(document.text.as_str(), String::as_str);
        let after = Document::importing(own, document.source.name(), files);
        let kinds = |all: &[Diagnostic]| {
            let mut kinds: Vec<_> = all.iter().map(|found| found.code).collect();
            kinds.sort();
            kinds
        };
        let (before, found) = (&document.analysis.diagnostics, &after.analysis.diagnostics);
        if kinds(before) != kinds(found) {
            let new = found.iter().find(|found| !before.iter().any(|known| known.code == found.code));
            return Err(match new {
                Some(mistake) => {
                    format!("with it `{}` has a mistake: {}", document.source.name(), mistake.message)
                }
                None => format!("with it `{}` would mean something else", document.source.name()),
            });
        }
        let stated = |file: u32, names: &Names, span: Span| {
            let key = match file {
                0 => key,
                file => names.files.get(file as usize - 1).map_or("", |file| file.key.as_str()),
            };
            changed.get(key).is_some_and(|(_, edits)| is_inserted(edits, span))
        };
        let same = after.names().is_some_and(|names| {
            let before = structure(&view.names, |_| false);
            before == structure(&names, |place| stated(place.0, &names, place.1))
        });
        if !same {
            return Err(format!("with it `{}` would mean something else", document.source.name()));
        }
    }
    Ok(())
}

/// Whether a place of a changed text is within one that was inserted.
fn is_inserted(edits: &[Edit], span: Span) -> bool {
    let mut moved = 0_i64;
    edits.iter().any(|edit| {
        let start = i64::from(edit.span.start) + moved;
        let end = start + edit.text.len() as i64;
        moved += edit.text.len() as i64 - i64::from(edit.span.end - edit.span.start);
        edit.span.range().is_empty() && start <= i64::from(span.start) && i64::from(span.end) <= end
    })
}

/// Which places stand for the same names: for each place, in order, its file and the numbers of its names, counted
/// in the order in which they first stand somewhere.
fn structure(names: &Names, without: impl Fn((u32, Span)) -> bool) -> Vec<(u32, Vec<usize>)> {
    let mut numbers: HashMap<usize, usize> = HashMap::new();
    let mut out = Vec::new();
    for place in names.places.iter().filter(|place| !without((place.file, place.span))) {
        let mut own = Vec::new();
        for name in &place.names {
            let next = numbers.len();
            own.push(*numbers.entry(*name).or_insert(next));
        }
        own.sort_unstable();
        out.push((place.file, own));
    }
    out
}

/// The same changes with the equations `d(q..)/dt = u..` that hold because of the names, and would not with the
/// new one.
fn with_rates(
    views: &[View<'_>],
    same: &BTreeSet<Global>,
    old: &str,
    new: &str,
    mut changed: Changes,
) -> Option<Changes> {
    let mut stated = BTreeMap::new();
    for view in views {
        for place in &view.names.places {
            let (Some(whole), [name]) = (place.coordinate, place.names.as_slice()) else { continue };
            let (key, scope, coordinate) = view.global(*name);
            let is = |text: &str| (key.clone(), scope.clone(), text.to_owned());
            let known = |speed: &String| (0..view.names.names.len()).any(|i| view.global(i) == is(speed));
            let Some(speed) = speeds_of(&coordinate).find(known) else { continue };
            if !same.contains(&is(&coordinate)) && !same.contains(&is(&speed)) {
                continue;
            }
            let text = view.text(place.file);
            let indices = text.get(place.span.end as usize..whole.end as usize)?;
            let named = |name: &str| if name == old { new.to_owned() } else { name.to_owned() };
            let equation = format!("d({}{indices})/dt = {}{indices};", named(&coordinate), named(&speed));
            let file = view.key(place.file).to_owned();
            stated.insert((file, whole), (text.to_owned(), equation));
        }
    }
    if stated.is_empty() {
        return None;
    }
    for ((file, whole), (text, equation)) in stated {
        let edit = equation_in_block(&text, whole, &equation)?;
        let (_, edits) = changed.entry(file).or_insert_with(|| (text, Vec::new()));
        edits.push(edit);
        edits.sort_by_key(|edit| edit.span);
    }
    Some(changed)
}

/// One more kinematical equation in the block whose section holds a place.
fn equation_in_block(text: &str, place: Span, equation: &str) -> Option<Edit> {
    let tokens = lexer::tokens(text, MAX_TOKENS);
    let mut open: Vec<usize> = Vec::new();
    for (i, token) in tokens.iter().enumerate().take_while(|(_, token)| token.span.end <= place.start) {
        match token.kind {
            TokenKind::Open('{') => open.push(i),
            TokenKind::Close('}') => drop(open.pop()),
            _ => {}
        }
    }
    let section = open.pop()?;
    let (first, last) = match open.pop() {
        Some(brace) => (brace + 1, partner(&tokens, brace)),
        None => (0, tokens.len()),
    };
    let mut sections: Vec<(Section, usize)> = Vec::new();
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate().take(last).skip(first) {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            TokenKind::Name if depth == 0 && opens(tokens.get(i + 1)) => {
                sections.extend(Section::of_word(&token.text).map(|section| (section, i)));
            }
            _ => {}
        }
    }
    let at = |at: u32| Span { start: at, end: at };
    if let Some((_, there)) = sections.iter().find(|(section, _)| *section == Section::Kinematics) {
        return Some(Edit { span: at(tokens[there + 1].span.end), text: format!(" {equation}") });
    }
    let line = |at: u32| text[..at as usize].rfind('\n').map_or(0, |feed| feed + 1);
    let head = tokens[section.checked_sub(1)?].span.start;
    let indent: String = text[line(head)..].chars().take_while(|c| *c == ' ').collect();
    let written = format!("{} {{ {equation} }}", Section::Kinematics.word());
    // before the first section that comes later, with its documentation, else at the end
    let later = sections.iter().find(|(section, _)| *section > Section::Kinematics);
    match later {
        Some((_, there)) => {
            let start = tokens[*there].span.start;
            Some(Edit { span: at(start), text: format!("{written}\n{indent}") })
        }
        None => {
            let end = tokens.get(last.checked_sub(1)?)?.span.end;
            Some(Edit { span: at(end), text: format!("\n{indent}{written}") })
        }
    }
}

fn opens(token: Option<&Token>) -> bool {
    token.is_some_and(|token| token.kind == TokenKind::Open('{'))
}
