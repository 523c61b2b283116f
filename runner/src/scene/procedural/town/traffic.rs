//! Traffic: cars that drive around their blocks, and the camera's drive through the town.

use super::cars;
use super::plan::{Plan, Rect, SIDES, Usage};
use crate::scene::animation::{Animation, Local, Node, Thing};
use crate::scene::procedural::path;
use glam::{DAffine3, DVec3, Quat, Vec2, Vec3};

/// Time of a round and of the drive, s.
pub const DURATION: f32 = 24.0;
/// Cars keep this far from the drive, m.
const CLEAR: f32 = 7.0;
/// Keys of a round or of the drive.
const KEYS: usize = 480;
/// Blocks farther from the middle have no traffic, m.
const BUSY: f32 = 330.0;

/// Straight legs with arcs between them, m.
#[derive(Clone, Debug)]
pub struct Path {
    /// (length from the start, place); many.
    points: Vec<(f32, Vec2)>,
}

impl Path {
    /// Through `corners`, which arcs of `radius` round off; closed, or from the first to the last.
    fn new(corners: &[Vec2], radius: f32, closed: bool) -> Self {
        let n = corners.len();
        let mut places = Vec::new();
        for i in 0..n {
            if !closed && (i == 0 || i + 1 == n) {
                places.push(corners[i]);
                continue;
            }
            let (a, b, c) = (corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]);
            let (before, after) = ((b - a).normalize(), (c - b).normalize());
            // Turns of a quarter.
            let middle = b - radius * before + radius * after;
            for k in 0..=16 {
                let (sin, cos) = (std::f32::consts::FRAC_PI_2 * k as f32 / 16.0).sin_cos();
                places.push(middle - radius * cos * after + radius * sin * before);
            }
        }
        if closed {
            places.push(places[0]);
        }
        let mut points = vec![(0.0, places[0])];
        for pair in places.windows(2) {
            let (length, _) = points[points.len() - 1];
            points.push((length + pair[0].distance(pair[1]), pair[1]));
        }
        Path { points }
    }

    pub fn length(&self) -> f32 {
        self.points[self.points.len() - 1].0
    }

    /// The place at a length from the start; before the start and after the end straight on.
    pub fn at(&self, length: f32) -> Vec2 {
        let after = self.points.partition_point(|point| point.0 <= length).clamp(1, self.points.len() - 1);
        let ((l0, a), (l1, b)) = (self.points[after - 1], self.points[after]);
        a + (b - a) * ((length - l0) / (l1 - l0).max(1e-6))
    }
}

/// A car's way round its block.
pub struct Round {
    path: Path,
    /// Share of the way at time 0.
    start: f32,
    pub color: usize,
}

impl Round {
    pub fn at(&self, time: f32) -> Vec2 {
        self.path.at(self.path.length() * (time / DURATION + self.start).fract())
    }

    /// Unit. Looks back as far as forward, as its wheels do.
    pub fn way(&self, time: f32) -> Vec2 {
        let length = self.path.length() * (time / DURATION + self.start).fract();
        let at = |l: f32| self.path.at(l.rem_euclid(self.path.length()));
        (at(length + 1.3) - at(length - 1.3)).normalize_or(Vec2::X)
    }
}

/// The middle of the lane next to a block, clockwise from above: traffic keeps right.
fn lane(plan: &Plan, block: usize) -> (Rect, f32) {
    let block = &plan.blocks[block];
    let [north, east, south, west] = SIDES.map(|side| plan.rank(block, side).lane());
    let rect = Rect::new(block.curb.min - Vec2::new(west, north), block.curb.max + Vec2::new(east, south));
    (rect, 1.5 * [north, east, south, west].into_iter().fold(f32::INFINITY, f32::min))
}

/// All cars that move, near the middle first; none meets the drive.
pub fn rounds(plan: &Plan) -> Vec<Round> {
    let mut blocks: Vec<usize> = (0..plan.blocks.len())
        .filter(|&i| plan.blocks[i].distance() < BUSY && plan.blocks[i].usage != Usage::Park)
        .collect();
    blocks.sort_by(|&a, &b| plan.blocks[a].distance().total_cmp(&plan.blocks[b].distance()));
    let drive = drive();
    let mut rounds = Vec::new();
    for (i, block) in blocks.into_iter().enumerate() {
        let (rect, radius) = lane(plan, block);
        let [a, b, c, d] =
            [rect.min, Vec2::new(rect.max.x, rect.min.y), rect.max, Vec2::new(rect.min.x, rect.max.y)];
        let path = Path::new(&[a, b, c, d], radius, true);
        for start in [0.13 * (i % 5) as f32, 0.13 * (i % 5) as f32 + 0.47] {
            let round = Round { path: path.clone(), start, color: (i + rounds.len()) % cars::COLORS.len() };
            let meets = |k: u16| {
                let time = f32::from(k) * 0.1;
                round.at(time).distance(drive.at(time)) < CLEAR
            };
            if i % 2 == 0 && !(0..=(10.0 * DURATION) as u16).any(meets) {
                rounds.push(round);
            }
        }
    }
    rounds
}

/// The drive, as lengths of its way at equal times: slow in corners.
pub struct Drive {
    path: Path,
    lengths: Vec<f32>,
}

/// Along the avenue to the square, round its north side and on to the west.
pub fn drive() -> Drive {
    // Off the middle of the avenue, off the middle of the streets.
    let (avenue, street) = (2.4, 1.7);
    let corners = [
        Vec2::new(112.0, -avenue),
        Vec2::new(56.0 + street, -avenue),
        Vec2::new(56.0 + street, -58.0 - street),
        Vec2::new(-56.0 - street, -58.0 - street),
        Vec2::new(-56.0 - street, -avenue),
        Vec2::new(-92.0, -avenue),
    ];
    let path = Path::new(&corners, 9.0, false);
    let turns = &corners[1..corners.len() - 1];
    // s/m: 7 m/s in corners, twice as fast away from them; the whole is stretched to the duration.
    let slowness = |length: f32| {
        let at = path.at(length);
        let corner = turns.iter().map(|turn| turn.distance(at)).fold(f32::INFINITY, f32::min);
        let t = ((corner - 5.0) / 22.0).clamp(0.0, 1.0);
        1.0 / (7.0 + 7.0 * t * t * (3.0 - 2.0 * t))
    };
    let step = path.length() / 2000.0;
    let mut clock = vec![0.0];
    for i in 0..2000u16 {
        clock.push(clock[usize::from(i)] + step * slowness((f32::from(i) + 0.5) * step));
    }
    let total = clock[2000];
    let lengths = (0..=KEYS)
        .map(|key| {
            let time = total * key as f32 / KEYS as f32;
            let after = clock.partition_point(|&c| c < time).clamp(1, 2000);
            let t = (time - clock[after - 1]) / (clock[after] - clock[after - 1]);
            step * (after as f32 - 1.0 + t)
        })
        .collect();
    Drive { path, lengths }
}

impl Drive {
    /// How far it has gone.
    fn length(&self, time: f32) -> f32 {
        let key = (time / DURATION).clamp(0.0, 1.0) * KEYS as f32;
        let before = (key as usize).min(KEYS - 1);
        let [a, b] = [self.lengths[before], self.lengths[before + 1]];
        a + (b - a) * (key - before as f32)
    }

    pub fn at(&self, time: f32) -> Vec2 {
        self.path.at(self.length(time))
    }
}

/// Height of the driver's eyes, m.
pub const EYES: f32 = 1.45;

/// Where the driver is and looks: somewhat ahead, so that turns begin softly.
pub fn driver(drive: &Drive, time: f32) -> (Vec3, Vec2) {
    let here = drive.at(time);
    let length = drive.length(time);
    let mut way = Vec2::ZERO;
    for k in 1..=6 {
        way += (drive.path.at(length + 2.0 * k as f32) - here).normalize_or_zero();
    }
    (Vec3::new(here.x, EYES, here.y), way.normalize_or(Vec2::NEG_X))
}

/// Adds a node that follows `place` (where, and the way it heads) and returns it.
pub fn follow(animation: &mut Animation, place: impl Fn(f32) -> (Vec3, Vec2)) -> usize {
    let key = |key: usize| {
        let time = DURATION * key as f32 / KEYS as f32;
        let (at, way) = place(time);
        (time, at.as_dvec3(), cars::heading(way).as_dquat())
    };
    path::follow(animation, (0..=KEYS).map(key))
}

/// Hangs `thing` on `parent`, at a place of its own in the parent's space.
pub fn attach(animation: &mut Animation, thing: Thing, parent: usize, at: Vec3, turn: Quat) {
    let rest = Local::Trs { translation: at.as_dvec3(), rotation: turn.as_dquat(), scale: DVec3::ONE };
    animation.nodes.push(Node { parent: Some(parent), base: DAffine3::IDENTITY, rest });
    animation.attached.push((thing, animation.nodes.len() - 1));
}
