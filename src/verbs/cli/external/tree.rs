//! Stops a program and what it started.

use std::process::{Child, Command, Stdio};

/// Kills the child and its descendants, and waits for the child.
///
/// Not a process group of its own: Ctrl-C on the terminal would then pass the program by. So the
/// descendants are looked up, by `ps`, and killed by `kill`, both of which POSIX has. Without them,
/// or on other systems, only the child is killed.
pub fn kill(child: &mut Child) {
    let found = descendants(child.id());
    // An error means that it has ended already.
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

/// Children, their children, and so on, as far as their parents are alive.
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

/// A line of `ps`: process and parent.
fn pair(line: &str) -> Option<(u32, u32)> {
    let (pid, parent) = line.trim().split_once(char::is_whitespace)?;
    Some((pid.parse().ok()?, parent.trim().parse().ok()?))
}
