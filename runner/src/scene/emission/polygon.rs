//! Convex polygons in the plane: cutting them, and integrals over them.

use glam::{DVec2, DVec3};

/// A convex polygon, counter-clockwise in (x right, y up) coordinates; may be empty.
#[derive(Clone, Debug, Default)]
pub struct Polygon(Vec<DVec2>);

impl Polygon {
    /// The triangle between `corners`, in whichever order they run.
    pub fn triangle([a, b, c]: [DVec2; 3]) -> Self {
        Polygon(if (b - a).perp_dot(c - a) < 0.0 { vec![a, c, b] } else { vec![a, b, c] })
    }

    pub fn bounds(&self) -> (DVec2, DVec2) {
        let (low, high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        self.0.iter().fold((low, high), |(low, high), &p| (low.min(p), high.max(p)))
    }

    /// The same elsewhere: `map` keeps straight lines straight and does not turn the polygon over.
    pub fn map(&self, map: impl FnMut(DVec2) -> DVec2) -> Self {
        Polygon(self.0.iter().copied().map(map).collect())
    }

    /// The part where normal . p >= offset (Sutherland & Hodgman 1974).
    pub fn clip(&self, normal: DVec2, offset: f64) -> Self {
        let height = |p: DVec2| normal.dot(p) - offset;
        let mut kept = Vec::with_capacity(self.0.len() + 1);
        for (i, &b) in self.0.iter().enumerate() {
            let a = self.0[if i == 0 { self.0.len() - 1 } else { i - 1 }];
            let (ha, hb) = (height(a), height(b));
            if (ha < 0.0) != (hb < 0.0) {
                kept.push(a + (b - a) * (ha / (ha - hb)));
            }
            if hb >= 0.0 {
                kept.push(b);
            }
        }
        Polygon(kept)
    }

    /// The part in the box from `low` to `high`.
    pub fn clip_to_box(&self, low: DVec2, high: DVec2) -> Self {
        self.clip(DVec2::X, low.x).clip(-DVec2::X, -high.x).clip(DVec2::Y, low.y).clip(-DVec2::Y, -high.y)
    }

    /// How the box from `low` to `high` lies.
    pub fn relation(&self, low: DVec2, high: DVec2) -> Relation {
        let (first, last) = self.bounds();
        if first.cmpge(high).any() || last.cmple(low).any() || self.0.len() < 3 {
            return Relation::Outside;
        }
        let mut inside = true;
        for (i, &b) in self.0.iter().enumerate() {
            let a = self.0[if i == 0 { self.0.len() - 1 } else { i - 1 }];
            let normal = (b - a).perp();
            // The corners farthest along the normal and against it.
            let far = DVec2::select(normal.cmpge(DVec2::ZERO), high, low);
            let near = low + high - far;
            if normal.dot(far - a) <= 0.0 {
                return Relation::Outside;
            }
            inside &= normal.dot(near - a) >= 0.0;
        }
        if inside { Relation::Inside } else { Relation::Cut }
    }

    /// Area, and ∫ f over the polygon for an f of degree 2 at most: exact but for rounding.
    pub fn integrate(&self, f: impl Fn(DVec2) -> DVec3) -> (f64, DVec3) {
        let (mut area, mut integral) = (0.0, DVec3::ZERO);
        for pair in self.0.get(1..).unwrap_or_default().windows(2) {
            let [a, b, c] = [self.0[0], pair[0], pair[1]];
            let part = 0.5 * (b - a).perp_dot(c - a);
            area += part;
            integral += (f(0.5 * (a + b)) + f(0.5 * (b + c)) + f(0.5 * (c + a))) * (part / 3.0);
        }
        (area, integral)
    }
}

/// How a box lies to a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    Inside,
    /// Maybe partly inside.
    Cut,
    Outside,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Polygon {
        Polygon::triangle([DVec2::ZERO, DVec2::Y * 4.0, DVec2::X * 4.0])
    }

    #[test]
    fn boxes_inside_across_and_outside() {
        let relation = |low: [f64; 2], high: [f64; 2]| triangle().relation(low.into(), high.into());
        assert_eq!(relation([0.0, 0.0], [1.0, 1.0]), Relation::Inside);
        assert_eq!(relation([1.0, 1.0], [2.0, 2.0]), Relation::Inside);
        assert_eq!(relation([1.0, 1.0], [2.5, 2.0]), Relation::Cut);
        assert_eq!(relation([3.0, 3.0], [3.5, 3.5]), Relation::Outside);
        assert_eq!(relation([-2.0, 0.0], [0.0, 1.0]), Relation::Outside);
        assert_eq!(relation([-1.0, -1.0], [9.0, 9.0]), Relation::Cut);
    }

    /// Pieces make the whole, and moments are those of a right triangle: ∫x = a³/6, ∫xy = a⁴/24, ∫x² = a⁴/12.
    #[test]
    fn integrals_in_closed_form() {
        let moments = |p: DVec2| DVec3::new(p.x, p.x * p.y, p.x * p.x);
        let exact = DVec3::new(64.0 / 6.0, 256.0 / 24.0, 256.0 / 12.0);
        let (area, whole) = triangle().integrate(moments);
        assert!((area - 8.0).abs() < 1e-12 && (whole - exact).abs().max_element() < 1e-12, "{whole}");
        let (mut area, mut sum) = (0.0, DVec3::ZERO);
        for x in 0..4 {
            for y in 0..4 {
                let low = DVec2::new(f64::from(x), f64::from(y));
                let (a, part) = triangle().clip_to_box(low, low + 1.0).integrate(moments);
                area += a;
                sum += part;
            }
        }
        assert!((area - 8.0).abs() < 1e-12 && (sum - exact).abs().max_element() < 1e-12, "{sum}");
        assert_eq!(triangle().clip(DVec2::X, 9.0).integrate(moments), (0.0, DVec3::ZERO));
    }
}
