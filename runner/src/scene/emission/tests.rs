//! Division of textured emitters, against sums over the texture.

use super::*;
use crate::scene::{Filter, Image, Instance, Texture, Wrap};
use glam::{Affine3A, DVec3};
use std::sync::Arc;

const SIDE: u32 = 64;

/// Dark but for a disk of gradients, a single bright texel and a gray line.
fn pattern(x: u32, y: u32) -> [u8; 3] {
    let d2 = (x as i32 - 20).pow(2) + (y as i32 - 24).pow(2);
    match (x, y) {
        (50, 50) => [255, 255, 255],
        (_, 8) => [30, 30, 30],
        _ if d2 < 144 => [200, (4 * x) as u8, (4 * y) as u8],
        _ => [0, 0, 0],
    }
}

/// A quad of 2 m x 1 m that shows the whole texture once, in two triangles.
fn scene(pattern: impl Fn(u32, u32) -> [u8; 3], linear: bool) -> SceneDescription {
    let texels = (0..SIDE * SIDE).flat_map(|i| {
        let [r, g, b] = pattern(i % SIDE, i / SIDE);
        [r, g, b, 255]
    });
    let image = Image { name: "glow".into(), width: SIDE, height: SIDE, texels: texels.collect() };
    let texture = Texture {
        image: Arc::new(image),
        srgb: false,
        wrap: [Wrap::Repeat; 2],
        filter: if linear { Filter::LINEAR } else { Filter::NEAREST },
    };
    let quad = Primitive {
        positions: [(0., 0.), (2., 0.), (2., 1.), (0., 1.)].map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        uvs: vec![Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Primitive::default()
    };
    let material =
        Material { emission: Vec3::new(1.0, 2.0, 3.0), emissive_texture: Some(0), ..Material::default() };
    SceneDescription {
        meshes: vec![Mesh { name: "screen".into(), primitives: vec![quad] }],
        instances: vec![Instance { name: "screen".into(), mesh: 0, transform: Affine3A::IDENTITY }],
        materials: vec![material],
        textures: vec![texture],
        ..SceneDescription::default()
    }
}

fn parts(scene: &SceneDescription) -> Vec<Part> {
    match Emitters::new(scene).0[0][0].clone() {
        Some(Emission::Textured(parts)) => parts,
        other => panic!("{other:?}"),
    }
}

/// Of the quad's triangles of 1 m².
fn area(part: &Part) -> f64 {
    let [a, b, c] = part.corners.map(|c| c.as_dvec2());
    (b - a).perp_dot(c - a).abs()
}

/// ∫ radiance over the quad, from its parts.
fn flux(parts: &[Part]) -> DVec3 {
    parts.iter().map(|part| part.radiance.as_dvec3() * area(part)).sum()
}

/// The same from the texels: the quad of 2 m² shows each of them on its share.
fn texture_flux(pattern: impl Fn(u32, u32) -> [u8; 3]) -> DVec3 {
    let texel = |i: u32| Vec3::from(pattern(i % SIDE, i / SIDE).map(f32::from)).as_dvec3() / 255.0;
    let mean = (0..SIDE * SIDE).map(texel).sum::<DVec3>() / f64::from(SIDE * SIDE);
    2.0 * mean * DVec3::new(1.0, 2.0, 3.0)
}

#[test]
fn no_energy_is_lost_or_gained() {
    for linear in [false, true] {
        let parts = parts(&scene(pattern, linear));
        let (sum, exact) = (flux(&parts), texture_flux(pattern));
        assert!((sum / exact - 1.0).abs().max_element() < 1e-6, "linear {linear}: {sum} instead of {exact}");
        // A planted error of one texel in 4096 is seen.
        let planted = |x, y| if (x, y) == (20, 20) { [0; 3] } else { pattern(x, y) };
        assert!((sum / texture_flux(planted) - 1.0).abs().max_element() > 1e-5);
    }
}

/// Dark texels give no light: with nearest texels, lights cover the lit texels and what shares a part with their edge.
#[test]
fn dark_parts_are_no_lights() {
    let half = |x: u32, _| if x < SIDE / 2 { [255; 3] } else { [0; 3] };
    let parts = parts(&scene(half, false));
    // The edge lies on middles of edges from the first division on.
    assert!((parts.iter().map(area).sum::<f64>() - 1.0).abs() < 1e-6);
    assert!(parts.iter().all(|part| part.radiance == Vec3::new(1.0, 2.0, 3.0)), "{parts:?}");
    assert!(parts.len() <= 8, "{} lights", parts.len());
    assert!(super::tests::parts(&scene(|_, _| [0; 3], true)).is_empty());
}

/// Every part left is within its bound: sampled texels differ from its mean by less than the tolerance allows.
#[test]
fn parts_keep_their_bound() {
    let scene = scene(pattern, false);
    let parts = parts(&scene);
    assert!(parts.len() < 2 + MAX_ADDED, "the budget is not what ended it");
    let tolerance = TOLERANCE * f64::from(luminance(flux(&parts).as_vec3()));
    let uv = |triangle: u32, b: DVec2| {
        let [a, p, q] =
            if triangle == 0 { [DVec2::Y, DVec2::ONE, DVec2::X] } else { [DVec2::Y, DVec2::X, DVec2::ZERO] };
        a + b.x * (p - a) + b.y * (q - a)
    };
    for part in &parts {
        let corners = part.corners.map(|c| c.as_dvec2());
        let size = corners.map(|c| uv(part.triangle, c) * f64::from(SIDE));
        let low = size[0].min(size[1]).min(size[2]);
        if (size[0].max(size[1]).max(size[2]) - low).max_element() <= 1.0 {
            continue;
        }
        for (s, t) in [(0.2, 0.2), (0.6, 0.2), (0.2, 0.6), (0.33, 0.33)] {
            let b = corners[0] + s * (corners[1] - corners[0]) + t * (corners[2] - corners[0]);
            let place = (uv(part.triangle, b) * f64::from(SIDE)).as_uvec2();
            let texel = Vec3::from(pattern(place.x, place.y).map(f32::from)) / 255.0;
            let seen = luminance(texel * Vec3::new(1.0, 2.0, 3.0));
            let error = f64::from((seen - luminance(part.radiance)).abs()) * area(part);
            assert!(error <= tolerance * 1.001, "{error} above {tolerance} at {place}: {part:?}");
        }
    }
    // The whole triangles break it: there is something to divide.
    assert!(parts.len() > 100, "{} parts", parts.len());
}

/// Noise everywhere ends at the budget where instances share it.
#[test]
fn the_budget_holds() {
    let noise = |x: u32, y: u32| [(x * 7919 + y * 104_729 + x * y * 31) as u8; 3];
    let mut scene = scene(noise, true);
    let once = parts(&scene).len();
    scene.instances = vec![scene.instances[0].clone(); 1024];
    let shared = parts(&scene);
    // One screen ends by its bound: each of about 1024 parts has a 1024th of what varies.
    assert!((1024..8 * 1024).contains(&once), "{once}");
    assert!(shared.len() > 50 && shared.len() <= 2 + MAX_ADDED / 1024, "{}", shared.len());
    assert!((flux(&shared) / texture_flux(noise) - 1.0).abs().max_element() < 1e-6);
}

/// Where an object stands must not matter: its lights keep their places when it moves.
#[test]
fn division_does_not_look_at_transforms() {
    let mut scene = scene(pattern, true);
    let before = parts(&scene);
    scene.instances[0].transform = Affine3A::from_scale(Vec3::new(0.1, 300.0, -1.0));
    assert_eq!(parts(&scene), before);
}
