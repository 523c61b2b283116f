//! The compiled shaders, inside the program: it runs from anywhere.

/// SPIR-V of the entry point `stem`, or none.
pub fn spirv(stem: &str) -> Option<&'static [u8]> {
    MODULES.iter().find(|(name, _)| *name == stem).map(|(_, code)| *code)
}

macro_rules! modules {
    ($($stem:literal)*) => {
        /// (entry point, SPIR-V) of every shader.
        pub const MODULES: &[(&str, &[u8])] =
            &[$(($stem, include_bytes!(concat!("../../assets/shaders/", $stem, ".spv")))),*];
    };
}

modules! {
    "gbuffer" "visibility_vertex" "visibility" "visibility_alpha_vertex" "visibility_alpha" "gbuffer_raster"
    "initial" "temporal" "spatial" "shade" "shade_known" "tonemap" "reference"
    "accumulate" "view" "statistics" "floor_primary" "floor_shadow" "floor_copy"
    "presample" "initial_tiled" "temporal_unbiased" "spatial_unbiased"
    "temporal_known" "temporal_moving" "temporal_unbiased_moving" "pair_targets" "pair_merge"
    "closest_hit" "primary_any_hit" "shadow_any_hit" "primary_miss" "shadow_miss"
}
