//! Words that many threads of a pass count in: sums and greatest values, which do not depend on the order of the threads, and lists,
//! whose order nothing may depend on.

/// A buffer of such words.
pub struct Counters<'a>(&'a mut [u32]);

impl<'a> Counters<'a> {
    /// Over `words`, whatever they hold.
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

    /// Word 0 += 1, and the word of that number = value: a list, in the order in which threads come.
    pub fn append(&mut self, value: u32) {
        #[cfg(not(target_arch = "spirv"))]
        let before = {
            self.0[0] += 1;
            self.0[0] - 1
        };
        // SAFETY: as above.
        #[cfg(target_arch = "spirv")]
        let before = unsafe { spirv_std::arch::atomic_i_add::<u32, DEVICE, RELAXED>(&mut self.0[0], 1) };
        self.0[1 + before as usize] = value;
    }

    /// The list is empty. For one thread of a pass in which nobody appends.
    pub fn clear(&mut self) {
        self.0[0] = 0;
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
