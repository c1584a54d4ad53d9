//! HTTP/1.1 for one page and the browser on the same machine. Threads, time and memory are bounded, whatever is sent.

use super::request::{LONGEST_HEAD, Refusal, TOO_LONG, TOO_SLOW, parse};
use super::response::{Response, answer, refusal};
use super::site::Site;
use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Connections that are served at a time; browsers open six.
const THREADS: usize = 24;
/// A connection without a request is closed after this time, and a request has to arrive within it.
const REQUEST_TIME: Duration = Duration::from_secs(5);
/// Within this time a body has to be taken.
const BODY_TIME: Duration = Duration::from_secs(60);
/// What is written at a time.
const PIECE: usize = 64 << 10;

/// Serves the site from now on.
///
/// # Errors
/// If the system starts no threads.
pub(super) fn start(listener: TcpListener, port: u16, site: Site) -> std::io::Result<()> {
    let (listener, site) = (Arc::new(listener), Arc::new(site));
    for _ in 0..THREADS {
        let (listener, site) = (listener.clone(), site.clone());
        std::thread::Builder::new()
            .name("explore".into())
            .spawn(move || {
                loop {
                    match listener.accept() {
                        // What goes wrong with one connection is the end of that one.
                        Ok((stream, _)) => drop(serve(&stream, port, &site)),
                        // The system is short of something: it may pass.
                        Err(_) => std::thread::sleep(Duration::from_millis(100)),
                    }
                }
            })?;
    }
    Ok(())
}

/// Answers the requests of a connection, one after the other.
fn serve(stream: &TcpStream, port: u16, site: &Site) -> std::io::Result<()> {
    stream.set_nodelay(true)?;
    let mut buffer = Vec::new();
    loop {
        let end = match read_head(stream, &mut buffer)? {
            Head::Whole(end) => end,
            Head::Closed => return Ok(()),
            Head::Refused(why) => return turn_away(stream, why),
        };
        let request = match parse(&buffer[..end], port) {
            Ok(request) => request,
            Err(why) => return turn_away(stream, why),
        };
        buffer.drain(..end);
        send(stream, &answer(site, &request))?;
        if !request.keep_alive {
            return stream.shutdown(Shutdown::Both);
        }
    }
}

enum Head {
    /// It is there, and has this many bytes.
    Whole(usize),
    Closed,
    Refused(Refusal),
}

/// Reads until `buffer` holds the head of a request.
fn read_head(mut stream: &TcpStream, buffer: &mut Vec<u8>) -> std::io::Result<Head> {
    let end = Instant::now() + REQUEST_TIME;
    loop {
        if let Some(at) = buffer.windows(4).position(|w| w == b"\r\n\r\n") {
            return Ok(Head::Whole(at + 4));
        }
        if buffer.len() >= LONGEST_HEAD {
            return Ok(Head::Refused(TOO_LONG));
        }
        let left = end.saturating_duration_since(Instant::now());
        let late = match buffer.is_empty() {
            true => Head::Closed,
            false => Head::Refused(TOO_SLOW),
        };
        if left.is_zero() {
            return Ok(late);
        }
        stream.set_read_timeout(Some(left))?;
        let mut piece = [0; 2048];
        let room = piece.len().min(LONGEST_HEAD - buffer.len());
        match stream.read(&mut piece[..room]) {
            Ok(0) => return Ok(Head::Closed),
            Ok(count) => buffer.extend(&piece[..count]),
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                return Ok(late);
            }
            Err(e) => return Err(e),
        }
    }
}

fn send(mut stream: &TcpStream, response: &Response) -> std::io::Result<()> {
    let end = Instant::now() + BODY_TIME;
    let pieces = std::iter::once(response.head.as_bytes()).chain(response.body.chunks(PIECE));
    for mut piece in pieces {
        while !piece.is_empty() {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ErrorKind::TimedOut.into());
            }
            stream.set_write_timeout(Some(left))?;
            match stream.write(piece) {
                Ok(count) => piece = &piece[count..],
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
    }
    Ok(())
}

/// Says why a request is not answered, and closes.
fn turn_away(mut stream: &TcpStream, why: Refusal) -> std::io::Result<()> {
    send(stream, &refusal(why, true, false))?;
    stream.shutdown(Shutdown::Write)?;
    // A connection that is closed while something is unread is reset, and the answer may be lost on its way: some more is read.
    stream.set_read_timeout(Some(Duration::from_millis(200)))?;
    let end = Instant::now() + Duration::from_secs(1);
    let mut waste = [0; 4096];
    while Instant::now() < end && stream.read(&mut waste)? > 0 {}
    Ok(())
}
