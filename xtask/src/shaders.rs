//! `cargo xtask shaders`: finds (or installs) the rust-gpu compiler, then runs the shader builder.

use crate::command;
use anyhow::{Context, Result, bail};
use std::env;

/// What the shader builder reads: a rustup toolchain's name and the path of librustc_codegen_spirv.
const VARIABLES: [&str; 2] = ["RUST_GPU_TOOLCHAIN", "RUST_GPU_BACKEND"];

pub fn run(check: bool) -> Result<()> {
    let mut builder = command::cargo();
    if !set_by_the_user()? {
        builder.envs(VARIABLES.into_iter().zip(install()?));
    }
    builder.args(["run", "-p", "shader-builder", "--"]).args(check.then_some("--check"));
    command::run(&mut builder)
}

fn set_by_the_user() -> Result<bool> {
    match VARIABLES.map(|name| env::var_os(name).is_some_and(|value| !value.is_empty())) {
        [true, true] => Ok(true),
        [false, false] => Ok(false),
        _ => bail!(
            "set both {0} and {1}, or neither (then rustup installs the compiler)",
            VARIABLES[0],
            VARIABLES[1]
        ),
    }
}

/// Runs `xtask/rust-gpu-install`: the first time it downloads a nightly and compiles the back end (minutes).
fn install() -> Result<[String; 2]> {
    if !command::succeeds(command::program("rustup").arg("--version")) {
        bail!(
            "compiling shaders needs rustup (https://rustup.rs); the committed ones in assets/shaders don't"
        );
    }
    eprintln!("The first time this installs a Rust nightly and compiles the shader compiler: some minutes.");
    let target = command::target_dir().join("rust-gpu-install");
    let mut installer = command::cargo();
    installer.args(["run", "--release", "--locked", "--manifest-path", "xtask/rust-gpu-install/Cargo.toml"]);
    installer.arg("--target-dir").arg(target).args(["--", "shaders"]);
    parse(&command::output(&mut installer)?)
}

/// The values of [`VARIABLES`] among the lines `NAME=value`; other lines are some tool's chatter.
fn parse(output: &str) -> Result<[String; 2]> {
    let value = |name: &str| {
        let value = output.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('='));
        value.map(String::from).with_context(|| format!("rust-gpu-install did not print {name}"))
    };
    Ok([value(VARIABLES[0])?, value(VARIABLES[1])?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_among_chatter() {
        let text = "Compiling\nRUST_GPU_TOOLCHAIN=nightly-2026-07-03\nRUST_GPU_BACKEND=/c/a=b.so\n";
        assert_eq!(parse(text).unwrap(), ["nightly-2026-07-03", "/c/a=b.so"]);
        let error = parse("RUST_GPU_TOOLCHAIN=x\n").unwrap_err().to_string();
        assert!(error.contains("RUST_GPU_BACKEND"), "{error}");
    }
}
