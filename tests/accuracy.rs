//! docs/accuracy.md names tests that exist.

use std::path::{Path, PathBuf};

/// `file::test` for every test that the page names in backquotes.
fn named(page: &str) -> Vec<(String, String)> {
    let quoted = page.split('`').skip(1).step_by(2);
    let name = |quote: &str| {
        let (file, test) = quote.rsplit_once("::")?;
        let plain = |s: &str| s.chars().all(|c| c.is_ascii_alphanumeric() || "_/.".contains(c));
        (file.ends_with(".rs") && plain(file) && plain(test)).then(|| (file.to_owned(), test.to_owned()))
    };
    quoted.filter_map(name).collect()
}

fn missing(root: &Path, page: &str) -> Vec<String> {
    let exists = |(file, test): &(String, String)| {
        let source = std::fs::read_to_string(root.join(file)).unwrap_or_default();
        source.contains(&format!("#[test]\nfn {test}()"))
            || source.contains(&format!("#[test]\n    fn {test}()"))
    };
    let named = named(page).into_iter().filter(|name| !exists(name));
    named.map(|(file, test)| format!("{file}::{test}")).collect()
}

#[test]
fn every_test_that_the_page_names_exists() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = std::fs::read_to_string(root.join("docs/accuracy.md")).expect("docs/accuracy.md");
    assert!(named(&page).len() > 30, "the page names its tests as `file.rs::test`");
    assert_eq!(
        missing(&root, &page),
        Vec::<String>::new(),
        "tests named in docs/accuracy.md that are not there"
    );
    // Negative control.
    let planted = page + "`tests/pixels.rs::no_such_test` `tests/no_such_file.rs::a_test`";
    assert_eq!(missing(&root, &planted).len(), 2);
}
