//! Compressed buffer views -> plain ones.

use super::meshopt::{self, FILTERS, Filter, Layout, MODES, Mode};
use super::shape::Mender;
use super::{Reason, label, schema};
use crate::parallel;
use serde_json::{Value, json};
use std::collections::HashMap;

/// The two names of the same extension.
const NAMES: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// What is compressed of a view; none if it is not.
pub fn of(view: &Value) -> Option<&Value> {
    let extensions = view.get("extensions")?;
    NAMES.iter().find_map(|name| extensions.get(name))
}

/// Decodes the compressed ones of `views`, on all processors, into buffers behind the others, and makes them views of
/// those. Gives the views that are broken, each with a reason.
pub fn decode(
    views: &mut Value,
    list: &mut Value,
    buffers: &mut Vec<Vec<u8>>,
    mender: &mut Mender,
) -> HashMap<usize, String> {
    let mut broken = HashMap::new();
    let mut tasks = Vec::new();
    for (i, view) in views.as_array().into_iter().flatten().enumerate() {
        let Some(mut extension) = of(view).cloned() else { continue };
        let label = label("buffer view", i, None);
        match mender.mend(&mut extension, &schema::MESHOPT, &label).and_then(|()| task(&extension)) {
            Ok((stream, layout)) => tasks.push((i, stream, layout)),
            Err(reason) => _ = broken.insert(i, reason),
        }
    }
    let source = &*buffers;
    let decoded = parallel::map(&tasks, |(_, stream, layout)| {
        let bytes = source.get(stream.buffer).and_then(|buffer| buffer.get(stream.start..stream.end));
        meshopt::decode(bytes.ok_or("its compressed bytes reach past their buffer")?, *layout)
    });
    for ((i, _, layout), bytes) in tasks.into_iter().zip(decoded) {
        let bytes = match bytes {
            Ok(bytes) => bytes,
            Err(reason) => {
                broken.insert(i, reason);
                continue;
            }
        };
        let mut view = json!({"buffer": buffers.len(), "byteLength": bytes.len()});
        // Of indices it is the size of one.
        if layout.mode == Mode::Attributes {
            view["byteStride"] = json!(layout.stride);
        }
        views[i] = view;
        if let Some(list) = list.as_array_mut() {
            list.push(json!({"byteLength": bytes.len()}));
        }
        buffers.push(bytes);
    }
    broken
}

/// Where a stream is.
struct Stream {
    buffer: usize,
    start: usize,
    end: usize,
}

fn task(extension: &Value) -> Reason<(Stream, Layout)> {
    let number = |name: &str| {
        let number = extension.get(name).and_then(Value::as_u64).unwrap_or_default();
        usize::try_from(number).map_err(|_| format!("{name} is too large"))
    };
    let text = |name: &str| extension.get(name).and_then(Value::as_str);
    let mode = MODES.iter().find(|(name, _)| text("mode") == Some(name)).map(|&(_, mode)| mode);
    let filter = FILTERS.iter().find(|(name, _)| text("filter") == Some(name)).map(|&(_, filter)| filter);
    let start = number("byteOffset")?;
    let end = start.checked_add(number("byteLength")?).ok_or("byteLength is too large")?;
    let layout = Layout {
        mode: mode.ok_or("it has no mode")?,
        filter: filter.unwrap_or(Filter::None),
        count: number("count")?,
        stride: number("byteStride")?,
    };
    Ok((Stream { buffer: number("buffer")?, start, end }, layout))
}
