//! Direct light from thousands to millions of lights in real time: ReSTIR DI on Vulkan ray tracing, every shader in Rust.
//!
//! A [`SceneDescription`](scene::SceneDescription) is plain data: loaded from a file ([`scene::load`]) or filled in by a program.
//! [`GpuScene`](gpu_scene::GpuScene) is the scene on a [`Device`](vulkan::Device). A
//! [`Renderer`](frame::renderer::Renderer) renders its frames one after another and waits for each; a
//! [`Recorder`](frame::recorder::Recorder) records them into command buffers of an application.
//! [`Knobs`](knobs::Knobs) are the settings. Units are metres, candela, lux and nit; +Y is up, and colors are linear Rec. 709.
//!
//! A white square under a lamp of 100 cd, as a PNG file:
//!
//! ```
//! use candela::exposure;
//! use candela::frame::renderer::{FrameOptions, Renderer};
//! use candela::frame::schedule::{Primary, Work};
//! use candela::gpu_scene::GpuScene;
//! use candela::image_io;
//! use candela::knobs::Knobs;
//! use candela::scene::{Instance, Material, Mesh, PointLight, Primitive, SceneDescription};
//! use candela::shared::glam::{Affine3A, UVec2, Vec3};
//! use candela::vulkan::{Device, DeviceOptions};
//!
//! # fn main() -> candela::error::Result<()> {
//! let square = Primitive {
//!     positions: vec![
//!         Vec3::new(-1.0, 0.0, 1.0),
//!         Vec3::new(1.0, 0.0, 1.0),
//!         Vec3::new(1.0, 0.0, -1.0),
//!         Vec3::new(-1.0, 0.0, -1.0),
//!     ],
//!     normals: vec![Vec3::Y; 4],
//!     indices: vec![0, 1, 2, 0, 2, 3],
//!     ..Primitive::default()
//! };
//! let lamp = PointLight { position: Vec3::Y, intensity: Vec3::splat(100.0), radius: 0.0 };
//! let scene = SceneDescription {
//!     meshes: vec![Mesh { name: "square".into(), primitives: vec![square] }],
//!     instances: vec![Instance { name: "floor".into(), mesh: 0, transform: Affine3A::IDENTITY }],
//!     materials: vec![Material::default()],
//!     lights: vec![lamp.into()],
//!     ..SceneDescription::default()
//! };
//!
//! let size = UVec2::new(320, 180);
//! let camera = scene.camera_fitted().seen_in(size);
//! let device = Device::new(&DeviceOptions::default())?;
//! let gpu_scene = GpuScene::new(&device, &scene)?;
//! let settings = Knobs::default().settings(gpu_scene.lights());
//! let mut renderer = Renderer::new(&device, gpu_scene, size, settings.reservoirs)?;
//! let options = FrameOptions::new(Work::Restir(settings), Primary::Auto, 0);
//! for _ in 0..16 {
//!     renderer.render(camera, &options)?;
//! }
//! let radiance = renderer.radiance()?;
//! let exposure = exposure::automatic(&radiance, 0.0);
//! let file = std::env::temp_dir().join("square.png");
//! image_io::write_tone_mapped(&file, size, &radiance, exposure)
//! # }
//! ```
#![deny(missing_docs)]

pub mod error;
pub mod exposure;
#[doc(hidden)]
pub mod files;
pub mod frame;
pub mod gpu_scene;
pub mod image_io;
pub mod knobs;
#[doc(hidden)]
pub mod parallel;
pub mod scene;
#[doc(hidden)]
pub mod startup;
pub mod vulkan;

// What the library's own types are made of, in the versions that it takes.
pub use ash;
pub use gpu_allocator;
pub use shared;
