//! The light tree on the device. It is larger than the lights, so it is made when the first frame draws from it, and not before.

use super::{GpuScene, STORAGE};
use crate::error::Result;
use crate::startup;
use crate::vulkan::{Buffer, Device, Uploader};
use shared::light::Light;
use shared::light::tree::{self, Tree};
use shared::resources::{Binding as Place, Resource};

/// Its buffers.
const PLACES: [Place; 3] = [Place::tree_nodes, Place::tree_lights, Place::tree_leaves];

/// The buffers of `tree`; of none, ones that can be bound.
pub fn buffers(upload: &mut Uploader, tree: &Tree) -> Result<[(Resource, Buffer); 3]> {
    Ok([
        (Resource::tree_nodes, upload.buffer("light tree", &tree.nodes, STORAGE)?),
        (Resource::tree_lights, upload.buffer("lights of the tree", &tree.lights, STORAGE)?),
        (Resource::tree_leaves, upload.buffer("leaves of lights", &tree.leaves, STORAGE)?),
    ])
}

impl GpuScene {
    /// Makes the tree over the lights that the device has, unless it is there; then waits for frames in flight.
    pub fn make_light_tree(&mut self, device: &Device) -> Result<()> {
        if self.tree_is_made {
            return Ok(());
        }
        // Descriptors change.
        device.wait_idle()?;
        let lights: Vec<Light> = self.buffers[&Resource::lights].read_vec()?;
        let tree = startup::timed("light tree", || tree::build(&lights));
        self.set_light_tree(device, &tree)?;
        self.tree_is_made = true;
        Ok(())
    }

    /// Forgets the tree of lights that are no more; nothing may be in flight.
    pub(super) fn drop_light_tree(&mut self, device: &Device) -> Result<()> {
        if self.tree_is_made {
            self.set_light_tree(device, &Tree::default())?;
            self.tree_is_made = false;
        }
        Ok(())
    }

    fn set_light_tree(&mut self, device: &Device, tree: &Tree) -> Result<()> {
        let mut upload = Uploader::new(device);
        let made = buffers(&mut upload, tree)?;
        upload.finish()?;
        self.buffers.extend(made);
        for place in PLACES {
            self.set.bind_storage_buffer(place.number(), &self.buffers[&place.resource()]);
        }
        Ok(())
    }
}
