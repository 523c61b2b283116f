//! Accessors, checked before they are read: the readers of the gltf crate trust the file.

use super::Reason;
use gltf::accessor::sparse::{IndexType, Sparse};
use gltf::accessor::{DataType, Dimensions};
use gltf::{Accessor, buffer};

/// Elements of an accessor that has only sparse values: nothing in the file bounds their number, so this does.
const MAX_IMPLICIT_COUNT: usize = 1 << 24;

/// Checks that `accessor` has one of the `types` and that each byte it stands for exists.
/// Errors name the accessor and what is out of what.
pub fn check(accessor: &Accessor, types: &[(Dimensions, DataType)], buffers: &[Vec<u8>]) -> Reason<()> {
    check_content(accessor, types, buffers)
        .map_err(|reason| format!("accessor {}: {reason}", accessor.index()))
}

fn check_content(accessor: &Accessor, types: &[(Dimensions, DataType)], buffers: &[Vec<u8>]) -> Reason<()> {
    let (dimensions, data_type) = (accessor.dimensions(), accessor.data_type());
    if !types.contains(&(dimensions, data_type)) {
        return Err(format!("{dimensions:?} of {data_type:?} is not allowed here"));
    }
    let count = accessor.count();
    if count == 0 {
        return Err("has no elements".into());
    }
    match (accessor.view(), accessor.sparse()) {
        (Some(view), _) => check_range(&view, accessor.offset(), count, accessor.size(), buffers)?,
        (None, Some(_)) if count <= MAX_IMPLICIT_COUNT => {}
        (None, Some(_)) => return Err(format!("{count} elements without a buffer view are too many")),
        (None, None) => return Err("has no buffer view".into()),
    }
    match accessor.sparse() {
        Some(sparse) => check_sparse(&sparse, count, accessor.size(), buffers),
        None => Ok(()),
    }
}

/// `count` (> 0) elements of `size` bytes from `offset` on must lie inside `view`, and it inside its buffer.
fn check_range(
    view: &buffer::View,
    offset: usize,
    count: usize,
    size: usize,
    buffers: &[Vec<u8>],
) -> Reason<()> {
    let (index, length) = (view.index(), view.length());
    bytes_of(view, buffers)?;
    let stride = view.stride().unwrap_or(size);
    if stride < size {
        return Err(format!(
            "buffer view {index}: a stride of {stride} bytes is less than an element of {size}"
        ));
    }
    let end =
        stride.checked_mul(count - 1).and_then(|n| n.checked_add(size)).and_then(|n| n.checked_add(offset));
    match end {
        Some(end) if end <= length => Ok(()),
        _ => Err(format!("{count} elements reach past buffer view {index} of {length} bytes")),
    }
}

/// The bytes of a buffer view.
pub fn bytes_of<'b>(view: &buffer::View, buffers: &'b [Vec<u8>]) -> Reason<&'b [u8]> {
    let (index, buffer) = (view.index(), view.buffer().index());
    let end = view.offset().checked_add(view.length());
    end.and_then(|end| buffers[buffer].get(view.offset()..end)).ok_or_else(|| {
        format!("buffer view {index} reaches past buffer {buffer} of {} bytes", buffers[buffer].len())
    })
}

fn check_sparse(sparse: &Sparse, count: usize, size: usize, buffers: &[Vec<u8>]) -> Reason<()> {
    let changed = sparse.count();
    if changed == 0 || changed > count {
        return Err(format!("{changed} sparse values for {count} elements"));
    }
    let (indices, values) = (sparse.indices(), sparse.values());
    let index_size = match indices.index_type() {
        IndexType::U8 => 1,
        IndexType::U16 => 2,
        IndexType::U32 => 4,
    };
    check_range(&indices.view(), indices.offset(), changed, index_size, buffers)?;
    check_range(&values.view(), values.offset(), changed, size, buffers)?;
    let bytes = &bytes_of(&indices.view(), buffers)?[indices.offset()..];
    let stride = indices.view().stride().unwrap_or(index_size);
    let index = |i: usize| {
        bytes[i * stride..][..index_size].iter().rev().fold(0, |n, &byte| n << 8 | usize::from(byte))
    };
    // The reader walks both lists at once: out of order, a value would be lost without a word.
    if (1..changed).any(|i| index(i) <= index(i - 1)) || index(changed - 1) >= count {
        return Err(format!("sparse indices must increase and stay below {count}"));
    }
    Ok(())
}
