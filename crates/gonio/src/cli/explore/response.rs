//! What the explorer's server answers, with the headers that keep the page to itself.

use super::request::{BROKEN, NOT_FOUND, Refusal, Request};
use super::site::Site;
use std::borrow::Cow;
use std::fmt::Write;

/// Scripts, styles, pictures and workers of this server alone; WebAssembly, but no code from text; in no other page's frame. The
/// page says the same of itself, but for the frame, which only a server can say.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' blob: data:; \
    connect-src 'self'; worker-src 'self'; font-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; \
    frame-ancestors 'none'";

/// The head and the body of an answer.
pub(super) struct Response<'a> {
    pub head: String,
    pub body: Cow<'a, [u8]>,
}

/// What the request is answered.
pub(super) fn answer<'a>(site: &'a Site, request: &Request) -> Response<'a> {
    let Some(file) = site.get(&request.path) else {
        return refusal(NOT_FOUND, request.wants_body, request.keep_alive);
    };
    let Ok((body, gzip)) = file.body(request.takes_gzip) else {
        return refusal(BROKEN, request.wants_body, request.keep_alive);
    };
    let is_there = request
        .has
        .as_deref()
        .is_some_and(|has| knows(has, &file.tag));
    let status = if is_there {
        "304 Not Modified"
    } else {
        "200 OK"
    };
    let mut head = begin(status, request.keep_alive);
    let keep = match file.immutable {
        true => "public, max-age=31536000, immutable",
        false => "no-cache",
    };
    let _ = write!(head, "ETag: {}\r\nCache-Control: {keep}\r\n", file.tag);
    if file.varies() {
        head += "Vary: Accept-Encoding\r\n";
    }
    if is_there {
        head += "\r\n";
        return Response {
            head,
            body: Cow::Borrowed(&[]),
        };
    }
    let _ = write!(
        head,
        "Content-Type: {}\r\nContent-Length: {}\r\n",
        file.media_type,
        body.len()
    );
    if gzip {
        head += "Content-Encoding: gzip\r\n";
    }
    head += "\r\n";
    let body = if request.wants_body {
        body
    } else {
        Cow::Borrowed(&[][..])
    };
    Response { head, body }
}

/// What a request is answered that gets nothing.
pub(super) fn refusal(refusal: Refusal, wants_body: bool, keep_alive: bool) -> Response<'static> {
    let mut head = begin(refusal.status, keep_alive);
    if refusal.status.starts_with("405") {
        head += "Allow: GET, HEAD\r\n";
    }
    let _ = write!(
        head,
        "Cache-Control: no-store\r\nContent-Type: text/plain; charset=utf-8\r\nContent-Length: {}\r\n\r\n",
        refusal.text.len()
    );
    let body = if wants_body {
        refusal.text.as_bytes()
    } else {
        &[]
    };
    Response {
        head,
        body: Cow::Borrowed(body),
    }
}

/// The status line and what every answer says.
fn begin(status: &str, keep_alive: bool) -> String {
    let connection = if keep_alive { "keep-alive" } else { "close" };
    format!(
        "HTTP/1.1 {status}\r\nConnection: {connection}\r\nContent-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\n\
         Referrer-Policy: no-referrer\r\nCross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Resource-Policy: same-origin\r\n"
    )
}

/// Whether an `If-None-Match` names the tag; its comparison is the weak one.
fn knows(has: &str, tag: &str) -> bool {
    let opaque = |tag: &str| tag.trim().trim_start_matches("W/").to_owned();
    has.trim() == "*" || has.split(',').any(|known| opaque(known) == opaque(tag))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write as _;

    fn site() -> Site {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(b"(module)").unwrap();
        let bytes = encoder.finish().unwrap().leak();
        Site::of(&[("a.wasm", true, bytes), ("index.html", false, b"page")]).unwrap()
    }

    fn request(path: &str, takes_gzip: bool) -> Request {
        Request {
            path: path.into(),
            wants_body: true,
            takes_gzip,
            has: None,
            keep_alive: true,
        }
    }

    #[test]
    fn a_file_goes_out_as_it_is_stored_to_who_takes_it() {
        let site = site();
        let packed = answer(&site, &request("/a.wasm", true));
        assert!(packed.head.contains("Content-Encoding: gzip\r\n"));
        assert!(packed.head.contains("Content-Type: application/wasm\r\n"));
        let plain = answer(&site, &request("/a.wasm", false));
        assert!(!plain.head.contains("Content-Encoding"));
        assert_eq!(&*plain.body, b"(module)");
        for response in [&packed, &plain] {
            let length = format!("Content-Length: {}\r\n", response.body.len());
            assert!(response.head.contains(&length), "{}", response.head);
            assert!(response.head.contains("Vary: Accept-Encoding\r\n"));
        }
        assert!(!answer(&site, &request("/", true)).head.contains("Vary"));
    }

    #[test]
    fn tags_are_compared_weakly() {
        assert!(
            knows("\"a\", W/\"b\"", "W/\"b\"")
                && knows("\"b\"", "W/\"b\"")
                && knows("*", "W/\"b\"")
        );
        assert!(!knows("\"a\"", "W/\"b\"") && !knows("", "W/\"b\""));
    }
}
