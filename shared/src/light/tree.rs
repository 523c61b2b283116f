//! A binary tree over the lights that are somewhere (Conty Estevez & Kulla 2018, "Importance Sampling of Many Lights with
//! Adaptive Tree Splitting"): each node bounds its lights in space and in direction, and a walk from the root draws one with a
//! probability that is known exactly. Receivers are small regions, [`Receiver`]: what is drawn for one serves all of its pixels.
//!
//! Lights lie at the leaves in the order of their Morton codes; a node of n leaves has n/2 of them, rounded down, under its first
//! child. A subtree of n leaves takes 2n - 1 nodes in a row: no pointers.

use crate::cells::belief::{self, Beliefs};
use crate::math::unpack_direction;
use crate::motion::NO_LIGHT;
use crate::pdf::Pmf;
use crate::rng::{Rng, unit_f32};
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// A node. 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TreeNode {
    /// Box of its lights, world space, m.
    min: Vec3,
    /// Σ of the greatest intensities of its lights, cd.
    intensity: f32,
    max: Vec3,
    /// Cone that all its light leaves within: an octahedral axis of 8 + 8 bits, and above it the half angle as a fraction of π in 16.
    cone: u32,
}

/// A small region that light is drawn for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Receiver {
    /// World space, m.
    pub center: Vec3,
    /// All of it lies within, m.
    pub radius: f32,
    /// Unit; that of most of its surfaces.
    pub normal: Vec3,
}

/// What is left of a light that most likely doesn't reach the receiver: all bounds are guesses for the whole of it.
const UNLIKELY: f32 = 0.05;

impl TreeNode {
    /// Of its cone.
    fn axis(&self) -> Vec3 {
        unpack_direction((self.cone & 0xff) << 8 | (self.cone & 0xff00) << 16)
    }

    /// How much of it may arrive at `receiver` unshadowed, lx: only ratios matter.
    fn importance(&self, receiver: &Receiver) -> f32 {
        let to = 0.5 * (self.min + self.max) - receiver.center;
        let half = 0.5 * (self.max - self.min).length() + receiver.radius;
        let distance2 = to.dot(to);
        let mut importance = self.intensity / distance2.max(half * half).max(f32::MIN_POSITIVE);
        let distance = distance2.sqrt();
        // Within the sphere around both every direction is possible.
        if distance > half {
            let uncertain = (half / distance).asin();
            let angle = (-self.axis().dot(to) / distance).clamp(-1.0, 1.0).acos();
            let widest = (self.cone >> 16) as f32 * (core::f32::consts::PI / 65535.0) + uncertain;
            if angle > widest {
                importance *= UNLIKELY;
            }
            if receiver.normal.dot(to) < -half {
                importance *= UNLIKELY;
            }
        }
        importance
    }
}

/// The tree as shaders read it.
#[derive(Clone, Copy)]
pub struct LightTree<'a> {
    /// 2n - 1 of them for n lights.
    pub nodes: &'a [TreeNode],
    /// The light of each leaf.
    pub lights: &'a [u32],
    /// The leaf of each light; [`NO_LIGHT`] for light from infinity.
    pub leaves: &'a [u32],
    /// n: buffers of nothing are longer.
    pub count: u32,
}

/// A light as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// [`NO_LIGHT`]: none.
    pub light: u32,
    /// The probability of drawing it.
    pub pmf: Pmf,
    /// The fraction of its light that is believed to arrive, in [0, 1].
    pub visibility: f32,
}

impl Draw {
    /// No light.
    pub fn none() -> Self {
        Draw { light: NO_LIGHT, pmf: Pmf(0.0), visibility: 1.0 }
    }
}

/// A walk from the root to a leaf.
#[derive(Clone, Copy)]
struct Walk {
    node: u32,
    /// Leaves below `node`: the first one and how many.
    first: u32,
    count: u32,
    /// Probability of having come here.
    pmf: f32,
    /// What is believed of `node`, and whether there is a ray that it stands on.
    visibility: f32,
    asked: bool,
}

/// The children of a node.
#[derive(Clone, Copy)]
struct Fork {
    /// Their probabilities, and what is believed of them.
    pmf: [f32; 2],
    visibility: [f32; 2],
    asked: [bool; 2],
}

impl Walk {
    /// From the root of a tree of `count` leaves.
    fn start(count: u32, visibility: f32) -> Self {
        Walk { node: 0, first: 0, count, pmf: 1.0, visibility, asked: true }
    }

    fn children(self) -> [u32; 2] {
        [self.node + 1, self.node + 2 * (self.count / 2)]
    }

    /// Is leaf `leaf` below the second child?
    fn is_second(self, leaf: u32) -> bool {
        leaf >= self.first + self.count / 2
    }

    /// To the first child, or to the second one.
    fn step(self, second: bool, fork: Fork) -> Self {
        let half = self.count / 2;
        let [first_child, second_child] = self.children();
        if second {
            Walk {
                node: second_child,
                first: self.first + half,
                count: self.count - half,
                pmf: self.pmf * fork.pmf[1],
                visibility: fork.visibility[1],
                asked: fork.asked[1],
            }
        } else {
            Walk {
                node: first_child,
                first: self.first,
                count: half,
                pmf: self.pmf * fork.pmf[0],
                visibility: fork.visibility[0],
                asked: fork.asked[0],
            }
        }
    }
}

/// Hands `each` the nodes from the root, without it, to leaf `leaf` of `count`.
pub fn path(leaf: u32, count: u32, mut each: impl FnMut(u32)) {
    let mut walk = Walk::start(count, 1.0);
    while walk.count > 1 {
        walk = walk
            .step(walk.is_second(leaf), Fork { pmf: [1.0; 2], visibility: [1.0; 2], asked: [true, true] });
        each(walk.node);
    }
}

impl LightTree<'_> {
    /// Where `walk` stands.
    ///
    /// Equation (31).
    fn fork(self, walk: Walk, receiver: &Receiver, beliefs: &Beliefs<'_>) -> Fork {
        let [a, b] = walk.children();
        // Below what nobody has asked for there is nothing to look up.
        let rays = if walk.asked { [beliefs.rays(a), beliefs.rays(b)] } else { [0, 0] };
        let prior = walk.visibility;
        let visibility = [belief::believed(rays[0], prior), belief::believed(rays[1], prior)];
        let first = self.nodes[a as usize].importance(receiver) * belief::weight(visibility[0]);
        let second = self.nodes[b as usize].importance(receiver) * belief::weight(visibility[1]);
        // Dark lights are all alike.
        let pmf = if first + second > 0.0 { first / (first + second) } else { 0.5 };
        Fork { pmf: [pmf, 1.0 - pmf], visibility, asked: [rays[0] > 0xffff, rays[1] > 0xffff] }
    }

    /// Draws a light for a receiver in a cell that believes `beliefs`, and `all` of all lights; none without lights.
    pub fn sample(self, receiver: &Receiver, beliefs: &Beliefs<'_>, all: f32, rng: &mut Rng) -> Draw {
        if self.count == 0 {
            return Draw::none();
        }
        let mut walk = Walk::start(self.count, all);
        let mut random = UVec4::ZERO;
        let mut level = 0;
        while walk.count > 1 {
            random =
                if level & 3 == 0 { rng.next_u32x4() } else { UVec4::new(random.y, random.z, random.w, 0) };
            let fork = self.fork(walk, receiver, beliefs);
            walk = walk.step(unit_f32(random.x) >= fork.pmf[0], fork);
            level += 1;
        }
        Draw { light: self.lights[walk.first as usize], pmf: Pmf(walk.pmf), visibility: walk.visibility }
    }

    /// The draw of `light`, as [`LightTree::sample`] makes it; its probability is 0 for light from infinity.
    pub fn draw(self, light: u32, receiver: &Receiver, beliefs: &Beliefs<'_>, all: f32) -> Draw {
        let leaf = self.leaves[light as usize];
        if leaf == NO_LIGHT {
            return Draw { light, pmf: Pmf(0.0), visibility: beliefs.of(belief::far_away(light), all) };
        }
        let mut walk = Walk::start(self.count, all);
        while walk.count > 1 {
            walk = walk.step(walk.is_second(leaf), self.fork(walk, receiver, beliefs));
        }
        Draw { light, pmf: Pmf(walk.pmf), visibility: walk.visibility }
    }
}

/// Where a light is and where it shines.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// World space, m.
    pub min: Vec3,
    /// World space, m.
    pub max: Vec3,
    /// Unit, the middle of its directions.
    pub axis: Vec3,
    /// It shines at most this far from `axis`, rad; π: everywhere.
    pub angle: f32,
}

#[cfg(not(target_arch = "spirv"))]
pub use host::{Tree, build};

#[cfg(not(target_arch = "spirv"))]
mod host {
    use super::*;
    use crate::light::Light;
    use crate::math::pack_direction;
    use core::f32::consts::PI;
    use glam::DVec3;

    /// A tree, owned.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub struct Tree {
        /// Parents before their children.
        pub nodes: Vec<TreeNode>,
        /// Lights in the order of the leaves.
        pub lights: Vec<u32>,
        /// The leaf of each light.
        pub leaves: Vec<u32>,
    }

    impl Tree {
        /// As passes read it.
        pub fn view(&self) -> LightTree<'_> {
            LightTree {
                nodes: &self.nodes,
                lights: &self.lights,
                leaves: &self.leaves,
                count: self.lights.len() as u32,
            }
        }
    }

    impl Bound {
        /// A place that shines everywhere.
        pub fn point(position: Vec3) -> Self {
            Bound { min: position, max: position, axis: Vec3::Y, angle: PI }
        }

        /// Around both.
        fn union(self, other: Bound) -> Bound {
            let (min, max) = (self.min.min(other.min), self.max.max(other.max));
            let (wide, narrow) = if self.angle >= other.angle { (self, other) } else { (other, self) };
            let between = wide.axis.dot(narrow.axis).clamp(-1.0, 1.0).acos();
            if between + narrow.angle <= wide.angle {
                return Bound { min, max, ..wide };
            }
            let angle = 0.5 * (wide.angle + between + narrow.angle);
            // In the plane of both axes, so far from the wider one that its cone is just inside.
            let side = narrow.axis - wide.axis * wide.axis.dot(narrow.axis);
            if angle >= PI || side.length() < 1e-6 {
                return Bound { min, max, axis: wide.axis, angle: PI };
            }
            let turn = angle - wide.angle;
            let axis = (wide.axis * turn.cos() + side.normalize() * turn.sin()).normalize();
            Bound { min, max, axis, angle }
        }

        fn node(self, intensity: f64) -> TreeNode {
            let p = pack_direction(self.axis);
            // Rounded to 8 bits each: 1/128 of the octahedron's side, within 0.02 rad.
            let round = |bits: u32| {
                let snorm = (bits << 16) as i32 >> 16;
                ((snorm + 128) >> 8).min(127) as u32 & 0xff
            };
            let angle = ((self.angle + 0.03) / PI * 65535.0).ceil().min(65535.0) as u32;
            let cone = round(p) | round(p >> 16) << 8 | angle << 16;
            let intensity = intensity.min(f64::from(f32::MAX)) as f32;
            TreeNode { min: self.min, max: self.max, intensity, cone }
        }
    }

    /// The tree over those of `lights` that are somewhere.
    pub fn build(lights: &[Light]) -> Tree {
        let bounds: Vec<(u32, Bound)> =
            lights.iter().enumerate().filter_map(|(i, light)| Some((i as u32, light.bound()?))).collect();
        let middle = |b: &Bound| 0.5 * (b.min.as_dvec3() + b.max.as_dvec3());
        let infinite = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) =
            bounds.iter().fold(infinite, |(low, high), (_, b)| (low.min(middle(b)), high.max(middle(b))));
        let scale = 1_048_575.0 / (high - low).max_element().max(1e-30);
        let mut sorted: Vec<(u64, u32)> =
            (0u32..).zip(&bounds).map(|(i, (_, b))| (morton((middle(b) - low) * scale), i)).collect();
        sorted.sort_unstable();
        let mut tree = Tree {
            nodes: vec![TreeNode::default(); (2 * bounds.len()).saturating_sub(1)],
            lights: sorted.iter().map(|&(_, i)| bounds[i as usize].0).collect(),
            leaves: vec![NO_LIGHT; lights.len()],
        };
        for (leaf, &light) in (0u32..).zip(&tree.lights) {
            tree.leaves[light as usize] = leaf;
        }
        let leaf = |i: usize| {
            let (light, bound) = bounds[sorted[i].1 as usize];
            (bound, lights[light as usize].intensity())
        };
        if !bounds.is_empty() {
            fill(&mut tree.nodes, 0, bounds.len(), &leaf);
        }
        tree
    }

    /// Writes the nodes of `count` leaves from `first` on.
    fn fill(
        nodes: &mut [TreeNode],
        first: usize,
        count: usize,
        leaf: &impl Fn(usize) -> (Bound, f64),
    ) -> (Bound, f64) {
        let (bound, intensity) = if count == 1 {
            leaf(first)
        } else {
            let half = count / 2;
            let (left, right) = nodes[1..].split_at_mut(2 * half - 1);
            let (a, of_a) = fill(left, first, half, leaf);
            let (b, of_b) = fill(right, first + half, count - half, leaf);
            (a.union(b), of_a + of_b)
        };
        nodes[0] = bound.node(intensity);
        (bound, intensity)
    }

    /// 20 bits of each coordinate, interleaved.
    fn morton(p: DVec3) -> u64 {
        let spread = |x: f64| {
            let mut x = (x as u64) & 0xfffff;
            x = (x | x << 32) & 0x001f_0000_0000_ffff;
            x = (x | x << 16) & 0x001f_0000_ff00_00ff;
            x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
            x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
            (x | x << 2) & 0x1249_2492_4924_9249
        };
        spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
    }
}

#[cfg(test)]
mod tests;
