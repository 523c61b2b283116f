//! docs/algorithm.md's table of equations against the doc comments that name them.

use crate::docs::{code_spans, files, is_module, workspace};
use std::fs;
use std::path::{Path, PathBuf};

/// Where doc comments may name equations.
const SOURCES: [&str; 5] = ["shared/src", "shared/tests", "shaders/src", "runner/src", "runner/lab/src"];
const HEADING: &str = "## Table of equations";
/// The thesis's equations are (4.1) to (4.22).
const THESIS: u32 = 22;

/// An equation's numbers: ours, the paper's, the thesis's; without parentheses what is no equation ("section 5", "Alg. 4").
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers {
    pub ours: u32,
    pub bitterli: Vec<String>,
    pub thesis: Vec<String>,
}

/// A row of the table.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub numbers: Numbers,
    /// `module::Type::function` or `folder/file.rs::function`.
    pub functions: Vec<String>,
}

/// A function whose doc comment has lines like `/// Equation (10): Bitterli (6); thesis (4.17).`
#[derive(Clone, Debug)]
pub struct Item {
    file: PathBuf,
    /// Inline module or implemented type, and name.
    path: Vec<String>,
    equations: Vec<Numbers>,
}

/// What is wrong with the page alone: numbers that don't run, equations of the thesis that are missing, rows without function.
pub fn wrong_numbers(page: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    let tags: Vec<&str> = page.split("\\tag{").skip(1).filter_map(|rest| rest.split('}').next()).collect();
    let rows = rows(page);
    for (i, tag) in tags.iter().enumerate() {
        if *tag != (i + 1).to_string() {
            wrong.push(format!("\\tag{{{tag}}} is equation {} of the page", i + 1));
        }
        if rows.get(i).is_none_or(|row| row.numbers.ours as usize != i + 1) {
            wrong.push(format!("row {} of the table is not equation ({})", i + 1, i + 1));
        }
    }
    if rows.len() != tags.len() {
        wrong.push(format!("{} rows for {} equations", rows.len(), tags.len()));
    }
    for number in 1..=THESIS {
        let number = format!("(4.{number})");
        if !rows.iter().any(|row| row.numbers.thesis.contains(&number)) {
            wrong.push(format!("thesis {number} is in no row"));
        }
    }
    let without = rows.iter().filter(|row| row.functions.is_empty());
    wrong.extend(without.map(|row| format!("({}) names no function", row.numbers.ours)));
    wrong
}

/// Where the table of `page` and the doc comments of `items` disagree, either way.
pub fn contradictions(page: &str, items: &[Item]) -> Vec<String> {
    let rows = rows(page);
    let mut wrong = Vec::new();
    for row in &rows {
        let Numbers { ours, bitterli, thesis } = &row.numbers;
        let mut named: Vec<&Numbers> = Vec::new();
        for function in &row.functions {
            let equation = items.iter().filter(|item| item.is(function)).flat_map(|item| &item.equations);
            let found: Vec<_> = equation.filter(|equation| equation.ours == *ours).collect();
            if found.is_empty() {
                wrong.push(format!("({ours}): the doc comment of {function} does not name it"));
            }
            named.extend(found);
        }
        let by = |of: fn(&Numbers) -> &Vec<String>, number| named.iter().any(|n| of(n).contains(number));
        let unnamed = bitterli.iter().filter(|number| !by(|n| &n.bitterli, number));
        wrong.extend(unnamed.map(|number| format!("({ours}): no doc comment names Bitterli {number}")));
        let unnamed = thesis.iter().filter(|number| !by(|n| &n.thesis, number));
        wrong.extend(unnamed.map(|number| format!("({ours}): no doc comment names thesis {number}")));
    }
    for item in items {
        for equation in &item.equations {
            let row = rows.iter().find(|row| {
                row.numbers.ours == equation.ours && row.functions.iter().any(|function| item.is(function))
            });
            let is_in = |row: &Row| {
                let all = |a: &[String], b: &[String]| a.iter().all(|number| b.contains(number));
                all(&equation.bitterli, &row.numbers.bitterli) && all(&equation.thesis, &row.numbers.thesis)
            };
            if !row.is_some_and(is_in) {
                let name = item.path.join("::");
                wrong.push(format!("{}: {name} names {equation:?}, the table does not", item.file.display()));
            }
        }
    }
    wrong
}

/// The table's rows: `| (10) what it is | (6) | (4.17) | functions |`.
fn rows(page: &str) -> Vec<Row> {
    let table = page.split_once(HEADING).map_or("", |(_, rest)| rest.split("\n## ").next().unwrap_or(""));
    table.lines().filter_map(row).collect()
}

fn row(line: &str) -> Option<Row> {
    let cells: Vec<&str> = line.strip_prefix('|')?.split('|').map(str::trim).collect();
    let [ours, bitterli, thesis, functions, ..] = cells[..] else { return None };
    let ours = ours.strip_prefix('(')?.split(')').next()?.parse().ok()?;
    let list = |cell: &str| -> Vec<String> {
        cell.split(", ").filter(|number| *number != "–").map(str::to_owned).collect()
    };
    let numbers = Numbers { ours, bitterli: list(bitterli), thesis: list(thesis) };
    Some(Row { numbers, functions: code_spans(functions) })
}

/// All functions whose doc comments name equations.
pub fn items() -> Vec<Item> {
    let files = SOURCES.iter().flat_map(|folder| files(&workspace().join(folder), "rs"));
    files.flat_map(|file| items_of(&file, &fs::read_to_string(&file).unwrap_or_default())).collect()
}

/// Those of `text`, which stands in `file`.
pub fn items_of(file: &Path, text: &str) -> Vec<Item> {
    let (mut items, mut scope, mut equations) = (Vec::new(), None, Vec::new());
    for line in text.lines() {
        let code = line.trim_start();
        if let Some(comment) = code.strip_prefix("///") {
            equations.extend(numbers(comment.trim()));
        } else if !code.starts_with("#[") {
            let words: Vec<&str> = code.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
            if let (Some(at), false) = (words.iter().position(|&word| word == "fn"), equations.is_empty()) {
                let path = scope.iter().cloned().chain(words.get(at + 1).map(|&name| name.to_owned()));
                items.push(Item { file: file.into(), path: path.collect(), equations: equations.clone() });
            }
            equations.clear();
            if line.starts_with("impl") || line.starts_with("mod ") {
                scope = scope_of(line);
            } else if line.starts_with('}') {
                scope = None;
            }
        }
    }
    items
}

/// The type of an `impl` without its generics, or the name of a `mod`.
fn scope_of(line: &str) -> Option<String> {
    let target = line.rsplit(" for ").next()?.split('{').next()?.trim();
    let name = target.split(' ').next_back()?.split('<').next()?;
    Some(name.rsplit("::").next()?.to_owned())
}

/// Of a line `Equation (10): Bitterli (6); thesis (4.17).`
fn numbers(comment: &str) -> Option<Numbers> {
    let (ours, rest) = comment.strip_prefix("Equation (")?.split_once(')')?;
    let mut numbers = Numbers { ours: ours.parse().ok()?, ..Numbers::default() };
    for number in rest.trim_start_matches(':').trim_end_matches('.').split([',', ';']).map(str::trim) {
        if let Some(number) = number.strip_prefix("Bitterli ") {
            numbers.bitterli.push(number.to_owned());
        } else if let Some(number) = number.strip_prefix("thesis ") {
            numbers.thesis.push(number.to_owned());
        }
    }
    Some(numbers)
}

impl Item {
    /// Is `function` this item's path?
    fn is(&self, function: &str) -> bool {
        let parts: Vec<&str> = function.split("::").collect();
        let Some(split) = parts.len().checked_sub(self.path.len()) else { return false };
        let (module, path) = parts.split_at(split);
        let in_file = match module {
            [file] if file.ends_with(".rs") => self.file.ends_with(file),
            [] => false,
            _ => is_module(&self.file, &module.join("/")),
        };
        in_file && self.path == path
    }
}
