//! Converts a robot description (URDF) to the text of a model.
//!
//! ```text
//! URDF -> document  the XML: its attributes, checked, its links and joints with their places, the
//!                   geometry of collisions, and what is not used
//!      -> tree      links and joints as a tree, checked
//!      -> bodies    links that are fixed to a moving link become part of it
//!      -> text      the model
//! ```

mod attributes;
mod collision;
mod description;
mod document;
mod fixed_links;
mod lines;
mod names;
mod text;
mod tree;

#[cfg(test)]
mod tests;

/// How to import.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// links at whose origins there is to be a contact
    pub contacts: Vec<String>,
    /// whether the root link is free to move. `None`: if it has an inertia
    pub floating: Option<bool>,
    /// whether parameters are folded in at build time.
    pub fixed_parameters: bool,
}

/// What an import delivers.
#[derive(Clone, Debug)]
pub struct Imported {
    /// the text of the model
    pub model: String,
    /// what was ignored, chosen or renamed, one sentence each
    pub notes: Vec<String>,
}

/// Imports the text of a URDF file called `file` (for messages).
///
/// # Errors
///
/// All that is wrong with the file, one sentence with its place each.
pub fn import(source: &str, file: &str, options: &Options) -> Result<Imported, Vec<String>> {
    let mut notes = Vec::new();
    let document = document::read(source, file, &mut notes)?;
    let mut tree = tree::grow(&document, &mut notes)?;
    tree.choose_base(options.floating, &mut notes);
    let groups = fixed_links::combined(&tree, &document, &mut notes)?;
    let model = text::write(&tree, &groups, &document, options, &mut notes)?;
    Ok(Imported { model, notes })
}
