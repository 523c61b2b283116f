//! The interface: one panel at the left with sections, messages at the bottom, explanation and help over all.

mod animation;
mod camera;
mod error;
mod explanation;
mod help;
mod inspector;
mod knobs;
mod messages;
mod picture;
mod times;

use super::explaining::Answer;
use super::frames::FrameFacts;
use super::notices::Notices;
use super::readings::Readings;
use super::running::SceneFacts;
use super::state::{Action, State};
use super::views::Split;
use ash::vk;
use candela::vulkan::Device;
use egui::{CollapsingHeader, Color32, Panel, ScrollArea, Ui};
use glam::UVec2;

/// What the panels tell.
pub struct Info<'a> {
    pub scene: &'a SceneFacts,
    pub device: &'a Device,
    pub readings: &'a Readings,
    pub facts: FrameFacts,
    pub mode: vk::PresentModeKHR,
    /// What is being loaded, what is being done for it, and for how many seconds.
    pub loading: Option<(String, &'static str, f32)>,
    /// The pixel that is being explained, and for how many seconds.
    pub explaining: Option<(UVec2, f32)>,
    pub answer: &'a mut Option<Answer>,
    pub notices: &'a mut Notices,
}

/// Lays everything out; what the user asks for goes to `state`, or to `actions` where that can't do it.
pub fn show(ui: &mut Ui, state: &mut State, info: &mut Info, actions: &mut Vec<Action>) {
    divider(ui, state);
    messages::show(ui, info);
    if state.panels {
        Panel::left("panel").resizable(false).exact_size(280.0).show(ui, |ui| {
            ui.spacing_mut().slider_width = 90.0;
            ScrollArea::vertical().show(ui, |ui| {
                section(ui, "Knobs", true, |ui| knobs::show(ui, state, actions));
                section(ui, "Picture", true, |ui| picture::show(ui, state, info, actions));
                if state.picked.is_some() {
                    section(ui, "Pixel", true, |ui| inspector::show(ui, state, info, actions));
                }
                if state.needs_reference() {
                    section(ui, "Error", true, |ui| error::show(ui, state, info));
                }
                section(ui, "Times", true, |ui| times::show(ui, info));
                if state.timeline.duration() > 0.0 {
                    section(ui, "Animation", true, |ui| animation::show(ui, state, actions));
                }
                section(ui, "Camera", false, |ui| camera::show(ui, state, actions));
            });
        });
    }
    explanation::show(ui, state, info, actions);
    if state.help {
        help::show(ui, state);
    }
}

fn section(ui: &mut Ui, name: &str, open: bool, content: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(name).default_open(open).show(ui, content);
}

/// The line between two sides; a drag moves it.
fn divider(ui: &Ui, state: &State) {
    if state.split != Split::Off {
        let window = ui.max_rect();
        let x = window.left() + state.divider * window.width();
        ui.painter().vline(x, window.y_range(), (1.0, Color32::from_white_alpha(160)));
    }
}
