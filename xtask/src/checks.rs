//! `cargo xtask test`: all that must hold before a change is merged, the quick checks first.

use crate::{command, setup, stills};
use anyhow::{Context, Result};
use std::time::Instant;

const CHECKS: [(&str, &[&str]); 3] = [
    ("format", &["fmt", "--all", "--check"]),
    ("lints", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]),
    ("tests", &["test", "--workspace"]),
];

pub fn run() -> Result<()> {
    let start = Instant::now();
    timed("setup", || setup::run(&setup::Options { tests: true, ..Default::default() }))?;
    for (name, args) in CHECKS {
        timed(name, || command::run(command::cargo().args(args)))?;
    }
    timed("stills", stills::test)?;
    println!("All checks passed ({:.1} s)", start.elapsed().as_secs_f32());
    Ok(())
}

fn timed(name: &str, check: impl FnOnce() -> Result<()>) -> Result<()> {
    let start = Instant::now();
    let outcome = check();
    let verdict = if outcome.is_ok() { "passed" } else { "FAILED" };
    println!("{name}: {verdict} ({:.1} s)", start.elapsed().as_secs_f32());
    outcome.with_context(|| format!("check '{name}'"))
}
