//! Materials of the hall.

use super::textures::{ASHLAR, MARBLE, WOOD};
use crate::scene::Material;
use crate::scene::procedural::kit;
use glam::{Vec3, Vec4};

/// A material of the hall; its number is the index into `SceneDescription::materials`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Finish {
    Limestone,
    DarkLimestone,
    Ashlar,
    RedPlaster,
    WhitePlaster,
    BlueCoffer,
    Gold,
    Brass,
    Bronze,
    Iron,
    WhiteMarble,
    GreenMarble,
    RedMarble,
    BlackMarble,
    Travertine,
    Grout,
    OakBeams,
    Walnut,
    RedCloth,
    BlueCloth,
    GreenCloth,
    OchreCloth,
    BlueGlaze,
    WhiteGlaze,
    Leaf,
    Terracotta,
    Soil,
    DarkGlass,
    Wax,
}

/// Finish, linear base color, roughness, metallic.
type Entry = (Finish, [f32; 3], f32, f32);

/// In the order of [`Finish`].
const TABLE: [Entry; 29] = [
    (Finish::Limestone, [0.62, 0.55, 0.44], 0.75, 0.0),
    (Finish::DarkLimestone, [0.46, 0.39, 0.30], 0.80, 0.0),
    (Finish::Ashlar, [0.55, 0.46, 0.35], 0.70, 0.0),
    (Finish::RedPlaster, [0.42, 0.12, 0.07], 0.85, 0.0),
    (Finish::WhitePlaster, [0.72, 0.68, 0.60], 0.90, 0.0),
    (Finish::BlueCoffer, [0.04, 0.10, 0.28], 0.65, 0.0),
    (Finish::Gold, [1.00, 0.77, 0.34], 0.28, 1.0),
    (Finish::Brass, [0.89, 0.72, 0.38], 0.18, 1.0),
    (Finish::Bronze, [0.45, 0.31, 0.18], 0.38, 1.0),
    (Finish::Iron, [0.10, 0.10, 0.11], 0.55, 0.9),
    (Finish::WhiteMarble, [0.90, 0.88, 0.84], 0.14, 0.0),
    (Finish::GreenMarble, [0.09, 0.26, 0.17], 0.12, 0.0),
    (Finish::RedMarble, [0.48, 0.13, 0.08], 0.16, 0.0),
    (Finish::BlackMarble, [0.035, 0.033, 0.035], 0.10, 0.0),
    (Finish::Travertine, [0.60, 0.51, 0.39], 0.32, 0.0),
    (Finish::Grout, [0.22, 0.19, 0.16], 0.95, 0.0),
    (Finish::OakBeams, [0.42, 0.27, 0.15], 0.60, 0.0),
    (Finish::Walnut, [0.26, 0.13, 0.07], 0.35, 0.0),
    (Finish::RedCloth, [0.52, 0.02, 0.03], 0.88, 0.0),
    (Finish::BlueCloth, [0.03, 0.09, 0.42], 0.88, 0.0),
    (Finish::GreenCloth, [0.02, 0.28, 0.12], 0.88, 0.0),
    (Finish::OchreCloth, [0.68, 0.36, 0.05], 0.84, 0.0),
    (Finish::BlueGlaze, [0.04, 0.16, 0.48], 0.10, 0.0),
    (Finish::WhiteGlaze, [0.82, 0.82, 0.80], 0.12, 0.0),
    (Finish::Leaf, [0.07, 0.22, 0.04], 0.50, 0.0),
    (Finish::Terracotta, [0.52, 0.22, 0.12], 0.82, 0.0),
    (Finish::Soil, [0.07, 0.045, 0.03], 1.00, 0.0),
    (Finish::DarkGlass, [0.02, 0.03, 0.04], 0.05, 0.0),
    (Finish::Wax, [0.86, 0.80, 0.66], 0.45, 0.0),
];

/// A mesh of the hall under construction.
pub type Part = kit::Part<Finish>;

impl kit::Finish for Finish {
    fn index(self) -> usize {
        self as usize
    }

    fn has_normal_map(self) -> bool {
        self == Finish::Ashlar
    }
}

fn texture(finish: Finish) -> Option<usize> {
    match finish {
        Finish::WhiteMarble | Finish::GreenMarble | Finish::RedMarble | Finish::BlackMarble => Some(MARBLE),
        Finish::OakBeams | Finish::Walnut => Some(WOOD),
        _ => None,
    }
}

/// All materials, indexed by [`Finish`].
pub fn materials() -> Vec<Material> {
    let material = |&(finish, color, roughness, metallic): &Entry| Material {
        name: format!("{finish:?}"),
        base_color: Vec4::from((Vec3::from(color), 1.0)),
        base_color_texture: texture(finish),
        roughness,
        metallic,
        normal_texture: kit::Finish::has_normal_map(finish).then_some(ASHLAR),
        // Thin sheets, seen from both sides.
        double_sided: matches!(
            finish,
            Finish::RedCloth | Finish::BlueCloth | Finish::GreenCloth | Finish::OchreCloth | Finish::Leaf
        ),
        ..Material::default()
    };
    TABLE.iter().map(material).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_names() {
        for (i, entry) in TABLE.iter().enumerate() {
            assert_eq!(entry.0 as usize, i, "{:?}", entry.0);
        }
        assert_eq!(Finish::Wax as usize + 1, TABLE.len());
    }
}
