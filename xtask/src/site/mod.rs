//! `cargo xtask site`: the project's pages as a book with the API's documentation, in target/site/book. A link that
//! leads nowhere fails.
//!
//! mdBook builds from a copy of the pages, in which equations are MathML and links to source files lead to files of the
//! site. The site loads nothing from elsewhere.

mod links;
mod math;
mod pages;

use crate::command;
use anyhow::{Context, Result, bail};
use pages::Target;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Installed once, into target/tools.
const MDBOOK: &str = "0.5.4";

/// A chapter that the site alone has.
const API: &str = "# The API's documentation\n
- [`candela`](api/candela/index.html): scenes, Vulkan, frames
- [`candela_shared`](api/candela_shared/index.html): the estimator\n";

pub fn run() -> Result<()> {
    let mdbook = install()?;
    let site = command::target_dir().join("site");
    let (source, book) = (site.join("pages"), site.join("book"));
    let wanted = stage(&command::root(), &source)?;
    command::run(command::program(mdbook).arg("build").arg(&source))?;
    wanted.iter().try_for_each(|path| copy_source(path, &book))?;
    document(&book.join("api"))?;
    let dangling = links::dangling(&book)?;
    if !dangling.is_empty() {
        bail!("links that lead nowhere:\n{}", dangling.join("\n"));
    }
    println!("The site is {}", book.join("index.html").display());
    Ok(())
}

/// mdBook of our version.
fn install() -> Result<PathBuf> {
    let tools = command::target_dir().join("tools");
    let program = tools.join("bin/mdbook");
    let known = command::try_output(command::program(&program).arg("--version")).unwrap_or_default();
    if !known.contains(MDBOOK) {
        let mut cargo = command::cargo();
        cargo.args([
            "install",
            "--locked",
            "--force",
            "--no-default-features",
            "--features",
            "search",
            "--root",
        ]);
        cargo.arg(&tools).arg(format!("mdbook@{MDBOOK}"));
        command::run(cargo.env("CARGO_TARGET_DIR", tools.join("build")))?;
    }
    Ok(program)
}

/// Writes the book's source to `to`; gives the paths that its pages link to and mdBook does not copy.
fn stage(root: &Path, to: &Path) -> Result<BTreeSet<PathBuf>> {
    if to.exists() {
        fs::remove_dir_all(to).with_context(|| format!("can't empty {}", to.display()))?;
    }
    let summary = read(&root.join("SUMMARY.md"))?;
    let chapters = pages::chapters(&summary);
    let mut wanted = BTreeSet::new();
    for chapter in &chapters {
        let page = pages::staged(&read(&root.join(chapter))?, chapter, |path| {
            let target = pages::target(root, &chapters, path);
            match &target {
                Target::Picture => wanted.insert(path.to_path_buf()),
                Target::Source | Target::Folder => wanted.insert(path.to_path_buf()),
                Target::Chapter | Target::Documented(_) => false,
            };
            target
        });
        let page = page.with_context(|| chapter.display().to_string())?;
        write(&to.join("src").join(chapter), page.as_bytes())?;
    }
    write(&to.join("src/SUMMARY.md"), format!("{summary}- [The API](api.md)\n").as_bytes())?;
    write(&to.join("src/api.md"), API.as_bytes())?;
    write(&to.join("equations.css"), math::STYLE.as_bytes())?;
    write(&to.join("book.toml"), read(&root.join("book.toml"))?.as_bytes())?;
    Ok(wanted)
}

/// Puts the file or folder `path` of the project into the book: pictures as they are, all else as text.
fn copy_source(path: &Path, book: &Path) -> Result<()> {
    let from = command::root().join(path);
    if from.is_dir() {
        let files = command::output(command::program("git").args(["ls-files", "--"]).arg(path))?;
        let files: Vec<&Path> = files.lines().map(Path::new).filter(|file| is_text(file)).collect();
        files.iter().try_for_each(|file| copy_source(file, book))?;
        return write(&book.join(path).join("index.html"), pages::listing(path, &files).as_bytes());
    }
    let to = if pages::is_picture(path) { path.to_path_buf() } else { pages::as_text(path) };
    write(&book.join(to), &fs::read(&from).with_context(|| format!("can't read {}", from.display()))?)
}

fn is_text(path: &Path) -> bool {
    pages::is_picture(path)
        || fs::read(command::root().join(path)).is_ok_and(|bytes| String::from_utf8(bytes).is_ok())
}

/// Rustdoc's pages of the library and the estimator.
fn document(to: &Path) -> Result<()> {
    let mut doc = command::cargo();
    doc.args(["doc", "--locked", "--no-deps", "-p", "candela-renderer", "-p", "candela-shared", "--lib"]);
    command::run(&mut doc)?;
    copy_folder(&command::target_dir().join("doc"), to)
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    for entry in fs::read_dir(from).with_context(|| format!("can't read {}", from.display()))? {
        let entry = entry?;
        let to = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &to)?;
        } else {
            write(&to, &fs::read(entry.path())?)?;
        }
    }
    Ok(())
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("can't read {}", path.display()))
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder).with_context(|| format!("can't create {}", folder.display()))?;
    fs::write(path, bytes).with_context(|| format!("can't write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_page_is_staged_and_what_it_links_to_exists() {
        let to = std::env::temp_dir().join(format!("candela-xtask-site-{}", std::process::id()));
        let wanted = stage(&command::root(), &to).unwrap();
        assert!(wanted.contains(Path::new("docs/images/atrium.png")), "{wanted:?}");
        for path in wanted {
            assert!(command::root().join(&path).exists(), "{}", path.display());
        }
        let page = read(&to.join("src/docs/algorithm.md")).unwrap();
        assert!(page.contains("<math display=\"block\">") && !page.contains("```math"));
        for page in fs::read_dir(command::root().join("docs")).unwrap() {
            let page = page.unwrap().path();
            let name = page.file_name().unwrap();
            let staged =
                page.extension().is_none_or(|e| e != "md") || to.join("src/docs").join(name).exists();
            assert!(staged, "SUMMARY.md lacks docs/{}", name.display());
        }
        fs::remove_dir_all(to).unwrap();
    }
}
