//! The picked pixel: its surface, its reservoirs, its light.

use super::Info;
use crate::input::Command;
use crate::state::{Action, State};
use egui::Ui;
use glam::Vec3;

pub fn show(ui: &mut Ui, state: &mut State, info: &Info, actions: &mut Vec<Action>) {
    let Some(pixel) = state.picked else { return };
    ui.horizontal(|ui| {
        ui.label(format!("pixel {}, {}", pixel.x, pixel.y));
        let explain =
            ui.small_button("explain").on_hover_text("Replay this pixel of the next frame on the CPU (I)");
        if explain.clicked() {
            actions.extend(state.command(Command::Explain));
        }
        if ui.small_button("close").clicked() {
            state.picked = None;
        }
    });
    let Some(probe) = &info.readings.probe else { return };
    let rgb = |v: Vec3| format!("{:.4} {:.4} {:.4}", v.x, v.y, v.z);
    let mut lines = vec![("radiance, nit", rgb(probe.radiance))];
    match &probe.surface {
        None => lines.push(("surface", "none that is lit".into())),
        Some(surface) => lines.extend([
            ("position, m", rgb(surface.position)),
            ("distance, m", format!("{:.4}", surface.distance)),
            ("normal", rgb(surface.normal)),
            ("diffuse", rgb(surface.reflectance.diffuse)),
            ("f0", rgb(surface.reflectance.f0)),
            ("roughness", format!("{:.4}", surface.reflectance.roughness)),
            ("instance", probe.instance.to_string()),
        ]),
    }
    for reservoir in &probe.reservoirs {
        let (w, m) = (reservoir.contribution_weight, reservoir.confidence);
        let light = if w > 0.0 { format!("light {}", reservoir.sample.light) } else { "no light".into() };
        lines.push(("reservoir", format!("{light}, W {w:.4e}, M {m:.0}")));
    }
    for (name, value) in lines {
        ui.horizontal_wrapped(|ui| {
            ui.weak(name);
            ui.monospace(value);
        });
    }
}
