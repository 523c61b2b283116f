//! `candela ... | head`.

use std::io::pipe;
use std::process::{Command, Stdio};

/// No words and no panic where nobody reads any more; the same command is content where somebody does.
#[test]
fn a_closed_pipe_ends_the_program_quietly() {
    let info = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_candela"));
        command.args(["info", "knot", "100"]).stderr(Stdio::piped());
        command
    };
    let (reader, writer) = pipe().expect("a pipe");
    drop(reader);
    let cut = info().stdout(writer).spawn().and_then(|child| child.wait_with_output()).expect("it runs");
    assert_eq!((cut.status.code(), String::from_utf8_lossy(&cut.stderr)), (Some(141), "".into()));

    let whole = info().output().expect("it runs");
    assert!(whole.status.success() && !whole.stdout.is_empty());
}

/// A full disk is no success.
#[test]
#[cfg(target_os = "linux")]
fn a_full_output_is_said() {
    for arguments in [&["info", "knot", "100"][..], &["--help"]] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
        let mut command = Command::new(env!("CARGO_BIN_EXE_candela"));
        let output = command.args(arguments).stdout(full).stderr(Stdio::piped()).output().expect("it runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), said.lines().count()), (Some(3), 1), "{arguments:?}: {said}");
        assert!(said.contains("standard output") && said.contains("No space left"), "{said}");
    }
}
