//! The camera: its place, its kind, and those of the file.

use crate::camera::Style;
use crate::input::Command;
use crate::state::{Action, State};
use egui::{ComboBox, Slider, Ui};

pub fn show(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.selectable_value(&mut state.rig.style, Style::Orbit, "Orbit");
        ui.selectable_value(&mut state.rig.style, Style::Fly, "Fly");
    });
    let mut chosen = state.chosen_camera();
    let before = chosen;
    let names: Vec<String> = state.cameras.iter().map(|camera| camera.name.clone()).collect();
    ComboBox::from_label("Scene's cameras").show_index(ui, &mut chosen, names.len(), |i| names[i].as_str());
    if chosen != before {
        state.look_through(chosen);
    }
    ui.add(Slider::new(&mut state.rig.speed, 0.01..=100.0).logarithmic(true).text("Speed"));
    let mut degrees = state.rig.fov_y.to_degrees();
    if ui.add(Slider::new(&mut degrees, 5.0..=120.0).text("Field of view, °")).changed() {
        state.rig.fov_y = degrees.to_radians();
    }
    let p = state.rig.origin + state.rig.position.as_dvec3();
    ui.label(format!("at {:.3}, {:.3}, {:.3} m", p.x, p.y, p.z));
    if ui.button("Copy as a command line").clicked() {
        actions.extend(state.command(Command::CopyCamera));
    }
}
