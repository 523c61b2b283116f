//! Alias method: draws from n weights in constant time (Walker 1974, built by Vose 1991).
//!
//! The table has a power of two entries and each entry is split in 2^32 tickets, so two random words draw an
//! outcome with exactly the mass that is stored beside it: masses are rational numbers, not approximations.

use crate::pdf::Pmf;
use bytemuck::{Pod, Zeroable};

/// One column of the table: its own outcome below `threshold`, another outcome above. 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct AliasEntry {
    /// Tickets (of 2^32) that stay with this column's own outcome; `u32::MAX` counts as all of them.
    pub threshold: u32,
    /// The outcome of the other tickets.
    pub alias: u32,
    /// Mass of this column's own outcome over the whole table.
    pub pmf: f32,
    /// Mass of `alias` over the whole table.
    pub alias_pmf: f32,
}

/// Draws (outcome, mass) from `table`, whose length is a power of two >= 1, with two independent random words.
/// An outcome of weight 0 is never drawn; an empty table gives mass 0.
///
/// Equation (6): thesis section 4.1.6.
pub fn sample(table: &[AliasEntry], random: [u32; 2]) -> (u32, Pmf) {
    if table.is_empty() {
        return (0, Pmf(0.0));
    }
    let column = random[0] & (table.len() as u32 - 1);
    let entry = table[column as usize];
    let own = (random[1] <= entry.threshold) & (entry.pmf > 0.0);
    (if own { column } else { entry.alias }, Pmf(if own { entry.pmf } else { entry.alias_pmf }))
}

/// Builds the table for `weights` (any finite numbers >= 0; others count as 0), in f64. Gives an empty table when
/// no weight is positive. Outcome i is drawn with mass w_i / Σw up to 2^-32 of a column, and every positive weight
/// keeps at least one ticket, so no light is lost to rounding.
#[cfg(not(target_arch = "spirv"))]
pub fn build(weights: &[f64]) -> Vec<AliasEntry> {
    let weight = |i: usize| weights.get(i).copied().filter(|w| w.is_finite() && *w > 0.0).unwrap_or(0.0);
    let total: f64 = (0..weights.len()).map(weight).sum();
    if total <= 0.0 || !total.is_finite() {
        return Vec::new();
    }
    let n = weights.len().next_power_of_two();
    // Scaled so that a column holds 1: what is below 1 is topped up by what is above (Vose 1991).
    let mut scaled: Vec<f64> = (0..n).map(|i| weight(i) / total * n as f64).collect();
    let (mut small, mut large): (Vec<u32>, Vec<u32>) = (0..n as u32).partition(|&i| scaled[i as usize] < 1.0);
    let mut table: Vec<AliasEntry> = (0..n as u32)
        .map(|i| AliasEntry { threshold: u32::MAX, alias: i, pmf: 0.0, alias_pmf: 0.0 })
        .collect();
    while let (Some(&low), Some(&high)) = (small.last(), large.last()) {
        small.pop();
        table[low as usize].threshold = tickets(scaled[low as usize]);
        table[low as usize].alias = high;
        scaled[high as usize] -= 1.0 - scaled[low as usize];
        if scaled[high as usize] < 1.0 {
            large.pop();
            small.push(high);
        }
    }
    // What is left on either stack holds 1 up to rounding: it keeps its whole column. A column without any weight
    // of its own can be left only by rounding too; it goes to the heaviest outcome.
    let heaviest = (0..weights.len()).max_by(|&a, &b| weight(a).total_cmp(&weight(b))).unwrap_or(0) as u32;
    for &i in &small {
        if weight(i as usize) == 0.0 {
            table[i as usize] = AliasEntry { threshold: 0, alias: heaviest, pmf: 0.0, alias_pmf: 0.0 };
        }
    }
    store_exact_masses(&mut table, weight);
    table
}

/// Threshold for a column whose own share is `share` in (0, 1): at least one ticket.
#[cfg(not(target_arch = "spirv"))]
fn tickets(share: f64) -> u32 {
    // `sample` compares with <=, so threshold t keeps t + 1 tickets.
    (share * 4_294_967_296.0 - 1.0).clamp(0.0, 4_294_967_295.0).round() as u32
}

/// Counts each outcome's tickets and writes its mass beside every place it can be drawn from.
///
/// Equation (6): thesis section 4.1.6.
#[cfg(not(target_arch = "spirv"))]
fn store_exact_masses(table: &mut [AliasEntry], weight: impl Fn(usize) -> f64) {
    const COLUMN: u64 = 1 << 32;
    let mut counts = vec![0u64; table.len()];
    for (i, entry) in table.iter().enumerate() {
        let own = if weight(i) > 0.0 { u64::from(entry.threshold) + 1 } else { 0 };
        counts[i] += own;
        counts[entry.alias as usize] += COLUMN - own;
    }
    let all = table.len() as f64 * COLUMN as f64;
    let mass = |i: usize| (counts[i] as f64 / all) as f32;
    for (i, entry) in table.iter_mut().enumerate() {
        entry.pmf = if weight(i) > 0.0 { mass(i) } else { 0.0 };
        entry.alias_pmf = mass(entry.alias as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Rng, Stream};
    use glam::UVec2;

    fn cases() -> Vec<Vec<f64>> {
        let mut rng = Rng::new(UVec2::ZERO, 0, 1, Stream::Initial, 0);
        vec![
            vec![1.0],
            vec![1.0, 1.0],
            vec![0.0, 3.0, 1.0],
            vec![1e-6, 1e6, 1.0],
            (0..1000).map(|_| f64::from(rng.next_f32())).collect(),
            (0..257).map(|i| 1.0 / f64::from(i + 1)).collect(),
        ]
    }

    /// Tickets of each outcome, counted from the table alone.
    fn masses(table: &[AliasEntry]) -> Vec<f64> {
        let mut mass = vec![0.0; table.len()];
        for (i, e) in table.iter().enumerate() {
            let own = if e.pmf > 0.0 { (f64::from(e.threshold) + 1.0) / 4_294_967_296.0 } else { 0.0 };
            mass[i] += own / table.len() as f64;
            mass[e.alias as usize] += (1.0 - own) / table.len() as f64;
        }
        mass
    }

    #[test]
    fn masses_are_the_weights() {
        for weights in cases() {
            let table = build(&weights);
            let total: f64 = weights.iter().sum();
            let mass = masses(&table);
            assert!((mass.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            for (i, m) in mass.iter().enumerate() {
                let exact = weights.get(i).unwrap_or(&0.0) / total;
                // Every column rounds by at most one ticket.
                assert!((m - exact).abs() <= 1.0 / 4_294_967_296.0, "outcome {i}: {m} instead of {exact}");
                if table[i].pmf > 0.0 {
                    assert!((f64::from(table[i].pmf) - m).abs() <= 6e-8 * m, "stored mass of {i}");
                }
            }
            for entry in &table {
                let m = mass[entry.alias as usize];
                assert!(
                    (f64::from(entry.alias_pmf) - m).abs() <= 6e-8 * m,
                    "mass beside alias {}",
                    entry.alias
                );
            }
        }
    }

    /// Draws against the weights: chi-square, false alarm 1e-4 a case (fixed seed). The planted table, with two
    /// thresholds off, must fail the same test.
    #[test]
    fn draws_follow_the_weights() {
        let weights: Vec<f64> = (1..=64).map(f64::from).collect();
        let total: f64 = weights.iter().sum();
        let chi2 = |table: &[AliasEntry]| {
            let mut rng = Rng::new(UVec2::new(1, 2), 3, 4, Stream::Initial, 0);
            let n = 1 << 20;
            let mut counts = vec![0u32; weights.len()];
            for _ in 0..n {
                let r = rng.next_u32x4();
                let (i, pmf) = sample(table, [r.x, r.y]);
                assert!((f64::from(pmf.0) - weights[i as usize] / total).abs() < 1e-6);
                counts[i as usize] += 1;
            }
            counts.iter().zip(&weights).fold(0.0, |sum, (&c, w)| {
                let expected = f64::from(n) * w / total;
                sum + (f64::from(c) - expected).powi(2) / expected
            })
        };
        const LIMIT: f64 = 111.1; // quantile 0.9999 of chi-square with 63 degrees of freedom
        let table = build(&weights);
        assert!(chi2(&table) < LIMIT, "chi-square {}", chi2(&table));
        let mut planted = table;
        planted[3].threshold = u32::MAX;
        planted[5].threshold = u32::MAX;
        assert!(chi2(&planted) > LIMIT, "the planted error was not seen");
    }

    #[test]
    fn useless_weights_are_never_drawn() {
        assert!(build(&[]).is_empty() && build(&[0.0, f64::NAN, -1.0]).is_empty());
        assert_eq!(sample(&[], [1, 2]), (0, Pmf(0.0)));
        let table = build(&[0.0, 2.0, f64::NAN, -1.0, 2.0]);
        let mut rng = Rng::new(UVec2::new(1, 2), 3, 4, Stream::Initial, 0);
        for _ in 0..10_000 {
            let r = rng.next_u32x4();
            let (i, pmf) = sample(&table, [r.x, r.y]);
            assert!((i == 1 || i == 4) && (pmf.0 - 0.5).abs() < 1e-6);
        }
        // The corner tickets too.
        for column in 0..8 {
            for ticket in [0, u32::MAX] {
                assert!(sample(&table, [column, ticket]).1.0 > 0.0, "column {column}, ticket {ticket}");
            }
        }
    }

    /// Four million weights with one that dominates: the small ones keep their tickets and their mass.
    #[test]
    fn one_weight_may_dominate_millions() {
        let n = 4_000_000;
        let mut weights = vec![1.0; n];
        weights[1234] = 1e9;
        let table = build(&weights);
        let total = 1e9 + (n - 1) as f64;
        assert!((f64::from(table[1234].pmf) - 1e9 / total).abs() < 1e-6);
        let small = f64::from(table[77].pmf);
        assert!((small * total - 1.0).abs() < 1e-5, "a small light's mass is {small}");
        assert!(table[..n].iter().all(|e| e.pmf > 0.0));
    }
}
