//! One side of the window: frames of one settings.

use crate::state::State;
use crate::views::View;
use candela::error::Result;
use candela::frame::history::History;
use candela::knobs::Knobs;
use candela::vulkan::Device;
use glam::UVec2;
use shared::interface::PassConstants;
use shared::passes::Pass;
use shared::view::kind;

/// Frames of one settings.
pub(super) struct Side {
    pub history: History,
    /// What the mean stands for, and how many frames it has.
    settings: Option<Knobs>,
    pub count: u32,
}

impl Side {
    pub fn new(device: &Device, size: UVec2, reservoirs: u32) -> Result<Side> {
        Ok(Side { history: History::new(device, size, reservoirs)?, settings: None, count: 0 })
    }

    pub fn fits(&self, state: &State, side: usize, size: UVec2) -> bool {
        self.history.size() == size
            && self.history.reservoirs() >= state.settings[side].reservoirs
            && (self.history.has_mean() || !looks_closer(state))
    }

    pub fn fit(&mut self, device: &Device, state: &State, side: usize, size: UVec2) -> Result<()> {
        let reservoirs = state.settings[side].reservoirs;
        if self.history.size() != size || self.history.reservoirs() < reservoirs {
            *self = Side::new(device, size, reservoirs)?;
        }
        if looks_closer(state) { self.history.make_mean(device) } else { Ok(()) }
    }

    /// The mean starts anew with other settings.
    pub fn follow(&mut self, settings: &Knobs) {
        if self.settings.as_ref() != Some(settings) {
            self.settings = Some(settings.clone());
            self.count = 0;
        }
    }

    /// Passes after the frame: its mean, and what is shown instead of it.
    pub fn looks(&mut self, state: &State, radius: f32) -> Vec<(Pass, PassConstants)> {
        let mut looks = Vec::new();
        self.count = if state.accumulate { self.count + 1 } else { 0 };
        let constants = PassConstants { count: self.count, scale: radius, ..PassConstants::default() };
        if state.accumulate {
            looks.push((Pass::accumulate, constants));
        }
        let mean = (state.accumulate && state.view == View::Final).then_some(kind::MEAN);
        if let Some(view) = state.view.kind().or(mean) {
            looks.push((Pass::view, PassConstants { view, ..constants }));
        }
        looks
    }
}

/// Does any pass follow the frame that needs a mean or sums?
fn looks_closer(state: &State) -> bool {
    state.accumulate || state.error || state.view.kind().is_some()
}
