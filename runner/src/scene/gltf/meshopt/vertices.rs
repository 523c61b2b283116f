//! Attributes (A, mode 0): differences of consecutive elements, byte by byte, in groups of 16.

use super::take;

/// Elements of a group.
const GROUP: usize = 16;
/// Elements of a block, at most.
const BLOCK: usize = 256;
/// Bytes of a channel: what is decoded together.
const CHANNEL: usize = 4;

/// `count` elements of `stride` bytes (a multiple of [`CHANNEL`]); none if the stream is broken.
pub fn decode(stream: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (version, least_tail) = match *stream.first()? {
        0xa0 => (0, 32),
        0xa1 => (1, 24),
        _ => return None,
    };
    let channels = stride / CHANNEL;
    let modes_length = if version == 1 { channels } else { 0 };
    let tail_length = stride + modes_length;
    let tail = stream.get(stream.len().checked_sub(tail_length).filter(|&at| at > 0)?..)?;
    let (mut previous, modes) = (tail[..stride].to_vec(), &tail[stride..]);
    let body_end = stream.len().checked_sub(tail_length.max(least_tail))?;
    let mut body = stream.get(1..body_end)?;
    let mode_of = |channel: usize| modes.get(channel).copied().unwrap_or(0);
    if !(0..channels).all(|channel| matches!(mode_of(channel), 0 | 1) || mode_of(channel) & 15 == 2) {
        return None;
    }
    let block_length = ((8192 / stride) & !(GROUP - 1)).min(BLOCK);
    // Each block takes some bytes: what a short stream asks for beyond them is not there.
    let blocks = count.div_ceil(block_length);
    let header = if version == 1 { channels } else { stride };
    if blocks.checked_mul(header)? > body.len() {
        return None;
    }
    let mut decoded = vec![0; count * stride];
    for block in decoded.chunks_mut(block_length * stride) {
        let controls = if version == 1 { Some(take(&mut body, channels)?) } else { None };
        for channel in 0..channels {
            let mut deltas = [[0; BLOCK]; CHANNEL];
            for (byte, deltas) in deltas.iter_mut().enumerate() {
                let control = controls.map(|controls| controls[channel] >> (2 * byte) & 3);
                read_deltas(&mut body, control, deltas, block.len() / stride)?;
            }
            let previous = &mut previous[channel * CHANNEL..][..CHANNEL];
            accumulate(
                &deltas,
                mode_of(channel),
                previous,
                block.chunks_exact_mut(stride).map(|element| &mut element[channel * CHANNEL..][..CHANNEL]),
            );
        }
    }
    body.is_empty().then_some(decoded)
}

/// The differences of one byte of the `count` elements of a block, still zigzag-encoded. `control` is that of version 1.
fn read_deltas(body: &mut &[u8], control: Option<u8>, deltas: &mut [u8; BLOCK], count: usize) -> Option<()> {
    let bits: [u32; 4] = match control {
        None => [0, 2, 4, 8],
        Some(0) => [0, 1, 2, 4],
        Some(1) => [1, 2, 4, 8],
        Some(2) => return Some(()),
        Some(_) => {
            deltas[..count].copy_from_slice(take(body, count)?);
            return Some(());
        }
    };
    let groups = count.div_ceil(GROUP);
    let headers = take(body, groups.div_ceil(4))?;
    for (i, group) in deltas.chunks_exact_mut(GROUP).take(groups).enumerate() {
        let header = headers[i / 4] >> (2 * (i % 4)) & 3;
        read_group(body, bits[usize::from(header)], group)?;
    }
    Some(())
}

/// 16 differences of so many bits; those that have all of them set stand as bytes behind the others.
fn read_group(body: &mut &[u8], bits: u32, group: &mut [u8]) -> Option<()> {
    match bits {
        0 => {}
        8 => group.copy_from_slice(take(body, GROUP)?),
        _ => {
            let packed = take(body, 2 * bits as usize)?;
            let a_byte = 8 / bits as usize;
            let escape = (1u8 << bits) - 1;
            for (i, delta) in group.iter_mut().enumerate() {
                let place = bits * (i % a_byte) as u32;
                // The first is the lowest of single bits, and the highest of pairs and quadruples.
                let shift = if bits == 1 { place } else { 8 - bits - place };
                *delta = packed[i / a_byte] >> shift & escape;
                if *delta == escape {
                    *delta = take(body, 1)?[0];
                }
            }
        }
    }
    Some(())
}

/// Adds the differences of a channel up, from `previous` on, which is the last element afterwards.
fn accumulate<'e>(
    deltas: &[[u8; BLOCK]; CHANNEL],
    mode: u8,
    previous: &mut [u8],
    elements: impl Iterator<Item = &'e mut [u8]>,
) {
    let mut last = u32::from_le_bytes([previous[0], previous[1], previous[2], previous[3]]);
    for (i, element) in elements.enumerate() {
        let delta = u32::from_le_bytes([deltas[0][i], deltas[1][i], deltas[2][i], deltas[3][i]]);
        last = match mode & 15 {
            0 => lanes::<8>(last, delta),
            1 => lanes::<16>(last, delta),
            _ => last ^ delta.rotate_right(u32::from(mode >> 4)),
        };
        element.copy_from_slice(&last.to_le_bytes());
    }
    previous.copy_from_slice(&last.to_le_bytes());
}

/// Sums of integers of BITS bits that stand side by side, of which the second are zigzag-encoded.
fn lanes<const BITS: u32>(a: u32, zigzag: u32) -> u32 {
    let mask = (1u32 << BITS) - 1;
    (0..32 / BITS).fold(0, |sum, lane| {
        let [a, z] = [a, zigzag].map(|word| word >> (lane * BITS) & mask);
        let delta = (z >> 1) ^ (z & 1).wrapping_neg();
        sum | (a.wrapping_add(delta) & mask) << (lane * BITS)
    })
}
