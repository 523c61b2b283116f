//! Compiled shaders and built-in plans of Candela, inside the program: it runs from anywhere.

/// SPIR-V of the entry point `stem`, or none.
pub fn spirv(stem: &str) -> Option<&'static [u8]> {
    MODULES.iter().find(|(name, _)| *name == stem).map(|(_, code)| *code)
}

macro_rules! modules {
    ($($pass:ident)*; $($other:ident)*) => {
        /// (entry point, SPIR-V) of every shader.
        pub const MODULES: &[(&str, &[u8])] = &[$(modules!($pass),)* $(modules!($other)),*];
    };
    ($stem:ident) => {
        (stringify!($stem), include_bytes!(concat!("shaders/", stringify!($stem), ".spv")))
    };
}

macro_rules! passes {
    ($(($body:ident $extent:ident { $($stage:ident $rays:tt $stem:ident),* } $read:tt $update:tt $write:tt $($count:tt)?))*) => {
        modules! {
            $($($stem)*)*;
            visibility_vertex visibility_alpha_vertex visibility_alpha
            closest_hit primary_any_hit shadow_any_hit primary_miss shadow_miss
        }
    };
}

shared::passes!(passes);

/// (name, TOML) of the plans that `candela sweep` knows.
pub const PLANS: [(&str, &str); 8] = [
    ("bench", include_str!("plans/bench.toml")),
    ("thesis", include_str!("plans/thesis.toml")),
    ("lights", include_str!("plans/lights.toml")),
    ("modes", include_str!("plans/modes.toml")),
    ("indirect", include_str!("plans/indirect.toml")),
    ("town", include_str!("plans/town.toml")),
    ("motion", include_str!("plans/motion.toml")),
    ("smoke", include_str!("plans/smoke.toml")),
];
