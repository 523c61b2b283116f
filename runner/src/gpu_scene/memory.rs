//! Device memory of each feature of a scene: the buffers and images that exist because of it.

use super::arrays::SceneArrays;
use super::draws::DRAW_BYTES;
use crate::scene::lights::LightTable;
use crate::scene::{Image, SceneDescription};
use serde::Serialize;
use shared::environment::EnvironmentTexel;
use shared::light::count::LightCount;
use shared::light::tree::TreeNode;
use shared::light::{KINDS, KindFacts, kind};
use shared::material::slot;
use std::collections::HashSet;
use std::sync::Arc;

/// Memory of one feature.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Cost {
    /// What needs them.
    pub feature: &'static str,
    /// Device memory.
    pub bytes: u64,
    /// What the bytes are.
    pub detail: String,
}

/// Every feature that has bytes of its own, but for acceleration structures, whose size only a device knows. Buffers are
/// exact, but for the 16 zero bytes of one without content (shaders name every binding); images as their texels with all mip levels, which devices may pad.
pub fn costs(scene: &SceneDescription, lights: &LightTable, arrays: &SceneArrays) -> Vec<Cost> {
    let mut costs = vec![geometry(arrays)];
    let mut add = |feature, bytes: usize, detail: String| {
        if bytes > 0 {
            costs.push(Cost { feature, bytes: bytes as u64, detail });
        }
    };
    add("materials", size_of_val(&arrays.materials[..]), format!("{}", arrays.materials.len()));
    let second = &arrays.second_uvs;
    add("second uv set", size_of_val(&second[..]), format!("{} vertices", second.len()));
    for KindFacts { kind, lights: name, .. } in KINDS {
        let count = lights.lights.iter().filter(|light| light.kind == kind).count();
        let textured = match kind {
            kind::TRIANGLE if lights.textured > 0 => {
                format!(", {} of them parts of textures", lights.textured)
            }
            _ => String::new(),
        };
        add(name, count * size_of::<shared::light::Light>(), format!("{count} lights{textured}"));
    }
    let alias = &lights.alias[..];
    add(
        "alias table",
        size_of_val(alias),
        format!("{} columns for {} lights", alias.len(), lights.lights.len()),
    );
    if let Some(map) = &scene.environment {
        let (x, y) = (map.size.x, map.size.y);
        add(
            "environment map",
            map.radiance.len() * size_of::<EnvironmentTexel>(),
            format!("{x} x {y} texels, as a background"),
        );
    }
    costs.extend(images(scene));
    costs
}

/// The light tree, which the first frame with light cells makes.
pub fn light_tree(lights: LightCount) -> Cost {
    let placed = lights.placed as usize;
    let nodes = (2 * placed).saturating_sub(1) * size_of::<TreeNode>();
    let bytes = nodes + (placed + lights.number as usize) * size_of::<u32>();
    Cost {
        feature: "light tree",
        bytes: bytes as u64,
        detail: format!("over {placed} lights, for light cells"),
    }
}

fn geometry(arrays: &SceneArrays) -> Cost {
    let vertices = arrays.positions.len();
    let bytes = size_of_val(&arrays.positions[..])
        + size_of_val(&arrays.attributes[..])
        + size_of_val(&arrays.indices[..])
        + size_of_val(&arrays.instances[..])
        + DRAW_BYTES * arrays.instances.len();
    let detail = format!("{vertices} vertices, {} triangles", arrays.indices.len() / 3);
    Cost { feature: "geometry", bytes: bytes as u64, detail }
}

/// Images by what reads them first: one that serves two purposes is there once.
fn images(scene: &SceneDescription) -> Vec<Cost> {
    let mut known: HashSet<(*const Image, bool)> = HashSet::new();
    let mut costs = Vec::new();
    for (name, slot) in [
        ("base color textures", slot::BASE_COLOR),
        ("reflectance textures", slot::REFLECTANCE),
        ("normal maps", slot::NORMAL),
        ("emissive textures", slot::EMISSIVE),
    ] {
        let textures = scene.materials.iter().filter_map(|m| m.textures()[slot]).map(|t| &scene.textures[t]);
        let new: Vec<&Arc<Image>> = textures
            .filter(|texture| known.insert((Arc::as_ptr(&texture.image), texture.srgb)))
            .map(|texture| &texture.image)
            .collect();
        if !new.is_empty() {
            let bytes = new.iter().map(|image| mip_bytes(image.width, image.height)).sum();
            costs.push(Cost {
                feature: name,
                bytes,
                detail: format!("{} images with mip levels", new.len()),
            });
        }
    }
    costs
}

/// RGBA8 texels of all levels down to 1 x 1.
fn mip_bytes(width: u32, height: u32) -> u64 {
    let levels = width.max(height).max(1).ilog2() + 1;
    let side = |n: u32, level: u32| u64::from((n >> level).max(1));
    (0..levels).map(|level| 4 * side(width, level) * side(height, level)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::fixtures;

    #[test]
    fn levels_add_a_third() {
        assert_eq!(mip_bytes(1, 1), 4);
        assert_eq!(mip_bytes(4, 2), 4 * (8 + 2 + 1));
        assert_eq!(mip_bytes(2048, 2048), 4 * ((1 << 24) - 1) / 3);
    }

    /// What a scene has not is not in its list.
    #[test]
    fn plain_scenes_pay_for_nothing_else() {
        let scene = fixtures::all().into_iter().find(|(name, _)| *name == "cornell-box").unwrap().1;
        let lights = LightTable::new(&scene);
        let arrays = SceneArrays::new(&scene, &lights).unwrap();
        let names: Vec<_> = costs(&scene, &lights, &arrays).iter().map(|cost| cost.feature).collect();
        assert_eq!(names, ["geometry", "materials", "emissive triangles", "alias table"]);
    }
}
