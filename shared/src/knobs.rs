//! Every knob of the estimator, one row each. [`crate::frame::Settings`], the settings document, the command line,
//! the viewer's panel, the columns of a sweep and the table in docs/command-line.md follow from it.
//! docs/adding-a-knob.md has an example.

/// Gives `$with!` the rows, in the order in which they are shown everywhere and stored for shaders, and after them
/// those in `$host`: knobs of the host, which no shader reads.
///
/// A row: `name -> field: kind = default`, then
/// - `label`: a few words for the viewer's panel,
/// - `about`: one line for everywhere,
/// - `unit`: of the number, if it has one,
/// - `higher`, `lower`: what more and less of it do, or on and off,
/// - `bias`: what it does to the mean.
///
/// `name` is what people type; `field` is that of [`crate::frame::Settings`]. Kinds, with the type of the field:
/// - `count(RANGE, One | Doubled)`, u32: a number, and how the viewer steps,
/// - `number(RANGE, STEP)`, f32: above 0; the viewer goes through the range in steps,
/// - `angle(RANGE, STEP)`, f32: degrees above 0, not beyond the range's end; the field is the cosine,
/// - `switch()`, u32: on (1) or off (0),
/// - `auto(RANGE)`, u32: on, off, or on with so many lights; `auto(RANGE, FROM, MOST)`: from FROM lights on only where at most MOST
///   of them lie on a m², [`crate::light::count`],
/// - `choice(TYPE, VALUE)`, u32: one of a few words; the field's value of the default.
#[macro_export]
macro_rules! knobs {
    ($with:ident { $($host:tt)* }) => { $with! { {
        candidates -> candidates: count(1..=1024, Doubled) = 32,
            label "Light samples", about "Light candidates of each reservoir; half as many with `cells`",
            higher "less noise; time grows with it", lower "faster, noisier", bias "none";
        bsdf_candidates -> bsdf_candidates: count(0..=4, One) = 1,
            label "BSDF samples",
            about "Candidates of each reservoir that rays along the reflectance find, where triangles or an environment shine",
            higher "less noise in smooth surfaces; a ray each", lower "faster; 0: mirrors show specks",
            bias "none; they act with visibility reuse only";
        // Bitterli et al. 2020, Alg. 5.
        visibility -> visibility_reuse: switch() = true,
            label "Visibility reuse", about "Test the survivor's visibility before it is reused",
            higher "far less noise in shadow; one more ray a reservoir",
            lower "hidden lights spread and are found dark only when shaded",
            bias "biased mode darkens near shadow edges; unbiased mode has none";
        temporal -> temporal: switch() = true,
            label "Temporal reuse", about "Reuse the reservoir that this surface had in the previous frame",
            higher "the samples of many frames for the price of one", lower "every frame by itself",
            bias "biased mode: some where surfaces come into view; unbiased: none";
        spatial -> spatial: switch() = true,
            label "Spatial reuse", about "Reuse the reservoirs of neighboring pixels",
            higher "many times the samples; noise turns into blotches", lower "every pixel by itself",
            bias "biased mode darkens where neighbors see other lights; unbiased: none";
        iterations -> spatial_iterations: count(1..=8, One) = 1,
            label "Spatial iterations", about "Spatial passes",
            higher "samples come from further away; time grows with it", lower "faster",
            bias "biased mode: grows with it; unbiased: none";
        neighbors -> neighbors: count(1..=32, One) = 4,
            label "Neighbors", about "Neighbors of each spatial pass, without `pairs` or in biased mode",
            higher "less noise; time grows with it", lower "faster", bias "biased mode: grows with it; unbiased: none";
        radius -> radius: number(4.0..=200.0, 5.0) = 8.0,
            label "Radius",
            about "Radius of the neighborhood; with `pairs` the side of the squares that partners share, rounded up to a power of two", unit "pixels",
            higher "neighbors repeat less, but are less alike", lower "neighbors more alike, blotches smaller and stronger",
            bias "biased mode: grows with it; unbiased: none";
        depth_threshold -> depth_threshold: number(0.02..=1.0, 0.02) = 0.1,
            label "Depth threshold", about "Largest difference between neighbors in the distance to the camera", unit "as a fraction",
            higher "more neighbors pass, also of other surfaces", lower "fewer neighbors, more alike",
            bias "biased mode: grows with it; unbiased: none";
        // 25 as in Bitterli et al. 2020.
        normal_threshold -> normal_threshold: angle(5.0..=180.0, 5.0) = 25.0,
            label "Normal threshold", about "Largest angle between normals of neighbors", unit "degrees",
            higher "more neighbors pass, also around corners", lower "fewer neighbors, more alike",
            bias "biased mode: grows with it; unbiased: none";
        // 20 as in Bitterli et al. 2020.
        confidence_cap -> confidence_cap: number(1.0..=100.0, 5.0) = 20.0,
            label "Confidence cap", about "Weight limit of reservoirs from another point: a neighbor, or a history whose point or camera has moved",
            unit "times the light candidates",
            higher "smoother, slower to follow changes", lower "follows changes at once, noisier",
            bias "none in the mean; errors of neighboring frames are alike";
        history_cap -> history_cap: number(1.0..=1000.0, 20.0) = 320.0,
            label "History cap", about "Weight limit of the history of the same point while camera and scene are at rest; unbiased mode only",
            unit "times the light candidates",
            higher "a still picture converges for longer; its remaining noise stands still", lower "noisier; noise changes with each frame",
            bias "none in the mean; errors of neighboring frames are alike";
        reservoirs -> reservoirs: count(1..=4, One) = 1,
            label "Reservoirs", about "Independent reservoirs of each pixel, averaged by shading",
            higher "less noise; time and memory grow with it", lower "faster", bias "none";
        pixel_centers -> pixel_centers: switch() = false,
            label "Pixel centers", about "Shade the points behind pixel centers, also while the camera moves",
            higher "points jump with each movement: more noise in motion", lower "points follow surfaces: in motion nearly as good as at rest",
            bias "none";
        mode -> mode: choice(Mode, $crate::frame::mode::UNBIASED) = Unbiased,
            label "Mode", about "How reused reservoirs are weighted",
            higher "unbiased: the right mean, more rays", lower "biased: faster, too dark where neighbors disagree",
            bias "this is the choice";
        // 4096 as measured on an H100 (docs/performance.md): equal at 500 lights, faster from some thousands on.
        tiles -> tiles: auto(4096..=u32::MAX) = Auto,
            label "Light tiles", about "Draw light candidates from small presampled lists",
            higher "faster with very many lights", lower "each pixel draws from all lights",
            bias "none; neighboring pixels share candidates";
        // One light is drawn every time anyway; of thousands that all see a pixel, pools hold too few (docs/performance.md).
        cells -> cells: auto(2..=u32::MAX, 4096, 10.0) = Auto,
            label "Light cells", about "Draw light candidates by the visibility that world-space cells have learned; `tiles` act without them",
            higher "far less noise where many lights are hidden or far away", lower "candidates by power alone",
            bias "none";
        learning -> learning: switch() = true,
            label "Learning", about "Cells learn which lights they see",
            higher "far less noise where lights are hidden", lower "candidates from a light tree alone",
            bias "none";
        pairs -> pairs: switch() = true,
            label "Pairs", about "Merge pixels in mutual pairs instead of `neighbors`; unbiased mode only",
            higher "one ray a pixel and pass", lower "several neighbors, two rays", bias "none";
        indirect -> indirect: choice(Indirect, $crate::frame::indirect::OFF) = Off,
            label "Indirect light", about "Light after one or more reflections, by resampled paths",
            higher "lights what no light reaches directly; three rays a pixel and more", lower "direct light alone",
            bias "none in the bounces that are asked for, in both modes";
    } { $($host)* } } };
}
