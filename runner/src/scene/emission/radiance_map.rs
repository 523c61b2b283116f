//! An emissive texture as a function on the plane, with exact means over triangles.

use super::polygon::{Polygon, Relation};
use crate::scene::{Texture, Wrap};
use glam::{DVec2, DVec3, UVec2, Vec3};
use shared::math::luminance;

/// Texture coordinates of a triangle may reach over this many repeats of the texture; a triangle with more of them
/// counts as one with all of the texture, evenly (its mean is then off by its edge's share of them).
const MAX_REPEATS: f64 = 1024.0;

/// What a sampler shows at its finest level (Vulkan 1.2, "Texel Filtering"): the plane is a grid of cells in which it is
/// constant (nearest) or bilinear between four texels (linear), and which repeats.
pub struct RadianceMap<'a> {
    texels: &'a [u8],
    width: usize,
    /// nit of each value of each channel.
    decode: [[f32; 256]; 3],
    linear: bool,
    axes: [Axis; 2],
    /// Level l >= 1: squares of 2^l x 2^l cells, row by row, down to a single one.
    levels: Vec<Vec<Square>>,
}

/// Texels along u or v.
#[derive(Clone, Copy)]
struct Axis {
    texels: u32,
    /// Cells until everything repeats; of a clamped axis all that there are.
    cells: u32,
    wrap: Wrap,
    /// Texture coordinate -> cell coordinate: x texels + shift.
    shift: f64,
}

/// The map on a square of cells.
#[derive(Clone, Copy)]
struct Square {
    /// ∫ over the cells that exist, in units of one cell.
    integral: Vec3,
    /// Luminance
    least: f32,
    most: f32,
}

/// The map on a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Measure {
    /// nit
    pub mean: DVec3,
    /// Bounds of the luminance, nit.
    pub least: f32,
    pub most: f32,
    /// The triangle covers more than one cell in u or v.
    pub divisible: bool,
}

impl Axis {
    fn new(texels: u32, wrap: Wrap, linear: bool) -> Self {
        let cells = match wrap {
            Wrap::Repeat => texels,
            Wrap::MirroredRepeat => 2 * texels,
            // Between texels, and the two halves beyond the outer ones.
            Wrap::ClampToEdge => texels + u32::from(linear),
        };
        let shift = match (linear, wrap) {
            (false, _) => 0.0,
            (true, Wrap::ClampToEdge) => 0.5,
            (true, _) => -0.5,
        };
        Axis { texels, cells, wrap, shift }
    }

    /// The texel that stands at place `i`, which may lie outside.
    fn texel(&self, i: i64) -> usize {
        let n = i64::from(self.texels);
        let place = match self.wrap {
            Wrap::Repeat => i.rem_euclid(n),
            Wrap::MirroredRepeat => {
                let i = i.rem_euclid(2 * n);
                i.min(2 * n - 1 - i)
            }
            Wrap::ClampToEdge => i.clamp(0, n - 1),
        };
        place as usize
    }

    /// The texels at both ends of cell `i`; the same one twice without interpolation.
    fn ends(&self, i: u32, linear: bool) -> [usize; 2] {
        let first = i64::from(i) - i64::from(linear && self.wrap == Wrap::ClampToEdge);
        [self.texel(first), self.texel(first + i64::from(linear))]
    }
}

impl<'a> RadianceMap<'a> {
    /// `factor` x texture, nit.
    pub fn new(texture: &'a Texture, factor: Vec3) -> Self {
        let value = |encoded: usize| {
            let encoded = encoded as f64 / 255.0;
            if texture.srgb { srgb_to_linear(encoded) } else { encoded }
        };
        let decode = factor.to_array().map(|f| std::array::from_fn(|i| (value(i) * f64::from(f)) as f32));
        let linear = texture.filter.magnify_linear;
        let image = &texture.image;
        let axes = [(image.width, 0), (image.height, 1)].map(|(n, i)| Axis::new(n, texture.wrap[i], linear));
        let width = image.width as usize;
        let mut map = RadianceMap { texels: &image.texels, width, decode, linear, axes, levels: Vec::new() };
        while map.size(map.levels.len()).max_element() > 1 {
            let level = map.levels.len() + 1;
            let size = map.size(level);
            let squares = (0..size.x * size.y).map(|i| map.gather(level, UVec2::new(i % size.x, i / size.x)));
            let squares = squares.collect();
            map.levels.push(squares);
        }
        map
    }

    fn cells(&self) -> UVec2 {
        UVec2::new(self.axes[0].cells, self.axes[1].cells)
    }

    /// Squares of a level, along u and v.
    fn size(&self, level: usize) -> UVec2 {
        let side = |cells: u32| (u64::from(cells).div_ceil(1 << level)) as u32;
        UVec2::new(side(self.cells().x), side(self.cells().y))
    }

    fn texel(&self, x: usize, y: usize) -> Vec3 {
        let at = 4 * (y * self.width + x);
        let byte = |channel: usize| self.texels.get(at + channel).copied().unwrap_or_default();
        Vec3::from_array(std::array::from_fn(|c| self.decode[c][usize::from(byte(c))]))
    }

    /// The values at the corners of a cell: (0, 0), (1, 0), (0, 1), (1, 1).
    fn corners(&self, cell: UVec2) -> [Vec3; 4] {
        let [x0, x1] = self.axes[0].ends(cell.x, self.linear);
        let [y0, y1] = self.axes[1].ends(cell.y, self.linear);
        [self.texel(x0, y0), self.texel(x1, y0), self.texel(x0, y1), self.texel(x1, y1)]
    }

    fn square(&self, level: usize, place: UVec2) -> Square {
        if let Some(level_above) = level.checked_sub(1) {
            return self.levels[level_above][(place.y * self.size(level).x + place.x) as usize];
        }
        let corners = self.corners(place);
        let luminances = corners.map(luminance);
        Square {
            integral: 0.25 * corners.into_iter().sum::<Vec3>(),
            least: luminances.into_iter().fold(f32::INFINITY, f32::min),
            most: luminances.into_iter().fold(0.0, f32::max),
        }
    }

    /// The square of a level from the four below it.
    fn gather(&self, level: usize, place: UVec2) -> Square {
        let mut integral = DVec3::ZERO;
        let (mut least, mut most) = (f32::INFINITY, 0f32);
        for part in self.parts(level, place) {
            let square = self.square(level - 1, part);
            integral += square.integral.as_dvec3();
            (least, most) = (least.min(square.least), most.max(square.most));
        }
        Square { integral: integral.as_vec3(), least, most }
    }

    /// Places of the squares of the level below, as far as they exist.
    fn parts(&self, level: usize, place: UVec2) -> impl Iterator<Item = UVec2> {
        let size = self.size(level - 1);
        let children = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| 2 * place + UVec2::new(x, y));
        children.into_iter().filter(move |part| part.x < size.x && part.y < size.y)
    }

    /// The map between three points of the texture's plane: its mean over the triangle in closed form, in f64.
    pub fn measure(&self, uvs: [DVec2; 3]) -> Measure {
        let [u, v] = self.axes;
        let scale = DVec2::new(u.texels.into(), v.texels.into());
        let corners = uvs.map(|uv| uv * scale + DVec2::new(u.shift, v.shift));
        let corners = with_area(corners);
        let triangle = Polygon::triangle(corners);
        let (low, high) = triangle.bounds();
        let divisible = (high - low).max_element() > 1.0;
        let mut sum = Sum::default();
        let repeats = (high - low) / self.cells().as_dvec2();
        let repeats = DVec2::new(
            if u.wrap == Wrap::ClampToEdge { 1.0 } else { repeats.x },
            if v.wrap == Wrap::ClampToEdge { 1.0 } else { repeats.y },
        );
        // Numbers that f64 has no fractions of are no places on a texture either.
        if !(repeats.x * repeats.y <= MAX_REPEATS && repeats.max_element() <= MAX_REPEATS)
            || low.abs().max(high.abs()).max_element() > 1e12
        {
            sum.add(
                self.square(self.levels.len(), UVec2::ZERO),
                self.cells().as_dvec2().element_product(),
                1.0,
            );
            return Measure { divisible: false, ..sum.measure(divisible) };
        }
        for (across, weight) in unclamped(triangle, u, DVec2::X) {
            for (polygon, further) in unclamped(across, v, DVec2::Y) {
                self.add_repeats(&polygon, weight * further, &mut sum);
            }
        }
        sum.measure(divisible)
    }

    fn add_repeats(&self, polygon: &Polygon, weight: f64, sum: &mut Sum) {
        let period = self.cells().as_dvec2();
        let (low, high) = polygon.bounds();
        let (first, last) = ((low / period).floor(), (high / period).floor());
        if !(first.is_finite() && last.is_finite()) {
            return;
        }
        for y in first.y as i64..=last.y as i64 {
            for x in first.x as i64..=last.x as i64 {
                let moved = polygon.map(|p| p - DVec2::new(x as f64, y as f64) * period);
                self.add(&moved, weight, self.levels.len(), UVec2::ZERO, sum);
            }
        }
    }

    /// Adds the part of `polygon` in a square.
    fn add(&self, polygon: &Polygon, weight: f64, level: usize, place: UVec2, sum: &mut Sum) {
        let side = DVec2::splat((1u64 << level) as f64);
        let low = place.as_dvec2() * side;
        let high = (low + side).min(self.cells().as_dvec2());
        match polygon.relation(low, high) {
            Relation::Outside => {}
            Relation::Inside => sum.add(self.square(level, place), (high - low).element_product(), weight),
            Relation::Cut if level > 0 => {
                for part in self.parts(level, place) {
                    self.add(polygon, weight, level - 1, part, sum);
                }
            }
            Relation::Cut => {
                let [a, b, c, d] = self.corners(place).map(Vec3::as_dvec3);
                let value = |p: DVec2| a + p.x * (b - a) + p.y * (c - a) + p.x * p.y * (d - b - c + a);
                let inside = polygon.clip_to_box(low, high).map(|p| p - low);
                let (area, integral) = inside.integrate(value);
                if area > 0.0 {
                    let Square { least, most, .. } = self.square(0, place);
                    sum.add_integral(integral, least, most, area, weight);
                }
            }
        }
    }
}

/// What was seen of a map.
struct Sum {
    integral: DVec3,
    area: f64,
    least: f32,
    most: f32,
}

impl Default for Sum {
    fn default() -> Self {
        Sum { integral: DVec3::ZERO, area: 0.0, least: f32::INFINITY, most: 0.0 }
    }
}

impl Sum {
    fn add(&mut self, square: Square, area: f64, weight: f64) {
        self.add_integral(square.integral.as_dvec3(), square.least, square.most, area, weight);
    }

    fn add_integral(&mut self, integral: DVec3, least: f32, most: f32, area: f64, weight: f64) {
        self.integral += integral * weight;
        self.area += area * weight;
        self.least = self.least.min(least);
        self.most = self.most.max(most);
    }

    fn measure(self, divisible: bool) -> Measure {
        let mean = if self.area > 0.0 { self.integral / self.area } else { DVec3::ZERO };
        Measure { mean, least: self.least.min(self.most), most: self.most, divisible }
    }
}

/// The triangle, or a thin one in place of one without area: palettes map whole meshes to a point or a line.
fn with_area(corners: [DVec2; 3]) -> [DVec2; 3] {
    /// Cells; far less than anything that would change a mean.
    const WIDTH: f64 = 1e-4;
    let [a, b, c] = corners;
    if (b - a).perp_dot(c - a).abs() > WIDTH * WIDTH {
        return corners;
    }
    let edges = [b - a, c - b, a - c];
    let longest = edges.into_iter().fold(DVec2::ZERO, |l, e| if e.length() > l.length() { e } else { l });
    let along = longest.try_normalize().unwrap_or(DVec2::X);
    // Only a corner that is no end of the longest edge may leave the line; of a point all do.
    let across = along.perp() * WIDTH;
    if longest.length() < WIDTH {
        [a, a + along * WIDTH, a + across]
    } else if longest == edges[0] {
        [a, b, c + across]
    } else if longest == edges[1] {
        [a + across, b, c]
    } else {
        [a, b + across, c]
    }
}

/// The polygon in pieces with weights, so that none lies beyond the cells of a clamped axis: what does is pressed into
/// the outer half of the outermost cell, where the map is the same, and counts as often as it was pressed.
fn unclamped(polygon: Polygon, axis: Axis, direction: DVec2) -> Vec<(Polygon, f64)> {
    let end = f64::from(axis.cells);
    let (low, high) = polygon.bounds();
    let (low, high) = (low.dot(direction), high.dot(direction));
    if axis.wrap != Wrap::ClampToEdge || low >= 0.0 && high <= end {
        return vec![(polygon, 1.0)];
    }
    let mut pieces = vec![(polygon.clip(direction, 0.0).clip(-direction, -end), 1.0)];
    let mut press = |piece: Polygon, fixed: f64, depth: f64| {
        if depth > 0.0 {
            let scale = 0.5 / depth;
            let map = |p: DVec2| {
                let x = p.dot(direction);
                let inner = if fixed == 0.0 { (x + depth) * scale } else { end - 0.5 + (x - end) * scale };
                p + (inner - x) * direction
            };
            pieces.push((piece.map(map), 1.0 / scale));
        }
    };
    press(polygon.clip(-direction, 0.0), 0.0, -low);
    press(polygon.clip(direction, end), end, high - end);
    pieces
}

/// IEC 61966-2-1.
fn srgb_to_linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
#[path = "radiance_map_tests.rs"]
mod tests;
