//! Accessors -> numbers. Every offset and count of a file is checked.

use super::Reason;
use gltf::accessor::sparse::{IndexType, Sparse};
use gltf::accessor::{DataType, Dimensions};
use gltf::{Accessor, buffer};

/// Elements of an accessor that has no bytes for all of them: nothing in the file bounds their number, so this does.
const MAX_IMPLICIT_COUNT: usize = 1 << 24;

/// What integers stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integers {
    /// Nothing: only floats are allowed.
    None,
    /// Parts of their largest value, whether the file says so or not.
    Normalized,
    /// The same if the accessor says so, else themselves (KHR_mesh_quantization).
    AsDeclared,
}

/// The first N components of all elements; those that an element lacks are 1. `dimensions` are the allowed ones.
/// Errors name the accessor and what is out of what.
pub fn floats<const N: usize>(
    accessor: &Accessor,
    dimensions: &[Dimensions],
    integers: Integers,
    buffers: &[Vec<u8>],
) -> Reason<Vec<[f32; N]>> {
    let data = accessor.data_type();
    let allowed = match data {
        DataType::F32 => true,
        DataType::U32 => false,
        _ => integers != Integers::None,
    };
    let normalized = integers == Integers::Normalized || accessor.normalized();
    let read = |bytes: &[u8]| match data {
        DataType::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        DataType::U32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32,
        DataType::U8 => scaled(f32::from(bytes[0]), 255.0, normalized),
        DataType::I8 => scaled(f32::from(bytes[0] as i8), 127.0, normalized),
        DataType::U16 => scaled(f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0, normalized),
        DataType::I16 => scaled(f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0, normalized),
    };
    let size = data.size();
    let kept = accessor.dimensions().multiplicity().min(N);
    let element = |bytes: &[u8]| {
        let mut element = [1.0; N];
        for (i, x) in element.iter_mut().enumerate().take(kept) {
            *x = read(&bytes[i * size..]);
        }
        element
    };
    let mut zero = [1.0; N];
    zero[..kept].fill(0.0);
    elements(accessor, allowed && dimensions.contains(&accessor.dimensions()), zero, element, buffers)
        .map_err(|reason| format!("accessor {}: {reason}", accessor.index()))
}

/// Indices of vertices, 8 to 32 bits wide. Errors as those of [`floats`].
pub fn indices(accessor: &Accessor, buffers: &[Vec<u8>]) -> Reason<Vec<u32>> {
    let data = accessor.data_type();
    let allowed = matches!(data, DataType::U8 | DataType::U16 | DataType::U32);
    let size = data.size();
    let element = |bytes: &[u8]| whole(&bytes[..size]) as u32;
    elements(accessor, allowed && accessor.dimensions() == Dimensions::Scalar, 0, element, buffers)
        .map_err(|reason| format!("accessor {}: {reason}", accessor.index()))
}

/// An integer as a part of `most`, if it is normalized (glTF 2.0, 3.6.2.2: the least of signed ones is -1 too).
fn scaled(x: f32, most: f32, normalized: bool) -> f32 {
    if normalized { (x / most).max(-1.0) } else { x }
}

/// A little-endian unsigned integer.
fn whole(bytes: &[u8]) -> usize {
    bytes.iter().rev().fold(0, |n, &byte| n << 8 | usize::from(byte))
}

/// All elements: those of the buffer view or `zero`, then the sparse ones in their places.
fn elements<T: Copy>(
    accessor: &Accessor,
    allowed: bool,
    zero: T,
    element: impl Fn(&[u8]) -> T,
    buffers: &[Vec<u8>],
) -> Reason<Vec<T>> {
    let (count, size) = (accessor.count(), accessor.size());
    if count == 0 {
        return Err("has no elements".into());
    }
    if !allowed {
        let (dimensions, data) = (accessor.dimensions(), accessor.data_type());
        return Err(format!("{dimensions:?} of {data:?} is not allowed here"));
    }
    let mut all = match accessor.view() {
        Some(view) => {
            let (bytes, stride) = range(&view, accessor.offset(), count, size, buffers)?;
            // The last element may end before its stride does.
            bytes.chunks(stride).take(count).map(element_of(&element, size)).collect()
        }
        None if count <= MAX_IMPLICIT_COUNT => vec![zero; count],
        None => return Err(format!("{count} elements without a buffer view are too many")),
    };
    if let Some(sparse) = accessor.sparse() {
        fill_sparse(&mut all, &sparse, size, &element, buffers)?;
    }
    Ok(all)
}

fn element_of<'a, T>(element: &'a impl Fn(&[u8]) -> T, size: usize) -> impl Fn(&[u8]) -> T + 'a {
    move |bytes| element(&bytes[..size])
}

fn fill_sparse<T>(
    all: &mut [T],
    sparse: &Sparse,
    size: usize,
    element: &impl Fn(&[u8]) -> T,
    buffers: &[Vec<u8>],
) -> Reason<()> {
    let changed = sparse.count();
    if changed == 0 || changed > all.len() {
        return Err(format!("{changed} sparse values for {} elements", all.len()));
    }
    let (indices, values) = (sparse.indices(), sparse.values());
    let index_size = match indices.index_type() {
        IndexType::U8 => 1,
        IndexType::U16 => 2,
        IndexType::U32 => 4,
    };
    let (places, place_stride) = range(&indices.view(), indices.offset(), changed, index_size, buffers)?;
    let (values, stride) = range(&values.view(), values.offset(), changed, size, buffers)?;
    let count = all.len();
    for (place, value) in places.chunks(place_stride).zip(values.chunks(stride)).take(changed) {
        let place = whole(&place[..index_size]);
        let slot = all.get_mut(place).ok_or_else(|| format!("sparse index {place} for {count} elements"))?;
        *slot = element(&value[..size]);
    }
    Ok(())
}

/// The bytes of `count` (> 0) elements of `size` bytes from `offset` on, and their stride.
fn range<'b>(
    view: &buffer::View,
    offset: usize,
    count: usize,
    size: usize,
    buffers: &'b [Vec<u8>],
) -> Reason<(&'b [u8], usize)> {
    let (index, length) = (view.index(), view.length());
    let bytes = bytes_of(view, buffers)?;
    let stride = view.stride().unwrap_or(size);
    if stride < size {
        return Err(format!(
            "buffer view {index}: a stride of {stride} bytes is less than an element of {size}"
        ));
    }
    let end =
        stride.checked_mul(count - 1).and_then(|n| n.checked_add(size)).and_then(|n| n.checked_add(offset));
    let bytes = end.and_then(|end| bytes.get(offset..end));
    Ok((
        bytes.ok_or_else(|| format!("{count} elements reach past buffer view {index} of {length} bytes"))?,
        stride,
    ))
}

/// The bytes of a buffer view.
pub fn bytes_of<'b>(view: &buffer::View, buffers: &'b [Vec<u8>]) -> Reason<&'b [u8]> {
    let buffer = buffers.get(view.buffer().index()).map_or(&[][..], Vec::as_slice);
    let end = view.offset().checked_add(view.length());
    end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
        let (index, buffer_index) = (view.index(), view.buffer().index());
        format!("buffer view {index} reaches past buffer {buffer_index} of {} bytes", buffer.len())
    })
}
