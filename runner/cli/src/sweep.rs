//! `candela sweep`: a plan's points, one after another, into a report.

use super::args::DeviceArgs;
use super::args::values::{parse_size, positive};
use super::progress::Sweeping;
use super::{output, progress};
use candela::error::{Error, Result};
use candela_lab::measure::report::{self, markdown, tables};
use candela_lab::measure::sweep::plan::Plan;
use candela_lab::measure::sweep::store::Store;
use candela_lab::measure::sweep::{Results, Sweep, point};
use clap::Args;
use glam::UVec2;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Results so far are written about this often: whoever stops a sweep has them.
const WRITE_EVERY: Duration = Duration::from_secs(20);

#[derive(Args, Clone, Debug)]
pub struct SweepArgs {
    /// A .toml file, or a built-in plan: thesis, lights, modes, town, indirect, motion, bench (times alone), smoke.
    pub plan: PathBuf,
    /// Folder of the results: points.json, points.csv, report.html.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Folder of finished points and references, kept between runs [default: DIR/cache].
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    /// Measure only points whose name contains this text; may be repeated.
    #[arg(long, value_name = "TEXT")]
    pub only: Vec<String>,
    /// Width x height in pixels, in place of the plan's.
    #[arg(long, value_parser = parse_size)]
    pub size: Option<UVec2>,
    /// Frames before the timed ones, in place of the plan's.
    #[arg(long, value_name = "FRAMES")]
    pub warm_up: Option<u32>,
    /// Timed frames, in place of the plan's.
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..))]
    pub frames: Option<u32>,
    /// Independent runs, in place of the plan's.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub replicas: Option<u32>,
    /// Milliseconds of accumulation, in place of the plan's.
    #[arg(long, value_name = "MS", value_parser = positive)]
    pub accumulate: Option<f32>,
    /// Print the points of the plan and measure nothing.
    #[arg(long)]
    pub list: bool,
    #[command(flatten)]
    pub device: DeviceArgs,
}

pub fn run(args: &SweepArgs) -> Result<()> {
    let (mut plan, base) = Plan::read(&args.plan)?;
    if let Some(size) = args.size {
        plan.size = size.to_array();
    }
    plan.warm_up = args.warm_up.unwrap_or(plan.warm_up);
    plan.frames = args.frames.unwrap_or(plan.frames);
    plan.replicas = args.replicas.unwrap_or(plan.replicas);
    if let (Some(ms), Some(accumulate)) = (args.accumulate, &mut plan.accumulate) {
        accumulate.ms = ms.into();
    }
    plan.check().map_err(Error::Usage)?;
    let mut points = plan.points().map_err(Error::Usage)?;
    points.retain(|p| args.only.is_empty() || args.only.iter().any(|text| p.name(&plan).contains(text)));
    if points.is_empty() {
        return Err(Error::Usage(format!(
            "no point's name contains '{}'; --list shows them",
            args.only.join("' or '")
        )));
    }
    if args.list {
        points.iter().for_each(|p| println!("{}", p.name(&plan)));
        return Ok(());
    }
    let store = Store::open(&args.cache.clone().unwrap_or_else(|| args.output.join("cache")))?;
    report::check_writable(&args.output)?;
    let bar = Sweeping(progress::bar(point::frames_of(&plan) * points.len() as u64, "measuring"));
    let sweep = Sweep { plan: &plan, base, points, store, device: args.device.options(), progress: &bar };
    let mut written = Instant::now();
    let (about, rows, device) = sweep.run(|about, rows| {
        if written.elapsed() > WRITE_EVERY {
            let results = Results { about: about.clone(), plan: plan.clone(), rows: rows.to_vec() };
            report::write(&args.output, &results)?;
            written = Instant::now();
        }
        Ok(())
    })?;
    bar.0.finish_and_clear();
    let failed: Vec<String> = rows.iter().filter_map(|row| row.error.clone()).collect();
    let total = rows.len();
    if plan.times_only {
        let mut table = format!("{}, {}\n", about.device.name, about.device.driver);
        markdown::write_table(&mut table, &tables::bench(&rows));
        println!("{table}");
    }
    report::write(&args.output, &Results { about, plan: plan.clone(), rows })?;
    println!("wrote {}", args.output.join("report.html").display());
    match failed.first() {
        None => device.as_ref().map_or(Ok(()), output::check_validation),
        Some(first) => {
            let count = failed.len();
            Err(Error::Check(format!("{count} of {total} points failed, the first: {first}")))
        }
    }
}
