//! User input, independent of the window system, and the meaning of each key.

use super::presets::Preset;
use super::views::View;
use candela::knobs::{self, Knob, Step};
use glam::Vec2;
use std::path::PathBuf;

pub use winit::keyboard::KeyCode;

#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    Key {
        key: KeyCode,
        pressed: bool,
    },
    /// Pixels from the window's upper left corner.
    Cursor(Vec2),
    Button {
        button: Button,
        pressed: bool,
    },
    /// Notches of the wheel, or what a touchpad makes of two fingers; away from the user is positive.
    Scroll(f32),
    /// Relative change of two fingers' distance.
    Pinch(f32),
    /// The display's density has changed: pixels a point.
    Scale(f32),
    /// The window has lost the keyboard: no key is held any more.
    Unfocused,
    Dropped(PathBuf),
    Command(Command),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    Left,
    Middle,
    Right,
}

/// What keys and panels can ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    Step(&'static Knob, Step),
    /// A knob's other value, or its next one.
    Toggle(&'static Knob),
    /// Chooses a knob for the arrow keys.
    SelectKnob(Step),
    StepSelected(Step),
    Preset(Preset),
    Reset,
    Accumulate,
    Denoise,
    Restart,
    View(View),
    NextView(Step),
    Split,
    /// Which of the two settings the knobs change.
    OtherSide,
    Error,
    Exposure(Step),
    AutoExposure,
    OrbitOrFly,
    NextCamera(Step),
    Focus,
    /// Play or pause the scene's animations.
    Play,
    StepTime(Step),
    /// Go where the chosen camera of the file goes.
    Follow,
    /// Replay the picked pixel.
    Explain,
    CopyExplanation,
    CopyCamera,
    Screenshot,
    Fullscreen,
    PresentMode,
    Panels,
    Help,
    Quit,
}

/// A key with its help; `shift` where the key alone means something else.
pub struct Binding {
    pub key: KeyCode,
    pub shift: bool,
    pub shown: &'static str,
    pub help: &'static str,
    pub command: Command,
}

const fn bind(
    key: KeyCode,
    shift: bool,
    shown: &'static str,
    help: &'static str,
    command: Command,
) -> Binding {
    Binding { key, shift, shown, help, command }
}

/// All keys but those held to fly.
pub const BINDINGS: &[Binding] = &[
    bind(
        KeyCode::Comma,
        false,
        ",",
        "light samples halved",
        Command::Step(&knobs::by_name::candidates, Step::Down),
    ),
    bind(
        KeyCode::Period,
        false,
        ".",
        "light samples doubled",
        Command::Step(&knobs::by_name::candidates, Step::Up),
    ),
    bind(KeyCode::KeyV, false, "V", "visibility reuse", Command::Toggle(&knobs::by_name::visibility)),
    bind(KeyCode::KeyT, false, "T", "temporal reuse", Command::Toggle(&knobs::by_name::temporal)),
    bind(KeyCode::KeyR, false, "R", "spatial reuse", Command::Toggle(&knobs::by_name::spatial)),
    bind(KeyCode::KeyU, false, "U", "biased or unbiased", Command::Toggle(&knobs::by_name::mode)),
    bind(
        KeyCode::BracketLeft,
        false,
        "[",
        "one spatial iteration less",
        Command::Step(&knobs::by_name::iterations, Step::Down),
    ),
    bind(
        KeyCode::BracketRight,
        false,
        "]",
        "one spatial iteration more",
        Command::Step(&knobs::by_name::iterations, Step::Up),
    ),
    bind(KeyCode::KeyN, false, "N", "one neighbor more", Command::Step(&knobs::by_name::neighbors, Step::Up)),
    bind(
        KeyCode::KeyN,
        true,
        "Shift N",
        "one neighbor less",
        Command::Step(&knobs::by_name::neighbors, Step::Down),
    ),
    bind(KeyCode::ArrowUp, false, "Up", "the knob above", Command::SelectKnob(Step::Down)),
    bind(KeyCode::ArrowDown, false, "Down", "the knob below", Command::SelectKnob(Step::Up)),
    bind(KeyCode::ArrowLeft, false, "Left", "less of the chosen knob", Command::StepSelected(Step::Down)),
    bind(KeyCode::ArrowRight, false, "Right", "more of the chosen knob", Command::StepSelected(Step::Up)),
    bind(KeyCode::Digit1, false, "1", "preset Fast", Command::Preset(Preset::Fast)),
    bind(KeyCode::Digit2, false, "2", "preset Thesis", Command::Preset(Preset::Thesis)),
    bind(KeyCode::Digit3, false, "3", "preset Unbiased", Command::Preset(Preset::Unbiased)),
    bind(KeyCode::Digit4, false, "4", "preset Reference", Command::Preset(Preset::Reference)),
    bind(KeyCode::Backspace, false, "Backspace", "reset all knobs", Command::Reset),
    bind(KeyCode::KeyP, false, "P", "accumulate frames", Command::Accumulate),
    bind(KeyCode::KeyM, false, "M", "denoise and antialias what is shown", Command::Denoise),
    bind(KeyCode::KeyP, true, "Shift P", "start again", Command::Restart),
    bind(KeyCode::KeyG, false, "G", "next view", Command::NextView(Step::Up)),
    bind(KeyCode::KeyG, true, "Shift G", "view before", Command::NextView(Step::Down)),
    bind(KeyCode::KeyB, false, "B", "split: off, two settings, reference", Command::Split),
    bind(KeyCode::KeyL, false, "L", "knobs of the left or the right side", Command::OtherSide),
    bind(KeyCode::KeyX, false, "X", "live error against the reference", Command::Error),
    bind(KeyCode::Equal, false, "=", "half a stop brighter", Command::Exposure(Step::Up)),
    bind(KeyCode::Minus, false, "-", "half a stop darker", Command::Exposure(Step::Down)),
    bind(KeyCode::Digit0, false, "0", "exposure by itself", Command::AutoExposure),
    bind(KeyCode::KeyO, false, "O", "orbit or fly", Command::OrbitOrFly),
    bind(KeyCode::KeyC, false, "C", "next camera of the scene", Command::NextCamera(Step::Up)),
    bind(KeyCode::KeyC, true, "Shift C", "copy the camera as a command line", Command::CopyCamera),
    bind(KeyCode::KeyF, false, "F", "go to the clicked point", Command::Focus),
    bind(KeyCode::KeyI, false, "I", "explain the clicked pixel", Command::Explain),
    bind(KeyCode::Space, false, "Space", "play or pause", Command::Play),
    bind(KeyCode::KeyJ, false, "J", "1/24 s back", Command::StepTime(Step::Down)),
    bind(KeyCode::KeyK, false, "K", "1/24 s on", Command::StepTime(Step::Up)),
    bind(KeyCode::KeyY, false, "Y", "follow the file's camera", Command::Follow),
    bind(KeyCode::F12, false, "F12", "save picture, radiance and settings", Command::Screenshot),
    bind(KeyCode::F11, false, "F11", "fullscreen", Command::Fullscreen),
    bind(KeyCode::F10, false, "F10", "next present mode", Command::PresentMode),
    bind(KeyCode::KeyH, false, "H", "panels on or off", Command::Panels),
    bind(KeyCode::F1, false, "F1", "this help", Command::Help),
    bind(KeyCode::Escape, false, "Esc", "close", Command::Quit),
];

/// What has no key of its own.
pub const MOUSE_HELP: &[(&str, &str)] = &[
    ("W A S D, Q E", "fly; Shift faster, Ctrl slower"),
    ("drag", "orbit, or look around when flying"),
    ("right or middle drag", "move across"),
    ("wheel, two fingers, pinch", "nearer; faster when flying"),
    ("click", "inspect the pixel; orbits go around that point"),
    ("drop a file", ".glb or .gltf: another scene; .hdr, .exr or a picture: another sky"),
];

/// The command of a key that is pressed.
pub fn command(key: KeyCode, shift: bool) -> Option<Command> {
    let of = |shift| BINDINGS.iter().find(|b| b.key == key && b.shift == shift);
    of(shift).or_else(|| of(false)).map(|binding| binding.command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_means_two_things() {
        for (i, a) in BINDINGS.iter().enumerate() {
            assert!(
                BINDINGS[..i].iter().all(|b| (a.key, a.shift) != (b.key, b.shift)),
                "{} has two meanings",
                a.shown
            );
            let flies = [KeyCode::KeyW, KeyCode::KeyA, KeyCode::KeyS, KeyCode::KeyD, KeyCode::KeyQ];
            assert!(!flies.contains(&a.key) && a.key != KeyCode::KeyE);
        }
    }

    #[test]
    fn shift_makes_another_key_only_where_it_is_bound() {
        assert_eq!(command(KeyCode::KeyC, true), Some(Command::CopyCamera));
        assert_eq!(command(KeyCode::KeyC, false), Some(Command::NextCamera(Step::Up)));
        assert_eq!(command(KeyCode::KeyV, true), Some(Command::Toggle(&knobs::by_name::visibility)));
        assert_eq!(command(KeyCode::KeyW, false), None);
    }
}
