//! Lights of all kinds: memory, and what rays find.

use super::*;
use glam::UVec2;

/// The page shows the file.
#[test]
fn the_recipe_is_the_code_of_the_example() {
    let page = include_str!("../../../docs/adding-a-light.md");
    let file = include_str!("segment.rs");
    let code = file.split("/// A segment").nth(1).and_then(|rest| rest.split("mod tests").next()).unwrap();
    assert!(page.contains(code.trim_end()), "docs/adding-a-light.md shows another segment.rs");
    assert!(!page.contains(&code.trim_end().replace("edge1", "edge2")), "whatever it shows");
}

#[test]
fn memory_is_as_documented() {
    assert_eq!(size_of::<Light>(), 64);
    assert_eq!(core::mem::offset_of!(Light, edge1), 16);
    assert_eq!(core::mem::offset_of!(Light, edge2), 32);
    assert_eq!(core::mem::offset_of!(Light, emission), 48);
    assert_eq!(size_of::<LightSample>(), 8);
}

/// Where a sample lies, there the direction to it leads back.
#[test]
fn directions_lead_back_to_their_samples() {
    let corners = [Vec3::new(0.3, 2.0, -0.4), Vec3::new(1.5, 2.5, 0.1), Vec3::new(0.1, 1.6, 1.2)];
    let texel = |x, y| Light::environment(UVec2::new(x, y), UVec2::new(32, 16), Vec3::ONE, 5.0);
    let lights = [
        Light::triangle(corners, Vec3::ONE, true),
        Light::triangle([corners[0], corners[2], corners[1]], Vec3::ONE, true),
        texel(0, 0),
        texel(31, 7),
        texel(13, 15),
    ];
    for light in lights {
        for receiver in [Vec3::ZERO, Vec3::new(0.5, 4.0, 0.2), Vec3::new(-3.0, 1.0, 2.0)] {
            for i in 0..400 {
                let square = Vec2::new((i % 20) as f32 + 0.5, (i / 20) as f32 + 0.5) / 20.0;
                let incident = light.sample_li(square, receiver);
                let back = light.invert_li(incident.direction, receiver);
                assert!((back - square).abs().max_element() < 1e-4, "{square} came back as {back}");
                let stored = LightSample::at(7, back).square();
                assert!((stored - back).abs().max_element() <= 0.5 / 65536.0 + 1e-7);
            }
        }
    }
    // Rounding may lead past an edge; the grid ends there.
    assert_eq!(LightSample::at(1, Vec2::new(-0.1, 1.1)), LightSample { light: 1, uv: 0xffff_0000 });
    assert_eq!(LightSample::at(1, Vec2::NAN.min(Vec2::ZERO)).light, 1);
}

/// dω = cosθ'/d² dA, by differences of the solid angle of ever smaller parts; and none for what no ray finds.
#[test]
fn solid_angles_are_those_of_the_light() {
    let corners = [Vec3::new(0.3, 2.0, -0.4), Vec3::new(0.301, 2.0, -0.4), Vec3::new(0.3, 2.0005, -0.399)];
    let light = Light::triangle(corners, Vec3::ONE, true);
    // Van Oosterom & Strackee 1983, for a triangle seen from 0.
    let [a, b, c] = corners.map(|v| v.as_dvec3().normalize());
    let solid_angle = 2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
    let incident = light.sample_li(Vec2::splat(0.5), Vec3::ZERO);
    let ours = f64::from(incident.solid_angle * light.area);
    assert!((ours / solid_angle - 1.0).abs() < 1e-3, "{ours} instead of {solid_angle} sr");
    let of = |light: Light| light.sample_li(Vec2::splat(0.5), Vec3::ZERO).solid_angle;
    assert_eq!(of(Light { flags: UNTRACEABLE, ..light }), 0.0);
    assert_eq!(of(Light::point(Vec3::Y, Vec3::ONE)), 0.0);
    assert_eq!(of(Light::directional(Vec3::Y, Vec3::ONE, 1.0)), 0.0);
    assert_eq!(of(Light::environment(UVec2::ZERO, UVec2::new(8, 4), Vec3::ONE, 1.0)), 1.0);
}
