//! What the window can show of a frame.

use super::knobs::Step;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    Final,
    /// Every light of every pixel, accumulated.
    Reference,
}

impl View {
    pub const ALL: &[View] = &[View::Final, View::Reference];

    pub fn name(self) -> &'static str {
        match self {
            View::Final => "Final",
            View::Reference => "Reference",
        }
    }

    /// Is it made with the reference?
    pub fn needs_reference(self) -> bool {
        self == View::Reference
    }

    /// The next one or the one before, around and around.
    pub fn step(self, step: Step) -> View {
        let at = View::ALL.iter().position(|&v| v == self).unwrap_or(0);
        let count = View::ALL.len();
        View::ALL[if step == Step::Up { at + 1 } else { at + count - 1 } % count]
    }
}

/// What stands right of the divider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    Off,
    /// The second settings.
    Settings,
    Reference,
}

impl Split {
    pub const ALL: [Split; 3] = [Split::Off, Split::Settings, Split::Reference];

    pub fn name(self) -> &'static str {
        match self {
            Split::Off => "off",
            Split::Settings => "two settings",
            Split::Reference => "reference",
        }
    }

    pub fn next(self) -> Split {
        match self {
            Split::Off => Split::Settings,
            Split::Settings => Split::Reference,
            Split::Reference => Split::Off,
        }
    }
}
