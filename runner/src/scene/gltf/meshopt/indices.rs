//! Indices of triangle lists (A, mode 1) and of anything else (A, mode 2).

use super::take;

/// The last 16 of something; the latest is number 0.
struct Recent<T> {
    entries: [Option<T>; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    fn new() -> Self {
        Recent { entries: [None; 16], next: 0 }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.next] = Some(entry);
        self.next = (self.next + 1) % 16;
    }

    /// None if there has not been so much.
    fn get(&self, age: u8) -> Option<T> {
        self.entries[self.next.wrapping_sub(1 + usize::from(age)) % 16]
    }
}

/// What the decoder of triangles knows.
struct Triangles<'s> {
    data: &'s [u8],
    /// The index that has not been used yet.
    next: u32,
    /// The last one that was given explicitly.
    last: u32,
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
}

/// `count` (a multiple of 3) indices; none if the stream is broken.
pub fn triangles(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    let body = stream.strip_prefix(&[0xe1])?;
    let (body, table) = body.split_last_chunk::<16>()?;
    let (codes, data) = body.split_at_checked(count / 3)?;
    let mut state = Triangles { data, next: 0, last: 0, edges: Recent::new(), vertices: Recent::new() };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        indices.extend(state.triangle(code, table)?);
    }
    state.data.is_empty().then_some(indices)
}

impl Triangles<'_> {
    fn triangle(&mut self, code: u8, table: &[u8; 16]) -> Option<[u32; 3]> {
        let (high, low) = (code >> 4, code & 15);
        if high < 15 {
            let [a, b] = self.edges.get(high)?;
            let c = match low {
                0 => self.unused(),
                1..13 => self.vertices.get(low)?,
                13 | 14 => {
                    self.last = if low == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                    self.last
                }
                _ => self.explicit()?,
            };
            self.edges.push([c, b]);
            self.edges.push([a, c]);
            if low == 0 || low > 12 {
                self.vertices.push(c);
            }
            return Some([a, b, c]);
        }
        let pair = if low < 14 { table[usize::from(low)] } else { take(&mut self.data, 1)?[0] };
        if low >= 14 && pair == 0 {
            self.next = 0;
        }
        let a = if low < 15 { self.unused() } else { self.explicit()? };
        let (b_kind, c_kind) = (pair >> 4, pair & 15);
        // The table may not ask for explicit indices.
        if low < 14 && (b_kind == 15 || c_kind == 15) {
            return None;
        }
        let b = self.corner(b_kind)?;
        let c = self.corner(c_kind)?;
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        self.vertices.push(a);
        for (index, kind) in [(b, b_kind), (c, c_kind)] {
            if matches!(kind, 0 | 15) {
                self.vertices.push(index);
            }
        }
        Some([a, b, c])
    }

    fn corner(&mut self, kind: u8) -> Option<u32> {
        match kind {
            0 => Some(self.unused()),
            15 => self.explicit(),
            age => self.vertices.get(age - 1),
        }
    }

    fn unused(&mut self) -> u32 {
        let index = self.next;
        self.next = index.wrapping_add(1);
        index
    }

    fn explicit(&mut self) -> Option<u32> {
        self.last = self.last.wrapping_add(unzigzag(variable(&mut self.data)?));
        Some(self.last)
    }
}

/// `count` indices; none if the stream is broken.
pub fn sequence(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    let body = stream.strip_prefix(&[0xd1])?;
    let (mut data, _) = body.split_last_chunk::<4>()?;
    // Each takes a byte at least.
    if count > data.len() {
        return None;
    }
    let mut baselines = [0u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let word = variable(&mut data)?;
        let baseline = &mut baselines[(word & 1) as usize];
        *baseline = baseline.wrapping_add(unzigzag(word >> 1));
        indices.push(*baseline);
    }
    data.is_empty().then_some(indices)
}

fn unzigzag(v: u32) -> u32 {
    (v >> 1) ^ (v & 1).wrapping_neg()
}

/// An integer in 7 bits a byte, the lowest first; all but the last of at most 5 bytes have bit 7 set.
fn variable(data: &mut &[u8]) -> Option<u32> {
    let mut value = 0;
    for shift in [0, 7, 14, 21, 28] {
        let byte = take(data, 1)?[0];
        value |= u32::from(byte & 127) << shift;
        if byte < 128 {
            return Some(value);
        }
    }
    None
}
