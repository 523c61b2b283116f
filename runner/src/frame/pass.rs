//! Passes at their place in a frame, with their buffers. Barriers, labels and timestamps follow from what the table of passes declares.

use super::targets::Target;
use shared::interface::PassConstants;
use shared::passes::{Access, Pass};
use shared::resources::{Binding, set};

/// A pass at its place in a frame.
#[derive(Clone, Debug)]
pub struct Step {
    pub pass: Pass,
    /// Of [`shared::passes::variant`].
    pub variant: u32,
    /// Its buffers in set 1, in the order of the table.
    pub targets: Vec<(Binding, Access, Target)>,
    pub constants: PassConstants,
}

impl Step {
    /// `target`: what stands behind a binding.
    pub fn new(
        pass: Pass,
        variant: u32,
        constants: PassConstants,
        target: impl Fn(Binding) -> Target,
    ) -> Self {
        let uses = pass.uses().iter().filter(|(binding, _)| binding.set() == set::FRAME);
        let targets = uses.map(|&(binding, access)| (binding, access, target(binding))).collect();
        Step { pass, variant, targets, constants }
    }

    /// What stands behind `binding`, if the pass has it.
    pub fn target(&self, binding: Binding) -> Option<Target> {
        self.targets.iter().find(|(name, ..)| *name == binding).map(|&(_, _, target)| target)
    }

    /// Does it write `binding`?
    pub fn writes(&self, binding: Binding) -> bool {
        self.targets.iter().any(|&(name, access, _)| name == binding && access.writes())
    }
}

/// For each step: must it wait for what came before? True when it touches a buffer that was written since the last
/// wait, or writes one that was read since. The frame before counts: its steps come first.
pub fn barriers(steps: &[Step]) -> Vec<bool> {
    let mut written: Vec<Target> = Vec::new();
    let mut read: Vec<Target> = Vec::new();
    let mut waits = Vec::with_capacity(steps.len());
    for step in steps {
        let accesses = || step.targets.iter().map(|&(_, access, target)| (access, target));
        let hazard = accesses()
            .any(|(access, target)| written.contains(&target) || access.writes() && read.contains(&target));
        // The first step waits for the frame before it, whatever that did.
        let wait = hazard || waits.is_empty();
        if wait {
            written.clear();
            read.clear();
        }
        for (access, target) in accesses() {
            if access.writes() { written.push(target) } else { read.push(target) }
        }
        waits.push(wait);
    }
    waits
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::resources::Resource;

    fn step(targets: &[(Access, Target)]) -> Step {
        let targets = targets.iter().map(|&(access, target)| (Binding::gbuffer, access, target)).collect();
        Step { pass: Pass::tonemap, variant: 0, targets, constants: PassConstants::default() }
    }

    #[test]
    fn hazards_need_barriers_and_nothing_else_does() {
        let gbuffer = |copy| Target { resource: Resource::gbuffer, copy };
        let [radiance, display] = [Resource::radiance, Resource::display].map(Target::from);
        let produce = |target| step(&[(Access::Write, target)]);
        let consume = |from, to| step(&[(Access::Read, from), (Access::Write, to)]);
        // Write -> read; independent; write after read; write after write.
        let steps = [
            produce(gbuffer(0)),
            consume(gbuffer(0), radiance),
            produce(gbuffer(1)),
            consume(gbuffer(0), display),
            produce(gbuffer(0)),
            produce(gbuffer(0)),
        ];
        assert_eq!(barriers(&steps), [true, true, false, false, true, true]);
    }
}
