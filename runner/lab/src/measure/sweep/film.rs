//! Films: what a plan with `[motion]` measures of each point in place of a frame at rest.
//!
//! A run begins at rest, moves, and stops, or cuts to another camera. Pictures of all parts of it are judged against the sum over
//! all lights at the very points that they shaded, so that error of light and error of edges are told apart.

use super::pictures;
use super::plan::{MotionPlan, Plan, PointSpec};
use super::point::{Measurement, Run, is_checkpoint};
use super::truth::{self, AboutTruth, Truth};
use crate::measure::metrics::{self, Metrics};
use crate::measure::statistics::{Interval, Times};
use crate::measure::times::PassTimes;
use candela::error::{Error, Result};
use candela::exposure;
use candela::frame::renderer::Renderer;
use candela::scene::{SceneCamera, SceneDescription};
use colorvideovdp::{Color, Cvvdp, DisplayModel, Image, Options};
use glam::{UVec2, Vec3};
use serde::{Deserialize, Serialize};
use shared::camera::Camera;
use shared::math::luminance;
use shared::resources::Resource;
use shared::surface::GBufferTexel;
use std::collections::BTreeMap;

/// What is known of a point that moves.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Film {
    /// Those that were judged, in order.
    pub pictures: Vec<JudgedPicture>,
    /// Correlation of relative errors of the same surface points in pictures one apart, and [`MotionPlan::every`] apart, while the
    /// camera moves; points on things that move are left out. 1: noise sticks to surfaces; 0: each picture has its own.
    pub correlation: [f64; 2],
    /// Quality of the first pictures of the motion as a film, in just objectionable differences from the truth: 10 is the best
    /// (ColorVideoVDP, Mantiuk et al. 2024).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jod: Option<f64>,
    /// ms of frames at rest, before the motion.
    pub rest_frame: Times,
}

/// One picture of a film, over the runs.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct JudgedPicture {
    /// Number, from the beginning of the motion on; negative at rest.
    pub number: i32,
    pub phase: Phase,
    pub rel_mse: Interval,
    pub smape: Interval,
    pub chroma: Interval,
    pub energy_ratio: Interval,
    /// Of the first run.
    pub flip: f64,
    /// Share of pixels whose point is new; none where points do not last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub new_points: Option<f64>,
    /// A part of the picture as a JPEG in Base64, of some.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub picture: String,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Before anything moves.
    #[default]
    Rest,
    Moving,
    /// After the stop or the cut.
    After,
}

/// What the camera of a film does: `name` moves or stands, `from > to` cuts.
struct Take<'a> {
    from: Option<&'a str>,
    cut_to: Option<&'a str>,
    motion: &'a MotionPlan,
}

impl<'a> Take<'a> {
    fn new(motion: &'a MotionPlan, camera: Option<&'a str>) -> Self {
        match camera.and_then(|text| text.split_once('>')) {
            Some((from, to)) => Take { from: Some(from.trim()), cut_to: Some(to.trim()), motion },
            None => Take { from: camera, cut_to: None, motion },
        }
    }

    /// Frames in motion.
    fn moving(&self) -> u32 {
        if self.cut_to.is_some() { 0 } else { self.motion.moving }
    }

    fn frames(&self) -> u32 {
        self.motion.rest + self.moving() + self.motion.after
    }

    /// Of a frame, and its number within that.
    fn phase(&self, frame: u32) -> (Phase, u32) {
        let (rest, moving) = (self.motion.rest, self.moving());
        match frame {
            f if f < rest => (Phase::Rest, f),
            f if f < rest + moving => (Phase::Moving, f - rest),
            f => (Phase::After, f - rest - moving),
        }
    }

    /// On the scene's clock, s.
    fn time(&self, frame: u32) -> f64 {
        let moved = (frame + 1).saturating_sub(self.motion.rest).min(self.moving());
        f64::from(moved) / f64::from(self.motion.fps)
    }

    fn is_judged(&self, frame: u32) -> bool {
        match self.phase(frame) {
            (Phase::Rest, i) => i + 1 == self.motion.rest,
            (Phase::Moving, i) => i % self.motion.every < 2,
            (Phase::After, i) => is_checkpoint(i + 1) || frame + 1 == self.frames(),
        }
    }

    /// Is it a picture of the film that is judged as a whole?
    fn is_filmed(&self, frame: u32) -> bool {
        frame.checked_sub(self.motion.rest).is_some_and(|number| number < self.motion.film)
    }

    /// The scene as `frame` shows it, and its camera.
    fn set(&self, frame: u32, scene: &mut SceneDescription) -> Result<SceneCamera> {
        let pose = scene.pose(self.time(frame));
        scene.apply(&pose);
        scene.camera(self.cut_to.filter(|_| frame >= self.motion.rest).or(self.from))
    }
}

/// The camera that a film begins with, under the name of what it does.
pub fn first_camera(
    motion: &MotionPlan,
    camera: Option<&str>,
    scene: &mut SceneDescription,
) -> Result<SceneCamera> {
    let take = Take::new(motion, camera);
    if let Some(to) = take.cut_to {
        scene.camera(Some(to))?;
    }
    let first = take.set(0, scene)?;
    Ok(SceneCamera { name: camera.map_or(first.name, str::to_owned), ..first })
}

/// Frames that [`measure`] renders, truths aside.
pub fn frames_of(motion: &MotionPlan, replicas: u32) -> u64 {
    u64::from(replicas + 1) * u64::from(motion.rest + motion.moving + motion.after)
}

/// Fills times and the film. `tick` is called after each frame.
pub fn measure(
    renderer: &mut Renderer,
    scene: &mut SceneDescription,
    plan: &Plan,
    motion: &MotionPlan,
    spec: &PointSpec,
    mut tick: impl FnMut(),
) -> Result<Measurement> {
    let take = Take::new(motion, spec.camera.as_deref());
    let mut shoot = Shooting { run: Run::new(renderer, spec), take, scene };
    let mut point = Measurement { settings: spec.settings.clone(), ..Measurement::default() };
    // Times first: nothing is read back between these frames.
    shoot.begin()?;
    point.settled = Some(shoot.run.settle(plan)?);
    let (mut times, mut still) = (PassTimes::default(), PassTimes::default());
    shoot.begin()?;
    for frame in 0..shoot.take.frames() {
        let steps = shoot.frame(frame, plan.seed)?;
        match shoot.take.phase(frame) {
            (Phase::Rest, i) if 2 * i >= motion.rest => still.add(Some(steps)),
            (Phase::Moving, _) => times.add(Some(steps)),
            (Phase::After, _) if shoot.take.cut_to.is_some() => times.add(Some(steps)),
            _ => {}
        }
        tick();
    }
    let mut judge = Judge::new(motion, plan.size());
    for replica in 0..plan.replicas {
        shoot.begin()?;
        for frame in 0..shoot.take.frames() {
            let seed = plan.seed + 1 + replica;
            shoot.frame(frame, seed)?;
            let filmed = replica == 0 && shoot.take.is_filmed(frame);
            if shoot.take.is_judged(frame) || filmed {
                let shot = shoot.shot(seed)?;
                judge.see(&shoot.take, replica, frame, shot)?;
            }
            tick();
        }
        judge.before = None;
    }
    point.passes = times.passes().into_iter().map(|(stem, t)| (stem.to_owned(), t)).collect();
    point.frame = times.frames();
    point.clock = shoot.run.clock();
    point.film = Some(judge.film(still.frames())?);
    Ok(point)
}

/// A scene in front of a camera.
struct Shooting<'a> {
    run: Run<'a>,
    take: Take<'a>,
    scene: &'a mut SceneDescription,
}

/// A picture, and what is known of it.
struct Shot {
    camera: Camera,
    gbuffer: Vec<GBufferTexel>,
    radiance: Vec<Vec3>,
    truth: Vec<Vec3>,
    /// Pixels whose point is new.
    new_points: Option<u32>,
}

impl Shooting<'_> {
    /// From the first frame on, without a past.
    fn begin(&mut self) -> Result<()> {
        self.show(0)?;
        self.run.renderer.restart();
        Ok(())
    }

    fn show(&mut self, frame: u32) -> Result<()> {
        let size = self.run.renderer.size();
        self.run.camera = self.take.set(frame, self.scene)?.seen_in(size);
        if self.scene.changes() {
            let pose = self.scene.pose(self.take.time(frame));
            self.run.renderer.update_scene(self.scene, &pose)?;
        }
        Ok(())
    }

    fn frame(&mut self, frame: u32, seed: u32) -> Result<candela::frame::renderer::StepTimes> {
        self.show(frame)?;
        Ok(self.run.frame(seed)?.0)
    }

    /// The last frame, and its truth. The frame after it knows nothing of that.
    fn shot(&mut self, seed: u32) -> Result<Shot> {
        let options = self.run.options(seed);
        let (camera, renderer) = (self.run.camera, &mut *self.run.renderer);
        let (radiance, gbuffer) = (renderer.radiance()?, renderer.gbuffer()?);
        let lasting = renderer.parts().1.points_last();
        let new_points = lasting.then(|| renderer.read::<u32>(Resource::hops)).transpose()?;
        let new_points = new_points.and_then(|hops| hops.first().copied());
        let samples = self.take.motion.truth_samples;
        let truth = truth::at_points(renderer, camera, &options, samples)?.radiance();
        Ok(Shot { camera, gbuffer, radiance, truth, new_points })
    }
}

/// Judges pictures as they come.
struct Judge {
    size: UVec2,
    every: u32,
    fps: f32,
    /// Of each judged frame, one of each run.
    seen: BTreeMap<u32, Seen>,
    /// The last two moving pictures that are followed by one that is looked at along surface points: (number, shot).
    before: Option<(u32, Shot)>,
    correlation: [Correlation; 2],
    /// As displayed: picture, truth.
    film: [Vec<Image>; 2],
    exposure: Option<f32>,
}

#[derive(Default)]
struct Seen {
    phase: Phase,
    number: i32,
    metrics: Vec<Metrics>,
    new_points: Option<f64>,
    picture: String,
}

/// Σab/√(Σa² Σb²).
#[derive(Clone, Copy, Default)]
struct Correlation {
    products: f64,
    squares: [f64; 2],
}

impl Correlation {
    fn add(&mut self, a: f64, b: f64) {
        self.products += a * b;
        self.squares = [self.squares[0] + a * a, self.squares[1] + b * b];
    }

    fn value(self) -> f64 {
        let scale = (self.squares[0] * self.squares[1]).sqrt();
        if scale > 0.0 { self.products / scale } else { 0.0 }
    }
}

impl Judge {
    fn new(motion: &MotionPlan, size: UVec2) -> Self {
        Judge {
            size,
            every: motion.every,
            fps: motion.fps,
            seen: BTreeMap::new(),
            before: None,
            correlation: Default::default(),
            film: Default::default(),
            exposure: None,
        }
    }

    fn see(&mut self, take: &Take, replica: u32, frame: u32, shot: Shot) -> Result<()> {
        let exposure = *self.exposure.get_or_insert_with(|| exposure::automatic(&shot.truth, 0.0));
        if replica == 0 && take.is_filmed(frame) {
            for (film, picture) in self.film.iter_mut().zip([&shot.radiance, &shot.truth]) {
                film.push(shown(picture, exposure, self.size)?);
            }
        }
        if !take.is_judged(frame) {
            return Ok(());
        }
        let (phase, number) = take.phase(frame);
        let seen = self.seen.entry(frame).or_default();
        (seen.phase, seen.number) = (phase, frame as i32 - take.motion.rest as i32);
        seen.metrics.push(match replica {
            0 => metrics::with_flip(&shot.radiance, &shot.truth, self.size).0,
            _ => metrics::metrics(&shot.radiance, &shot.truth),
        });
        if replica == 0 {
            seen.new_points = shot.new_points.map(|n| f64::from(n) / f64::from(self.size.element_product()));
            if is_shown(take, frame) {
                let truth =
                    Truth { size: self.size, radiance: shot.truth.clone(), about: AboutTruth::default() };
                seen.picture = pictures::part(&shot.radiance, &truth)?;
            }
        }
        if phase == Phase::Moving {
            self.follow(number, shot);
        }
        Ok(())
    }

    /// Compares errors with those of the moving picture one or `every` before.
    fn follow(&mut self, number: u32, shot: Shot) {
        if let Some((last, before)) = &self.before {
            let lag = [1, self.every].iter().position(|lag| number - last == *lag);
            if let Some(lag) = lag {
                correlate(&mut self.correlation[lag], before, &shot, self.size);
            }
        }
        if number.is_multiple_of(self.every) {
            self.before = Some((number, shot));
        }
    }

    fn film(self, rest_frame: Times) -> Result<Film> {
        let [test, truth] = &self.film;
        let jod = if test.is_empty() {
            None
        } else {
            // A screen of 24 inches at 0.6 m.
            let display = DisplayModel::from_name("standard_fhd").map_err(Error::internal)?;
            let metric = Cvvdp::new(display, Options::default()).map_err(Error::internal)?;
            let prediction = metric.predict_video(test, truth, self.fps, Color::Srgb);
            Some(f64::from(prediction.map_err(Error::internal)?.jod))
        };
        let picture = |seen: Seen| {
            let of = |value: &dyn Fn(&Metrics) -> f64| {
                Interval::of(&seen.metrics.iter().map(value).collect::<Vec<_>>())
            };
            JudgedPicture {
                number: seen.number,
                phase: seen.phase,
                rel_mse: of(&|m| m.rel_mse),
                smape: of(&|m| m.smape),
                chroma: of(&|m| m.chroma),
                energy_ratio: of(&|m| m.energy_ratio),
                flip: seen.metrics.first().and_then(|m| m.flip).unwrap_or_default(),
                new_points: seen.new_points,
                picture: seen.picture,
            }
        };
        Ok(Film {
            pictures: self.seen.into_values().map(picture).collect(),
            correlation: self.correlation.map(Correlation::value),
            jod,
            rest_frame,
        })
    }
}

/// Pictures of a report: the last at rest, the first and the last that moves, and two after it.
fn is_shown(take: &Take, frame: u32) -> bool {
    let (phase, number) = take.phase(frame);
    match phase {
        Phase::Rest => true,
        Phase::Moving => {
            let last = number % take.motion.every == 1 && number + take.motion.every >= take.moving();
            number == 0 || last
        }
        Phase::After => number == 0 || frame + 1 == take.frames(),
    }
}

/// Errors of `now` beside those of the pixels of `before` that show the same points.
fn correlate(sums: &mut Correlation, before: &Shot, now: &Shot, size: UVec2) {
    let mean = before.truth.iter().map(|c| f64::from(luminance(*c))).sum::<f64>() / before.truth.len() as f64;
    // Bounded, as SMAPE is.
    let error = |shot: &Shot, at: usize| {
        let (x, y) = (f64::from(luminance(shot.radiance[at])), f64::from(luminance(shot.truth[at])));
        2.0 * (x - y) / (x + y + 0.01 * mean).max(f64::MIN_POSITIVE)
    };
    for at in 0..now.gbuffer.len() {
        if let Some(was) = seen_before(before, now, at, size) {
            sums.add(error(before, was), error(now, at));
        }
    }
}

/// The pixel of `before` that shows the surface point of pixel `at`, which has not moved.
fn seen_before(before: &Shot, now: &Shot, at: usize, size: UVec2) -> Option<usize> {
    let pixel = |at: usize| UVec2::new(at as u32 % size.x, at as u32 / size.x);
    let point = |shot: &Shot, at: usize| shot.gbuffer[at].unpack(u32::MAX, &shot.camera, pixel(at), size);
    if now.gbuffer[at].is_empty() {
        return None;
    }
    let here = point(now, at).position;
    let place = before.camera.project(here - before.camera.position, size);
    let inside = place.cmpge(glam::Vec2::ZERO).all() && place.cmplt(size.as_vec2()).all();
    if !inside {
        return None;
    }
    let was = (place.y as u32 * size.x + place.x as u32) as usize;
    let texel = &before.gbuffer[was];
    let same = !texel.is_empty()
        && texel.instance() == now.gbuffer[at].instance()
        && point(before, was).position.distance(here) < SAME * texel.distance();
    same.then_some(was)
}

/// Points are the same if they lie no further apart than this part of their distance to the camera: a few pixels.
const SAME: f32 = 0.01;

/// As a display shows it, three channels in sRGB.
fn shown(picture: &[Vec3], exposure: f32, size: UVec2) -> Result<Image> {
    let values = picture.iter().flat_map(|&c| {
        shared::tonemap::display(if c.is_finite() { c } else { Vec3::ZERO }, exposure).to_array()
    });
    Image::new(size.x as usize, size.y as usize, 3, values.collect()).map_err(Error::internal)
}

impl Film {
    /// The last picture at rest, in a film that cuts the last of all.
    pub fn at_rest(&self) -> Option<&JudgedPicture> {
        match self.has_motion() {
            true => self.pictures.iter().rev().find(|p| p.phase == Phase::Rest),
            false => self.pictures.last(),
        }
    }

    /// Is there anything but a cut?
    pub fn has_motion(&self) -> bool {
        self.pictures.iter().any(|p| p.phase == Phase::Moving)
    }

    /// Mean of a number over the pictures in motion, after a cut over those after it.
    pub fn in_motion(&self, value: impl Fn(&JudgedPicture) -> f64) -> f64 {
        let phase = if self.has_motion() { Phase::Moving } else { Phase::After };
        let values: Vec<f64> = self.pictures.iter().filter(|p| p.phase == phase).map(value).collect();
        values.iter().sum::<f64>() / values.len().max(1) as f64
    }

    /// Pictures after the stop or the cut until SMAPE is at most `times` that at rest, of those judged; none if it never is.
    pub fn pictures_to(&self, times: f64) -> Option<u32> {
        let rest = self.at_rest()?.smape.mean;
        let after: Vec<_> = self.pictures.iter().filter(|p| p.phase == Phase::After).collect();
        let first = after.first()?.number;
        let there = after.iter().find(|p| p.smape.mean <= times * rest)?;
        u32::try_from(there.number - first + 1).ok()
    }
}

/// Every point light goes round a level circle of `radius` m once in two seconds.
pub fn circle_lights(scene: &mut SceneDescription, radius: f64) {
    use candela::scene::PlacedLight;
    use candela::scene::animation::{Channel, Curve, Interpolation, Local, Node, Thing, Track};
    use glam::{DAffine3, DQuat, DVec3};
    const SECONDS: u32 = 10;
    const RATE: u32 = 32;
    let times: Vec<f32> = (0..=SECONDS * RATE).map(|key| key as f32 / RATE as f32).collect();
    for (i, light) in scene.lights.iter().enumerate() {
        let PlacedLight::Point(light) = light else { continue };
        let at = |time: &f32| {
            let (sin, cos) = (std::f64::consts::PI * f64::from(*time)).sin_cos();
            light.position.as_dvec3() + radius * DVec3::new(cos - 1.0, 0.0, sin)
        };
        let values: Vec<DVec3> = times.iter().map(at).collect();
        let node = scene.animation.nodes.len();
        let rest = Local::Trs { translation: values[0], rotation: DQuat::IDENTITY, scale: DVec3::ONE };
        scene.animation.nodes.push(Node { parent: None, base: DAffine3::IDENTITY, rest });
        scene.animation.attached.push((Thing::Light(i), node));
        let track = Track { interpolation: Interpolation::Linear, times: times.clone(), values };
        scene.animation.channels.push(Channel { node, curve: Curve::Translation(track) });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use shared::geometry::SurfacePoint;
    use shared::material::Reflectance;

    const SIZE: UVec2 = UVec2::new(32, 16);

    fn motion() -> MotionPlan {
        MotionPlan { rest: 4, moving: 20, after: 10, every: 8, film: 3, ..MotionPlan::default() }
    }

    #[test]
    fn films_rest_move_and_stop() {
        let motion = motion();
        let take = Take::new(&motion, Some("walk"));
        let judged: Vec<i32> =
            (0..take.frames()).filter(|f| take.is_judged(*f)).map(|f| f as i32 - 4).collect();
        // At rest; in motion 0, 1, 8, 9, 16, 17; after it 1, 2, 3, 4, 6, 8 and the last.
        assert_eq!(judged, [-1, 0, 1, 8, 9, 16, 17, 20, 21, 22, 23, 25, 27, 29]);
        assert_eq!((take.time(3), take.time(4), take.time(23)), (0.0, 1.0 / 60.0, 20.0 / 60.0));
        assert_eq!(take.time(33), take.time(23), "it stands");
        assert!(!take.is_filmed(3) && take.is_filmed(4) && take.is_filmed(6) && !take.is_filmed(7));
        let cut = Take::new(&motion, Some("a > b"));
        assert_eq!((cut.from, cut.cut_to, cut.frames()), (Some("a"), Some("b"), 14));
        assert_eq!((cut.phase(3), cut.phase(4), cut.time(13)), ((Phase::Rest, 3), (Phase::After, 0), 0.0));
    }

    #[test]
    fn cuts_and_motions_have_their_cameras() {
        let motion = motion();
        let mut scene = candela::scene::procedural::knot::knot();
        let at = |frame, text: &str, scene: &mut SceneDescription| {
            Take::new(&motion, Some(text)).set(frame, scene).map(|camera| camera.position)
        };
        let [front, orbit] = [0, 1].map(|camera| scene.cameras[camera].position);
        assert_eq!(at(3, "front > strafe", &mut scene).unwrap(), front);
        assert_ne!(at(4, "front > strafe", &mut scene).unwrap(), front);
        assert_eq!(at(3, "orbit", &mut scene).unwrap(), orbit);
        assert_ne!(at(8, "orbit", &mut scene).unwrap(), at(9, "orbit", &mut scene).unwrap());
        assert!(at(8, "front > nowhere", &mut scene).unwrap_err().to_string().contains("nowhere"));
        assert!(first_camera(&motion, Some("front > nowhere"), &mut scene).is_err(), "before any work");
    }

    /// A wall 10 m away, whose truth is 1 everywhere, seen by a camera that steps aside by `step` pixels.
    fn wall(step: f32, error: impl Fn(Vec2) -> f32) -> Shot {
        let aside = step * 2.0 * 10.0 * 0.5f32.tan() / SIZE.y as f32;
        let camera = Camera::new(aside * Vec3::X, Vec3::NEG_Z, Vec3::Y, 1.0, SIZE);
        let (mut gbuffer, mut radiance) = (Vec::new(), Vec::new());
        for y in 0..SIZE.y {
            for x in 0..SIZE.x {
                let way = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), SIZE);
                let position = camera.position + way * (10.0 / -way.z);
                let point = SurfacePoint {
                    position,
                    geometric_normal: Vec3::Z,
                    normal: Vec3::Z,
                    tangent: Vec3::X,
                    tangent_sign: 1.0,
                    uv: Vec2::ZERO,
                    color: Vec3::ONE,
                };
                let gray = Reflectance { diffuse: Vec3::splat(0.5), f0: Vec3::ZERO, roughness: 1.0 };
                gbuffer.push(GBufferTexel::new(&point, Vec3::Z, gray, 3, camera.position));
                radiance.push(Vec3::splat(1.0 + error(position.truncate())));
            }
        }
        let truth = vec![Vec3::ONE; radiance.len()];
        Shot { camera, gbuffer, radiance, truth, new_points: None }
    }

    /// Noise that sticks to the wall correlates along it and not from pixel to pixel; the wall's other instance has none.
    #[test]
    fn errors_are_compared_along_surfaces() {
        let noise = |p: Vec2| 0.2 * (9.1 * p.x.floor()).sin() * (5.3 * p.y.floor()).cos();
        let value = |now: &Shot| {
            let mut sums = Correlation::default();
            correlate(&mut sums, &wall(0.0, noise), now, SIZE);
            sums.value()
        };
        let stuck = value(&wall(6.0, noise));
        assert!(stuck > 0.8, "{stuck}");
        let aside = 6.0 * 2.0 * 10.0 * 0.5f32.tan() / SIZE.y as f32;
        let carried = value(&wall(6.0, |p| noise(p - aside * Vec2::X)));
        assert!(carried < 0.5, "noise that goes with the picture: {carried}");
        let mut other = wall(6.0, noise);
        other.gbuffer.iter_mut().for_each(|texel| texel.instance ^= 1);
        assert_eq!(value(&other), 0.0);
    }

    /// The truth is without a difference; noise that boils is worse than noise that stands.
    #[test]
    fn films_are_judged_in_jod() {
        let jod = |noise: &dyn Fn(u32, u32) -> f32| {
            let mut judge = Judge::new(&motion(), SIZE);
            for frame in 0..8 {
                let picture: Vec<Vec3> =
                    (0..SIZE.element_product()).map(|i| Vec3::splat(0.4 + noise(i, frame))).collect();
                judge.film[0].push(shown(&picture, 1.0, SIZE).unwrap());
                judge.film[1].push(shown(&vec![Vec3::splat(0.4); picture.len()], 1.0, SIZE).unwrap());
            }
            judge.film(Times::default()).unwrap().jod.unwrap()
        };
        let hash = |i: u32| f32::from((i.wrapping_mul(2_654_435_761) >> 16) as u16) / 65535.0 - 0.5;
        let (same, still) = (jod(&|_, _| 0.0), jod(&|i, _| 0.2 * hash(i)));
        assert!((same - 10.0).abs() < 1e-3 && still < 9.5, "{same} {still}");
        let twice = jod(&|i, _| 0.4 * hash(i));
        assert!(twice < still, "{twice} {still}");
    }
}
