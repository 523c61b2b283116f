//! A texture read on the CPU, at its finest level, as Vulkan's samplers do.

use candela::scene::{Texture, Wrap};
use glam::Vec2;

/// Alpha of `texture` at `uv`.
pub fn alpha(texture: &Texture, uv: Vec2) -> f32 {
    let image = &texture.image;
    let size = [image.width as i32, image.height as i32];
    let texel = |x: i32, y: i32| {
        let [x, y] = [wrapped(x, size[0], texture.wrap[0]), wrapped(y, size[1], texture.wrap[1])];
        f32::from(image.texels[(y * image.width as usize + x) * 4 + 3]) / 255.0
    };
    let place = uv * Vec2::new(size[0] as f32, size[1] as f32);
    if !texture.filter.magnify_linear {
        let corner = place.floor().as_ivec2();
        return texel(corner.x, corner.y);
    }
    let corner = (place - 0.5).floor();
    let (f, c) = (place - 0.5 - corner, corner.as_ivec2());
    let row = |y: i32| texel(c.x, y) * (1.0 - f.x) + texel(c.x.saturating_add(1), y) * f.x;
    row(c.y) * (1.0 - f.y) + row(c.y.saturating_add(1)) * f.y
}

/// The texel that stands for place `i` of `n` (Vulkan 1.3, 16.8.4, "Wrapping Operation").
fn wrapped(i: i32, n: i32, wrap: Wrap) -> usize {
    let texel = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::ClampToEdge => i.clamp(0, n - 1),
        Wrap::MirroredRepeat => {
            let place = i64::from(i).rem_euclid(2 * i64::from(n)) as i32;
            if place < n { place } else { 2 * n - 1 - place }
        }
    };
    texel as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use candela::scene::{Filter, Image};
    use std::sync::Arc;

    fn texture(wrap: Wrap, linear: bool) -> Texture {
        let filter = if linear { Filter::LINEAR } else { Filter::NEAREST };
        let texels = [0u8, 255, 51, 102].iter().flat_map(|&a| [0, 0, 0, a]).collect();
        let image = Arc::new(Image { name: "test".into(), width: 4, height: 1, texels });
        Texture { image, srgb: true, wrap: [wrap; 2], filter }
    }

    #[test]
    fn texels_are_where_their_centers_are() {
        let read = |wrap, linear, u: f32| alpha(&texture(wrap, linear), Vec2::new(u, 0.5));
        for linear in [false, true] {
            assert_eq!(read(Wrap::Repeat, linear, 0.375), 1.0);
            assert_eq!(read(Wrap::Repeat, linear, 1.375), 1.0);
            assert_eq!(read(Wrap::ClampToEdge, linear, 7.0), 0.4);
            assert_eq!(read(Wrap::MirroredRepeat, linear, 1.125), 0.4);
            assert_eq!(read(Wrap::MirroredRepeat, linear, -0.375), 1.0);
        }
        assert!((read(Wrap::Repeat, true, 0.5) - 0.6).abs() < 1e-6, "half way between 1 and 0.2");
        assert!(
            (read(Wrap::Repeat, true, 0.0) - 0.2).abs() < 1e-6,
            "half way between 0.4 and 0, around the edge"
        );
    }
}
