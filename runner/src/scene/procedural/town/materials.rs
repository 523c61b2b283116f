//! Materials of the town.

use super::textures::{ASPHALT, ASPHALT_GLOSS, BRICK, CONCRETE, PAVING, PLASTER, TILES};
use crate::scene::Material;
use crate::scene::procedural::kit;
use glam::{Vec3, Vec4};

/// A material of the town; its number is the index into `SceneDescription::materials`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Finish {
    Asphalt,
    Paint,
    Kerb,
    Paving,
    Cobble,
    Gravel,
    Grass,
    Cream,
    Ochre,
    Rose,
    Grey,
    White,
    RedBrick,
    DarkBrick,
    Concrete,
    Stone,
    Slate,
    Tiles,
    Copper,
    Iron,
    Steel,
    Wood,
    Door,
    Frame,
    Glass,
    Water,
    Leaf,
    Hedge,
    Bark,
    RedCar,
    BlueCar,
    SilverCar,
    BlackCar,
    WhiteCar,
    Tyre,
    RedCloth,
    GreenCloth,
    BlueCloth,
    Canvas,
    Bronze,
    Board,
    // What looks lit and is no light itself: the lights beside it are.
    Bulb,
    WhiteBulb,
    RedBulb,
    BlueBulb,
    GreenBulb,
    TailLens,
    // Lights.
    WarmPane,
    SoftPane,
    WhitePane,
    ColdPane,
    AmberPane,
    ShopPanel,
    Dial,
    RedNeon,
    BlueNeon,
    GreenNeon,
    PinkNeon,
    WarmNeon,
    Poster,
}

/// Finish, linear base color, roughness, metallic.
type Entry = (Finish, [f32; 3], f32, f32);

/// What reflects.
const SOLID: [Entry; 41] = [
    (Finish::Asphalt, [0.15, 0.15, 0.155], 1.0, 0.0),
    (Finish::Paint, [0.62, 0.62, 0.60], 0.55, 0.0),
    (Finish::Kerb, [0.36, 0.35, 0.33], 0.75, 0.0),
    (Finish::Paving, [0.26, 0.25, 0.24], 0.62, 0.0),
    (Finish::Cobble, [0.23, 0.21, 0.19], 0.45, 0.0),
    (Finish::Gravel, [0.19, 0.17, 0.14], 0.95, 0.0),
    (Finish::Grass, [0.055, 0.10, 0.03], 0.95, 0.0),
    (Finish::Cream, [0.66, 0.57, 0.42], 0.9, 0.0),
    (Finish::Ochre, [0.62, 0.40, 0.19], 0.9, 0.0),
    (Finish::Rose, [0.58, 0.33, 0.27], 0.9, 0.0),
    (Finish::Grey, [0.38, 0.40, 0.41], 0.9, 0.0),
    (Finish::White, [0.74, 0.72, 0.68], 0.85, 0.0),
    (Finish::RedBrick, [0.42, 0.17, 0.11], 0.9, 0.0),
    (Finish::DarkBrick, [0.22, 0.13, 0.10], 0.9, 0.0),
    (Finish::Concrete, [0.42, 0.41, 0.39], 0.85, 0.0),
    (Finish::Stone, [0.56, 0.52, 0.45], 0.75, 0.0),
    (Finish::Slate, [0.10, 0.11, 0.13], 0.5, 0.0),
    (Finish::Tiles, [0.40, 0.15, 0.08], 0.8, 0.0),
    (Finish::Copper, [0.16, 0.38, 0.31], 0.6, 0.0),
    (Finish::Iron, [0.06, 0.065, 0.06], 0.45, 0.6),
    (Finish::Steel, [0.50, 0.51, 0.53], 0.35, 0.9),
    (Finish::Wood, [0.30, 0.17, 0.08], 0.6, 0.0),
    (Finish::Door, [0.10, 0.16, 0.12], 0.4, 0.0),
    (Finish::Frame, [0.55, 0.53, 0.49], 0.5, 0.0),
    (Finish::Glass, [0.015, 0.02, 0.025], 0.06, 0.0),
    (Finish::Water, [0.01, 0.025, 0.03], 0.05, 0.0),
    (Finish::Leaf, [0.07, 0.16, 0.035], 0.65, 0.0),
    (Finish::Hedge, [0.045, 0.11, 0.03], 0.9, 0.0),
    (Finish::Bark, [0.13, 0.09, 0.06], 0.95, 0.0),
    (Finish::RedCar, [0.42, 0.02, 0.02], 0.22, 0.0),
    (Finish::BlueCar, [0.02, 0.06, 0.24], 0.22, 0.0),
    (Finish::SilverCar, [0.52, 0.53, 0.55], 0.25, 0.5),
    (Finish::BlackCar, [0.015, 0.015, 0.018], 0.18, 0.0),
    (Finish::WhiteCar, [0.72, 0.72, 0.70], 0.22, 0.0),
    (Finish::Tyre, [0.02, 0.02, 0.02], 0.8, 0.0),
    (Finish::RedCloth, [0.50, 0.03, 0.03], 0.85, 0.0),
    (Finish::GreenCloth, [0.03, 0.22, 0.09], 0.85, 0.0),
    (Finish::BlueCloth, [0.04, 0.10, 0.34], 0.85, 0.0),
    (Finish::Canvas, [0.66, 0.60, 0.48], 0.85, 0.0),
    (Finish::Bronze, [0.42, 0.30, 0.17], 0.35, 1.0),
    (Finish::Board, [0.03, 0.03, 0.035], 0.5, 0.0),
];

/// What shows its color whatever the light: finish, linear color.
const UNLIT: [(Finish, [f32; 3]); 6] = [
    (Finish::Bulb, [1.0, 0.62, 0.26]),
    (Finish::WhiteBulb, [1.0, 0.93, 0.80]),
    (Finish::RedBulb, [1.0, 0.10, 0.05]),
    (Finish::BlueBulb, [0.15, 0.35, 1.0]),
    (Finish::GreenBulb, [0.12, 0.9, 0.25]),
    (Finish::TailLens, [0.9, 0.03, 0.02]),
];

/// What shines: finish, radiance in nit.
const SHINING: [(Finish, [f32; 3]); 13] = [
    (Finish::WarmPane, [9.0, 5.2, 2.1]),
    (Finish::SoftPane, [4.6, 2.5, 1.0]),
    (Finish::WhitePane, [8.0, 6.6, 4.8]),
    (Finish::ColdPane, [3.0, 4.4, 6.6]),
    (Finish::AmberPane, [6.0, 2.6, 0.6]),
    (Finish::ShopPanel, [210.0, 170.0, 115.0]),
    (Finish::Dial, [22.0, 19.0, 12.0]),
    (Finish::RedNeon, [62.0, 3.0, 1.5]),
    (Finish::BlueNeon, [3.5, 12.0, 62.0]),
    (Finish::GreenNeon, [3.0, 46.0, 12.0]),
    (Finish::PinkNeon, [56.0, 6.0, 34.0]),
    (Finish::WarmNeon, [50.0, 30.0, 11.0]),
    (Finish::Poster, [24.0, 24.0, 24.0]),
];

/// A mesh of the town under construction.
pub type Part = kit::Part<Finish>;

impl kit::Finish for Finish {
    fn index(self) -> usize {
        self as usize
    }

    fn repeat(self) -> f32 {
        match self {
            Finish::Asphalt => 12.0,
            Finish::Paving | Finish::Cobble | Finish::Tiles | Finish::Slate => 2.0,
            Finish::RedBrick | Finish::DarkBrick => 2.0,
            Finish::Cream | Finish::Ochre | Finish::Rose | Finish::Grey | Finish::White => 7.0,
            Finish::Concrete | Finish::Stone | Finish::Gravel | Finish::Grass => 5.0,
            _ => 1.0,
        }
    }
}

fn texture(finish: Finish) -> Option<usize> {
    match finish {
        Finish::Asphalt => Some(ASPHALT),
        Finish::RedBrick | Finish::DarkBrick => Some(BRICK),
        Finish::Cream | Finish::Ochre | Finish::Rose | Finish::Grey | Finish::White => Some(PLASTER),
        Finish::Concrete | Finish::Stone | Finish::Gravel | Finish::Grass => Some(CONCRETE),
        Finish::Paving | Finish::Cobble => Some(PAVING),
        Finish::Tiles | Finish::Slate => Some(TILES),
        _ => None,
    }
}

/// All materials, indexed by [`Finish`]. Behind them come `posters`, one for each of these textures.
pub fn materials(posters: &[usize]) -> Vec<Material> {
    let solid = SOLID.iter().map(|&(finish, color, roughness, metallic)| Material {
        name: format!("{finish:?}"),
        base_color: Vec4::from((Vec3::from(color), 1.0)),
        base_color_texture: texture(finish),
        reflectance_texture: (finish == Finish::Asphalt).then_some(ASPHALT_GLOSS),
        roughness,
        metallic,
        double_sided: finish == Finish::Leaf,
        ..Material::default()
    });
    let unlit = UNLIT.iter().map(|&(finish, color)| Material {
        name: format!("{finish:?}"),
        base_color: Vec4::from((Vec3::from(color), 1.0)),
        unlit: true,
        ..Material::default()
    });
    let shining = |name: String, radiance: [f32; 3], emissive_texture| Material {
        name,
        base_color: Vec4::new(0.05, 0.05, 0.05, 1.0),
        roughness: 0.3,
        emission: Vec3::from(radiance),
        emissive_texture,
        ..Material::default()
    };
    let lights = SHINING.iter().map(|&(finish, radiance)| shining(format!("{finish:?}"), radiance, None));
    let mut all: Vec<Material> = solid.chain(unlit).chain(lights).collect();
    let poster = SHINING[SHINING.len() - 1].1;
    all.pop();
    all.extend(posters.iter().enumerate().map(|(i, &t)| shining(format!("Poster {i}"), poster, Some(t))));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_in_the_order_of_the_names() {
        let names = SOLID.iter().map(|entry| entry.0).chain(UNLIT.iter().map(|entry| entry.0));
        for (i, finish) in names.chain(SHINING.iter().map(|entry| entry.0)).enumerate() {
            assert_eq!(finish as usize, i, "{finish:?}");
        }
    }
}
