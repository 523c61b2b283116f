//! The interface: one panel at the left with sections, messages at the bottom, the help over all.

mod camera;
mod error;
mod help;
mod inspector;
mod knobs;
mod messages;
mod picture;
mod times;

use super::app::SceneFacts;
use super::notices::Notices;
use super::probe::Probe;
use super::state::{Action, State};
use super::timings::Timings;
use super::views::Split;
use crate::vulkan::Device;
use ash::vk;
use egui::{CollapsingHeader, Color32, Panel, ScrollArea, Ui};

/// What the panels tell.
pub struct Info<'a> {
    pub scene: &'a SceneFacts,
    pub device: &'a Device,
    pub timings: &'a Timings,
    pub probe: Option<&'a Probe>,
    /// Of what is on screen, relative to the reference.
    pub error: Option<f64>,
    /// Frames in the mean, and whole sums in the reference's.
    pub counts: (u32, Option<u32>),
    pub mode: vk::PresentModeKHR,
    /// Device memory of the picture-sized buffers, bytes.
    pub picture_bytes: u64,
    /// What is being loaded, and for how many seconds.
    pub loading: Option<(String, f32)>,
    pub notices: &'a mut Notices,
}

/// Lays everything out; what the user asks for goes to `state`, or to `actions` where that can't do it.
pub fn show(ui: &mut Ui, state: &mut State, info: &mut Info, actions: &mut Vec<Action>) {
    divider(ui, state);
    messages::show(ui, info);
    if state.panels {
        Panel::left("panel").resizable(false).exact_size(270.0).show(ui, |ui| {
            ScrollArea::vertical().show(ui, |ui| {
                section(ui, "Knobs", true, |ui| knobs::show(ui, state, actions));
                section(ui, "Picture", true, |ui| picture::show(ui, state, info, actions));
                if state.needs_reference() {
                    section(ui, "Error", true, |ui| error::show(ui, state, info));
                }
                section(ui, "Times", true, |ui| times::show(ui, info));
                section(ui, "Camera", false, |ui| camera::show(ui, state, actions));
                if state.picked.is_some() {
                    section(ui, "Pixel", true, |ui| inspector::show(ui, state, info));
                }
            });
        });
    }
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
