//! Roads with their paint, pavements, yards and the land around the town.

use super::materials::{Finish, Part};
use super::plan::{EDGE, HALF, KERB, Plan, Rank, Rect, SIDES, Segment, Usage};
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::{Shape, cuboid, polygon};
use glam::{Vec2, Vec3};

/// Meshes of the ground along each axis: small ones suit ray tracing.
const PARTS: usize = 6;
/// Side of the square within the outermost kerbs, m.
const LAND: f32 = 2.0 * EDGE;
/// Width of the stripes of crossings and of the lines between lanes, m.
const STRIPE: f32 = 0.5;
const LINE: f32 = 0.14;

pub fn add(kit: &mut Kit, plan: &Plan) {
    let mut parts: Vec<Part> = vec![Part::default(); PARTS * PARTS];
    let index = |p: Vec2| {
        let of = |x: f32| (((x / HALF + 1.0) * 0.5 * PARTS as f32) as usize).min(PARTS - 1);
        of(p.x) * PARTS + of(p.y)
    };
    for segment in &plan.segments {
        road(&mut parts[index(segment.road.center())], segment);
    }
    for crossing in &plan.crossings {
        parts[index(crossing.center())].add(Finish::Asphalt, &flat(crossing, 0.0));
    }
    for block in &plan.blocks {
        let part = &mut parts[index(block.plot.center())];
        let cover = match block.usage {
            Usage::Square => Finish::Cobble,
            Usage::Park => Finish::Grass,
            Usage::Towers => Finish::Paving,
            Usage::Houses => Finish::Gravel,
        };
        part.add(cover, &flat(&block.plot, KERB));
        pavement(part, &block.curb, &block.plot);
        if block.usage == Usage::Park {
            paths(part, &block.plot);
        }
    }
    parts.into_iter().enumerate().for_each(|(i, part)| kit.single(&format!("ground-{i}"), part));
    let (piece, middles) = land();
    let mesh = kit.mesh("land", piece);
    middles.into_iter().for_each(|middle| kit.place_at(mesh, middle));
}

/// Seen from above.
fn flat(rect: &Rect, y: f32) -> Shape {
    polygon(&rect.corners(y), Vec3::Y)
}

/// The ring between kerb and plot, and the kerb's face.
fn pavement(part: &mut Part, curb: &Rect, plot: &Rect) {
    let stone = curb.inset(0.15);
    for (finish, outer, inner) in [(Finish::Kerb, curb, &stone), (Finish::Paving, &stone, plot)] {
        let (a, b) = (outer.corners(KERB), inner.corners(KERB));
        for i in 0..4 {
            let j = (i + 1) % 4;
            part.add(finish, &polygon(&[a[i], a[j], b[j], b[i]], Vec3::Y));
        }
    }
    for side in SIDES {
        let [l, r] = curb.edge(side);
        let at = |p: Vec2, y: f32| Vec3::new(p.x, y, p.y);
        let out = at(side.outward(), 0.0);
        part.add(Finish::Kerb, &polygon(&[at(l, 0.0), at(r, 0.0), at(r, KERB), at(l, KERB)], out));
    }
}

/// Two gravel paths that cross in the middle.
fn paths(part: &mut Part, plot: &Rect) {
    let center = plot.center();
    let lift = |min: Vec2, max: Vec2| {
        cuboid(Vec3::new(min.x, KERB - 0.05, min.y), Vec3::new(max.x, KERB + 0.03, max.y))
    };
    part.add(
        Finish::Gravel,
        &lift(Vec2::new(plot.min.x, center.y - 1.5), Vec2::new(plot.max.x, center.y + 1.5)),
    );
    part.add(
        Finish::Gravel,
        &lift(Vec2::new(center.x - 1.5, plot.min.y), Vec2::new(center.x + 1.5, center.y - 1.5)),
    );
    part.add(
        Finish::Gravel,
        &lift(Vec2::new(center.x - 1.5, center.y + 1.5), Vec2::new(center.x + 1.5, plot.max.y)),
    );
}

/// A segment: near the town's middle and on avenues with paint, as strips beside each other, none on top.
fn road(part: &mut Part, segment: &Segment) {
    let rect = segment.road;
    let size = rect.size();
    let (length, width) = if segment.along_x { (size.x, size.y) } else { (size.y, size.x) };
    let mut piece = |s: [f32; 2], t: [f32; 2], painted: bool| {
        let (a, b) = (Vec2::new(s[0], t[0]), Vec2::new(s[1], t[1]));
        let (a, b) = if segment.along_x { (a, b) } else { (Vec2::new(a.y, a.x), Vec2::new(b.y, b.x)) };
        let finish = if painted { Finish::Paint } else { Finish::Asphalt };
        part.add(finish, &flat(&Rect::new(rect.min + a, rect.min + b), 0.0));
    };
    let marked = segment.rank != Rank::Lane && length > 24.0 && rect.center().length() < 300.0;
    if !marked {
        piece([0.0, length], [0.0, width], false);
        return;
    }
    // From either end: a gap, a crossing for those on foot, then the road between.
    for ends in [[0.0, 1.0, 4.0], [length, length - 1.0, length - 4.0]] {
        let order = |a: f32, b: f32| [a.min(b), a.max(b)];
        piece(order(ends[0], ends[1]), [0.0, width], false);
        let stripes = (width / STRIPE).round() as usize;
        for i in 0..stripes {
            let t = |k: usize| width * k as f32 / stripes as f32;
            piece(order(ends[1], ends[2]), [t(i), t(i + 1)], i % 2 == 1);
        }
    }
    let (from, to) = (4.0, length - 4.0);
    let lines: &[f32] = if segment.rank == Rank::Avenue { &[0.32, 0.5, 0.68] } else { &[0.5] };
    let mut left = 0.0;
    for share in lines {
        let [a, b] = [share * width - 0.5 * LINE, share * width + 0.5 * LINE];
        piece([from, to], [left, a], false);
        let dashes = 2 * (0.5 * (to - from) / 3.0).round() as usize;
        for i in 0..dashes {
            let s = |k: usize| from + (to - from) * k as f32 / dashes as f32;
            piece([s(i), s(i + 1)], [a, b], i % 2 == 0);
        }
        left = b;
    }
    piece([from, to], [left, width], false);
}

/// Grass around the town in square pieces, none of which covers the town: (mesh, middle of each).
fn land() -> (Part, Vec<Vec3>) {
    let piece = flat(&Rect::around(Vec2::ZERO, Vec2::splat(LAND)), 0.0);
    let middles = (-1..=1).flat_map(|i| (-1..=1).map(move |k| Vec3::new(i as f32, 0.0, k as f32) * LAND));
    let around: Vec<Vec3> = middles.filter(|middle| *middle != Vec3::ZERO).collect();
    (Part::of(Finish::Grass, piece), around)
}
