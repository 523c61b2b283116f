//! The pages say what is there: the code that they name, and the files that they link to.

use std::fs;
use std::path::{Path, PathBuf};
use tests::docs::{code_spans, dangling_links, dangling_names, files, pages, workspace};
use tests::equations::{contradictions, items, items_of, wrong_numbers};

#[test]
fn pages_name_code_that_exists() {
    let page = fs::read_to_string(workspace().join("docs/algorithm.md")).unwrap();
    let names = code_spans(&page).iter().filter(|span| span.contains("::")).count();
    assert!(names >= 60, "{names} names are few for a page that ties each equation to a function and a test");
    for page in ["docs/algorithm.md", "docs/accuracy.md"] {
        // A page that is not written yet names nothing.
        let Ok(text) = fs::read_to_string(workspace().join(page)) else { continue };
        let dangling = dangling_names(&text);
        assert!(dangling.is_empty(), "{page} names what is not there: {dangling:?}");
    }
}

/// Negative control: each kind of wrong name is seen, each kind of right one is not.
#[test]
fn wrong_names_are_seen() {
    let right = "`reservoir::Reservoir::add` `light::tile::presample` `light::tests::memory_is_as_documented` `math::safe_ratio`
        `reservoir::tests::survivors_follow_their_weights` `tests/statistics.rs::a_planted_bias_is_seen` `light::tile::TILES`
        `passes::spatial::spatial` `spatial::spatial` `not a path` `f32`";
    assert_eq!(dangling_names(right), Vec::<String>::new());
    let wrong = "`reservoir::Reservoir::gone` `light::tile::gone` `gone::add` `reservoir::Gone::add` `tests/gone.rs::add`
        `tests/statistics.rs::gone` `reservoir::gone::add`";
    assert_eq!(dangling_names(wrong).len(), 7, "{:?}", dangling_names(wrong));
}

#[test]
fn links_lead_somewhere() {
    let pages = pages();
    assert!(pages.len() >= 5, "{pages:?}");
    for path in pages {
        let dangling = dangling_links(&path, &fs::read_to_string(&path).unwrap());
        assert!(dangling.is_empty(), "{}: {dangling:?}", path.display());
    }
    let here = workspace().join("README.md");
    let page = "# Above all\n[a](docs) [b](gone.md) [c](https://example.org) [d](#above-all) [e](#gone) [f](docs/gone.md#there)
        [g](docs/town.md#the-town) [h](docs/town.md#gone)";
    let dangling = dangling_links(&here, page);
    assert_eq!(dangling, ["gone.md", "#gone", "docs/gone.md#there", "docs/town.md#gone"]);
}

fn algorithm() -> String {
    fs::read_to_string(workspace().join("docs/algorithm.md")).expect("the page is there")
}

/// Equations are numbered one after another, the table has a row for each, and each of the thesis's is in some row.
#[test]
fn equations_are_numbered() {
    let page = algorithm();
    assert_eq!(wrong_numbers(&page), Vec::<String>::new());
    // Negative controls: a number left out, a row left out, an equation of the thesis left out, a row without function.
    for (right, wrong) in [
        ("\\tag{15}", "\\tag{13a}"),
        ("| (16) weight", "| weight"),
        ("(4.22)", "section 4.1.4"),
        ("`target::unshadowed`", "the integrand"),
    ] {
        assert_ne!(wrong_numbers(&page.replace(right, wrong)), Vec::<String>::new(), "{right}");
    }
}

/// The functions of the table name its equations in their doc comments, and what doc comments name is in the table.
#[test]
fn equations_and_doc_comments_agree() {
    let (page, items) = (algorithm(), items());
    assert_eq!(contradictions(&page, &items), Vec::<String>::new());
    assert!(items.len() >= 25, "{} functions name equations", items.len());
    // Negative controls, the table against the code: another function, a number that no doc comment has, one left out.
    for (right, wrong) in [
        ("`shading::contribution` |", "`shading::Average::add` |"),
        ("| (6) | (4.17) |", "| (6), (7) | (4.17) |"),
        ("| (6) | (4.17) |", "| (6) | – |"),
    ] {
        assert_ne!(contradictions(&page.replace(right, wrong), &items), Vec::<String>::new(), "{right}");
    }
    // The code against the table: a function that names an equation of the table, unknown to it; and one of no table.
    for comment in ["Equation (10): Bitterli (6).", "Equation (99)."] {
        let text = format!(
            "impl<'a> Other<'a> {{\n    /// What.\n    ///\n    /// {comment}\n    #[inline]\n    pub fn gone() {{}}\n}}\n"
        );
        let planted = [items.clone(), items_of(Path::new("shared/src/other.rs"), &text)].concat();
        assert_eq!(contradictions(&page, &planted).len(), 1, "{comment}");
    }
}

/// Files below `folders` that name `word` in the program: not in comments or tests.
fn places(word: &str, folders: &[&str]) -> Vec<String> {
    let sources = folders.iter().flat_map(|folder| files(&workspace().join(folder), "rs"));
    let names = |file: &PathBuf| fs::read_to_string(file).is_ok_and(|text| is_named(word, &text));
    let inside =
        |file: PathBuf| file.strip_prefix(workspace()).expect("a file of the project").display().to_string();
    let mut found: Vec<_> =
        sources.filter(names).map(inside).filter(|file| !file.contains("tests")).collect();
    found.sort();
    found
}

fn is_named(word: &str, text: &str) -> bool {
    let program = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut lines = program.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.any(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_').any(|found| found == word))
}

/// A pass, a buffer and a knob are written where the pages say, and used by who needs them; nothing else names them.
#[test]
fn recipes_name_every_place() {
    // The viewer, where `accumulate` has its place in the frame, and plans have other things of that name.
    let gpu = ["shared/src", "shaders/src", "runner/src/frame", "runner/src/vulkan"];
    let all =
        ["shared/src", "shaders/src", "runner/src", "runner/lab/src", "runner/viewer/src", "runner/cli/src"];
    for (word, folders, written, used) in [
        (
            "accumulate",
            &gpu[..],
            &["shared/src/passes/accumulate.rs", "shared/src/passes/mod.rs", "shared/src/passes/table.rs"][..],
            &["runner/src/frame/renderer.rs"][..],
        ),
        (
            "direct_specular",
            &all,
            &["shared/src/resources.rs"],
            &[
                "runner/cli/src/accumulation.rs",
                "shared/src/passes/denoise/temporal.rs",
                "shared/src/passes/resolve.rs",
                "shared/src/passes/table.rs",
            ],
        ),
        (
            "history_cap",
            &all,
            &["shared/src/knobs.rs"],
            &["shared/src/frame.rs", "shared/src/resampling/confidence.rs"],
        ),
    ] {
        let mut expected = [written, used].concat();
        expected.sort();
        assert_eq!(places(word, folders), expected, "{word}");
    }
    // Negative control.
    assert!(is_named("cap", "let a = self.cap(1);") && !is_named("cap", "// cap\ncapped cap_1"));
}

/// Examples of the pages are the code that they are taken from.
#[test]
fn examples_stand_in_the_code() {
    let folded = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let program: Vec<_> = files(&workspace().join("shared/src"), "rs")
        .iter()
        .map(|file| folded(&fs::read_to_string(file).unwrap()))
        .collect();
    let is_there = |example: &str| program.iter().any(|text| text.contains(&folded(example)));
    for page in ["docs/adding-a-pass.md", "docs/adding-a-buffer.md"] {
        let text = fs::read_to_string(workspace().join(page)).unwrap();
        let examples: Vec<_> =
            text.split("```rust").skip(1).filter_map(|rest| rest.split("```").next()).collect();
        assert!(!examples.is_empty());
        for example in examples {
            let code: Vec<_> = example.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
            assert!(is_there(&code.join("\n")), "{page}:\n{example}");
            // Negative control.
            assert!(!is_there(&code.join("\n").replace(')', "]")));
        }
    }
}
