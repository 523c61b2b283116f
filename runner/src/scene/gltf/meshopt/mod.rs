//! Compressed buffer views (EXT_meshopt_compression, KHR_meshopt_compression; the sections named below are the latter's).

mod filters;
mod indices;
#[cfg(test)]
mod tests;
mod vertices;

use super::Reason;

/// Bytes that one view may decode to: a stream of some kB can ask for a thousand times its size.
const MAX_DECODED: usize = 1 << 31;

/// How a view is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    pub mode: Mode,
    pub filter: Filter,
    /// Elements.
    pub count: usize,
    /// Bytes of an element.
    pub stride: usize,
}

/// What a stream holds (appendix A).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// What its elements become once they are decoded (appendix B).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

/// The names that files use.
pub const MODES: [(&str, Mode); 3] =
    [("ATTRIBUTES", Mode::Attributes), ("TRIANGLES", Mode::Triangles), ("INDICES", Mode::Indices)];
pub const FILTERS: [(&str, Filter); 5] = [
    ("NONE", Filter::None),
    ("OCTAHEDRAL", Filter::Octahedral),
    ("QUATERNION", Filter::Quaternion),
    ("EXPONENTIAL", Filter::Exponential),
    ("COLOR", Filter::Color),
];

/// The `count` x `stride` bytes that `stream` stands for. Errors: a layout that makes no sense, a broken stream.
pub fn decode(stream: &[u8], layout: Layout) -> Reason<Vec<u8>> {
    let Layout { mode, filter, count, stride } = layout;
    let fits = match mode {
        Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
        Mode::Triangles => matches!(stride, 2 | 4) && count.is_multiple_of(3),
        Mode::Indices => matches!(stride, 2 | 4),
    };
    let filters = match filter {
        Filter::None => true,
        Filter::Octahedral | Filter::Color => mode == Mode::Attributes && matches!(stride, 4 | 8),
        Filter::Quaternion => mode == Mode::Attributes && stride == 8,
        Filter::Exponential => mode == Mode::Attributes,
    };
    if !(fits && filters) {
        return Err(format!(
            "{count} elements of {stride} bytes can't be {mode:?} with the filter {filter:?}"
        ));
    }
    if count.checked_mul(stride).is_none_or(|bytes| bytes > MAX_DECODED) {
        return Err(format!("{count} elements of {stride} bytes are too many"));
    }
    let broken = || format!("broken stream of {mode:?}");
    let mut decoded = match mode {
        Mode::Attributes => vertices::decode(stream, count, stride),
        Mode::Triangles => indices::triangles(stream, count).map(|indices| narrow(&indices, stride)),
        Mode::Indices => indices::sequence(stream, count).map(|indices| narrow(&indices, stride)),
    }
    .ok_or_else(broken)?;
    filters::apply(filter, stride, &mut decoded);
    Ok(decoded)
}

/// Indices as little-endian integers of `stride` bytes.
fn narrow(indices: &[u32], stride: usize) -> Vec<u8> {
    indices.iter().flat_map(|index| index.to_le_bytes().into_iter().take(stride)).collect()
}

/// Takes `count` bytes off the front; none if there are fewer.
fn take<'s>(stream: &mut &'s [u8], count: usize) -> Option<&'s [u8]> {
    let (head, tail) = stream.split_at_checked(count)?;
    *stream = tail;
    Some(head)
}
