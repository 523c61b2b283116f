//! The picture: view, exposure, split, accumulation.

use super::Info;
use crate::input::Command;
use crate::state::{Action, State};
use crate::views::{Split, View};
use egui::{Color32, ComboBox, Sense, Slider, Ui, Vec2};
use shared::view;

pub fn show(ui: &mut Ui, state: &mut State, info: &Info, actions: &mut Vec<Action>) {
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
    legend(ui, state.view);
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
    ui.add(Slider::new(&mut state.stops, -8.0..=8.0).step_by(0.5).text("Stops"))
        .on_hover_text("Brighter or darker than the automatic exposure");
    ui.horizontal(|ui| {
        if ui.checkbox(&mut state.accumulate, "Accumulate").on_hover_text("The mean of all frames").clicked()
        {
            state.restarts += 1;
        }
        ui.checkbox(&mut state.denoise, "Denoise")
            .on_hover_text("And antialias: for the eye; errors are never those of what is shown so");
        if state.accumulate {
            ui.weak(format!("{} frames", info.facts.counts.0));
        }
    });
    ui.horizontal(|ui| {
        ui.checkbox(&mut state.error, "Live error").on_hover_text("Against the accumulating reference");
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

/// What the colors of `shown` mean; heat maps with their scale, by the shader's own functions.
fn legend(ui: &mut Ui, shown: View) {
    let text = shown.legend();
    if text.is_empty() {
        return;
    }
    let color: Option<fn(f32) -> glam::Vec3> = match shown {
        View::Difference => Some(|t| view::diverging(2.0 * t - 1.0)),
        View::Weight | View::Confidence | View::Believed => Some(view::heat),
        _ => None,
    };
    if let Some(color) = color {
        const STEPS: u8 = 64;
        let (rect, _) = ui.allocate_exact_size(Vec2::new(230.0, 10.0), Sense::hover());
        let width = rect.width() / f32::from(STEPS);
        for i in 0..STEPS {
            let c = color(f32::from(i) / f32::from(STEPS - 1)) * 255.0;
            let place = rect.min + egui::vec2(f32::from(i) * width, 0.0);
            let cell = egui::Rect::from_min_size(place, Vec2::new(width + 0.5, rect.height()));
            ui.painter().rect_filled(cell, 0.0, Color32::from_rgb(c.x as u8, c.y as u8, c.z as u8));
        }
    }
    ui.weak(text);
}
