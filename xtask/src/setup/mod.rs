//! `cargo xtask setup`: look at the machine, decide, act. Only [`machine`] looks and only this file acts.

mod machine;
mod plan;

use crate::command;
use anyhow::{Context, Result, bail};
use machine::Machine;
use plan::{Action, Plan};
use std::io::IsTerminal;

#[derive(clap::Args, Default)]
pub struct Options {
    /// Also install what the tests use: Vulkan validation layers, a virtual display, rustfmt, clippy
    #[arg(long)]
    pub tests: bool,
    /// Install the software driver (lavapipe) even though there is a GPU driver
    #[arg(long)]
    pub software: bool,
}

pub fn run(options: &Options) -> Result<()> {
    if options.tests {
        install_rust_components()?;
    }
    match plan::decide(&Machine::inspect(), options)? {
        Plan::Ready(driver) => println!("Ready: {driver}"),
        Plan::Advise(advice) => println!("{advice}"),
        Plan::Install(actions) => {
            install(&actions)?;
            match plan::decide(&Machine::inspect(), options)? {
                Plan::Ready(driver) => println!("Ready: {driver}"),
                _ => bail!("{}", plan::TOO_OLD),
            }
        }
    }
    Ok(())
}

fn install_rust_components() -> Result<()> {
    for (component, subcommand) in [("rustfmt", "fmt"), ("clippy", "clippy")] {
        if !command::succeeds(command::cargo().args([subcommand, "--version"])) {
            command::run(command::program("rustup").args(["component", "add", component]))
                .with_context(|| format!("the tests need {component}"))?;
        }
    }
    Ok(())
}

fn install(actions: &[Action]) -> Result<()> {
    let Some(prefix) = become_root() else {
        for action in actions {
            println!("{}", action.shell("sudo "));
        }
        bail!("setup needs root: run the commands above, then this again");
    };
    for action in actions {
        let mut argv = prefix.iter().copied().chain(action.argv.iter().map(String::as_str));
        let mut command = command::program(argv.next().unwrap_or_default());
        command.args(argv);
        match &action.stdin {
            Some(text) => command::run_with_input(&mut command, text)?,
            None => command::run(&mut command)?,
        }
    }
    Ok(())
}

/// The words in front of a command that make it run as root; `None` when there is no way without a person.
fn become_root() -> Option<&'static [&'static str]> {
    if command::try_output(command::program("id").arg("-u")).is_some_and(|id| id.trim() == "0") {
        Some(&[])
    } else if command::succeeds(command::program("sudo").args(["-n", "true"])) {
        Some(&["sudo", "-n"])
    } else if std::io::stdin().is_terminal() && command::succeeds(command::program("sudo").arg("--version")) {
        Some(&["sudo"])
    } else {
        None
    }
}
