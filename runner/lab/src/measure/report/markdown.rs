//! Fills the tables of a Markdown page from committed results.
//!
//! Between `<!-- results NAME.json -->` and `<!-- end -->` the page has generated tables; the text around them is written
//! by hand.

use super::tables::{self, COLUMNS, FILM_COLUMNS, Table};
use super::{Group, html, read, verdict};
use crate::measure::sweep::Results;
use candela::error::Result;
use candela::{files, image_io};
use std::fmt::Write;
use std::path::Path;

/// A picture that the page shows: file name, content.
pub type Picture = (String, String);

/// Rewrites `page` from the results in `directory`, and the plots beside them.
pub fn update(page: &Path, directory: &Path) -> Result<()> {
    let (text, pictures) = render(page, directory)?;
    for (name, svg) in pictures {
        image_io::replace(&directory.join(name), svg.as_bytes())?;
    }
    image_io::replace(page, text.as_bytes())
}

/// What [`update`] writes.
pub fn render(page: &Path, directory: &Path) -> Result<(String, Vec<Picture>)> {
    let old = files::read_text(page)?;
    // As a link from the page: both are given from the same folder.
    let folder = directory.strip_prefix(page.parent().unwrap_or(Path::new(""))).unwrap_or(directory);
    let mut pictures = Vec::new();
    let text = fill(&old, "results", |name| {
        let results = read(&directory.join(name))?;
        let stem = name.trim_end_matches(".json");
        let (body, plots) = blocks(&results, stem, &folder.display().to_string());
        pictures.extend(plots);
        Ok(body)
    })?;
    Ok((text, pictures))
}

/// `page` with what `body` says of NAME in each block between `<!-- KIND NAME -->`, at the start of a line, and
/// `<!-- end -->`.
pub fn fill(page: &str, kind: &str, mut body: impl FnMut(&str) -> Result<String>) -> Result<String> {
    let (mut text, mut rest) = (String::new(), page);
    while let Some((before, name, after)) = block(rest, kind) {
        let _ = write!(text, "{before}\n<!-- {kind} {name} -->\n\n{}\n{END}", body(name)?);
        rest = after;
    }
    Ok(text + rest)
}

const END: &str = "<!-- end -->";

/// (text before, name, text after) of the first block.
fn block<'a>(text: &'a str, kind: &str) -> Option<(&'a str, &'a str, &'a str)> {
    let (before, rest) = text.split_once(&format!("\n<!-- {kind} "))?;
    let (name, rest) = rest.split_once(" -->")?;
    let (_, after) = rest.split_once(END)?;
    Some((before, name, after))
}

fn blocks(results: &Results, stem: &str, folder: &str) -> (String, Vec<Picture>) {
    let (about, plan) = (&results.about, &results.plan);
    let mut text = format!(
        "{} ({}), {} at commit {}. {} x {} pixels, {} warm-up and {} timed frames, {} independent runs. `{}`\n",
        about.device.name,
        about.device.driver,
        about.program,
        about.commit,
        plan.size[0],
        plan.size[1],
        plan.warm_up,
        plan.frames,
        plan.replicas,
        about.command
    );
    let mut pictures = Vec::new();
    let mut plot = |text: &mut String, title: &str, svg: String| {
        let name = format!("{stem}-{}.svg", pictures.len() + 1);
        let _ = write!(text, "\n![{title}]({folder}/{name})\n");
        pictures.push((name, svg));
    };
    for svg in html::over_lights(results) {
        plot(&mut text, "Over the number of lights", svg);
    }
    for group in Group::all(results) {
        let _ = write!(text, "\n**{}.** {}\n", group.title(), group.truth());
        if let Some(unsettled) = group.unsettled() {
            let _ = write!(text, "\n{unsettled}\n");
        }
        // Tables of errors stand behind curves and conclusions; tables of times are the result itself.
        let folded = !plan.times_only;
        if let Some(svg) = html::equal_time(&group) {
            plot(&mut text, "Error over time", svg);
        }
        for svg in html::over_pictures(&group) {
            plot(&mut text, "Error over pictures", svg);
        }
        let sentences = verdict::sentences(results, &group);
        if !sentences.is_empty() {
            text.push('\n');
        }
        for sentence in sentences {
            let _ = writeln!(text, "- {sentence}");
        }
        if folded {
            text += "\n<details>\n<summary>The numbers</summary>\n";
        }
        let equal = plan.accumulate.as_ref().and_then(|a| tables::equal_time(&group, &a.targets));
        for table in equal.iter().chain(&tables::error_after(&group)) {
            write_table(&mut text, table);
        }
        for (name, rows) in group.series() {
            let mut table = tables::series(&rows);
            table[0][0] = name.into();
            write_table(&mut text, &table);
            if let Some(mut table) = tables::films(&rows) {
                table[0][0] = name.into();
                write_table(&mut text, &table);
            }
        }
        if folded {
            text += "\n</details>\n";
        }
    }
    let _ = write!(text, "\n{COLUMNS}\n");
    if plan.motion.is_some() {
        let _ = write!(text, "\n{FILM_COLUMNS}\n");
    }
    (text, pictures)
}

/// `table` as Markdown.
pub fn write_table(text: &mut String, table: &Table) {
    text.push('\n');
    for (i, row) in table.iter().enumerate() {
        let _ = writeln!(
            text,
            "| {} |",
            row.iter().map(|c| c.replace('|', "\\|")).collect::<Vec<_>>().join(" | ")
        );
        if i == 0 {
            let _ = writeln!(text, "|{}", "---|".repeat(row.len()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    #[test]
    fn blocks_are_found_and_the_rest_is_left() {
        let text = "a\n<!-- results x.json -->\nold\n<!-- end -->\nb";
        assert_eq!(block(text, "results"), Some(("a", "x.json", "\nb")));
        assert_eq!(block("\n<!-- results x.json --> never ends", "results"), None);
        assert_eq!(block("in `<!-- results x.json -->` text\n<!-- end -->", "results"), None);
    }

    /// docs/results.md is what `cargo xtask results` makes of docs/results/*.json, to the byte.
    #[test]
    fn the_committed_page_is_up_to_date() {
        let docs = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs");
        let page = docs.join("results.md");
        let (text, pictures) = render(&page, &docs.join("results")).unwrap();
        let hint = "`cargo xtask results` brings it up to date";
        assert!(text == std::fs::read_to_string(&page).unwrap(), "docs/results.md: {hint}");
        assert!(text.contains("relMSE"), "it has at least one block");
        for (name, svg) in pictures {
            let committed = std::fs::read_to_string(docs.join("results").join(&name)).unwrap_or_default();
            assert!(svg == committed, "docs/results/{name}: {hint}");
        }
    }
}
