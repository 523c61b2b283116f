//! The point of speed against error that is on screen.

use super::Info;
use crate::viewer::state::State;
use egui::{Color32, Sense, Stroke, Ui, Vec2};

/// Decades that the plot shows: ms a frame, relative error.
const TIMES: [f64; 2] = [-1.0, 4.0];
const ERRORS: [f64; 2] = [-3.0, 1.0];

pub fn show(ui: &mut Ui, state: &State, info: &Info) {
    match info.counts.1 {
        Some(0) | None => ui.label("reference: the first sum over all lights is not complete"),
        Some(count) => ui.label(format!("reference: mean of {count} sums over all lights")),
    };
    if !state.error {
        return;
    }
    let (Some(error), Some(frame)) = (info.error, info.timings.frame()) else { return };
    ui.label(format!("{:.2} ms, relative RMSE {error:.4}", frame.median))
        .on_hover_text("Root mean square difference of luminances over the reference's mean luminance");
    plot(ui, frame.median, error);
}

/// Both axes logarithmic: left is faster, down is nearer to the truth.
fn plot(ui: &mut Ui, ms: f64, error: f64) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(230.0, 110.0), Sense::hover());
    let place = |value: f64, range: [f64; 2]| {
        ((value.max(1e-9).log10() - range[0]) / (range[1] - range[0])).clamp(0.0, 1.0) as f32
    };
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, Color32::from_gray(25));
    let grid = Stroke::new(1.0, Color32::from_gray(55));
    for decade in TIMES[0] as i32..=TIMES[1] as i32 {
        let x = rect.left() + rect.width() * place(10f64.powi(decade), TIMES);
        painter.vline(x, rect.y_range(), grid);
    }
    for decade in ERRORS[0] as i32..=ERRORS[1] as i32 {
        let y = rect.bottom() - rect.height() * place(10f64.powi(decade), ERRORS);
        painter.hline(rect.x_range(), y, grid);
    }
    let x = rect.left() + rect.width() * place(ms, TIMES);
    let y = rect.bottom() - rect.height() * place(error, ERRORS);
    painter.circle_filled(egui::pos2(x, y), 4.0, Color32::from_rgb(250, 200, 80));
    response.on_hover_text("Right: 0.1 ms to 10 s a frame. Up: error 0.001 to 10. A line a decade.");
}
