//! Converts a description of a robot (URDF, MJCF or SDF) to the text of a model.
//!
//! ```text
//! URDF -> document  its attributes, checked, its links and joints with their places, the geometry of
//!                   collisions, and what is not used
//! MJCF -> mjcf      the same of bodies, whose joints may be several and anywhere: `chains` makes links
//! SDF  -> sdf       the same of links and joints, each in axes of its own
//!      -> tree      links and joints as a tree, checked
//!      -> bodies    links that are fixed to a moving link become part of it
//!      -> text      the model
//! ```

mod attributes;
mod chains;
mod collision;
mod description;
mod document;
mod fixed_links;
mod forces;
mod formulas;
mod lines;
mod masses;
mod mjcf;
mod names;
mod poses;
mod sdf;
mod symmetric;
mod text;
mod tree;
mod xml;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_formats;
#[cfg(test)]
mod tests_of_mjcf;
#[cfg(test)]
mod tests_of_sdf;
#[cfg(test)]
mod tests_of_xml;

/// The options of an import.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// names of the links that get a contact at their origins
    pub contacts: Vec<String>,
    /// whether the root link can move freely. `None`: if it has an inertia
    pub floating: Option<bool>,
    /// whether parameters are `fixed`, that is, folded in at build time
    pub fixed_parameters: bool,
}

/// The result of an import.
#[derive(Clone, Debug)]
pub struct Imported {
    /// the text of the model
    pub model: String,
    /// everything that was ignored, chosen or renamed, one sentence each
    pub notes: Vec<String>,
}

/// Imports the text of a URDF, MJCF or SDF file called `file` (for messages).
///
/// # Errors
///
/// All mistakes of the file, each in a sentence with its place.
pub fn import(source: &str, file: &str, options: &Options) -> Result<Imported, Vec<String>> {
    let mut notes = Vec::new();
    let lines = lines::Lines::of(source);
    let xml = xml::parse(source, file, &lines)?;
    let root = xml.root_element();
    let mut document = match root.tag_name().name() {
        "robot" => document::read(root, file, &lines, &mut notes)?,
        "mujoco" => mjcf::read(root, file, &lines, &mut notes)?,
        "sdf" => sdf::read(root, file, &lines, &mut notes)?,
        found => {
            let at = lines.place(root.range().start);
            return Err(vec![format!(
                "{file}:{at}: this is not a robot description: its root is <{found}>, not <robot> (URDF), <mujoco> (MJCF) or <sdf>"
            )]);
        }
    };
    let mut options = options.clone();
    document.shorten(&mut options.contacts, &mut notes);
    let mut tree = tree::build(&document, &mut notes)?;
    match (document.on_ground, options.floating) {
        (false, floating) => tree.choose_base(floating, &mut notes),
        (true, None) => {}
        (true, Some(_)) => {
            return Err(vec![format!(
                "{file}: --base is for URDF only: {} states itself whether the base is free",
                document.format
            )]);
        }
    }
    let groups = fixed_links::combined(&tree, &document, &mut notes)?;
    let model = text::write(&tree, &groups, &document, &options, &mut notes)?;
    Ok(Imported { model, notes })
}
