//! Wrong files made of right ones. A mutation knows what it changes: a glTF's JSON stays JSON and its chunks keep their lengths, words
//! of a text become other words of it, numbers those at which programs fail. One in eight cases breaks bytes besides.

use crate::dice::Dice;
use serde_json::{Map, Value, json};

/// Numbers at which programs fail.
const NUMBERS: [f64; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    2.0,
    3.0,
    7.0,
    0.5,
    255.0,
    256.0,
    65535.0,
    65536.0,
    2147483647.0,
    2147483648.0,
    4294967295.0,
    4294967296.0,
    9007199254740993.0,
    1e-40,
    3.5e38,
    1e308,
];
const WORDS: [&str; 24] = [
    "NaN",
    "inf",
    "-1",
    "0",
    "1e999",
    "18446744073709551615",
    "-9223372036854775808",
    "65535",
    "65536",
    "4294967295",
    "0.5",
    "1e-40",
    "true",
    "null",
    "[]",
    "{}",
    "\"\"",
    "\"\u{1f980}\"",
    "[[",
    "=",
    ",",
    "\n",
    "#",
    "0x10",
];
/// Bit patterns of four bytes: NaN, infinities, largest, smallest, limits of integers.
const BITS: [u32; 10] = [
    0x7fc0_0000,
    0x7f80_0000,
    0xff80_0000,
    0x7f7f_ffff,
    1,
    0,
    u32::MAX,
    0x7fff_ffff,
    0x8000_0000,
    0x0001_0000,
];

/// `original`, a file with this extension, changed in one to eight places.
pub fn mutated(original: &[u8], extension: &str, dice: &mut Dice) -> Vec<u8> {
    let changes = 1 + dice.below(8);
    let mut bytes = match extension {
        "glb" => glb(original, changes, dice),
        "gltf" => json_text(original, changes, dice),
        "json" if dice.one_in(2) => json_text(original, changes, dice),
        "json" | "toml" => words(original, changes, dice),
        "hdr" if dice.one_in(2) => words(original, changes, dice),
        _ => broken(original, changes, dice),
    };
    if dice.one_in(8) {
        bytes = broken(&bytes, 1, dice);
    }
    bytes
}

/// Two chunks, JSON and binary.
fn glb(original: &[u8], changes: usize, dice: &mut Dice) -> Vec<u8> {
    let word = |at: usize| {
        original.get(at..at + 4).and_then(|b| b.try_into().ok()).map_or(0, |b| u32::from_le_bytes(b) as usize)
    };
    let end = 20 + word(12);
    let (Some(text), Some(bin)) = (original.get(20..end), original.get(end + 8..)) else {
        return broken(original, changes, dice);
    };
    let (mut json, mut bin) = (text.to_vec(), bin.to_vec());
    // Most of what a file says, it says in its JSON.
    if dice.one_in(4) {
        bin = broken(&bin, changes, dice);
    } else {
        json = json_text(text, changes, dice);
    }
    json.resize(json.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let number = |n: usize| (n as u32).to_le_bytes();
    let length = 28 + json.len() + bin.len();
    [
        b"glTF",
        &number(2)[..],
        &number(length),
        &number(json.len()),
        b"JSON",
        &json,
        &number(bin.len()),
        b"BIN\0",
        &bin,
    ]
    .concat()
}

fn json_text(original: &[u8], changes: usize, dice: &mut Dice) -> Vec<u8> {
    let Ok(mut root) = serde_json::from_slice::<Value>(original) else {
        return broken(original, changes, dice);
    };
    for _ in 0..changes {
        let donor = some_value(&mut root, dice).clone();
        change(some_value(&mut root, dice), donor, dice);
    }
    root.to_string().into_bytes()
}

/// Any value of the tree: at each step one child in six is where it ends.
fn some_value<'a>(value: &'a mut Value, dice: &mut Dice) -> &'a mut Value {
    let children = match &*value {
        Value::Array(list) => list.len(),
        Value::Object(map) => map.len(),
        _ => 0,
    };
    if children == 0 || dice.one_in(6) {
        return value;
    }
    let at = dice.below(children);
    let child = match value {
        Value::Array(list) => list.get_mut(at),
        Value::Object(map) => map.values_mut().nth(at),
        _ => None,
    };
    some_value(child.expect("it was counted"), dice)
}

/// `donor`: another value of the same document.
fn change(value: &mut Value, donor: Value, dice: &mut Dice) {
    match dice.below(5) {
        0 => *value = donor,
        1 => {
            *value =
                dice.of(&[json!(null), json!([]), json!({}), json!(""), json!(true), json!("VEC3")]).clone()
        }
        _ => match value {
            Value::Number(number) => {
                let near = number.as_f64().unwrap_or(0.0) + *dice.of(&[-1.0, 1.0]);
                let wrong = if dice.one_in(2) { near } else { *dice.of(&NUMBERS) };
                *value = if wrong.fract() == 0.0 && wrong.abs() < 1e15 {
                    json!(wrong as i64)
                } else {
                    json!(wrong)
                };
            }
            Value::String(text) => {
                let cut = text.char_indices().nth(dice.below(text.len().max(1))).map_or(0, |(at, _)| at);
                text.truncate(cut);
            }
            Value::Array(list) if !list.is_empty() => {
                let (at, item) = (dice.below(list.len()), dice.of(list).clone());
                match dice.below(3) {
                    0 => drop(list.remove(at)),
                    1 => list.extend(vec![item; 1 + dice.below(64)]),
                    _ => list[at] = item,
                }
            }
            Value::Object(map) if !map.is_empty() => change_member(map, donor, dice),
            _ => *value = json!(dice.of(&NUMBERS)),
        },
    }
}

fn change_member(map: &mut Map<String, Value>, donor: Value, dice: &mut Dice) {
    let key = map.keys().nth(dice.below(map.len())).cloned().unwrap_or_default();
    let value = map.remove(&key);
    match dice.below(3) {
        // It is missing.
        0 => {}
        1 => drop(map.insert(key, donor)),
        _ => drop(map.insert("uri".into(), value.unwrap_or_default())),
    }
}

/// Words of a text replaced, left out, repeated or exchanged; what separates them stays.
fn words(original: &[u8], changes: usize, dice: &mut Dice) -> Vec<u8> {
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || b"._-+".contains(&byte);
    let mut words: Vec<Vec<u8>> =
        original.chunk_by(|&a, &b| is_word(a) == is_word(b)).map(<[u8]>::to_vec).collect();
    for _ in 0..changes.min(words.len()) {
        let (at, other) = (dice.below(words.len()), dice.below(words.len()));
        match dice.below(4) {
            0 => words[at] = dice.of(&WORDS).as_bytes().to_vec(),
            1 => words[at].clear(),
            2 => words[at] = words[other].clone(),
            _ => words.swap(at, other),
        }
    }
    words.concat()
}

/// Bytes changed, cut off or repeated, whatever they mean.
fn broken(original: &[u8], changes: usize, dice: &mut Dice) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..changes {
        if bytes.is_empty() {
            break;
        }
        let at = dice.below(bytes.len());
        match dice.below(6) {
            0 => bytes[at] ^= 1 << dice.below(8),
            1 => bytes[at] = dice.bits() as u8,
            2 | 3 => {
                let aligned = at & !3;
                let wrong = dice.of(&BITS).to_le_bytes();
                bytes.iter_mut().skip(aligned).zip(wrong).for_each(|(byte, wrong)| *byte = wrong);
            }
            4 if dice.one_in(4) => bytes.truncate(at),
            4 => drop(bytes.drain(at..(at + 1 + dice.below(16)).min(bytes.len()))),
            _ => {
                let piece = bytes[at..(at + 1 + dice.below(64)).min(bytes.len())].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
    bytes
}
