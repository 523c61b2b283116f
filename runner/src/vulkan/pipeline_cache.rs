//! Compiled pipelines on disk: the next start needs no compiler.
//!
//! One file a device and driver. It begins with a hash of what pipelines are made from, the program's shaders, and with a hash
//! of its content: drivers trust what they are given.

use super::Check;
use crate::error::Result;
use crate::{files, image_io};
use ash::vk;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// The driver's cache, and the file that it comes from and goes to.
pub(super) struct PipelineCache {
    pub handle: vk::PipelineCache,
    file: Option<PathBuf>,
    /// As it was read.
    known: Vec<u8>,
}

const HASH: usize = 32;

impl PipelineCache {
    /// From the file in `directory` that is for this device, if there is one; without a directory nothing outlives the program.
    pub fn new(
        device: &ash::Device,
        directory: Option<&Path>,
        properties: &vk::PhysicalDeviceProperties,
    ) -> Result<Self> {
        let file = directory.map(|directory| directory.join(file_name(properties)));
        let known = file.as_deref().and_then(read).unwrap_or_default();
        let info = vk::PipelineCacheCreateInfo::default().initial_data(&known);
        // SAFETY: a valid create info; the data is what this driver gave, its hash says so. The owner destroys the cache.
        let handle = unsafe { device.create_pipeline_cache(&info, None) }.check("create pipeline cache")?;
        Ok(PipelineCache { handle, file, known })
    }

    /// Writes the file, if there is anything new. Whatever fails, pipelines can be made again.
    pub fn save(&self, device: &ash::Device) {
        let Some(file) = &self.file else { return };
        // SAFETY: the cache is alive.
        let Ok(data) = (unsafe { device.get_pipeline_cache_data(self.handle) }) else { return };
        if data == self.known {
            return;
        }
        let written = file.parent().map_or(Ok(()), image_io::create_folder);
        if let Err(error) = written.and_then(|()| image_io::replace(file, &sealed(&data))) {
            tracing::warn!("compiled pipelines are not kept: {error}");
        }
    }
}

/// The user's folder for such files, if there is one.
pub fn default_directory() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|f| !f.is_empty()).map(PathBuf::from);
    let cache = folder("XDG_CACHE_HOME").or_else(|| folder("LOCALAPPDATA"));
    let cache = cache.or_else(|| folder("HOME").map(|home| home.join(".cache")))?;
    cache.is_absolute().then(|| cache.join("candela"))
}

/// Of a device under a driver: each has its own form of compiled pipelines.
fn file_name(properties: &vk::PhysicalDeviceProperties) -> String {
    let vk::PhysicalDeviceProperties { vendor_id, device_id, driver_version, pipeline_cache_uuid, .. } =
        properties;
    let uuid: String = pipeline_cache_uuid.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("pipelines-{vendor_id:x}-{device_id:x}-{driver_version:x}-{uuid}.bin")
}

fn sealed(data: &[u8]) -> Vec<u8> {
    [&shaders()[..], &Sha256::digest(data), data].concat()
}

/// What [`sealed`] was given; none, with a warning, if the file is broken; none if it is of other shaders or not there.
fn read(file: &Path) -> Option<Vec<u8>> {
    let bytes = files::bytes(file).ok()?;
    let opened = open(&bytes);
    if opened.is_none() {
        tracing::warn!("{}: broken, so pipelines are compiled again", file.display());
    }
    opened?.map(<[u8]>::to_vec)
}

/// None: broken. Some(None): of other shaders.
fn open(bytes: &[u8]) -> Option<Option<&[u8]>> {
    let (made_from, rest) = bytes.split_at_checked(HASH)?;
    let (hash, data) = rest.split_at_checked(HASH)?;
    let whole = hash == &Sha256::digest(data)[..];
    whole.then(|| (made_from == shaders()).then_some(data))
}

fn shaders() -> [u8; HASH] {
    let mut hash = Sha256::new();
    candela_assets::MODULES.iter().for_each(|(_, code)| hash.update(code));
    hash.finalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_broken_or_of_others_is_not_taken() {
        let data = b"compiled".to_vec();
        let whole = sealed(&data);
        assert_eq!(open(&whole), Some(Some(&data[..])));
        for i in HASH..whole.len() {
            let mut broken = whole.clone();
            broken[i] ^= 1;
            assert_eq!(open(&broken), None, "byte {i}");
        }
        for length in 0..whole.len() {
            assert_eq!(open(&whole[..length]), None, "{length} bytes");
        }
        let mut of_others = whole;
        of_others[0] ^= 1;
        assert_eq!(open(&of_others), Some(None));
    }

    #[test]
    fn each_driver_has_its_file() {
        let name = |version: u32, uuid: u8| {
            let pipeline_cache_uuid = [uuid; 16];
            file_name(&vk::PhysicalDeviceProperties {
                driver_version: version,
                pipeline_cache_uuid,
                ..Default::default()
            })
        };
        assert_ne!(name(1, 0), name(2, 0));
        assert_ne!(name(1, 0), name(1, 1));
    }
}
