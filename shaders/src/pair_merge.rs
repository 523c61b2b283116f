//! Pass 4 in unbiased mode, in pairs, repeated: merges the reservoirs of partners, each of which knows how it sees the other's sample.

use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::PassConstants;
use shared::resampling::pairs::{self, PairTargets};
use shared::resampling::reservoir_index;
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "pair_merge"))]
pub fn pair_merge(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(push_constant)] constants: &PassConstants,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 3)] reservoirs: &[StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 4)] merged: &mut [StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 16)] targets: &[PairTargets],
) {
    let (pixel, lane) = (id.truncate(), id.z);
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let index = reservoir_index(frame, pixel, lane) as usize;
    let (own, here) = (reservoirs[index], targets[index]);
    let partner = here.index as usize;
    if partner == index {
        merged[index] = own;
        return;
    }
    let repetition = lane + frame.settings.reservoirs * constants.iteration;
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Spatial, repetition);
    let (both, seen) = ([own, reservoirs[partner]], [here, targets[partner]]);
    merged[index] = pairs::merge(&frame.settings, both, seen, &mut rng);
}
