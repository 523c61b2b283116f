//! The scene's textures, as the hardware samples them.

use shared::glam::{UVec2, Vec2, Vec4};
use shared::textures::Texels;
use spirv_std::RuntimeArray;
use spirv_std::image::{Image2d, SampledImage};

pub type Textures = RuntimeArray<SampledImage<Image2d>>;

/// The array that is bound.
#[derive(Clone, Copy)]
pub struct Bound<'a>(pub &'a Textures);

impl Texels for Bound<'_> {
    fn size(self, texture: u32) -> UVec2 {
        // SAFETY: the host writes only indices of textures that exist.
        let texture = unsafe { self.0.index(texture as usize) };
        texture.query_size_lod(0)
    }

    fn sample(self, texture: u32, uv: Vec2, lod: f32) -> Vec4 {
        // SAFETY: the host writes only indices of textures that exist.
        let texture = unsafe { self.0.index(texture as usize) };
        texture.sample_by_lod(uv, lod)
    }
}
