//! The largest number of rays of a frame. Counting those that are traced takes an atomic in every ray-tracing shader, or
//! a second variant of each; the most is known from the settings alone.

use super::pass::Step;
use super::schedule::{Conditions, Rotation, Work, schedule};
use shared::frame::Settings;
use shared::passes::indirect::Level;
use shared::passes::{Body, Stage};
use shared::resources::Extent;

/// Rays a pixel of a frame with these settings, at most; fewer where nothing is hit or a sample's visibility is known.
/// `features`: of the scene.
pub fn most(settings: &Settings, draws: bool, features: u32) -> u64 {
    let conditions = Conditions { draws, features, ..Default::default() };
    let (steps, _) = schedule(&Work::Restir(*settings), conditions, Rotation::default());
    steps.iter().map(|step| of_step(step, settings, features)).sum()
}

/// Rays a pixel of one step.
fn of_step(step: &Step, settings: &Settings, features: u32) -> u64 {
    let known = u64::from(settings.visibility_is_known());
    let a_thread = match step.pass.body() {
        _ if matches!(step.pass.stage(), Stage::Compute | Stage::Raster) => 0,
        Body::gbuffer | Body::gbuffer_aimed => 1,
        Body::initial | Body::initial_met => {
            u64::from(settings.bsdf_candidates(features)) + u64::from(settings.visibility_reuse != 0)
        }
        // The sample of the one in the place of the other, and the survivor; not asked where visibility is left to shading.
        Body::temporal | Body::temporal_hops | Body::spatial => 2 * known,
        // The partner's sample.
        Body::pair_targets => known,
        // To what reflects light, and from each of its points on and to a light.
        Body::indirect_initial => 3,
        // On to each point, and from those where light is gathered two.
        Body::indirect_further => {
            let Level { side, first, last } = step.constants.level;
            u64::from((last + 2 * (last + 1 - first)).div_ceil((side * side).max(1)))
        }
        Body::indirect_temporal => 2,
        Body::indirect_pair_targets => 1,
        Body::shade | Body::shade_parts => u64::from(settings.reservoirs),
        Body::reference | Body::reference_parts => u64::from(step.constants.light_count),
        // One that goes on, and one to a light, at each point but the first.
        Body::paths | Body::paths_parts => {
            u64::from(step.constants.paths) * (1 + 2 * u64::from(step.constants.bounces))
        }
        Body::roofline_primary | Body::roofline_shadow => 1,
        _ => 0,
    };
    let threads = if step.pass.extent() == Extent::Reservoirs { settings.reservoirs } else { 1 };
    a_thread * u64::from(threads)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::frame::{features, mode};
    use shared::interface::PassConstants;
    use shared::passes::Pass;

    /// Counted by hand: the eye's ray, one for the candidate, one to shade; unbiased two in each of three merges, and none to
    /// shade but through what is transparent.
    #[test]
    fn rays_counted_by_hand() {
        let biased = Settings { mode: mode::BIASED, pairs: 0, spatial_iterations: 2, ..Settings::default() };
        let unbiased = Settings { mode: mode::UNBIASED, ..biased };
        let most = |settings: &Settings, features| {
            let rays = super::most(settings, false, features);
            assert_eq!(super::most(settings, true, features), rays - 1, "the eye's ray");
            rays
        };
        let count = |settings: Settings| (most(&settings, 0), most(&settings, features::ALPHA));
        assert_eq!(count(biased), (3, 3));
        assert_eq!(count(Settings { visibility_reuse: 0, reservoirs: 2, ..biased }), (3, 3));
        assert_eq!(count(unbiased), (8, 9));
        assert_eq!(count(Settings { pairs: 1, ..unbiased }), (6, 7));
        assert_eq!(count(Settings { reservoirs: 4, temporal: 0, ..unbiased }), (21, 25));
        assert_eq!(count(Settings { tiles: 1, spatial: 0, ..unbiased }), (4, 5));
        assert_eq!(count(Settings { visibility_reuse: 0, ..unbiased }), (2, 2));
    }

    /// A pass with rays that nobody counts would be one without.
    #[test]
    fn rays_of_every_pass_count() {
        let constants = PassConstants { light_count: 1, paths: 1, ..Default::default() };
        for &pass in Pass::ALL {
            let step = Step::new(pass, 0, constants, |binding| binding.resource().into());
            let rays = of_step(&step, &Settings::default(), features::TRACEABLE);
            assert_eq!(rays > 0, matches!(pass.stage(), Stage::RayTracing(_)), "{pass:?}: {rays}");
        }
    }

    /// Moving passes trace as many as those that stand in for them.
    #[test]
    fn motion_costs_no_ray() {
        for mode in [mode::BIASED, mode::UNBIASED] {
            let settings = Settings { mode, ..Settings::default() };
            let rays = |moved| -> u64 {
                let conditions = Conditions { moved, ..Default::default() };
                let (steps, _) = schedule(&Work::Restir(settings), conditions, Rotation::default());
                steps.iter().map(|step| of_step(step, &settings, 0)).sum()
            };
            assert_eq!(rays(true), rays(false));
        }
    }
}
