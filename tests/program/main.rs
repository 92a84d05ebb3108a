//! The program as its users run it: verbs, flags, messages, exit codes, files, and the examples.
//!
//! A new verb, a new flag and a new key of a report belong here.

mod cases;
mod check;
mod command_line;
mod cost;
mod examples;
#[cfg(unix)] // the programs it starts are POSIX's
mod external;
#[cfg(unix)] // the solvers are started as a POSIX shell would
mod gate;
#[cfg(unix)] // signals are POSIX's
mod interrupted;
mod names;
mod report;
mod rest;
mod run;
mod schema;
mod show;
mod stability;
#[path = "../testkit/mod.rs"]
mod testkit;
