//! Knobs as JSON documents (`--settings`, screenshots) and as options of the command line.

use super::{ALL, Knob, Knobs, Value};
use crate::error::{Error, Result};
use crate::files;
use std::path::Path;

impl Knobs {
    /// Reads a JSON document.
    pub fn read(path: &Path) -> Result<Self> {
        let text = files::read_text(path)?;
        let knobs: Knobs = serde_json::from_str(&text).map_err(Error::input(path))?;
        knobs.check().map_err(Error::input(path))?;
        Ok(knobs)
    }

    /// As a JSON document that [`Knobs::read`] takes.
    pub fn to_json(&self) -> String {
        // Numbers, words and truth values: nothing in them can fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// What the command line says to get these knobs from `base`.
    pub fn options(&self, base: &Knobs) -> Vec<String> {
        let changed = ALL.iter().filter(|knob| knob.value(self) != knob.value(base));
        changed.map(|knob| option(knob, knob.value(self))).collect()
    }
}

fn option(knob: &Knob, value: Value) -> String {
    let name = knob.name.replace('_', "-");
    match value {
        on if knob.is_flag() && on == knob.flag(true) => format!("--{name}"),
        off if knob.is_flag() && off == knob.flag(false) => format!("--no-{name}"),
        value => format!("--{name} {value}"),
    }
}
