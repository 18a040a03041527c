//! What models import in an editor: the texts that are open there, else files.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use hodograph_generator::files::{self, Beside};
use hodograph_generator::parts::{Files, Imported};
use hodograph_generator::source;

/// The texts of open files, by what the files are known by.
#[derive(Clone, Default)]
pub struct Texts(Rc<RefCell<HashMap<String, String>>>);

impl Texts {
    /// A file is open with this text.
    pub fn set(&self, key: &str, text: &str) {
        self.0.borrow_mut().insert(key.to_owned(), text.to_owned());
    }

    /// A file is no longer open.
    pub fn remove(&self, key: &str) {
        self.0.borrow_mut().remove(key);
    }

    /// What a model in a file may import.
    pub fn beside(&self, path: &Path) -> Rc<dyn Files> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Rc::new(OpenOrBeside { open: self.clone(), beside: Beside { path: path.to_owned(), name } })
    }
}

struct OpenOrBeside {
    open: Texts,
    beside: Beside,
}

impl Files for OpenOrBeside {
    fn read(&self, importing: Option<&Imported>, path: &str) -> Result<Imported, String> {
        let (found, name) = self.beside.find(importing, path)?;
        let key = files::key(&found);
        if let Some(text) = self.open.0.borrow().get(&key) {
            return Ok(Imported { key, name, text: text.clone() });
        }
        let text = files::text(&found, source::MAX_BYTES);
        let text = text.map_err(|error| format!("cannot be read: {error}"))?;
        Ok(Imported { key, name, text })
    }
}
