//! The properties that this loader reads of a file's JSON (glTF 2.0, chapter 5, and extensions), as [`Shape`]s.

use super::shape::{Field, Kind, Need, Shape};
use Kind::{
    Accessor, Buffer, Camera, Curve, Image, Light, Material, Mesh, Node, Panel, Sampler, Skin, Texture, View,
};
use Need::{Firm, FirmOr, Loose, Must, Or};
use Shape::{Choice, Code, Flag, Index, List, Named, Number, Numbers, Object, Open, Place, Text, Whole};

const fn f(name: &'static str, shape: Shape, need: Need) -> Field {
    Field { name, shape, need }
}

const NAME: Field = f("name", Text, Loose);
const BYTES: Shape = Whole(u64::MAX);
const SET: Shape = Whole(u32::MAX as u64);

pub const BUFFER: Shape = Object(&[NAME, f("byteLength", BYTES, Or("0")), f("uri", Text, Firm)]);

pub const VIEW: Shape = Object(&[
    NAME,
    f("buffer", Index(Buffer), Must),
    f("byteLength", BYTES, Must),
    f("byteOffset", BYTES, Firm),
    f("byteStride", BYTES, Firm),
]);

/// What EXT_meshopt_compression and KHR_meshopt_compression say of a view.
pub const MESHOPT: Shape = Object(&[
    f("buffer", Index(Buffer), Must),
    f("byteOffset", BYTES, Firm),
    f("byteLength", BYTES, Must),
    f("byteStride", BYTES, Must),
    f("count", BYTES, Must),
    f("mode", Choice(&["ATTRIBUTES", "TRIANGLES", "INDICES"]), Must),
    f("filter", Choice(&["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"]), Firm),
]);

pub const ACCESSOR: Shape = Object(&[
    NAME,
    f("bufferView", Index(View), Firm),
    f("byteOffset", BYTES, Firm),
    f("componentType", Code(&[5120, 5121, 5122, 5123, 5125, 5126]), Must),
    f("count", BYTES, Must),
    f("normalized", Flag, Loose),
    f("type", Choice(&["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]), Must),
    f("sparse", SPARSE, Firm),
]);

const SPARSE: Shape = Object(&[
    f("count", BYTES, Must),
    f(
        "indices",
        Object(&[
            f("bufferView", Index(View), Must),
            f("byteOffset", BYTES, Firm),
            f("componentType", Code(&[5121, 5123, 5125]), Must),
        ]),
        Must,
    ),
    f("values", Object(&[f("bufferView", Index(View), Must), f("byteOffset", BYTES, Firm)]), Must),
]);

pub const IMAGE: Shape =
    Object(&[NAME, f("uri", Text, Loose), f("bufferView", Index(View), Loose), f("mimeType", Text, Loose)]);

const WRAP: Shape = Code(&[33071, 33648, 10497]);
pub const SAMPLER: Shape = Object(&[
    NAME,
    f("magFilter", Code(&[9728, 9729]), Loose),
    f("minFilter", Code(&[9728, 9729, 9984, 9985, 9986, 9987]), Loose),
    f("wrapS", WRAP, Loose),
    f("wrapT", WRAP, Loose),
]);

pub const TEXTURE: Shape = Object(&[
    NAME,
    f("sampler", Index(Sampler), Loose),
    f("source", Index(Image), Loose),
    f(
        "extensions",
        Open(&[f("EXT_texture_webp", OTHER_IMAGE, Loose), f("KHR_texture_basisu", OTHER_IMAGE, Loose)]),
        Loose,
    ),
]);
/// An image in place of core glTF's.
const OTHER_IMAGE: Shape = Object(&[f("source", Index(Image), Must)]);

const TRANSFORM: Field = f(
    "extensions",
    Open(&[f(
        "KHR_texture_transform",
        Object(&[
            f("offset", Numbers(2), Loose),
            f("rotation", Number, Loose),
            f("scale", Numbers(2), Loose),
            f("texCoord", SET, Loose),
        ]),
        Loose,
    )]),
    Loose,
);
/// A texture as a material names it.
const REFERENCE: Shape = Object(&[
    f("index", Index(Texture), Must),
    f("texCoord", SET, Loose),
    f("scale", Number, Loose),
    f("strength", Number, Loose),
    TRANSFORM,
]);

/// Whatever is broken in a material, there is something to draw.
pub const MATERIAL: Shape = Object(&[
    NAME,
    f(
        "pbrMetallicRoughness",
        Object(&[
            f("baseColorFactor", Numbers(4), Loose),
            f("baseColorTexture", REFERENCE, Loose),
            f("metallicFactor", Number, Loose),
            f("roughnessFactor", Number, Loose),
            f("metallicRoughnessTexture", REFERENCE, Loose),
        ]),
        Loose,
    ),
    f("normalTexture", REFERENCE, Loose),
    f("occlusionTexture", REFERENCE, Loose),
    f("emissiveTexture", REFERENCE, Loose),
    f("emissiveFactor", Numbers(3), Loose),
    f("alphaMode", Choice(&["OPAQUE", "MASK", "BLEND"]), Loose),
    f("alphaCutoff", Number, Loose),
    f("doubleSided", Flag, Loose),
    f(
        "extensions",
        Open(&[
            f("KHR_materials_emissive_strength", Object(&[f("emissiveStrength", Number, Loose)]), Loose),
            f("KHR_materials_ior", Object(&[f("ior", Number, Loose)]), Loose),
            f(
                "KHR_materials_pbrSpecularGlossiness",
                Object(&[
                    f("diffuseFactor", Numbers(4), Loose),
                    f("diffuseTexture", REFERENCE, Loose),
                    f("specularFactor", Numbers(3), Loose),
                    f("glossinessFactor", Number, Loose),
                    f("specularGlossinessTexture", REFERENCE, Loose),
                ]),
                Loose,
            ),
            f("KHR_materials_unlit", Object(&[]), Loose),
        ]),
        Loose,
    ),
]);

pub const CAMERA: Shape = Object(&[
    NAME,
    f("type", Choice(&["perspective", "orthographic"]), Must),
    f(
        "perspective",
        Object(&[
            f("aspectRatio", Number, Loose),
            f("yfov", Number, Must),
            f("zfar", Number, Loose),
            f("znear", Number, Or("0")),
        ]),
        // A camera without a view, which is left out.
        FirmOr(r#"{"yfov": 0, "znear": 0}"#),
    ),
    f(
        "orthographic",
        Object(&[
            f("xmag", Number, Or("0")),
            f("ymag", Number, Or("0")),
            f("zfar", Number, Or("0")),
            f("znear", Number, Or("0")),
        ]),
        Or(r#"{"xmag": 0, "ymag": 0, "zfar": 0, "znear": 0}"#),
    ),
]);

/// Of KHR_lights_punctual.
pub const LIGHT: Shape = Object(&[
    NAME,
    f("type", Choice(&["directional", "point", "spot"]), Must),
    f("color", Numbers(3), Loose),
    f("intensity", Number, Firm),
    f("range", Number, Loose),
    f("spot", Object(&[f("innerConeAngle", Number, Loose), f("outerConeAngle", Number, Loose)]), Or("{}")),
    EXTRAS,
]);
/// Of lights and their nodes: may have a `radius`.
const EXTRAS: Field = f("extras", Shape::Anything, Loose);

/// Of EXT_lights_area.
pub const PANEL: Shape = Object(&[
    NAME,
    f("type", Choice(&["rect", "disk"]), Must),
    f("color", Numbers(3), Loose),
    f("intensity", Number, Firm),
    f("size", Number, Firm),
    f("rect", Object(&[f("aspect", Number, Firm)]), Firm),
]);

/// The attributes that may be read, or are looked for to say that they are not.
fn attribute(name: &str) -> Option<Need> {
    let (stem, set) = name.split_once('_').unwrap_or((name, ""));
    let numbered = set.parse::<u32>().is_ok();
    match stem {
        "POSITION" if set.is_empty() => Some(Firm),
        "NORMAL" | "TANGENT" if set.is_empty() => Some(Loose),
        "TEXCOORD" | "COLOR" | "JOINTS" | "WEIGHTS" if numbered => Some(Loose),
        _ => None,
    }
}

/// The attributes of EXT_mesh_gpu_instancing.
fn copied(name: &str) -> Option<Need> {
    matches!(name, "TRANSLATION" | "ROTATION" | "SCALE").then_some(Firm)
}

pub const MESH: Shape = Object(&[
    NAME,
    f("weights", Numbers(0), Loose),
    f(
        "primitives",
        List(&Object(&[
            f("attributes", Named(attribute, &Index(Accessor)), Must),
            f("indices", Index(Accessor), Firm),
            f("material", Index(Material), Firm),
            f("mode", Code(&[0, 1, 2, 3, 4, 5, 6]), Firm),
            f("targets", List(&Named(attribute, &Index(Accessor))), Loose),
            f("extensions", Object(&[f("KHR_draco_mesh_compression", DRACO, Firm)]), Firm),
        ])),
        Must,
    ),
]);

const DRACO: Shape = Object(&[
    f("bufferView", Index(View), Must),
    f("attributes", Named(attribute, &Whole(u32::MAX as u64)), Must),
]);

pub const SKIN: Shape = Object(&[
    NAME,
    f("inverseBindMatrices", Index(Accessor), Firm),
    f("joints", List(&Place(Node)), Must),
    f("skeleton", Place(Node), Loose),
]);

pub const NODE: Shape = Object(&[
    NAME,
    f("camera", Index(Camera), Loose),
    f("children", List(&Place(Node)), Firm),
    f("matrix", Numbers(16), Firm),
    f("mesh", Index(Mesh), Firm),
    f("rotation", Numbers(4), Firm),
    f("scale", Numbers(3), Firm),
    f("translation", Numbers(3), Firm),
    f("skin", Index(Skin), Loose),
    f("weights", Numbers(0), Loose),
    EXTRAS,
    f(
        "extensions",
        Object(&[
            f(
                "EXT_mesh_gpu_instancing",
                Object(&[f("attributes", Named(copied, &Index(Accessor)), Firm)]),
                Firm,
            ),
            f("EXT_lights_area", Object(&[f("light", Index(Panel), Must)]), Loose),
            f("KHR_lights_punctual", Object(&[f("light", Index(Light), Must)]), Loose),
            f("KHR_node_visibility", Object(&[f("visible", Flag, Loose)]), Loose),
        ]),
        Firm,
    ),
]);

pub const SCENE: Shape = Object(&[NAME, f("nodes", List(&Place(Node)), FirmOr("[]"))]);

pub const ANIMATION: Shape = Object(&[
    NAME,
    f(
        "samplers",
        Shape::Table(
            Curve,
            &Object(&[
                f("input", Index(Accessor), Must),
                f("interpolation", Choice(&["LINEAR", "STEP", "CUBICSPLINE"]), Firm),
                f("output", Index(Accessor), Must),
            ]),
        ),
        Or("[]"),
    ),
    f(
        "channels",
        Shape::Loose(&Object(&[
            f("sampler", Index(Curve), Must),
            f(
                "target",
                Object(&[
                    f("node", Place(Node), Must),
                    f("path", Choice(&["translation", "rotation", "scale", "weights"]), Must),
                ]),
                Must,
            ),
        ])),
        Or("[]"),
    ),
]);
