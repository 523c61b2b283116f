//! Standard output may fail: a reader has seen enough (`| head`), a disk is full. These macros stand in for those of `std`, which
//! panic then.

use candela::error::Kind;
use std::fmt::Arguments;
use std::io::{Error, ErrorKind, Write};

macro_rules! print {
    ($($text:tt)*) => { $crate::stdout::write(format_args!($($text)*)) };
}

macro_rules! println {
    ($($text:tt)*) => { $crate::stdout::write(format_args!("{}\n", format_args!($($text)*))) };
}

/// What a shell says of a program that SIGPIPE has ended.
const NOBODY_READS: i32 = 141;

pub fn write(text: Arguments) {
    if let Err(error) = std::io::stdout().write_fmt(text) {
        give_up(&error);
    }
}

/// Ends the program: quietly where nobody reads any more.
pub fn give_up(error: &Error) -> ! {
    if error.kind() == ErrorKind::BrokenPipe {
        std::process::exit(NOBODY_READS);
    }
    eprintln!("error: can't write to standard output: {error}");
    std::process::exit(Kind::Output.exit_code().into())
}
