//! A page of the repository as a page of the book.

use super::math;
use anyhow::Result;
use std::path::{Component, Path, PathBuf};

/// Where a link of a page leads to, in the site.
#[derive(Debug, PartialEq, Eq)]
pub enum Target {
    Chapter,
    /// A file that is shown as it is.
    Picture,
    /// A file that is shown as text.
    Source,
    /// A folder whose files are listed.
    Folder,
    /// Rustdoc's view of a source file: its path in the site.
    Documented(PathBuf),
}

/// The pages that `summary` lists.
pub fn chapters(summary: &str) -> Vec<PathBuf> {
    let links = summary.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    links.map(PathBuf::from).collect()
}

/// The target of `path`, from the project's root.
pub fn target(root: &Path, chapters: &[PathBuf], path: &Path) -> Target {
    let documented = [("shared/src", "candela_shared"), ("runner/src", "candela")];
    let view = documented.iter().find_map(|(folder, name)| {
        let file = path.strip_prefix(folder).ok().filter(|_| root.join(path).is_file())?;
        Some(Path::new("api/src").join(name).join(format!("{}.html", file.display())))
    });
    match view {
        _ if chapters.iter().any(|chapter| chapter == path) => Target::Chapter,
        _ if is_picture(path) => Target::Picture,
        Some(view) => Target::Documented(view),
        None if root.join(path).is_dir() => Target::Folder,
        None => Target::Source,
    }
}

pub fn is_picture(path: &Path) -> bool {
    path.extension().is_some_and(|e| ["jpg", "png", "svg"].iter().any(|known| e == *known))
}

/// The name under which browsers show a source file.
pub fn as_text(path: &Path) -> PathBuf {
    PathBuf::from(format!("{}.txt", path.display()))
}

/// `page`, at `place` from the project's root: equations in MathML, and links that lead to files of the site.
pub fn staged(page: &str, place: &Path, mut target: impl FnMut(&Path) -> Target) -> Result<String> {
    let mut staged = String::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        let text = line.trim_start();
        let indent = &line[..line.len() - text.len()];
        if !text.starts_with("```") {
            staged += &format!("{}\n", prose(line, place, &mut target)?);
            continue;
        }
        let body: Vec<&str> =
            lines.by_ref().take_while(|line| !line.trim_start().starts_with("```")).collect();
        staged += &match text {
            "```math" => format!("\n{indent}{}\n\n", math::block(&body.join("\n"))?),
            _ => format!("{line}\n{}\n{indent}```\n", body.join("\n")),
        };
    }
    Ok(staged)
}

/// A line outside of fenced blocks.
fn prose(line: &str, place: &Path, target: &mut impl FnMut(&Path) -> Target) -> Result<String> {
    let mut parts = line.split('`');
    let mut prose = String::new();
    while let Some(text) = parts.next() {
        prose += &math::inline(&linked(text, place, target))?;
        if let Some(code) = parts.next() {
            prose += &format!("`{code}`");
        }
    }
    Ok(prose)
}

/// `text` with the links of the site.
fn linked(text: &str, place: &Path, target: &mut impl FnMut(&Path) -> Target) -> String {
    let mut parts = text.split("](");
    let mut linked = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (link, rest) = part.split_at(part.find(')').unwrap_or(part.len()));
        let elsewhere = link.contains("://") || link.starts_with('#') || link.starts_with("mailto:");
        let link = if elsewhere { link.to_owned() } else { in_site(link, place, target) };
        linked += &format!("]({link}{rest}");
    }
    linked
}

fn in_site(link: &str, place: &Path, target: &mut impl FnMut(&Path) -> Target) -> String {
    let folder = place.parent().unwrap_or(Path::new(""));
    let path = plain(&folder.join(link.split('#').next().unwrap_or(link)));
    let up = "../".repeat(folder.components().count());
    match target(&path) {
        // mdBook knows its own pages, but for those that become a folder's index.
        Target::Chapter => link.replace("README.md", "index.md"),
        Target::Picture => format!("{up}{}", path.display()),
        Target::Documented(view) => format!("{up}{}", view.display()),
        Target::Folder => format!("{up}{}/index.html", path.display()),
        Target::Source => format!("{up}{}", as_text(&path).display()),
    }
}

/// `path` without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => _ = plain.pop(),
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    plain
}

/// An HTML page that lists the `files` of `folder`.
pub fn listing(folder: &Path, files: &[&Path]) -> String {
    let title = folder.display();
    let mut page = format!(
        "<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<h1>{title}</h1>\n<ul>\n"
    );
    for file in files {
        let name = file.strip_prefix(folder).unwrap_or(file).display().to_string();
        let link = if is_picture(file) { name.clone() } else { format!("{name}.txt") };
        page += &format!("<li><a href=\"{link}\">{name}</a>\n");
    }
    page + "</ul>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_become_chapters() {
        let page = "# A\nSee [up](../README.md), [b](b.md#there), [code](../shared/src/lib.rs) and `$[x](y)`, $x$.\n```sh\necho $HOME [x](y)\n```\n- a\n\n  ```math\n  y\n  ```\n";
        let staged = staged(page, Path::new("docs/a.md"), |path| match path.extension() {
            Some(e) if e == "md" => Target::Chapter,
            _ => Target::Source,
        });
        let staged = staged.unwrap();
        assert!(
            staged.contains(
                "[up](../index.md), [b](b.md#there), [code](../shared/src/lib.rs.txt) and `$[x](y)`, <math"
            ),
            "{staged}"
        );
        assert!(
            staged.contains("```sh\necho $HOME [x](y)\n```\n- a\n\n\n  <div class=\"equation\">"),
            "{staged}"
        );
    }
}
