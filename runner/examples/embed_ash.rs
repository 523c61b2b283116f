//! Candela inside an application with its own Vulkan device: `cargo run --release --example embed_ash -- knot embedded.png`.
//!
//! The application makes instance, device, queue, allocator and command buffers. Candela records frames into one of them and
//! their picture into an image; the application's own commands use it after that, and it submits and waits when it wants.

use ash::vk;
use candela::error::{Error, Result};
use candela::exposure;
use candela::frame::history::History;
use candela::frame::picture::Picture;
use candela::frame::recorder::{FrameOptions, Recorder};
use candela::frame::schedule::{Primary, Work};
use candela::gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use candela::gpu_scene::GpuScene;
use candela::knobs::Knobs;
use candela::scene::{self, Illumination, SceneSource};
use candela::shared::glam::UVec2;
use candela::vulkan::{Buffer, Device, EXTENSIONS, Features, Memory, RawDevice, Timestamps};
use std::env::args;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

const SIZE: UVec2 = UVec2::new(640, 360);
const FRAMES: u32 = 16;

/// What an application has before it meets Candela.
struct Application {
    entry: ash::Entry,
    instance: ash::Instance,
    physical_device: vk::PhysicalDevice,
    device: ash::Device,
    queue: vk::Queue,
    queue_family: u32,
    has_anisotropy: bool,
    /// Goes before the device.
    allocator: Option<Arc<Mutex<Allocator>>>,
}

fn failed(what: &'static str) -> impl Fn(vk::Result) -> Error {
    move |result| Error::Vulkan { what: what.into(), result }
}

impl Application {
    fn new() -> Result<Application> {
        // SAFETY: the system's Vulkan loader; valid create infos; `Drop` destroys what is made.
        unsafe {
            let entry = ash::Entry::load().map_err(|e| Error::NoLoader(e.to_string()))?;
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
            let info = vk::InstanceCreateInfo::default().application_info(&application);
            let instance = entry.create_instance(&info, None).map_err(failed("create instance"))?;
            let devices = instance.enumerate_physical_devices().map_err(failed("list devices"))?;
            let Some(&physical_device) = devices.first() else {
                return Err(Error::NoDevice { seen: Vec::new() });
            };
            let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
            let families = instance.get_physical_device_queue_family_properties(physical_device);
            let family = families.iter().position(|family| family.queue_flags.contains(both));
            let queue_family = family.unwrap_or_default() as u32;

            // Candela's extensions and features, beside those that the application needs itself.
            let mut features = Features::new(&instance, physical_device);
            let names: Vec<_> = EXTENSIONS.iter().map(|name| name.as_ptr()).collect();
            let queues = [vk::DeviceQueueCreateInfo::default()
                .queue_family_index(queue_family)
                .queue_priorities(&[1.0])];
            let info =
                vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&names);
            let has_anisotropy = features.core.sampler_anisotropy == vk::TRUE;
            let device = instance.create_device(physical_device, &features.enable(info), None);
            let device = device.map_err(failed("create device"))?;
            let queue = device.get_device_queue(queue_family, 0);
            let allocator = Allocator::new(&AllocatorCreateDesc {
                instance: instance.clone(),
                device: device.clone(),
                physical_device,
                debug_settings: Default::default(),
                buffer_device_address: true,
                allocation_sizes: Default::default(),
            });
            let allocator = allocator.map_err(|error| Error::Platform(error.to_string()))?;
            let allocator = Some(Arc::new(Mutex::new(allocator)));
            Ok(Application {
                entry,
                instance,
                physical_device,
                device,
                queue,
                queue_family,
                has_anisotropy,
                allocator,
            })
        }
    }

    /// The same handles for Candela.
    fn lend(&self) -> Result<Device> {
        let raw = RawDevice {
            entry: self.entry.clone(),
            instance: self.instance.clone(),
            physical_device: self.physical_device,
            device: self.device.clone(),
            queue: self.queue,
            queue_family: self.queue_family,
            has_anisotropy: self.has_anisotropy,
            has_debug_utils: false,
            allocator: self.allocator.clone(),
        };
        // SAFETY: the handles belong together and outlive `main`'s Candela; extensions and features were enabled.
        unsafe { Device::from_raw(raw, None) }
    }

    /// Bytes of its allocator that are in use.
    fn allocated(&self) -> u64 {
        let allocator = self.allocator.iter().map(|allocator| {
            allocator.lock().unwrap_or_else(PoisonError::into_inner).generate_report().total_allocated_bytes
        });
        allocator.sum()
    }
}

impl Drop for Application {
    fn drop(&mut self) {
        self.allocator = None;
        // SAFETY: all that was made from them is gone.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

fn main() -> Result<()> {
    let source = args().nth(1).unwrap_or("knot".into());
    let output = args().nth(2).unwrap_or("embedded.png".into());
    let application = Application::new()?;
    let picture = render(&application, &source)?;
    println!("bytes in use after Candela: {}", application.allocated());
    let pixels = picture.iter().flat_map(|pixel| pixel.to_le_bytes()).collect();
    let image = image::RgbaImage::from_raw(SIZE.x, SIZE.y, pixels)
        .ok_or_else(|| Error::Internal("a picture has another size".into()))?;
    image.save(&output).map_err(|error| Error::Internal(format!("{output}: {error}")))
}

/// Display values: sRGB, 8 bits, red in the lowest.
fn render(application: &Application, source: &str) -> Result<Vec<u32>> {
    let device = application.lend()?;
    let scene = scene::load(&SceneSource::named(Path::new(source)), &Illumination::points(100))?;
    let camera = scene.camera(None)?.seen_in(SIZE);
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = Knobs::default().settings(gpu_scene.lights());
    let mut recorder = Recorder::new(&device, gpu_scene)?;
    let mut history = History::new(&device, SIZE, settings.reservoirs)?;
    let mut timestamps = Timestamps::new(&device, 64)?;
    let mut options = FrameOptions::new(Work::Restir(settings), Primary::Auto, 0);
    let bytes = u64::from(SIZE.x * SIZE.y) * 4;
    let picture = Picture::new(&device, SIZE)?;
    let copy = Buffer::new(&device, "copy", bytes, vk::BufferUsageFlags::empty(), Memory::Readback)?;

    // SAFETY: the pool is used here alone, nothing is recorded before the fence of the last submission, and scene and history
    // outlive the commands.
    unsafe {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(application.queue_family);
        let pool = device.create_command_pool(&info, None).map_err(failed("create command pool"))?;
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        let buffers = device.allocate_command_buffers(&info).map_err(failed("allocate command buffer"))?;
        let fence =
            device.create_fence(&vk::FenceCreateInfo::default(), None).map_err(failed("create fence"))?;
        for frame in 0..FRAMES {
            device.reset_command_pool(pool, vk::CommandPoolResetFlags::empty()).map_err(failed("reset"))?;
            let begin = vk::CommandBufferBeginInfo::default();
            device.begin_command_buffer(buffers[0], &begin).map_err(failed("begin"))?;
            recorder.record(buffers[0], &mut history, camera, &options, &mut timestamps)?;
            if frame + 1 == FRAMES {
                picture.record(buffers[0], &history)?;
                // The application's own work: here a copy; elsewhere `picture.view()` in a descriptor of its own.
                let (sampled, source) =
                    (vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL, vk::ImageLayout::TRANSFER_SRC_OPTIMAL);
                picture.image().transition(buffers[0], sampled, source);
                picture.image().record_copy(buffers[0], &copy);
            }
            device.end_command_buffer(buffers[0]).map_err(failed("record"))?;
            let submits = [vk::SubmitInfo::default().command_buffers(&buffers)];
            device.queue_submit(*device.queue(), &submits, fence).map_err(failed("submit"))?;
            device.wait_for_fences(&[fence], true, u64::MAX).map_err(failed("wait"))?;
            device.reset_fences(&[fence]).map_err(failed("reset fence"))?;
            if frame + 2 == FRAMES {
                options.exposure = exposure::automatic(&history.radiance()?, 0.0);
            }
        }
        device.destroy_fence(fence, None);
        device.destroy_command_pool(pool, None);
    }
    println!("bytes in use by Candela: {}", application.allocated());
    copy.read_vec()
}
