use candela::cli;
use candela::error::Kind;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// What a shell says of a program that SIGPIPE has ended.
const NOBODY_READS: i32 = 141;

fn main() -> ExitCode {
    end_in_words_when_output_fails();
    candela::startup::begin();
    // What the user should know even without RUST_LOG.
    let quiet = || EnvFilter::new("error,candela=warn");
    tracing_subscriber::fmt()
        .with_env_filter(EnvFilter::try_from_default_env().unwrap_or_else(|_| quiet()))
        .with_writer(std::io::stderr)
        .init();
    match cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.kind().exit_code())
        }
    }
}

/// `println!` can only panic when standard output fails.
fn end_in_words_when_output_fails() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let said = panic.payload().downcast_ref::<String>();
        if let Some(reason) = said.and_then(|said| said.strip_prefix("failed printing to stdout: ")) {
            end_without_output(reason);
        }
        usual(panic);
    }));
}

/// A reader that has seen enough (`| head`) is no fault of ours; a full disk is worth a word.
fn end_without_output(reason: &str) -> ! {
    // EPIPE, and what Windows says instead.
    if reason.contains("(os error 32)") || reason.contains("(os error 232)") {
        std::process::exit(NOBODY_READS);
    }
    eprintln!("error: standard output: can't write: {reason}");
    std::process::exit(Kind::Output.exit_code().into());
}
