//! Motion by held keys and by playing: the camera and the scene's time.

use super::State;
use crate::camera::Rig;
use crate::input::KeyCode;
use candela::scene::SceneCamera;
use glam::Vec3;

/// The longest step of a flight, seconds: a slow frame must not carry through walls.
const LONGEST_STEP: f32 = 0.1;

impl State {
    /// Lets `seconds` pass: held keys fly, the scene's time goes on. Is anything held?
    pub fn advance(&mut self, seconds: f32) -> bool {
        self.timeline.advance(seconds.into());
        let axis = |plus: KeyCode, minus: KeyCode| {
            f32::from(u8::from(self.is_held(plus))) - f32::from(u8::from(self.is_held(minus)))
        };
        let direction = Vec3::new(
            axis(KeyCode::KeyD, KeyCode::KeyA),
            axis(KeyCode::KeyE, KeyCode::KeyQ),
            axis(KeyCode::KeyW, KeyCode::KeyS),
        );
        if direction == Vec3::ZERO {
            return false;
        }
        let fast = self.is_held(KeyCode::ShiftLeft) || self.is_held(KeyCode::ShiftRight);
        let slow = self.is_held(KeyCode::ControlLeft) || self.is_held(KeyCode::ControlRight);
        let factor = if fast { 4.0 } else { 1.0 } * if slow { 0.25 } else { 1.0 };
        self.hand().walk(direction * factor, seconds.clamp(0.0, LONGEST_STEP));
        true
    }

    /// The camera, taken by hand: it follows nothing any more.
    pub(super) fn hand(&mut self) -> &mut Rig {
        self.follow = false;
        &mut self.rig
    }

    /// Takes the place of one of the scene's cameras.
    pub fn look_through(&mut self, camera: usize) {
        if let Some(chosen) = self.cameras.get(camera) {
            self.camera = camera;
            self.rig.look_through(chosen);
        }
    }

    /// Index of the scene's camera that was chosen last.
    pub fn chosen_camera(&self) -> usize {
        self.camera
    }

    /// Does the chosen camera move with the scene?
    pub fn camera_moves(&self) -> bool {
        self.moving_cameras.contains(&self.camera)
    }

    /// Follow the chosen camera on its way, or let go of it.
    pub fn set_follow(&mut self, follow: bool) {
        self.follow = follow && self.camera_moves();
        if self.follow {
            self.look_through(self.camera);
        }
    }

    /// Where the scene's cameras are now.
    pub fn cameras_are(&mut self, cameras: &[SceneCamera]) {
        if !self.moving_cameras.is_empty() && self.cameras != cameras {
            self.cameras = cameras.to_vec();
            self.set_follow(self.follow);
        }
    }
}
