//! Differences of two results, in ulps.

use serde::Serialize;
use shared::reservoir::StoredReservoir;

/// More units in the last place than rounding alone explains. Both sides evaluate the same expressions in f32; a GPU may fuse
/// multiplications with additions and be off by up to 2.5 ulp in divisions and by more in roots (Vulkan 1.3, appendix A,
/// "Precision and Operation of SPIR-V Instructions"). A contribution weight goes through some hundred of them; where
/// directions cancel (a light very near, light at a grazing angle), each of those counts many times over. At most 56 were
/// seen in 40 pixels of the atrium, both modes, on an NVIDIA H100, and 2 on lavapipe.
pub const ROUNDING_ULPS: u64 = 512;

/// Numbers of f32 between `a` and `b`: 0 for equal ones, `u64::MAX` if either is NaN.
pub fn ulps(a: f32, b: f32) -> u64 {
    if a.is_nan() || b.is_nan() {
        return u64::MAX;
    }
    // Monotonic over the whole line; both zeros are 0.
    let place = |x: f32| {
        let size = i64::from(x.to_bits() & 0x7fff_ffff);
        if x.is_sign_negative() { -size } else { size }
    };
    place(a).abs_diff(place(b))
}

/// Two reservoirs, field by field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The same light and the same point on it, or no survivor in both.
    pub same_sample: bool,
    pub weight_ulps: u64,
    pub confidence_ulps: u64,
}

impl Difference {
    pub fn new(a: StoredReservoir, b: StoredReservoir) -> Self {
        Difference {
            same_sample: a.sample == b.sample || a.contribution_weight == 0.0 && b.contribution_weight == 0.0,
            weight_ulps: ulps(a.contribution_weight, b.contribution_weight),
            confidence_ulps: ulps(a.confidence, b.confidence),
        }
    }

    pub fn is_rounding(&self) -> bool {
        self.same_sample && self.weight_ulps <= ROUNDING_ULPS && self.confidence_ulps == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ulps_count_numbers() {
        assert_eq!((ulps(1.0, 1.0), ulps(0.0, -0.0)), (0, 0));
        assert_eq!((ulps(1.0, 1.0f32.next_up()), ulps(1.0f32.next_down(), 1.0f32.next_up())), (1, 2));
        assert_eq!(ulps(-f32::from_bits(1), f32::from_bits(1)), 2);
        assert_eq!(ulps(f32::NAN, 1.0), u64::MAX);
    }
}
