//! What extensions say of dielectrics, in terms of what materials have.

use super::warnings::Warnings;
use crate::scene::{AlphaMode, Material};
use glam::Vec3;
use serde_json::Value;
use shared::math::luminance;

fn number(value: &Value) -> Option<f32> {
    value.as_f64().map(|x| x as f32)
}

/// The reflectance at normal incidence of what would have `f0`, by KHR_materials_specular:
/// min(f0 specularColorFactor, 1) specularFactor.
pub fn specular(source: &gltf::Material, f0: f32, label: &str, warnings: &mut Warnings) -> Vec3 {
    let Some(extension) = source.extension_value("KHR_materials_specular") else { return Vec3::splat(f0) };
    for texture in ["specularTexture", "specularColorTexture"] {
        if extension.get(texture).is_some() {
            warnings.add(&format!("the picture lacks {texture}s"), label);
        }
    }
    let factor = extension.get("specularFactor").and_then(number).unwrap_or(1.0).clamp(0.0, 1.0);
    let channel = |i: usize| number(extension.get("specularColorFactor")?.get(i)?);
    let color = [0, 1, 2].map(|i| channel(i).unwrap_or(1.0).max(0.0));
    (f0 * Vec3::from(color)).min(Vec3::ONE) * factor
}

/// Makes an opaque `material` pass light by KHR_materials_transmission: a thin surface that is there with probability alpha, as
/// blended ones are. Of t = transmissionFactor (the part that is no metal) and the color b,
///
/// - t b (1 - f0) passes, in the mean over the channels: 1 - alpha,
/// - f0 is reflected at normal incidence, and (1 - t) b scattered: alpha times what the surface that is there does.
///
/// What metals and grazing angles reflect is less than that by alpha.
pub fn transmit(source: &gltf::Material, material: &mut Material, label: &str, warnings: &mut Warnings) {
    let Some(extension) = source.extension_value("KHR_materials_transmission") else { return };
    let factor = extension.get("transmissionFactor").and_then(number).unwrap_or(0.0).clamp(0.0, 1.0);
    let metallic = material.metallic.clamp(0.0, 1.0);
    if factor <= 0.0 || material.unlit {
        return;
    }
    let textured = extension.get("transmissionTexture").is_some();
    let partly_metal = metallic > 0.0 && material.reflectance_texture.is_some();
    if textured || partly_metal || material.alpha != AlphaMode::Opaque {
        warnings.add("the picture lacks transmission that varies, or of what is masked or blended", label);
        return;
    }
    let transmitted = factor * (1.0 - metallic);
    if transmitted <= 0.0 {
        return;
    }
    warnings.add("light passes thin surfaces straight: neither refracted, nor tinted, nor blurred", label);
    let color = material.base_color.truncate();
    let passing = transmitted * luminance(color) * (1.0 - luminance(material.specular));
    let alpha = 1.0 - passing.clamp(0.0, 1.0);
    let scattered = (color * ((1.0 - transmitted) / alpha)).min(Vec3::ONE);
    material.base_color = scattered.extend(alpha);
    material.specular = (material.specular / alpha).min(Vec3::ONE);
    material.alpha = AlphaMode::Blend;
}
