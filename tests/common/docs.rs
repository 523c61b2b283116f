//! Pages that name code: whether what they name exists, and where their links lead.

use std::fs;
use std::path::{Path, PathBuf};

/// The project's folder.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// Where modules are looked for.
const SOURCES: [&str; 6] =
    ["shared/src", "shaders/src", "runner/src", "runner/lab/src", "runner/viewer/src", "runner/cli/src"];

/// The code spans of `page` that name code and name nothing that exists.
///
/// A span names code if it is a path with `::`: `module::function`, `module::Type::function`,
/// `module::tests::function`, or `folder/file.rs::function`. Modules are files of shared, shaders or runner, or `mod`s in
/// them; several may match. The last part is a function, type, constant, trait or module.
pub fn dangling_names(page: &str) -> Vec<String> {
    code_spans(page).into_iter().filter(|span| is_path(span) && !exists(span)).collect()
}

/// Text between single backticks, outside of fenced blocks.
pub fn code_spans(page: &str) -> Vec<String> {
    let mut spans = Vec::new();
    let mut fenced = false;
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            spans.extend(line.split('`').skip(1).step_by(2).map(str::to_owned));
        }
    }
    spans
}

fn is_path(span: &str) -> bool {
    let is_name =
        |part: &str| !part.is_empty() && part.chars().all(|c| c.is_alphanumeric() || "_/.".contains(c));
    span.contains("::") && span.split("::").all(is_name)
}

fn exists(span: &str) -> bool {
    let parts: Vec<&str> = span.split("::").collect();
    let (&name, scope) = parts.split_last().unwrap_or((&"", &[]));
    if let [file, ..] = scope
        && file.ends_with(".rs")
    {
        return fs::read_to_string(workspace().join(file))
            .is_ok_and(|text| defines(&text, &scope[1..], name));
    }
    let modules = scope.iter().take_while(|part| part.starts_with(|c: char| c.is_lowercase())).count();
    // The first of the modules are files, the others are inside of the last of those.
    (1..=modules).rev().any(|files| {
        let stem = scope[..files].join("/");
        sources()
            .iter()
            .filter(|file| is_module(file, &stem))
            .any(|file| fs::read_to_string(file).is_ok_and(|text| defines(&text, &scope[files..], name)))
    })
}

/// Is `file` the module `stem` (`light/tile`: light/tile.rs or light/tile/mod.rs), or one whose path ends so?
pub(crate) fn is_module(file: &Path, stem: &str) -> bool {
    let of = |tail: String| file.ends_with(tail);
    of(format!("{stem}.rs")) || of(format!("{stem}/mod.rs"))
}

/// Has `text` a definition of `name`, and of all of `scope` (types, inline modules)?
fn defines(text: &str, scope: &[&str], name: &str) -> bool {
    let is_defined = |name: &str| {
        text.lines().any(|line| {
            let mut words =
                line.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|word| !word.is_empty());
            let keyword = words.find(|word| !matches!(*word, "pub" | "crate" | "super" | "in" | "unsafe"));
            // `const` may come before `fn`.
            let keyword =
                if keyword == Some("const") && line.contains("const fn") { words.next() } else { keyword };
            let defines = ["fn", "struct", "enum", "trait", "const", "static", "type", "mod"];
            keyword.is_some_and(|keyword| defines.contains(&keyword)) && words.next() == Some(name)
        })
    };
    let is_implemented =
        |name: &str| text.lines().any(|line| line.starts_with("impl") && line.contains(name));
    scope.iter().all(|part| is_defined(part) || is_implemented(part)) && is_defined(name)
}

/// All Rust files that modules may be.
fn sources() -> Vec<PathBuf> {
    SOURCES.iter().flat_map(|folder| files(&workspace().join(folder), "rs")).collect()
}

/// The project's Markdown pages.
pub fn pages() -> Vec<PathBuf> {
    files(workspace(), "md")
}

/// Files under `folder` whose name ends so; not those of build products and hidden folders.
pub fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok).map(|entry| entry.path());
    let mut found = Vec::new();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir()
            && !name.starts_with('.')
            && !["target", "out", "node_modules"].contains(&name.as_str())
        {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found
}

/// Links of `page`, at `path`, to files or headings that do not exist.
pub fn dangling_links(path: &Path, page: &str) -> Vec<String> {
    let folder = path.parent().unwrap_or(path);
    let leads_nowhere = |link: &String| {
        let (file, heading) = link.split_once('#').unwrap_or((link, ""));
        if link.contains("://") || link.starts_with("mailto:") {
            return false;
        }
        let target = if file.is_empty() { path.to_path_buf() } else { folder.join(file) };
        let is_page = target.extension().is_some_and(|e| e == "md");
        let text =
            if file.is_empty() { page.into() } else { fs::read_to_string(&target).unwrap_or_default() };
        !target.exists() || is_page && !heading.is_empty() && !headings(&text).any(|known| known == heading)
    };
    links(page).into_iter().filter(leads_nowhere).collect()
}

/// Anchors of the headings of `page`: lower case, words joined by dashes, without punctuation.
fn headings(page: &str) -> impl Iterator<Item = String> {
    let lines = page.split("```").step_by(2).flat_map(str::lines).filter(|line| line.starts_with('#'));
    lines.map(|line| {
        let kept = |c: char| c.is_alphanumeric() || " -_".contains(c);
        line.trim_start_matches('#').trim().to_lowercase().replace(|c| !kept(c), "").replace(' ', "-")
    })
}

/// Targets of `[text](target)`, outside of fenced blocks.
fn links(page: &str) -> Vec<String> {
    let fences = page.split("```").step_by(2);
    let after = fences.flat_map(|text| text.split("](").skip(1));
    after.filter_map(|rest| rest.split([')', ' ']).next()).map(str::to_owned).collect()
}
