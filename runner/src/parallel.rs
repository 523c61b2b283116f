//! Work spread over all processors.

use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

/// `f` of each item, in the items' order. Items are taken one by one: they may take very different times.
pub fn map<A: Sync, B: Send>(items: &[A], f: impl Fn(&A) -> B + Sync + Send) -> Vec<B> {
    items.par_iter().with_max_len(1).map(f).collect()
}
