//! Mean of many pictures, in f64.

use glam::{DVec3, DVec4, UVec2, Vec3};

/// Running mean and variance of each pixel (Welford 1962).
#[derive(Clone, Debug)]
pub struct Mean {
    count: u32,
    mean: Vec<DVec3>,
    /// Σ (x - mean)² of the luminance.
    squares: Vec<f64>,
}

const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

impl Mean {
    /// Of no pictures yet.
    pub fn new(size: UVec2) -> Self {
        let pixels = size.x as usize * size.y as usize;
        Mean { count: 0, mean: vec![DVec3::ZERO; pixels], squares: vec![0.0; pixels] }
    }

    /// One more picture of this size.
    pub fn add(&mut self, picture: &[Vec3]) {
        self.count += 1;
        for ((mean, squares), x) in self.mean.iter_mut().zip(&mut self.squares).zip(picture) {
            let before = x.as_dvec3() - *mean;
            *mean += before / f64::from(self.count);
            *squares += before.dot(LUMINANCE) * (x.as_dvec3() - *mean).dot(LUMINANCE);
        }
    }

    /// All of it, to go on from later.
    pub fn to_bytes(&self) -> Vec<u8> {
        let pixels = self.mean.iter().zip(&self.squares).map(|(mean, squares)| mean.extend(*squares));
        let pixels: Vec<DVec4> = pixels.collect();
        [&u64::from(self.count).to_ne_bytes()[..], bytemuck::cast_slice(&pixels)].concat()
    }

    /// What [`Mean::to_bytes`] gave, for pictures of `size`; none if it is anything else.
    pub fn from_bytes(size: UVec2, bytes: &[u8]) -> Option<Self> {
        let (count, pixels) = bytes.split_first_chunk()?;
        let count = u32::try_from(u64::from_ne_bytes(*count)).ok()?;
        let pixels: Vec<DVec4> =
            pixels.chunks_exact(size_of::<DVec4>()).map(bytemuck::pod_read_unaligned).collect();
        let (mean, squares) = pixels.iter().map(|p| (p.truncate(), p.w)).unzip();
        (pixels.len() == size.element_product() as usize).then_some(Mean { count, mean, squares })
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    /// The mean, nit.
    pub fn radiance(&self) -> Vec<Vec3> {
        self.mean.iter().map(|c| c.as_vec3()).collect()
    }

    /// Standard error of each pixel's mean luminance, nit; 0 for fewer than two pictures.
    ///
    /// Equation (4): thesis (4.5), thesis (4.15).
    pub fn standard_errors(&self) -> Vec<f64> {
        let n = f64::from(self.count);
        let error = |squares: &f64| if self.count < 2 { 0.0 } else { (squares / (n - 1.0) / n).sqrt() };
        self.squares.iter().map(error).collect()
    }

    /// Mean of the pixels' standard errors over the mean luminance.
    pub fn relative_standard_error(&self) -> f64 {
        let luminance: f64 = self.mean.iter().map(|c| c.dot(LUMINANCE)).sum();
        if luminance > 0.0 { self.standard_errors().iter().sum::<f64>() / luminance } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_error_of_known_numbers() {
        let mut mean = Mean::new(UVec2::new(2, 1));
        for x in [1.0, 2.0, 3.0, 4.0] {
            mean.add(&[Vec3::splat(x), Vec3::splat(5.0)]);
        }
        assert_eq!(mean.radiance(), [Vec3::splat(2.5), Vec3::splat(5.0)]);
        // Sample variance 5/3, four samples.
        let errors = mean.standard_errors();
        assert!((errors[0] - (5.0f64 / 3.0 / 4.0).sqrt()).abs() < 1e-12 && errors[1] == 0.0);
        assert!((mean.relative_standard_error() - errors[0] / 7.5).abs() < 1e-12);
    }

    /// A mean that is put aside and goes on is the mean of all.
    #[test]
    fn a_mean_goes_on_where_it_was() {
        let size = UVec2::new(2, 1);
        let picture = |x: f32| [Vec3::new(x, 2.0 * x, 0.1), Vec3::splat(x * x)];
        let (mut whole, mut first) = (Mean::new(size), Mean::new(size));
        (1..=3).map(|i| picture(i as f32)).for_each(|p| first.add(&p));
        let mut second = Mean::from_bytes(size, &first.to_bytes()).unwrap();
        (4..=7).map(|i| picture(i as f32)).for_each(|p| second.add(&p));
        (1..=7).map(|i| picture(i as f32)).for_each(|p| whole.add(&p));
        assert_eq!(whole.to_bytes(), second.to_bytes());
        let bytes = first.to_bytes();
        assert!(
            Mean::from_bytes(UVec2::ONE, &bytes).is_none() && Mean::from_bytes(size, &bytes[1..]).is_none()
        );
    }
}
