//! Buffers of shaders, a line each: what it is called, where it is bound, what it holds, how many copies of it there are and
//! how long it is. All else follows: parameters of entry points, enums, strides, allocation, rotation, descriptors, bytes.

/// The table, handed to the macro `$use`. A line: descriptor set, buffer, element, copies, length, and its bindings: the names
/// that passes call its copies by, each with its binding number.
///
/// | copies | meaning |
/// |---|---|
/// | 0 | none of its own: it lies in a buffer that is dead by then |
/// | 1 | the same in every frame |
/// | 2 | ping-pong: this frame's and the previous frame's |
/// | 3 | a ring: the previous frame's, and two that passes go back and forth between |
#[macro_export]
macro_rules! resources {
    ($use:ident) => {
        $use! {
        //   set  buffer               element             copies length      bindings
            (0    instances            (InstanceGeometry)  1      Scene       { instances = 1 })
            (0    positions            (Vec3)              1      Scene       { positions = 2 })
            (0    attributes           (VertexAttributes)  1      Scene       { attributes = 3 })
            (0    indices              (u32)               1      Scene       { indices = 4 })
            (0    materials            (Material)          1      Scene       { materials = 5 })
            (0    lights               (Light)             1      Scene       { lights = 6 })
            (0    alias                (AliasEntry)        1      Scene       { alias = 7 })
            (0    second_uvs           (Vec2)              1      Scene       { second_uvs = 8 })
            (0    environment          (EnvironmentTexel)  1      Scene       { environment = 9 })
            (0    tree_nodes           (TreeNode)          1      Scene       { tree_nodes = 10 })
            (0    tree_lights          (u32)               1      Scene       { tree_lights = 11 })
            (0    tree_leaves          (u32)               1      Scene       { tree_leaves = 12 })
            (1    gbuffer              (GBufferTexel)      2      Pixels      { gbuffer = 1, previous_gbuffer = 2 })
            (1    reservoirs           (StoredReservoir)   3      Reservoirs  { reservoirs = 3, merged = 4, history = 5 })
            (1    radiance             (Vec3)              1      Pixels      { radiance = 6 })
            (1    display              (u32)               1      Pixels      { display = 7 })
            (1    tile_entries         (TileEntry)         1      Tiles       { tile_entries = 8 })
            (1    tile_points          (u32)               1      Tiles       { tile_points = 9 })
            (1    mean                 (Vec3)              1      Pixels      { mean = 10 })
            (1    reference            (Vec3)              0      Pixels      { reference = 11 })
            (1    statistics           (BlockSums)         1      Blocks      { statistics = 12 })
            (1    rays                 (StoredRay)         1      Pixels      { rays = 13 })
            (1    hits                 (u32)               1      Pixels      { hits = 14 })
            (1    visibility           (UVec2)             1      Pixels      { visibility = 15 })
            (1    pair_targets         (PairTargets)       0      Reservoirs  { pair_targets = 16 })
            (1    emission             (Vec3)              1      Pixels      { emission = 17 })
            (1    direct_diffuse       (Vec3)              1      Pixels      { direct_diffuse = 18 })
            (1    direct_specular      (Vec3)              1      Pixels      { direct_specular = 19 })
            (1    marks                (u32)               1      Cells       { marks = 20 })
            (1    cells                (Cell)              1      Cells       { cells = 21 })
            (1    lists                (ListEntry)         1      Lists       { lists = 22 })
            (1    findings             (u32)               1      Lists       { findings = 23 })
            (1    beliefs              (u32)               1      Beliefs     { beliefs = 24 })
            (1    observations         (u32)               1      Beliefs     { observations = 25 })
            (1    pool_entries         (TileEntry)         1      Pools       { pool_entries = 26 })
            (1    pool_points          (u32)               1      Pools       { pool_points = 27 })
            (1    points               (ScenePoint)        2      Pixels      { points = 28, previous_points = 29 })
            (1    caught               (u32)               1      Pixels      { caught = 30 })
            (1    aims                 (Aim)               1      Pixels      { aims = 31 })
            (1    paths                (StoredPath)        3      Pixels      { paths = 32, merged_paths = 33, path_history = 34 })
            (1    path_targets         (PairTargets)       0      Pixels      { path_targets = 35 })
            (1    indirect_diffuse     (Vec3)              1      Pixels      { indirect_diffuse = 36 })
            (1    indirect_specular    (Vec3)              1      Pixels      { indirect_specular = 37 })
            (1    landings             (u32)               1      Pixels      { landings = 38 })
            (1    hops                 (u32)               1      List        { hops = 39 })
            (1    smoothed             (Smoothed)          2      Pixels      { smoothed = 40, previous_smoothed = 41 })
            (1    filtered             (Filtered)          2      Pixels      { filtering = 42, filtered = 43 })
            (1    met                  (ScenePoint)        1      Reservoirs  { met = 44 })
            (1    aliased              (Vec3)              0      Pixels      { aliased = 45 })
            (1    antialiased          (Vec4)              2      Pixels      { antialiased = 46, previous_antialiased = 47 })
            (2    previous_lights      (Light)             1      Scene       { previous_lights = 1 })
            (2    motions              (InstanceMotion)    1      Scene       { motions = 2 })
            (2    previous_to_current  (u32)               1      Scene       { previous_to_current = 3 })
            (2    current_to_previous  (u32)               1      Scene       { current_to_previous = 4 })
        }
    };
}

/// What buffers hold: the types of the table.
pub mod element {
    pub use crate::alias_table::AliasEntry;
    pub use crate::cells::Cell;
    pub use crate::cells::list::ListEntry;
    pub use crate::denoise::{Filtered, Smoothed};
    pub use crate::environment::EnvironmentTexel;
    pub use crate::geometry::{InstanceGeometry, VertexAttributes};
    pub use crate::light::Light;
    pub use crate::light::tile::TileEntry;
    pub use crate::light::tree::TreeNode;
    pub use crate::material::Material;
    pub use crate::motion::InstanceMotion;
    pub use crate::passes::pair_targets::PairTargets;
    pub use crate::points::{Aim, ScenePoint};
    pub use crate::reservoir::{StoredPath, StoredReservoir};
    pub use crate::statistics::BlockSums;
    pub use crate::stored_ray::StoredRay;
    pub use crate::surface::GBufferTexel;
    pub use glam::{UVec2, Vec2, Vec3, Vec4};
}

/// Descriptor sets, and what is bound in them beside buffers.
pub mod set {
    /// The scene, the same for all frames.
    pub const SCENE: u32 = 0;
    /// The buffers of a frame, pushed for each pass.
    pub const FRAME: u32 = 1;
    /// The scene as it was in the previous frame.
    pub const PAST: u32 = 2;
    /// Acceleration structures of sets 0 and 2.
    pub const STRUCTURE: u32 = 0;
    /// Set 0, the last one: its length varies.
    pub const TEXTURES: u32 = 32;
    /// Set 1: [`crate::frame::FrameConstants`].
    pub const CONSTANTS: u32 = 0;
}

/// How many elements a buffer has, and how many threads a pass.
// Not a byte, which would be a capability of the device.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// As many as the scene has of it.
    Scene,
    /// One a pixel.
    Pixels,
    /// One for each reservoir of each pixel.
    Reservoirs,
    /// One for each entry of the light tiles.
    Tiles,
    /// One for each cell of the world, see [`crate::cells`].
    Cells,
    /// One for each place of each cell's list.
    Lists,
    /// One for each belief of cells.
    Beliefs,
    /// One for each sample of each cell's pool.
    Pools,
    /// A number, and that many of the pixels.
    List,
    /// One for each block of [`crate::statistics::BLOCK`] x BLOCK pixels.
    Blocks,
}

#[cfg(not(target_arch = "spirv"))]
macro_rules! declare {
    ($(($set:literal $buffer:ident ($element:ty) $copies:literal $extent:ident { $($name:ident = $binding:literal),* }))*) => {
        /// A buffer of the table.
        #[allow(non_camel_case_types, missing_docs)]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Resource { $($buffer),* }

        impl Resource {
            /// In the order of the table.
            pub const ALL: &'static [Resource] = &[$(Resource::$buffer),*];

            /// As in the table.
            pub const fn name(self) -> &'static str {
                match self { $(Resource::$buffer => stringify!($buffer)),* }
            }

            /// How many there are: frames take turns.
            pub const fn copies(self) -> usize {
                match self { $(Resource::$buffer => $copies),* }
            }

            /// How many elements it has.
            pub const fn extent(self) -> Extent {
                match self { $(Resource::$buffer => Extent::$extent),* }
            }

            /// Name of the elements' type.
            pub const fn element(self) -> &'static str {
                match self { $(Resource::$buffer => stringify!($element)),* }
            }

            /// Bytes of an element.
            pub const fn stride(self) -> usize {
                match self { $(Resource::$buffer => size_of::<$element>()),* }
            }
        }

        /// A copy of a buffer, as a pass calls it.
        #[allow(non_camel_case_types, missing_docs)]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Binding { $($($name),*),* }

        impl Binding {
            /// In the order of the table.
            pub const ALL: &'static [Binding] = &[$($(Binding::$name),*),*];

            /// As passes call it.
            pub const fn name(self) -> &'static str {
                match self { $($(Binding::$name => stringify!($name)),*),* }
            }

            /// The buffer that it is a copy of.
            pub const fn resource(self) -> Resource {
                match self { $($(Binding::$name => Resource::$buffer),*),* }
            }

            /// Its descriptor set.
            pub const fn set(self) -> u32 {
                match self { $($(Binding::$name => $set),*),* }
            }

            /// Number within its set.
            pub const fn number(self) -> u32 {
                match self { $($(Binding::$name => $binding),*),* }
            }
        }

        /// Buffers on the CPU, by the names that passes call them by; empty where nobody asks.
        #[allow(missing_docs)]
        #[derive(Clone, Copy, Default)]
        pub struct Buffers<'a> { $($(pub $name: &'a [$element]),*),* }

        impl<'a> Buffers<'a> {
            /// With `bytes` as the content of `binding`.
            ///
            /// Panics where they are not whole, aligned elements.
            pub fn set(&mut self, binding: Binding, bytes: &'a [u8]) {
                match binding { $($(Binding::$name => self.$name = bytemuck::cast_slice(bytes)),*),* }
            }
        }
    };
}

#[cfg(not(target_arch = "spirv"))]
mod declared {
    use super::Extent;
    use super::element::*;

    resources!(declare);
}
#[cfg(not(target_arch = "spirv"))]
pub use declared::{Binding, Buffers, Resource};

#[cfg(test)]
mod tests {
    use super::*;

    /// Two buffers in one place would be one.
    #[test]
    fn places_are_taken_once() {
        for (i, &a) in Binding::ALL.iter().enumerate() {
            for &b in &Binding::ALL[..i] {
                assert!((a.set(), a.number()) != (b.set(), b.number()), "{a:?} and {b:?}");
            }
            let taken = match a.set() {
                set::SCENE => &[set::STRUCTURE, set::TEXTURES][..],
                set::FRAME => &[set::CONSTANTS],
                _ => &[set::STRUCTURE],
            };
            assert!(!taken.contains(&a.number()), "{a:?}");
        }
    }
}
