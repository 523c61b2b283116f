//! GPU times of the passes, and memory.

use super::Info;
use crate::timings::Summary;
use egui::{Align2, Color32, FontId, Rect, Sense, TextStyle, Ui, Vec2};

pub fn show(ui: &mut Ui, info: &Info) {
    ui.label(format!("{} ({:?})", info.device.info().name, info.mode));
    let timings = &info.readings.timings;
    match timings.frame() {
        None => {
            ui.label("No times yet, or this device has no timestamps.");
        }
        Some(frame) => {
            row(ui, ["ms", "median", "95 %"].map(String::from), 0.0);
            for pass in timings.passes().iter().chain([&frame]) {
                let part = if frame.median > 0.0 { pass.median / frame.median } else { 0.0 };
                let times = [pass.median, pass.p95].map(milliseconds);
                let [median, p95] = times;
                row(ui, [pass.stem.into(), median, p95], part as f32);
            }
        }
    }
    rays(ui, info, timings.rendering());
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    ui.label(format!(
        "memory: {:.1} MiB, {:.1} of them the picture's",
        mib(info.device.memory_used()),
        mib(info.facts.picture_bytes)
    ));
    let scene = info.scene;
    ui.label(format!("{}: {} triangles, {} lights", scene.name, scene.triangles, scene.lights));
}

/// Of the left side; see [`candela::frame::rays`] for why the most is told.
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
            "An upper bound by the settings. Fewer are traced where nothing is hit, or where visibility is known.",
        );
}

/// To a hundredth of a millisecond, but with no more digits than a column holds.
fn milliseconds(ms: f64) -> String {
    let digits = if ms < 100.0 { 2 } else { usize::from(ms < 1000.0) };
    format!("{ms:.digits$}")
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

/// Name and two times, over a bar: the part of the frame.
fn row(ui: &mut Ui, [name, median, p95]: [String; 3], part: f32) {
    let height = ui.text_style_height(&TextStyle::Body);
    let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), height), Sense::hover());
    let bar = Rect::from_min_size(rect.min, Vec2::new(rect.width() * part.clamp(0.0, 1.0), height));
    let (painter, color) = (ui.painter(), ui.visuals().text_color());
    painter.rect_filled(bar, 1.0, Color32::from_rgb(35, 70, 105));
    // The longest stem fits beside the times.
    let font = FontId::proportional(11.5);
    painter.text(rect.left_center(), Align2::LEFT_CENTER, name, font, color);
    let font = TextStyle::Monospace.resolve(ui.style());
    for (text, from_right) in [(median, 50.0), (p95, 0.0)] {
        let place = rect.right_center() - Vec2::new(from_right, 0.0);
        painter.text(place, Align2::RIGHT_CENTER, text, font.clone(), color);
    }
}

#[cfg(test)]
mod tests {
    use super::{milliseconds, thousands};

    #[test]
    fn times_fit_their_columns() {
        let all = [0.054, 12.345, 123.45, 11620.7].map(milliseconds);
        assert_eq!(all, ["0.05", "12.35", "123.5", "11621"]);
    }

    #[test]
    fn numbers_of_rays_have_three_digits() {
        let all = [7.0, 2_764_800.0, 999e6, 1.25e9, 48e3].map(thousands);
        assert_eq!(all, ["7.00", "2.76 M", "999 M", "1.25 G", "48.0 k"]);
    }
}
