//! The whole estimator on the CPU, the very bodies of the GPU's passes, against mathematics in f64.
//!
//! [`world`] has the scenes, [`truth`] their radiance by closed form and quadrature, [`passes`] the frame as the GPU runs
//! it, [`knowledge`] what its cells know, [`plant`] the errors that can be planted in it, [`statistics`] the test that decides. Then the tests: [`matrix`] (every kind
//! of light under every kind of reuse), [`controls`] (each planted error is seen), [`hard_cases`] and [`long_runs`].

extern crate candela_shared as shared;

mod controls;
mod hard_cases;
mod knowledge;
mod long_runs;
mod matrix;
mod passes;
mod plant;
mod statistics;
mod truth;
mod world;
