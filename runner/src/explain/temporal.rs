//! The temporal passes of one pixel, with and without things that have moved.

use super::record::{Neighbor, PassReport};
use super::replay::{Rays, Replay, Replayed};
use glam::{Affine3A, Vec3};
use shared::alpha::SURE_HITS_ONLY;
use shared::frame::mode;
use shared::motion::{InstanceMotion, PastLights};
use shared::resampling::temporal::Place;
use shared::resampling::{CrossProposal, Pixels, initial, moving, temporal};
use shared::reservoir::{Reservoir, StoredReservoir};
use shared::rng::{Rng, Stream, unit_f32};

/// What a pass over one reservoir read of the previous frame.
#[derive(Clone, Copy)]
pub struct TemporalPass<'a> {
    pub stem: &'static str,
    pub lane: u32,
    pub previous: Pixels<'a>,
    /// Of a pass over things that move.
    pub before: Option<Before<'a>>,
}

/// How the scene was in the previous frame.
#[derive(Clone, Copy)]
pub struct Before<'a> {
    pub lights: PastLights<'a>,
    /// Of the pixel's instance.
    pub motion: InstanceMotion,
    /// Object to world of each of the scene's instances.
    pub transforms: &'a [Affine3A],
}

impl TemporalPass<'_> {
    /// `current`: all reservoirs before the pass. `gpu`: after it.
    pub fn replay(
        &self,
        replay: &Replay<'_>,
        current: &[StoredReservoir],
        gpu: &[StoredReservoir],
    ) -> PassReport {
        let (current, gpu) = (replay.at(current, self.lane), replay.at(gpu, self.lane));
        let place = self.place(replay);
        let mut history = Neighbor {
            pixel: place.map(|place| place.pixel.to_array()),
            rejected: place.and_then(|place| self.rejected(replay, place)),
            ..Default::default()
        };
        let report = PassReport { pass: self.stem, reservoir: self.lane, ..Default::default() };
        let (Some(place), None) = (place, history.rejected) else {
            history.rejected = history.rejected.or(Some("outside the previous picture, or the first frame"));
            let report =
                PassReport { canonical: Some(replay.alone(current)), others: vec![history], ..report };
            return replay.report(gpu, |_| {
                Replayed::new(report.clone(), self.without_history(replay, current), current, true)
            });
        };
        replay.report(gpu, |rays| {
            let report = PassReport { others: vec![history.clone()], ..report.clone() };
            match replay.frame.settings.mode {
                mode::BIASED => self.biased(replay, report, current, place),
                _ => self.unbiased(replay, report, current, rays),
            }
        })
    }

    fn place(&self, replay: &Replay<'_>) -> Option<Place> {
        match &self.before {
            Some(before) => moving::previous_place(&replay.frame, &replay.surface, &before.motion),
            None => temporal::previous_place(&replay.frame, &replay.surface),
        }
    }

    /// The surface's normal in the previous frame.
    fn normal(&self, replay: &Replay<'_>) -> Vec3 {
        let normal = replay.surface.normal;
        self.before.map_or(normal, |before| before.motion.normal(normal))
    }

    fn rejected(&self, replay: &Replay<'_>, place: Place) -> Option<&'static str> {
        let texel = self.previous.gbuffer[replay.frame.pixel_index(place.pixel) as usize];
        let unlike = replay.unlike(place.distance, self.normal(replay), &texel);
        let other_albedo = !temporal::is_similar_albedo(&replay.surface, &texel);
        unlike.or(other_albedo.then_some("its albedo differs too much"))
    }

    /// What the pass makes of a reservoir without history.
    fn without_history(&self, replay: &Replay<'_>, current: StoredReservoir) -> StoredReservoir {
        if replay.frame.settings.mode == mode::BIASED {
            return self.merged_biased(replay, current, &mut replay.rng(Stream::Temporal, self.lane));
        }
        if self.propose(replay, current).is_none() { current } else { StoredReservoir::default() }
    }

    fn merged_biased(&self, replay: &Replay<'_>, current: StoredReservoir, rng: &mut Rng) -> StoredReservoir {
        let Replay { frame, surface, .. } = replay;
        let (lights, previous, lane) = (replay.lights(), self.previous, self.lane);
        match self.before {
            Some(Before { lights: past, motion, .. }) => {
                moving::biased(frame, lights, past, surface, &motion, current, previous, lane, rng)
            }
            None => temporal::biased(frame, lights, surface, current, previous, lane, rng),
        }
    }

    fn propose(&self, replay: &Replay<'_>, current: StoredReservoir) -> Option<CrossProposal> {
        let Replay { frame, surface, .. } = replay;
        let (lights, previous, lane) = (replay.lights(), self.previous, self.lane);
        match self.before {
            Some(Before { lights: past, motion, .. }) => {
                moving::propose(frame, lights, past, surface, &motion, current, previous, lane)
            }
            None => temporal::propose(frame, lights, surface, current, previous, lane),
        }
    }

    fn biased(
        &self,
        replay: &Replay<'_>,
        mut report: PassReport,
        current: StoredReservoir,
        place: Place,
    ) -> Replayed {
        let mut rng = replay.rng(Stream::Temporal, self.lane);
        let result = self.merged_biased(replay, current, &mut rng.clone());
        let random = rng.next_u32x4();
        let mut merged = Reservoir::default();
        report.canonical = Some(replay.merge(&mut merged, current, unit_f32(random.x)));
        let mut history =
            temporal::capped_history(&replay.frame, current, self.previous, place.pixel, self.lane);
        if let Some(before) = &self.before {
            history = before.lights.carried(replay.lights().lights, history);
        }
        report.others[0].merged = Some(replay.merge(&mut merged, history, unit_f32(random.y)));
        Replayed::uniform(report, result, merged)
    }

    fn unbiased(
        &self,
        replay: &Replay<'_>,
        mut report: PassReport,
        current: StoredReservoir,
        rays: &mut Rays<'_>,
    ) -> Replayed {
        let (lights, surface) = (replay.lights(), &replay.surface);
        let Some(proposal) = self.propose(replay, current) else {
            return Replayed::new(report, current, StoredReservoir::default(), true);
        };
        let asks = replay.frame.settings.visibility_is_known();
        let seen = !asks || proposal.is_certain() || self.history_sees(&proposal, rays);
        let mut rng = replay.rng(Stream::Temporal, self.lane);
        let finished = temporal::accept(lights, surface, current, proposal, seen, &mut rng.clone());
        let visible = replay.is_seen(&finished, asks, rays);

        let random = rng.next_u32x4();
        let mut merge = temporal::begin(lights, surface, current, proposal);
        let weighed = merge.add(proposal.neighbor, proposal.seen(seen), unit_f32(random.x));
        replay.cross(&mut report.others[0], &proposal, weighed);
        let lines = replay.end_with_canonical(&mut report, &mut merge, current, unit_f32(random.y));
        Replayed::new(report, initial::accept(finished, visible), lines, visible)
    }

    fn history_sees(&self, proposal: &CrossProposal, rays: &mut Rays<'_>) -> bool {
        let purpose = "from the history's pixel to the current sample";
        match self.before {
            Some(Before { transforms, .. }) => {
                rays.ask_among(transforms, purpose, proposal.ray, SURE_HITS_ONLY)
            }
            None => rays.ask(purpose, proposal.ray, SURE_HITS_ONLY),
        }
    }
}
