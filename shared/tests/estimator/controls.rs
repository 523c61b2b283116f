//! Negative controls: each term of the estimator left out once. The test of [`crate::matrix`] must fail on every one.

use crate::knowledge::known;
use crate::matrix::base;
use crate::plant::Plant;
use crate::statistics::{T_LIMIT, expected, t_of};
use crate::world::{self, World};
use shared::frame::{Settings, mode};

fn reuse() -> Settings {
    Settings { visibility_reuse: 1, ..base() }
}

fn unbiased() -> Settings {
    Settings { mode: mode::UNBIASED, ..reuse() }
}

/// `planted` is seen in `world`, and nothing else is: without it the same case passes.
fn is_seen(planted: Plant, world: World, settings: Settings, frames: u32) {
    let truth = expected(&world, frames);
    let right = t_of(&format!("without {planted:?}"), &world, &truth, settings, frames, None);
    let wrong = t_of(&format!("{planted:?}"), &world, &truth, settings, frames, Some(planted));
    assert!(right < T_LIMIT, "without {planted:?}: {right} standard errors off");
    assert!(wrong > T_LIMIT, "{planted:?} was not seen: {wrong} standard errors");
}

fn screened(kind: world::Kind) -> World {
    World::new(kind.somewhere).behind_a_screen()
}

#[test]
fn source_densities_left_out_are_seen() {
    is_seen(Plant::SourcePmf, screened(world::points()), base(), 1);
    is_seen(Plant::OnLightPdf, screened(world::triangles()), base(), 1);
    is_seen(Plant::OnLightPdf, screened(world::environment()), base(), 1);
    is_seen(Plant::TilePmf, screened(world::points()), Settings { tiles: 1, ..base() }, 1);
}

#[test]
fn faults_of_cells_are_seen() {
    let random = Settings { cells: known::RANDOM, candidates: 8, ..reuse() };
    is_seen(Plant::ListShare, screened(world::points()), random, 1);
    is_seen(Plant::TableWritten, screened(world::points()), random, 1);
    is_seen(Plant::StaleBound, screened(world::points()), Settings { cells: known::LEARNED, ..random }, 1);
    is_seen(Plant::BeliefInTargetAlone, screened(world::points()), random, 1);
}

#[test]
fn faults_of_found_candidates_are_seen() {
    let found = Settings { bsdf_candidates: 1, ..reuse() };
    let glossy = |kind| screened(kind).reflecting(0.9, 0.5);
    for kind in [world::ceiling, world::environment] {
        is_seen(Plant::Balance, glossy(kind()), found, 1);
        is_seen(Plant::FoundMixture, glossy(kind()), found, 1);
    }
    let unbiased = Settings { mode: mode::UNBIASED, ..found };
    is_seen(Plant::FoundRay, glossy(world::environment()), unbiased, 1);
    is_seen(Plant::FoundSolidAngle, glossy(world::ceiling()), found, 1);
}

#[test]
fn normalizations_left_out_are_seen() {
    is_seen(Plant::FreshNormalization, screened(world::points()), base(), 1);
    let spatial = Settings { spatial: 1, spatial_iterations: 1, ..reuse() };
    is_seen(Plant::MergedNormalization, World::new(world::points().everywhere), spatial, 1);
    is_seen(Plant::Average, screened(world::points()), Settings { reservoirs: 2, ..base() }, 1);
}

#[test]
fn terms_of_the_integrand_left_out_are_seen() {
    is_seen(Plant::Cosine, screened(world::suns()), base(), 1);
    is_seen(Plant::EmitterCosine, screened(world::triangles()), base(), 1);
    is_seen(Plant::Distance, screened(world::points()), base(), 1);
    is_seen(Plant::ShadowRay, screened(world::points()), base(), 1);
}

#[test]
fn mis_weights_left_out_are_seen() {
    let temporal = Settings { temporal: 1, ..unbiased() };
    is_seen(Plant::MisWeight, screened(world::points()), temporal, 2);
    // Targets differ where cones end between the history's pixel and the canonical one.
    let blind = Settings { visibility_reuse: 0, ..temporal };
    is_seen(Plant::ForeignTarget, screened(world::spots()), blind, 4);
    let spatial = Settings { spatial: 1, spatial_iterations: 1, candidates: 16, ..unbiased() };
    is_seen(Plant::EmptyForgotten, screened(world::points()), spatial, 1);
}

/// A cap that changes the history's count, and not its weight with it, changes the mean.
#[test]
fn a_cap_after_the_weight_is_seen() {
    let capped = Settings { temporal: 1, confidence_cap: 2.0, ..reuse() };
    is_seen(Plant::CapAfterWeight, World::new(world::points().everywhere), capped, 6);
}

#[test]
fn rays_left_out_are_seen() {
    let temporal = Settings { temporal: 1, candidates: 16, ..unbiased() };
    let spatial = Settings { spatial: 1, spatial_iterations: 1, candidates: 16, ..unbiased() };
    is_seen(Plant::VisibilityReuse, screened(world::points()), temporal, 1);
    is_seen(Plant::HistoryRay, screened(world::points()), temporal, 4);
    is_seen(Plant::SurvivorRay, screened(world::points()), spatial, 1);
    is_seen(Plant::PendingRay, screened(world::points()), spatial, 1);
    is_seen(Plant::PendingInverted, screened(world::points()), spatial, 1);
}

#[test]
fn a_point_taken_for_another_is_seen() {
    let temporal = Settings { temporal: 1, candidates: 16, ..unbiased() };
    is_seen(Plant::OtherPoint, screened(world::points()).with_points_that_last(), temporal, 4);
}

#[test]
fn faults_of_pairs_are_seen() {
    let pairs =
        Settings { pairs: 1, spatial: 1, spatial_iterations: 4, radius: 8.0, candidates: 16, ..unbiased() };
    for planted in [Plant::RayToPartner, Plant::RayFromPartner, Plant::PartnerTarget] {
        is_seen(planted, screened(world::points()), pairs, 1);
    }
}

/// The biased mode itself is the negative control of the unbiased one: 1/M weights behind a screen.
///
/// Equation (21): Bitterli section 4.2.
#[test]
fn the_bias_of_the_biased_mode_is_seen() {
    let world = screened(world::points());
    let settings = Settings { spatial: 1, spatial_iterations: 1, candidates: 16, ..reuse() };
    let truth = expected(&world, 1);
    assert!(t_of("1/M", &world, &truth, settings, 1, None) > T_LIMIT, "1/M weights passed behind a screen");
    let unbiased = Settings { mode: mode::UNBIASED, ..settings };
    assert!(t_of("pairwise", &world, &truth, unbiased, 1, None) < T_LIMIT);
}
