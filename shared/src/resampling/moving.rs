//! [`super::temporal`] where instances or lights have changed since the previous frame.
#![allow(clippy::too_many_arguments)]

use super::pairwise::CrossTargets;
use super::temporal::{Place, capped_history, merge_biased, place_of, relative_to_previous, similar_at};
use super::{CrossProposal, Pixels, target_of};
use crate::frame::FrameConstants;
use crate::light::{LightSample, LightTable};
use crate::motion::{InstanceMotion, PastLights};
use crate::reservoir::StoredReservoir;
use crate::rng::Rng;
use crate::shadow::ShadowRay;
use crate::surface::Surface;
use crate::target::target_function;
use glam::UVec2;

/// Where `surface`, on an instance that moved by `motion`, was seen in the previous frame; see
/// [`super::temporal::previous_place`].
pub fn previous_place(frame: &FrameConstants, surface: &Surface, motion: &InstanceMotion) -> Option<Place> {
    place_of(frame, relative_to_previous(frame, surface) + motion.displacement(surface.position))
}

/// The pixel of the previous frame that saw `surface`, on an instance that moved by `motion`; or none.
pub fn reproject(
    frame: &FrameConstants,
    surface: &Surface,
    motion: &InstanceMotion,
    previous_gbuffer: Pixels<'_>,
) -> Option<UVec2> {
    let place = previous_place(frame, surface, motion)?;
    similar_at(frame, surface, motion.normal(surface.normal), place, previous_gbuffer)
}

/// Biased temporal reuse, see [`super::temporal::biased`].
pub fn biased(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    past: PastLights<'_>,
    surface: &Surface,
    motion: &InstanceMotion,
    current: StoredReservoir,
    previous: Pixels<'_>,
    lane: u32,
    rng: &mut Rng,
) -> StoredReservoir {
    let Some(pixel) = reproject(frame, surface, motion, previous) else {
        return current;
    };
    let history = capped_history(frame, current, previous, pixel, lane);
    merge_biased(lights, surface, current, past.carried(lights.lights, history), rng)
}

/// Unbiased temporal reuse begins, see [`super::temporal::propose`]; it ends with [`super::temporal::accept`].
///
/// The history's pixel, its surface and the lights it saw are the previous frame's, and so must be what the ray is traced
/// among. Its targets are densities over this frame's samples, hence the Jacobian (Lin et al. 2022, "Generalized Resampled
/// Importance Sampling", eq. 13: shift mappings).
pub fn propose(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    past: PastLights<'_>,
    surface: &Surface,
    motion: &InstanceMotion,
    current: StoredReservoir,
    previous: Pixels<'_>,
    lane: u32,
) -> Option<CrossProposal> {
    let pixel = reproject(frame, surface, motion, previous)?;
    let history = capped_history(frame, current, previous, pixel, lane);
    let texel = previous.gbuffer[frame.pixel_index(pixel) as usize];
    let there = texel.unpack(&frame.previous_camera, pixel, frame.size);
    let neighbor = past.carried(lights.lights, history);
    let target = |now: LightSample, before: LightSample, weight: f32| {
        let incident = past.lights.incident(before, there.position);
        let jacobian = past.jacobian(lights.lights, now.light, before.light);
        (if weight > 0.0 { target_function(&there, &incident) * jacobian } else { 0.0 }, incident)
    };
    let (neighbor_at_neighbor, _) = target(neighbor.sample, history.sample, neighbor.contribution_weight);
    let (canonical_at_neighbor, incident) =
        target(current.sample, past.before(current.sample), current.contribution_weight);
    let neighbor_at_canonical = target_of(surface, lights, neighbor);
    let targets = CrossTargets { neighbor_at_canonical, neighbor_at_neighbor, canonical_at_neighbor };
    Some(CrossProposal { neighbor, targets, ray: ShadowRay::new(&there, &incident), same_point: 0 })
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
            let surface = texel(world, normal, eye).unpack(&frame.camera, pixel, SIZE);
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
            let previous = Pixels { gbuffer: &gbuffer, reservoirs: &[] };
            if surface.normal.dot(normal) < 0.99 {
                // Bent toward this frame's camera: another normal than the object's.
                continue;
            }
            assert_eq!(reproject(&frame, &surface, &motion, previous), Some(expected), "point {i}");
            found += 1;
            lost += usize::from(super::super::temporal::reproject(&frame, &surface, previous).is_none());
        }
        assert!(found > 200, "{found}");
        // Negative control: without the motion (nearly) all miss.
        assert!(lost * 100 > found * 97, "{lost} of {found}");
    }
}
