//! A knob as people see it: its words, its range, its steps.

use super::{Auto, Choice, Indirect, Knobs, Mode};
use crate::frame::schedule::Primary;
use shared::light::count::Condition;
use std::fmt;
use std::ops::RangeInclusive;

/// A row of the table, as the command line, panels, keys, scripts, tables and pages see it.
#[derive(Debug)]
pub struct Knob {
    /// In documents and, with dashes, on the command line.
    pub name: &'static str,
    /// In the viewer's panel.
    pub label: &'static str,
    /// One line for everywhere.
    pub about: &'static str,
    /// Of its number; empty if it has none.
    pub unit: &'static str,
    /// What more of it does, and less; for switches on and off.
    pub higher: &'static str,
    /// What less of it does.
    pub lower: &'static str,
    /// What it does to the mean.
    pub bias: &'static str,
    pub(super) kind: Kind,
    pub(super) get: fn(&Knobs) -> Value,
    pub(super) set: fn(&mut Knobs, Value),
}

#[derive(Debug)]
pub(super) enum Kind {
    /// A number, and how it steps.
    Count(RangeInclusive<u32>, Counting),
    /// Above 0; range and width of the viewer's steps.
    Number(RangeInclusive<f32>, f32),
    /// Degrees above 0, to the range's end; range and width of the viewer's steps.
    Angle(RangeInclusive<f64>, f64),
    /// On or off.
    Switch,
    /// On from so many lights on, unless it is switched.
    /// On with so many lights.
    Auto(Condition),
    /// Words from the lowest to the highest, with their meanings.
    Choice(&'static [(&'static str, &'static str)]),
}

#[derive(Debug)]
pub(super) enum Counting {
    /// By one.
    One,
    /// Doubled and halved, as the thesis has it.
    Doubled,
}

/// What a knob is set to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Of a count.
    Count(u32),
    /// Of a number, or an angle in degrees.
    Number(f32),
    /// Degrees.
    Angle(f64),
    /// Of a switch.
    Switch(bool),
    /// Of a choice.
    Word(&'static str),
}

/// A step of the viewer's keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// To a lower value.
    Down,
    /// To a higher value.
    Up,
}

/// As documents and tables have it.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Value::Count(count) => count.fmt(f),
            Value::Number(number) => number.fmt(f),
            Value::Angle(degrees) => degrees.fmt(f),
            Value::Switch(on) => on.fmt(f),
            Value::Word(word) => word.fmt(f),
        }
    }
}

/// A name is one knob's.
impl PartialEq for Knob {
    fn eq(&self, other: &Knob) -> bool {
        self.name == other.name
    }
}

impl Knob {
    /// What `knobs` have.
    pub fn value(&self, knobs: &Knobs) -> Value {
        (self.get)(knobs)
    }

    /// `value` is of this knob's kind: one that [`Knob::value`] or [`Knob::parse`] gave.
    pub fn set(&self, knobs: &mut Knobs, value: Value) {
        (self.set)(knobs, value);
    }

    /// The default as help and pages say it.
    pub fn default_in_words(&self) -> String {
        match (&self.kind, self.value(&Knobs::default())) {
            (Kind::Auto(lights), Value::Word("auto")) => on_with(lights),
            (_, Value::Switch(on)) => if on { "on" } else { "off" }.into(),
            (_, value) => value.to_string(),
        }
    }

    /// As typed on the command line. Errors: what is expected.
    pub fn parse(&self, text: &str) -> Result<Value, String> {
        let value = match &self.kind {
            Kind::Count(..) => text.parse().map(Value::Count).map_err(|e| e.to_string()),
            Kind::Number(..) => text.parse().map(Value::Number).map_err(|_| self.values()),
            Kind::Angle(..) => text.parse().map(Value::Angle).map_err(|_| self.values()),
            Kind::Switch => text.parse().map(Value::Switch).map_err(|_| self.values()),
            Kind::Auto(..) | Kind::Choice(_) => {
                let known = self.words().iter().find(|(word, _)| *word == text);
                known.map(|(word, _)| Value::Word(word)).ok_or_else(|| self.values())
            }
        };
        let value = value.map_err(|expected| match &self.kind {
            Kind::Count(..) => expected,
            _ => format!("expected {expected}"),
        })?;
        self.check(value).map(|()| value)
    }

    /// Is `value` within the knob's range?
    pub fn check(&self, value: Value) -> Result<(), String> {
        let above_zero = |number: f64, most: f64| match number {
            _ if !(number.is_finite() && number > 0.0) => Err(format!("{value} is not a number above 0")),
            _ if number > most => Err(format!("{value} is more than {most} {}", self.unit)),
            _ => Ok(()),
        };
        match (&self.kind, value) {
            (Kind::Count(range, _), Value::Count(count)) if !range.contains(&count) => {
                Err(format!("{count} is not in {}..={}", range.start(), range.end()))
            }
            (Kind::Number(..), Value::Number(number)) => above_zero(number.into(), f64::INFINITY),
            (Kind::Angle(range, _), Value::Angle(degrees)) => above_zero(degrees, *range.end()),
            _ => Ok(()),
        }
    }

    /// What it takes, in words, with its unit.
    pub fn values(&self) -> String {
        match &self.kind {
            Kind::Count(range, _) => format!("{} to {}", range.start(), range.end()),
            Kind::Number(..) => format!("a number above 0, {}", self.unit),
            Kind::Angle(range, _) => format!("a number above 0, at most {}, {}", range.end(), self.unit),
            Kind::Switch => "on or off".into(),
            Kind::Auto(lights) => format!("on, off or auto: {}", on_with(lights)),
            Kind::Choice(words) => words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(" or "),
        }
    }

    /// Its words with their meanings, from the lowest to the highest; none if it takes a number.
    pub fn words(&self) -> &'static [(&'static str, &'static str)] {
        match &self.kind {
            Kind::Auto(..) => Auto::WORDS,
            Kind::Choice(words) => words,
            _ => &[],
        }
    }

    /// `--NAME` and `--no-NAME`, without a value.
    pub fn is_flag(&self) -> bool {
        matches!(self.kind, Kind::Switch | Kind::Auto(..))
    }

    /// What `--NAME`, or `--no-NAME`, sets a flag to.
    pub fn flag(&self, on: bool) -> Value {
        match self.kind {
            Kind::Auto(..) => Value::Word(if on { Auto::On } else { Auto::Off }.word()),
            _ => Value::Switch(on),
        }
    }

    /// Is it a choice between two?
    pub fn is_switch(&self) -> bool {
        matches!(self.kind, Kind::Switch) || self.words().len() == 2
    }

    /// One step up or down, within the knob's range; switches go on and off.
    pub fn step(&self, knobs: &mut Knobs, step: Step) {
        let up = step == Step::Up;
        let value = match (&self.kind, self.value(knobs)) {
            (Kind::Count(range, counting), Value::Count(count)) => {
                let next = match (counting, up) {
                    (Counting::One, true) => count.saturating_add(1),
                    (Counting::One, false) => count.saturating_sub(1),
                    (Counting::Doubled, true) => count.saturating_mul(2),
                    (Counting::Doubled, false) => count / 2,
                };
                Value::Count(next.clamp(*range.start(), *range.end()))
            }
            (Kind::Number(range, width), Value::Number(number)) => {
                let next = on_grid(number / width, up) as f32 * width;
                Value::Number(next.clamp(*range.start(), *range.end()))
            }
            (Kind::Angle(range, width), Value::Angle(degrees)) => {
                let next = on_grid((degrees / width) as f32, up) * width;
                Value::Angle(next.clamp(*range.start(), *range.end()))
            }
            (Kind::Switch, _) => Value::Switch(up),
            (_, Value::Word(word)) => {
                let words = self.words();
                let at = words.iter().position(|(known, _)| *known == word).unwrap_or(0);
                let next = if up { (at + 1).min(words.len() - 1) } else { at.saturating_sub(1) };
                Value::Word(words[next].0)
            }
            (_, value) => value,
        };
        self.set(knobs, value);
    }

    /// A step that changes something: up, or from the top down.
    pub fn toggle(&self, knobs: &mut Knobs) {
        let before = self.value(knobs);
        self.step(knobs, Step::Up);
        if self.value(knobs) == before {
            self.step(knobs, Step::Down);
        }
    }

    /// The value as panels show it.
    pub fn shown(&self, value: Value) -> String {
        match (&self.kind, value) {
            (Kind::Number(_, width), Value::Number(number)) if *width < 1.0 => format!("{number:.2}"),
            (_, Value::Number(number)) => format!("{number:.0}"),
            (_, Value::Angle(degrees)) => format!("{degrees:.0}°"),
            (_, Value::Switch(on)) => if on { "on" } else { "off" }.into(),
            (_, value) => value.to_string(),
        }
    }
}

/// The next whole number, so that what was typed on the command line comes back onto the grid.
fn on_grid(at: f32, up: bool) -> f64 {
    f64::from(if up { (at + 1e-3).floor() + 1.0 } else { (at - 1e-3).ceil() - 1.0 })
}

/// A value's way into the document and back.
pub(super) trait Field {
    fn value(&self) -> Value;
    /// A value of another kind changes nothing.
    fn assign(&mut self, value: Value);
}

macro_rules! fields {
    ($($type:ty: $kind:ident)*) => { $(impl Field for $type {
        fn value(&self) -> Value {
            Value::$kind(*self)
        }

        fn assign(&mut self, value: Value) {
            if let Value::$kind(value) = value {
                *self = value;
            }
        }
    })* };
}

macro_rules! choices {
    ($($type:ty)*) => { $(impl Field for $type {
        fn value(&self) -> Value {
            Value::Word(self.word())
        }

        fn assign(&mut self, value: Value) {
            if let Value::Word(word) = value {
                *self = <$type>::from_word(word).unwrap_or(*self);
            }
        }
    })* };
}

fields! { u32: Count f32: Number f64: Angle bool: Switch }
/// In words.
fn on_with(Condition { number, sparse }: &Condition) -> String {
    let range = match (number.start(), number.end()) {
        (from, &u32::MAX) => format!("on from {from} lights on"),
        (from, to) => format!("on from {from} to {to} lights"),
    };
    match sparse {
        Some((from, most)) => {
            format!("{range}, from {from} on if at most {most} lie on a m² of the largest side of their box")
        }
        None => range,
    }
}

choices! { Auto Indirect Mode Primary }
