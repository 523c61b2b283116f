//! `cargo xtask fuzz`: wrong files for every reader. A panic, an abort, a hang, or memory beyond a multiple of what was decoded is a
//! fault. Cases are numbered: the same seed and number give the same bytes everywhere.

mod dice;
mod mutate;
mod targets;

use clap::{Parser, ValueEnum};
use dice::Dice;
use peak_alloc::PeakAlloc;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Result};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::{Mutex, mpsc};
use std::time::{Duration, Instant};
use targets::Target;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// Most bytes of the heap: so many, and so many for each byte of the file and of what was decoded from it.
const MEMORY: (usize, usize) = (64 << 20, 16);
/// After so many aborts and hangs of one target the others get their turn.
const MOST_DEATHS: usize = 20;

#[derive(Parser)]
#[command(name = "cargo xtask fuzz", about = "Feed every reader with wrong files")]
struct Args {
    /// Only these.
    #[arg(long, value_enum)]
    target: Vec<Target>,
    /// Cases of each target.
    #[arg(long, default_value_t = 10_000)]
    cases: u64,
    /// The first case.
    #[arg(long, default_value_t = 0)]
    first: u64,
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Seconds that one case may take.
    #[arg(long, default_value_t = 10)]
    timeout: u64,
    /// Where the files of faults go.
    #[arg(short, long, default_value = "out/fuzz")]
    output: PathBuf,
    /// Run the cases in this process and report on standard output.
    #[arg(long, hide = true)]
    worker: bool,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let outcome = if args.worker { work(&args).map(|()| 0) } else { supervise(&args) };
    match outcome {
        Ok(0) => ExitCode::SUCCESS,
        Ok(faults) => {
            eprintln!("error: {faults} faults; their files are in {}", args.output.display());
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The bytes of a case, and the extension of their file.
fn case(corpus: &[(String, Vec<u8>)], target: Target, seed: u32, number: u64) -> (String, Vec<u8>) {
    let mut dice = Dice::new(seed, target as u32, number);
    let (extension, original) = dice.of(corpus);
    (extension.clone(), mutate::mutated(original, extension, &mut dice))
}

/// Writes the number of each case before it, and a fault behind its number.
fn work(args: &Args) -> Result<()> {
    static PANIC: Mutex<String> = Mutex::new(String::new());
    std::panic::set_hook(Box::new(|panic| {
        *PANIC.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = panic.to_string().replace('\n', " ");
    }));
    let target = args.target[0];
    let corpus = target.corpus()?;
    let folder = std::env::temp_dir().join(format!("candela-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    for number in args.first..args.first + args.cases {
        println!("{number}");
        let (extension, bytes) = case(&corpus, target, args.seed, number);
        let path = folder.join("case").with_extension(extension);
        std::fs::write(&path, &bytes)?;
        let before = HEAP.current_usage();
        HEAP.reset_peak_usage();
        match std::panic::catch_unwind(|| target.read(&path)) {
            Err(_) => println!("{number} {}", PANIC.lock().unwrap_or_else(|poisoned| poisoned.into_inner())),
            Ok(decoded) => {
                let took = HEAP.peak_usage().saturating_sub(before);
                if took > MEMORY.0 + MEMORY.1 * (bytes.len() + decoded) {
                    println!("{number} memory: too much for its size");
                    eprintln!("{number}: {took} bytes for {} and {decoded}", bytes.len());
                }
            }
        }
    }
    std::fs::remove_dir_all(&folder)
}

fn supervise(args: &Args) -> Result<usize> {
    let all = Target::ALL.to_vec();
    let mut faults = 0;
    for target in if args.target.is_empty() { all } else { args.target.clone() } {
        let start = Instant::now();
        let found = run(args, target)?;
        let name = target.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned());
        println!(
            "{name}: {} cases, {} faults, {:.0} s",
            args.cases,
            found.len(),
            start.elapsed().as_secs_f32()
        );
        let corpus = target.corpus()?;
        for (what, numbers) in &found {
            let (extension, bytes) = case(&corpus, target, args.seed, numbers[0]);
            let path = args.output.join(format!("{name}-{}-{}.{extension}", args.seed, numbers[0]));
            std::fs::create_dir_all(&args.output)?;
            std::fs::write(&path, bytes)?;
            println!("  {} ({} cases): {what}", path.display(), numbers.len());
        }
        faults += found.len();
    }
    Ok(faults)
}

/// Each fault with the cases that show it.
fn run(args: &Args, target: Target) -> Result<BTreeMap<String, Vec<u64>>> {
    let mut found: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    let (mut next, end) = (args.first, args.first + args.cases);
    let mut deaths = 0;
    while next < end && deaths < MOST_DEATHS {
        let mut last = next;
        let death = watch(args, target, next..end, |number, fault| {
            last = number;
            if let Some(fault) = fault {
                found.entry(fault).or_default().push(number);
            }
        })?;
        next = match death {
            None => end,
            Some(how) => {
                deaths += 1;
                found.entry(how).or_default().push(last);
                last + 1
            }
        };
    }
    Ok(found)
}

/// Runs a worker and hears what it says; how it died, if it did.
fn watch(
    args: &Args,
    target: Target,
    cases: std::ops::Range<u64>,
    mut heard: impl FnMut(u64, Option<String>),
) -> Result<Option<String>> {
    let name = target.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned());
    let mut worker = Command::new(std::env::current_exe()?)
        .args(["--worker", "--target", &name])
        .args(["--first", &cases.start.to_string(), "--cases", &(cases.end - cases.start).to_string()])
        .args(["--seed", &args.seed.to_string()])
        .stdout(Stdio::piped())
        .spawn()?;
    let (say, hear) = mpsc::channel();
    let lines = BufReader::new(worker.stdout.take().expect("its output is piped")).lines();
    let listener =
        std::thread::spawn(move || lines.map_while(Result::ok).try_for_each(|line| say.send(line)));
    let hung = loop {
        match hear.recv_timeout(Duration::from_secs(args.timeout)) {
            Ok(line) => {
                let (number, fault) =
                    line.split_once(' ').map_or((&line[..], None), |(n, f)| (n, Some(f.to_owned())));
                heard(number.parse().unwrap_or(cases.start), fault);
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => break false,
            Err(mpsc::RecvTimeoutError::Timeout) => break true,
        }
    };
    if hung {
        worker.kill()?;
    }
    let status = worker.wait()?;
    // It ends with the worker's output.
    let _ = listener.join();
    let folder = std::env::temp_dir().join(format!("candela-fuzz-{}", worker.id()));
    remove(&folder);
    Ok(match (hung, status.success()) {
        (true, _) => Some(format!("no end within {} s", args.timeout)),
        (false, true) => None,
        (false, false) => Some(format!("it died: {status}")),
    })
}

/// What a worker that died has left behind, if anything.
fn remove(folder: &Path) {
    let _ = std::fs::remove_dir_all(folder);
}
