//! docs/licenses.md names the licence of everything of others that is in the program.

use std::collections::BTreeSet;
use std::process::Command;

const PAGE: &str = include_str!("../../../docs/licenses.md");

/// First cells of the rows below `heading`, in backticks there.
fn rows(heading: &str) -> BTreeSet<String> {
    let section =
        PAGE.split(heading).nth(1).and_then(|rest| rest.split("\n## ").next()).expect("the page has it");
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    rows.map(|(name, _)| name.to_owned()).collect()
}

#[test]
fn fonts_are_listed() {
    let fonts: BTreeSet<String> = egui::FontDefinitions::default().font_data.into_keys().collect();
    assert_eq!(rows("\n## Fonts\n"), fonts);
    assert!(fonts.len() >= 2, "{fonts:?}");
}

/// SPDX expressions of the crates that the program is linked from, on this machine.
#[test]
fn licences_of_libraries_are_listed() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments =
        ["tree", "-p", "candela-cli", "-e", "normal", "--prefix", "none", "-f", "{l}", "--locked"];
    let folder = env!("CARGO_MANIFEST_DIR");
    let output = Command::new(cargo).args(arguments).arg("--offline").current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let found: BTreeSet<&str> = text.lines().map(|line| line.trim_end_matches(" (*)")).collect();
    assert!(found.len() >= 10, "{found:?}");
    let listed = rows("\n## Libraries\n");
    let missing = |found: &BTreeSet<&str>| found.iter().filter(|e| !listed.contains(**e)).count();
    assert_eq!(missing(&found), 0, "docs/licenses.md lacks one of {found:?}");
    // Negative control: a licence that nobody has looked at.
    assert_eq!(missing(&found.into_iter().chain(["GPL-3.0-only", ""]).collect()), 2);
}
