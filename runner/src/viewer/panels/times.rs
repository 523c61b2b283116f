//! Where the time of a frame goes, and the memory.

use super::Info;
use crate::viewer::timings::Summary;
use egui::{Color32, Grid, Sense, Ui, Vec2};

pub fn show(ui: &mut Ui, info: &Info) {
    ui.label(format!("{} ({:?})", info.device.info().name, info.mode));
    match info.timings.frame() {
        None => {
            ui.label("No times: none yet, or this device has no clock.");
        }
        Some(frame) => {
            Grid::new("times").num_columns(4).show(ui, |ui| {
                for heading in ["ms", "median", "95 %", ""] {
                    ui.weak(heading);
                }
                ui.end_row();
                for pass in info.timings.passes().iter().chain([&frame]) {
                    row(ui, pass, frame.median);
                    ui.end_row();
                }
            });
        }
    }
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    ui.label(format!(
        "memory: {:.1} MiB, {:.1} of them the picture's",
        mib(info.device.memory_used()),
        mib(info.picture_bytes)
    ));
    let scene = info.scene;
    ui.label(format!("{}: {} triangles, {} lights", scene.name, scene.triangles, scene.lights));
}

fn row(ui: &mut Ui, pass: &Summary, frame: f64) {
    ui.label(pass.stem);
    ui.monospace(format!("{:.2}", pass.median));
    ui.monospace(format!("{:.2}", pass.p95));
    // The pass's part of the frame.
    let (rect, _) = ui.allocate_exact_size(Vec2::new(70.0, 10.0), Sense::hover());
    let part = if frame > 0.0 { (pass.median / frame).clamp(0.0, 1.0) as f32 } else { 0.0 };
    let bar = egui::Rect::from_min_size(rect.min, Vec2::new(rect.width() * part, rect.height()));
    ui.painter().rect_filled(rect, 1.0, Color32::from_gray(50));
    ui.painter().rect_filled(bar, 1.0, Color32::from_rgb(90, 160, 220));
}
