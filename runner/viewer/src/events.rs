//! winit's events as inputs.

use super::input::{Button, Input};
use glam::Vec2;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::PhysicalKey;

/// Points of a touchpad's scrolling that count as a notch of a wheel.
const NOTCH: f32 = 40.0;

/// What a window's event means, if anything. `scale`: pixels a point.
pub fn translate(event: &WindowEvent, scale: f32) -> Option<Input> {
    Some(match event {
        WindowEvent::KeyboardInput { event, .. } => {
            let PhysicalKey::Code(key) = event.physical_key else { return None };
            Input::Key { key, pressed: event.state == ElementState::Pressed }
        }
        WindowEvent::CursorMoved { position, .. } => {
            Input::Cursor(Vec2::new(position.x as f32, position.y as f32))
        }
        WindowEvent::MouseInput { state, button, .. } => {
            let button = match button {
                MouseButton::Left => Button::Left,
                MouseButton::Middle => Button::Middle,
                MouseButton::Right => Button::Right,
                _ => return None,
            };
            Input::Button { button, pressed: *state == ElementState::Pressed }
        }
        WindowEvent::MouseWheel { delta, .. } => Input::Scroll(match delta {
            MouseScrollDelta::LineDelta(_, y) => *y,
            MouseScrollDelta::PixelDelta(pixels) => pixels.y as f32 / (NOTCH * scale),
        }),
        WindowEvent::PinchGesture { delta, .. } => Input::Pinch(*delta as f32),
        WindowEvent::ScaleFactorChanged { scale_factor, .. } => Input::Scale(*scale_factor as f32),
        WindowEvent::Focused(false) => Input::Unfocused,
        WindowEvent::DroppedFile(path) => Input::Dropped(path.clone()),
        _ => return None,
    })
}
