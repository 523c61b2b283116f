//! One pixel of the next frame, replayed.

use super::{Frames, camera};
use crate::state::State;
use crate::views::{Split, View};
use candela::error::{Error, Result};
use candela::frame::recorder::FrameOptions;
use candela_lab::explain::{World, next_frame};
use glam::UVec2;
use shared::camera::Camera;

/// Which pixel of which frame.
pub struct Question {
    pub pixel: UVec2,
    camera: Camera,
    options: FrameOptions,
    /// Of the settings right of the divider.
    right: bool,
}

impl Frames {
    /// What the picked pixel of the next frame of `state` asks for. Errors: nothing is picked, or the pixel shows the
    /// reference.
    pub fn question(&self, state: &State) -> Result<Question> {
        let pixel = state.picked.ok_or_else(|| Error::Usage("click a pixel first".into()))?;
        let right = state.is_right(pixel);
        let reference = if right { state.split == Split::Reference } else { state.view == View::Reference };
        if reference {
            return Err(Error::Usage("this pixel shows the reference, which does not resample".into()));
        }
        let side = usize::from(right && state.split == Split::Settings);
        let options = self.options_of(state, side, self.exposure(state));
        Ok(Question { pixel, camera: camera(state, self.size()), options, right: side == 1 })
    }

    /// Renders the next frame of the side in question, and replays the pixel on the CPU. Nothing may be in flight. The
    /// scene stands still for it: what moved before has moved.
    pub fn explain(&mut self, question: &Question) -> Result<String> {
        self.move_scene()?;
        let Frames { recorder, left, right, scene, .. } = self;
        let side = if question.right { right.as_mut().unwrap_or(left) } else { left };
        let world = World::new(scene)?;
        let Question { pixel, camera, options, .. } = question;
        let explanation = next_frame(recorder, &mut side.history, &world, *camera, options, *pixel)?;
        let held = match self.posed {
            Some(time) if self.scene.changes() => {
                format!(
                    "at {time:.3} s, held still for this frame; `candela explain --time` replays frames in motion\n\n"
                )
            }
            _ => String::new(),
        };
        Ok(format!("{held}{explanation}"))
    }
}
