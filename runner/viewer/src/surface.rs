//! The Vulkan surface of a window.

use ash::{khr, vk};
use candela::error::{Error, Result};
use candela::vulkan::{Check, Device};
use raw_window_handle::{HasDisplayHandle, HasWindowHandle};
use std::ffi::CStr;

/// Instance extensions that windows of this display need, for `DeviceOptions::window_extensions`.
pub fn window_extensions(display: &impl HasDisplayHandle) -> Result<Vec<&'static CStr>> {
    let handle = display.display_handle().map_err(|e| Error::Unsupported(format!("no display: {e}")))?;
    let names = ash_window::enumerate_required_extensions(handle.as_raw()).check("list window extensions")?;
    // SAFETY: the names are static strings of ash.
    Ok(names.iter().map(|&name| unsafe { CStr::from_ptr(name) }).collect())
}

/// A window's surface. The window must outlive it.
pub struct Surface {
    device: Device,
    loader: khr::surface::Instance,
    handle: vk::SurfaceKHR,
}

impl Surface {
    /// The device must have been made with the window's extensions.
    pub fn new(device: &Device, window: &(impl HasDisplayHandle + HasWindowHandle)) -> Result<Surface> {
        let no_handle = |e| Error::Unsupported(format!("the window has no handle: {e}"));
        let display_handle = window.display_handle().map_err(no_handle)?.as_raw();
        let window_handle = window.window_handle().map_err(no_handle)?.as_raw();
        let (entry, instance) = (device.entry(), device.instance());
        // SAFETY: valid handles of a window that outlives the surface; the instance has the extensions.
        let handle =
            unsafe { ash_window::create_surface(entry, instance, display_handle, window_handle, None) }
                .check("create a surface for the window")?;
        let loader = khr::surface::Instance::new(entry, instance);
        let surface = Surface { device: device.clone(), loader, handle };
        // SAFETY: the surface and the device are alive, and the queue family exists.
        let presents = unsafe {
            surface.loader.get_physical_device_surface_support(
                device.physical_device(),
                device.queue_family(),
                handle,
            )
        };
        if !presents.check("ask whether the device presents to the window")? {
            let name = &device.info().name;
            return Err(Error::Unsupported(format!(
                "{name} can't draw to this display; choose another --device"
            )));
        }
        Ok(surface)
    }

    pub fn handle(&self) -> vk::SurfaceKHR {
        self.handle
    }

    pub fn capabilities(&self) -> Result<vk::SurfaceCapabilitiesKHR> {
        // SAFETY: the surface is alive.
        unsafe {
            self.loader.get_physical_device_surface_capabilities(self.device.physical_device(), self.handle)
        }
        .check("ask what the window's surface can do")
    }

    pub fn formats(&self) -> Result<Vec<vk::SurfaceFormatKHR>> {
        // SAFETY: the surface is alive.
        unsafe { self.loader.get_physical_device_surface_formats(self.device.physical_device(), self.handle) }
            .check("list the formats of the window's surface")
    }

    pub fn present_modes(&self) -> Result<Vec<vk::PresentModeKHR>> {
        // SAFETY: the surface is alive.
        unsafe {
            self.loader.get_physical_device_surface_present_modes(self.device.physical_device(), self.handle)
        }
        .check("list the present modes of the window's surface")
    }
}

impl Drop for Surface {
    fn drop(&mut self) {
        // SAFETY: swapchains of the surface have gone before it.
        unsafe { self.loader.destroy_surface(self.handle, None) };
    }
}
