//! Who answers a ray.

use crate::interface::HitPayload;
use crate::shadow::ShadowRay;
use glam::Vec3;

/// Why a ray is traced.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// Does this pixel see the sample that its reservoir ends the pass with?
    Survivor,
    /// Does the history's pixel see the current sample?
    History,
    /// Does a neighbor see the canonical sample?
    Neighbor,
    /// Does this pixel see its partner's sample?
    Partner,
    /// Does this pixel see the sample that it shades?
    Shade,
    /// Does this pixel see this point of a light? Of the reference.
    Light,
}

/// Answers rays: the hardware, every triangle in f64, a recorder, or one that lies.
pub trait Visibility {
    /// False: no ray is traced, and what can't be known without one is left as it is.
    const TRACES: bool;

    /// Is nothing between the ends of `ray`? `key`: of [`crate::alpha`].
    fn sees(&mut self, question: Question, ray: ShadowRay, key: u32) -> bool;

    /// The same, among the things of the previous frame.
    fn saw(&mut self, question: Question, ray: ShadowRay, key: u32) -> bool {
        self.sees(question, ray, key)
    }

    /// The nearest surface from `origin` along `direction` (unit), both sides of everything. `key`: of [`crate::alpha`].
    fn nearest(&mut self, _origin: Vec3, _direction: Vec3, _key: u32) -> HitPayload {
        HitPayload::default()
    }
}

#[cfg(not(target_arch = "spirv"))]
impl<V: Visibility> Visibility for &mut V {
    const TRACES: bool = V::TRACES;

    fn sees(&mut self, question: Question, ray: ShadowRay, key: u32) -> bool {
        (**self).sees(question, ray, key)
    }

    fn saw(&mut self, question: Question, ray: ShadowRay, key: u32) -> bool {
        (**self).saw(question, ray, key)
    }

    fn nearest(&mut self, origin: Vec3, direction: Vec3, key: u32) -> HitPayload {
        (**self).nearest(origin, direction, key)
    }
}

/// No ray: what is asked for is seen, as an earlier ray has shown.
#[derive(Clone, Copy, Debug, Default)]
pub struct Assumed;

impl Visibility for Assumed {
    const TRACES: bool = false;

    fn sees(&mut self, _: Question, _: ShadowRay, _: u32) -> bool {
        true
    }
}
