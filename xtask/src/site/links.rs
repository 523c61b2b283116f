//! Links of a built site that lead nowhere.

use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A page that a server shows for a missing one, so its links are those of no folder.
const ANYWHERE: &str = "404.html";

/// `page: link` for each link to a file or anchor that is not there, of all pages but rustdoc's own (`api`).
pub fn dangling(site: &Path) -> Result<Vec<String>> {
    let site = &site.canonicalize().with_context(|| format!("no site in {}", site.display()))?;
    let mut pages = BTreeMap::new();
    collect(site, &mut pages)?;
    let mut dangling = Vec::new();
    for (path, page) in &pages {
        let place = path.strip_prefix(site).unwrap_or(path);
        if place.starts_with("api") || place == Path::new(ANYWHERE) {
            continue;
        }
        let links: BTreeSet<&str> =
            ["href", "src"].iter().flat_map(|name| attributes(&page.text, name)).collect();
        for link in links {
            if !leads_somewhere(link, path, &pages) {
                dangling.push(format!("{}: {link}", place.display()));
            }
        }
    }
    Ok(dangling)
}

struct Page {
    text: String,
    anchors: BTreeSet<String>,
}

fn collect(folder: &Path, pages: &mut BTreeMap<PathBuf, Page>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| format!("can't read {}", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, pages)?;
        } else if path.extension().is_some_and(|e| e == "html") {
            let text = fs::read_to_string(&path).with_context(|| format!("can't read {}", path.display()))?;
            let anchors = attributes(&text, "id").map(str::to_owned).collect();
            pages.insert(path, Page { text, anchors });
        }
    }
    Ok(())
}

/// Values of the attribute `name`, in double quotes.
fn attributes<'a>(text: &'a str, name: &str) -> impl Iterator<Item = &'a str> {
    let before = format!(" {name}=\"");
    let values: Vec<_> =
        text.split(before.as_str()).skip(1).filter_map(|rest| rest.split('"').next()).collect();
    values.into_iter()
}

fn leads_somewhere(link: &str, from: &Path, pages: &BTreeMap<PathBuf, Page>) -> bool {
    let elsewhere = ["http://", "https://", "mailto:", "data:", "javascript:"];
    if elsewhere.iter().any(|scheme| link.starts_with(scheme)) {
        return true;
    }
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let target = if file.is_empty() { from.to_path_buf() } else { from.with_file_name(file) };
    let Ok(target) = target.canonicalize() else { return false };
    let target = if target.is_dir() { target.join("index.html") } else { target };
    match pages.get(&target) {
        Some(page) => anchor.is_empty() || page.anchors.contains(anchor),
        None => target.is_file() && anchor.is_empty(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_to_nowhere_are_seen() {
        let site = std::env::temp_dir().join(format!("candela-xtask-links-{}", std::process::id()));
        fs::create_dir_all(site.join("docs")).unwrap();
        let index = r##"<a href="docs/a.html#there">a</a> <img src="p.png"> <a href="#here" id="here">b</a>
            <a href="https://example.org">c</a> <a href="docs/">d</a>"##;
        fs::write(site.join("index.html"), index).unwrap();
        fs::write(site.join("p.png"), "").unwrap();
        fs::write(site.join("docs/a.html"), r#"<h1 id="there">A</h1> <a href="../index.html">up</a>"#)
            .unwrap();
        fs::write(site.join("docs/index.html"), "").unwrap();
        assert_eq!(dangling(&site).unwrap(), Vec::<String>::new());
        // Negative controls.
        for (right, wrong) in [
            ("a.html#there", "a.html#gone"),
            ("p.png", "q.png"),
            ("#here\"", "#gone\""),
            ("docs/\"", "doc/\""),
        ] {
            fs::write(site.join("index.html"), index.replacen(right, wrong, 1)).unwrap();
            assert_eq!(dangling(&site).unwrap().len(), 1, "{wrong}");
        }
        fs::remove_dir_all(site).unwrap();
    }
}
