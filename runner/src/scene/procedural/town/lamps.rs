//! Street lamps: lanterns in the old town, masts with an arm elsewhere.

use super::dice::Dice;
use super::materials::{Finish, Part};
use super::plan::{KERB, Plan, Rank, SIDES, Side, Usage};
use super::square;
use crate::scene::procedural::shapes::{Outline, cuboid, lathe, tube};
use crate::scene::{PlacedLight, PointLight, SpotLight};
use glam::{Affine3A, Quat, Vec2, Vec3};

/// From the kerb to the foot, m.
const SETBACK: f32 = 0.55;
/// Mean distance between lamps of one side, m.
const PITCH: f32 = 24.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Lantern,
    Mast,
}

/// A lamp in its place.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    pub kind: Kind,
    pub foot: Vec2,
    /// The arm reaches over the road on this side.
    pub side: Side,
    /// cd
    intensity: f32,
}

/// All lamps, those near the town's middle first.
pub fn lamps(plan: &Plan) -> Vec<Lamp> {
    let mut lamps = Vec::new();
    for (i, block) in plan.blocks.iter().enumerate() {
        let mut dice = Dice::new(50, i);
        for side in SIDES {
            let [left, right] = block.curb.edge(side);
            let length = left.distance(right);
            let count = (length / PITCH).round().max(1.0) as usize;
            let avenue = plan.rank(block, side) == Rank::Avenue;
            let old = block.distance() < 190.0 || matches!(block.usage, Usage::Square | Usage::Park);
            let kind = if old && !avenue { Kind::Lantern } else { Kind::Mast };
            for k in 0..count {
                let at = left.lerp(right, (k as f32 + 0.5) / count as f32);
                let intensity = if avenue { dice.within(70.0..80.0) } else { dice.within(40.0..66.0) };
                lamps.push(Lamp { kind, foot: at - SETBACK * side.outward(), side, intensity });
            }
        }
        let free: Vec<Vec2> = match block.usage {
            Usage::Square => square::lanterns().collect(),
            Usage::Park => {
                let inner = block.plot.inset(9.0);
                let share = |k: usize| Vec2::new((k % 5) as f32 / 4.0, (k / 5) as f32);
                (0..10).map(|k| inner.min + inner.size() * share(k)).collect()
            }
            Usage::Houses | Usage::Towers => Vec::new(),
        };
        let lantern = |foot| Lamp { kind: Kind::Lantern, foot, side: Side::South, intensity: 45.0 };
        lamps.extend(free.into_iter().map(lantern));
    }
    lamps.sort_by(|a, b| a.foot.length().total_cmp(&b.foot.length()));
    lamps
}

impl Lamp {
    pub fn transform(&self) -> Affine3A {
        let foot = Vec3::new(self.foot.x, KERB, self.foot.y);
        Affine3A::from_rotation_translation(Quat::from_rotation_y(self.side.turn()), foot)
    }

    pub fn light(&self) -> PlacedLight {
        let place = self.transform();
        match self.kind {
            Kind::Lantern => {
                let color = Vec3::new(1.30, 0.93, 0.46);
                let position = place.transform_point3(LANTERN);
                PointLight { position, intensity: color * self.intensity, radius: 0.0 }.into()
            }
            Kind::Mast => {
                let color = Vec3::new(1.32, 0.94, 0.40);
                let position = place.transform_point3(HEAD);
                SpotLight {
                    position,
                    axis: Vec3::NEG_Y,
                    intensity: color * self.intensity,
                    inner_angle: 1.0,
                    outer_angle: 1.45,
                    radius: 0.0,
                }
                .into()
            }
        }
    }
}

/// Where the lights are, in the space of the lamp; arms reach to +z.
const LANTERN: Vec3 = Vec3::new(0.0, 4.17, 0.0);
const HEAD: Vec3 = Vec3::new(0.0, 6.05, 1.55);

/// A lamp that shines, or one that doesn't.
pub fn mesh(kind: Kind, lit: bool) -> Part {
    let glass = if lit { Finish::Bulb } else { Finish::Glass };
    match kind {
        Kind::Lantern => {
            let post = Outline::from(0.17, 0.0)
                .to(0.17, 0.12)
                .to(0.11, 0.2)
                .to(0.10, 0.75)
                .to(0.06, 0.85)
                .to(0.045, 3.7)
                .to(0.09, 3.76)
                .to(0.09, 3.8)
                .to(0.0, 3.8)
                .open();
            let cap =
                Outline::from(0.27, 4.42).to(0.28, 4.46).to(0.1, 4.66).to(0.03, 4.7).to(0.0, 4.82).open();
            let under = Outline::from(0.0, 4.40).to(0.27, 4.42).open();
            let mut part = Part::of(Finish::Iron, lathe(&post, 8));
            part.add(Finish::Iron, &lathe(&cap, 6).with(lathe(&under, 6)));
            for (x, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0f32)] {
                let foot = Vec3::new(0.055 * x, 3.8, 0.055 * z);
                part.add(Finish::Iron, &tube(foot, Vec3::new(0.18 * x, 4.42, 0.18 * z), 0.012, 4));
            }
            let bulb = Outline::from(0.0, 4.24).to(0.085, 4.32).to(0.06, 4.40).open();
            part.with(glass, lathe(&bulb, 8))
        }
        Kind::Mast => {
            let post =
                Outline::from(0.11, 0.0).to(0.11, 0.9).to(0.08, 1.0).to(0.05, 6.15).to(0.0, 6.15).open();
            let mut part = Part::of(Finish::Steel, lathe(&post, 8));
            part.add(Finish::Steel, &tube(Vec3::new(0.0, 6.1, 0.0), Vec3::new(0.0, 6.22, 1.3), 0.035, 6));
            part.add(Finish::Steel, &cuboid(Vec3::new(-0.16, 6.16, 1.2), Vec3::new(0.16, 6.27, 1.9)));
            part.with(glass, cuboid(Vec3::new(-0.12, 6.12, 1.3), Vec3::new(0.12, 6.16, 1.85)))
        }
    }
}
