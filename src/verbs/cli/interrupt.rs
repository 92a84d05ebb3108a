//! What a signal that ends the program must not leave behind: temporary files, and other programs that it started.

use indicatif::ProgressBar;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// All that would be left behind.
#[cfg_attr(not(unix), allow(dead_code, reason = "no signal is received there"))]
struct Left {
    /// Temporary files and folders. Those that are gone by now are no matter.
    temporary: Vec<PathBuf>,
    /// Programs that run, each the first of its process group.
    programs: Vec<u32>,
    /// The files whose results are not complete.
    unfinished: Vec<PathBuf>,
    bar: Option<ProgressBar>,
}

static LEFT: Mutex<Left> = Mutex::new(Left {
    temporary: Vec::new(),
    programs: Vec::new(),
    unfinished: Vec::new(),
    bar: None,
});

fn left() -> MutexGuard<'static, Left> {
    // A panic elsewhere leaves the lists as they are.
    LEFT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes a temporary file or folder, which a signal removes.
pub fn remembered<T>(
    make: impl FnOnce() -> std::io::Result<T>,
    path: impl FnOnce(&T) -> &Path,
) -> std::io::Result<T> {
    let mut left = left();
    let made = make()?;
    left.temporary.push(path(&made).to_owned());
    Ok(made)
}

/// States the files whose results are not complete from now on.
pub fn unfinished(files: &[PathBuf]) {
    left().unfinished = files.to_owned();
}

/// States the progress bar that a signal clears.
pub fn shows(bar: Option<ProgressBar>) {
    left().bar = bar;
}

/// A process group that a signal ends, as long as this lives: until all that its program gives has been read.
#[derive(Debug)]
pub struct Group(u32);

/// Starts a program in a process group of its own.
pub fn start(command: &mut Command) -> std::io::Result<(Child, Group)> {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let mut left = left();
    let child = command.spawn()?;
    let group = Group(child.id());
    left.programs.push(group.0);
    Ok((child, group))
}

impl Drop for Group {
    fn drop(&mut self) {
        let mut left = left();
        let at = left.programs.iter().position(|known| *known == self.0);
        at.map(|at| left.programs.swap_remove(at));
    }
}

impl Group {
    /// Kills the program with all that it started itself: its process group, and those that left the group, as far as
    /// `ps` finds them. Elsewhere than on Unix the caller kills the program alone.
    pub fn kill(&self) {
        kill(self.0);
    }
}

#[cfg(unix)]
fn kill(program: u32) {
    use rustix::process::{Pid, Signal, kill_process, kill_process_group};
    let pid = |id: u32| Pid::from_raw(id.try_into().ok()?);
    let found = descendants(program);
    // An error means that it has ended already.
    if let Some(group) = pid(program) {
        let _ = kill_process_group(group, Signal::KILL);
    }
    for descendant in found.into_iter().filter_map(pid) {
        let _ = kill_process(descendant, Signal::KILL);
    }
}

#[cfg(not(unix))]
fn kill(_program: u32) {}

/// The children of a process, their children, and so on, as far as their parents are alive.
#[cfg(unix)]
fn descendants(root: u32) -> Vec<u32> {
    let listed = Command::new("ps")
        .args(["-A", "-o", "pid=", "-o", "ppid="])
        .stdin(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
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
#[cfg(unix)]
fn pair(line: &str) -> Option<(u32, u32)> {
    let (pid, parent) = line.trim().split_once(char::is_whitespace)?;
    Some((pid.parse().ok()?, parent.trim().parse().ok()?))
}

/// Receives Ctrl-C, SIGTERM and SIGHUP from now on. Where signals cannot be received, they end the program as ever.
#[cfg(unix)]
pub fn watch() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut received = vec![SIGINT, SIGTERM];
    // `nohup` has it ignored, and so it stays.
    if !is_ignored(SIGHUP) {
        received.push(SIGHUP);
    }
    if let Ok(mut signals) = signal_hook::iterator::Signals::new(received) {
        std::thread::spawn(move || {
            if let Some(signal) = signals.forever().next() {
                end(signal);
            }
        });
    }
}

#[cfg(not(unix))]
pub fn watch() {}

/// Whether the program was started with this signal ignored, where the system says so.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.unwrap_or(0) >> (signal - 1) & 1 == 1
}

/// Ends the program as a shell expects it, with 128 and the signal's number as exit code.
#[cfg(unix)]
fn end(signal: i32) -> ! {
    // Held to the end: no file is made and no program started meanwhile.
    let left = left();
    if let Some(bar) = &left.bar {
        bar.finish_and_clear();
    }
    left.programs.iter().for_each(|program| kill(*program));
    for path in &left.temporary {
        let _ = match path.is_dir() {
            true => std::fs::remove_dir_all(path),
            false => std::fs::remove_file(path),
        };
    }
    let name = signal_hook::low_level::signal_name(signal).unwrap_or("a signal");
    super::note::note(&format!(
        "ended by {name}{}",
        not_finished(&left.unfinished)
    ));
    std::process::exit(128 + signal);
}

/// The most files that are named.
#[cfg(unix)]
const MAX_NAMED: usize = 3;

#[cfg(unix)]
fn not_finished(files: &[PathBuf]) -> String {
    let names = files.iter().take(MAX_NAMED);
    let mut names: Vec<String> = names.map(|file| file.display().to_string()).collect();
    let more = files.len().saturating_sub(MAX_NAMED);
    if more > 0 {
        names.push(format!("{more} more"));
    }
    match names.is_empty() {
        true => String::new(),
        false => format!(
            "; not finished, and without a report: {}",
            crate::report::words::listed(&names)
        ),
    }
}
