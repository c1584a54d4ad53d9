//! From a glTF file to its JSON document and the bytes of its buffers and images.
//!
//! Only files beside the document are read, never the network: a URI is a `data:` URI or a relative path.

use crate::{LoadOptions, SceneError};
use gltf::json;
use std::path::{Path, PathBuf};

/// "glTF" and the chunk types, little-endian.
const GLB_MAGIC: &[u8] = b"glTF";
const GLB_JSON: u32 = 0x4E4F_534A;
const GLB_BIN: u32 = 0x004E_4942;

/// The JSON text of a glTF document and, in a binary one, its first binary chunk.
///
/// # Errors
/// [`SceneError::Format`] if a binary container is truncated, is not version 2, or has no JSON chunk first.
pub(super) fn split<'a>(
    path: &Path,
    bytes: &'a [u8],
) -> Result<(&'a [u8], Option<&'a [u8]>), SceneError> {
    if !bytes.starts_with(GLB_MAGIC) {
        return Ok((bytes, None));
    }
    let word = |at: usize| -> Result<u32, SceneError> {
        bytes
            .get(at..at + 4)
            .and_then(|b| b.try_into().ok())
            .map(u32::from_le_bytes)
            .ok_or_else(|| {
                let found = format!("the end of the file after {} bytes", bytes.len());
                SceneError::format(path, format!("byte {at}"), found, "a binary glTF header")
            })
    };
    let version = word(4)?;
    if version != 2 {
        let found = format!("version {version}");
        return Err(SceneError::format(
            path,
            "byte 4",
            found,
            "binary glTF version 2",
        ));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        let found = format!("{} bytes: the file is truncated", bytes.len());
        let expected = format!("the {length} bytes that its header announces");
        return Err(SceneError::format(path, "byte 8", found, expected));
    }
    let chunk = |at: usize| -> Result<(u32, &'a [u8]), SceneError> {
        let size = word(at)? as usize;
        let kind = word(at + 4)?;
        let data = at
            .checked_add(8 + size)
            .and_then(|end| bytes.get(at + 8..end));
        let data = data.ok_or_else(|| {
            let found = format!("a chunk of {size} bytes that ends after the file");
            SceneError::format(path, format!("byte {at}"), found, "a chunk inside the file")
        })?;
        Ok((kind, data))
    };
    let (kind, document) = chunk(12)?;
    if kind != GLB_JSON {
        let found = format!("a chunk of type {kind:#010x}");
        return Err(SceneError::format(path, "byte 16", found, "the JSON chunk"));
    }
    let mut at = 20 + document.len().next_multiple_of(4);
    while at + 8 <= length {
        let (kind, data) = chunk(at)?;
        if kind == GLB_BIN {
            return Ok((document, Some(data)));
        }
        at += 8 + data.len().next_multiple_of(4);
    }
    Ok((document, None))
}

/// The bytes of all buffers of a document, in their order.
///
/// # Errors
/// [`SceneError::Io`] for a file that can't be read, [`SceneError::Format`] for one that is too short, for a URI that is not
/// local, and for a missing binary chunk; [`SceneError::Limit`] past `max_bytes` in all.
pub(super) fn buffers(
    path: &Path,
    root: &json::Root,
    bin: Option<&[u8]>,
    options: &LoadOptions,
) -> Result<Vec<Vec<u8>>, SceneError> {
    let max_bytes = options.max_bytes;
    let mut total = 0_u64;
    let mut all = Vec::with_capacity(root.buffers.len());
    for (index, buffer) in root.buffers.iter().enumerate() {
        let place = format!("buffer {index}");
        let wanted = buffer.byte_length.0;
        total = total.saturating_add(wanted);
        if total > max_bytes {
            return Err(SceneError::Limit {
                path: path.to_owned(),
                place,
                found: format!("{total} bytes of buffers"),
                limit: format!("{max_bytes} bytes"),
            });
        }
        let bytes = match (&buffer.uri, bin) {
            (Some(uri), _) => resolve(path, &place, uri, options)?,
            (None, Some(bin)) if index == 0 => bin.to_vec(),
            (None, _) => {
                let found = "neither a URI nor a binary chunk";
                return Err(SceneError::format(path, place, found, "the buffer's bytes"));
            }
        };
        if (bytes.len() as u64) < wanted {
            let found = format!("{} bytes", bytes.len());
            return Err(SceneError::format(
                path,
                place,
                found,
                format!("byteLength = {wanted} bytes"),
            ));
        }
        all.push(bytes);
    }
    Ok(all)
}

/// The bytes that a URI stands for: a `data:` URI, or a file relative to the document's folder.
pub(super) fn resolve(
    path: &Path,
    place: &str,
    uri: &str,
    options: &LoadOptions,
) -> Result<Vec<u8>, SceneError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let bad = |found: &str| SceneError::format(path, place, found, "a base64 data URI");
        let (head, body) = data
            .split_once(',')
            .ok_or_else(|| bad("a data URI without a comma"))?;
        if !head.ends_with(";base64") {
            return Err(bad("a data URI that is not base64"));
        }
        return base64(body.as_bytes()).ok_or_else(|| bad("a broken base64 data URI"));
    }
    let file = local_path(path, place, uri)?;
    options.files.read(&file, options.max_bytes)
}

/// The file that a relative URI names.
pub(super) fn local_path(path: &Path, place: &str, uri: &str) -> Result<PathBuf, SceneError> {
    let decoded = percent_decoded(uri).ok_or_else(|| {
        SceneError::format(
            path,
            place,
            format!("the URI {uri:?}"),
            "a percent-encoded UTF-8 path",
        )
    })?;
    let relative = Path::new(&decoded);
    // A colon before the first slash is a scheme: http:, file:, or a drive letter.
    let first = decoded.split('/').next().unwrap_or_default();
    if first.contains(':') || relative.is_absolute() {
        let expected = "a path relative to the glTF file (nothing is fetched from elsewhere)";
        return Err(SceneError::format(
            path,
            place,
            format!("the URI {uri:?}"),
            expected,
        ));
    }
    Ok(path.parent().unwrap_or(Path::new("")).join(relative))
}

/// A URI with its %XX resolved; nothing if that isn't UTF-8.
fn percent_decoded(uri: &str) -> Option<String> {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let escaped = (bytes[i] == b'%')
            .then(|| bytes.get(i + 1..i + 3))
            .flatten()
            .and_then(|hex| std::str::from_utf8(hex).ok())
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        match escaped {
            Some(byte) => {
                out.push(byte);
                i += 3;
            }
            None => {
                out.push(bytes[i]);
                i += 1;
            }
        }
    }
    String::from_utf8(out).ok()
}

/// Decoded base64 (RFC 4648 section 4), with or without padding; nothing if a character isn't in its alphabet.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let end = text.iter().rposition(|&c| c != b'=').map_or(0, |i| i + 1);
    if text.len() - end > 2 || end % 4 == 1 {
        return None;
    }
    let mut out = Vec::with_capacity(end * 3 / 4);
    let (mut bits, mut count) = (0_u32, 0);
    for &c in &text[..end] {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_rfc_4648() {
        for (text, plain) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg", "foob"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(base64(text.as_bytes()).unwrap(), plain.as_bytes(), "{text}");
        }
        for bad in ["Z", "Zg=x", "Z g=", "Zg===", "Zm9vY"] {
            assert!(base64(bad.as_bytes()).is_none(), "{bad}");
        }
    }

    #[test]
    fn uris_are_local() {
        let here = Path::new("/scenes/a/b.gltf");
        let local = |uri: &str| local_path(here, "image 0", uri);
        assert_eq!(
            local("my%20image.png").unwrap(),
            Path::new("/scenes/a/my image.png")
        );
        assert_eq!(
            local("../tex/50%.png").unwrap(),
            Path::new("/scenes/a/../tex/50%.png")
        );
        for remote in [
            "http://example.org/a.png",
            "file:///etc/hosts",
            "/etc/hosts",
            "C:\\a.png",
        ] {
            let message = local(remote).unwrap_err().to_string();
            assert!(
                message.contains("image 0") && message.contains("relative"),
                "{message}"
            );
        }
    }

    /// A binary container around the given chunks.
    fn glb(chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, data) in chunks {
            body.extend((data.len() as u32).to_le_bytes());
            body.extend(kind.to_le_bytes());
            body.extend(*data);
        }
        let mut file = b"glTF".to_vec();
        file.extend(2_u32.to_le_bytes());
        file.extend((12 + body.len() as u32).to_le_bytes());
        file.extend(body);
        file
    }

    #[test]
    fn binary_containers_are_split() {
        let here = Path::new("a.glb");
        let whole = glb(&[(GLB_JSON, b"{}  "), (7, b"skip"), (GLB_BIN, b"12345678")]);
        let (json, bin) = split(here, &whole).unwrap();
        assert_eq!((json, bin), (&b"{}  "[..], Some(&b"12345678"[..])));
        let (json, bin) = split(here, b"{ }").unwrap();
        assert_eq!((json, bin), (&b"{ }"[..], None));
        for cut in 4..whole.len() {
            let message = split(here, &whole[..cut]).unwrap_err().to_string();
            assert!(message.starts_with("a.glb: byte "), "{message}");
        }
        let mut short = whole.clone();
        short[8..12].copy_from_slice(&3_u32.to_le_bytes());
        assert_eq!(
            split(here, &short).unwrap().1,
            None,
            "a header that announces too little hides the rest"
        );
        let mut huge = whole.clone();
        huge[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(
            split(here, &huge)
                .unwrap_err()
                .to_string()
                .contains("chunk")
        );
        assert!(
            split(here, &glb(&[(GLB_BIN, b"1234")]))
                .unwrap_err()
                .to_string()
                .contains("JSON")
        );
        let mut old = whole;
        old[4] = 1;
        assert!(
            split(here, &old)
                .unwrap_err()
                .to_string()
                .contains("version 1")
        );
    }
}
