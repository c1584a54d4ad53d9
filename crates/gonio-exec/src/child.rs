//! A running process behind three pipes, none of which can block the caller.
//!
//! A thread a pipe: one writes questions, one reads answers, one keeps the tail of standard error. So a process that answers
//! before it has read a long question, that floods its standard error, or that neither reads nor writes, can't lock up with us:
//! the caller waits on one channel, with a time limit.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::process::{Child as Handle, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use crate::command::CommandLine;

/// Bytes read at once.
const CHUNK: usize = 1 << 16;
/// Chunks that may wait for the caller: a process that writes without end blocks, and takes no memory.
const WAITING: usize = 16;
/// Bytes of standard error that are kept.
const TAIL_BYTES: usize = 1 << 14;
/// Lines of it that are told, and characters of a line.
const TAIL_LINES: usize = 12;
const TAIL_WIDTH: usize = 200;
/// How long a process may take to end by itself after its input has, and to be gone after its output has.
pub(crate) const GRACE: Duration = Duration::from_secs(2);

/// What happened on the pipes.
pub(crate) enum Event {
    /// Bytes came.
    Bytes(Vec<u8>),
    /// It writes no more.
    OutputClosed,
    /// It reads no more.
    InputClosed,
    /// Nothing happened until the deadline.
    Late,
}

/// A running process.
pub(crate) struct Child {
    handle: Handle,
    /// `None`: its input was closed.
    questions: Option<Sender<Vec<u8>>>,
    events: Receiver<Event>,
    tail: Arc<Mutex<VecDeque<u8>>>,
    /// Gives an error when standard error was read to its end.
    tail_ended: Receiver<()>,
    ended: Option<ExitStatus>,
}

/// Ends a process from elsewhere, such as the handler of an interrupt.
#[derive(Debug, Clone, Copy)]
pub struct Killer {
    #[cfg_attr(
        not(unix),
        expect(
            dead_code,
            reason = "elsewhere an interrupt reaches the process by itself"
        )
    )]
    id: u32,
}

impl Killer {
    /// Ends the process and what it has started, at once. Nothing happens if there is none.
    pub fn kill(self) {
        #[cfg(unix)]
        if let Some(id) = i32::try_from(self.id)
            .ok()
            .and_then(rustix::process::Pid::from_raw)
        {
            // An error means that it is gone.
            let _ = rustix::process::kill_process_group(id, rustix::process::Signal::KILL);
        }
    }
}

impl Child {
    /// Starts the program, in a process group of its own where the system has such.
    pub(crate) fn start(line: &CommandLine) -> io::Result<Self> {
        let mut command = Command::new(line.program());
        command
            .args(line.arguments())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        // So that what it starts (a shell's children, a launcher's interpreter) can be ended with it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut handle = command.spawn()?;
        let missing = || io::Error::other("a pipe is missing");
        let stdin = handle.stdin.take().ok_or_else(missing)?;
        let stdout = handle.stdout.take().ok_or_else(missing)?;
        let stderr = handle.stderr.take().ok_or_else(missing)?;

        let (questions, asked) = channel::<Vec<u8>>();
        let (to_caller, events) = sync_channel(WAITING);
        let tail = Arc::new(Mutex::new(VecDeque::new()));
        let (tail_alive, tail_ended) = channel();
        thread::spawn({
            let to_caller = to_caller.clone();
            move || write(stdin, &asked, &to_caller)
        });
        thread::spawn(move || read(stdout, &to_caller));
        thread::spawn({
            let tail = Arc::clone(&tail);
            move || {
                keep_tail(stderr, &tail);
                drop(tail_alive);
            }
        });
        Ok(Self {
            handle,
            questions: Some(questions),
            events,
            tail,
            tail_ended,
            ended: None,
        })
    }

    pub(crate) fn killer(&self) -> Killer {
        Killer {
            id: self.handle.id(),
        }
    }

    /// Hands bytes to the thread that writes. Failure to write them is an [`Event`].
    pub(crate) fn send(&self, bytes: Vec<u8>) {
        if let Some(questions) = &self.questions {
            // The thread ends only after it has reported why.
            let _ = questions.send(bytes);
        }
    }

    /// What happens next.
    pub(crate) fn wait(&self, deadline: Instant) -> Event {
        let left = deadline.saturating_duration_since(Instant::now());
        match self.events.recv_timeout(left) {
            Ok(event) => event,
            Err(RecvTimeoutError::Timeout) => Event::Late,
            Err(RecvTimeoutError::Disconnected) => Event::OutputClosed,
        }
    }

    /// The exit status, if the process ends within a short time.
    pub(crate) fn status(&mut self) -> Option<ExitStatus> {
        let deadline = Instant::now() + GRACE;
        let mut pause = Duration::from_micros(200);
        while self.ended.is_none() {
            // An error means that there is no such child any more.
            self.ended = self.handle.try_wait().ok()?;
            if Instant::now() >= deadline {
                break;
            }
            if self.ended.is_none() {
                thread::sleep(pause);
                pause = (pause * 2).min(Duration::from_millis(20));
            }
        }
        self.ended
    }

    /// Closes its input, which asks the process to end, and makes sure that it has.
    pub(crate) fn finish(&mut self) {
        self.questions = None;
        if self.status().is_none() {
            self.kill();
        }
    }

    /// Ends it at once.
    pub(crate) fn kill(&mut self) {
        if self.ended.is_some() {
            return;
        }
        self.killer().kill();
        // For systems without process groups. An error means that it has ended.
        let _ = self.handle.kill();
        self.ended = self.handle.wait().ok();
    }

    /// The last lines of its standard error.
    pub(crate) fn last_words(&self) -> Vec<String> {
        // What a process wrote before it ended may still be in the pipe; a child of its own may keep the pipe open.
        let _ = self.tail_ended.recv_timeout(Duration::from_millis(300));
        let bytes: Vec<u8> = {
            let tail = self.tail.lock().unwrap_or_else(PoisonError::into_inner);
            tail.iter().copied().collect()
        };
        lines(&bytes)
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.questions = None;
        self.kill();
    }
}

fn write(mut stdin: impl Write, asked: &Receiver<Vec<u8>>, to_caller: &SyncSender<Event>) {
    while let Ok(bytes) = asked.recv() {
        if stdin
            .write_all(&bytes)
            .and_then(|()| stdin.flush())
            .is_err()
        {
            // The caller may be gone.
            let _ = to_caller.send(Event::InputClosed);
            return;
        }
    }
}

fn read(mut stdout: impl Read, to_caller: &SyncSender<Event>) {
    let mut chunk = vec![0; CHUNK];
    loop {
        match stdout.read(&mut chunk) {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Ok(0) | Err(_) => break,
            Ok(n) => {
                if to_caller.send(Event::Bytes(chunk[..n].to_vec())).is_err() {
                    return;
                }
            }
        }
    }
    let _ = to_caller.send(Event::OutputClosed);
}

fn keep_tail(mut stderr: impl Read, tail: &Mutex<VecDeque<u8>>) {
    let mut chunk = vec![0; CHUNK];
    loop {
        match stderr.read(&mut chunk) {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Ok(0) | Err(_) => return,
            Ok(n) => {
                let mut tail = tail.lock().unwrap_or_else(PoisonError::into_inner);
                tail.extend(&chunk[..n]);
                let excess = tail.len().saturating_sub(TAIL_BYTES);
                tail.drain(..excess);
            }
        }
    }
}

/// The last lines, cut to a readable width, with control characters replaced: they could rewrite a terminal.
fn lines(bytes: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(bytes);
    let mut last: Vec<String> = text
        .lines()
        .rev()
        .filter(|line| !line.trim().is_empty())
        .take(TAIL_LINES)
        .map(|line| {
            let mut shown: String = line
                .trim_end()
                .chars()
                .take(TAIL_WIDTH)
                .map(|c| match c {
                    '\t' => ' ',
                    c if c.is_control() => '\u{fffd}',
                    c => c,
                })
                .collect();
            if line.trim_end().chars().count() > TAIL_WIDTH {
                shown.push('…');
            }
            shown
        })
        .collect();
    last.reverse();
    last
}

/// An exit status in words.
pub(crate) fn in_words(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("killed by signal {signal}");
    }
    match status.code() {
        Some(code) => format!("exit status {code}"),
        None => "without an exit status".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_words_are_few_and_harmless() {
        assert_eq!(lines(b""), Vec::<String>::new());
        assert_eq!(lines(b"a\n\n\tb\x1b[2J\r\n"), ["a", " b\u{fffd}[2J"]);
        let many: String = (0..100).map(|k| format!("line {k}\n")).collect();
        let kept = lines(many.as_bytes());
        assert_eq!((kept.len(), kept[0].as_str()), (TAIL_LINES, "line 88"));
        let wide = &lines("x".repeat(5000).as_bytes())[0];
        assert_eq!(wide.chars().count(), TAIL_WIDTH + 1);
        assert!(wide.ends_with('…'));
        assert_eq!(lines(&[0xff, b'\n']), ["\u{fffd}"]);
    }

    #[test]
    fn a_flood_is_kept_to_its_end() {
        let tail = Mutex::new(VecDeque::new());
        let flood = [vec![b'x'; 10 * TAIL_BYTES], b"the end".to_vec()].concat();
        keep_tail(flood.as_slice(), &tail);
        let tail: Vec<u8> = tail.into_inner().unwrap().into();
        assert_eq!(tail.len(), TAIL_BYTES);
        assert!(tail.ends_with(b"the end"));
    }
}
