//! Warnings, collected: equal ones share a line with their count.

use std::collections::HashSet;

/// Text of a warning, and the things it is about.
#[derive(Default)]
pub struct Warnings {
    entries: Vec<Entry>,
}

#[derive(Default)]
struct Entry {
    text: String,
    labels: HashSet<String>,
    named: Vec<String>,
    count: usize,
}

/// Things that a line names before it only counts them.
const NAMED: usize = 3;

impl Warnings {
    /// `text` holds for the thing that `label` names.
    pub fn add(&mut self, text: &str, label: &str) {
        self.entry(text, label);
    }

    /// As `add`, with a number of cases that are summed up.
    pub fn count(&mut self, text: &str, label: &str, cases: usize) {
        self.entry(text, label).count += cases;
    }

    /// All of `other`, said after what has been said so far.
    pub fn append(&mut self, other: Warnings) {
        for Entry { text, labels, named, count } in other.entries {
            let entry = self.entry_of(&text);
            entry.count += count;
            named.iter().chain(&labels).for_each(|label| entry.name(label));
        }
    }

    fn entry(&mut self, text: &str, label: &str) -> &mut Entry {
        let entry = self.entry_of(text);
        entry.name(label);
        entry
    }

    fn entry_of(&mut self, text: &str) -> &mut Entry {
        let i = self.entries.iter().position(|entry| entry.text == text).unwrap_or_else(|| {
            self.entries.push(Entry { text: text.to_owned(), ..Entry::default() });
            self.entries.len() - 1
        });
        &mut self.entries[i]
    }

    /// One line a text.
    pub fn into_lines(self) -> Vec<String> {
        self.entries.into_iter().map(|entry| super::one_line(&entry.line())).collect()
    }
}

impl Entry {
    fn name(&mut self, label: &str) {
        if self.labels.insert(label.to_owned()) && self.named.len() < NAMED {
            self.named.push(label.to_owned());
        }
    }

    fn line(&self) -> String {
        let count = if self.count > 0 { format!("{} ", self.count) } else { String::new() };
        let named = self.named.join(", ");
        match self.labels.len() {
            n if n > NAMED => format!("{count}{}: {named} and {} more", self.text, n - NAMED),
            _ => format!("{count}{}: {named}", self.text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alike_warnings_make_one_line() {
        let mut warnings = Warnings::default();
        for i in 0..5 {
            warnings.add("is grey", &format!("cat {i}"));
            warnings.add("is grey", "cat 0");
        }
        warnings.count("legs are missing", "dog", 1);
        warnings.count("legs are missing", "dog", 2);
        warnings.add("two\nlines", "x");
        // Said in parts, it is the same.
        let mut parts = Warnings::default();
        for i in 0..5 {
            let mut part = Warnings::default();
            part.add("is grey", &format!("cat {i}"));
            part.count("legs are missing", "dog", if i == 3 { 3 } else { 0 });
            parts.append(part);
        }
        assert_eq!(
            parts.into_lines(),
            ["is grey: cat 0, cat 1, cat 2 and 2 more", "3 legs are missing: dog"]
        );
        assert_eq!(
            warnings.into_lines(),
            ["is grey: cat 0, cat 1, cat 2 and 2 more", "3 legs are missing: dog", "two lines: x"]
        );
    }
}
