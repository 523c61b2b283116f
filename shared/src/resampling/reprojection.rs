//! Where a surface was seen in the previous frame.

use super::is_similar;
use crate::frame::FrameConstants;
use crate::motion::InstanceMotion;
use crate::surface::{GBufferTexel, Surface};
use glam::{UVec2, Vec2, Vec3};

/// A surface as it was in the previous frame.
#[derive(Clone, Copy, Debug)]
pub struct Before {
    /// From the previous frame's camera, m.
    pub relative: Vec3,
    /// Unit.
    pub normal: Vec3,
}

/// Where the previous frame saw a point.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Of the previous frame.
    pub pixel: UVec2,
    /// To the previous camera, m.
    pub distance: f32,
}

impl Before {
    /// Of a surface that stands still. Positions are subtracted camera from camera first: near numbers, whatever the distance
    /// from the origin.
    pub fn still(frame: &FrameConstants, surface: &Surface) -> Self {
        let cameras = frame.camera.position - frame.previous_camera.position;
        Before { relative: cameras - surface.wo * surface.distance, normal: surface.normal }
    }

    /// If its instance moved by `motion` since.
    pub fn moved(self, surface: &Surface, motion: &InstanceMotion) -> Self {
        Before {
            relative: self.relative + motion.displacement(surface.position),
            normal: motion.normal(self.normal),
        }
    }

    /// The pixel of the previous frame that the surface fell into; none outside the image, and in the first frame.
    pub fn place(self, frame: &FrameConstants) -> Option<Place> {
        let place = frame.previous_camera.project(self.relative, frame.size);
        let inside = place.cmpge(Vec2::ZERO).all() && place.cmplt(frame.size.as_vec2()).all();
        if frame.index == 0 || !inside {
            return None;
        }
        Some(Place { pixel: place.as_uvec2().min(frame.size - 1), distance: self.relative.length() })
    }
}

/// Is what `texel` of the previous frame holds at `place` what `surface` was?
pub fn similar_at(
    frame: &FrameConstants,
    surface: &Surface,
    before: Before,
    place: Place,
    texel: &GBufferTexel,
) -> bool {
    is_similar(&frame.settings, place.distance, before.normal, texel) && is_similar_albedo(surface, texel)
}

/// Another material is another target function: its history is of little use. 0.25: a visibly different color.
pub fn is_similar_albedo(surface: &Surface, previous: &GBufferTexel) -> bool {
    (surface.reflectance.diffuse - previous.diffuse()).abs().max_element() <= 0.25
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::frame::Settings;
    use crate::geometry::SurfacePoint;
    use crate::material::Reflectance;
    use crate::surface::GBufferTexel;
    use bytemuck::Zeroable;
    use glam::{Affine3A, DVec3, Quat, Vec2, Vec3};

    const SIZE: UVec2 = UVec2::new(320, 180);

    fn texel(position: Vec3, normal: Vec3, eye: Vec3) -> GBufferTexel {
        let point = SurfacePoint {
            position,
            geometric_normal: normal,
            normal,
            tangent: Vec3::X,
            tangent_sign: 1.0,
            uv: Vec2::ZERO,
            color: Vec3::ONE,
        };
        GBufferTexel::new(&point, normal, Reflectance::from_metallic_roughness(Vec3::ONE, 0.0, 1.0), 0, eye)
    }

    fn place(angle: f32, at: Vec3) -> Affine3A {
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), angle);
        Affine3A::from_rotation_translation(turn, at)
    }

    /// Points of a thing that moves under a camera that moves: the pixel is that of the thing's point in the previous frame,
    /// composed and projected in f64. All other pixels are empty, so any other pixel gives none.
    #[test]
    fn the_pixel_is_where_the_point_was() {
        let camera = |at: Vec3| Camera::new(at, Vec3::new(0.1, -0.2, -1.0), Vec3::Y, 0.8, SIZE);
        let (eye, previous_eye) = (Vec3::new(0.2, 1.0, 4.0), Vec3::new(0.0, 0.9, 4.2));
        let (now, before) = (place(0.9, Vec3::new(0.4, 0.3, -0.5)), place(0.2, Vec3::new(-0.3, 0.1, -0.2)));
        let motion = InstanceMotion::between(before, now);
        let frame = FrameConstants {
            camera: camera(eye),
            previous_camera: camera(previous_eye),
            size: SIZE,
            index: 1,
            settings: Settings::default(),
            ..FrameConstants::zeroed()
        };
        let (mut found, mut lost) = (0, 0);
        for i in 0..400 {
            let t = i as f32 / 400.0;
            let object = Vec3::new(t - 0.5, (9.0 * t).sin() * 0.5, (5.0 * t).cos() * 0.5);
            let world = now.transform_point3(object);
            let facing = (previous_eye - before.transform_point3(object)).normalize();
            let normal = (now * before.inverse()).transform_vector3(facing);
            let pixel = frame.camera.project(world - eye, SIZE).as_uvec2().min(SIZE - 1);
            // The surface is where its pixel's ray says.
            let surface = texel(world, normal, eye).unpack(u32::MAX, &frame.camera, pixel, SIZE);
            let exact = |p: Vec3| -> DVec3 {
                let object = now.inverse().matrix3.as_dmat3() * (p - Vec3::from(now.translation)).as_dvec3();
                before.matrix3.as_dmat3() * object + before.translation.as_dvec3()
            };
            let relative = exact(surface.position) - previous_eye.as_dvec3();
            let c = &frame.previous_camera;
            let depth = relative.dot(c.forward.as_dvec3());
            let along = |axis: Vec3| relative.dot(axis.as_dvec3()) / axis.as_dvec3().length_squared() / depth;
            let x = (along(c.right) + 1.0) * 0.5 * f64::from(SIZE.x);
            let y = (1.0 - along(c.up)) * 0.5 * f64::from(SIZE.y);
            // At the border of a pixel rounding decides.
            let near_border = |x: f64| (x - x.round()).abs() < 1e-3;
            if near_border(x) || near_border(y) || x < 0.0 || y < 0.0 {
                continue;
            }
            let expected = UVec2::new(x as u32, y as u32);
            let mut gbuffer = vec![GBufferTexel::default(); (SIZE.x * SIZE.y) as usize];
            gbuffer[frame.pixel_index(expected) as usize] =
                texel(before.transform_point3(object), facing, previous_eye);
            let found_at = |before: Before| {
                let place = before.place(&frame)?;
                let texel = gbuffer[frame.pixel_index(place.pixel) as usize];
                similar_at(&frame, &surface, before, place, &texel).then_some(place.pixel)
            };
            let still = Before::still(&frame, &surface);
            if surface.normal.dot(normal) < 0.99 {
                // Bent toward this frame's camera: another normal than the object's.
                continue;
            }
            assert_eq!(found_at(still.moved(&surface, &motion)), Some(expected), "point {i}");
            found += 1;
            lost += usize::from(found_at(still).is_none());
        }
        assert!(found > 200, "{found}");
        // Negative control: without the motion (nearly) all miss.
        assert!(lost * 100 > found * 97, "{lost} of {found}");
    }
}
