//! All keys in one place.

use crate::input::{BINDINGS, MOUSE_HELP};
use crate::state::State;
use egui::{Align2, Grid, RichText, ScrollArea, Ui, Window};

/// Pairs of key and meaning side by side.
const COLUMNS: usize = 3;
/// What the table takes at most, and what the window's frame takes, points.
const TABLE: egui::Vec2 = egui::Vec2::new(720.0, 460.0);
const FRAME: egui::Vec2 = egui::Vec2::new(32.0, 72.0);

pub fn show(ui: &mut Ui, state: &mut State) {
    let most = (ui.ctx().viewport_rect().size() - FRAME).min(TABLE);
    let window = Window::new("Keys").open(&mut state.help).anchor(Align2::CENTER_CENTER, [0.0, 0.0]);
    window.collapsible(false).resizable(false).default_size(most).show(ui.ctx(), |ui| {
        ScrollArea::both().max_width(most.x).max_height(most.y).show(ui, |ui| {
            table(ui, "mouse", MOUSE_HELP, 1);
            ui.separator();
            let keys: Vec<_> = BINDINGS.iter().map(|binding| (binding.shown, binding.help)).collect();
            table(ui, "keys", &keys, COLUMNS);
        });
    });
}

/// Down the first column, then down the next.
fn table(ui: &mut Ui, id: &str, entries: &[(&str, &str)], columns: usize) {
    let rows = entries.len().div_ceil(columns);
    Grid::new(id).num_columns(2 * columns).striped(true).spacing([10.0, 1.0]).show(ui, |ui| {
        for row in 0..rows {
            for (key, help) in entries.iter().skip(row).step_by(rows) {
                ui.label(RichText::new(*key).monospace().size(11.0));
                ui.label(RichText::new(*help).size(11.5));
            }
            ui.end_row();
        }
    });
}
