//! Passes, a line each: what its body is called, what it covers, its entry points, and the buffers that it reads and writes. All else
//! follows: entry points, declarations on the host, barriers, labels, timestamps, columns of reports.

/// The table, handed to the macro `$use`. A line: the body, a function of that name in [`crate::passes`] (or in the `shaders`
/// crate where it needs images); its extent; its entry points; and bindings of [`crate::resources!`], in the order of the body's
/// arguments: those that it reads anywhere, those whose own element it gets and gives back, those whose own element it gives, and
/// [`crate::counters::Counters`] that all threads count in.
///
/// | entry point | arguments of the body before the buffers |
/// |---|---|
/// | `compute` | its [`crate::passes::At`] |
/// | `known` | that, and no ray: [`crate::passes::Assumed`] answers |
/// | `traced(..)` | that, and the hardware, by shadow rays; `nearest`: also by BSDF rays, `previous`: also in the previous frame |
/// | `known(scene)`, `traced(scene shadow)` | the same; the body reads textures, so only the device runs it |
/// | `listed(..)` | as `traced(..)`, for the pixels that its first buffer lists; the body does not get that |
/// | `bounced` | that, and the hardware, by shadow rays and rays that ask what they meet, whatever it is |
/// | `sparse` | the same, for the pixel that is picked of each block ([`crate::passes::At::picked`]); the launch covers more |
/// | `primary` | that, and the hardware, by rays from the eye |
/// | `drawn` | none: vertex and fragment shaders of their own |
#[macro_export]
macro_rules! passes {
    ($use:ident) => {
        $use! {
            (gbuffer Pixels { primary() gbuffer }
                [instances positions attributes indices materials second_uvs environment textures] [] [gbuffer radiance points])
            (visibility Pixels { drawn() visibility }
                [] [] [visibility])
            (gbuffer_raster Pixels { compute() gbuffer_raster }
                [instances positions attributes indices materials second_uvs environment textures visibility] [] [gbuffer radiance points])
            (scatter Pixels { compute() scatter }
                [instances positions indices previous_points] [] [] [caught])
            (land Pixels { compute() land }
                [instances positions indices previous_points caught] [] [landings] [hops])
            (aim Pixels { compute() aim }
                [previous_points caught landings] [] [aims])
            (gbuffer_aimed Pixels { primary() gbuffer_aimed }
                [instances positions attributes indices materials second_uvs environment textures previous_points]
                [aims caught] [gbuffer radiance points] [hops])
            (gbuffer_kept Pixels { compute() gbuffer_kept }
                [instances positions attributes indices materials second_uvs environment textures previous_gbuffer previous_points]
                [] [gbuffer radiance points])
            (presample Tiles { compute() presample }
                [lights alias] [] [tile_entries tile_points])
            (learn_beliefs Beliefs { compute() learn_beliefs }
                [] [beliefs observations] [])
            (learn_lists Lists { compute() learn_lists }
                [] [lists findings] [])
            (mark_cells Pixels { compute() mark_cells }
                [gbuffer] [] [] [marks])
            (cells Cells { compute() cells }
                [gbuffer lists beliefs] [marks] [cells])
            (pools Pools { compute() pools }
                [lights alias tree_nodes tree_lights tree_leaves cells lists beliefs] [] [pool_entries pool_points])
            (initial Reservoirs { traced(shadow nearest) initial }
                [lights alias tree_nodes tree_lights tree_leaves instances environment gbuffer tile_entries tile_points
                cells lists beliefs pool_entries pool_points] [] [merged])
            (initial_met Reservoirs { traced(shadow nearest) initial_met }
                [lights alias tree_nodes tree_lights tree_leaves instances environment gbuffer tile_entries tile_points
                cells lists beliefs pool_entries pool_points] [] [merged met])
            (observe Pixels { compute() observe }
                [lights tree_leaves gbuffer merged] [] [] [observations findings])
            (temporal Reservoirs { known() temporal, traced(shadow previous) temporal_traced }
                [lights alias gbuffer previous_gbuffer history aims previous_lights motions previous_to_current current_to_previous] [merged] [])
            (temporal_hops Reservoirs { listed(shadow) temporal_hops }
                [hops lights alias gbuffer previous_gbuffer history aims previous_lights motions previous_to_current current_to_previous] [merged] [])
            (spatial Reservoirs { known() spatial, traced(shadow) spatial_traced }
                [lights alias gbuffer reservoirs] [] [merged])
            (pair_targets Reservoirs { traced(shadow) pair_targets }
                [lights alias gbuffer reservoirs] [] [pair_targets])
            (pair_merge Reservoirs { known() pair_merge }
                [reservoirs pair_targets] [] [merged])
            (shade Pixels { known() shade, traced(shadow) shade_traced }
                [lights alias gbuffer reservoirs] [radiance] [])
            (shade_parts Pixels { known() shade_parts, traced(shadow) shade_parts_traced }
                [lights alias gbuffer reservoirs] [] [direct_diffuse direct_specular])
            (indirect_initial Pixels { bounced() indirect_initial }
                [lights alias instances positions attributes indices materials second_uvs environment textures gbuffer met] []
                [merged_paths])
            (indirect_further Pixels { sparse() indirect_further }
                [lights alias instances positions attributes indices materials second_uvs environment textures gbuffer] [merged_paths] [])
            (indirect_temporal Pixels { known(scene) indirect_temporal, traced(scene shadow) indirect_temporal_traced }
                [lights alias instances positions attributes indices materials second_uvs environment textures gbuffer
                previous_gbuffer path_history aims] [merged_paths] [])
            (indirect_pair_targets Pixels { traced(scene shadow) indirect_pair_targets }
                [lights alias instances positions attributes indices materials second_uvs environment textures gbuffer paths] []
                [path_targets])
            (indirect_pair_merge Pixels { known(scene) indirect_pair_merge }
                [paths path_targets] [] [merged_paths])
            (indirect_shade Pixels { known(scene) indirect_shade }
                [lights alias instances positions attributes indices materials second_uvs environment textures gbuffer paths]
                [radiance] [])
            (indirect_shade_parts Pixels { known(scene) indirect_shade_parts }
                [lights alias instances positions attributes indices materials second_uvs environment textures gbuffer paths] []
                [indirect_diffuse indirect_specular])
            (reference Pixels { traced(shadow) reference }
                [lights gbuffer] [radiance] [])
            (reference_parts Pixels { traced(shadow) reference_parts }
                [lights gbuffer] [direct_diffuse direct_specular] [])
            (paths Pixels { bounced() paths }
                [lights alias instances positions attributes indices materials second_uvs environment textures gbuffer] [] [radiance])
            (paths_parts Pixels { bounced() paths_parts }
                [lights alias instances positions attributes indices materials second_uvs environment textures gbuffer] []
                [direct_diffuse direct_specular])
            (resolve Pixels { compute() resolve }
                [gbuffer direct_diffuse direct_specular emission] [] [radiance])
            (resolve_indirect Pixels { compute() resolve_indirect }
                [gbuffer indirect_diffuse indirect_specular] [radiance] [])
            (denoise_temporal Pixels { compute() denoise_temporal }
                [gbuffer previous_gbuffer aims motions direct_diffuse direct_specular indirect_diffuse indirect_specular previous_smoothed]
                [] [smoothed filtered])
            (denoise_variance Pixels { compute() denoise_variance }
                [smoothed filtering] [] [filtered])
            (denoise_spatial Pixels { compute() denoise_spatial }
                [filtering] [] [filtered])
            (resolve_denoised Pixels { compute() resolve_denoised }
                [gbuffer emission smoothed filtering] [] [radiance])
            (antialias Pixels { compute() antialias }
                [gbuffer motions aliased previous_antialiased] [] [antialiased radiance])
            (tonemap Pixels { compute() tonemap }
                [radiance] [] [display])
            (accumulate Pixels { compute() accumulate }
                [radiance] [mean] [])
            (view Pixels { compute() view }
                [instances materials lights tree_leaves cells beliefs gbuffer reservoirs radiance mean reference] [] [display])
            (statistics Blocks { compute() statistics }
                [radiance mean reference] [] [statistics])
            (roofline_primary Pixels { primary() roofline_primary }
                [rays] [] [hits])
            (roofline_shadow Pixels { traced(shadow) roofline_shadow }
                [rays] [] [hits])
            (roofline_copy Pixels { compute() roofline_copy }
                [gbuffer] [] [previous_gbuffer])
        }
    };
}
