//! Lit windows: the panes of a house that shine, and the number of houses with light.

use super::dice::Dice;
use super::facade::Pane;
use super::materials::{Finish, Part};
use crate::scene::procedural::kit::Kit;
use crate::scene::{Mesh, Primitive};

/// Meshes of each design and level: neighbors of one design need not look alike.
const VARIANTS: usize = 2;
pub const LEVELS: usize = 3;

/// Shares of a building's panes that shine, by level.
pub const OF_HOUSES: [f32; LEVELS] = [0.10, 0.24, 0.42];
pub const OF_TOWERS: [f32; LEVELS] = [0.05, 0.14, 0.30];

/// The meshes of one design.
pub struct Glows {
    /// By level and variant.
    meshes: [[usize; VARIANTS]; LEVELS],
    /// Triangles of each.
    lights: [[usize; VARIANTS]; LEVELS],
}

impl Glows {
    /// Makes them; `shop` shines at every level.
    pub fn new(
        kit: &mut Kit,
        name: &str,
        panes: &[Pane],
        shop: Option<&Part>,
        shares: [f32; LEVELS],
    ) -> Self {
        let mut glows = Glows { meshes: [[0; VARIANTS]; LEVELS], lights: [[0; VARIANTS]; LEVELS] };
        for (level, share) in shares.into_iter().enumerate() {
            for variant in 0..VARIANTS {
                let mut part = lit(panes, share, kit.scene.meshes.len());
                if let Some(shop) = shop {
                    part.merge(shop, glam::Affine3A::IDENTITY);
                }
                let mesh = kit.mesh(&format!("{name}-glow-{level}-{variant}"), part);
                glows.meshes[level][variant] = mesh;
                glows.lights[level][variant] = triangles(&kit.scene.meshes[mesh]);
            }
        }
        glows
    }

    pub fn mesh(&self, level: usize, building: usize) -> usize {
        self.meshes[level][building % VARIANTS]
    }

    fn lights(&self, level: usize, building: usize) -> usize {
        self.lights[level][building % VARIANTS]
    }
}

pub fn triangles(mesh: &Mesh) -> usize {
    mesh.primitives.iter().map(|primitive: &Primitive| primitive.indices.len() / 3).sum()
}

/// About a share of the panes, some with a blind half down or a curtain drawn.
fn lit(panes: &[Pane], share: f32, number: usize) -> Part {
    let mut dice = Dice::new(80, number);
    let mut part = Part::default();
    const WARM: [Finish; 8] = [
        Finish::WarmPane,
        Finish::WarmPane,
        Finish::WarmPane,
        Finish::SoftPane,
        Finish::SoftPane,
        Finish::WhitePane,
        Finish::AmberPane,
        Finish::ColdPane,
    ];
    const ALL: [f32; 2] = [0.0, 1.0];
    for pane in panes {
        if !dice.chance(share) {
            continue;
        }
        let finish = dice.pick(&WARM);
        if dice.chance(0.7) || finish == Finish::ColdPane {
            part.add(finish, &pane.shape(ALL, ALL));
            continue;
        }
        let cut = dice.within(0.3..0.7);
        let (bright, dim) = match dice.chance(0.5) {
            true => (pane.shape(ALL, [0.0, cut]), pane.shape(ALL, [cut, 1.0])),
            false => (pane.shape([0.0, cut], ALL), pane.shape([cut, 1.0], ALL)),
        };
        part.add(finish, &bright);
        part.add(Finish::SoftPane, &dim);
    }
    part
}

/// How brightly each building is lit with at most `budget` lights; `glows` of each, those that come first first. First all get a
/// little, then the first ones more.
pub fn levels(glows: &[&Glows], budget: usize) -> Vec<Option<usize>> {
    let mut levels = vec![None; glows.len()];
    let mut left = budget;
    for (level, limit) in [(0, budget / 2), (1, 0), (2, 0)] {
        for (i, glow) in glows.iter().enumerate() {
            let more = glow.lights(level, i)
                - if level > 0 { glow.lights(level - 1, i).min(glow.lights(level, i)) } else { 0 };
            let follows = if level == 0 { levels[i].is_none() } else { levels[i] == Some(level - 1) };
            if follows && left >= more + limit {
                left -= more;
                levels[i] = Some(level);
            }
        }
        // What the first pass kept back is for houses that are farther away, after the near ones are bright.
        if level == 2 {
            fill(&mut levels, glows, &mut left);
        }
    }
    levels
}

/// Wakes further houses with what is left.
fn fill(levels: &mut [Option<usize>], glows: &[&Glows], left: &mut usize) {
    for (i, level) in levels.iter_mut().enumerate() {
        let lights = glows[i].lights(0, i);
        if level.is_none() && *left >= lights {
            *left -= lights;
            *level = Some(0);
        }
    }
}

/// Triangles of a mesh that shine.
pub fn shining(scene: &crate::scene::SceneDescription, mesh: usize) -> usize {
    let shines = |primitive: &&Primitive| scene.materials[primitive.material].emission != glam::Vec3::ZERO;
    scene.meshes[mesh].primitives.iter().filter(shines).map(|primitive| primitive.indices.len() / 3).sum()
}
