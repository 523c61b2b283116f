//! How much reservoirs of the past and of neighbors count, in frames of fresh candidates: those of lights, and those of paths.
//!
//! The history of the very point that is shaded, seen from the same place, goes on like a mean over frames: it counts up to
//! `history_cap` of them. The reservoir of another point (a neighbor's, or a history whose point or camera has moved) brings noise
//! of its own, however long it is, since p̂ here over p̂ there spreads over its samples: it counts up to `confidence_cap` frames,
//! and lends no confidence beyond that. So neighbors help while a history is young, and hold no old one up; where both are long,
//! they are not asked at all. Measured in docs/performance.md.
//!
//! All is decided by confidences, which hang on geometry and never on samples: the mean stays right.

use crate::bounced::PathSample;
use crate::frame::{FrameConstants, Settings};
use crate::light::LightSample;
use crate::reservoir::Stored;

/// What reservoirs hold.
pub trait Sample: Copy + PartialEq {
    /// Candidates that a frame shows each reservoir, as confidences count them.
    fn a_frame(settings: &Settings) -> f32;
}

impl Sample for LightSample {
    fn a_frame(settings: &Settings) -> f32 {
        settings.light_candidates() as f32
    }
}

impl Sample for PathSample {
    fn a_frame(_: &Settings) -> f32 {
        1.0
    }
}

/// The history as it counts in this frame, beside `fresh` candidates.
///
/// Equation (19).
pub fn of_history<S: Sample>(
    frame: &FrameConstants,
    history: Stored<S>,
    same_point: bool,
    fresh: f32,
) -> Stored<S> {
    let Settings { history_cap, confidence_cap, .. } = frame.settings;
    let lasts = same_point && frame.camera == frame.previous_camera;
    history.capped(if lasts { history_cap } else { confidence_cap } * fresh)
}

/// A neighbor's reservoir as it counts: a capped history, and its frame.
///
/// Equation (19).
pub fn of_neighbor<S: Sample>(settings: &Settings, neighbor: Stored<S>) -> Stored<S> {
    neighbor.capped(lent::<S>(settings))
}

/// `merged` from a reservoir of confidence `own` and from neighbors.
///
/// Equation (19).
pub fn with_neighbors<S: Sample>(settings: &Settings, own: f32, merged: Stored<S>) -> Stored<S> {
    Stored { confidence: own.max(merged.confidence.min(lent::<S>(settings))), ..merged }
}

/// Are both so long that neither gains by the other?
pub fn both_last<S: Sample>(settings: &Settings, a: Stored<S>, b: Stored<S>) -> bool {
    let frames = (0.5 * settings.history_cap).max(2.0 * settings.confidence_cap);
    settings.temporal != 0 && a.confidence.min(b.confidence) > frames * S::a_frame(settings)
}

/// The most that neighbors count, candidates. Without a history they are as good as the pixel itself.
fn lent<S: Sample>(settings: &Settings) -> f32 {
    if settings.temporal == 0 {
        return f32::MAX;
    }
    (settings.confidence_cap + 1.0) * S::a_frame(settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reservoir::StoredReservoir;

    fn counting(confidence: f32) -> StoredReservoir {
        StoredReservoir { contribution_weight: 1.0, confidence, ..StoredReservoir::default() }
    }

    fn settings() -> Settings {
        Settings {
            candidates: 10,
            confidence_cap: 20.0,
            history_cap: 100.0,
            temporal: 1,
            ..Settings::default()
        }
    }

    #[test]
    fn only_the_same_point_seen_from_the_same_place_counts_long() {
        let mut frame = FrameConstants { settings: settings(), ..bytemuck::Zeroable::zeroed() };
        let count = |frame: &FrameConstants, same| of_history(frame, counting(1e6), same, 10.0).confidence;
        assert_eq!((count(&frame, true), count(&frame, false)), (1000.0, 200.0));
        frame.camera.position.x = 1e-3;
        assert_eq!(count(&frame, true), 200.0, "what it reflects to the camera has changed");
    }

    /// From the first frame on, each pixel merged with one that is as old.
    #[test]
    fn neighbors_fill_up_the_young_and_the_old_go_on_alone() {
        let settings = settings();
        let mut history = 0.0f32;
        let mut ages = Vec::new();
        for _ in 0..200 {
            let own = counting(history.min(1000.0) + 10.0);
            let other = of_neighbor(&settings, own);
            assert!(other.confidence <= 210.0);
            let merged = counting(own.confidence + other.confidence);
            history = with_neighbors(&settings, own.confidence, merged).confidence;
            ages.push(history / 10.0);
        }
        assert_eq!(ages[..6], [2.0, 6.0, 14.0, 21.0, 22.0, 23.0]);
        assert_eq!(ages[199], 101.0);
        let alone =
            ages.iter().position(|&age| both_last(&settings, counting(10.0 * age), counting(10.0 * age)));
        assert_eq!(alone.map(|i| ages[i]), Some(51.0));
        assert!(!both_last(&settings, counting(1e6), counting(20.0)), "the younger one gains");
    }

    /// With one cap for all, histories count as in the papers, and neighbors as much as the pixel itself.
    #[test]
    fn one_cap_for_all_is_the_papers() {
        let settings = Settings { history_cap: 20.0, ..settings() };
        let full = counting(210.0);
        assert_eq!(of_neighbor(&settings, full), full);
        assert!(!both_last(&settings, full, full));
        let alone = Settings { temporal: 0, ..settings };
        assert_eq!(of_neighbor(&alone, counting(1e6)), counting(1e6));
        assert_eq!(with_neighbors(&alone, 1.0, counting(1e6)), counting(1e6));
    }
}
