//! A pass as a declaration: what it reads, writes and covers. Barriers, labels and timestamps follow from it.

use shared::interface::{PassConstants, frame_binding};

/// How a pass runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// A ray generation shader; `rays` names the payload its pipeline is built for.
    RayTracing(Rays),
    Compute,
    /// Vertex and fragment shaders draw the scene into an image, which is copied to the pass's buffer.
    Raster,
}

/// Which hit and miss shaders a ray-tracing pass needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rays {
    Primary,
    Shadow,
    /// Shadow rays, and rays that look for the nearest light where the scene has lights that rays can find.
    Both,
}

/// What a binding of set 1 is used for. The physical buffer behind a role changes from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    GBuffer,
    PreviousGBuffer,
    ReservoirsIn,
    ReservoirsOut,
    ReservoirsHistory,
    Radiance,
    Display,
    TileEntries,
    TilePoints,
    /// The viewer's mean over frames, and the mean of the reference.
    Mean,
    Reference,
    Statistics,
    /// Of the floors.
    Rays,
    Hits,
    /// Which triangle each pixel sees.
    Visibility,
    /// Lies in the history, which is no longer needed when neighbors are reused.
    PairTargets,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    Read,
    Write,
    ReadWrite,
}

/// How many threads a pass launches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// One a pixel.
    Pixels,
    /// One for each reservoir of each pixel.
    Reservoirs,
    /// One for each entry of the light tiles.
    Tiles,
    /// One for each block of [`shared::statistics::BLOCK`] x BLOCK pixels.
    Blocks,
}

/// A pass. Its stem names the shader file, the host file, the entry point, the debug label, the timestamp and the
/// column of reports.
#[derive(Debug, PartialEq, Eq)]
pub struct Pass {
    pub stem: &'static str,
    pub stage: Stage,
    pub uses: &'static [(Role, Access)],
    pub extent: Extent,
    /// It reads set 2: the scene as it was in the previous frame.
    pub past: bool,
}

/// A buffer that outlives a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BufferId {
    GBuffer(usize),
    Reservoirs(usize),
    Radiance,
    Display,
    TileEntries,
    TilePoints,
    Mean,
    /// The mean of another history, which shows the reference.
    Reference,
    Statistics,
    Rays,
    Hits,
    Visibility,
}

/// A pass at its place in a frame, with its buffers.
#[derive(Clone, Debug)]
pub struct Step {
    pub pass: &'static Pass,
    /// One for each of the pass's `uses`, in their order.
    pub buffers: Vec<BufferId>,
    pub constants: PassConstants,
}

impl Role {
    /// Binding number in set 1.
    pub fn binding(self) -> u32 {
        match self {
            Role::GBuffer => frame_binding::GBUFFER,
            Role::PreviousGBuffer => frame_binding::PREVIOUS_GBUFFER,
            Role::ReservoirsIn => frame_binding::RESERVOIRS_IN,
            Role::ReservoirsOut => frame_binding::RESERVOIRS_OUT,
            Role::ReservoirsHistory => frame_binding::RESERVOIRS_HISTORY,
            Role::Radiance => frame_binding::RADIANCE,
            Role::Display => frame_binding::DISPLAY,
            Role::TileEntries => frame_binding::TILE_ENTRIES,
            Role::TilePoints => frame_binding::TILE_POINTS,
            Role::Mean => frame_binding::MEAN,
            Role::Reference => frame_binding::REFERENCE,
            Role::Statistics => frame_binding::STATISTICS,
            Role::Rays => frame_binding::RAYS,
            Role::Hits => frame_binding::HITS,
            Role::Visibility => frame_binding::VISIBILITY,
            Role::PairTargets => frame_binding::PAIR_TARGETS,
        }
    }
}

impl Access {
    fn writes(self) -> bool {
        self != Access::Read
    }
}

/// For each step: must it wait for what came before? True when it touches a buffer that was written since the last
/// wait, or writes one that was read since. The frame before counts: its steps come first.
pub fn barriers(steps: &[Step]) -> Vec<bool> {
    let mut written: Vec<BufferId> = Vec::new();
    let mut read: Vec<BufferId> = Vec::new();
    let mut waits = Vec::with_capacity(steps.len());
    for step in steps {
        let accesses =
            || step.pass.uses.iter().zip(&step.buffers).map(|(&(_, access), &buffer)| (access, buffer));
        let hazard = accesses()
            .any(|(access, buffer)| written.contains(&buffer) || access.writes() && read.contains(&buffer));
        // The first step waits for the frame before it, whatever that did.
        let wait = hazard || waits.is_empty();
        if wait {
            written.clear();
            read.clear();
        }
        for (access, buffer) in accesses() {
            if access.writes() { written.push(buffer) } else { read.push(buffer) }
        }
        waits.push(wait);
    }
    waits
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRODUCE: Pass = Pass {
        stem: "produce",
        stage: Stage::Compute,
        uses: &[(Role::GBuffer, Access::Write)],
        extent: Extent::Pixels,
        past: false,
    };
    const CONSUME: Pass = Pass {
        stem: "consume",
        stage: Stage::Compute,
        uses: &[(Role::GBuffer, Access::Read), (Role::Radiance, Access::Write)],
        extent: Extent::Pixels,
        past: false,
    };

    fn step(pass: &'static Pass, buffers: &[BufferId]) -> Step {
        Step { pass, buffers: buffers.to_vec(), constants: PassConstants::default() }
    }

    #[test]
    fn hazards_need_barriers_and_nothing_else_does() {
        use BufferId::{Display, GBuffer, Radiance};
        // Write -> read; independent; write after read; write after write.
        let steps = [
            step(&PRODUCE, &[GBuffer(0)]),
            step(&CONSUME, &[GBuffer(0), Radiance]),
            step(&PRODUCE, &[GBuffer(1)]),
            step(&CONSUME, &[GBuffer(0), Display]),
            step(&PRODUCE, &[GBuffer(0)]),
            step(&PRODUCE, &[GBuffer(0)]),
        ];
        assert_eq!(barriers(&steps), [true, true, false, false, true, true]);
    }
}
