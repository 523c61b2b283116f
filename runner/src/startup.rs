//! Times of the steps from start to first frame: on standard error with `--timings`, else in the log.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

static REPORTS: AtomicBool = AtomicBool::new(false);
static START: OnceLock<Instant> = OnceLock::new();

/// The program starts now.
pub fn begin() {
    START.get_or_init(Instant::now);
}

/// Steps are reported from now on.
pub fn report() {
    REPORTS.store(true, Ordering::Relaxed);
}

/// Does `step`, named `name`; steps may lie in one another.
pub fn timed<R>(name: &str, step: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = step();
    done(name, start);
    result
}

/// `name` has been reached.
pub fn reached(name: &str) {
    done(name, *START.get_or_init(Instant::now));
}

/// `name`, begun at `since`, is done.
pub fn done(name: &str, since: Instant) {
    let ms = since.elapsed().as_secs_f64() * 1e3;
    if REPORTS.load(Ordering::Relaxed) {
        eprintln!("{name:<24} {ms:9.1} ms");
    } else {
        tracing::info!("{name}: {ms:.1} ms");
    }
}
