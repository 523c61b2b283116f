//! The scene's time.

use crate::input::Command;
use crate::state::{Action, State};
use candela::knobs::Step;
use egui::{Slider, Ui};

pub fn show(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    let mut commands = Vec::new();
    ui.horizontal(|ui| {
        let playing = state.timeline.playing;
        for (name, about, command) in [
            ("<", "1/24 s back (J)", Command::StepTime(Step::Down)),
            (if playing { "Pause" } else { "Play" }, "Space", Command::Play),
            (">", "1/24 s on (K)", Command::StepTime(Step::Up)),
        ] {
            if ui.button(name).on_hover_text(about).clicked() {
                commands.push(command);
            }
        }
        let time = state.timeline.time();
        ui.monospace(
            time.map_or("at rest".into(), |t| format!("{t:.2} of {:.2} s", state.timeline.duration())),
        );
    });
    let (duration, mut time) = (state.timeline.duration(), state.timeline.time().unwrap_or(0.0));
    if ui.add(Slider::new(&mut time, 0.0..=duration).text("s").show_value(false)).changed() {
        state.timeline.seek(time);
    }
    let speed = Slider::new(&mut state.timeline.speed, 0.05..=10.0).logarithmic(true);
    ui.add(speed.text("Speed")).on_hover_text("Seconds of the scene a second");
    if state.camera_moves() {
        let mut follow = state.follow;
        let about = "Follow the animated camera of the file; a drag ends it (Y)";
        if ui.checkbox(&mut follow, "Follow the file's camera").on_hover_text(about).changed() {
            commands.push(Command::Follow);
        }
    }
    actions.extend(commands.into_iter().filter_map(|command| state.command(command)));
}
