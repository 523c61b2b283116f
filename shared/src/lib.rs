//! The estimator of Candela: pure functions that run on the GPU (rust-gpu) and on the CPU (tests, tools).
//!
//! Direct lighting at a surface point x seen from direction wo is an integral over all light points y,
//!
//! ```text
//! L(x, wo) = ∫ f(x, wo, wi) Le(y) G(x, y) V(x, y) dA(y)        (+ a sum over delta lights)
//! ```
//!
//! estimated by reservoir resampling: candidates from a cheap source density, one survivor drawn in
//! proportion to the unshadowed integrand, survivors shared between neighboring pixels and frames.
//!
//! | word | symbol | meaning | unit |
//! |---|---|---|---|
//! | `target_function` | p̂ | luminance of the unshadowed integrand | cd/m² per measure |
//! | `source_pdf` | p | density a candidate was drawn with | 1/m² (area) or 1 (delta light) |
//! | `resampling_weight` | w | m · p̂(x) · W: what a candidate weighs in its reservoir | cd/m² |
//! | `weight_sum` | Σw | sum of the weights seen so far | cd/m² |
//! | `contribution_weight` | W | unbiased estimate of 1/p of the survivor | m² or 1 |
//! | `confidence` | M | number of candidates a reservoir stands for | 1 |
//! | `canonical` | | the pixel being shaded | |
//! | `neighbor` / `history` | | reservoir from this / the previous frame, another pixel | |
//!
//! Units: metres, seconds, radians; radiance in nit (cd/m²), intensity in candela, linear Rec. 709 RGB.
//! Frame: right-handed, +Y up as in glTF; directions point away from the surface.
//!
//! Doc comments name the equations they compute, "Equation (10): Bitterli (6); thesis (4.17).": the number of
//! docs/algorithm.md, of Bitterli et al. 2020 and of the thesis (Karlović 2022), as in that page's table.
//!
//! Reading order: [`math`], [`rng`], [`pdf`], [`sampling`], [`alias_table`], [`environment`], [`light`], [`camera`],
//! [`cells`], [`counters`], [`frame`] (its settings: [`knobs!`]), [`geometry`], [`raster`], [`material`], [`ray_cone`], [`textures`], [`alpha`], [`surface`], [`scene`], [`bsdf`], [`target`], [`shadow`],
//! [`reservoir`], [`motion`], [`points`], [`resampling`], [`shading`], [`passes`], [`tonemap`], [`view`], [`statistics`],
//! [`stored_ray`], [`resources`], [`interface`].
#![cfg_attr(target_arch = "spirv", no_std)]
#![cfg_attr(not(target_arch = "spirv"), deny(missing_docs))]
#![cfg_attr(target_arch = "spirv", feature(asm_experimental_arch))]

pub mod alias_table;
pub mod alpha;
pub mod antialias;
pub mod bounced;
pub mod bsdf;
pub mod camera;
pub mod cells;
pub mod counters;
pub mod denoise;
pub mod environment;
pub mod frame;
pub mod geometry;
pub mod interface;
mod knobs;
pub mod light;
pub mod material;
pub mod math;
pub mod motion;
pub mod passes;
pub mod pdf;
pub mod points;
pub mod raster;
pub mod ray_cone;
pub mod reflected;
pub mod resampling;
pub mod reservoir;
pub mod resources;
pub mod rng;
pub mod sampling;
pub mod scene;
pub mod shading;
pub mod shadow;
pub mod statistics;
pub mod stored_ray;
pub mod surface;
pub mod target;
pub mod textures;
pub mod tonemap;
pub mod view;

pub use glam;
