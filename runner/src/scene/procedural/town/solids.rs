//! Solid parts of the town in closed form, for tests of positions; independent of the triangles.

use super::lots::{self, Lot};
use super::plan::{EDGE, Plan, Rect};
use super::{houses, room, square, towers};
use crate::scene::Bounds;
use glam::{Affine3A, Mat3, Vec2, Vec3};

/// A box of a house, in the house's space.
#[derive(Clone, Debug)]
pub struct Solid {
    to_world: Affine3A,
    outside: Bounds,
    /// Rooms in it that are open.
    hollows: Vec<Bounds>,
}

/// Houses, towers, the hall.
pub fn solids(plan: &Plan) -> Vec<Solid> {
    let designs = houses::designs();
    let house = |lot: &Lot| {
        let house = &designs[lot.design];
        let half = 0.5 * lots::width(house);
        let outside =
            Bounds { min: Vec3::new(-half, 0.0, -houses::DEPTH), max: Vec3::new(half, house.top, 0.0) };
        Solid { to_world: lot.transform, outside, hollows: house.hollows.clone() }
    };
    let mut solids: Vec<Solid> = lots::lots(plan, &designs).iter().map(house).collect();
    let towers = towers::designs();
    solids.extend(towers::sites(plan).iter().map(|site| block(site.rect, site.roof(&towers[site.design]))));
    if let Some(to_world) = room::transform(plan) {
        let half = 0.5 * room::WIDTH;
        let min = Vec3::new(-half, 0.0, -houses::DEPTH);
        let outside = Bounds { min, max: Vec3::new(half, room::EAVES + 0.8, 0.0) };
        solids.push(Solid { to_world, outside, hollows: vec![room::ROOM] });
    }
    use square::{DEPTH, EAVES, FRONT, PORCH, TOWER, WALLS, WING};
    let hall = Rect::new(Vec2::new(-WING, FRONT - DEPTH), Vec2::new(WING, FRONT));
    let tower = Rect::around(Vec2::new(0.0, FRONT + PORCH - TOWER), Vec2::splat(2.0 * TOWER));
    solids.extend([block(hall, EAVES), block(tower, WALLS)]);
    solids
}

/// Is this on a road, between kerbs?
pub fn on_road(plan: &Plan, p: Vec2) -> bool {
    p.abs().max_element() < EDGE && !plan.blocks.iter().any(|block| block.curb.contains(p))
}

/// Between a rectangle on the ground and a height.
fn block(rect: Rect, height: f32) -> Solid {
    let min = Vec3::new(rect.min.x, 0.0, rect.min.y);
    let outside = Bounds { min, max: Vec3::new(rect.max.x, height, rect.max.y) };
    Solid { to_world: Affine3A::IDENTITY, outside, hollows: Vec::new() }
}

impl Solid {
    /// Is `p` in it, at least `depth` (m) under its surface? Negative: or so far outside.
    pub fn contains(&self, p: Vec3, depth: f32) -> bool {
        let to_local = self.to_world.inverse();
        let local = to_local.transform_point3(p);
        // Along the axes, as transforms keep right angles.
        let linear = Mat3::from(to_local.matrix3);
        let shrink = depth * (linear.x_axis.abs() + linear.y_axis.abs() + linear.z_axis.abs());
        let within = |b: &Bounds, by: Vec3| local.cmpgt(b.min + by).all() && local.cmplt(b.max - by).all();
        within(&self.outside, shrink) && !self.hollows.iter().any(|hollow| within(hollow, -shrink))
    }

    /// How far this and `other` reach into each other, m: at most 0 where they are apart.
    pub fn overlap(&self, other: &Solid) -> f32 {
        let [a, b] = [self, other].map(Solid::bounds);
        (a.max.min(b.max) - a.min.max(b.min)).min_element()
    }

    fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::default();
        for p in [self.outside.min, self.outside.max] {
            bounds.add(self.to_world.transform_point3(p));
        }
        bounds
    }

    pub fn in_square(&self) -> bool {
        self.bounds().center().length() < 55.0
    }
}
