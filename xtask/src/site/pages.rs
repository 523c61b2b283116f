//! A page of the repository as a page of the book.

use std::path::{Component, Path, PathBuf};

/// Where a link of a page leads to, in the site.
#[derive(Debug, PartialEq, Eq)]
pub enum Target {
    Chapter,
    /// A file that is shown as it is.
    Picture,
    /// A file or folder that is shown as text.
    Source,
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
    let documented = [("shared/src", "shared"), ("runner/src", "candela")];
    let view = documented.iter().find_map(|(folder, name)| {
        let file = path.strip_prefix(folder).ok().filter(|_| root.join(path).is_file())?;
        Some(Path::new("api/src").join(name).join(format!("{}.html", file.display())))
    });
    match view {
        _ if chapters.iter().any(|chapter| chapter == path) => Target::Chapter,
        _ if is_picture(path) => Target::Picture,
        Some(view) => Target::Documented(view),
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

/// `page`, at `place` from the project's root: math blocks of GitHub become KaTeX's, links lead to files of the site.
pub fn staged(page: &str, place: &Path, mut target: impl FnMut(&Path) -> Target) -> String {
    #[derive(PartialEq)]
    enum In {
        Text,
        Code,
        Math,
    }
    let mut within = In::Text;
    let mut staged = String::new();
    for line in page.lines() {
        let text = line.trim_start();
        let indent = &line[..line.len() - text.len()];
        let fence = text.starts_with("```");
        within = match within {
            In::Text if fence && text == "```math" => {
                staged += &format!("{indent}$$\n");
                In::Math
            }
            In::Math if fence => {
                staged += &format!("{indent}$$\n");
                In::Text
            }
            In::Code | In::Math => {
                staged += &format!("{line}\n");
                if fence { In::Text } else { within }
            }
            In::Text => {
                let line = if fence { line.to_owned() } else { linked(line, place, &mut target) };
                staged += &format!("{line}\n");
                if fence { In::Code } else { In::Text }
            }
        };
    }
    staged
}

/// `line` with the links of the site.
fn linked(line: &str, place: &Path, target: &mut impl FnMut(&Path) -> Target) -> String {
    let mut parts = line.split("](");
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
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let path = plain(&folder.join(file));
    let up = "../".repeat(folder.components().count());
    match target(&path) {
        // mdBook knows its own pages.
        Target::Chapter => link.to_owned(),
        Target::Picture => format!("{up}{}", path.display()),
        Target::Documented(view) => format!("{up}{}", view.display()),
        Target::Source if path.extension().is_none() && !path.starts_with("LICENSE") && anchor.is_empty() => {
            format!("{up}{}/index.html", path.display())
        }
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
