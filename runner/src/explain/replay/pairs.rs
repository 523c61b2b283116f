//! Spatial reuse in pairs: the pixel's half of the merge, and its partner's.

use super::super::record::{Neighbor, PassReport};
use super::{Rays, Replay, Replayed};
use glam::UVec2;
use shared::alpha::SURE_HITS_ONLY;
use shared::resampling::pairs::{self, PairTargets};
use shared::resampling::{Pixels, reservoir_index};
use shared::reservoir::StoredReservoir;
use shared::rng::{Stream, unit_f32};

impl Replay<'_> {
    /// `reservoirs`: before the pass. `gpu`: after it.
    pub fn pair_merge(
        &self,
        pass: &'static str,
        iteration: u32,
        lane: u32,
        reservoirs: &[StoredReservoir],
        gpu: &[StoredReservoir],
    ) -> PassReport {
        let pixels = Pixels { gbuffer: self.gbuffer, reservoirs };
        let round = lane + self.frame.settings.reservoirs * iteration;
        let report = PassReport { pass, iteration, reservoir: lane, ..Default::default() };
        let (partner, rejected) = self.partner(round);
        let neighbor =
            Neighbor { pixel: partner.map(|place| place.to_array()), rejected, ..Default::default() };
        let own = self.at(reservoirs, lane);
        self.report(self.at(gpu, lane), |rays| {
            let report = PassReport { others: vec![neighbor.clone()], ..report.clone() };
            match partner.filter(|_| rejected.is_none()) {
                Some(partner) => self.merge_with(partner, round, pixels, report, rays),
                None => {
                    let canonical = Some(self.alone(own));
                    Replayed::new(PassReport { canonical, ..report }, own, own, true)
                }
            }
        })
    }

    /// The partner of the pixel, and why it is not merged.
    fn partner(&self, round: u32) -> (Option<UVec2>, Option<&'static str>) {
        let Some(place) = pairs::partner_of(&self.frame, self.pixel, round) else {
            return (None, Some("outside the picture, or the pixel itself"));
        };
        if pairs::similar_partner(&self.frame, self.gbuffer, self.pixel, round).is_some() {
            return (Some(place), None);
        }
        let texel = self.gbuffer[self.frame.pixel_index(place) as usize];
        let unlike = self.unlike(self.surface.distance, self.surface.normal, &texel);
        // Of the two distances the smaller one counts.
        (Some(place), unlike.or(Some("its distance differs too much")))
    }

    fn merge_with(
        &self,
        partner: UVec2,
        round: u32,
        pixels: Pixels<'_>,
        mut report: PassReport,
        rays: &mut Rays<'_>,
    ) -> Replayed {
        let (frame, lane) = (&self.frame, report.reservoir);
        let here = self.pair_targets(
            self.pixel,
            round,
            pixels,
            lane,
            "from this pixel to its partner's sample",
            rays,
        );
        let there =
            self.pair_targets(partner, round, pixels, lane, "from the partner to this pixel's sample", rays);
        let own = self.at(pixels.reservoirs, lane);
        let other = pixels.reservoirs[reservoir_index(frame, partner, lane) as usize];
        let mut rng = self.rng(Stream::Spatial, round);
        let result = pairs::merge(&frame.settings, [own, other], [here, there], &mut rng.clone());

        let random = rng.next_u32x4();
        let mut merge = pairs::begin(&frame.settings, own, other, here);
        let cross = pairs::cross(here, there);
        let weighed = merge.add(other, cross, unit_f32(random.x));
        let neighbor = &mut report.others[0];
        neighbor.target_there = Some(there.own);
        neighbor.canonical_there = Some(there.partner);
        neighbor.merged = Some(self.weighed(other, here.partner, weighed));
        let lines = self.end_with_canonical(&mut report, &mut merge, own, unit_f32(random.y));
        Replayed::new(report, result, lines, true)
    }

    /// What `pixel` makes of both samples.
    fn pair_targets(
        &self,
        pixel: UVec2,
        round: u32,
        pixels: Pixels<'_>,
        lane: u32,
        purpose: &'static str,
        rays: &mut Rays<'_>,
    ) -> PairTargets {
        let frame = &self.frame;
        let texel = self.gbuffer[frame.pixel_index(pixel) as usize];
        let surface = texel.unpack(&frame.camera, pixel, frame.size);
        let proposal = pairs::propose(frame, self.lights(), &surface, pixels, pixel, lane, round);
        let visible = !frame.settings.visibility_is_known()
            || proposal.is_certain()
            || rays.ask(purpose, proposal.ray, SURE_HITS_ONLY);
        pairs::accept(proposal, visible)
    }
}
