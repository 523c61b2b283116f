//! The mouse: drags turn, pan or move the divider, clicks pick a pixel.

use super::State;
use crate::input::Button;
use crate::views::Split;
use glam::{UVec2, Vec2, Vec3};

/// A press that moves less than this, in points, is a click.
const CLICK: f32 = 4.0;
/// Points around the divider that take hold of it.
const GRIP: f32 = 6.0;

/// Where the cursor is and what it holds.
#[derive(Default)]
pub(super) struct Pointer {
    cursor: Vec2,
    drag: Option<Drag>,
}

struct Drag {
    button: Button,
    from: Vec2,
    moved: bool,
    /// It moves the divider.
    divider: bool,
}

impl Pointer {
    pub fn let_go(&mut self) {
        self.drag = None;
    }
}

impl State {
    pub(super) fn cursor_moved(&mut self, at: Vec2) {
        let delta = (at - self.pointer.cursor) / self.size.y.max(1) as f32;
        self.pointer.cursor = at;
        let (width, click) = (self.size.x.max(1) as f32, CLICK * self.scale);
        let Some(drag) = &mut self.pointer.drag else { return };
        drag.moved |= at.distance(drag.from) >= click;
        if drag.divider {
            self.divider = (at.x / width).clamp(0.0, 1.0);
        } else if drag.moved {
            match drag.button {
                Button::Left => self.hand().turn(delta),
                Button::Middle | Button::Right => self.hand().pan(delta),
            }
        }
    }

    pub(super) fn button(&mut self, button: Button, pressed: bool) {
        let cursor = self.pointer.cursor;
        if pressed {
            let near = (cursor.x - self.divider_column()).abs() <= GRIP * self.scale;
            let divider = self.split != Split::Off && button == Button::Left && near;
            self.pointer.drag = Some(Drag { button, from: cursor, moved: false, divider });
            return;
        }
        let Some(drag) = self.pointer.drag.take().filter(|drag| drag.button == button) else { return };
        if button == Button::Left && !drag.moved && !drag.divider {
            self.pick(cursor);
        }
    }

    fn pick(&mut self, at: Vec2) {
        let inside = at.cmpge(Vec2::ZERO).all() && at.cmplt(self.size.as_vec2()).all();
        if inside {
            self.picked = Some(at.as_uvec2());
            self.picked_point = None;
            self.center_on_pick = true;
        }
    }

    /// The picked pixel's surface has been read: its place in the world.
    pub fn found(&mut self, point: Option<Vec3>) {
        self.picked_point = point;
        if let Some(point) = point
            && std::mem::take(&mut self.center_on_pick)
        {
            self.rig.set_center(point);
        }
    }

    /// Pixels left of the divider.
    pub fn divider_column(&self) -> f32 {
        self.divider * self.size.x as f32
    }

    /// Is `pixel` shown right of the divider?
    pub fn is_right(&self, pixel: UVec2) -> bool {
        self.split != Split::Off && pixel.x >= self.divider_column() as u32
    }
}
