//! The frame's passes, followed on paper.

use super::*;
use crate::frame::pass::barriers;
use shared::passes::Access;
use shared::resources::set;
use std::collections::HashMap;

/// Follows the data: every buffer holds what its reader expects, however many iterations and whatever is off.
#[test]
fn every_pass_reads_what_the_pass_before_it_wrote() {
    for iterations in 1..=4 {
        for (temporal, spatial, pairs) in [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (0, 1, 1), (1, 1, 1)] {
            let spatial_iterations = iterations;
            let indirect = [indirect::ONE, indirect::FULL][iterations as usize % 2];
            let settings =
                Settings { temporal, spatial, pairs, spatial_iterations, indirect, ..Default::default() };
            follow(&Work::Restir(settings), Points::Centers, true, "gbuffer_raster");
            follow(&Work::Restir(settings), Points::Centers, false, "gbuffer");
            follow(&Work::Restir(settings), Points::Lasting, false, "gbuffer_aimed");
        }
    }
}

fn follow(work: &Work, points: Points, draws: bool, surfaces: &str) {
    let mut rotation = Rotation::default();
    let mut content: HashMap<Target, (u32, &str)> = HashMap::new();
    for frame in 0..7 {
        let (moved, has_paths) = (frame % 2 == 1, frame > 0);
        let conditions = Conditions { draws, points, moved, has_paths, ..Default::default() };
        let (steps, next) = schedule(work, conditions, rotation);
        let (mut last_reservoirs, mut last_paths) = ("", "");
        for step in &steps {
            for &(binding, access, target) in &step.targets {
                let found = content.get(&target).copied();
                match binding {
                    Binding::gbuffer if access == Access::Read => {
                        assert_eq!(found, Some((frame, surfaces)))
                    }
                    Binding::previous_gbuffer | Binding::previous_points if frame > 0 => {
                        assert_eq!(found, Some((frame - 1, surfaces)))
                    }
                    Binding::aims if access == Access::Read && points != Points::Centers => {
                        assert_eq!(found, Some((frame, "gbuffer_aimed")), "confirmed");
                    }
                    Binding::visibility if access == Access::Read => {
                        assert_eq!(found, Some((frame, "visibility")))
                    }
                    Binding::reservoirs => assert_eq!(found, Some((frame, last_reservoirs))),
                    Binding::pair_targets if access == Access::Read => {
                        assert_eq!(found, Some((frame, "pair_targets")))
                    }
                    Binding::paths => assert_eq!(found, Some((frame, last_paths))),
                    Binding::path_targets if access == Access::Read => {
                        assert_eq!(found, Some((frame, "indirect_pair_targets")))
                    }
                    Binding::history | Binding::path_history if frame > 0 => {
                        assert_eq!(found.map(|f| f.0), Some(frame - 1), "history is of the frame before");
                    }
                    _ => {}
                }
            }
            for &(binding, access, target) in &step.targets {
                if access.writes() {
                    content.insert(target, (frame, step.pass.stem()));
                    last_reservoirs =
                        if binding == Binding::merged { step.pass.stem() } else { last_reservoirs };
                    last_paths = if binding == Binding::merged_paths { step.pass.stem() } else { last_paths };
                }
            }
        }
        let view = &looks(&[(Pass::view, PassConstants::default())], next)[0];
        let seen = |binding| content[&view.target(binding).unwrap()];
        assert_eq!(seen(Binding::gbuffer), (frame, surfaces));
        assert_eq!(seen(Binding::reservoirs), (frame, last_reservoirs));
        assert_eq!(content[&next.last_reservoirs()], (frame, last_reservoirs));
        let last_buffer = Target { resource: Resource::paths, copy: next.history };
        assert_eq!(content[&last_buffer], (frame, last_paths));
        assert_eq!(content[&next.last_gbuffer()], (frame, surfaces));
        rotation = next;
    }
}

#[test]
fn the_thesis_frame_reads_like_the_paper() {
    let thesis = Settings { mode: mode::BIASED, spatial_iterations: 2, ..Settings::default() };
    let (steps, _) = schedule(&Work::Restir(thesis), Conditions::default(), Rotation::default());
    let stems: Vec<_> = steps.iter().map(|s| s.pass.stem()).collect();
    assert_eq!(stems, ["gbuffer", "initial", "temporal", "spatial", "spatial", "shade_traced", "tonemap"]);
    assert!(barriers(&steps).iter().all(|&wait| wait), "each pass needs the one before it");
}

#[test]
fn the_reference_covers_each_light_once() {
    for lights in [0, 1, 63, 64, 65, 500] {
        let (steps, _) = schedule(&Work::Reference { lights }, Conditions::default(), Rotation::default());
        let ranges = steps.iter().filter(|s| s.pass.stem() == "reference").map(|s| s.constants);
        let covered: Vec<u32> = ranges.flat_map(|c| c.first_light..c.first_light + c.light_count).collect();
        assert_eq!(covered, (0..lights).collect::<Vec<_>>());
    }
}

#[test]
fn slices_of_the_reference_are_the_reference() {
    let mut rotation = Rotation::default();
    let mut covered = Vec::new();
    for (first, count) in [(0, 100), (100, 30), (130, 1)] {
        let work = Work::ReferenceSlice { first, count };
        let (steps, next) = schedule(&work, Conditions::default(), rotation);
        let surfaces = steps.iter().filter(|s| s.pass.stem() == "gbuffer").count();
        assert_eq!(surfaces, usize::from(first == 0), "one set of surfaces for all");
        let adds = steps.iter().filter(|s| s.pass.stem() == "reference").map(|s| s.constants);
        covered.extend(adds.flat_map(|c| c.first_light..c.first_light + c.light_count));
        rotation = next;
    }
    assert_eq!(covered, (0..131).collect::<Vec<_>>());
}

/// Buffers of several copies, or of none, have a rule; a new one without it would be bound to its first copy.
#[test]
fn copies_have_a_rule() {
    let frame = Frame::new(Conditions::default(), Rotation::default());
    for &binding in Binding::ALL.iter().filter(|binding| binding.set() == set::FRAME) {
        let Target { resource, copy } = frame.target(binding);
        // The reference's mean is that of another history.
        assert!(copy < resource.copies() || binding == Binding::reference, "{binding:?}");
    }
    for names in [
        [Binding::gbuffer, Binding::previous_gbuffer],
        [Binding::reservoirs, Binding::merged],
        [Binding::paths, Binding::merged_paths],
    ] {
        assert_ne!(frame.target(names[0]), frame.target(names[1]));
        assert_eq!(names[0].resource(), names[1].resource());
    }
}
