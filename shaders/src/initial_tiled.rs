//! Pass 2, from light tiles: fresh candidates for every reservoir, and visibility reuse.

use crate::trace::trace_shadow;
use shared::alias_table::AliasEntry;
use shared::alpha::SURE_HITS_ONLY;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::ShadowPayload;
use shared::light::tile::{TileEntry, Tiles, tile_of};
use shared::light::{Light, LightTable, Lights};
use shared::resampling::{initial, reservoir_index};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "initial_tiled"))]
pub fn initial_tiled(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 4)] reservoirs: &mut [StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 8)] entries: &[TileEntry],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 9)] points: &[u32],
    #[spirv(ray_payload)] payload: &mut ShadowPayload,
) {
    let (pixel, lane) = (launch.truncate(), launch.z);
    let out = reservoir_index(frame, pixel, lane) as usize;
    let texel = gbuffer[frame.pixel_index(pixel) as usize];
    if texel.is_empty() {
        reservoirs[out] = StoredReservoir::default();
        return;
    }
    let surface = texel.unpack(&frame.camera, pixel, frame.size);
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Initial, lane);
    let proposal = initial::propose_from_tile(
        &surface,
        LightTable { lights: Lights { lights, features }, alias },
        Tiles { entries, points },
        tile_of(frame, pixel, lane),
        frame.settings.candidates,
        &mut rng,
    );
    let mut visible = true;
    if frame.settings.visibility_reuse != 0 && !proposal.is_certain() {
        visible = trace_shadow(tlas, features, proposal.ray, SURE_HITS_ONLY, payload);
    }
    reservoirs[out] = initial::accept(proposal, visible);
}
