//! Every chore has one command: `cargo xtask setup`, `demo`, `test`, `shaders`, `models`, `fixtures`, `bench`, `results`,
//! `docs`, `site`, `fuzz`.

mod checks;
mod command;
mod models;
mod setup;
mod shaders;
mod site;
mod stills;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Candela's chores: set-up, demo, tests, shaders, models")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Make this machine able to run Candela: a Vulkan loader and a driver that traces rays
    Setup(setup::Options),
    /// Set up, then render the atrium to out/atrium.png
    Demo,
    /// Set up, then check format, lints and tests; stops at the first failure
    Test,
    /// Compile the shaders to assets/shaders
    Shaders {
        /// Rebuild and compare with the committed bytes instead of replacing them
        #[arg(long)]
        check: bool,
    },
    /// Download CC0 test models to models/
    Models,
    /// Write the test scenes to assets/scenes
    Fixtures,
    /// Measure the rows of docs/performance.md on this machine: a Markdown table, and out/bench/points.json
    Bench,
    /// Feed every reader with wrong files; what breaks one goes to out/fuzz (`--help` after `--` says more)
    Fuzz {
        #[arg(last = true)]
        arguments: Vec<String>,
    },
    /// Fill the tables of docs/results.md from docs/results
    Results,
    /// Fill the tables of docs/command-line.md from the program
    Docs,
    /// Build the pages and the API's documentation as a site in target/site/book; a broken link fails
    Site,
}

fn main() -> ExitCode {
    match run(Cli::parse().task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: Task) -> Result<()> {
    match task {
        Task::Setup(options) => setup::run(&options),
        Task::Demo => demo(),
        Task::Test => checks::run(),
        Task::Shaders { check } => shaders::run(check),
        Task::Models => models::run(),
        Task::Fixtures => candela(&["fixtures", "assets/scenes"]),
        Task::Bench => candela(&["sweep", "bench", "-o", "out/bench"]),
        Task::Site => site::run(),
        Task::Docs => candela(&["page", "docs/command-line.md"]),
        Task::Fuzz { arguments } => {
            let fuzz = ["run", "-p", "tests", "--bin", "fuzz", "--"];
            command::run(command::cargo().args(fuzz).args(arguments))
        }
        Task::Results => candela(&["report", "docs/results", "--markdown", "docs/results.md"]),
    }
}

fn demo() -> Result<()> {
    setup::run(&setup::Options::default())?;
    let out = command::root().join("out");
    std::fs::create_dir_all(&out).with_context(|| format!("can't create {}", out.display()))?;
    // Small and through pixels' centers, which are drawn: rays of processors are slow.
    let picture = ["--size", "960x540", "--frames", "32", "--pixel-centers"];
    candela(&[&["render", "--denoise"], &picture[..], &["-o", "out/atrium.png"]].concat())?;
    println!(
        "{} shows the atrium, lit by 500 lights: 32 frames, denoised.",
        out.join("atrium.png").display()
    );
    Ok(())
}

fn candela(args: &[&str]) -> Result<()> {
    let run = ["run", "--release", "-p", "candela-cli", "--"];
    command::run(command::cargo().args(run).args(args))
}
