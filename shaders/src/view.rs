//! One of the viewer's views in place of the tone-mapped picture.

use shared::frame::FrameConstants;
use shared::geometry::InstanceGeometry;
use shared::glam::{UVec3, Vec3};
use shared::interface::PassConstants;
use shared::light::{Light, Lights};
use shared::material::Material;
use shared::reservoir::StoredReservoir;
use shared::surface::GBufferTexel;
use shared::target::unshadowed;
use shared::{tonemap, view};
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "view"))]
pub fn view(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(push_constant)] constants: &PassConstants,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] instances: &[InstanceGeometry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 3)] reservoirs: &[StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 6)] radiance: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 7)] display: &mut [u32],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 10)] mean: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 11)] reference: &[Vec3],
) {
    let pixel = id.truncate();
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let index = frame.pixel_index(pixel) as usize;
    let texel = gbuffer[index];
    let mut shown = view::Pixel::new(texel, radiance[index]);
    // Reference frames have no reservoirs.
    if frame.settings.reservoirs > 0 {
        shown.reservoir = reservoirs[index];
    }
    if constants.count > 0 {
        shown.mean = mean[index];
    }
    if constants.view == view::kind::DIFFERENCE {
        shown.reference = reference[index];
    }
    if constants.view == view::kind::VISIBILITY && !texel.is_empty() {
        let surface = texel.unpack(&frame.camera, pixel, frame.size);
        let incident = Lights { lights, features }.incident(shown.reservoir.sample, surface.position);
        shown.unshadowed = unshadowed(&surface, &incident) * shown.reservoir.contribution_weight;
    }
    let color = if constants.view == view::kind::FEATURES && !texel.is_empty() {
        view::features_color(&materials[instances[texel.instance as usize].material as usize])
    } else {
        view::color(constants.view, constants.scale, frame, &shown)
    };
    display[index] = tonemap::pack_rgba8(color);
}
