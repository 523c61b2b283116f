//! `candela`: the viewer and the command line.

#[macro_use]
mod stdout;

mod accumulation;
mod args;
mod compare;
mod denoise;
mod explain;
mod export;
mod fixtures;
mod info;
mod output;
mod page;
mod pipelines;
mod progress;
mod reference;
mod render;
mod report;
mod roofline;
mod sequence;
mod sweep;
mod truth;
mod view;
mod window;
mod writer;

use args::{Cli, Command};
use candela::error::Result;
use candela::startup;
use clap::Parser;
use std::process::ExitCode;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::prelude::*;

fn main() -> ExitCode {
    startup::begin();
    // What the user should know even without RUST_LOG.
    let quiet = || Targets::new().with_default(LevelFilter::ERROR).with_target("candela", LevelFilter::WARN);
    let asked = std::env::var("RUST_LOG").ok().and_then(|text| text.parse::<Targets>().ok());
    let messages = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
    tracing_subscriber::registry().with(messages.with_filter(asked.unwrap_or_else(quiet))).init();
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.kind().exit_code())
        }
    }
}

/// Runs the command that the program was started with; ends it where that can't be understood, or asks for help.
fn run() -> Result<()> {
    // Help is one of the answers, and goes to standard output.
    let cli = Cli::try_parse().unwrap_or_else(|answer| match answer.print() {
        Ok(()) => std::process::exit(answer.exit_code()),
        Err(error) => crate::stdout::give_up(&error),
    });
    if cli.timings() {
        startup::report();
    }
    let Some(command) = cli.command else { return window::run(&cli.view) };
    match command {
        Command::View(args) => window::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Reference(args) => reference::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Denoise(args) => denoise::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Roofline(args) => roofline::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Page { page } => page::update(&page),
        Command::Fixtures { directory } => fixtures::run(&directory),
    }
}
