//! What is shown, and how.

use crate::viewer::input::Command;
use crate::viewer::state::{Action, State};
use crate::viewer::views::{Split, View};
use egui::{ComboBox, Slider, Ui};

pub fn show(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    let mut commands = Vec::new();
    let mut view = state.view;
    ComboBox::from_label("View").selected_text(view.name()).show_ui(ui, |ui| {
        for &choice in View::ALL {
            ui.selectable_value(&mut view, choice, choice.name());
        }
    });
    if view != state.view {
        commands.push(Command::View(view));
    }
    let mut split = state.split;
    ComboBox::from_label("Split").selected_text(split.name()).show_ui(ui, |ui| {
        for choice in Split::ALL {
            ui.selectable_value(&mut split, choice, choice.name());
        }
    });
    if split != state.split {
        state.set_split(split);
    }
    if state.split != Split::Off {
        ui.add(Slider::new(&mut state.divider, 0.0..=1.0).text("Divider").show_value(false));
    }
    ui.add(Slider::new(&mut state.stops, -8.0..=8.0).step_by(0.5).text("Exposure, stops"));
    ui.horizontal(|ui| {
        if ui.checkbox(&mut state.accumulate, "Accumulate").on_hover_text("The mean of all frames").clicked()
        {
            state.restarts += 1;
        }
        if ui.button("Screenshot").on_hover_text("Picture, radiance and settings").clicked() {
            commands.push(Command::Screenshot);
        }
    });
    ui.horizontal(|ui| {
        for (name, command) in [
            ("Keys", Command::Help),
            ("Fullscreen", Command::Fullscreen),
            ("Present mode", Command::PresentMode),
        ] {
            if ui.button(name).clicked() {
                commands.push(command);
            }
        }
    });
    actions.extend(commands.into_iter().filter_map(|command| state.command(command)));
}
