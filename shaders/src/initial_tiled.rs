//! Pass 2, from light tiles: fresh candidates for every reservoir, from the lights and along the reflectance, and visibility reuse.

use crate::trace::{trace_glances, trace_shadow};
use shared::alias_table::AliasEntry;
use shared::alpha::SURE_HITS_ONLY;
use shared::environment::EnvironmentTexel;
use shared::frame::FrameConstants;
use shared::geometry::InstanceGeometry;
use shared::glam::UVec3;
use shared::interface::{HitPayload, ShadowPayload};
use shared::light::found::Emitters;
use shared::light::tile::{TileEntry, Tiles, tile_of};
use shared::light::{Light, LightTable, Lights};
use shared::resampling::initial::{self, Techniques};
use shared::resampling::reservoir_index;
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
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] instances: &[InstanceGeometry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 9)] environment: &[EnvironmentTexel],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 4)] reservoirs: &mut [StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 8)] entries: &[TileEntry],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 9)] points: &[u32],
    #[spirv(ray_payload)] payload: &mut ShadowPayload,
    #[spirv(ray_payload)] nearest: &mut HitPayload,
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
    let lights = LightTable { lights: Lights { lights, features }, alias };
    let emitters = Emitters::new(frame, features, instances, environment);
    let techniques = Techniques::new(&frame.settings, features);
    let tiles = Tiles { entries, points };
    let tile = tile_of(frame, pixel, lane);
    let mut fresh = initial::from_tile(&surface, lights, techniques, tiles, tile, &mut rng);
    trace_glances(tlas, &surface, lights, emitters, techniques, &mut fresh, &mut rng, nearest);
    let proposal = fresh.finish(&surface, lights);
    let mut visible = true;
    if frame.settings.visibility_reuse != 0 && !proposal.is_certain() {
        visible = trace_shadow(tlas, features, proposal.ray, SURE_HITS_ONLY, payload);
    }
    reservoirs[out] = initial::accept(proposal, visible);
}
