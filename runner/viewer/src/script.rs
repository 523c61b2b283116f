//! A viewer that plays itself, for tests: one command a line, counted in frames.
//!
//! ```text
//! frames N             let N frames pass
//! key NAME [NAME]      press and release (winit's key names: KeyV, F12, ShiftLeft KeyN)
//! click X Y            with the left button, pixels
//! drag BUTTON X Y X Y  left, middle or right, from and to
//! scroll NOTCHES
//! knobs                every knob to its other value, a frame each
//! resize W H           ask for another window size
//! scale F              as if the display's density had changed
//! minimise             as if the window had no area
//! drop FILE            as if dropped on the window
//! loaded               wait until nothing is being loaded or explained
//! expect WHAT TEXT     scene, source, error, size, ... (`running/checks.rs`); an empty TEXT is nothing at all
//! await WHAT TEXT      let frames pass until it is so
//! say TEXT             a line on standard output
//! save DIRECTORY       a screenshot
//! fail lost|memory     as if the device had failed so
//! fail upload          the next scene's upload runs out of memory
//! close
//! ```

use super::input::{Button, Command, Input, KeyCode};
use candela::error::{Error, Left, Result};
use candela::{files, knobs};
use glam::{UVec2, Vec2};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};

#[derive(Debug)]
pub enum Event {
    Input(Input),
    Resize(UVec2),
    Scale(f32),
    Minimise,
    Say(String),
    Expect(String),
    Await(String),
    Save(PathBuf),
    FailUpload(Error),
    Fail(Error),
    /// The window, whatever else is open in it: Escape closes the help first.
    Close,
}

#[derive(Debug)]
enum Line {
    Event(Event),
    Frames(u32),
    Loaded,
}

/// The lines that are left; none for a viewer that a person uses.
#[derive(Debug, Default)]
pub struct Script {
    lines: VecDeque<Line>,
    /// Frames to pass before the next line.
    wait: u32,
    /// Frames that have passed for an `await`.
    patience: u32,
}

/// Frames that an `await` may take.
const MOST: u32 = 100_000;

impl Script {
    pub fn read(path: &Path) -> Result<Script> {
        Script::parse(&files::read_text(path)?).map_err(Error::input(path))
    }

    fn parse(text: &str) -> Result<Script, String> {
        let mut lines = VecDeque::new();
        for (number, line) in text.lines().enumerate() {
            let words: Vec<&str> = line.split_whitespace().collect();
            if words.is_empty() || words[0].starts_with('#') {
                continue;
            }
            let parsed = parse_line(&words).ok_or(format!("line {}: can't read '{line}'", number + 1))?;
            lines.extend(parsed);
        }
        Ok(Script { lines, ..Script::default() })
    }

    /// The next thing to do before this frame, if any. `busy`: something is being loaded.
    pub fn next(&mut self, busy: bool) -> Option<Event> {
        while self.wait == 0 {
            if busy && matches!(self.lines.front(), Some(Line::Loaded)) {
                return None;
            }
            match self.lines.pop_front()? {
                Line::Event(event) => return Some(event),
                Line::Frames(count) => self.wait = count,
                Line::Loaded => {}
            }
        }
        None
    }

    /// It was too early for `event`: once more after the next frame.
    pub fn again(&mut self, event: Event) -> Result<()> {
        self.patience += 1;
        if self.patience > MOST {
            return Err(Error::Check(format!("script: {event:?} had no effect")));
        }
        self.lines.push_front(Line::Event(event));
        self.wait = 1;
        Ok(())
    }

    /// A frame has been shown.
    pub fn frame_done(&mut self) {
        self.wait = self.wait.saturating_sub(1);
    }
}

fn parse_line(words: &[&str]) -> Option<Vec<Line>> {
    let number = |i: usize| words.get(i)?.parse::<f32>().ok();
    let point = |i: usize| Some(Vec2::new(number(i)?, number(i + 1)?));
    let rest = words[1..].join(" ");
    let one = |event| Some(vec![Line::Event(event)]);
    let inputs =
        |inputs: Vec<Input>| Some(inputs.into_iter().map(|i| Line::Event(Event::Input(i))).collect());
    match words[0] {
        "frames" => Some(vec![Line::Frames(rest.parse().ok()?)]),
        "loaded" => Some(vec![Line::Loaded]),
        "key" => inputs(keys(&words[1..])?),
        "click" => inputs(dragged(Button::Left, point(1)?, point(1)?)),
        "drag" => inputs(dragged(button(words.get(1)?)?, point(2)?, point(4)?)),
        "scroll" => inputs(vec![Input::Scroll(number(1)?)]),
        "knobs" => Some(
            knobs::ALL
                .iter()
                .flat_map(|knob| {
                    let toggle = Input::Command(Command::Toggle(knob));
                    [Line::Event(Event::Input(toggle)), Line::Frames(1)]
                })
                .collect(),
        ),
        "resize" => one(Event::Resize(point(1)?.as_uvec2())),
        "drop" => inputs(vec![Input::Dropped(rest.into())]),
        "scale" => one(Event::Scale(number(1)?)),
        "minimise" => one(Event::Minimise),
        "say" => one(Event::Say(rest)),
        "await" => one(Event::Await(rest)),
        "expect" => one(Event::Expect(rest)),
        "save" => one(Event::Save(rest.into())),
        "fail" => one(match rest.as_str() {
            "lost" => Event::Fail(Error::DeviceLost("frame".into())),
            "memory" => Event::Fail(out_of_memory("buffer 'radiance'")),
            "upload" => Event::FailUpload(out_of_memory("acceleration structures")),
            _ => return None,
        }),
        "close" => one(Event::Close),
        _ => None,
    }
}

fn out_of_memory(what: &str) -> Error {
    Error::OutOfMemory { what: what.into(), bytes: 1, device: "the GPU", left: Left::Less }
}

/// Pressed in this order, released in the other.
fn keys(names: &[&str]) -> Option<Vec<Input>> {
    let keys: Vec<KeyCode> = names.iter().map(|name| key(name)).collect::<Option<_>>()?;
    let down = keys.iter().map(|&key| Input::Key { key, pressed: true });
    let up = keys.iter().rev().map(|&key| Input::Key { key, pressed: false });
    Some(down.chain(up).collect())
}

/// Keys that mean something, by winit's names.
fn key(name: &str) -> Option<KeyCode> {
    let bound = super::input::BINDINGS.iter().map(|binding| binding.key);
    let others = [
        KeyCode::ShiftLeft,
        KeyCode::ControlLeft,
        KeyCode::KeyW,
        KeyCode::KeyA,
        KeyCode::KeyS,
        KeyCode::KeyD,
        KeyCode::KeyQ,
        KeyCode::KeyE,
    ];
    bound.chain(others).find(|key| format!("{key:?}") == name)
}

fn button(name: &str) -> Option<Button> {
    Some(match name {
        "left" => Button::Left,
        "middle" => Button::Middle,
        "right" => Button::Right,
        _ => return None,
    })
}

fn dragged(button: Button, from: Vec2, to: Vec2) -> Vec<Input> {
    vec![
        Input::Cursor(from),
        Input::Button { button, pressed: true },
        Input::Cursor(to),
        Input::Button { button, pressed: false },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_wait_for_frames_and_loading() {
        let mut script = Script::parse("# a test\nkey ShiftLeft KeyN\n\nframes 2\nloaded\nclose\n").unwrap();
        let pressed: Vec<_> = (0..4).map(|_| script.next(false).unwrap()).collect();
        assert!(matches!(&pressed[1], Event::Input(Input::Key { key: KeyCode::KeyN, pressed: true })));
        assert!(matches!(&pressed[3], Event::Input(Input::Key { key: KeyCode::ShiftLeft, pressed: false })));
        for busy in [false, false, true, true, false] {
            let next = script.next(busy);
            script.frame_done();
            assert_eq!(next.is_some(), script.lines.is_empty(), "{next:?}");
        }
    }

    #[test]
    fn what_is_awaited_comes_after_frames() {
        let mut script = Script::parse("await scale 2\nclose\n").unwrap();
        for _ in 0..3 {
            let event = script.next(false).unwrap();
            assert!(matches!(&event, Event::Await(what) if what == "scale 2"));
            script.again(event).unwrap();
            assert!(script.next(false).is_none());
            script.frame_done();
        }
        assert!(script.next(false).is_some());
        assert!(matches!(script.next(false), Some(Event::Close)));
    }

    #[test]
    fn nonsense_names_its_line() {
        for line in ["dance", "key KeyNope", "frames", "click 3", "drag up 1 2 3 4", "fail well"] {
            let error = Script::parse(&format!("frames 1\n{line}")).unwrap_err();
            assert!(error.contains("line 2") && error.contains(line), "{error}");
        }
    }

    #[test]
    fn all_knobs_are_a_line() {
        let mut script = Script::parse("knobs").unwrap();
        let mut count = 0;
        while !script.lines.is_empty() {
            count += u32::from(script.next(false).is_some());
            script.frame_done();
        }
        assert_eq!(count as usize, knobs::ALL.len());
    }
}
