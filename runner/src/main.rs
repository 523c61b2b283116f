use candela::cli;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// What a shell says of a program that SIGPIPE has ended.
const NOBODY_READS: i32 = 141;

fn main() -> ExitCode {
    end_quietly_when_nobody_reads();
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

/// A reader that has seen enough (`| head`) is no fault of ours. `println!` can only panic then.
fn end_quietly_when_nobody_reads() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let said = panic.payload().downcast_ref::<String>();
        if said.is_some_and(|said| said.starts_with("failed printing to stdout")) {
            std::process::exit(NOBODY_READS);
        }
        usual(panic);
    }));
}
