//! The command line.

pub mod args;
mod compare;
mod fixtures;
mod info;
mod output;
mod progress;
mod reference;
mod render;
mod report;
mod sweep;
pub(crate) mod view;

use crate::error::Result;
use args::{Cli, Command};

/// Runs one command.
pub fn run(cli: Cli) -> Result<()> {
    match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Reference(args) => reference::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Fixtures { directory } => fixtures::run(&directory),
    }
}
