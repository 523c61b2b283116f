//! The extensions of glTF, and how this loader treats each.

use super::Reason;
use super::warnings::Warnings;
use Effect::{Drawn, Lacks, Needed, None as Nothing, Partly};

/// What an extension does to the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// What it should.
    Drawn,
    /// It is drawn but for this, which is said where a material asks for it.
    Partly(&'static str),
    /// It is ignored, so the picture lacks this.
    Lacks(&'static str),
    /// Nothing: it says what a picture does not show.
    None,
    /// It is ignored, and what is left can't be drawn without.
    Needed,
}

/// Name and effect, by name.
#[rustfmt::skip]
pub const EXTENSIONS: &[(&str, Effect)] = &[
    ("ADOBE_materials_clearcoat_specular", Lacks("the reflectance of a clear coat")),
    ("ADOBE_materials_clearcoat_tint", Lacks("the tint of a clear coat")),
    ("ADOBE_materials_thin_transparency", Lacks("thin transparency")),
    ("AGI_articulations", Nothing),
    ("AGI_stk_metadata", Nothing),
    ("CESIUM_primitive_outline", Lacks("outlines")),
    ("EXT_lights_area", Drawn),
    ("EXT_lights_ies", Lacks("light profiles")),
    ("EXT_lights_image_based", Lacks("the environment of the file (--environment takes one)")),
    ("EXT_mesh_gpu_instancing", Drawn),
    ("EXT_mesh_manifold", Nothing),
    ("EXT_mesh_primitive_edge_visibility", Lacks("outlines")),
    ("EXT_mesh_primitive_restart", Needed),
    ("EXT_meshopt_compression", Drawn),
    ("EXT_texture_astc", Lacks("textures in ASTC")),
    ("EXT_texture_avif", Lacks("textures in AVIF")),
    ("EXT_texture_webp", Drawn),
    ("FB_geometry_metadata", Nothing),
    ("GODOT_single_root", Nothing),
    ("GRIFFEL_bim_data", Nothing),
    ("KHR_animation_pointer", Lacks("animations of anything but nodes")),
    ("KHR_draco_mesh_compression", Drawn),
    ("KHR_gaussian_splatting", Lacks("Gaussian splats")),
    ("KHR_interactivity", Nothing),
    ("KHR_lights_punctual", Drawn),
    ("KHR_materials_anisotropy", Lacks("anisotropy")),
    ("KHR_materials_clearcoat", Lacks("clear coats")),
    ("KHR_materials_diffuse_transmission", Lacks("diffuse transmission")),
    ("KHR_materials_dispersion", Lacks("dispersion")),
    ("KHR_materials_emissive_strength", Drawn),
    ("KHR_materials_ior", Drawn),
    ("KHR_materials_iridescence", Lacks("iridescence")),
    ("KHR_materials_pbrSpecularGlossiness", Drawn),
    ("KHR_materials_sheen", Lacks("sheen")),
    ("KHR_materials_specular", Partly("its textures; grazing reflections keep their strength")),
    ("KHR_materials_transmission", Partly("its texture: surfaces are thin, and pass light straight and without a tint")),
    ("KHR_materials_unlit", Drawn),
    ("KHR_materials_variants", Lacks("all variants of materials but the default")),
    ("KHR_materials_volume", Lacks("absorption in volumes")),
    ("KHR_mesh_quantization", Drawn),
    ("KHR_meshopt_compression", Drawn),
    ("KHR_node_hoverability", Nothing),
    ("KHR_node_selectability", Nothing),
    ("KHR_node_visibility", Drawn),
    ("KHR_techniques_webgl", Lacks("shaders of the file's own")),
    ("KHR_texture_basisu", Drawn),
    ("KHR_texture_transform", Drawn),
    ("KHR_xmp", Nothing),
    ("KHR_xmp_json_ld", Nothing),
    ("MPEG_audio_spatial", Nothing),
    ("MSFT_lod", Lacks("levels of detail: the finest is drawn")),
    ("MSFT_packing_normalRoughnessMetallic", Lacks("packed textures")),
    ("MSFT_packing_occlusionRoughnessMetallic", Lacks("packed textures")),
    ("MSFT_texture_dds", Lacks("textures in DDS")),
    ("NV_materials_mdl", Lacks("materials in MDL")),
];

/// What becomes of the extension `name`. One that is not listed may be anything, but one that calls itself a matter of
/// materials or data about data leaves the rest as it is.
pub fn effect(name: &str) -> Effect {
    if let Ok(place) = EXTENSIONS.binary_search_by_key(&name, |(listed, _)| listed) {
        return EXTENSIONS[place].1;
    }
    let lower = name.to_ascii_lowercase();
    let about = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    if about(&["metadata", "xmp"]) {
        Nothing
    } else if about(&["_material", "_texture", "_light", "variants"]) {
        Lacks("what it adds to materials, textures or lights")
    } else {
        Needed
    }
}

/// Says what the picture lacks of the extensions in `used`. Error: one that the file requires is [`Effect::Needed`].
pub fn check(used: &[String], required: &[String], warnings: &mut Warnings) -> Reason<()> {
    let needed: Vec<&str> =
        required.iter().map(String::as_str).filter(|name| effect(name) == Needed).collect();
    if !needed.is_empty() {
        return Err(format!(
            "requires {}, which is not supported; export the scene without",
            needed.join(", ")
        ));
    }
    let mut said = std::collections::HashSet::new();
    for name in used.iter().chain(required).filter(|name| said.insert(*name)) {
        match effect(name) {
            Drawn | Partly(_) => {}
            Lacks(what) => warnings.add("the picture lacks", &format!("{what} ({name})")),
            Nothing | Needed => warnings.add("extensions without an effect here", name),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_sorted() {
        assert!(EXTENSIONS.is_sorted_by(|(a, _), (b, _)| a < b));
    }

    /// As a line of the table in docs/formats.md.
    fn line(name: &str, effect: Effect) -> String {
        match effect {
            Drawn => format!("| `{name}` | drawn |"),
            Partly(what) => format!("| `{name}` | drawn, but for {what} |"),
            Lacks(what) => format!("| `{name}` | ignored, with a warning: the picture lacks {what} |"),
            Nothing => format!("| `{name}` | ignored: no effect on a picture |"),
            Needed => format!("| `{name}` | a file that requires it is refused |"),
        }
    }

    #[test]
    fn the_table_in_the_docs_is_this_list() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/formats.md");
        let page = std::fs::read_to_string(path).unwrap();
        let written: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
        let listed: Vec<String> = EXTENSIONS.iter().map(|&(name, effect)| line(name, effect)).collect();
        assert_eq!(written, listed, "docs/formats.md should have these lines:\n{}", listed.join("\n"));
    }

    /// All that Khronos has ratified by 2026 are listed.
    #[test]
    fn ratified_extensions_are_listed() {
        for name in [
            "EXT_mesh_gpu_instancing",
            "EXT_meshopt_compression",
            "EXT_texture_webp",
            "KHR_animation_pointer",
            "KHR_draco_mesh_compression",
            "KHR_lights_punctual",
            "KHR_materials_anisotropy",
            "KHR_materials_clearcoat",
            "KHR_materials_dispersion",
            "KHR_materials_emissive_strength",
            "KHR_materials_ior",
            "KHR_materials_iridescence",
            "KHR_materials_sheen",
            "KHR_materials_specular",
            "KHR_materials_transmission",
            "KHR_materials_unlit",
            "KHR_materials_variants",
            "KHR_materials_volume",
            "KHR_mesh_quantization",
            "KHR_node_visibility",
            "KHR_texture_basisu",
            "KHR_texture_transform",
            "KHR_xmp_json_ld",
        ] {
            assert!(EXTENSIONS.iter().any(|&(listed, _)| listed == name), "{name}");
        }
    }

    #[test]
    fn unlisted_extensions_are_known_by_their_names() {
        assert_eq!(effect("KHR_lights_punctual"), Drawn);
        assert!(matches!(effect("VENDOR_materials_glitter"), Lacks(_)));
        assert_eq!(effect("VENDOR_Metadata"), Nothing);
        assert_eq!(effect("VENDOR_mesh_fractal"), Needed);
    }
}
