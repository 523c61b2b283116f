//! Words that many threads of a pass count in: sums and greatest values, which do not depend on the order of the threads.

/// A buffer of such words.
pub struct Counters<'a>(&'a mut [u32]);

impl<'a> Counters<'a> {
    pub fn new(words: &'a mut [u32]) -> Self {
        Counters(words)
    }

    /// word += value
    pub fn add(&mut self, index: u32, value: u32) {
        let word = &mut self.0[index as usize];
        #[cfg(not(target_arch = "spirv"))]
        {
            *word = word.wrapping_add(value);
        }
        // SAFETY: the word lies in a storage buffer, and all who share it in this pass use atomics.
        #[cfg(target_arch = "spirv")]
        unsafe {
            spirv_std::arch::atomic_i_add::<u32, DEVICE, RELAXED>(word, value);
        }
    }

    /// word = max(word, value), cheap where it is already.
    pub fn max(&mut self, index: u32, value: u32) {
        let word = &mut self.0[index as usize];
        #[cfg(not(target_arch = "spirv"))]
        {
            *word = (*word).max(value);
        }
        // SAFETY: as above.
        #[cfg(target_arch = "spirv")]
        unsafe {
            if spirv_std::arch::atomic_load::<u32, DEVICE, RELAXED>(word) < value {
                spirv_std::arch::atomic_u_max::<u32, DEVICE, RELAXED>(word, value);
            }
        }
    }
}

/// Scope of the atomics. Queue family: what the Vulkan memory model allows without a further feature.
#[cfg(target_arch = "spirv")]
const DEVICE: u32 = spirv_std::memory::Scope::QueueFamily as u32;
/// Memory semantics: barriers between passes order them.
#[cfg(target_arch = "spirv")]
const RELAXED: u32 = 0;
