//! Streams that meshoptimizer's encoder wrote, in the default settings of its JavaScript module, and broken ones.

use super::*;
use base64::Engine;
use glam::UVec2;
use shared::rng::{Rng, Stream};

fn bytes(base64: &str) -> Vec<u8> {
    base64::engine::general_purpose::STANDARD.decode(base64).unwrap()
}

fn attributes(stream: &str, filter: Filter, count: usize, stride: usize) -> Vec<u8> {
    decode(&bytes(stream), Layout { mode: Mode::Attributes, filter, count, stride }).unwrap()
}

/// What the encoder was given: 40 elements of two u16, a f32, four u8, and zeros.
fn elements() -> Vec<u8> {
    let element = |i: u32| {
        let mut bytes = Vec::new();
        bytes.extend((i as u16 * 300).to_le_bytes());
        bytes.extend(((i * i * 37 % 1000) as u16).to_le_bytes());
        bytes.extend((i as f32 * 0.25 - 3.0).to_le_bytes());
        bytes.extend((0..4).map(|k| (i * 73 + k * 19 + i * i * k) as u8));
        bytes.extend([0; 4]);
        bytes
    };
    (0..40).flat_map(element).collect()
}

/// A grid of 5 x 5 squares, and two triangles of vertices far apart.
fn indices() -> Vec<u32> {
    let square = |i: u32| {
        let a = i / 5 * 6 + i % 5;
        [a, a + 1, a + 6, a + 6, a + 1, a + 7]
    };
    (0..25).flat_map(square).chain([35, 2, 1000, 0, 17, 8]).collect()
}

#[test]
fn vertices_come_back() {
    for stream in [VERTICES_0, VERTICES_1_0, VERTICES_1_2, VERTICES_1_3] {
        assert!(attributes(stream, Filter::None, 40, 16) == elements(), "{stream}");
    }
}

#[test]
fn indices_come_back() {
    let expected = indices();
    let layout = |mode, stride| Layout { mode, filter: Filter::None, count: expected.len(), stride };
    // Triangles may be turned.
    let turned = |t: &[u32]| (0..3).map(|i| [t[i], t[(i + 1) % 3], t[(i + 2) % 3]]).min().unwrap();
    let decoded = decode(&bytes(TRIANGLES), layout(Mode::Triangles, 4)).unwrap();
    let decoded: Vec<u32> = decoded.as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)).collect();
    let all = |indices: &[u32]| indices.chunks_exact(3).map(turned).collect::<Vec<_>>();
    assert_eq!(all(&decoded), all(&expected));
    let spread: Vec<u32> = expected.iter().enumerate().map(|(i, v)| v + 500 * (i as u32 % 2)).collect();
    let decoded = decode(&bytes(SEQUENCE), layout(Mode::Indices, 4)).unwrap();
    assert_eq!(decoded, spread.iter().flat_map(|i| i.to_le_bytes()).collect::<Vec<u8>>());
    let decoded = decode(&bytes(SEQUENCE), layout(Mode::Indices, 2)).unwrap();
    assert_eq!(decoded, spread.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect::<Vec<u8>>());
}

/// Against the decoder of meshoptimizer; its rounding may differ by one unit, but not that of exponentials.
#[test]
fn filters_give_what_meshoptimizer_gives() {
    let decoded = attributes(EXPONENTIAL, Filter::Exponential, 8, 16);
    assert_eq!(decoded, bytes(EXPONENTIAL_DECODED));
    for (stream, expected, filter) in
        [(OCTAHEDRAL_8, OCTAHEDRAL_8_DECODED, Filter::Octahedral), (COLOR_8, COLOR_8_DECODED, Filter::Color)]
    {
        let decoded = attributes(stream, filter, 8, 4);
        let near = decoded.iter().zip(bytes(expected)).all(|(&a, b)| a.wrapping_sub(b).wrapping_add(1) <= 2);
        assert!(near, "{filter:?}");
    }
    for (stream, expected, filter) in [
        (OCTAHEDRAL_12, OCTAHEDRAL_12_DECODED, Filter::Octahedral),
        (QUATERNION, QUATERNION_DECODED, Filter::Quaternion),
        (COLOR_12, COLOR_12_DECODED, Filter::Color),
    ] {
        let words =
            |bytes: Vec<u8>| bytes.as_chunks().0.iter().map(|&w| u16::from_le_bytes(w)).collect::<Vec<_>>();
        let (decoded, expected) = (words(attributes(stream, filter, 8, 8)), words(bytes(expected)));
        let near = decoded.iter().zip(&expected).all(|(&a, &b)| a.wrapping_sub(b).wrapping_add(1) <= 2);
        assert!(near && decoded.len() == 32, "{filter:?}: {decoded:?} {expected:?}");
        assert!(decoded.iter().any(|&word| word != 0));
    }
}

#[test]
fn layouts_that_make_no_sense() {
    let refused = |mode, filter, count, stride| {
        let reason = decode(&bytes(VERTICES_0), Layout { mode, filter, count, stride }).unwrap_err();
        assert!(reason.starts_with(&format!("{count} elements of {stride} bytes")), "{reason}");
    };
    use Filter::{Color, Exponential, None, Octahedral, Quaternion};
    for (mode, filter, count, stride) in [
        (Mode::Attributes, None, 40, 0),
        (Mode::Attributes, None, 40, 6),
        (Mode::Attributes, None, 40, 260),
        (Mode::Attributes, Octahedral, 40, 16),
        (Mode::Attributes, Quaternion, 40, 4),
        (Mode::Attributes, Color, 40, 12),
        (Mode::Triangles, Exponential, 39, 4),
        (Mode::Triangles, None, 40, 4),
        (Mode::Indices, None, 40, 1),
        (Mode::Attributes, None, usize::MAX, 16),
        (Mode::Attributes, None, 1 << 40, 256),
    ] {
        refused(mode, filter, count, stride);
    }
}

/// A stream that is cut, longer than it says, or asks for more than it can hold is broken, and costs no memory.
#[test]
fn streams_of_another_length_are_broken() {
    let all = [
        (VERTICES_0, Mode::Attributes, 40, 16),
        (VERTICES_1_3, Mode::Attributes, 40, 16),
        (TRIANGLES, Mode::Triangles, 156, 4),
        (SEQUENCE, Mode::Indices, 156, 4),
    ];
    for (stream, mode, count, stride) in all {
        let stream = bytes(stream);
        let broken = |stream: &[u8], count| {
            decode(stream, Layout { mode, filter: Filter::None, count, stride }).is_err()
        };
        assert!(!broken(&stream, count));
        assert!((0..stream.len()).all(|length| broken(&stream[..length], count)), "{mode:?}");
        assert!(broken(&[&stream[..], &[7; 3]].concat(), count));
        assert!(broken(&stream, count + 48) && broken(&stream, count - 36) && broken(&stream, 100_000_002));
    }
}

/// Whatever the bits: no panic, and the promised length or an error.
#[test]
fn changed_streams_do_no_harm() {
    let all = [
        (VERTICES_0, Mode::Attributes, 40, 16),
        (VERTICES_1_0, Mode::Attributes, 40, 16),
        (VERTICES_1_3, Mode::Attributes, 40, 16),
        (TRIANGLES, Mode::Triangles, 156, 4),
        (SEQUENCE, Mode::Indices, 156, 2),
        (OCTAHEDRAL_8, Mode::Attributes, 8, 4),
        (QUATERNION, Mode::Attributes, 8, 8),
        (EXPONENTIAL, Mode::Attributes, 8, 16),
        (COLOR_12, Mode::Attributes, 8, 8),
    ];
    let mut rng = Rng::new(UVec2::new(9, 9), 0, 0, Stream::Initial, 0);
    let (mut decoded, mut tried) = (0, 0);
    for (stream, mode, count, stride) in all {
        let filters: &[Filter] = match (mode, stride) {
            (Mode::Attributes, 4) => &[Filter::Octahedral, Filter::Color],
            (Mode::Attributes, 8) => {
                &[Filter::Octahedral, Filter::Quaternion, Filter::Exponential, Filter::Color]
            }
            (Mode::Attributes, _) => &[Filter::None, Filter::Exponential],
            _ => &[Filter::None],
        };
        let whole = bytes(stream);
        for _ in 0..1000 {
            let mut broken = whole.clone();
            let random = rng.next_u32x4();
            for word in random.to_array().into_iter().take(1 + random.w as usize % 4) {
                let i = (word >> 8) as usize % broken.len();
                broken[i] = word as u8;
            }
            let filter = filters[random.x as usize % filters.len()];
            tried += 1;
            if let Ok(bytes) = decode(&broken, Layout { mode, filter, count, stride }) {
                assert_eq!(bytes.len(), count * stride);
                decoded += 1;
            }
        }
    }
    assert!(decoded > tried / 10 && decoded < tried * 9 / 10, "{decoded} of {tried}");
}

const VERTICES_0: &str = "\
    oB8AWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWP//AABYWFhYWFhYWBUqrqrqBASuququBAQEq6oAAAQfAErejQaaoT2G6lFC\
    1pUBktlFTu2JOp6dCYrhfXbakQL//wAAlqVBguZVPtIpAq/1EgMEAwQCI0NBEQZQIiNDQRAAAAAAAAAfAB8fHx8/Pz8/f3//////gIBA\
    QEBAICAgICAgICAQEBD//wAAEBAQEBAQEBAFABAB+IR8AIAAAB8AkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkv//AACSkpKS\
    kpKSkh8AlJicoKSorLC0uLzAxMjM0NTY3ODk6Ozw9Pj8//v38///AADv6+fj39vX0x8Alp6mrra+xs7W3ubu9v758enh2dHJwbmxqaGZ\
    kYmBef//AABxaWFZUUlBOR8AmKSwvMjU4Oz4++/j18u/s6ebj4N3a19TRzsvIxcLAP//AAAMGCQwPEhUYAAAAAAAAAAAAAAAAAAAAAAA\
    AAAAAAAAAAAAQMAAEyY5AAAAAA==";
const VERTICES_1_0: &str = "\
    oVVaVaoPAFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFj/AFhYWFhYWFhYFSququoEBK6q6q4EBASrqgAABA8ASt6NBpqhPYbq\
    UULWlQGS2UVO7Yk6np0JiuF9dtqRAv8AlqVBguZVPtIpAq/1EgMEAwQCI0NBEQZQIiNDQRAAAAAADwAfHx8fPz8/P39//////4CAQEBA\
    QCAgICAgICAgEBAQ/wAQEBAQEBAQEAEAEAH4hHwQAAIAAA8AkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkv8AkpKSkpKSkpIP\
    AJSYnKCkqKywtLi8wMTIzNDU2Nzg5Ojs8PT4/P/79/P/AO/r5+Pf29fTDwCWnqautr7Gztbe5u72/vnx6eHZ0cnBubGpoZmRiYF5/wBx\
    aWFZUUlBOQ8AmKSwvMjU4Oz4++/j18u/s6ebj4N3a19TRzsvIxcLAP8ADBgkMDxIVGAAAAAAAAAAAAAAQMAAEyY5AAAAAAAAAAA=";
const VERTICES_1_2: &str = "\
    oXc6/6oAWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYFSqqqqqqqqqqqqoAAABK3nIGmqHCeepRvSmVAZImuk7t\
    dsWenQl14YKJ2m4ClqW+feZVwS0pAa/5QAQDAwQRJDNCIQdwEiQzQhEAAAAAAB8fHx8/Pz8/f3//AAAAgIBAQEBAICAgICAgICAQEBAQ\
    EBAQEBAQEAEAcIN9AQCSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpIAlJicoKSorLC0uLzAxMjM0NTY3ODk6Ozw\
    9Pj8//v38+/r5+Pf29fTAJaepq62vsbO1t7m7vb++fHp4dnRycG5samhmZGJgXlxaWFZUUlBOQCYpLC8yNTg7Pj77+PXy7+zp5uPg3dr\
    X1NHOy8jFwsADBgkMDxIVGAAAAAAAAAAAAAAQMAAEyY5AAAAAAEBAAA=";
const VERTICES_1_3: &str = "\
    oXdo/6oAWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYFSqqqqqqqqqqqqoAAABK3nIGmqHCeepRvSmVAZImuk7t\
    dsWenQl14YKJ2m4ClqW+feZVwS0pAa/5QAQDAwQRJDNCIQdwEiQzQhEAAAAABSAwDxcHEAAPGg4mL0xPj//4/Bgw0NAw9MTyYuJi8TEY\
    /B7d3QAABwMPAwCSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpIAlJicoKSorLC0uLzAxMjM0NTY3ODk6Ozw9Pj8\
    //v38+/r5+Pf29fTAJaepq62vsbO1t7m7vb++fHp4dnRycG5samhmZGJgXlxaWFZUUlBOQCYpLC8yNTg7Pj77+PXy7+zp5uPg3drX1NH\
    Oy8jFwsADBgkMDxIVGAAAAAAAAAAAAAAQMAAEyY5AAAAAAFSAAA=";
const TRIANGLES: &str = "\
    4f4eEA4QDhAOEA7+HhkOGA4XDhYO/x4WDhYOFg4WDv8eFg4WDhYOFg7/HhYOFg4WDhYO//8PDJ8CXwkMXwkMXwkM/wBBzA//zw8iEQB2\
    h1ZneKmGZYlomAFpAAA=";
const SEQUENCE: &str = "\
    0QDVDxgVEgUAExgVEgUAExgVEgUAExgVEgUAExgVEgUEDxgVEgUAExgVEgUAExgVEgUAExgVEgUAExgVEgUEDxgVEgUAExgVEgUAExgV\
    EgUAExgVEgUAExgVEgUEDxgVEgUAExgVEgUAExgVEgUAExgVEgUAExgVEgUEDxgVEgUAExgVEgUAExgVEgUAExgVEgUAExgVEgUYgwGU\
    HgfaHiEAAAAA";
const OCTAHEDRAL_8: &str = "\
    oAE//wAAiljII/0bMgE//wAAGzznQ2GukgACA0NDQwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAEV/gQ==";
const OCTAHEDRAL_8_DECODED: &str = "\
    AGFSgWNPBH9AFZSBt8taf6mjAYEUpKt/WtNNgW5AA38=";
const OCTAHEDRAL_12: &str = "\
    oAE//wAAtHFcPzw03QE/dgAACAYTEAE//wAAOi2vLyf22wIBTVXIAAAAAAAAAgNDQ0MAAAAAARmZAAAAAAAAAAAAAAAAAAAAAAAAAAAA\
    AAAAAAAAAFgE/wcBgA==";
const OCTAHEDRAL_12_DECODED: &str = "\
    AAD4YWBSAYAqZJNPUQT/f7A/AhX7kgGA7rZWylta/394qKWiggIBgCgVxKPQqf9/+Fpn0zpOAYB/botAyAL/fw==";
const QUATERNION: &str = "\
    oAE//wAAjNX7aL2kYAIJ53n/AAAAABIVAT//AADHYlQI52WfAT/zAAATDhEGEAUBP/8AAM4bm3WiUrECBPfK+gAAAAAREwELtgAAAwQA\
    AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAJgUeBiYF/Qc=";
const QUATERNION_DECODED: &str = "\
    RjpDRUY6PUV3VadXxgTz2lks+u6OWEdPa03AJwS9Qb7gCjB7xvwm3/q/5D+8OxNEoz1czIpaeSkWryQYBAEwYA==";
const EXPONENTIAL: &str = "\
    oAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAEAAAABAAAAAQmzsAEA==";
const EXPONENTIAL_DECODED: &str = "\
    AAAAAAAAAAAAAAAAAGxuTgAAAAAAAAAAAAAAAABsbk4AAAAAAAAAAAAAAAAAbG5OAAAAAAAAAAAAAAAAAGxuTgAAAAAAAAAAAAAAAABs\
    bk4AAAAAAAAAAAAAAAAAbG5OAAAAAAAAAAAAAAAAAGxuTgAAAAAAAAAAAAAAAABsbk4=";
const COLOR_8: &str = "\
    oAE//wAA4B1gHR0fHQE//wAAMjTLNDIyNAE//wAAWKnWp6eppwE//wAAGxsbGx0bGwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA\
    AAD/";
const COLOR_8_DECODED: &str = "\
    AAAA/12cK+O9OFfHHNOCq3twrY/ZDdlwN6gFVJZFMDg=";
const COLOR_12: &str = "\
    oAE//wAAEhYUFhQUFgE3VQAADgYBP/8AAM3Ly8vNzcsCAk1EJAAAAAABP/8AAI+Nj4+Nj40CBJ65+QAAAAAWAT//AAA6ODo4Ojg6AQVV\
    AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAD/Dw==";
const COLOR_12_DECODED: &str = "\
    AAAAAAAA//+mXhmcgyuN42u9UzgFVwzHIhx81IiCuqr3eqdwGq44jp3Z0Qyd2cdxQzj6qCAFRVUJlzRFozDzOA==";
