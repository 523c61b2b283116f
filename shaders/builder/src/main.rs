//! `shader-builder [--check]`: compiles the shaders into assets/shaders; with `--check` only compares the bytes.

use anyhow::{Context, Result, bail};
use shader_builder::manifest::{Manifest, Toolchain};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

/// Set for the process that compiles; the other one reads what it says.
const COMPILING: &str = "CANDELA_SHADERS_COMPILING";

fn main() -> ExitCode {
    let compile_only = std::env::var_os(COMPILING).is_some();
    let result =
        if compile_only { compile().map(|_| ()) } else { compile_quietly().and_then(|_| write_or_check()) };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Compiles in a process of its own and fails on any warning: a shader that the optimiser or the validator complains of
/// would otherwise be taken unoptimised.
fn compile_quietly() -> Result<()> {
    let program = std::env::current_exe().context("can't find the own program")?;
    let mut child = Command::new(program)
        .args(std::env::args_os().skip(1))
        .env(COMPILING, "1")
        .stderr(Stdio::piped())
        .spawn()
        .context("can't start the compilation")?;
    let mut warnings = 0;
    for line in child.stderr.take().map(BufReader::new).into_iter().flat_map(BufRead::lines) {
        let line = line?;
        warnings += u32::from(line.trim_start().starts_with("warning"));
        eprintln!("{line}");
    }
    if !child.wait()?.success() {
        bail!("the shaders do not compile");
    }
    if warnings > 0 {
        bail!("{warnings} warnings while compiling the shaders; nothing was written");
    }
    Ok(())
}

fn compile() -> Result<BTreeMap<String, Vec<u8>>> {
    shader_builder::compile(workspace(), &Toolchain::from_environment()?)
}

/// After a clean compilation: its result comes from the compiler's cache.
fn write_or_check() -> Result<()> {
    let check = match std::env::args().nth(1).as_deref() {
        None => false,
        Some("--check") => true,
        Some(other) => bail!("unknown argument '{other}'; usage: shader-builder [--check]"),
    };
    let modules = compile()?;
    let manifest = Manifest::new(workspace(), &Toolchain::from_environment()?, &modules)?;
    if check {
        if Manifest::read(workspace())?.modules != manifest.modules {
            bail!("assets/shaders is not what the sources compile to; run `cargo xtask shaders`");
        }
        println!("{} shader modules are up to date", modules.len());
    } else {
        shader_builder::write(workspace(), &modules, &manifest)?;
        println!("wrote {} shader modules to assets/shaders", modules.len());
    }
    Ok(())
}

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap_or(Path::new("."))
}
