//! Starts a program, reads its output, and stops it when it takes too long.

use crate::solvers::external::Failure;
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
}

/// An event that one of the two reader threads reports.
enum Event {
    /// The whole of stdout, or one byte more than the limit.
    Stdout(std::io::Result<Vec<u8>>),
    /// stderr is closed.
    Stderr,
}

/// Runs the words as program and arguments, in the working directory, without a shell and without
/// input. Its stderr is passed on as it comes; its stdout is read up to `limit` bytes.
///
/// # Errors
/// Fails unless the program ends with exit code 0 in time. After a failure none of its descendants is left running,
/// as far as they can be found.
pub fn run(words: &[OsString], timeout: Duration, limit: usize) -> Result<Finished, Failure> {
    let (program, arguments) = words.split_first().ok_or(Failure::Silent)?;
    let start = Instant::now();
    let mut child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|cause| not_started(program, cause))?;
    let deadline = Deadline { start, timeout };
    let watched = watch(&mut child, &deadline, limit);
    let seconds = start.elapsed().as_secs_f64();
    let (stdout, status) = watched.inspect_err(|_| kill(&mut child))?;
    judged(status)?;
    Ok(Finished { stdout, seconds })
}

fn not_started(program: &OsString, cause: std::io::Error) -> Failure {
    let program = program.to_string_lossy().into_owned();
    match cause.kind() {
        ErrorKind::NotFound => Failure::NotFound { program },
        _ => Failure::NotStarted { program, cause },
    }
}

/// Waits until both streams are closed and the program has ended.
fn watch(
    child: &mut Child,
    deadline: &Deadline,
    limit: usize,
) -> Result<(Vec<u8>, ExitStatus), Failure> {
    let events = listen(child, limit);
    let mut stdout = None;
    let mut errors_open = true;
    while stdout.is_none() || errors_open {
        let left = deadline.left(child)?;
        match events.recv_timeout(left) {
            Ok(Event::Stdout(bytes)) => {
                let bytes = bytes.map_err(Failure::io("read its stdout"))?;
                if bytes.len() > limit {
                    return Err(Failure::TooMuch { limit });
                }
                stdout = Some(bytes);
            }
            Ok(Event::Stderr) => errors_open = false,
            // The time is up; `left` returns the error.
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    // A program that has closed its streams usually ends at once.
    let mut pause = Duration::from_micros(50);
    loop {
        let status = child.try_wait();
        if let Some(status) = status.map_err(Failure::io("wait for it"))? {
            return Ok((stdout.unwrap_or_default(), status));
        }
        std::thread::sleep(pause.min(deadline.left(child)?));
        pause = (2 * pause).min(Duration::from_millis(20));
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

struct Deadline {
    start: Instant,
    timeout: Duration,
}

impl Deadline {
    /// The time left, more than 0.
    ///
    /// # Errors
    /// Fails when no time is left. If the program itself has failed and only a stream was kept open, its failure is the
    /// error.
    fn left(&self, child: &mut Child) -> Result<Duration, Failure> {
        match self.timeout.checked_sub(self.start.elapsed()) {
            Some(left) if !left.is_zero() => Ok(left),
            _ => {
                if let Ok(Some(status)) = child.try_wait() {
                    judged(status)?;
                }
                Err(Failure::TimedOut {
                    after: self.timeout,
                })
            }
        }
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

/// Kills the child and its descendants, and waits for the child.
///
/// The child has no process group of its own, since Ctrl-C on the terminal would then not reach it. So the
/// descendants are looked up by `ps` and killed by `kill`, which POSIX both has. Without them,
/// or on other systems, only the child is killed.
fn kill(child: &mut Child) {
    let found = descendants(child.id());
    // An error means that the child has ended already.
    let _ = child.kill();
    let _ = child.wait();
    if !found.is_empty() {
        let _ = quiet("kill")
            .arg("-9")
            .args(found.iter().map(u32::to_string))
            .status();
    }
}

fn quiet(program: &str) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::null()).stderr(Stdio::null());
    command
}

/// The children of a process, their children, and so on, as far as their parents are alive.
fn descendants(root: u32) -> Vec<u32> {
    if !cfg!(unix) {
        return Vec::new();
    }
    let listed = quiet("ps")
        .args(["-A", "-o", "pid=", "-o", "ppid="])
        .output();
    let listed = listed.map(|output| output.stdout).unwrap_or_default();
    let text = String::from_utf8_lossy(&listed);
    let pairs: Vec<(u32, u32)> = text.lines().filter_map(pair).collect();
    let mut found = vec![root];
    let mut at = 0;
    while let Some(&parent) = found.get(at) {
        let children = pairs.iter().filter(|(_, of)| *of == parent);
        for (pid, _) in children {
            if !found.contains(pid) {
                found.push(*pid);
            }
        }
        at += 1;
    }
    found.remove(0);
    found
}

/// Parses a line of `ps`: process and parent.
fn pair(line: &str) -> Option<(u32, u32)> {
    let (pid, parent) = line.trim().split_once(char::is_whitespace)?;
    Some((pid.parse().ok()?, parent.trim().parse().ok()?))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_prints_without_end_is_stopped_at_the_limit() {
        let run = |words: &[&str], limit| {
            let words: Vec<OsString> = words.iter().map(OsString::from).collect();
            run(&words, Duration::from_secs(60), limit)
        };
        let endless = run(&["sh", "-c", "while :; do echo more; done"], 10_000);
        assert!(matches!(endless, Err(Failure::TooMuch { limit: 10_000 })));
        // To the last byte.
        let exact = |limit| run(&["printf", "%s", "12345"], limit);
        assert_eq!(exact(5).expect("five bytes").stdout, b"12345");
        assert!(matches!(exact(4), Err(Failure::TooMuch { .. })));
    }
}
