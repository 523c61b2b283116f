//! Messages and the progress of loading.

use super::Info;
use egui::{Color32, Panel, RichText, Ui};

pub fn show(ui: &mut Ui, info: &mut Info) {
    let loading = info.loading.clone();
    let notices = info.notices.current();
    if notices.is_empty() && loading.is_none() {
        return;
    }
    let mut closed = None;
    Panel::bottom("messages").show(ui, |ui| {
        if let Some((what, stage, seconds)) = loading {
            ui.horizontal_wrapped(|ui| {
                ui.spinner();
                ui.label(format!("loading {what}: {stage} ({seconds:.0} s)"));
            });
        }
        for (i, notice) in notices.iter().enumerate() {
            ui.horizontal_wrapped(|ui| {
                if ui.small_button("x").clicked() {
                    closed = Some(i);
                }
                let text = RichText::new(&notice.text);
                let color = if notice.is_error { Color32::LIGHT_RED } else { Color32::LIGHT_GRAY };
                ui.label(text.color(color));
            });
        }
    });
    if let Some(index) = closed {
        info.notices.close(index);
    }
}
