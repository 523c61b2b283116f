//! Every knob: as a document of values ([`Knobs`]), and as its description ([`Knob`]). Both follow from the rows of
//! `shared/src/knobs.rs`, and from those below for the knobs of the host.

mod choice;
mod file;
mod knob;

pub use choice::{Auto, Choice, Indirect, Mode};
pub use knob::{Knob, Step, Value};

use crate::frame::schedule::Primary;
use knob::{Counting, Field, Kind};
use serde::{Deserialize, Serialize};
use shared::frame::Settings;
use shared::light::count::{Condition, LightCount};

/// The type of a knob in the document.
macro_rules! value {
    (count $args:tt) => {
        u32
    };
    (number $args:tt) => {
        f32
    };
    (angle $args:tt) => {
        f64
    };
    (switch $args:tt) => {
        bool
    };
    (auto $args:tt) => {
        Auto
    };
    (choice ($type:ident $(, $word:expr)?)) => {
        $type
    };
}

/// Its default there.
macro_rules! default {
    (auto $args:tt $default:ident) => {
        Auto::$default
    };
    (choice ($type:ident $(, $word:expr)?) $default:ident) => {
        $type::$default
    };
    ($kind:ident $args:tt $default:literal) => {
        $default
    };
}

/// The field of [`Settings`] for a value, in a scene of so many lights.
macro_rules! field {
    (switch $args:tt $on:expr, $lights:expr) => {
        $on.into()
    };
    (auto $args:tt $auto:expr, $lights:expr) => {
        $auto.is_on(condition!($args).holds($lights)).into()
    };
    (angle $args:tt $degrees:expr, $lights:expr) => {
        $degrees.to_radians().cos() as f32
    };
    (choice $args:tt $choice:expr, $lights:expr) => {
        $choice.into()
    };
    ($number:ident $args:tt $value:expr, $lights:expr) => {
        $value
    };
}

/// When a switch is on by itself.
macro_rules! condition {
    (($range:expr)) => {
        Condition { number: $range, sparse: None }
    };
    (($range:expr, $from:literal, $most:literal)) => {
        Condition { number: $range, sparse: Some(($from, $most)) }
    };
}

/// Range, steps and words.
macro_rules! kind {
    (count ($range:expr, $step:ident)) => {
        Kind::Count($range, Counting::$step)
    };
    (number ($range:expr, $step:literal)) => {
        Kind::Number($range, $step)
    };
    (angle ($range:expr, $step:literal)) => {
        Kind::Angle($range, $step)
    };
    (switch ()) => {
        Kind::Switch
    };
    (auto $args:tt) => {
        Kind::Auto(condition!($args))
    };
    (choice ($type:ident $(, $word:expr)?)) => {
        Kind::Choice(<$type as Choice>::WORDS)
    };
}

macro_rules! knobs {
    ({ $(
        $name:ident -> $field:ident: $kind:ident $args:tt = $default:tt, label $label:literal, about $about:literal,
        $(unit $unit:literal,)? higher $higher:literal, lower $lower:literal, bias $bias:literal;
    )* } { $(
        $host:ident: $host_kind:ident $host_args:tt = $host_default:tt, label $host_label:literal, about $host_about:literal,
        higher $host_higher:literal, lower $host_lower:literal, bias $host_bias:literal;
    )* }) => {
        /// A value for every knob. In a document a knob that is missing has its default; one that does not exist is an error.
        ///
        /// ```
        /// use candela::knobs::{Auto, Knobs, Mode};
        ///
        /// let thesis = Knobs { mode: Mode::Biased, iterations: 2, radius: 30.0, cells: Auto::Off, ..Knobs::default() };
        /// thesis.check()?;
        /// let settings = thesis.settings(500);
        /// assert!(settings.radius == 30.0 && settings.cells == 0);
        /// assert!(Knobs { candidates: 0, ..Knobs::default() }.check().is_err());
        /// # Ok::<(), String>(())
        /// ```
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct Knobs {
            $(#[doc = $about] pub $name: value!($kind $args),)*
            $(#[doc = $host_about] pub $host: value!($host_kind $host_args),)*
        }

        impl Default for Knobs {
            fn default() -> Self {
                Knobs {
                    $($name: default!($kind $args $default),)*
                    $($host: default!($host_kind $host_args $host_default),)*
                }
            }
        }

        impl Knobs {
            /// What shaders read, in a scene of so many lights.
            pub fn settings(&self, lights: impl Into<LightCount>) -> Settings {
                let lights = lights.into();
                Settings { $($field: field!($kind $args self.$name, lights),)* }
            }
        }

        /// All of them, in the order in which they are shown.
        pub static ALL: &[&Knob] = &[$(&by_name::$name,)* $(&by_name::$host,)*];

        /// By the names of the document.
        #[allow(missing_docs)]
        #[expect(non_upper_case_globals, reason = "they have the names of the document")]
        pub mod by_name {
            use super::*;

            $(pub static $name: Knob = Knob {
                name: stringify!($name),
                label: $label,
                about: $about,
                unit: concat!($($unit)?),
                higher: $higher,
                lower: $lower,
                bias: $bias,
                kind: kind!($kind $args),
                get: |knobs| knobs.$name.value(),
                set: |knobs, value| knobs.$name.assign(value),
            };)*

            $(pub static $host: Knob = Knob {
                name: stringify!($host),
                label: $host_label,
                about: $host_about,
                unit: "",
                higher: $host_higher,
                lower: $host_lower,
                bias: $host_bias,
                kind: kind!($host_kind $host_args),
                get: |knobs| knobs.$host.value(),
                set: |knobs, value| knobs.$host.assign(value),
            };)*
        }
    };
}

shared::knobs!(knobs {
    primary: choice(Primary) = Auto,
        label "Primary", about "How a frame finds the surface of each pixel",
        higher "raster: no rays from the eye", lower "rays: one a pixel",
        bias "none; a pixel whose center lies on an edge may show the other side";
});

impl Knobs {
    /// The first knob that is out of its range, in one line.
    pub fn check(&self) -> Result<(), String> {
        let wrong =
            |knob: &&Knob| knob.check(knob.value(self)).map_err(|e| format!("{}: {e}", knob.name)).err();
        ALL.iter().find_map(wrong).map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests;
