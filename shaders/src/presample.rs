//! Before pass 2: the light tiles of the frame.

use shared::alias_table::AliasEntry;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::light::tile::{TILE_SIZE, TILES, TileEntry, presample as draw};
use shared::light::{Light, LightTable, Lights};
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "presample"))]
pub fn presample(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 8)] entries: &mut [TileEntry],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 9)] points: &mut [u32],
) {
    if id.x >= TILE_SIZE || id.y >= TILES {
        return;
    }
    let place = (id.y * TILE_SIZE + id.x) as usize;
    let table = LightTable { lights: Lights { lights, features }, alias };
    (entries[place], points[place]) = draw(table, id.y, id.x, frame);
}
