//! The errors that can be planted in a frame.

/// One step done wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// The table believes that it draws every light equally often.
    SourcePmf,
    /// Points on area lights, directions in texels: their density is taken for 1.
    OnLightPdf,
    /// Tile entries forget which light they drew.
    TilePmf,
    /// 1/M of fresh candidates.
    FreshNormalization,
    /// 1/M of merged reservoirs.
    MergedNormalization,
    /// A history's weight is that of its full confidence, its count the capped one.
    CapAfterWeight,
    /// Merged with a MIS weight of 1 each.
    MisWeight,
    /// The MIS weight takes the canonical pixel's target function for the history's own.
    ForeignTarget,
    /// A reservoir found empty counts for nothing: a decision from the sample's content.
    EmptyForgotten,
    /// The cosine at the receiver, at the light, and 1/d².
    Cosine,
    EmitterCosine,
    Distance,
    /// The final shadow ray.
    ShadowRay,
    /// Visibility reuse left out where later passes count on it.
    VisibilityReuse,
    /// The ray from the history's pixel, from the neighbor whose weight is pending, and to the survivor.
    HistoryRay,
    PendingRay,
    SurvivorRay,
    /// The point of a pixel beside it is confirmed as the pixel's own.
    OtherPoint,
    /// Neighbors that see the sample are taken for blind, and the other way round.
    PendingInverted,
    /// The ray to the partner's sample, where that is merged, and where the partner weighs its own by the answer.
    RayToPartner,
    RayFromPartner,
    /// The partner's view of this pixel's sample is taken to be this pixel's own.
    PartnerTarget,
    /// Reservoirs are summed, not averaged.
    Average,
    /// Light and BSDF candidates are weighed by their own densities alone: what both find counts twice.
    Balance,
    /// The solid angle of a unit of the light, in the density of a BSDF candidate.
    FoundSolidAngle,
    /// The lobes' mixture in that density: the one has the other's probability.
    FoundMixture,
    /// BSDF rays that go through everything.
    FoundRay,
    /// A part of the pool believes in half the density that it was drawn with.
    ListShare,
    /// Pools are drawn from a tree of lights that have moved since, densities told from where they are now.
    StaleBound,
    /// Lists are written within the frame that reads them: densities are those of before.
    TableWritten,
    /// Candidates weigh what their lights would bring unshadowed, contribution weights what is believed to arrive.
    BeliefInTargetAlone,
}
