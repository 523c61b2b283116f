//! Presets and every knob, with what it means.

use crate::input::Command;
use crate::presets::Preset;
use crate::state::{Action, State};
use crate::views::Split;
use candela::knobs::{self, Knob, Step};
use egui::{Color32, Grid, RichText, Ui};

pub fn show(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    let mut commands = Vec::new();
    ui.horizontal_wrapped(|ui| {
        for preset in Preset::ALL {
            if ui.button(preset.name()).on_hover_text(preset.about()).clicked() {
                commands.push(Command::Preset(preset));
            }
        }
        if ui.button("Reset").on_hover_text("Reset all knobs").clicked() {
            commands.push(Command::Reset);
        }
    });
    if state.split == Split::Settings {
        ui.horizontal(|ui| {
            ui.selectable_value(&mut state.side, 0, "Left side");
            ui.selectable_value(&mut state.side, 1, "Right side");
        });
    }
    Grid::new("knobs").num_columns(2).striped(true).show(ui, |ui| {
        for (i, knob) in knobs::ALL.iter().enumerate() {
            row(ui, knob, i == state.selected, state, &mut commands);
            ui.end_row();
        }
    });
    actions.extend(commands.into_iter().filter_map(|command| state.command(command)));
}

fn row(ui: &mut Ui, knob: &'static Knob, selected: bool, state: &State, commands: &mut Vec<Command>) {
    let name = RichText::new(knob.label);
    let name = if selected { name.color(Color32::LIGHT_BLUE) } else { name };
    ui.label(name).on_hover_ui(|ui| {
        ui.strong(knob.label);
        ui.label(knob.about);
        for (what, text) in
            [("Values", &*knob.values()), ("Higher", knob.higher), ("Lower", knob.lower), ("Bias", knob.bias)]
        {
            ui.label(format!("{what}: {text}"));
        }
    });
    let value = knob.shown(knob.value(&state.settings[state.side]));
    ui.horizontal(|ui| {
        if knob.is_switch() {
            if ui.button(value).clicked() {
                commands.push(Command::Toggle(knob));
            }
            return;
        }
        if ui.small_button("-").clicked() {
            commands.push(Command::Step(knob, Step::Down));
        }
        ui.monospace(value);
        if ui.small_button("+").clicked() {
            commands.push(Command::Step(knob, Step::Up));
        }
    });
}
