//! Animations -> the scene's moving nodes and their curves.

use super::accessors::Integers;
use super::nodes::Placed;
use super::warnings::Warnings;
use super::{Reason, accessors, label};
use crate::scene::animation::{Animation, Channel, Curve, Interpolation, Node, Track};
use glam::{DAffine3, DVec3, DVec4};
use gltf::Document;
use gltf::accessor::Dimensions;
use gltf::animation::Property;
use std::collections::{HashMap, HashSet};

/// What moves, and for each of `nodes` which of the animation's nodes it is.
pub struct Motion {
    pub animation: Animation,
    pub of_placed: Vec<Option<usize>>,
    /// Which of its morphs changes the mesh of a node, by the place of the node.
    pub morphs: HashMap<usize, usize>,
}

/// All animations of the file, played together; of two that move the same property of a node, the first.
/// A channel that can't be played is left out with a warning.
pub fn read(
    document: &Document,
    nodes: &[Placed],
    origin: DVec3,
    buffers: &[Vec<u8>],
    warnings: &mut Warnings,
) -> Motion {
    let place: HashMap<usize, usize> = nodes.iter().enumerate().map(|(i, p)| (p.node.index(), i)).collect();
    let (mut curves, mut morph_tracks, mut morphs) = (Vec::new(), Vec::new(), HashMap::new());
    let mut taken = HashSet::new();
    for animation in document.animations() {
        let name = label("animation", animation.index(), animation.name());
        for channel in animation.channels() {
            let target = channel.target();
            let (node, property) = (target.node(), target.property());
            let label = format!("{name}, channel {}", channel.index());
            let Some(&placed) = place.get(&node.index()) else {
                warnings.add("moves a node outside of the scene", &label);
                continue;
            };
            if property == Property::MorphTargetWeights {
                match weights(&channel, buffers, &label, warnings) {
                    Err(reason) => warnings.add("not played", &format!("{label}: {reason}")),
                    Ok(tracks) => {
                        if taken.insert((placed, property as u32)) {
                            morphs.insert(placed, morph_tracks.len());
                            morph_tracks.push(tracks);
                        } else {
                            warnings.add(TAKEN, &label);
                        }
                    }
                }
                continue;
            }
            let curve = if matches!(node.transform(), gltf::scene::Transform::Matrix { .. }) {
                Err("its node has a matrix; only translation, rotation, scale can move".into())
            } else {
                curve(&channel, buffers, &label, warnings)
            };
            let curve = match curve {
                Ok(curve) => curve,
                Err(reason) => {
                    warnings.add("not played", &format!("{label}: {reason}"));
                    continue;
                }
            };
            if taken.insert((placed, property as u32)) {
                curves.push((placed, curve));
            } else {
                warnings.add(TAKEN, &label);
            }
        }
    }
    let Motion { animation, of_placed, .. } = motion(nodes, origin, curves);
    Motion { animation: Animation { morphs: morph_tracks, ..animation }, of_placed, morphs }
}

const TAKEN: &str = "not played: another channel moves the same property";

/// Keeps the nodes that move by themselves or with a parent; the worlds of all others are folded into them.
fn motion(nodes: &[Placed], origin: DVec3, curves: Vec<(usize, Curve)>) -> Motion {
    let animated: HashSet<usize> = curves.iter().map(|&(placed, _)| placed).collect();
    let mut animation = Animation::default();
    let mut of_placed: Vec<Option<usize>> = vec![None; nodes.len()];
    // Parents come before their children.
    for (i, placed) in nodes.iter().enumerate() {
        let parent = placed.parent.and_then(|parent| of_placed[parent]);
        if parent.is_none() && !animated.contains(&i) {
            continue;
        }
        of_placed[i] = Some(animation.nodes.len());
        let resting = placed.parent.filter(|_| parent.is_none());
        let base = resting.map_or(DAffine3::from_translation(-origin), |parent| nodes[parent].world);
        animation.nodes.push(Node { parent, base, rest: placed.local });
    }
    let channel = |(placed, curve): (usize, Curve)| of_placed[placed].map(|node| Channel { node, curve });
    animation.channels = curves.into_iter().filter_map(channel).collect();
    Motion { animation, of_placed, morphs: HashMap::new() }
}

/// How a sampler interpolates, and its times.
fn keys(
    sampler: &gltf::animation::Sampler,
    buffers: &[Vec<u8>],
    label: &str,
    warnings: &mut Warnings,
) -> Reason<(Interpolation, Vec<f32>)> {
    let interpolation = match sampler.interpolation() {
        gltf::animation::Interpolation::Step => Interpolation::Step,
        gltf::animation::Interpolation::Linear => Interpolation::Linear,
        gltf::animation::Interpolation::CubicSpline => Interpolation::CubicSpline,
    };
    let times = accessors::floats(&sampler.input(), &[Dimensions::Scalar], Integers::None, buffers)
        .map_err(|reason| format!("times: {reason}"))?;
    let times: Vec<f32> = times.into_iter().map(|[time]| time).collect();
    if check_times(&times)? {
        warnings.add("several keys at one time: the last one counts", label);
    }
    Ok((interpolation, times))
}

/// Weights of morph targets: a track for each.
fn weights(
    channel: &gltf::animation::Channel,
    buffers: &[Vec<u8>],
    label: &str,
    warnings: &mut Warnings,
) -> Reason<Vec<Track<f64>>> {
    let sampler = channel.sampler();
    let (interpolation, times) = keys(&sampler, buffers, label, warnings)?;
    let values = accessors::floats(&sampler.output(), &[Dimensions::Scalar], Integers::Normalized, buffers)
        .map_err(|reason| format!("values: {reason}"))?;
    let values: Vec<f64> = values.into_iter().map(|[weight]| f64::from(weight)).collect();
    // Those of all targets at a key stand together.
    let rows = times.len() * if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let targets = values.len() / rows.max(1);
    if targets == 0 || targets * rows != values.len() {
        return Err(format!("{} weights for {} keys", values.len(), times.len()));
    }
    let of = |target: usize| {
        let values = values.iter().skip(target).step_by(targets).copied().collect();
        track(interpolation, times.clone(), values, |weight: &f64| weight.is_finite())
    };
    (0..targets).map(of).collect()
}

fn curve(
    channel: &gltf::animation::Channel,
    buffers: &[Vec<u8>],
    label: &str,
    warnings: &mut Warnings,
) -> Reason<Curve> {
    let sampler = channel.sampler();
    let (interpolation, times) = keys(&sampler, buffers, label, warnings)?;
    let vectors = || {
        let values = accessors::floats(&sampler.output(), &[Dimensions::Vec3], Integers::None, buffers)
            .map_err(|reason| format!("values: {reason}"))?;
        Reason::Ok(values.into_iter().map(|v| DVec3::from(v.map(f64::from))).collect())
    };
    Ok(match channel.target().property() {
        Property::Translation => {
            Curve::Translation(track(interpolation, times, vectors()?, |v| v.is_finite())?)
        }
        Property::Scale => Curve::Scale(track(interpolation, times, vectors()?, |v| v.is_finite())?),
        Property::Rotation => {
            let values =
                accessors::floats(&sampler.output(), &[Dimensions::Vec4], Integers::Normalized, buffers)
                    .map_err(|reason| format!("values: {reason}"))?;
            let values = values.into_iter().map(|q| DVec4::from(q.map(f64::from))).collect();
            let mut track = track(interpolation, times, values, |v| v.is_finite())?;
            let cubic = interpolation == Interpolation::CubicSpline;
            for (i, value) in track.values.iter_mut().enumerate() {
                // Tangents of a spline may be anything.
                if !cubic || i % 3 == 1 {
                    let key = if cubic { i / 3 } else { i };
                    *value =
                        value.try_normalize().ok_or_else(|| format!("key {key}: 0 is not a rotation"))?;
                }
            }
            Curve::Rotation(track)
        }
        Property::MorphTargetWeights => return Err("weights move no node".into()),
    })
}

/// Are there equal ones? Errors: those that are no times, or not in order.
fn check_times(times: &[f32]) -> Reason<bool> {
    if let Some(key) = times.iter().position(|t| !(t.is_finite() && *t >= 0.0)) {
        return Err(format!("key {key}: {} s is not a time", times[key]));
    }
    match times.windows(2).position(|pair| pair[1] < pair[0]) {
        None => Ok(times.windows(2).any(|pair| pair[1] == pair[0])),
        Some(i) => Err(format!("key {} at {} s comes before key {i} at {} s", i + 1, times[i + 1], times[i])),
    }
}

fn track<T>(
    interpolation: Interpolation,
    times: Vec<f32>,
    values: Vec<T>,
    is_finite: impl Fn(&T) -> bool,
) -> Reason<Track<T>> {
    let of_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    if values.len() != of_key * times.len() {
        let (values, keys) = (values.len(), times.len());
        return Err(format!(
            "{values} values for {keys} keys of {interpolation:?}, which needs {of_key} a key"
        ));
    }
    match values.iter().position(|value| !is_finite(value)) {
        None => Ok(Track { interpolation, times, values }),
        Some(i) => Err(format!("key {}: its value is not finite", i / of_key)),
    }
}
