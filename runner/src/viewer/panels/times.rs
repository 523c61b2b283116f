//! Where the time of a frame goes, and the memory.

use super::Info;
use crate::viewer::timings::Summary;
use egui::{Color32, Grid, Sense, Ui, Vec2};

pub fn show(ui: &mut Ui, info: &Info) {
    ui.label(format!("{} ({:?})", info.device.info().name, info.mode));
    let timings = &info.readings.timings;
    match timings.frame() {
        None => {
            ui.label("No times: none yet, or this device has no clock.");
        }
        Some(frame) => {
            Grid::new("times").num_columns(4).show(ui, |ui| {
                for heading in ["ms", "median", "95 %", ""] {
                    ui.weak(heading);
                }
                ui.end_row();
                for pass in timings.passes().iter().chain([&frame]) {
                    row(ui, pass, frame.median);
                    ui.end_row();
                }
            });
        }
    }
    rays(ui, info, timings.frame());
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    ui.label(format!(
        "memory: {:.1} MiB, {:.1} of them the picture's",
        mib(info.device.memory_used()),
        mib(info.facts.picture_bytes)
    ));
    let scene = info.scene;
    ui.label(format!("{}: {} triangles, {} lights", scene.name, scene.triangles, scene.lights));
}

/// Of the left side; see [`crate::frame::rays`] for why the most is told.
fn rays(ui: &mut Ui, info: &Info, frame: Option<Summary>) {
    let (a_pixel, a_frame) = info.facts.rays;
    let a_second = match frame {
        Some(frame) if frame.median > 0.0 => {
            format!(", {} a second", thousands(1e3 * a_frame as f64 / frame.median))
        }
        _ => String::new(),
    };
    ui.label(format!("at most {a_pixel} rays a pixel, {} a frame{a_second}", thousands(a_frame as f64)))
        .on_hover_text(
            "What the settings allow. Fewer are traced where nothing is hit, or where a sample's visibility is known.",
        );
}

/// Three digits with k, M or G.
fn thousands(x: f64) -> String {
    let (scaled, unit) = match x {
        1e9.. => (x / 1e9, " G"),
        1e6.. => (x / 1e6, " M"),
        1e3.. => (x / 1e3, " k"),
        _ => (x, ""),
    };
    let digits = if scaled < 10.0 { 2 } else { usize::from(scaled < 100.0) };
    format!("{scaled:.digits$}{unit}")
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

#[cfg(test)]
mod tests {
    use super::thousands;

    #[test]
    fn numbers_of_rays_have_three_digits() {
        let all = [7.0, 2_764_800.0, 999e6, 1.25e9, 48e3].map(thousands);
        assert_eq!(all, ["7.00", "2.76 M", "999 M", "1.25 G", "48.0 k"]);
    }
}
