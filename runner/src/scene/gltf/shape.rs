//! Shapes of JSON values, and the repair of values that lack them.
//!
//! The gltf crate takes a file's word for much (indices, codes, what must be there) and refuses all of it for any fault. So
//! what is read is copied out first, property by property: what is not as it must be goes, with a warning, or breaks the
//! thing that can't be without. A broken thing is an error where it is drawn, and nowhere else.

use super::warnings::Warnings;
use super::{Reason, label};
use serde_json::{Map, Value};
use std::collections::HashMap;

/// The form of a value.
#[derive(Clone, Copy)]
pub enum Shape {
    Anything,
    Text,
    Flag,
    Number,
    /// A whole number from 0 to this.
    Whole(u64),
    /// So many numbers; 0: any number of them.
    Numbers(usize),
    /// One of these texts.
    Choice(&'static [&'static str]),
    /// One of these codes.
    Code(&'static [u64]),
    /// The place of a sound thing in the list of its kind.
    Index(Kind),
    /// The place of a thing, sound or not.
    Place(Kind),
    /// Elements that are all sound.
    List(&'static Shape),
    /// Elements of which broken ones are left out.
    Loose(&'static Shape),
    /// Things that are named by their place: a broken one leaves a hole.
    Table(Kind, &'static Shape),
    /// These properties; all others are left out.
    Object(&'static [Field]),
    /// These properties; all others stay as they are.
    Open(&'static [Field]),
    /// Properties by their names: how each is needed, or that it is not read.
    Named(fn(&str) -> Option<Need>, &'static Shape),
}

/// A property of an object.
#[derive(Clone, Copy)]
pub struct Field {
    pub name: &'static str,
    pub shape: Shape,
    pub need: Need,
}

/// What becomes of an object one of whose properties is missing or broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Either breaks it.
    Must,
    /// It may be missing; a broken one breaks it.
    Firm,
    /// It may be missing; a broken one counts as missing, with a warning.
    Loose,
    /// As `Loose`; then this JSON stands in its place.
    Or(&'static str),
    /// It may be missing, but for this JSON in its place; a broken one breaks the object.
    FirmOr(&'static str),
}

/// Kinds of things that are named by their places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    Buffer,
    View,
    Accessor,
    Image,
    Sampler,
    Texture,
    Material,
    Camera,
    Light,
    Panel,
    Mesh,
    Skin,
    Node,
    Scene,
    Animation,
    /// Of one animation.
    Curve,
}

impl Kind {
    /// As messages call it.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Buffer => "buffer",
            Kind::View => "buffer view",
            Kind::Accessor => "accessor",
            Kind::Image => "image",
            Kind::Sampler => "sampler",
            Kind::Texture => "texture",
            Kind::Material => "material",
            Kind::Camera => "camera",
            Kind::Light => "light",
            Kind::Panel => "area light",
            Kind::Mesh => "mesh",
            Kind::Skin => "skin",
            Kind::Node => "node",
            Kind::Scene => "scene",
            Kind::Animation => "animation",
            Kind::Curve => "animation sampler",
        }
    }

    /// What stands for a broken one: nothing that could be drawn, and sound.
    fn hole(self) -> &'static str {
        match self {
            Kind::View => r#"{"buffer": 0, "byteLength": 0}"#,
            Kind::Accessor => r#"{"componentType": 5126, "count": 0, "type": "SCALAR"}"#,
            Kind::Camera => r#"{"type": "perspective", "perspective": {"yfov": 0, "znear": 0}}"#,
            Kind::Light => r#"{"type": "point", "intensity": 0}"#,
            Kind::Panel => r#"{"type": "disk", "intensity": 0}"#,
            Kind::Mesh => r#"{"primitives": []}"#,
            Kind::Skin => r#"{"joints": []}"#,
            Kind::Scene => r#"{"nodes": []}"#,
            Kind::Animation => r#"{"channels": [], "samplers": []}"#,
            Kind::Curve => r#"{"input": 0, "output": 0}"#,
            Kind::Buffer | Kind::Image | Kind::Sampler | Kind::Texture | Kind::Material | Kind::Node => "{}",
        }
    }
}

/// The things of one kind.
#[derive(Default)]
struct Known {
    count: usize,
    broken: HashMap<usize, String>,
}

/// Takes what is sound out of a file's JSON.
pub struct Mender<'w> {
    known: HashMap<Kind, Known>,
    warnings: &'w mut Warnings,
}

impl<'w> Mender<'w> {
    pub fn new(warnings: &'w mut Warnings) -> Self {
        Mender { known: HashMap::new(), warnings }
    }

    /// Says how many things of a kind there are before they are mended.
    pub fn count(&mut self, kind: Kind, count: usize) {
        self.known.insert(kind, Known { count, broken: HashMap::new() });
    }

    /// Says that there are more things of a kind than were mended.
    pub fn recount(&mut self, kind: Kind, count: usize) {
        self.known.entry(kind).or_default().count = count;
    }

    /// Says that a thing is broken, beyond what its JSON tells.
    pub fn mark(&mut self, kind: Kind, index: usize, reason: String) {
        self.known.entry(kind).or_default().broken.insert(index, reason);
    }

    /// The broken things of a kind, by index, each with a reason.
    pub fn broken(&mut self, kind: Kind) -> HashMap<usize, String> {
        self.known.remove(&kind).unwrap_or_default().broken
    }

    /// Says that something can't be read and is not needed.
    /// Leaves of `value` what has the form of `shape`; `at` names the thing. Error: nothing does.
    pub fn mend(&mut self, value: &mut Value, shape: &Shape, at: &str) -> Reason<()> {
        match *shape {
            Shape::Anything => Ok(()),
            Shape::Text => expect(value.is_string(), value, "a text"),
            Shape::Flag => expect(value.is_boolean(), value, "true or false"),
            Shape::Number => expect(value.is_number(), value, "a number"),
            Shape::Whole(most) => {
                *value = whole(value)
                    .filter(|&n| n <= most)
                    .ok_or_else(|| format!("{} is not a whole number up to {most}", shown(value)))?
                    .into();
                Ok(())
            }
            Shape::Numbers(count) => {
                let sound = |list: &Vec<Value>| {
                    (count == 0 || list.len() == count) && list.iter().all(Value::is_number)
                };
                expect(value.as_array().is_some_and(sound), value, &format!("a list of {count} numbers"))
            }
            Shape::Choice(texts) => {
                let sound = value.as_str().is_some_and(|text| texts.contains(&text));
                expect(sound, value, &format!("one of {}", texts.join(", ")))
            }
            Shape::Code(codes) => {
                let code = whole(value).filter(|code| codes.contains(code));
                *value = code.ok_or_else(|| format!("{} is an unknown code", shown(value)))?.into();
                Ok(())
            }
            Shape::Place(kind) => self.mend_index(value, kind).map(|_| ()),
            Shape::Index(kind) => {
                let index = self.mend_index(value, kind)?;
                match self.known.get(&kind).and_then(|known| known.broken.get(&index)) {
                    Some(reason) => Err(format!("{} {index}: {reason}", kind.name())),
                    None => Ok(()),
                }
            }
            Shape::List(element) => {
                let list = value.as_array_mut().ok_or("it is not a list")?;
                let mut elements = list.iter_mut().enumerate();
                elements
                    .try_for_each(|(i, value)| self.mend(value, element, at).map_err(|r| format!("{i}: {r}")))
            }
            Shape::Loose(element) => {
                let list = value.as_array_mut().ok_or("it is not a list")?;
                for (i, mut value) in std::mem::take(list).into_iter().enumerate() {
                    match self.mend(&mut value, element, at) {
                        Ok(()) => list.push(value),
                        Err(reason) => self.ignore(&format!("{at}, {i}: {reason}")),
                    }
                }
                Ok(())
            }
            Shape::Table(kind, element) => self.mend_table(value, kind, element),
            Shape::Object(fields) => self.mend_object(value, fields, false, at),
            Shape::Open(fields) => self.mend_object(value, fields, true, at),
            Shape::Named(need, element) => {
                let object = object(value)?;
                for (name, mut value) in std::mem::take(object) {
                    let Some(need) = need(&name).filter(|_| !value.is_null()) else { continue };
                    match self.mend(&mut value, element, at) {
                        Ok(()) => _ = object.insert(name, value),
                        Err(reason) if need == Need::Loose => self.ignore(&format!("{at}: {name}: {reason}")),
                        Err(reason) => return Err(format!("{name}: {reason}")),
                    }
                }
                Ok(())
            }
        }
    }

    fn mend_index(&self, value: &mut Value, kind: Kind) -> Reason<usize> {
        let Some(index) = whole(value) else { return Err(format!("{} is not an index", shown(value))) };
        let count = self.known.get(&kind).map_or(0, |known| known.count);
        if index >= count as u64 {
            return Err(format!("{} {index} of {count} does not exist", kind.name()));
        }
        *value = index.into();
        Ok(index as usize)
    }

    fn mend_table(&mut self, value: &mut Value, kind: Kind, element: &Shape) -> Reason<()> {
        let list = value.as_array_mut().ok_or("it is not a list")?;
        // Things may name others of their own kind.
        self.count(kind, list.len());
        for (i, value) in list.iter_mut().enumerate() {
            let name = value.get("name").and_then(Value::as_str).map(str::to_owned);
            if let Err(reason) = self.mend(value, element, &label(kind.name(), i, name.as_deref())) {
                *value = json(kind.hole())?;
                if let Some(name) = name {
                    value["name"] = name.into();
                }
                self.mark(kind, i, reason);
            }
        }
        Ok(())
    }

    fn mend_object(&mut self, value: &mut Value, fields: &[Field], open: bool, at: &str) -> Reason<()> {
        let object = object(value)?;
        let mut mended = Map::new();
        for &Field { name, ref shape, need } in fields {
            // A table that is missing or no list has nothing in it, whatever another object's had.
            if let Shape::Table(kind, _) = *shape {
                self.count(kind, 0);
            }
            let found = object.remove(name).filter(|value| !value.is_null());
            let result = match found {
                Some(mut value) => self.mend(&mut value, shape, at).map(|()| Some(value)),
                None if need == Need::Must => return Err(format!("it has no {name}")),
                None => Ok(None),
            };
            let found = match (result, need) {
                (Ok(found), _) => found,
                (Err(reason), Need::Loose | Need::Or(_)) => {
                    self.ignore(&format!("{at}: {name}: {reason}"));
                    None
                }
                // The message names what is missing already.
                (Err(reason), _) if matches!(shape, Shape::Index(_) | Shape::Place(_)) => return Err(reason),
                (Err(reason), _) => return Err(format!("{name}: {reason}")),
            };
            let found = match (found, need) {
                (None, Need::Or(other) | Need::FirmOr(other)) => Some(json(other)?),
                (found, _) => found,
            };
            if let Some(value) = found {
                mended.insert(name.to_owned(), value);
            }
        }
        if open {
            mended.extend(std::mem::take(object));
        }
        *object = mended;
        Ok(())
    }

    pub fn ignore(&mut self, what: &str) {
        self.warnings.add("ignored as unreadable", what);
    }
}

fn object(value: &mut Value) -> Reason<&mut Map<String, Value>> {
    value.as_object_mut().ok_or_else(|| "it is not an object".into())
}

fn json(text: &str) -> Reason<Value> {
    serde_json::from_str(text).map_err(|error| error.to_string())
}

/// Some exporters write whole numbers as 4.0.
fn whole(value: &Value) -> Option<u64> {
    let exact = |x: &f64| x.fract() == 0.0 && (0.0..9e15).contains(x);
    value.as_u64().or_else(|| value.as_f64().filter(exact).map(|x| x as u64))
}

fn expect(sound: bool, value: &Value, what: &str) -> Reason<()> {
    if sound { Ok(()) } else { Err(format!("{} is not {what}", shown(value))) }
}

/// The head of a value, for a message.
fn shown(value: &Value) -> String {
    const LENGTH: usize = 40;
    let text = match value {
        Value::Array(list) => format!("a list of {}", list.len()),
        Value::Object(_) => "an object".into(),
        other => other.to_string(),
    };
    match text.char_indices().nth(LENGTH) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Need::{Firm, Loose, Must, Or};
    use serde_json::json;

    const fn field(name: &'static str, shape: Shape, need: Need) -> Field {
        Field { name, shape, need }
    }

    const LAMP: Shape = Shape::Object(&[
        field("name", Shape::Text, Loose),
        field("watt", Shape::Number, Must),
        field("color", Shape::Numbers(3), Or("[1, 1, 1]")),
        field("kind", Shape::Choice(&["tube", "bulb"]), Firm),
    ]);
    const HOUSE: Shape = Shape::Object(&[
        field("lamps", Shape::Table(Kind::Light, &LAMP), Firm),
        field("lit", Shape::Index(Kind::Light), Firm),
        field("others", Shape::Loose(&Shape::Index(Kind::Light)), Loose),
    ]);

    fn mended(mut value: Value) -> (Reason<()>, Value, Vec<String>) {
        let mut warnings = Warnings::default();
        let result = Mender::new(&mut warnings).mend(&mut value, &HOUSE, "house");
        (result, value, warnings.into_lines())
    }

    #[test]
    fn what_is_sound_stays_and_nothing_else() {
        let lamp = json!({"name": "a", "watt": 5, "color": [1, 0, 0], "kind": "bulb", "price": [7]});
        let (result, value, warnings) = mended(json!({"lamps": [lamp], "lit": 0.0, "garden": {}}));
        let sound = json!({"name": "a", "watt": 5, "color": [1, 0, 0], "kind": "bulb"});
        assert_eq!((result, value), (Ok(()), json!({"lamps": [sound], "lit": 0})));
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn what_may_be_missing_goes_with_a_warning() {
        let (result, value, warnings) =
            mended(json!({"lamps": [{"name": 7, "watt": 5, "color": [1, 0]}], "others": [0, 3, "x"]}));
        let lamp = json!({"watt": 5, "color": [1, 1, 1]});
        assert_eq!((result, value), (Ok(()), json!({"lamps": [lamp], "others": [0]})));
        let line = "ignored as unreadable: light 0: name: 7 is not a text, light 0: color: a list of 2 is not a list of 3 \
                    numbers, house, 1: light 3 of 1 does not exist and 1 more";
        assert_eq!(warnings, [line]);
    }

    #[test]
    fn a_broken_thing_is_an_error_for_those_who_need_it() {
        let lamps = json!([{"watt": 1}, {"watt": null}, {"watt": 1, "kind": "sun"}]);
        let lit = |index: usize| mended(json!({"lamps": lamps, "lit": index}));
        assert_eq!(lit(0).0, Ok(()));
        assert_eq!(lit(0).1["lamps"][1], json!({"type": "point", "intensity": 0}), "a hole keeps the places");
        assert_eq!(lit(1).0, Err("light 1: it has no watt".into()));
        assert_eq!(lit(2).0, Err("light 2: kind: \"sun\" is not one of tube, bulb".into()));
        assert_eq!(lit(3).0, Err("light 3 of 3 does not exist".into()));
        assert_eq!(mended(json!({"lamps": {}})).0, Err("lamps: it is not a list".into()));
        assert_eq!(mended(json!([])).0, Err("it is not an object".into()));
    }
}
