//! Vulkan, as thin as safety allows.
