//! Samplers, each combination of settings once.

use super::Check;
use super::device::Device;
use crate::error::Result;
use crate::scene::{Filter, Mips, Wrap};
use ash::vk;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Wrap in u and v, and how texels and levels are read.
type Key = ([Wrap; 2], Filter);

/// The device's samplers: each made once, all destroyed with it.
#[derive(Default)]
pub(super) struct Samplers(Mutex<HashMap<Key, vk::Sampler>>);

impl Samplers {
    fn lock(&self) -> MutexGuard<'_, HashMap<Key, vk::Sampler>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// All of them, which are gone from here.
    pub fn take(&self) -> Vec<vk::Sampler> {
        self.lock().drain().map(|(_, sampler)| sampler).collect()
    }
}

impl Device {
    /// The sampler for these settings, made once; it lives as long as the device.
    pub fn sampler(&self, wrap: [Wrap; 2], filter: Filter) -> Result<vk::Sampler> {
        let mut samplers = self.samplers().lock();
        if let Some(sampler) = samplers.get(&(wrap, filter)) {
            return Ok(*sampler);
        }
        let texels = |linear: bool| if linear { vk::Filter::LINEAR } else { vk::Filter::NEAREST };
        let (mip_filter, max_lod) = match filter.mips {
            // Above level 0 (which chooses between the filters) by less than half a level: Vulkan 1.2, VkSamplerCreateInfo.
            Mips::None => (vk::SamplerMipmapMode::NEAREST, 0.25),
            Mips::Nearest => (vk::SamplerMipmapMode::NEAREST, vk::LOD_CLAMP_NONE),
            Mips::Linear => (vk::SamplerMipmapMode::LINEAR, vk::LOD_CLAMP_NONE),
        };
        let anisotropy = if filter == Filter::LINEAR { self.limits().max_anisotropy } else { 1.0 };
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(texels(filter.magnify_linear))
            .min_filter(texels(filter.minify_linear))
            .mipmap_mode(mip_filter)
            .address_mode_u(address_mode(wrap[0]))
            .address_mode_v(address_mode(wrap[1]))
            .anisotropy_enable(anisotropy > 1.0)
            .max_anisotropy(anisotropy)
            .max_lod(max_lod);
        // SAFETY: a valid create info; the device destroys it.
        let sampler = unsafe { self.create_sampler(&info, None) }.check("create sampler")?;
        samplers.insert((wrap, filter), sampler);
        Ok(sampler)
    }
}

fn address_mode(wrap: Wrap) -> vk::SamplerAddressMode {
    match wrap {
        Wrap::Repeat => vk::SamplerAddressMode::REPEAT,
        Wrap::MirroredRepeat => vk::SamplerAddressMode::MIRRORED_REPEAT,
        Wrap::ClampToEdge => vk::SamplerAddressMode::CLAMP_TO_EDGE,
    }
}
