//! The explanation of the picked pixel.

use super::Info;
use crate::input::Command;
use crate::state::{Action, State};
use egui::{Align2, RichText, ScrollArea, TextStyle, Ui, Window};

pub fn show(ui: &mut Ui, state: &mut State, info: &mut Info, actions: &mut Vec<Action>) {
    if let Some((pixel, seconds)) = info.explaining {
        let window = Window::new("Explaining").title_bar(false).anchor(Align2::CENTER_TOP, [0.0, 8.0]);
        window.resizable(false).show(ui.ctx(), |ui| {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label(format!("replaying pixel {} {} ({seconds:.0} s)", pixel.x, pixel.y));
            });
        });
    }
    let Some(answer) = info.answer else { return };
    let mut open = true;
    let title = format!("Pixel {} {}", answer.pixel.x, answer.pixel.y);
    // Beside the panel, over the lower part of the picture.
    let mut free = ui.available_rect_before_wrap().shrink(12.0);
    free.min.y += 0.4 * free.height();
    let window = Window::new(title).id(egui::Id::new("explanation")).open(&mut open);
    window.default_rect(free).constrain(true).show(ui.ctx(), |ui| {
        ui.horizontal(|ui| {
            if ui.button("Copy").clicked() {
                actions.extend(state.command(Command::CopyExplanation));
            }
            if ui.button("Again").on_hover_text("The picked pixel of the next frame (I)").clicked() {
                actions.extend(state.command(Command::Explain));
            }
        });
        let height = ui.text_style_height(&TextStyle::Monospace);
        let lines = &answer.lines;
        ScrollArea::both().auto_shrink(false).show_rows(ui, height, lines.len(), |ui, rows| {
            for line in &lines[rows] {
                ui.add(egui::Label::new(RichText::new(shown(line)).monospace()).extend());
            }
        });
    });
    if !open {
        *info.answer = None;
    }
}

/// The fonts have no p with a hat; columns keep their places.
fn shown(line: &str) -> String {
    line.replace("  p\u{302}", " p^").replace("p\u{302}", "p^")
}

#[cfg(test)]
mod tests {
    use super::shown;

    #[test]
    fn hats_are_shown_and_columns_stay() {
        let line = "      p\u{302}   w = p\u{302}/p";
        assert_eq!(shown(line), "     p^   w = p^/p");
    }
}
