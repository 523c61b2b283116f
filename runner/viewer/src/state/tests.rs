use super::*;
use crate::input::Button;
use glam::Vec2;

fn state() -> State {
    let scene = SceneDescription::default();
    let camera = scene.camera_fitted();
    State::new(&scene, &camera, Knobs::default(), UVec2::new(200, 100))
}

fn press(state: &mut State, key: KeyCode) -> Option<Action> {
    let action = state.apply(Input::Key { key, pressed: true });
    assert_eq!(state.apply(Input::Key { key, pressed: false }), None);
    action
}

fn drag(state: &mut State, button: Button, from: Vec2, to: Vec2) {
    for input in [
        Input::Cursor(from),
        Input::Button { button, pressed: true },
        Input::Cursor(to),
        Input::Button { button, pressed: false },
    ] {
        assert_eq!(state.apply(input), None);
    }
}

/// With four keys alone every knob can be reached and changed.
#[test]
fn arrows_reach_every_knob() {
    let mut state = state();
    for &knob in knobs::ALL {
        let before = knob.value(&state.settings[0]);
        let mut changed = false;
        for key in [KeyCode::ArrowRight, KeyCode::ArrowLeft] {
            press(&mut state, key);
            changed |= knob.value(&state.settings[0]) != before;
        }
        assert!(changed, "{}", knob.name);
        press(&mut state, KeyCode::ArrowDown);
    }
    assert_eq!(state.selected, 0, "around once");
    press(&mut state, KeyCode::Backspace);
    assert_eq!(state.settings[0], Knobs::default());
}

#[test]
fn presets_and_the_reference() {
    let mut state = state();
    press(&mut state, KeyCode::Digit3);
    assert_eq!(Some(state.settings[0].clone()), Preset::Unbiased.settings());
    assert!(!state.needs_reference());
    press(&mut state, KeyCode::Digit4);
    assert!(state.view == View::Reference && state.needs_reference());
    press(&mut state, KeyCode::Digit1);
    assert!(state.view == View::Final);
}

#[test]
fn two_settings_are_changed_one_at_a_time() {
    let mut state = state();
    press(&mut state, KeyCode::KeyL);
    assert_eq!(state.side, 0, "there is one side only");
    press(&mut state, KeyCode::KeyB);
    press(&mut state, KeyCode::KeyL);
    press(&mut state, KeyCode::Period);
    assert_eq!((state.settings[0].candidates, state.settings[1].candidates), (32, 64));
    press(&mut state, KeyCode::KeyB);
    assert_eq!((state.split, state.side), (Split::Reference, 0));
}

#[test]
fn a_click_picks_and_a_drag_turns() {
    let mut state = state();
    let at = Vec2::new(50.0, 20.0);
    let before = state.rig.clone();
    drag(&mut state, Button::Left, at, at + 1.0);
    assert_eq!(state.picked, Some(UVec2::new(51, 21)));
    assert_eq!(state.rig, before);
    drag(&mut state, Button::Left, at, at + 30.0);
    assert_ne!(state.rig.forward, before.forward);
    let turned = state.rig.clone();
    drag(&mut state, Button::Right, at, at + 30.0);
    assert_eq!(state.rig.forward, turned.forward);
    assert_ne!(state.rig.position, turned.position);
}

#[test]
fn the_divider_is_dragged() {
    let mut state = state();
    press(&mut state, KeyCode::KeyB);
    let before = state.rig.clone();
    drag(&mut state, Button::Left, Vec2::new(102.0, 50.0), Vec2::new(40.0, 50.0));
    assert_eq!((state.divider, &state.rig, state.picked), (0.2, &before, None));
}

#[test]
fn a_found_point_becomes_the_center_once() {
    let mut state = state();
    let point = state.rig.position + 2.0 * state.rig.forward;
    drag(&mut state, Button::Left, Vec2::new(9.0, 9.0), Vec2::new(9.0, 9.0));
    state.found(Some(point));
    assert!((state.rig.center() - point).length() < 1e-3);
    state.rig.zoom(0.5);
    let center = state.rig.center();
    state.found(Some(point + Vec3::X));
    assert_eq!(state.rig.center(), center);
    press(&mut state, KeyCode::KeyF);
    assert!((state.rig.center() - point - Vec3::X).length() < 1e-3);
}

#[test]
fn held_keys_fly_and_a_lost_keyboard_stops_it() {
    let mut state = state();
    state.apply(Input::Key { key: KeyCode::KeyW, pressed: true });
    let before = state.rig.position;
    assert!(state.advance(0.05));
    let step = state.rig.position.distance(before);
    assert!(step > 0.0);
    state.apply(Input::Key { key: KeyCode::ShiftLeft, pressed: true });
    let before = state.rig.position;
    state.advance(0.05);
    assert!((state.rig.position.distance(before) / step - 4.0).abs() < 1e-3);
    state.apply(Input::Unfocused);
    assert!(!state.advance(0.05));
}

#[test]
fn a_held_switch_does_not_flicker() {
    let mut state = state();
    for _ in 0..3 {
        state.apply(Input::Key { key: KeyCode::KeyP, pressed: true });
    }
    assert!(state.accumulate);
    for _ in 0..3 {
        state.apply(Input::Key { key: KeyCode::Period, pressed: true });
    }
    assert_eq!(state.settings[0].candidates, 256);
}

#[test]
fn what_state_cannot_do_is_asked_for() {
    let mut state = state();
    assert_eq!(press(&mut state, KeyCode::F12), Some(Action::Screenshot));
    let path = PathBuf::from("a.glb");
    assert_eq!(state.apply(Input::Dropped(path.clone())), Some(Action::Load(path)));
    press(&mut state, KeyCode::F1);
    assert_eq!((press(&mut state, KeyCode::Escape), state.help), (None, false));
    assert_eq!(press(&mut state, KeyCode::Escape), Some(Action::Quit));
}

/// A click trembles by so many points, whatever the display's density.
#[test]
fn clicks_and_grips_scale_with_the_display() {
    let mut state = state();
    let at = Vec2::new(50.0, 20.0);
    let before = state.rig.clone();
    state.apply(Input::Scale(2.0));
    drag(&mut state, Button::Left, at, at + 5.0);
    assert_eq!((state.picked, &state.rig), (Some(UVec2::new(55, 25)), &before));
    press(&mut state, KeyCode::KeyB);
    drag(&mut state, Button::Left, Vec2::new(110.0, 50.0), Vec2::new(40.0, 50.0));
    assert_eq!(state.divider, 0.2);
    state.apply(Input::Scale(1.0));
    drag(&mut state, Button::Left, at, at + 5.0);
    assert_ne!(state.rig, before);
}

/// Two cameras, the second of which moves along x.
fn moving() -> SceneDescription {
    use candela::scene::animation::{Animation, Channel, Curve, Interpolation, Local, Node, Track};
    use glam::{DAffine3, DQuat, DVec3};
    let fixed = SceneDescription::default().camera_fitted();
    let rest = Local::Trs { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    let track = Track {
        interpolation: Interpolation::Linear,
        times: vec![0.0, 2.0],
        values: vec![DVec3::ZERO, DVec3::X],
    };
    SceneDescription {
        cameras: vec![fixed.clone(), fixed],
        animation: Animation {
            nodes: vec![Node { parent: None, base: DAffine3::IDENTITY, rest }],
            channels: vec![Channel { node: 0, curve: Curve::Translation(track) }],
            attached: vec![(Thing::Camera(1), 0)],
            morphs: vec![],
        },
        ..SceneDescription::default()
    }
}

#[test]
fn the_camera_follows_the_files_until_it_is_taken_by_hand() {
    let mut scene = moving();
    let mut state = State::new(&scene, &scene.cameras[0].clone(), Knobs::default(), UVec2::new(200, 100));
    let mut at = |state: &mut State, time: f64| {
        state.timeline.seek(time);
        let pose = scene.pose(time);
        scene.apply(&pose);
        state.cameras_are(&scene.cameras);
        state.rig.position.x
    };
    press(&mut state, KeyCode::KeyY);
    assert!(!state.follow, "the first camera stands still");
    press(&mut state, KeyCode::KeyC);
    press(&mut state, KeyCode::KeyY);
    assert!(state.follow);
    assert_eq!((at(&mut state, 1.0), at(&mut state, 2.0)), (0.5, 1.0));
    state.apply(Input::Scroll(1.0));
    let x = state.rig.position.x;
    assert!(!state.follow && at(&mut state, 0.5) == x, "a hand has it now");
    press(&mut state, KeyCode::KeyY);
    assert_eq!(state.rig.position.x, 0.25);
}

#[test]
fn time_goes_on_while_it_plays() {
    let mut state = State::new(&moving(), &moving().cameras[0], Knobs::default(), UVec2::new(200, 100));
    press(&mut state, KeyCode::Space);
    state.advance(0.5);
    assert_eq!(state.timeline.time(), Some(0.5));
    press(&mut state, KeyCode::KeyK);
    press(&mut state, KeyCode::KeyJ);
    assert!(!state.timeline.playing && (state.timeline.time().unwrap_or(0.0) - 0.5).abs() < 1e-12);
    state.enter(&SceneDescription::default());
    assert_eq!((state.timeline.time(), state.timeline.duration()), (None, 0.0));
}

#[test]
fn only_a_picked_pixel_is_explained() {
    let mut state = state();
    assert_eq!(press(&mut state, KeyCode::KeyI), None);
    drag(&mut state, Button::Left, Vec2::new(9.0, 9.0), Vec2::new(9.0, 9.0));
    assert_eq!(press(&mut state, KeyCode::KeyI), Some(Action::Explain));
    press(&mut state, KeyCode::KeyB);
    assert!(!state.is_right(UVec2::new(99, 0)) && state.is_right(UVec2::new(100, 0)));
}
