//! The kinds of light: one list, and all that follows from it. Each question is a chain of tests, one a kind that it concerns,
//! and kinds that a scene has not cost nothing: see [`Lights::features`](super::Lights).

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
use super::directional::Directional;
use super::disk::Disk;
use super::environment::Texel;
use super::point::Point;
use super::rectangle::Rectangle;
#[cfg(test)]
use super::sampling_tests::{Known, Sample};
#[cfg(test)]
use super::segment::Segment;
use super::soft_spot::SoftSpot;
use super::sphere::Sphere;
use super::spot::Spot;
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::triangle::Triangle;
use super::{Incident, Kind, Light, Place, Shape};
use crate::frame::features;
use glam::{Vec2, Vec3};

/// A view that is in the list.
pub trait Listed {
    /// `Light::kind` of its lights.
    const KIND: u32;
}

/// What is said of a kind.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KindFacts {
    /// `Light::kind`
    pub kind: u32,
    /// What one such light is called, and several.
    pub name: &'static str,
    /// What several are called.
    pub lights: &'static str,
    /// See [`Kind::HAS_EXTENT`].
    pub has_extent: bool,
}

#[cfg(not(target_arch = "spirv"))]
const fn facts<K: HostKind>() -> KindFacts {
    KindFacts { kind: K::KIND, name: K::NAME, lights: K::LIGHTS, has_extent: K::HAS_EXTENT }
}

macro_rules! kinds {
    ($($(#[$when:meta])* $NAME:ident: $view:ident,)* ..$LAST:ident: $last:ident) => {
        #[allow(clippy::upper_case_acronyms, non_camel_case_types)]
        #[repr(u32)]
        enum Order {
            $($(#[$when])* $NAME,)*
            $LAST,
        }

        /// `Light::kind`: their order in the list.
        pub mod kind {
            use super::Order;
            $(
                $(#[$when])*
                #[doc = concat!("Of `", stringify!($view), "`.")]
                pub const $NAME: u32 = Order::$NAME as u32;
            )*
            #[doc = concat!("Of `", stringify!($last), "`.")]
            pub const $LAST: u32 = Order::$LAST as u32;
            /// How many there are.
            pub const COUNT: u32 = $LAST + 1;
        }

        $($(#[$when])* impl Listed for $view {
            const KIND: u32 = kind::$NAME;
        })*
        impl Listed for $last {
            const KIND: u32 = kind::$LAST;
        }

        // What a kind says of itself goes together.
        $($(#[$when])* const _: () = is_sound::<$view>();)*
        const _: () = is_sound::<$last>();

        /// Of every kind, by `Light::kind`.
        #[cfg(not(target_arch = "spirv"))]
        pub const KINDS: [KindFacts; kind::COUNT as usize] =
            [$($(#[$when])* facts::<$view>(),)* facts::<$last>()];

        /// Are lights of `kind` of this shape, in a scene with these [`features`]?
        pub(super) fn is_shape(kind: u32, shape: Shape, features: u32) -> bool {
            let mut is = false;
            $($(#[$when])* {
                if $view::SHAPE as u32 == shape as u32 {
                    is |= is_kind(kind, kind::$NAME, features);
                }
            })*
            if $last::SHAPE as u32 == shape as u32 {
                is |= is_kind(kind, kind::$LAST, features);
            }
            is
        }

        /// Do lights of `kind` shine more in some directions than in others?
        pub(super) fn attenuates(kind: u32, features: u32) -> bool {
            let mut do_so = false;
            $($(#[$when])* {
                if $view::ATTENUATES {
                    do_so |= is_kind(kind, kind::$NAME, features);
                }
            })*
            if $last::ATTENUATES {
                do_so |= is_kind(kind, kind::$LAST, features);
            }
            do_so
        }

        impl Light {
            /// See [`Kind::place`]. `features`: as in [`Lights`](super::Lights); the last kind needs no test.
            pub(super) fn place(&self, square: Vec2, features: u32) -> Place {
                $($(#[$when])* {
                    if const { !is_one_point::<$view>() } && is_kind(self.kind, kind::$NAME, features) {
                        return $view::of(self).place(square);
                    }
                })*
                $last::of(self).place(square)
            }

            /// See [`Kind::seen`].
            pub(super) fn seen(&self, square: Vec2, receiver: Vec3, features: u32) -> Incident {
                $($(#[$when])* {
                    if const { matches!($view::SHAPE, Shape::Seen) } && is_kind(self.kind, kind::$NAME, features) {
                        return $view::of(self).seen(square, receiver);
                    }
                })*
                $last::of(self).seen(square, receiver)
            }

            /// See [`Kind::attenuation`].
            pub(super) fn attenuation(&self, direction: Vec3, features: u32) -> f32 {
                $($(#[$when])* {
                    if $view::ATTENUATES && is_kind(self.kind, kind::$NAME, features) {
                        return $view::of(self).attenuation(direction);
                    }
                })*
                $last::of(self).attenuation(direction)
            }

            /// See [`Kind::measure`].
            pub(super) fn measure(&self, features: u32) -> f32 {
                $($(#[$when])* {
                    if $view::HAS_EXTENT && is_kind(self.kind, kind::$NAME, features) {
                        return $view::of(self).measure();
                    }
                })*
                $last::of(self).measure()
            }

            /// Has it more than one point to sample?
            pub fn has_extent(&self) -> bool {
                let mut has = false;
                $($(#[$when])* {
                    if $view::HAS_EXTENT {
                        has |= self.kind == kind::$NAME;
                    }
                })*
                if $last::HAS_EXTENT {
                    has |= self.kind == kind::$LAST;
                }
                has
            }

            /// The inverse of [`Light::sample_li`] for a light that rays can find: the point of the unit square that lies in
            /// `direction` (unit) from `receiver`; the nearest one, where rounding leads past an edge.
            pub fn invert_li(&self, direction: Vec3, receiver: Vec3) -> Vec2 {
                $($(#[$when])* {
                    if $view::TRACEABLE && self.kind == kind::$NAME {
                        return $view::of(self).invert(direction, receiver);
                    }
                })*
                $last::of(self).invert(direction, receiver)
            }

            /// See [`HostKind::bound`].
            #[cfg(not(target_arch = "spirv"))]
            pub(super) fn bound(&self) -> Option<Bound> {
                match self.kind {
                    $($(#[$when])* kind::$NAME => $view::of(self).bound(),)*
                    _ => $last::of(self).bound(),
                }
            }

            /// See [`HostKind::flux_factor`].
            #[cfg(not(target_arch = "spirv"))]
            pub(super) fn flux_factor(&self) -> f32 {
                match self.kind {
                    $($(#[$when])* kind::$NAME => $view::of(self).flux_factor(),)*
                    kind::$LAST => $last::of(self).flux_factor(),
                    _ => 0.0,
                }
            }
        }

        /// Of every kind: its name, and a light whose numbers are known from elsewhere.
        #[cfg(test)]
        pub(super) const SAMPLES: [(&str, fn(f32) -> Known); kind::COUNT as usize] = [
            $($(#[$when])* ($view::NAME, <$view as Sample>::known),)*
            ($last::NAME, <$last as Sample>::known),
        ];

        /// See [`Sample::quarter`].
        #[cfg(test)]
        pub(super) fn quarter(light: &Light, place: Vec3) -> usize {
            match light.kind {
                $($(#[$when])* kind::$NAME => $view::of(light).quarter(place),)*
                _ => $last::of(light).quarter(place),
            }
        }
    };
}

// In the order of the tests. What is none of the others needs none, so what is drawn most often comes last.
kinds! {
    TRIANGLE: Triangle,
    DIRECTIONAL: Directional,
    ENVIRONMENT: Texel,
    SPHERE: Sphere,
    RECTANGLE: Rectangle,
    DISK: Disk,
    SOFT_SPOT: SoftSpot,
    // The example of docs/adding-a-light.md.
    #[cfg(test)]
    SEGMENT: Segment,
    SPOT: Spot,
    ..POINT: Point
}

/// Points of space without extent are where their `position` is: the last kind's answer is theirs.
const fn is_one_point<K: Kind>() -> bool {
    matches!(K::SHAPE, Shape::Point) && !K::HAS_EXTENT
}

/// Can the generic code do what the kind asks for?
const fn is_sound<K: Kind>() {
    assert!(!K::ATTENUATES || matches!(K::SHAPE, Shape::Point), "only points attenuate");
    assert!(!K::TRACEABLE || K::HAS_EXTENT && !matches!(K::SHAPE, Shape::Point), "no ray meets a point");
    assert!(K::HAS_EXTENT || !matches!(K::SHAPE, Shape::Surface | Shape::Seen), "a surface has extent");
    assert!(
        !K::TRACEABLE || !matches!(K::SHAPE, Shape::Seen),
        "a density of its points is known to it alone"
    );
}

// A bit of the features each, and four bits of a tile's entry.
const _: () = assert!(features::FIRST_LIGHT_KIND + kind::COUNT <= u32::BITS && kind::COUNT <= 16);

/// Is a light of kind `this` of kind `that`, in a scene with these [`features`]?
fn is_kind(this: u32, that: u32, features: u32) -> bool {
    // No branch: two comparisons that specialisation folds.
    (features & features::light_kind(that) != 0) & (this == that)
}
