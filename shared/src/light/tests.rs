//! Each kind of light against its closed form.

use super::*;
use core::f32::consts::PI;

fn triangle(double_sided: bool) -> Light {
    let vertices = [Vec3::new(-0.5, 2.0, -0.5), Vec3::new(0.5, 2.0, -0.5), Vec3::new(-0.5, 2.0, 0.5)];
    Light::triangle(vertices, Vec3::splat(10.0), double_sided)
}

#[test]
fn memory_is_as_documented() {
    assert_eq!(size_of::<Light>(), 64);
    assert_eq!(core::mem::offset_of!(Light, edge1), 16);
    assert_eq!(core::mem::offset_of!(Light, edge2), 32);
    assert_eq!(core::mem::offset_of!(Light, emission), 48);
    assert_eq!(size_of::<LightSample>(), 8);
}

#[test]
fn power_is_flux() {
    assert!((Light::point(Vec3::ZERO, Vec3::ONE).power() - 4.0 * PI).abs() < 1e-5);
    assert!((triangle(false).power() - 10.0 * PI * 0.5).abs() < 1e-5);
    assert_eq!(triangle(true).power(), 2.0 * triangle(false).power());
}

#[test]
fn point_light_falls_off_with_the_square() {
    let light = Light::point(Vec3::new(0.0, 3.0, 0.0), Vec3::new(9.0, 18.0, 27.0));
    let incident = light.sample_li(Vec2::splat(0.5), Vec3::ZERO);
    assert_eq!((incident.direction, incident.distance), (Vec3::Y, 3.0));
    assert!((incident.irradiance - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-6);
    // At the light itself there is no direction to come from.
    assert_eq!(light.sample_li(Vec2::splat(0.5), light.position).irradiance, Vec3::ZERO);
}

#[test]
fn distances_from_a_tenth_of_a_millimetre_to_a_hundred_kilometres() {
    for distance in [1e-4f32, 1e-2, 1.0, 1e3, 1e5] {
        let light = Light::point(Vec3::new(distance, 0.0, 0.0), Vec3::ONE);
        let irradiance = light.sample_li(Vec2::ZERO, Vec3::ZERO).irradiance.x;
        let exact = 1.0 / (f64::from(distance) * f64::from(distance));
        assert!((f64::from(irradiance) / exact - 1.0).abs() < 1e-6, "at {distance} m: {irradiance}");
    }
}

#[test]
fn triangles_emit_where_they_face() {
    // Counter-clockwise seen from below: the normal is (0, -1, 0).
    let lit = Vec3::new(0.0, 0.0, 0.0);
    let behind = Vec3::new(0.0, 4.0, 0.0);
    let at = |light: Light, p| light.sample_li(Vec2::new(0.25, 0.5), p).irradiance.x;
    let front_emits = at(triangle(false), lit) > 0.0;
    assert_ne!(front_emits, at(triangle(false), behind) > 0.0);
    assert!(at(triangle(true), lit) > 0.0 && at(triangle(true), behind) > 0.0);
    let normal = triangle(true).sample_li(Vec2::splat(0.3), lit).normal;
    assert!(normal.y < -0.99, "the normal is on the receiver's side: {normal}");
}

/// Irradiance from a triangle in closed form (Lambert 1760): E = L/2 Σ θ_i Γ_i·n over its edges.
#[test]
fn sampled_triangle_gives_lamberts_irradiance() {
    let light = triangle(true);
    let corners =
        [light.position, light.position + light.edge1, light.position + light.edge2].map(|v| v.as_dvec3());
    let exact: f64 = (0..3)
        .map(|i| {
            let (a, b) = (corners[i].normalize(), corners[(i + 1) % 3].normalize());
            a.dot(b).acos() * a.cross(b).normalize().y
        })
        .sum::<f64>()
        .abs()
        * 10.0
        / 2.0;
    let n = 256;
    let mut sum = 0.0;
    for i in 0..n * n {
        let square = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
        let incident = light.sample_li(square, Vec3::ZERO);
        sum += f64::from(incident.irradiance.x * incident.direction.y / light.pdf_li().0) / f64::from(n * n);
    }
    assert!((sum / exact - 1.0).abs() < 1e-4, "quadrature {sum}, Lambert {exact}");
}

#[test]
fn degenerate_lights_are_dark_and_finite() {
    let sliver = Light::triangle([Vec3::ZERO, Vec3::X, Vec3::X * 2.0], Vec3::ONE, true);
    assert_eq!((sliver.power(), sliver.pdf_li().0), (0.0, 0.0));
    assert_eq!(sliver.sample_li(Vec2::splat(0.5), Vec3::Y).irradiance, Vec3::ZERO);
    let hot = Light::point(Vec3::ZERO, Vec3::splat(1e30));
    assert!(hot.sample_li(Vec2::ZERO, Vec3::new(1e-10, 0.0, 0.0)).irradiance.is_finite());
}

/// ∫ attenuation dω by quadrature, sr: independent of the closed form, from the extension's own formula in f64.
fn spot_quadrature(inner: f64, outer: f64) -> f64 {
    let scale = 1.0 / (inner.cos() - outer.cos()).max(0.001);
    let offset = -outer.cos() * scale;
    let n = 1_000_000;
    let step = (1.0 - outer.cos()) / f64::from(n);
    let ring = |i: i32| {
        let cos = outer.cos() + (f64::from(i) + 0.5) * step;
        (cos * scale + offset).clamp(0.0, 1.0).powi(2)
    };
    2.0 * std::f64::consts::PI * step * (0..n).map(ring).sum::<f64>()
}

#[test]
fn spot_power_is_the_integral_of_its_attenuation() {
    for (inner, outer) in
        [(0.0, 0.785), (0.3, 0.6), (0.5, 0.5), (0.0, 1.57), (1.5, 1.57), (0.0, 0.03), (0.2, 0.201)]
    {
        let light = Light::spot(Vec3::ZERO, Vec3::Z, Vec3::splat(5.0), inner, outer);
        let exact = 5.0 * spot_quadrature(inner.into(), outer.into());
        let error = f64::from(light.power) / exact - 1.0;
        // 1 - cos of 0.03 rad has lost three digits in f32.
        assert!(error.abs() < 1e-3, "{inner} to {outer} rad: {} instead of {exact} lm", light.power);
    }
}

#[test]
fn spots_fade_from_the_inner_to_the_outer_cone() {
    let (inner, outer) = (0.4f32, 0.7f32);
    let light = Light::spot(Vec3::new(1.0, 4.0, 1.0), -Vec3::Y, Vec3::new(16.0, 32.0, 8.0), inner, outer);
    assert_eq!(light.pdf_li().0, 1.0);
    // 4 m from the light at `angle` from its axis.
    let at = |angle: f32| {
        let place = light.position + 4.0 * Vec3::new(angle.sin(), -angle.cos(), 0.0);
        light.sample_li(Vec2::splat(0.5), place).irradiance
    };
    for angle in [0.0, 0.2, 0.399] {
        assert!((at(angle) - Vec3::new(1.0, 2.0, 0.5)).length() < 1e-5, "full inside: {}", at(angle));
    }
    let halfway = (0.5 * (inner.cos() + outer.cos())).acos();
    assert!((at(halfway).x - 0.25).abs() < 1e-4, "a quarter at the middle cosine: {}", at(halfway));
    for angle in [0.7001, 1.0, 2.0, PI] {
        assert_eq!(at(angle), Vec3::ZERO, "dark from the outer cone on");
    }
    assert_eq!(light.sample_li(Vec2::ZERO, light.position).irradiance, Vec3::ZERO);
}

#[test]
fn directional_light_is_the_same_everywhere() {
    let direction = Vec3::new(1.0, 2.0, -2.0) / 3.0;
    let illuminance = Vec3::new(3.0, 2.0, 1.0);
    let light = Light::directional(direction, illuminance, 10.0);
    assert!((light.power - PI * 100.0 * luminance(illuminance)).abs() < 1e-2);
    assert_eq!(light.pdf_li().0, 1.0);
    for receiver in [Vec3::ZERO, Vec3::new(0.0, -10.0, 0.0), direction * -10.0] {
        let incident = light.sample_li(Vec2::splat(0.1), receiver);
        assert_eq!((incident.direction, incident.irradiance), (direction, illuminance));
        assert!(incident.position.length() > 10.0, "the shadow ray leaves the bounding sphere");
        assert!((incident.position - receiver).normalize().dot(direction) > 0.999_999);
    }
}

#[test]
fn a_flux_beyond_all_numbers_is_still_drawn() {
    let light = Light::directional(Vec3::Y, Vec3::splat(1e12), 1e15);
    assert_eq!(light.power, f32::MAX);
    assert!(build_alias_table(&[light])[0].pmf == 1.0);
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
