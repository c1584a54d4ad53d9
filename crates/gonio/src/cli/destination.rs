//! Where files go: checked before any time is spent.

use super::failure::{Failure, nearest};
use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::Path;

/// The extensions of pictures that can be written.
const EXTENSIONS: [&str; 3] = ["exr", "hdr", "png"];

/// The extension of a path in lower case, or nothing.
pub(super) fn extension(path: &Path) -> String {
    path.extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default()
        .to_lowercase()
}

/// Fails unless `path` has a picture's extension and lies in a folder that takes new files.
pub(super) fn check(path: &Path) -> Result<(), Failure> {
    check_extension(path, &EXTENSIONS, "pictures")?;
    writable(path)
}

/// Fails unless `path` has the extension of a picture or of a part of one and lies in a folder that takes new files.
pub(super) fn check_product(path: &Path) -> Result<(), Failure> {
    check_extension(path, &["exr", "hdr", "png", "gonio"], "pictures and parts")?;
    writable(path)
}

/// Fails unless the extension of `path` is one of those that `things` can be written with.
pub(super) fn check_extension(
    path: &Path,
    extensions: &[&str],
    things: &str,
) -> Result<(), Failure> {
    let extension = extension(path);
    if extensions.contains(&extension.as_str()) {
        return Ok(());
    }
    let message = match extension.as_str() {
        "" => format!(
            "{}: the name has no extension to tell the format by",
            path.display()
        ),
        other => format!("{}: {things} can't be written as .{other}", path.display()),
    };
    let listed = match extensions {
        [others @ .., last] if !others.is_empty() => format!(".{} or .{last}", others.join(", .")),
        all => all.iter().map(|e| format!(".{e}")).collect(),
    };
    Err(
        Failure::usage(message).with_help(match nearest(&extension, extensions) {
            Some(near) => format!("did you mean .{near}? {} are {listed}", capitalised(things)),
            None => format!("{things} are {listed}"),
        }),
    )
}

fn capitalised(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Fails unless `path` can be a file's, in a folder that takes new files.
pub(super) fn writable(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::input(format!(
            "{}: this is a folder, expected the name of a file",
            path.display()
        ))
        .with_help("name a file in it"));
    }
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    if !folder.exists() {
        return Err(Failure::input(format!(
            "{}: the folder {} does not exist",
            path.display(),
            folder.display()
        ))
        .with_help(format!("make it: mkdir -p '{}'", folder.display())));
    }
    if !folder.is_dir() {
        return Err(Failure::input(format!(
            "{}: {} is not a folder",
            path.display(),
            folder.display()
        ))
        .with_help("name a file in a folder"));
    }
    probe(folder).map_err(|e| Failure::io(&path.display().to_string(), "write", &e))
}

/// Bytes that a folder must take: more than a file system keeps in its directory.
const PROBE_BYTES: usize = 8192;

/// Makes a file in `folder`, and removes it.
fn probe(folder: &Path) -> std::io::Result<()> {
    let name = folder.join(format!(".gonio-probe-{}", std::process::id()));
    let mut options = OpenOptions::new();
    let mut file = match options.write(true).create_new(true).open(&name) {
        // Somebody else's: it shows that the folder takes files.
        Err(e) if e.kind() == ErrorKind::AlreadyExists => return Ok(()),
        other => other?,
    };
    let written = file.write_all(&[0; PROBE_BYTES]);
    drop(file);
    fs::remove_file(&name)?;
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(check(&folder.path().join("a.PNG")), Ok(()));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn extensions_are_lower_case() {
        assert_eq!(extension(Path::new("a/b.EXR")), "exr");
        assert_eq!(extension(Path::new("a.b/c")), "");
    }
}
