//! The tables of docs/command-line.md, generated.

use candela::error::{Error, Kind, Result};
use candela::knobs::ALL;
use candela::{files, image_io};
use candela_lab::measure::report::markdown::{fill, write_table};
use candela_lab::measure::report::tables::Table;
use std::path::Path;

/// Rewrites `page`: what stands between `<!-- table NAME -->` and `<!-- end -->`.
pub fn update(page: &Path) -> Result<()> {
    let text = files::read_text(page)?;
    image_io::replace(page, render(&text, page)?.as_bytes())
}

fn render(text: &str, page: &Path) -> Result<String> {
    fill(text, "table", |name| match name {
        "exit codes" => Ok(markdown(&exit_codes())),
        "knobs" => Ok(markdown(&knobs())),
        _ => Err(Error::input(page)(format!("there is no table '{name}'"))),
    })
}

fn markdown(table: &Table) -> String {
    let mut text = String::new();
    write_table(&mut text, table);
    text.trim_start().to_owned()
}

fn exit_codes() -> Table {
    let row = |code: u8, meaning: &str| vec![code.to_string(), meaning.to_owned()];
    let mut table = vec![vec!["code".into(), "meaning".into()], row(0, "done")];
    table.extend(Kind::ALL.map(|kind| row(kind.exit_code(), kind.meaning())));
    table
}

fn knobs() -> Table {
    let head = ["knob", "values", "default", "meaning", "higher, on", "lower, off", "bias"];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    table.extend(ALL.iter().map(|knob| {
        let cells =
            [&*knob.values(), &knob.default_in_words(), knob.about, knob.higher, knob.lower, knob.bias];
        let name = format!("`{}`", knob.name);
        std::iter::once(name).chain(cells.map(str::to_owned)).collect()
    }));
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_page_is_up_to_date() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/command-line.md");
        let text = std::fs::read_to_string(&page).unwrap();
        assert!(text.contains("<!-- table exit codes -->") && text.contains("<!-- table knobs -->"));
        assert!(
            render(&text, &page).unwrap() == text,
            "`cargo xtask docs` brings {} up to date",
            page.display()
        );
        // Negative control.
        for word in [Kind::Internal.meaning(), "| `candidates` | 1 to 1024 | 32 |"] {
            assert!(text.contains(word));
            let stale = text.replace(word, "?");
            assert_ne!(render(&stale, &page).unwrap(), stale);
        }
        assert!(render("\n<!-- table none --><!-- end -->", &page).is_err());
    }
}
