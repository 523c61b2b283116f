//! One validated device for a test program, and pictures rendered on it.

use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::gpu_scene::GpuScene;
use candela::scene::SceneDescription;
use candela::vulkan::{Device, DeviceOptions};
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::Settings;
use shared::resources::Resource;
use std::ops::Deref;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// The device and the right to use it: one test at a time. Mesa 25.0's lavapipe reallocates the table of its texture
/// functions when a sampler is made, also while another thread's frame reads it.
pub struct Gpu {
    device: &'static Device,
    _turn: MutexGuard<'static, ()>,
}

impl Deref for Gpu {
    type Target = Device;

    fn deref(&self) -> &Device {
        self.device
    }
}

/// The device, under validation unless `CANDELA_NO_VALIDATION=1`; none only where `CANDELA_ALLOW_NO_GPU=1` allows a machine
/// without one.
pub fn device() -> Option<Gpu> {
    static DEVICE: OnceLock<Option<Device>> = OnceLock::new();
    static TURN: Mutex<()> = Mutex::new(());
    let validate = std::env::var("CANDELA_NO_VALIDATION").as_deref() != Ok("1");
    // A test that failed in its turn leaves the device to the next one.
    let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let device =
        DEVICE.get_or_init(|| match Device::new(&DeviceOptions { validate, ..DeviceOptions::default() }) {
            Ok(device) => Some(device),
            Err(error) if std::env::var("CANDELA_ALLOW_NO_GPU").as_deref() == Ok("1") => {
                eprintln!("skipped: {error}");
                None
            }
            Err(error) => panic!("{error} (CANDELA_ALLOW_NO_GPU=1 skips these tests)"),
        });
    device.as_ref().map(|device| Gpu { device, _turn: turn })
}

/// Fails on any message of the validation layer.
pub fn assert_no_validation_messages(device: &Device) {
    let messages = device.validation_messages();
    assert!(messages.is_empty(), "{} validation messages:\n{}", messages.len(), messages.join("\n"));
}

/// A renderer for `scene`.
pub fn renderer(device: &Device, scene: &SceneDescription, size: UVec2, reservoirs: u32) -> Renderer {
    let scene = GpuScene::new(device, scene).expect("the scene fits");
    Renderer::new(device, scene, size, reservoirs).expect("the renderer fits")
}

/// The next frame of `renderer` shows `scene` as it is at `time`, s.
pub fn pose(renderer: &mut Renderer, scene: &mut SceneDescription, time: f64) {
    let pose = scene.pose(time);
    scene.apply(&pose);
    renderer.update_scene(scene, &pose).expect("the scene moves");
}

/// Options of a frame that is not shown.
pub fn options(work: Work, seed: u32) -> FrameOptions {
    FrameOptions::new(work, Primary::default(), seed)
}

/// Radiance of the last frame of those that `cameras` see one after the other, from a fresh history.
pub fn render(renderer: &mut Renderer, cameras: &[Camera], options: &FrameOptions) -> Vec<Vec3> {
    renderer.restart();
    for &camera in cameras {
        renderer.render(camera, options).expect("the frame renders");
    }
    renderer.radiance().expect("the picture is read back")
}

/// Few candidates near by, so that means over runs settle soon; reuse twice in space and in time.
pub fn small(mode: u32) -> Settings {
    Settings { candidates: 8, radius: 8.0, spatial_iterations: 2, mode, ..Settings::default() }
}

/// Radiance of the last of `frames` ReSTIR frames of a still camera, from a fresh history.
pub fn restir(
    renderer: &mut Renderer,
    camera: Camera,
    settings: Settings,
    frames: u32,
    seed: u32,
) -> Vec<Vec3> {
    renderer.restart();
    for _ in 0..frames {
        renderer.render(camera, &options(Work::Restir(settings), seed)).expect("the frame renders");
    }
    renderer.radiance().expect("the picture is read back")
}

/// Radiance of one frame of the reference.
pub fn reference(renderer: &mut Renderer, camera: Camera, seed: u32) -> Vec<Vec3> {
    let lights = renderer.scene().light_count();
    renderer.restart();
    renderer.render(camera, &options(Work::Reference { lights }, seed)).expect("the frame renders");
    renderer.radiance().expect("the picture is read back")
}

/// Light that bounced in the last frame, which was rendered in parts.
pub fn what_bounced(renderer: &Renderer) -> Vec<Vec3> {
    let read = |resource| renderer.read::<Vec3>(resource).expect("it is read back");
    let (diffuse, specular) = (read(Resource::indirect_diffuse), read(Resource::indirect_specular));
    let gbuffer = renderer.gbuffer().expect("it is read back");
    let parts = diffuse.iter().zip(&specular).zip(&gbuffer);
    parts.map(|((&diffuse, &specular), texel)| texel.diffuse() * diffuse + specular).collect()
}
