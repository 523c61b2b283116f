//! Primitives: any triangle topology of glTF -> an indexed triangle list with sound attributes.

use super::accessors::Integers;
use super::draco::{self, Decoded};
use super::warnings::Warnings;
use super::{Reason, accessors, tangents};
use crate::scene::Primitive;
use crate::scene::deform::{Bends, Influences, Target, face_normal};
use glam::{Vec2, Vec3, Vec4};
use gltf::accessor::Dimensions;
use gltf::mesh::{Mode, Semantic};
use shared::material::UvMap;
use shared::math::normalize_or;

/// Most vertices times morph targets of a primitive: targets may share their bytes in a file.
const MAX_DELTAS: usize = 1 << 24;

/// What a material asks of the primitives that wear it.
#[derive(Clone, Debug)]
pub struct Wear {
    /// Index into the scene's materials.
    pub material: usize,
    /// The n of TEXCOORD_n that its textures read, two at most: a primitive's first and second uvs.
    pub uv_sets: Vec<u32>,
    pub has_textures: bool,
    /// Where its normal map lies, if it has one.
    pub normal_map: Option<UvMap>,
}

/// What the attributes of a file may look like, and where their bytes are.
#[derive(Clone, Copy)]
pub struct Source<'b> {
    pub document: &'b gltf::Document,
    pub buffers: &'b [Vec<u8>],
    /// Integers may stand for coordinates (KHR_mesh_quantization).
    pub quantized: bool,
}

/// Reads a primitive; `None` (with a warning) if it has no triangles to draw. `label` names it in warnings.
/// Errors: positions or indices that are broken. Without its other attributes it can be drawn.
pub fn read(
    primitive: &gltf::Primitive,
    label: &str,
    wear: &Wear,
    source: Source,
    warnings: &mut Warnings,
) -> Reason<Option<Primitive>> {
    let mode = primitive.mode();
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        warnings.add("points and lines are left out", label);
        return Ok(None);
    }
    let decoded = draco::decode(source.document, primitive, source.buffers)?;
    let attributes = Attributes { primitive, label, source, decoded: decoded.as_ref() };
    let Some(mut mesh) = attributes.read(&wear.uv_sets, warnings)? else {
        warnings.add("left out: no positions", label);
        return Ok(None);
    };
    mesh.material = wear.material;
    let corners = match &decoded {
        Some(decoded) => decoded.indices(),
        None => read_indices(primitive, mesh.positions.len(), source.buffers)?,
    };
    // Whatever the file calls them, decoded indices are a list.
    let mode = if decoded.is_some() { Mode::Triangles } else { mode };
    if mode == Mode::Triangles && !corners.len().is_multiple_of(3) {
        warnings.add("the last triangle lacks a corner and is left out", label);
    }
    mesh.indices = triangles(mode, &corners);
    let dropped = drop_infinite(&mut mesh);
    if dropped > 0 {
        warnings.count("triangles with a vertex that is not finite are left out", label, dropped);
    }
    // Morph targets may unfold them.
    let dropped = if mesh.bends.targets.is_empty() { drop_degenerate(&mut mesh) } else { 0 };
    if dropped > 0 {
        warnings.count("triangles without an area are left out", label, dropped);
    }
    if mesh.indices.is_empty() {
        return Ok(None);
    }
    if mesh.normals.is_empty() {
        flatten(&mut mesh);
    } else {
        compact(&mut mesh);
        mend_normals(&mut mesh);
    }
    finish_texture_space(&mut mesh, label, wear, warnings);
    Ok(Some(mesh))
}

fn finish_texture_space(primitive: &mut Primitive, label: &str, wear: &Wear, warnings: &mut Warnings) {
    let lacks = primitive.uvs.is_empty() || wear.uv_sets.len() > 1 && primitive.second_uvs.is_empty();
    if wear.has_textures && lacks {
        warnings.add("textured without texture coordinates: one texel colors the whole primitive", label);
    }
    let Some(map) = wear.normal_map.filter(|_| primitive.tangents.is_empty()) else { return };
    let uvs = if map.set == 0 { &primitive.uvs } else { &primitive.second_uvs };
    let uvs: Vec<Vec2> = uvs.iter().map(|&uv| map.apply(uv)).collect();
    if !uvs.is_empty() {
        tangents::compute(primitive, &uvs);
    }
}

/// The attributes of a primitive, to be read.
struct Attributes<'a> {
    primitive: &'a gltf::Primitive<'a>,
    label: &'a str,
    source: Source<'a>,
    decoded: Option<&'a Decoded>,
}

impl Attributes<'_> {
    /// All that are drawn, without triangles; `None` where there are no positions.
    fn read(&self, uv_sets: &[u32], warnings: &mut Warnings) -> Reason<Option<Primitive>> {
        use Dimensions::{Vec2 as Two, Vec3 as Three, Vec4 as Four};
        let Some(accessor) = self.primitive.get(&Semantic::Positions) else { return Ok(None) };
        let integers = if self.source.quantized { Integers::AsDeclared } else { Integers::None };
        let positions = self
            .floats(&Semantic::Positions, &accessor, &[Three], integers)
            .map_err(|reason| format!("POSITION: {reason}"))?;
        let count = positions.len();
        if count > u32::MAX as usize {
            return Err(format!("{count} vertices are too many"));
        }
        let positions = positions.into_iter().map(Vec3::from).collect();
        let mut mesh = Primitive { positions, ..Default::default() };
        let directions = Integers::Normalized;
        let normals = self.other::<3>(Semantic::Normals, &[Three, Four], directions, count, warnings);
        mesh.normals = normals.into_iter().map(Vec3::from).collect();
        // Without the file's normals, its tangents mean nothing (glTF 2.0, 3.7.2.1).
        if !mesh.normals.is_empty() {
            let tangents = self.other(Semantic::Tangents, &[Four, Three], directions, count, warnings);
            mesh.tangents = tangents.into_iter().map(unit_tangent).collect();
        }
        let integers = if self.source.quantized { Integers::AsDeclared } else { Integers::Normalized };
        let mut uvs = |set: u32| {
            let uvs = self.other(Semantic::TexCoords(set), &[Two, Three, Four], integers, count, warnings);
            uvs.into_iter().map(Vec2::from).collect()
        };
        mesh.uvs = uvs(uv_sets.first().copied().unwrap_or(0));
        mesh.second_uvs = uv_sets.get(1).map_or(vec![], |&set| uvs(set));
        let colors = self.other(Semantic::Colors(0), &[Three, Four], Integers::Normalized, count, warnings);
        // Not by a clamp alone, which makes a number of NaN.
        let color = |c| {
            Some(Vec4::from(c))
                .filter(|c: &Vec4| c.is_finite())
                .map_or(Vec4::NAN, |c| c.clamp(Vec4::ZERO, Vec4::ONE))
        };
        mesh.colors = colors.into_iter().map(color).collect();
        mesh.bends = self.bends(count, warnings);
        Ok(Some(mesh))
    }

    /// Joints and morph targets; those that are broken are left out, with a warning.
    fn bends(&self, count: usize, warnings: &mut Warnings) -> Bends {
        let Attributes { primitive, label, source, .. } = *self;
        let mut influences = Vec::new();
        for set in 0..2 {
            let four = [Dimensions::Vec4];
            let joints = self.other::<4>(Semantic::Joints(set), &four, Integers::AsDeclared, count, warnings);
            let weights =
                self.other::<4>(Semantic::Weights(set), &four, Integers::Normalized, count, warnings);
            if joints.is_empty() || weights.is_empty() {
                break;
            }
            influences.resize(count, ([0.0; 8], [0.0; 8]));
            let place = 4 * set as usize..4 * set as usize + 4;
            for (i, (all_joints, all_weights)) in influences.iter_mut().enumerate() {
                all_joints[place.clone()].copy_from_slice(&joints[i]);
                all_weights[place.clone()].copy_from_slice(&weights[i]);
            }
        }
        let influences = influences.into_iter().map(|(joints, weights)| Influences::new(joints, weights));
        let read = |accessor: Option<gltf::Accessor>, integers| {
            let Some(accessor) = accessor else { return Ok(vec![]) };
            let deltas = accessors::floats::<3>(&accessor, &[Dimensions::Vec3], integers, source.buffers)?;
            let deltas: Vec<Vec3> = deltas.into_iter().map(Vec3::from).collect();
            match deltas.len() {
                n if n == count => Ok(deltas),
                n => Err(format!("{n} elements for {count} vertices")),
            }
        };
        let coordinates = if source.quantized { Integers::AsDeclared } else { Integers::None };
        let directions = if source.quantized { Integers::Normalized } else { Integers::None };
        let target = |target: gltf::mesh::MorphTarget| {
            Reason::Ok(Target {
                positions: read(target.positions(), coordinates)?,
                normals: read(target.normals(), directions)?,
                tangents: read(target.tangents(), directions)?,
            })
        };
        let many = primitive.morph_targets().len().saturating_mul(count) > MAX_DELTAS;
        if many {
            warnings.add("too many morph targets: none is used", label);
        }
        let targets = primitive.morph_targets().enumerate().filter(|_| !many).map(|(i, of)| {
            target(of).unwrap_or_else(|reason| {
                warnings
                    .add("a broken morph target changes nothing", &format!("{label}, target {i}: {reason}"));
                Target::default()
            })
        });
        Bends { targets: targets.collect(), influences: influences.collect(), flat: false }
    }

    /// The values of an attribute, see [`accessors::floats`].
    fn floats<const N: usize>(
        &self,
        semantic: &Semantic,
        accessor: &gltf::Accessor,
        dimensions: &[Dimensions],
        integers: Integers,
    ) -> Reason<Vec<[f32; N]>> {
        let normalized = integers == Integers::Normalized || accessor.normalized();
        let decoded = self.decoded.and_then(|decoded| decoded.floats(semantic, accessor, normalized));
        decoded.unwrap_or_else(|| accessors::floats(accessor, dimensions, integers, self.source.buffers))
    }

    /// An attribute that a primitive can be drawn without: empty (with a warning) if it is broken, or has not `count`
    /// elements.
    fn other<const N: usize>(
        &self,
        semantic: Semantic,
        dimensions: &[Dimensions],
        integers: Integers,
        count: usize,
        warnings: &mut Warnings,
    ) -> Vec<[f32; N]> {
        let Some(accessor) = self.primitive.get(&semantic) else { return vec![] };
        let read = self.floats(&semantic, &accessor, dimensions, integers);
        let read = read.and_then(|values| match values.len() {
            n if n == count => Ok(values),
            n => Err(format!("{n} elements for {count} vertices")),
        });
        read.unwrap_or_else(|reason| {
            let name = semantic.to_string();
            warnings.add(&format!("{name} is broken and not used"), &format!("{} ({reason})", self.label));
            vec![]
        })
    }
}

/// A tangent from the file, unit, with a handedness of ±1; one without a direction is 0 here.
fn unit_tangent(tangent: [f32; 4]) -> Vec4 {
    let [x, y, z, w] = tangent;
    unit(Vec3::new(x, y, z)).extend(if w < 0.0 { -1.0 } else { 1.0 })
}

/// 0 for what has no direction.
fn unit(v: Vec3) -> Vec3 {
    if v.is_finite() { normalize_or(v, Vec3::ZERO) } else { Vec3::ZERO }
}

/// The corners in the order they are drawn, each below `vertices`.
fn read_indices(source: &gltf::Primitive, vertices: usize, buffers: &[Vec<u8>]) -> Reason<Vec<u32>> {
    let Some(accessor) = source.indices() else {
        return Ok((0..vertices as u32).collect());
    };
    let corners = accessors::indices(&accessor, buffers).map_err(|reason| format!("indices: {reason}"))?;
    match corners.iter().find(|&&i| i as usize >= vertices) {
        None => Ok(corners),
        Some(index) => {
            let accessor = accessor.index();
            Err(format!("accessor {accessor}: index {index} is out of range of {vertices} vertices"))
        }
    }
}

/// Corners as a list of triangles, all wound the same way (glTF 2.0, 3.7.2.1).
fn triangles(mode: Mode, corners: &[u32]) -> Vec<u32> {
    match mode {
        // Every other triangle of a strip turns the other way: its last two corners are exchanged.
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .flat_map(|(i, c)| if i % 2 == 0 { [c[0], c[1], c[2]] } else { [c[0], c[2], c[1]] })
            .collect(),
        Mode::TriangleFan => corners.windows(2).skip(1).flat_map(|c| [c[0], c[1], corners[0]]).collect(),
        _ => corners[..corners.len() / 3 * 3].to_vec(),
    }
}

/// Removes the triangles with a corner where an attribute is not finite, and tells how many. Directions are
/// mended instead.
fn drop_infinite(mesh: &mut Primitive) -> usize {
    let mut sound = vec![true; mesh.positions.len()];
    let mut look = |vertex: usize, finite: bool| sound[vertex] &= finite;
    mesh.positions.iter().enumerate().for_each(|(i, v)| look(i, v.is_finite()));
    mesh.uvs.iter().enumerate().for_each(|(i, v)| look(i, v.is_finite()));
    mesh.second_uvs.iter().enumerate().for_each(|(i, v)| look(i, v.is_finite()));
    mesh.colors.iter().enumerate().for_each(|(i, v)| look(i, v.is_finite()));
    if sound.iter().all(|&sound| sound) {
        return 0;
    }
    let before = mesh.indices.len() / 3;
    let kept = |t: &&[u32]| t.iter().all(|&i| sound[i as usize]);
    mesh.indices = mesh.indices.chunks_exact(3).filter(kept).flatten().copied().collect();
    before - mesh.indices.len() / 3
}

/// Removes the triangles whose area is 0, and tells how many. f64 holds products of f32 exactly enough: only truly
/// collinear corners (up to its rounding) give 0.
fn drop_degenerate(primitive: &mut Primitive) -> usize {
    let before = primitive.indices.len() / 3;
    let positions = &primitive.positions;
    let has_area = |t: &&[u32]| {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| positions[i as usize].as_dvec3());
        (b - a).cross(c - a) != glam::DVec3::ZERO
    };
    let kept: Vec<u32> = primitive.indices.chunks_exact(3).filter(has_area).flatten().copied().collect();
    primitive.indices = kept;
    before - primitive.indices.len() / 3
}

/// Gives each triangle its own corners and its own normal.
fn flatten(primitive: &mut Primitive) {
    let order = std::mem::take(&mut primitive.indices);
    gather(primitive, &order);
    primitive.indices = (0..order.len() as u32).collect();
    primitive.bends.flat = true;
    primitive.face();
}

/// Drops the vertices that no triangle uses: exporters often let many primitives share one large vertex buffer.
fn compact(primitive: &mut Primitive) {
    const UNUSED: u32 = u32::MAX;
    let mut place = vec![UNUSED; primitive.positions.len()];
    let mut order = Vec::new();
    for &i in &primitive.indices {
        if place[i as usize] == UNUSED {
            place[i as usize] = order.len() as u32;
            order.push(i);
        }
    }
    if order.len() < primitive.positions.len() {
        gather(primitive, &order);
        for i in &mut primitive.indices {
            *i = place[*i as usize];
        }
    }
}

/// Replaces the vertices by those that `order` names.
pub(super) fn gather(primitive: &mut Primitive, order: &[u32]) {
    fn pick<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
        if !values.is_empty() {
            *values = order.iter().map(|&i| values[i as usize]).collect();
        }
    }
    pick(&mut primitive.positions, order);
    pick(&mut primitive.normals, order);
    pick(&mut primitive.tangents, order);
    pick(&mut primitive.uvs, order);
    pick(&mut primitive.second_uvs, order);
    pick(&mut primitive.colors, order);
    primitive.bends.gather(order);
}

/// Makes normals unit; one without a direction becomes that of a triangle at its vertex.
fn mend_normals(primitive: &mut Primitive) {
    for normal in &mut primitive.normals {
        *normal = unit(*normal);
    }
    for t in primitive.indices.chunks_exact(3) {
        for &i in t {
            if primitive.normals[i as usize] == Vec3::ZERO {
                let corners = [t[0], t[1], t[2]].map(|i| primitive.positions[i as usize]);
                primitive.normals[i as usize] = face_normal(corners);
            }
        }
    }
    for (tangent, normal) in primitive.tangents.iter_mut().zip(&primitive.normals) {
        if tangent.truncate() == Vec3::ZERO {
            *tangent = normal.any_orthonormal_vector().extend(1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 4]), [0, 1, 2, 1, 3, 2, 2, 3, 4]);
        assert_eq!(triangles(Mode::TriangleFan, &[9, 1, 2, 3]), [1, 2, 9, 2, 3, 9]);
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3, 4]), [0, 1, 2]);
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            for corners in [&[][..], &[0], &[0, 1]] {
                assert!(triangles(mode, corners).is_empty());
            }
        }
    }

    fn quad() -> Primitive {
        Primitive {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::Z],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Primitive::default()
        }
    }

    #[test]
    fn triangles_without_area_go() {
        let mut primitive = quad();
        // A repeated corner; collinear corners; a triangle that is tiny, but a triangle.
        primitive.positions.extend([Vec3::X * 0.5, Vec3::X * 1e-30, Vec3::Y * 1e-30]);
        primitive.indices.extend([1, 1, 2, 0, 5, 1, 0, 6, 7]);
        assert_eq!(drop_degenerate(&mut primitive), 2);
        assert_eq!(primitive.indices, [0, 1, 2, 0, 2, 3, 0, 6, 7]);
    }

    #[test]
    fn flat_normals_belong_to_their_triangle() {
        let mut primitive = quad();
        primitive.indices.extend([0, 4, 1]);
        primitive.uvs = (0..5).map(|i| Vec2::splat(i as f32)).collect();
        flatten(&mut primitive);
        assert_eq!(primitive.positions.len(), 9);
        assert_eq!(primitive.normals[..6], [Vec3::Z; 6]);
        assert_eq!(primitive.normals[6..], [Vec3::Y; 3]);
        assert_eq!(primitive.uvs[7], Vec2::splat(4.0));
        assert_eq!(primitive.indices, [0, 1, 2, 3, 4, 5, 6, 7, 8]);
    }

    #[test]
    fn unused_vertices_go() {
        let mut primitive = quad();
        primitive.indices = vec![2, 3, 4];
        primitive.normals = vec![Vec3::ZERO, Vec3::ZERO, Vec3::Z * 3.0, Vec3::ZERO, Vec3::Y];
        let corners = |p: &Primitive| p.indices.iter().map(|&i| p.positions[i as usize]).collect::<Vec<_>>();
        let before = corners(&primitive);
        compact(&mut primitive);
        mend_normals(&mut primitive);
        assert_eq!(corners(&primitive), before);
        assert_eq!(primitive.positions.len(), 3);
        let face = face_normal([before[0], before[1], before[2]]);
        assert_eq!(primitive.normals, [Vec3::Z, face, Vec3::Y]);
    }
}
