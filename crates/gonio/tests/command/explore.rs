//! `gonio explore`: what its server answers, and what it refuses. The page is a small one of these tests' own.

use crate::support::Place;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A running server, which ends with the test.
struct Explorer {
    process: Child,
    port: u16,
    /// The site's folder and a file beside it.
    place: Place,
}

/// An answer: status code, head, body.
struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Explorer {
    fn start() -> Self {
        let place = Place::new();
        std::fs::create_dir_all(place.path().join("dist/assets")).unwrap();
        for (name, text) in [
            ("dist/index.html", "<!doctype html><title>page</title>"),
            ("dist/sw.js", "self.x = 1"),
            ("dist/gonio.wasm", "\0asm"),
            ("dist/assets/index-Bx3kQ9_d.js", "export {}"),
            ("dist/assets/style-12345678.css", "p {}"),
            ("dist/assets/icon.svg", "<svg/>"),
            ("dist/assets/dawn.hdr", "#?RADIANCE"),
            ("secret.txt", "secret"),
        ] {
            place.write(name, text);
        }
        #[cfg(unix)]
        std::os::unix::fs::symlink("../secret.txt", place.path().join("dist/link.txt")).unwrap();
        let mut process = place
            .command(&["explore", "--port", "0", "--no-open", "--site", "dist"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut address = String::new();
        BufReader::new(process.stdout.as_mut().unwrap())
            .read_line(&mut address)
            .unwrap();
        let port = address
            .trim()
            .strip_prefix("http://127.0.0.1:")
            .and_then(|rest| rest.strip_suffix('/'))
            .unwrap_or_else(|| panic!("no address: {address:?}"))
            .parse()
            .unwrap();
        Self {
            process,
            port,
            place,
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(60)))
            .unwrap();
        stream
    }

    /// What these bytes are answered. The server may close before it has taken all of them.
    fn raw(&self, bytes: &[u8]) -> Answer {
        let mut stream = self.connect();
        let _ = stream.write_all(bytes);
        let mut all = Vec::new();
        let _ = stream.read_to_end(&mut all);
        answer(&all)
    }

    /// What a request of this path with these further headers is answered.
    fn ask(&self, method: &str, path: &str, headers: &str) -> Answer {
        let port = self.port;
        self.raw(
            format!("{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n{headers}\r\n").as_bytes(),
        )
    }

    fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, "")
    }
}

impl Drop for Explorer {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn answer(bytes: &[u8]) -> Answer {
    let at = bytes
        .windows(4)
        .position(|w| w == b"\r\n\r\n")
        .unwrap_or_else(|| panic!("no answer: {:?}", String::from_utf8_lossy(bytes)));
    let head = String::from_utf8(bytes[..at].to_vec()).unwrap();
    Answer {
        status: head.split(' ').nth(1).unwrap().parse().unwrap(),
        head,
        body: bytes[at + 4..].to_vec(),
    }
}

impl Answer {
    fn header(&self, name: &str) -> Option<&str> {
        let mut headers = self.head.lines().filter_map(|l| l.split_once(": "));
        headers.find_map(|(n, value)| n.eq_ignore_ascii_case(name).then_some(value))
    }
}

#[test]
fn files_go_out_with_their_type_and_how_long_they_keep() {
    let explorer = Explorer::start();
    const FOREVER: &str = "public, max-age=31536000, immutable";
    for (path, kind, keep) in [
        ("/", "text/html; charset=utf-8", "no-cache"),
        ("/index.html", "text/html; charset=utf-8", "no-cache"),
        ("/?a=../b", "text/html; charset=utf-8", "no-cache"),
        ("/sw.js", "text/javascript; charset=utf-8", "no-cache"),
        ("/gonio.wasm", "application/wasm", "no-cache"),
        (
            "/assets/index-Bx3kQ9_d.js",
            "text/javascript; charset=utf-8",
            FOREVER,
        ),
        (
            "/assets/style-12345678.css",
            "text/css; charset=utf-8",
            FOREVER,
        ),
        ("/assets/icon.svg", "image/svg+xml", "no-cache"),
        ("/assets/dawn.hdr", "application/octet-stream", "no-cache"),
    ] {
        let got = explorer.get(path);
        assert_eq!(got.status, 200, "{path}");
        assert_eq!(got.header("content-type"), Some(kind), "{path}");
        assert_eq!(got.header("cache-control"), Some(keep), "{path}");
        let length = got.body.len().to_string();
        assert_eq!(got.header("content-length"), Some(&*length), "{path}");
        // The browser has it already.
        let tag = got.header("etag").unwrap();
        let again = explorer.ask("GET", path, &format!("If-None-Match: {tag}\r\n"));
        assert_eq!((again.status, again.body.len()), (304, 0), "{path}");
        let other = explorer.ask("GET", path, "If-None-Match: \"other\"\r\n");
        assert_eq!((other.status, other.body), (200, got.body), "{path}");
        let head = explorer.ask("HEAD", path, "");
        assert_eq!((head.status, head.body.len()), (200, 0), "{path}");
        assert_eq!(head.header("content-length"), Some(&*length), "{path}");
    }
    assert_eq!(explorer.get("/gonio.wasm").body, b"\0asm");
}

#[test]
fn every_answer_keeps_the_page_to_itself() {
    let explorer = Explorer::start();
    let answers = [
        explorer.get("/"),
        explorer.get("/none"),
        explorer.ask("POST", "/", ""),
        explorer.raw(b"nonsense\r\n\r\n"),
    ];
    for got in &answers {
        let policy = got.header("content-security-policy").unwrap();
        for part in [
            "default-src 'none'",
            "script-src 'self' 'wasm-unsafe-eval'",
            "connect-src 'self'",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'none'",
        ] {
            assert!(policy.split("; ").any(|p| p.trim() == part), "{policy}");
        }
        assert!(!policy.contains("'unsafe-eval'") && !policy.contains("http"));
        for (name, value) in [
            ("x-content-type-options", "nosniff"),
            ("referrer-policy", "no-referrer"),
            ("cross-origin-opener-policy", "same-origin"),
            ("cross-origin-resource-policy", "same-origin"),
        ] {
            assert_eq!(got.header(name), Some(value));
        }
        assert_eq!(got.header("access-control-allow-origin"), None);
    }
}

#[test]
fn no_path_leads_out_of_the_site() {
    let explorer = Explorer::start();
    assert_eq!(explorer.place.read("secret.txt"), b"secret");
    for path in [
        "/../secret.txt",
        "/assets/../../secret.txt",
        "/%2e%2e/secret.txt",
        "/%2E%2E%2Fsecret.txt",
        "/..%2fsecret.txt",
        "/..%5csecret.txt",
        "/..\\secret.txt",
        "/%252e%252e%252fsecret.txt",
        "/%c0%ae%c0%ae/secret.txt",
        "/%uff0e%uff0e/secret.txt",
        "/....//secret.txt",
        "/./../secret.txt",
        "//secret.txt",
        "/assets/..;/../secret.txt",
        "/index.html/../../secret.txt",
        "/index.html%00.txt",
        "/link.txt",
        "/dist/index.html",
        "/assets",
        "/assets/",
        "/etc/passwd",
        "//etc/passwd",
        "/C:/Windows/win.ini",
        "../secret.txt",
        "file:///etc/passwd",
        "http://example.com/",
        "*",
    ] {
        let got = explorer.get(path);
        assert!(matches!(got.status, 400 | 404), "{path}: {}", got.status);
        let text = String::from_utf8(got.body).unwrap();
        assert!(text.starts_with("The explorer has no such file") || got.status == 400);
        assert!(
            !text.contains("secret") && !text.contains("root:"),
            "{path}"
        );
    }
}

#[test]
fn only_its_own_names_are_answered() {
    let explorer = Explorer::start();
    let port = explorer.port;
    let status = |headers: &str| {
        let request = format!("GET / HTTP/1.1\r\nConnection: close\r\n{headers}\r\n");
        explorer.raw(request.as_bytes()).status
    };
    assert_eq!(status(&format!("Host: 127.0.0.1:{port}\r\n")), 200);
    assert_eq!(status(&format!("Host: LOCALHOST:{port}\r\n")), 200);
    for host in [
        "example.com".to_owned(),
        format!("example.com:{port}"),
        format!("127.0.0.1.example.com:{port}"),
        format!("127.0.0.1:{port}@example.com"),
        format!("localhost:{}", port ^ 1),
        format!("0.0.0.0:{port}"),
        format!("[::1]:{port}"),
        format!("2130706433:{port}"),
        "127.0.0.1".to_owned(),
        String::new(),
    ] {
        assert_eq!(status(&format!("Host: {host}\r\n")), 421, "{host}");
    }
    assert_eq!(status(""), 400);
    let twice = format!("Host: 127.0.0.1:{port}\r\nHost: example.com\r\n");
    assert_eq!(status(&twice), 400);
    // No other address of this machine is listened to.
    #[cfg(target_os = "linux")]
    assert!(TcpStream::connect(("127.0.0.2", port)).is_err());
}

#[test]
fn what_is_no_plain_request_is_refused() {
    let explorer = Explorer::start();
    for method in [
        "POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH", "get",
    ] {
        let got = explorer.ask(method, "/", "");
        assert_eq!(got.status, 405, "{method}");
        assert_eq!(got.header("allow"), Some("GET, HEAD"));
    }
    assert_eq!(
        explorer.ask("GET", "/", "Content-Length: 0\r\n").status,
        200
    );
    for headers in [
        "Content-Length: 5\r\n",
        "Transfer-Encoding: chunked\r\n",
        "No colon\r\n",
        "Space : before\r\n",
        "Folded: a\r\n  b\r\n",
        "Null: \0\r\n",
    ] {
        assert_eq!(explorer.ask("GET", "/", headers).status, 400, "{headers:?}");
    }
    for bytes in [
        &b"\r\n\r\n\r\n\r\n"[..],
        b"GET /\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"\x16\x03\x01\x02\0\x01\0\x01\xfc\r\n\r\n",
        b"\xff\xfe\r\n\r\n",
    ] {
        assert_eq!(explorer.raw(bytes).status, 400, "{bytes:?}");
    }
    let long = "a".repeat(5000);
    assert_eq!(explorer.get(&format!("/{long}")).status, 414);
    assert_eq!(
        explorer
            .ask("GET", "/", &format!("X: {}\r\n", "b".repeat(1 << 20)))
            .status,
        431
    );
    assert_eq!(
        explorer.ask("GET", "/", &"X: y\r\n".repeat(100)).status,
        431
    );
    assert_eq!(explorer.get("/").status, 200);
}

#[test]
fn a_connection_serves_one_request_after_the_other() {
    let explorer = Explorer::start();
    let host = format!("Host: localhost:{}\r\n", explorer.port);
    let mut stream = explorer.connect();
    let three = format!(
        "GET /sw.js HTTP/1.1\r\n{host}\r\nGET /none HTTP/1.1\r\n{host}\r\nGET /gonio.wasm HTTP/1.1\r\n{host}Connection: close\r\n\r\n"
    );
    stream.write_all(three.as_bytes()).unwrap();
    let mut all = String::new();
    stream.read_to_string(&mut all).unwrap();
    let statuses: Vec<&str> = all
        .matches("HTTP/1.1 200")
        .chain(all.matches("HTTP/1.1 404"))
        .collect();
    assert_eq!(statuses.len(), 3, "{all}");
    assert!(all.ends_with("\0asm"), "{all}");
}

#[test]
fn slow_and_silent_ones_are_given_up() {
    let explorer = Explorer::start();
    let start = Instant::now();
    // More than there are threads.
    let silent: Vec<TcpStream> = (0..40).map(|_| explorer.connect()).collect();
    let mut slow = explorer.connect();
    slow.write_all(b"GET / HTTP/1.1\r\nHost: loc").unwrap();
    assert_eq!(explorer.get("/").status, 200);
    let mut all = Vec::new();
    slow.read_to_end(&mut all).unwrap();
    assert_eq!(answer(&all).status, 408);
    for mut stream in silent {
        let mut all = Vec::new();
        stream.read_to_end(&mut all).unwrap();
        assert!(all.is_empty());
    }
    assert!(start.elapsed() < Duration::from_secs(40));
}

#[test]
fn what_can_not_be_served_is_one_error() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("empty")).unwrap();
    let explore = |more: &[&str], words: &[&str]| {
        let arguments = [&["explore", "--no-open", "--port", "0"], more].concat();
        place.bad(&arguments, 3, words);
    };
    explore(
        &["--site", "empty"],
        &["empty", "no index.html", "cargo xtask web"],
    );
    explore(&["--site", "none"], &["none", "cannot read"]);
    place.bad(&["explore", "--port", "65536"], 2, &["65536"]);
    place.write("empty/index.html", "");
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let arguments = ["explore", "--no-open", "--site", "empty", "--port", &port];
    place.bad(&arguments, 3, &[&port, "taken", "--port 0"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it_without_complaint() {
    for signal in ["-INT", "-TERM"] {
        let mut explorer = Explorer::start();
        assert_eq!(explorer.get("/").status, 200);
        let id = explorer.process.id().to_string();
        let status = std::process::Command::new("kill")
            .args([signal, &id])
            .status();
        assert!(status.unwrap().success());
        assert_eq!(explorer.process.wait().unwrap().code(), Some(0));
        let mut said = String::new();
        let err = explorer.process.stderr.as_mut().unwrap();
        err.read_to_string(&mut said).unwrap();
        assert_eq!(said, "note: Ctrl-C ends it\n");
    }
}
