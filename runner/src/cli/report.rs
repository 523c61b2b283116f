//! `candela report`: a sweep's report again, or a page's tables from committed results.

use super::args::ReportArgs;
use crate::error::Result;
use crate::measure::report;
use crate::measure::report::markdown;

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
