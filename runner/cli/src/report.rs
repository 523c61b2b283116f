//! `candela report`: a sweep's report again, or a page's tables from committed results.

use candela::error::Result;
use candela_lab::measure::report;
use candela_lab::measure::report::markdown;
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Clone, Debug)]
pub struct ReportArgs {
    /// Folder of a sweep's results, or of committed ones.
    pub directory: PathBuf,
    /// Fill the tables of this page from the folder's .json files.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
}

pub fn run(args: &ReportArgs) -> Result<()> {
    match &args.markdown {
        Some(page) => {
            markdown::update(page, &args.directory)?;
            println!("wrote {}", page.display());
        }
        None => {
            let results = report::read(&args.directory.join("points.json"))?;
            report::write(&args.directory, &results)?;
            println!("wrote {}", args.directory.join("report.html").display());
        }
    }
    Ok(())
}
