//! What a browser asks for, and why some of it is refused.

/// A request is not longer than this, its path not longer than that, and it has not more headers.
pub(super) const LONGEST_HEAD: usize = 16 << 10;
const LONGEST_PATH: usize = 4 << 10;
const MOST_HEADERS: usize = 64;

/// A request that is answered.
#[derive(Debug, PartialEq)]
pub(super) struct Request {
    /// Without the query.
    pub path: String,
    /// GET; otherwise it is HEAD.
    pub wants_body: bool,
    pub takes_gzip: bool,
    /// The tags of what the browser has already.
    pub has: Option<String>,
    pub keep_alive: bool,
}

/// A status code, its reason phrase, and a sentence for the person who reads it.
#[derive(Debug, PartialEq, Clone, Copy)]
pub(super) struct Refusal {
    pub status: &'static str,
    pub text: &'static str,
}

const fn refuse<T>(status: &'static str, text: &'static str) -> Result<T, Refusal> {
    Err(Refusal { status, text })
}

pub(super) const NOT_FOUND: Refusal = Refusal {
    status: "404 Not Found",
    text: "The explorer has no such file.",
};
pub(super) const TOO_SLOW: Refusal = Refusal {
    status: "408 Request Timeout",
    text: "The request took too long to arrive.",
};
pub(super) const TOO_LONG: Refusal = Refusal {
    status: "431 Request Header Fields Too Large",
    text: "A request has at most 64 headers and 16384 bytes.",
};
pub(super) const BROKEN: Refusal = Refusal {
    status: "500 Internal Server Error",
    text: "A file in this program is damaged.",
};

/// The request in `head`, which ends with an empty line.
///
/// # Errors
/// If it is not answered.
pub(super) fn parse(head: &[u8], port: u16) -> Result<Request, Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    match parsed.parse(head) {
        Ok(httparse::Status::Complete(_)) => {}
        Err(httparse::Error::TooManyHeaders) => return Err(TOO_LONG),
        _ => return refuse("400 Bad Request", "This is no HTTP request."),
    }
    let target = parsed.path.unwrap_or_default();
    if target.len() > LONGEST_PATH {
        return refuse("414 URI Too Long", "A path has at most 4096 bytes.");
    }
    let named = |name: &'static str| {
        let mine = parsed.headers.iter();
        mine.filter(move |h| h.name.eq_ignore_ascii_case(name))
    };
    // A page of another site that has its name point to this machine sends its own name here: it gets nothing.
    let mut hosts = named("host");
    match (hosts.next(), hosts.next()) {
        (Some(host), None) if is_ours(host.value, port) => {}
        (Some(_), None) => {
            return refuse(
                "421 Misdirected Request",
                "The explorer answers to 127.0.0.1 and localhost only.",
            );
        }
        _ => return refuse("400 Bad Request", "A request has one Host header."),
    }
    let wants_body = match parsed.method {
        Some("GET") => true,
        Some("HEAD") => false,
        _ => return refuse("405 Method Not Allowed", "The explorer knows GET and HEAD."),
    };
    let has_body = named("transfer-encoding").next().is_some()
        || named("content-length").any(|h| h.value != b"0");
    if has_body {
        return refuse("400 Bad Request", "The explorer takes no body.");
    }
    if !target.starts_with('/') {
        return refuse("400 Bad Request", "A path begins with '/'.");
    }
    let text = |name| named(name).filter_map(|h| std::str::from_utf8(h.value).ok());
    let has_word = |name, word: &str| {
        text(name).any(|value| {
            value
                .split(',')
                .any(|w| w.trim().eq_ignore_ascii_case(word))
        })
    };
    Ok(Request {
        path: target.split(['?', '#']).next().unwrap_or_default().into(),
        wants_body,
        takes_gzip: text("accept-encoding").any(takes_gzip),
        has: text("if-none-match").next().map(str::to_owned),
        keep_alive: match parsed.version {
            Some(1) => !has_word("connection", "close"),
            _ => false,
        },
    })
}

fn is_ours(host: &[u8], port: u16) -> bool {
    let Ok(host) = std::str::from_utf8(host) else {
        return false;
    };
    ["127.0.0.1", "localhost"].iter().any(|name| {
        host.eq_ignore_ascii_case(&format!("{name}:{port}"))
            // Browsers leave HTTP's own port out.
            || (port == 80 && host.eq_ignore_ascii_case(name))
    })
}

/// Whether an `Accept-Encoding` takes gzip: named, or by `*`, and not with weight 0.
fn takes_gzip(value: &str) -> bool {
    let weight_of = |name: &str| {
        value.split(',').find_map(|coding| {
            let mut parts = coding.split(';').map(str::trim);
            parts.next()?.eq_ignore_ascii_case(name).then(|| {
                let weight = parts.find_map(|p| p.strip_prefix("q=")?.parse::<f32>().ok());
                weight.unwrap_or(1.0)
            })
        })
    };
    weight_of("gzip").or_else(|| weight_of("*")).unwrap_or(0.0) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(head: &str) -> String {
        match parse(head.as_bytes(), 8464) {
            Ok(request) => request.path,
            Err(refusal) => refusal.status[..3].into(),
        }
    }

    #[test]
    fn hosts() {
        for host in ["127.0.0.1:8464", "localhost:8464", "LocalHost:8464"] {
            assert_eq!(
                status(&format!("GET /a HTTP/1.1\r\nHost: {host}\r\n\r\n")),
                "/a"
            );
        }
        for host in [
            "example.com",
            "example.com:8464",
            "127.0.0.1",
            "localhost:80",
            "localhost.example.com:8464",
            "127.0.0.1:8464.example.com",
            "0.0.0.0:8464",
            "[::1]:8464",
            "user@127.0.0.1:8464",
            "",
        ] {
            let head = format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n");
            assert_eq!(status(&head), "421", "{host}");
        }
        assert_eq!(status("GET / HTTP/1.1\r\n\r\n"), "400");
        let two = "GET / HTTP/1.1\r\nHost: localhost:8464\r\nHost: localhost:8464\r\n\r\n";
        assert_eq!(status(two), "400");
    }

    #[test]
    fn compression_is_negotiated() {
        for value in ["gzip", "br, gzip", "gzip;q=0.1", "*", "GZIP ; q=1"] {
            assert!(takes_gzip(value), "{value}");
        }
        for value in ["", "br", "gzip;q=0", "identity", "*;q=0", "gzip;q=0, *"] {
            assert!(!takes_gzip(value), "{value}");
        }
    }

    #[test]
    fn a_query_is_no_part_of_the_path() {
        let request = parse(
            b"HEAD /a?b=/c HTTP/1.1\r\nHost: localhost:8464\r\nConnection: Close\r\n\r\n",
            8464,
        )
        .unwrap();
        assert_eq!(request.path, "/a");
        assert!(!request.wants_body && !request.keep_alive);
    }
}
