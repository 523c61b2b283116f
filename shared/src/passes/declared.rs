//! What the table of passes says, for the host.

use super::pair_targets::PairTargets;
use super::{At, Visibility, Witness};
use crate::points::ScenePoint;
use crate::reservoir::StoredReservoir;
use crate::resources::{Binding, Buffers, Extent};
use glam::Vec3;

/// How a pass runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// A compute shader.
    Compute,
    /// A ray generation shader.
    RayTracing(Rays),
    /// Vertex and fragment shaders draw the scene into an image, which is copied to the pass's buffer.
    Raster,
}

/// Which hit and miss shaders a ray-tracing pass needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rays {
    /// Rays from the camera.
    Primary,
    /// Shadow rays.
    Shadow,
    /// Shadow rays, and BSDF rays where the scene has lights that rays can find.
    Both,
    /// Shadow rays, and rays that ask what they meet.
    Bounces,
}

/// What a pass does with a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// It reads.
    Read,
    /// It writes what it did not read.
    Write,
    /// It reads and writes.
    ReadWrite,
}

impl Access {
    /// Does the pass write it?
    pub fn writes(self) -> bool {
        self != Access::Read
    }
}

macro_rules! stage {
    (compute) => {
        Stage::Compute
    };
    (known $($scene:ident)?) => {
        Stage::Compute
    };
    (traced scene $($rays:ident)*) => {
        stage!(traced $($rays)*)
    };
    (drawn) => {
        Stage::Raster
    };
    (primary) => {
        Stage::RayTracing(Rays::Primary)
    };
    (bounced) => {
        Stage::RayTracing(Rays::Bounces)
    };
    (sparse) => {
        Stage::RayTracing(Rays::Bounces)
    };
    (listed shadow) => {
        Stage::RayTracing(Rays::Shadow)
    };
    (traced shadow nearest) => {
        Stage::RayTracing(Rays::Both)
    };
    (traced shadow $($previous:ident)?) => {
        Stage::RayTracing(Rays::Shadow)
    };
}

/// What a body reads; images are no buffers.
macro_rules! uses {
    ([$($done:tt)*]) => { &[$($done)*] };
    ([$($done:tt)*] textures $($rest:tt)*) => { uses!([$($done)*] $($rest)*) };
    ([$($done:tt)*] $name:ident $($rest:tt)*) => { uses!([$($done)* (Binding::$name, Access::Read),] $($rest)*) };
    ([$($done:tt)*] ($access:ident $name:ident) $($rest:tt)*) => {
        uses!([$($done)* (Binding::$name, Access::$access),] $($rest)*)
    };
}

macro_rules! declare {
    ($(($body:ident $extent:ident { $($stage:ident($($rays:ident)*) $stem:ident),* }
        [$($read:ident)*] [$($update:ident)*] [$($write:ident)*] $([$($count:ident)*])?))*) => {
        /// A pass's body.
        #[allow(non_camel_case_types, missing_docs)]
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Body { $($body),* }

        /// A pass: a body with one of its entry points.
        #[allow(non_camel_case_types, missing_docs)]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Pass { $($($stem),*),* }

        impl Pass {
            /// In the order of the table.
            pub const ALL: &'static [Pass] = &[$($(Pass::$stem),*),*];

            /// Names the shader file, the entry point, the debug label, the timestamp and the column of reports.
            pub const fn stem(self) -> &'static str {
                match self { $($(Pass::$stem => stringify!($stem)),*),* }
            }

            /// The body that it runs.
            pub const fn body(self) -> Body {
                match self { $($(Pass::$stem => Body::$body),*),* }
            }

            /// How it runs.
            pub const fn stage(self) -> Stage {
                match self { $($(Pass::$stem => stage!($stage $($rays)*)),*),* }
            }

            /// What it launches a thread for each of.
            pub const fn extent(self) -> Extent {
                match self.body() { $(Body::$body => Extent::$extent),* }
            }

            /// Its buffers.
            pub const fn uses(self) -> &'static [(Binding, Access)] {
                match self.body() {
                    $(Body::$body =>
                        uses!([] $($read)* $((ReadWrite $update))* $((Write $write))* $($((ReadWrite $count))*)?)),*
                }
            }
        }
    };
}

crate::passes!(declare);

/// What a body of the estimator gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// Of passes that fill or merge reservoirs.
    Reservoir(StoredReservoir),
    /// Of `pair_targets`.
    Targets(PairTargets),
    /// nit
    Radiance(Vec3),
    /// Diffuse under an albedo of 1, specular.
    Parts(Vec3, Vec3),
    /// 1: the ray met something.
    Hit(u32),
}

impl From<StoredReservoir> for Output {
    fn from(reservoir: StoredReservoir) -> Self {
        Output::Reservoir(reservoir)
    }
}

impl From<(StoredReservoir, ScenePoint)> for Output {
    fn from((reservoir, _): (StoredReservoir, ScenePoint)) -> Self {
        Output::Reservoir(reservoir)
    }
}

impl From<PairTargets> for Output {
    fn from(targets: PairTargets) -> Self {
        Output::Targets(targets)
    }
}

impl From<Vec3> for Output {
    fn from(radiance: Vec3) -> Self {
        Output::Radiance(radiance)
    }
}

impl From<(Vec3, Vec3)> for Output {
    fn from((diffuse, specular): (Vec3, Vec3)) -> Self {
        Output::Parts(diffuse, specular)
    }
}

impl From<u32> for Output {
    fn from(hit: u32) -> Self {
        Output::Hit(hit)
    }
}

macro_rules! runs {
    ($(($body:ident $extent:ident { $stage:ident $rays:tt $stem:ident $($more:tt)* } $read:tt $update:tt $write:tt $($count:tt)?))*) => {
        /// Runs one thread of a body that rays decide over, as the GPU's entry points do, from `buffers`; none of a body that
        /// asks for no rays. Elements that it updates are read from `buffers` too.
        #[allow(unused_variables)]
        pub fn run(
            body: Body,
            at: At<'_>,
            rays: impl Visibility,
            note: impl Witness,
            buffers: &Buffers<'_>,
        ) -> Option<Output> {
            $(run_of!($stage $rays $body $extent $read $update, body, at, rays, note, buffers);)*
            None
        }
    };
}

macro_rules! run_of {
    (known (scene) $($rest:tt)*) => {};
    (traced (scene $($rays:ident)*) $($rest:tt)*) => {};
    (known () $($rest:tt)*) => { run_of!(asks $($rest)*) };
    (traced $rays:tt $($rest:tt)*) => { run_of!(asks $($rest)*) };
    (listed $rays:tt $name:ident $extent:ident [$list:ident $($read:ident)*] $($rest:tt)*) => {
        run_of!(asks $name $extent [$($read)*] $($rest)*)
    };
    (asks $name:ident $extent:ident [$($read:ident)*] [$($update:ident)*],
        $body:ident, $at:ident, $rays:ident, $note:ident, $buffers:ident) => {
        if $body == Body::$name {
            let index = $at.index(Extent::$extent);
            let result = super::$name($at, $rays, $note, $($buffers.$read,)* $($buffers.$update[index],)*);
            return Some(result.into());
        }
    };
    ($stage:ident $rays:tt $name:ident $extent:ident $read:tt $update:tt, $($rest:tt)*) => {};
}

crate::passes!(runs);
