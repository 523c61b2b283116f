//! What cells of the world learn from the frame before, see [`crate::cells`]. The first frame of a history knows nothing.

use super::At;
use crate::cells::belief;
use crate::cells::list::{self, ListEntry};

/// A belief with what the frame before observed; and no observation.
pub fn learn_beliefs(at: At<'_>, belief: u32, observed: u32) -> (u32, u32) {
    if at.frame.index == 0 {
        return (0, 0);
    }
    (belief::learned(belief, observed), 0)
}

/// An entry of a cell's list with what the frame before found; and no finding.
pub fn learn_lists(at: At<'_>, entry: ListEntry, finding: u32) -> (ListEntry, u32) {
    if at.frame.index == 0 {
        return (ListEntry::default(), 0);
    }
    (list::learned(entry, finding), 0)
}
