//! Commands that run beside the server, each in a process of its own: a derivation may take minutes.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use lsp_server::RequestId;
use tempfile::TempDir;

/// Names of commands, as clients send them.
pub const DERIVE: &str = "hodograph.derive";
/// Writes the equations as a page.
pub const EQUATIONS: &str = "hodograph.equations";
/// Writes a motion as a page.
pub const SIMULATE: &str = "hodograph.simulate";
/// All.
pub const ALL: [&str; 3] = [DERIVE, EQUATIONS, SIMULATE];

/// How often it is looked whether a process has ended.
const PAUSE: Duration = Duration::from_millis(30);

/// A command has ended.
pub struct Finished {
    /// the request to answer
    pub id: RequestId,
    /// the page that it wrote, if it writes one; or what it said
    pub result: Result<Option<PathBuf>, String>,
}

/// Who is told that a command has ended.
pub type Tell = Arc<dyn Fn(Finished) + Send + Sync>;

/// The commands that run.
pub struct Jobs {
    tell: Tell,
    /// pages and messages of commands; goes with the server
    folder: Option<TempDir>,
    running: Vec<(String, PathBuf, Arc<Mutex<Child>>)>,
    count: usize,
}

impl Jobs {
    /// None yet.
    pub fn new(tell: Tell) -> Jobs {
        Jobs { tell, folder: None, running: Vec::new(), count: 0 }
    }

    /// Starts a command on a model file.
    ///
    /// # Errors
    ///
    /// Why it cannot run.
    pub fn start(&mut self, id: RequestId, command: &str, model: &Path) -> Result<(), String> {
        let over = |child: &Arc<Mutex<Child>>| !matches!(lock(child).try_wait(), Ok(None));
        self.running.retain(|(.., child)| !over(child));
        if self.running.iter().any(|(other, path, _)| other == command && path == model) {
            return Err("it is running already".to_owned());
        }
        let cannot = |error: std::io::Error| format!("it cannot run: {error}");
        if self.folder.is_none() {
            self.folder = Some(tempfile::Builder::new().prefix("hodograph-lsp").tempdir().map_err(cannot)?);
        }
        let Some(folder) = self.folder.as_ref().map(TempDir::path) else { return Err(String::new()) };
        self.count += 1;
        let name = model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let kind = command.rsplit('.').next().unwrap_or_default();
        let page = folder.join(format!("{name}-{kind}.html"));
        let words = folder.join(format!("{}.txt", self.count));
        let mut process = Command::new(std::env::current_exe().map_err(cannot)?);
        let mut output = Stdio::null();
        match command {
            DERIVE => {
                process.arg("derive").arg(model);
            }
            EQUATIONS => {
                process.arg("explain").arg(model).args(["--format", "html"]);
                output = File::create(&page).map_err(cannot)?.into();
            }
            _ => {
                process.arg("simulate").arg(model).arg("--html").arg(&page);
            }
        }
        let errors = File::create(&words).map_err(cannot)?;
        let child = process.stdin(Stdio::null()).stdout(output).stderr(errors).spawn().map_err(cannot)?;
        let child = Arc::new(Mutex::new(child));
        self.running.push((command.to_owned(), model.to_owned(), Arc::clone(&child)));
        let tell = Arc::clone(&self.tell);
        let page = (command != DERIVE).then_some(page);
        std::thread::spawn(move || {
            let status = loop {
                let ended = lock(&child).try_wait();
                match ended {
                    Ok(None) => std::thread::sleep(PAUSE),
                    Ok(Some(status)) => break Ok(status),
                    Err(error) => break Err(error.to_string()),
                }
            };
            let said = std::fs::read_to_string(&words).unwrap_or_default().trim().to_owned();
            let result = match status {
                Ok(status) if status.success() => Ok(page),
                Ok(status) if said.is_empty() => Err(format!("it ended with {status}")),
                Ok(_) => Err(said),
                Err(error) => Err(error),
            };
            tell(Finished { id, result });
        });
        Ok(())
    }
}

impl Drop for Jobs {
    fn drop(&mut self) {
        for (.., child) in &self.running {
            let mut child = lock(child);
            if matches!(child.try_wait(), Ok(None)) {
                let _ = child.kill();
                let _ = child.wait();
            }
        }
    }
}

fn lock(child: &Arc<Mutex<Child>>) -> std::sync::MutexGuard<'_, Child> {
    child.lock().unwrap_or_else(PoisonError::into_inner)
}
