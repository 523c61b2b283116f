//! All keys in one place.

use crate::viewer::input::{BINDINGS, MOUSE_HELP};
use crate::viewer::state::State;
use egui::{Align2, Grid, ScrollArea, Ui, Window};

pub fn show(ui: &mut Ui, state: &mut State) {
    let window = Window::new("Keys").open(&mut state.help).anchor(Align2::CENTER_CENTER, [0.0, 0.0]);
    window.collapsible(false).default_width(620.0).show(ui.ctx(), |ui| {
        ScrollArea::both().show(ui, |ui| {
            let keys = BINDINGS.iter().map(|binding| (binding.shown, binding.help));
            let entries: Vec<_> = MOUSE_HELP.iter().copied().chain(keys).collect();
            Grid::new("keys").num_columns(4).striped(true).show(ui, |ui| {
                let rows = entries.len().div_ceil(2);
                for i in 0..rows {
                    for (key, help) in [Some(&entries[i]), entries.get(i + rows)].into_iter().flatten() {
                        ui.monospace(*key);
                        ui.label(*help);
                    }
                    ui.end_row();
                }
            });
        });
    });
}
