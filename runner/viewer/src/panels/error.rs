//! The plot of error over time: the picture on screen, and the past of the mean.

use super::Info;
use crate::state::State;
use crate::trail::{Point, slope};
use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, Ui, Vec2};

/// Decades that the plot shows: ms, relative error.
const TIMES: [i32; 2] = [-1, 6];
const ERRORS: [i32; 2] = [-4, 1];
const POINT: Color32 = Color32::from_rgb(250, 200, 80);
const TRAIL: Color32 = Color32::from_rgb(90, 160, 220);

pub fn show(ui: &mut Ui, state: &State, info: &Info) {
    match info.facts.counts.1 {
        Some(0) | None => ui.label("reference: the first sum over all lights is not complete"),
        Some(count) => ui.label(format!("reference: mean of {count} sums over all lights")),
    };
    let readings = info.readings;
    let (Some(measured), Some(frame), true) = (readings.error, readings.timings.rendering(), state.error)
    else {
        return;
    };
    let error = measured.error;
    let about = "Root mean square difference of luminances over the reference's mean luminance";
    // A single frame stands at its own time, a mean at the time of all its frames.
    let ms = if measured.count == 0 { frame.median } else { readings.trail.total() };
    match measured.count {
        0 => ui.label(format!("{ms:.2} ms, relative RMSE {error:.4}")),
        count => ui.label(format!("{count} frames, {:.2} s, relative RMSE {error:.4}", ms / 1e3)),
    }
    .on_hover_text(about);
    plot(ui, readings.trail.points(), Point { ms, error });
    if let Some(slope) = slope(readings.trail.points()) {
        ui.weak(format!("error ~ time^{slope:.2}")).on_hover_text("Independent frames: -0.5");
    }
}

/// Both axes logarithmic: left is faster, down is nearer to the truth.
fn plot(ui: &mut Ui, trail: &[Point], now: Point) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(230.0, 120.0), Sense::hover());
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, Color32::from_gray(25));
    let (grid, small) = (Stroke::new(1.0, Color32::from_gray(55)), FontId::proportional(9.0));
    let gray = Color32::from_gray(140);
    for decade in TIMES[0]..=TIMES[1] {
        let x = place(rect, Point { ms: 10f64.powi(decade), error: 1.0 }).x;
        painter.vline(x, rect.y_range(), grid);
        let named = [(0, "1 ms"), (3, "1 s"), (5, "100 s")].into_iter().find(|(named, _)| *named == decade);
        if let Some((_, name)) = named {
            painter.text(Pos2::new(x + 2.0, rect.bottom()), Align2::LEFT_BOTTOM, name, small.clone(), gray);
        }
    }
    for decade in ERRORS[0]..=ERRORS[1] {
        let y = place(rect, Point { ms: 1.0, error: 10f64.powi(decade) }).y;
        painter.hline(rect.x_range(), y, grid);
        if (-3..1).contains(&decade) {
            let name = format!("{}", 10f64.powi(decade));
            painter.text(Pos2::new(rect.left() + 2.0, y), Align2::LEFT_BOTTOM, name, small.clone(), gray);
        }
    }
    let line: Vec<Pos2> = trail.iter().map(|&point| place(rect, point)).collect();
    painter.line(line, Stroke::new(1.5, TRAIL));
    painter.circle_filled(place(rect, now), 4.0, POINT);
    response.on_hover_text("Right: time of the device, 0.1 ms to 1000 s. Up: relative RMSE, 0.0001 to 10. A line a decade. The dot is the picture on screen; the line is the past of the mean (Accumulate).");
}

/// Where a point is drawn; what lies outside is drawn at the edge.
fn place(rect: Rect, point: Point) -> Pos2 {
    let along = |value: f64, [first, last]: [i32; 2]| {
        ((value.max(1e-9).log10() - f64::from(first)) / f64::from(last - first)).clamp(0.0, 1.0) as f32
    };
    rect.left_bottom()
        + Vec2::new(rect.width() * along(point.ms, TIMES), -rect.height() * along(point.error, ERRORS))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten times the time is a decade to the right, a tenth of the error a decade down.
    #[test]
    fn points_stand_on_logarithmic_axes() {
        let rect = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(70.0, 50.0));
        let near = |ms, error, x: f32, y: f32| {
            let at = place(rect, Point { ms, error });
            assert!((at - Pos2::new(x, y)).length() < 1e-3, "{at:?}");
        };
        near(0.1, 1e-4, 10.0, 70.0);
        near(1.0, 1e-3, 20.0, 60.0);
        near(1e6, 10.0, 80.0, 20.0);
        near(1e9, 0.0, 80.0, 70.0);
    }
}
