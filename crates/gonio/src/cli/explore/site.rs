//! The files of the page, all in memory: nothing else can be asked for.

use crate::cli::failure::Failure;
use flate2::read::GzDecoder;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

/// Path in the site, whether it is compressed, and the bytes.
type Embedded = (&'static str, bool, &'static [u8]);

/// What `build.rs` found in `web/dist`.
static EMBEDDED: &[Embedded] = include!(concat!(env!("OUT_DIR"), "/site.rs"));

/// More than this is no page, but a folder that was given by mistake.
const MOST_FILES: usize = 2000;
const MOST_BYTES: u64 = 256 << 20;
const DEEPEST: usize = 8;

/// A file of the page.
pub(super) struct File {
    bytes: Cow<'static, [u8]>,
    /// Whether `bytes` are gzip.
    gzip: bool,
    pub media_type: &'static str,
    /// A tag of the content, for `ETag`. Weak: compressed or not, it is the same file.
    pub tag: String,
    /// The name has a hash of the content, so what it names never changes.
    pub immutable: bool,
}

impl File {
    fn new(path: &str, bytes: Cow<'static, [u8]>, gzip: bool) -> Self {
        let hash = blake3::hash(&bytes).to_hex();
        Self {
            gzip,
            media_type: media_type(path),
            tag: format!("W/\"{}\"", &hash[..32]),
            immutable: is_hashed(path),
            bytes,
        }
    }

    /// The body for a browser that does or does not take gzip, and whether it is gzip.
    pub fn body(&self, takes_gzip: bool) -> std::io::Result<(Cow<'_, [u8]>, bool)> {
        if !self.gzip || takes_gzip {
            return Ok((Cow::Borrowed(&self.bytes), self.gzip));
        }
        let mut plain = Vec::new();
        GzDecoder::new(&*self.bytes).read_to_end(&mut plain)?;
        Ok((Cow::Owned(plain), false))
    }

    /// Whether the body depends on what the browser takes.
    pub fn varies(&self) -> bool {
        self.gzip
    }
}

/// Files by their path, which begins with `/`.
pub(super) struct Site(BTreeMap<String, File>);

impl Site {
    /// The page in this program.
    ///
    /// # Errors
    /// If the program was built without it.
    pub fn embedded() -> Result<Self, Failure> {
        Self::of(EMBEDDED)
    }

    /// The files of a table like that of the program.
    pub(super) fn of(embedded: &[Embedded]) -> Result<Self, Failure> {
        if embedded.is_empty() {
            return Err(
                Failure::input("this gonio was built without the explorer's page").with_help(
                    "'cargo xtask web' builds it (with Node 20 or newer); then build gonio again, or give --site web/dist",
                ),
            );
        }
        let files = embedded.iter().map(|&(name, gzip, bytes)| {
            let path = format!("/{name}");
            let file = File::new(&path, Cow::Borrowed(bytes), gzip);
            (path, file)
        });
        Ok(Self(files.collect()))
    }

    /// The page in a folder.
    ///
    /// # Errors
    /// If the folder can't be read, has no `index.html`, or holds far more than a page.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let mut site = Self(BTreeMap::new());
        let mut left = MOST_BYTES;
        site.add(folder, "/", &mut left, DEEPEST)?;
        if !site.0.contains_key("/index.html") {
            return Err(
                Failure::input(format!("{}: has no index.html", folder.display()))
                    .with_help("'cargo xtask web' builds the page into web/dist"),
            );
        }
        Ok(site)
    }

    /// Adds what is in a folder. Links are left out: they could lead out of it.
    fn add(
        &mut self,
        folder: &Path,
        prefix: &str,
        left: &mut u64,
        deeper: usize,
    ) -> Result<(), Failure> {
        let fail = |path: &Path, e| Failure::io(&path.display().to_string(), "read", &e);
        for entry in std::fs::read_dir(folder).map_err(|e| fail(folder, e))? {
            let entry = entry.map_err(|e| fail(folder, e))?;
            let path = entry.path();
            let kind = entry.file_type().map_err(|e| fail(&path, e))?;
            let Some(name) = entry.file_name().to_str().map(|n| format!("{prefix}{n}")) else {
                continue;
            };
            if kind.is_dir() && deeper > 0 {
                self.add(&path, &format!("{name}/"), left, deeper - 1)?;
            } else if kind.is_file() {
                let size = entry.metadata().map_err(|e| fail(&path, e))?.len();
                if size > *left || self.0.len() == MOST_FILES {
                    return Err(Failure::input(format!(
                        "{}: holds more than a page: over {MOST_FILES} files or {} MiB",
                        folder.display(),
                        MOST_BYTES >> 20
                    ))
                    .with_help("--site is the folder that 'cargo xtask web' writes: web/dist"));
                }
                *left -= size;
                let bytes = std::fs::read(&path).map_err(|e| fail(&path, e))?;
                let file = File::new(&name, Cow::Owned(bytes), false);
                self.0.insert(name, file);
            }
        }
        Ok(())
    }

    /// The file of a request's path. Names of files are compared as they stand: nothing is decoded or resolved, so no path leads
    /// anywhere else.
    pub fn get(&self, path: &str) -> Option<&File> {
        self.0.get(if path == "/" { "/index.html" } else { path })
    }
}

fn media_type(path: &str) -> &'static str {
    match path.rsplit_once('.').map_or("", |(_, extension)| extension) {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" | "map" => "application/json",
        "webmanifest" => "application/manifest+json",
        "wasm" => "application/wasm",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "webp" => "image/webp",
        "ico" => "image/vnd.microsoft.icon",
        "woff2" => "font/woff2",
        "txt" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

/// Whether the bundler has put a hash of the content into the name: `/assets/index-Bx3kQ9_d.js`.
fn is_hashed(path: &str) -> bool {
    const DIGITS: usize = 8;
    let Some(name) = path.strip_prefix("/assets/") else {
        return false;
    };
    let stem = name.split_once('.').map_or(name, |(stem, _)| stem);
    let is_digit = |b: u8| b.is_ascii_alphanumeric() || b == b'-' || b == b'_';
    let bytes = stem.as_bytes();
    bytes.len() > DIGITS
        && bytes[bytes.len() - DIGITS - 1] == b'-'
        && bytes[bytes.len() - DIGITS..].iter().copied().all(is_digit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write;

    #[test]
    fn only_names_with_a_hash_never_change() {
        assert!(is_hashed("/assets/index-Bx3kQ9_d.js"));
        assert!(is_hashed("/assets/index-Bx3k-9_d.css.map"));
        for path in [
            "/index.html",
            "/sw.js",
            "/assets/a.js",
            "/assets/index.js",
            "/x-Bx3kQ9_d.js",
        ] {
            assert!(!is_hashed(path), "{path}");
        }
    }

    #[test]
    fn a_program_without_the_page_says_how_to_get_it() {
        let failure = Site::of(&[]).err().unwrap();
        assert_eq!(failure.code(), 3);
        assert!(failure.message().contains("without the explorer's page"));
    }

    #[test]
    fn a_compressed_file_is_unpacked_for_who_takes_no_gzip() {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(b"text").unwrap();
        let file = File::new("/a.txt", Cow::Owned(encoder.finish().unwrap()), true);
        let (body, gzip) = file.body(false).unwrap();
        assert_eq!((&*body, gzip), (&b"text"[..], false));
        let (body, gzip) = file.body(true).unwrap();
        assert!(gzip && body.starts_with(&[0x1F, 0x8B]));
    }

    #[test]
    fn what_is_embedded_is_whole() {
        for &(name, gzip, bytes) in EMBEDDED {
            let file = File::new(name, Cow::Borrowed(bytes), gzip);
            assert!(file.body(false).is_ok(), "{name}");
        }
    }
}
