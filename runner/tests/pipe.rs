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
