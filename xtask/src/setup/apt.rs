//! Debian's package sources: both file formats, and the backports source that a machine's own mirror offers.

use anyhow::{Context, Result};

/// One enabled binary source (`deb`) of sources.list(5).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    pub uris: Vec<String>,
    pub suites: Vec<String>,
    pub components: Vec<String>,
    /// A key ring's path, or a whole key with its line breaks.
    pub signed_by: Option<String>,
}

/// The one-line format: `deb [option=value ..] uri suite component ..`.
pub fn parse_list(text: &str) -> Vec<Source> {
    text.lines().filter_map(parse_list_line).collect()
}

fn parse_list_line(line: &str) -> Option<Source> {
    let line = line.split('#').next()?.trim();
    let rest = line.strip_prefix("deb").filter(|rest| rest.starts_with([' ', '\t', '[']))?.trim_start();
    let (options, rest) = match rest.strip_prefix('[') {
        Some(rest) => rest.split_once(']')?,
        None => ("", rest),
    };
    let mut words = rest.split_whitespace().map(String::from);
    let signed_by = options.split_whitespace().find_map(|option| option.strip_prefix("signed-by="));
    Some(Source {
        uris: vec![words.next()?],
        suites: vec![words.next()?],
        components: words.collect(),
        signed_by: signed_by.map(String::from),
    })
}

/// The deb822 format: stanzas of `Field: value`, continued on indented lines.
pub fn parse_deb822(text: &str) -> Vec<Source> {
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    lines.split(|line| line.trim().is_empty()).filter_map(parse_stanza).collect()
}

fn parse_stanza(lines: &[&str]) -> Option<Source> {
    let mut fields: Vec<(String, String)> = Vec::new();
    for line in lines {
        if line.starts_with([' ', '\t']) {
            let (_, value) = fields.last_mut()?;
            value.push('\n');
            value.push_str(line);
        } else {
            let (name, value) = line.split_once(':')?;
            fields.push((name.trim().to_ascii_lowercase(), value.trim().to_string()));
        }
    }
    let field = |name: &str| fields.iter().find(|(field, _)| field == name).map(|(_, value)| value.as_str());
    let words =
        |name: &str| field(name).unwrap_or("").split_whitespace().map(String::from).collect::<Vec<_>>();
    let enabled = !field("enabled").is_some_and(|value| value.eq_ignore_ascii_case("no"));
    (enabled && words("types").iter().any(|kind| kind == "deb")).then(|| Source {
        uris: words("uris"),
        suites: words("suites"),
        components: words("components"),
        signed_by: field("signed-by").map(String::from),
    })
}

/// Is the suite in use, with its `main` component?
pub fn offers(sources: &[Source], suite: &str) -> bool {
    find(sources, suite).is_some()
}

/// The text of a deb822 file for `<codename>-backports`, on the mirror and with the key that serve `<codename>`.
///
/// # Errors
/// No source serves `<codename> main`.
pub fn backports_file(sources: &[Source], codename: &str) -> Result<String> {
    let base = find(sources, codename).with_context(|| {
        format!("no apt source serves '{codename} main'; add one for {codename}-backports by hand, then run this again")
    })?;
    let mut text = format!(
        "# Candela: a Mesa whose software driver traces rays (cargo xtask setup).\nTypes: deb\nURIs: {}\nSuites: {codename}-backports\nComponents: main\n",
        base.uris.join(" ")
    );
    if let Some(key) = &base.signed_by {
        text.push_str(&format!("Signed-By: {key}\n"));
    }
    Ok(text)
}

fn find<'a>(sources: &'a [Source], suite: &str) -> Option<&'a Source> {
    let has = |words: &[String], wanted: &str| words.iter().any(|word| word == wanted);
    sources.iter().find(|source| has(&source.suites, suite) && has(&source.components, "main"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(String::from).collect()
    }

    /// The file that Debian's own container image ships.
    const DEBIAN_12: &str = "\
Types: deb
# http://snapshot.debian.org/archive/debian/20250520T000000Z
URIs: http://deb.debian.org/debian
Suites: bookworm bookworm-updates
Components: main
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg

Types: deb
URIs: http://deb.debian.org/debian-security
Suites: bookworm-security
Components: main
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg
";

    #[test]
    fn deb822_stanzas() {
        let sources = parse_deb822(DEBIAN_12);
        assert_eq!(sources.len(), 2);
        assert_eq!(
            sources[0],
            Source {
                uris: words("http://deb.debian.org/debian"),
                suites: words("bookworm bookworm-updates"),
                components: words("main"),
                signed_by: Some("/usr/share/keyrings/debian-archive-keyring.gpg".into()),
            }
        );
        assert_eq!(sources[1].suites, words("bookworm-security"));
    }

    #[test]
    fn deb822_skips_disabled_and_source_only_stanzas() {
        let disabled = DEBIAN_12.replace("Components", "Enabled: no\nComponents");
        assert_eq!(parse_deb822(&disabled), []);
        assert_eq!(parse_deb822(&DEBIAN_12.replace("Types: deb", "Types: deb-src")), []);
        assert_eq!(parse_deb822(&DEBIAN_12.replace("Types: deb", "types:\tdeb deb-src")).len(), 2);
        assert_eq!(parse_deb822("garbage\n\n indented\n\n\n"), []);
    }

    #[test]
    fn one_line_format() {
        let text = "\
# deb http://off.example/debian bookworm main
deb-src http://deb.debian.org/debian bookworm main
deb\thttp://deb.debian.org/debian bookworm main contrib # the mirror
deb [arch=amd64 signed-by=/etc/apt/keyrings/a.gpg] https://mirror.example/debian bookworm main
deb broken
";
        let sources = parse_list(text);
        assert_eq!(sources.len(), 2);
        assert_eq!(sources[0].components, words("main contrib"));
        assert_eq!(sources[0].signed_by, None);
        assert_eq!(sources[1].uris, words("https://mirror.example/debian"));
        assert_eq!(sources[1].signed_by.as_deref(), Some("/etc/apt/keyrings/a.gpg"));
    }

    #[test]
    fn backports_come_from_the_same_mirror_with_the_same_key() {
        let mirrored = DEBIAN_12.replace("deb.debian.org/debian\n", "mirror.example/d\n");
        let text = backports_file(&parse_deb822(&mirrored), "bookworm").unwrap();
        let [written] = parse_deb822(&text).try_into().unwrap();
        let expected = Source {
            uris: words("http://mirror.example/d"),
            suites: words("bookworm-backports"),
            components: words("main"),
            signed_by: Some("/usr/share/keyrings/debian-archive-keyring.gpg".into()),
        };
        assert_eq!(written, expected);
        assert!(offers(&[written], "bookworm-backports"));
        assert!(!offers(&parse_deb822(&mirrored), "bookworm-backports"));
    }

    #[test]
    fn a_key_inside_the_file_keeps_its_lines() {
        let key = "\n -----BEGIN PGP PUBLIC KEY BLOCK-----\n .\n mDMEY\n -----END PGP PUBLIC KEY BLOCK-----";
        let inline = DEBIAN_12.replacen(" /usr/share/keyrings/debian-archive-keyring.gpg", key, 1);
        let text = backports_file(&parse_deb822(&inline), "bookworm").unwrap();
        assert!(text.contains(&format!("Signed-By: {key}\n")), "{text}");
        assert_eq!(parse_deb822(&text)[0].signed_by.as_deref(), Some(key));
    }

    #[test]
    fn no_source_for_the_suite_is_an_error_that_names_it() {
        let error = backports_file(&parse_deb822(DEBIAN_12), "bullseye").unwrap_err().to_string();
        assert!(error.contains("'bullseye main'"), "{error}");
        // The security mirror carries no backports.
        assert!(!offers(&parse_deb822(DEBIAN_12)[1..], "bookworm"));
    }
}
