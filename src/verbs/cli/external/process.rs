//! Starts a program, reads its output, and stops it when it takes too long.

use crate::solvers::external::Failure;
use crate::verbs::cli::interrupt;
use std::ffi::OsString;
use std::io::{ErrorKind, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// The output of a program that ended with exit code 0.
#[derive(Debug)]
pub struct Finished {
    pub stdout: Vec<u8>,
    /// The wall time from its start to its end, s.
    pub seconds: f64,
    deadline: Deadline,
    /// What of it still runs in the background.
    group: interrupt::Group,
}

/// An event that one of the two reader threads reports.
enum Event {
    /// The whole of stdout, or one byte more than the limit.
    Stdout(std::io::Result<Vec<u8>>),
    /// stderr is closed.
    Stderr,
}

/// What a program wrote before it ended is read at once. A stream that is open for longer is held by something that
/// the program left in the background.
const GRACE: Duration = Duration::from_millis(300);
/// The longest time from one look at the program to the next.
const PAUSE: Duration = Duration::from_millis(20);

/// Runs the words as program and arguments, in the working directory, without a shell and without
/// input. Its stderr is passed on as it comes; its stdout is read up to `limit` bytes. Unless that is `wanted`, what
/// the program leaves in the background may keep it open.
///
/// # Errors
/// Fails unless the program ends with exit code 0 in time. After a failure none of its descendants is left running,
/// as far as they can be found.
pub fn run(
    words: &[OsString],
    timeout: Duration,
    limit: usize,
    wanted: bool,
) -> Result<Finished, Failure> {
    let (program, arguments) = words.split_first().ok_or(Failure::Silent)?;
    let start = Instant::now();
    let mut command = Command::new(program);
    command
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let started = interrupt::start(&mut command);
    let (mut child, group) = started.map_err(|cause| not_started(program, cause))?;
    let deadline = Deadline { start, timeout };
    let watched = watch(&mut child, &deadline, limit, wanted).inspect_err(|_| {
        group.kill();
        // An error means that it has ended already.
        let _ = child.kill();
        let _ = child.wait();
    });
    let (stdout, seconds) = watched?;
    Ok(Finished {
        stdout,
        seconds,
        deadline,
        group,
    })
}

fn not_started(program: &OsString, cause: std::io::Error) -> Failure {
    let program = program.to_string_lossy().into_owned();
    match cause.kind() {
        ErrorKind::NotFound => Failure::NotFound { program },
        _ => Failure::NotStarted { program, cause },
    }
}

/// Waits until the program has ended and both streams are closed, or held in the background only. Returns stdout and
/// the seconds until the program's end.
fn watch(
    child: &mut Child,
    deadline: &Deadline,
    limit: usize,
    wanted: bool,
) -> Result<(Vec<u8>, f64), Failure> {
    let events = listen(child, limit);
    let mut stdout = None;
    let mut errors_open = true;
    let mut ended: Option<(ExitStatus, Instant)> = None;
    // A program that has closed its streams usually ends at once.
    let mut pause = Duration::from_micros(50);
    loop {
        if ended.is_none() {
            let status = child.try_wait().map_err(Failure::io("wait for it"))?;
            ended = status.map(|status| (status, Instant::now()));
        }
        let closed = stdout.is_some() && !errors_open;
        if let Some((status, at)) = ended {
            let complete = stdout.is_some() || !wanted || !status.success();
            if closed || complete && at.elapsed() > GRACE {
                judged(status)?;
                let last = if closed { Instant::now() } else { at };
                let seconds = last.duration_since(deadline.start).as_secs_f64();
                return Ok((stdout.unwrap_or_default(), seconds));
            }
        }
        let after = deadline.timeout;
        let left = deadline.left().ok_or(match ended {
            Some(_) => Failure::Held {
                what: "its stdout",
                after,
            },
            None => Failure::TimedOut { after },
        })?;
        if closed {
            std::thread::sleep(pause.min(left));
            pause = (2 * pause).min(PAUSE);
            continue;
        }
        match events.recv_timeout(PAUSE.min(left)) {
            Ok(Event::Stdout(bytes)) => {
                let bytes = bytes.map_err(Failure::io("read its stdout"))?;
                if bytes.len() > limit {
                    return Err(Failure::TooMuch { limit });
                }
                stdout = Some(bytes);
            }
            Ok(Event::Stderr) => errors_open = false,
            Err(RecvTimeoutError::Timeout) => {}
            // Neither thread reports anything any more.
            Err(RecvTimeoutError::Disconnected) => {
                stdout.get_or_insert_default();
                errors_open = false;
            }
        }
    }
}

/// Starts a reader thread for each stream. The threads are not joined: a descendant of the program may keep
/// a stream open.
fn listen(child: &mut Child, limit: usize) -> Receiver<Event> {
    let (sender, events) = channel();
    if let Some(stdout) = child.stdout.take() {
        let sender = sender.clone();
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            let read = stdout.take(limit as u64 + 1).read_to_end(&mut bytes);
            // Sending fails where the time was up and the receiver is gone.
            let _ = sender.send(Event::Stdout(read.map(|_| bytes)));
        });
    }
    if let Some(stderr) = child.stderr.take() {
        std::thread::spawn(move || pass_on(stderr, &sender));
    }
    events
}

/// Passes the stream on to this program's stderr. It is still read after that is closed, so that the program is
/// never blocked.
fn pass_on(mut stderr: impl Read, sender: &Sender<Event>) {
    let mut buffer = [0; 4096];
    loop {
        match stderr.read(&mut buffer) {
            Ok(0) => break,
            Ok(n) => {
                let _ = std::io::stderr().write_all(&buffer[..n]);
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => break,
        }
    }
    let _ = sender.send(Event::Stderr);
}

#[derive(Debug)]
struct Deadline {
    start: Instant,
    timeout: Duration,
}

impl Deadline {
    /// The time left; None where none is.
    fn left(&self) -> Option<Duration> {
        let left = self.timeout.checked_sub(self.start.elapsed());
        left.filter(|left| !left.is_zero())
    }
}

impl Finished {
    /// What the work returns, in the time that the program has left, and at least a second. The work is left alone
    /// where it does not end.
    ///
    /// # Errors
    /// Fails where the work does, or where it does not end. Then nothing of the program is left running either.
    pub fn within<T: Send + 'static>(
        &self,
        what: &'static str,
        work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        let (sender, done) = channel();
        std::thread::spawn(move || sender.send(work()));
        let left = self.deadline.left().unwrap_or_default();
        let done = done.recv_timeout(left.max(Duration::from_secs(1)));
        done.unwrap_or_else(|_| {
            self.group.kill();
            let after = self.deadline.timeout;
            Err(Failure::Held { what, after })
        })
    }
}

fn judged(status: ExitStatus) -> Result<(), Failure> {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return Err(Failure::Signalled { signal });
    }
    match status.code() {
        Some(0) => Ok(()),
        code => Err(Failure::Exited {
            code: code.unwrap_or(-1),
        }),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_prints_without_end_is_stopped_at_the_limit() {
        let run = |words: &[&str], limit| {
            let words: Vec<OsString> = words.iter().map(OsString::from).collect();
            run(&words, Duration::from_secs(60), limit, true)
        };
        let endless = run(&["sh", "-c", "while :; do echo more; done"], 10_000);
        assert!(matches!(endless, Err(Failure::TooMuch { limit: 10_000 })));
        // To the last byte.
        let exact = |limit| run(&["printf", "%s", "12345"], limit);
        assert_eq!(exact(5).expect("five bytes").stdout, b"12345");
        assert!(matches!(exact(4), Err(Failure::TooMuch { .. })));
    }
}
