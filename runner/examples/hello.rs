//! A file becomes a picture: `cargo run --release --example hello -- scene.glb hello.png`.

use candela::exposure;
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::gpu_scene::GpuScene;
use candela::image_io;
use candela::knobs::Knobs;
use candela::scene::{self, Illumination, SceneSource};
use candela::shared::glam::UVec2;
use candela::vulkan::{Device, DeviceOptions};
use std::env::args;
use std::path::Path;

fn main() -> candela::error::Result<()> {
    let file = args().nth(1).unwrap_or("knot".into());
    let output = args().nth(2).unwrap_or("hello.png".into());
    let size = UVec2::new(640, 360);

    // A file without lights gets 100 of them.
    let scene = scene::load(&SceneSource::named(Path::new(&file)), &Illumination::points(100))?;
    let camera = scene.camera(None)?.seen_in(size);

    let device = Device::new(&DeviceOptions::default())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = Knobs::default().settings(gpu_scene.lights());
    let mut renderer = Renderer::new(&device, gpu_scene, size, settings.reservoirs)?;

    let frame = FrameOptions::new(Work::Restir(settings), Primary::Auto, 0);
    for _ in 0..16 {
        renderer.render(camera, &frame)?;
    }
    let radiance = renderer.radiance()?;
    image_io::write_tone_mapped(Path::new(&output), size, &radiance, exposure::automatic(&radiance, 0.0))
}
