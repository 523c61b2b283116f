//! What stays the same for all pixels of a frame: cameras, size, seed and every knob.

use crate::camera::Camera;
use bytemuck::{Pod, Zeroable};
use glam::UVec2;

/// The type of a knob's field.
macro_rules! word {
    (number) => {
        f32
    };
    (angle) => {
        f32
    };
    ($other:ident) => {
        u32
    };
}

/// The default of a knob's field.
#[cfg(not(target_arch = "spirv"))]
macro_rules! default {
    (switch () $on:literal) => {
        $on as u32
    };
    // Off: how many lights there are is not known here.
    (auto $args:tt $auto:ident) => {
        0
    };
    (choice ($type:ident, $value:expr) $choice:ident) => {
        $value
    };
    (angle $args:tt $degrees:literal) => {
        f64::to_radians($degrees).cos() as f32
    };
    ($number:ident $args:tt $value:literal) => {
        $value
    };
}

macro_rules! settings {
    ({ $(
        $name:ident -> $field:ident: $kind:ident $args:tt = $default:tt, label $label:literal, about $about:literal,
        $(unit $unit:literal,)? higher $higher:literal, lower $lower:literal, bias $bias:literal;
    )* } {}) => {
        /// Every knob of the estimator, as shaders read it: a field for each row of [`crate::knobs!`].
        #[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
        #[repr(C)]
        pub struct Settings {
            $(
                #[doc = concat!($about, $(", ", $unit,)? ": `", stringify!($kind $args), "`.")]
                pub $field: word!($kind),
            )*
        }

        /// The least error in the least time on measured scenes (docs/results.md); not the thesis's knobs in two: it has 1/M
        /// weights and two spatial passes.
        #[cfg(not(target_arch = "spirv"))]
        impl Default for Settings {
            fn default() -> Self {
                Settings { $($field: default!($kind $args $default),)* }
            }
        }
    };
}

crate::knobs!(settings {});

/// How reused reservoirs are weighted.
pub mod mode {
    /// 1/M (Bitterli et al. 2020, Alg. 4).
    pub const BIASED: u32 = 0;
    /// Pairwise MIS, with the neighbor's visibility where visibility reuse is on.
    pub const UNBIASED: u32 = 1;
}

/// How often light is reflected on its way to what a pixel sees.
pub mod indirect {
    /// Never: direct light alone.
    pub const OFF: u32 = 0;
    /// Once at most.
    pub const ONE: u32 = 1;
    /// As often as it is.
    pub const FULL: u32 = 2;

    /// How often at most.
    pub fn bounces(indirect: u32) -> u32 {
        match indirect {
            OFF => 0,
            ONE => 1,
            _ => crate::interface::UNBOUNDED,
        }
    }
}

impl Settings {
    /// Does every reservoir between passes hold a sample that no opaque surface hides, or none?
    pub fn visibility_is_known(&self) -> bool {
        self.mode == mode::UNBIASED && self.visibility_reuse != 0
    }

    /// Are neighbors merged in pairs?
    pub fn in_pairs(&self) -> bool {
        self.pairs != 0 && self.mode == mode::UNBIASED
    }

    /// For frames whose mean is taken. They had better differ: a history counts no more than another point's.
    pub fn for_a_mean(self) -> Self {
        Settings { history_cap: self.history_cap.min(self.confidence_cap), ..self }
    }

    /// M: candidates of each reservoir from the light table or from cells, in a frame.
    pub fn light_candidates(&self) -> u32 {
        // Those of cells are worth more than twice as much (docs/performance.md).
        if self.cells != 0 { self.candidates.div_ceil(2) } else { self.candidates }
    }

    /// t of [`crate::resampling::pairwise`] for neighbors. With a history all reservoirs stand for many candidates, but neighbors'
    /// for other targets than the pixel's own: together they count as much as that. Measured in docs/performance.md.
    pub fn neighbor_trust(&self) -> f32 {
        let neighbors = if self.in_pairs() { 1 } else { self.neighbors };
        if self.temporal != 0 { 1.0 / (neighbors * self.spatial_iterations) as f32 } else { 1.0 }
    }

    /// The same for paths, which always merge in pairs.
    pub fn pair_trust(&self) -> f32 {
        if self.temporal != 0 { 1.0 / self.spatial_iterations as f32 } else { 1.0 }
    }

    /// BSDF candidates of each reservoir in a scene with `features`. A ray finds visible samples only, so hidden ones have to be
    /// dropped too, or their weights would be wrong: visibility reuse does that.
    pub fn bsdf_candidates(&self, features: u32) -> u32 {
        let acts = self.visibility_reuse != 0 && features & features::TRACEABLE != 0;
        if acts { self.bsdf_candidates } else { 0 }
    }

    /// Shading asks again where visibility is not known, or where something is transparent: reuse sees opaque surfaces
    /// only. `features`: of the scene.
    pub fn shading_needs_rays(&self, features: u32) -> bool {
        !self.visibility_is_known() || features & features::ALPHA != 0
    }
}

/// Constants of one frame, the same for all of its passes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FrameConstants {
    /// Sees the frame.
    pub camera: Camera,
    /// The camera of the previous frame; equal to `camera` in the first.
    pub previous_camera: Camera,
    /// Image size in pixels.
    pub size: UVec2,
    /// Number of the frame since the start of its history: 0 has no past.
    pub index: u32,
    /// Seed of the run.
    pub seed: u32,
    /// Knobs, as shaders read them.
    pub settings: Settings,
    /// Factor from cd/m² to display values.
    pub exposure: f32,
    /// Radiance of what lies behind the scene, nit, linear RGB; an environment map takes its place.
    pub background: glam::Vec3,
    /// Texels of the environment map; 0 without one.
    pub environment_size: UVec2,
    /// Index of the light of the map's first lit texel.
    pub first_environment_light: u32,
    /// Lights of the light tree.
    pub tree_lights: u32,
    /// Place in its pixel that each looks through, packed ([`crate::math::pack_place`]), where points do not last.
    pub place: u32,
}

impl FrameConstants {
    /// Of the picture.
    pub fn pixels(&self) -> u32 {
        self.size.x * self.size.y
    }

    /// Place of `pixel` in the frame's buffers (rows from the top).
    pub fn pixel_index(&self, pixel: UVec2) -> u32 {
        pixel.y * self.size.x + pixel.x
    }

    /// The pixel at that place.
    pub fn pixel_at(&self, index: u32) -> UVec2 {
        UVec2::new(index % self.size.x, index / self.size.x)
    }
}

/// What a scene contains, as bits: pipelines are specialised with them.
pub mod features {
    /// At least one material has a texture.
    pub const TEXTURES: u32 = 1;
    /// At least one material has a normal map.
    pub const NORMAL_MAPS: u32 = 2;
    /// At least one texture has a transform or reads the second uv set.
    pub const UV_MAPS: u32 = 4;
    /// At least one material is masked or blended: any-hit shaders run on its triangles.
    pub const ALPHA: u32 = 8;
    /// A ray may end where a light is known: there is an environment map, or a triangle that rays can find.
    pub const TRACEABLE: u32 = 16;
    /// Light arrives at the curved surfaces that triangles with different normals at their corners stand for, see [`crate::geometry::InstanceGeometry::bulge`].
    pub const SMOOTH: u32 = 32;
    /// There is an environment map.
    pub const ENVIRONMENT: u32 = 1 << 16;
    /// There are lights of [`crate::light::kind`] k where bit k above this one is set.
    pub const FIRST_LIGHT_KIND: u32 = 17;

    /// All those bits.
    pub const LIGHT_KINDS: u32 = u32::MAX << FIRST_LIGHT_KIND;

    /// The bit that lights of `kind` set.
    pub const fn light_kind(kind: u32) -> u32 {
        1 << (FIRST_LIGHT_KIND + kind)
    }
}
