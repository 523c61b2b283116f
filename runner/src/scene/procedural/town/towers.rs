//! Office towers, and the floodlights on their roofs.

use super::dice::Dice;
use super::facade::{Face, Opening, Pane};
use super::materials::{Finish, Part};
use super::plan::{KERB, Plan, Rect, Usage};
use crate::scene::procedural::shapes::{cuboid, polygon};
use glam::{Affine3A, Vec2, Vec3};

/// Side of the square that a design stands on, m.
pub const SIDE: f32 = 24.0;
const STOREY: f32 = 3.7;
const BAY: f32 = 3.0;

/// A tower as a mesh around the y axis, its foot at y = 0.
pub struct Tower {
    pub part: Part,
    pub panes: Vec<Pane>,
    /// Of the roof.
    pub height: f32,
}

/// A tower in its place.
pub struct Site {
    pub design: usize,
    pub rect: Rect,
    pub transform: Affine3A,
}

pub fn designs() -> Vec<Tower> {
    [(24, Finish::Concrete), (26, Finish::Steel), (22, Finish::DarkBrick), (27, Finish::White)]
        .into_iter()
        .map(|(storeys, finish)| tower(storeys, finish))
        .collect()
}

fn faces(half: f32) -> [Face; 4] {
    [
        Face::new(Vec3::new(-half, 0.0, half), Vec3::X),
        Face::new(Vec3::new(half, 0.0, half), Vec3::NEG_Z),
        Face::new(Vec3::new(half, 0.0, -half), Vec3::NEG_X),
        Face::new(Vec3::new(-half, 0.0, -half), Vec3::Z),
    ]
}

fn tower(storeys: usize, finish: Finish) -> Tower {
    let (mut part, mut panes) = (Part::default(), Vec::new());
    let half = 0.5 * SIDE;
    let height = storeys as f32 * STOREY + 1.6;
    let bays = (SIDE / BAY) as usize;
    for face in faces(half) {
        for storey in 0..storeys {
            let floor = storey as f32 * STOREY;
            let (sill, head) = (floor + if storey == 0 { 0.3 } else { 1.0 }, floor + STOREY);
            let glass = Opening { u: [0.0, SIDE], v: [sill, head] };
            part.add(finish, &face.quad([0.0, SIDE], [floor, sill], 0.0));
            part.add(Finish::Glass, &face.quad(glass.u, glass.v, 0.18));
            let at = |v: f32, d: f32| [face.at(0.0, v, d), face.at(SIDE, v, d)];
            let ledge = |v: f32, up: Vec3| {
                let ([a, b], [c, d]) = (at(v, 0.0), at(v, 0.18));
                polygon(&[a, b, d, c], up)
            };
            part.add(finish, &ledge(sill, Vec3::Y).with(ledge(head, Vec3::NEG_Y)));
            for bay in 0..bays {
                let u = bay as f32 * BAY;
                panes.push(Pane::of(
                    face,
                    &Opening { u: [u + 0.25, u + BAY - 0.25], v: [sill + 0.1, head - 0.1] },
                    0.18,
                ));
            }
        }
        part.add(finish, &face.quad([0.0, SIDE], [storeys as f32 * STOREY, height], 0.0));
        for fin in 1..bays {
            let u = fin as f32 * BAY;
            part.add(finish, &face.block([u - 0.12, u + 0.12], [0.0, height - 0.4], [0.2, 0.3]));
        }
    }
    // Corners close what the glass leaves open.
    for (x, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let outer = Vec3::new(x * (half + 0.05), 0.0, z * (half + 0.05));
        let inner = Vec3::new(x * (half - 0.6), height, z * (half - 0.6));
        part.add(finish, &cuboid(outer.min(inner), outer.max(inner)));
    }
    let at = |x: f32, z: f32| Vec3::new(x * half, height, z * half);
    part.add(
        Finish::Gravel,
        &polygon(&[at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)], Vec3::Y),
    );
    let up = |min: [f32; 3], max: [f32; 3]| {
        cuboid(Vec3::from(min) + Vec3::Y * height, Vec3::from(max) + Vec3::Y * height)
    };
    part.add(finish, &up([-6.0, 0.0, -5.0], [5.0, 4.5, 6.0]));
    part.add(Finish::Steel, &up([-3.0, 4.5, -2.0], [0.0, 6.0, 3.0]));
    part.add(Finish::Iron, &up([1.9, 4.5, 1.9], [2.1, 15.0, 2.1]));
    part.add(Finish::RedBulb, &up([1.85, 15.0, 1.85], [2.15, 15.3, 2.15]));
    Tower { part, panes, height }
}

/// One or two on each plot for towers.
pub fn sites(plan: &Plan) -> Vec<Site> {
    let designs = 4;
    let mut sites = Vec::new();
    for (i, block) in plan.blocks.iter().enumerate().filter(|(_, block)| block.usage == Usage::Towers) {
        let mut dice = Dice::new(40, i);
        let size = block.plot.size();
        let side = (size.min_element() - 8.0).clamp(20.0, 28.0);
        let long = size.max_element();
        let middles: &[f32] = if long > 2.0 * side + 22.0 { &[-0.25, 0.25] } else { &[0.0] };
        for share in middles {
            let along = if size.x > size.y { Vec2::X } else { Vec2::Y };
            let middle = block.plot.center() + along * long * *share;
            let rect = Rect::around(middle, Vec2::splat(side));
            let stretch = Vec3::new(side / SIDE, dice.within(0.92..1.12), side / SIDE);
            let place = Vec3::new(middle.x, KERB, middle.y);
            let transform = Affine3A::from_translation(place) * Affine3A::from_scale(stretch);
            sites.push(Site { design: dice.below(designs), rect, transform });
        }
    }
    sites
}

impl Site {
    pub fn roof(&self, tower: &Tower) -> f32 {
        self.transform.transform_point3(Vec3::Y * tower.height).y
    }

    /// Of its floodlights: where each hangs, over the edge of the roof, and the way it shines: outward and down.
    pub fn floodlights(&self, tower: &Tower) -> [(Vec3, Vec3); 3] {
        let (center, half) = (self.rect.center(), 0.5 * self.rect.size().x);
        // Toward the town's middle, and to the sides of that.
        let inward = (-center).normalize_or(Vec2::X);
        [0.0, 1.9, -1.9].map(|turn| {
            let way = Vec2::from_angle(turn).rotate(inward);
            // Where that way leaves the square.
            let edge = center + way * (half + 0.5) / way.abs().max_element();
            let axis = Vec3::new(way.x, -1.1, way.y).normalize();
            (Vec3::new(edge.x, self.roof(tower) + 0.9, edge.y), axis)
        })
    }
}
