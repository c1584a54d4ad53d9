//! Scripts to talk with.

use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// The Python interpreter, if there is one.
pub fn python() -> Option<String> {
    let python = std::env::var("GONIO_PYTHON").unwrap_or_else(|_| "python3".into());
    if runs(&python, "import sys; assert sys.version_info >= (3, 10)") {
        return Some(python);
    }
    eprintln!("skipped: no `{python}` of version 3.10 or later");
    None
}

/// Whether the interpreter has numpy.
pub fn has_numpy(python: &str) -> bool {
    runs(python, "import numpy")
}

fn runs(python: &str, code: &str) -> bool {
    Command::new(python)
        .args(["-c", code])
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// A script in a folder of its own.
pub struct Script {
    folder: TempDir,
    python: String,
}

impl Script {
    /// `None`: there is no Python.
    pub fn new(body: &str) -> Option<Self> {
        let python = python()?;
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("script.py"), body).unwrap();
        Some(Self { folder, python })
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub fn command(&self) -> String {
        let script = self.folder.path().join("script.py");
        format!("{} '{}'", self.python, script.display())
    }
}
