//! The cache of a sweep: finished points and references, each under the hash of all that defines it.

use super::point::Measurement;
use super::truth::Truth;
use crate::measure::mean::Mean;
use candela::error::{Error, Result};
use candela::scene::SceneDescription;
use candela::{files, image_io};
use glam::UVec2;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A folder of `point-KEY.json`, `truth-KEY.exr`, `truth-KEY.json` and `truth-KEY.mean`. Files appear whole or not at all.
pub struct Store {
    directory: PathBuf,
}

impl Store {
    pub fn open(directory: &Path) -> Result<Self> {
        image_io::create_folder(directory)?;
        Ok(Store { directory: directory.into() })
    }

    /// A finished point; none if there is none, or none that can be read.
    pub fn point(&self, key: &str) -> Option<Measurement> {
        let bytes = files::bytes(&self.path("point", key, "json")).ok()?;
        serde_json::from_slice(&bytes).ok()
    }

    pub fn save_point(&self, key: &str, point: &Measurement) -> Result<()> {
        image_io::replace(&self.path("point", key, "json"), &to_json(point)?)
    }

    pub fn truth(&self, key: &str) -> Option<Truth> {
        let bytes = files::bytes(&self.path("truth", key, "json")).ok()?;
        let about = serde_json::from_slice(&bytes).ok()?;
        let (size, radiance) = image_io::read_exr(&self.path("truth", key, "exr")).ok()?;
        Some(Truth { size, radiance, about })
    }

    /// What a truth of `size` goes on from.
    pub fn truth_state(&self, key: &str, size: UVec2) -> Option<Mean> {
        Mean::from_bytes(size, &files::bytes(&self.path("truth", key, "mean")).ok()?)
    }

    /// The numbers last: a truth that has them has its picture. A truth that is exact has no `state`.
    pub fn save_truth(&self, key: &str, truth: &Truth, state: &Mean) -> Result<()> {
        if truth.about.error > 0.0 {
            image_io::replace(&self.path("truth", key, "mean"), &state.to_bytes())?;
        }
        image_io::write_exr(&self.path("truth", key, "exr"), truth.size, &truth.radiance)?;
        image_io::replace(&self.path("truth", key, "json"), &to_json(&truth.about)?)
    }

    fn path(&self, what: &str, key: &str, extension: &str) -> PathBuf {
        self.directory.join(format!("{what}-{key}.{extension}"))
    }
}

pub fn to_json(value: &impl Serialize) -> Result<Vec<u8>> {
    serde_json::to_vec_pretty(value).map_err(Error::internal)
}

/// 16 hexadecimal digits of the SHA-256 of `value` as JSON.
pub fn key(value: &impl Serialize) -> Result<String> {
    Ok(short(Sha256::digest(to_json(value)?)))
}

/// The same for all that a scene shows: geometry, materials, textures, lights, environment. Names and cameras don't count.
pub fn scene_key(scene: &SceneDescription) -> String {
    let mut hash = Sha256::new();
    for mesh in &scene.meshes {
        for p in &mesh.primitives {
            hash.update((p.material as u64).to_le_bytes());
            for bytes in [
                bytemuck::cast_slice::<_, u8>(&p.positions),
                bytemuck::cast_slice(&p.normals),
                bytemuck::cast_slice(&p.tangents),
                bytemuck::cast_slice(&p.uvs),
                bytemuck::cast_slice(&p.second_uvs),
                bytemuck::cast_slice(&p.colors),
                bytemuck::cast_slice(&p.indices),
            ] {
                hash.update((bytes.len() as u64).to_le_bytes());
                hash.update(bytes);
            }
        }
    }
    for texture in &scene.textures {
        hash.update(&texture.image.texels);
        let image = [texture.image.width, texture.image.height];
        hash.update(format!("{image:?} {} {:?} {:?}", texture.srgb, texture.wrap, texture.filter));
    }
    if let Some(map) = &scene.environment {
        hash.update(bytemuck::cast_slice::<_, u8>(&map.radiance));
    }
    // Their debug form has every digit and name that matters, of whatever kind they are.
    for light in &scene.lights {
        hash.update(format!("{light:?}"));
    }
    let others = (&scene.instances, &scene.materials);
    hash.update(format!("{others:?}"));
    short(hash.finalize())
}

fn short(digest: impl AsRef<[u8]>) -> String {
    digest.as_ref()[..8].iter().fold(String::new(), |mut text, byte| {
        // Writing to a string can't fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use candela::scene::procedural::{atrium, knot};

    #[test]
    fn scenes_are_told_apart_by_what_they_show() {
        let scene = knot::knot();
        let first = scene_key(&scene);
        assert_eq!(first, scene_key(&knot::knot()));
        let mut moved = scene.clone();
        moved.meshes[0].primitives[0].positions[7].x += 1e-4;
        let mut painted = scene.clone();
        painted.materials[0].roughness += 1e-4;
        let mut renamed = scene.clone();
        renamed.name = "other".into();
        assert_ne!(first, scene_key(&moved));
        assert_ne!(first, scene_key(&painted));
        assert_eq!(first, scene_key(&renamed));
        let hall = atrium::atrium(3);
        assert_ne!(scene_key(&hall), scene_key(&atrium::atrium(4)));
        let mut lit = hall.clone();
        *lit.lights[0].emission_mut() *= 1.0001;
        assert_ne!(scene_key(&hall), scene_key(&lit));
    }
}
