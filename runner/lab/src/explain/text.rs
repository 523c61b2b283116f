//! An explanation as text.

use super::compare::{Difference, ROUNDING_ULPS};
use super::record::{BsdfRay, Explanation, Neighbor, PassReport, Ray, Shading, Survivor};
use std::fmt::{Display, Formatter, Result};

/// Six significant digits.
fn number(x: f32) -> String {
    match x.abs() {
        0.0 => "0".into(),
        1e-3..1e6 => {
            let digits = 5 - x.abs().log10().floor() as i32;
            format!("{x:.*}", digits.max(0) as usize)
        }
        _ => format!("{x:.5e}"),
    }
}

fn vector(v: [f32; 3]) -> String {
    format!("({}, {}, {})", number(v[0]), number(v[1]), number(v[2]))
}

fn mark(chosen: bool) -> char {
    if chosen { '*' } else { ' ' }
}

impl Display for Explanation {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let ([x, y], [width, height]) = (self.pixel, self.size);
        writeln!(
            f,
            "{}: pixel {x} {y} of {width}x{height}, frame {}, seed {}, {} mode, {} lights, on {}",
            self.scene, self.frame, self.seed, self.mode, self.lights, self.device
        )?;
        self.write_surface(f)?;
        for pass in &self.passes {
            write!(f, "\n{pass}")?;
        }
        if let Some(shading) = &self.shading {
            write!(f, "\n{shading}")?;
        }
        if let Some(indirect) = self.indirect {
            writeln!(f, "\nindirect light: {} nit, by paths, which are not replayed", vector(indirect))?;
        }
        writeln!(f, "\nradiance {} nit on the GPU; {}", vector(self.radiance), self.verdict())
    }
}

impl Explanation {
    fn write_surface(&self, f: &mut Formatter<'_>) -> Result {
        match &self.seen {
            Some(hit) => writeln!(
                f,
                "sees      instance '{}', material '{}', geometry {}, triangle {}, at {:.6} m",
                hit.instance, hit.material, hit.geometry, hit.triangle, hit.t
            )?,
            None => writeln!(f, "sees      nothing: the primary ray leaves the scene")?,
        }
        let Some(s) = &self.surface else {
            let why = if self.seen.is_some() { "an unlit surface shows its color" } else { "the background" };
            return writeln!(f, "nothing to light here: {why}");
        };
        let ulps = match s.distance_ulps {
            Some(ulps) => format!("{ulps} ulp from the CPU's ray"),
            None => "the CPU's ray met another geometry".into(),
        };
        writeln!(f, "surface   at {}, {} m away ({ulps})", vector(s.position), number(s.distance))?;
        if s.lift > 0.0 {
            let lift = number(s.lift);
            writeln!(f, "          {lift} m above its triangle, on the curved surface that it stands for")?;
        }
        writeln!(f, "          normal {}, geometric {}", vector(s.normal), vector(s.geometric_normal))?;
        let (diffuse, f0) = (vector(s.diffuse), vector(s.f0));
        writeln!(f, "          diffuse {diffuse}, f0 {f0}, roughness {}", number(s.roughness))?;
        writeln!(f, "emission  {} nit", vector(self.emission))
    }

    /// Equal, off by rounding, or more than that: the comparison of CPU and GPU in a sentence.
    pub fn verdict(&self) -> String {
        let Some(shading) = &self.shading else { return "no resampling here".into() };
        let worst = self.worst_ulps();
        let flipped = self.disagreeing_rays();
        let rays = match flipped {
            0 => String::new(),
            n => format!(", with the GPU's answer for {n} rays"),
        };
        if !self.is_explained() {
            let pass = self.passes.iter().find(|pass| !pass.difference.is_rounding());
            let pass = pass.map_or("shade", |pass| pass.pass);
            return format!("the CPU DIFFERS in {pass} by more than rounding{rays}");
        }
        match (worst, shading.ulps) {
            (0, _) => format!("the CPU has equal bits in every pass{rays}"),
            (worst, [r, g, b]) => format!(
                "the CPU differs by rounding alone: {r}, {g}, {b} ulp here, at most {worst} ulp in any pass{rays}"
            ),
        }
    }

    /// The largest difference of any number in any pass.
    pub fn worst_ulps(&self) -> u64 {
        let weights = self.passes.iter().map(|pass| pass.difference.weight_ulps);
        let radiance = self.shading.iter().flat_map(|shading| shading.ulps);
        weights.chain(radiance).max().unwrap_or(0)
    }

    /// Rays that the GPU must have answered otherwise than the CPU.
    pub fn disagreeing_rays(&self) -> usize {
        let of_passes = self.passes.iter().flat_map(|pass| &pass.rays);
        let of_shading = self.shading.iter().flat_map(|shading| &shading.rays);
        let bsdf_rays =
            self.passes.iter().flat_map(|pass| &pass.bsdf_rays).filter(|ray| ray.gpu_disagrees).count();
        of_passes.chain(of_shading).filter(|ray| ray.gpu_disagrees).count() + bsdf_rays
    }

    /// Same survivors, same confidences, and all else within rounding.
    pub fn is_explained(&self) -> bool {
        self.passes.iter().all(|pass| pass.difference.is_rounding())
            && self.shading.iter().all(|shading| shading.ulps.iter().all(|&ulps| ulps <= ROUNDING_ULPS))
    }
}

impl Display for PassReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let iteration = if self.pass.starts_with("spatial") || self.pass.starts_with("pair") {
            format!(" {}", self.iteration)
        } else {
            String::new()
        };
        writeln!(f, "{}{iteration}, reservoir {}", self.pass, self.reservoir)?;
        if let Some(cell) = self.cell {
            writeln!(
                f,
                "  from the pool of cell {cell}; v: the fraction of a light that it believes to arrive"
            )?;
        }
        if let Some(tile) = &self.tile {
            let all = self.candidates.iter().filter(|candidate| candidate.by == "tile").count();
            let equal = tile.equal_entries;
            writeln!(
                f,
                "  from tile {}; the CPU draws the same light and point for {equal} of {all} entries",
                tile.tile
            )?;
        }
        if !self.candidates.is_empty() {
            writeln!(
                f,
                "    {:5} {:>8} {:11} {:>12} {:>6} {:>12} {:>12} {:>12}",
                "by", "light", "kind", "p", "v", "p̂", "w = p̂/p", "Σw"
            )?;
        }
        for c in &self.candidates {
            let [p, target, weight, sum] = [c.source_pdf, c.target, c.weight, c.weight_sum].map(number);
            let (mark, light, kind) = (mark(c.chosen), c.light, c.kind);
            let (by, v) = (c.by, c.believed);
            writeln!(
                f,
                "  {mark} {by:5} {light:>8} {kind:11} {p:>12} {v:>6.3} {target:>12} {weight:>12} {sum:>12}"
            )?;
        }
        if let Some(own) = &self.canonical {
            let line = Neighbor { merged: Some(own.clone()), ..Neighbor::default() };
            writeln!(
                f,
                "    {:>10} {:>8} {:>12} {:>6} {:>12} {:>12} {:>12} {:>12} {:>12} {:>10}",
                "pixel", "light", "W", "M", "p̂", "p̂_i(y_i)", "p̂_i(y_0)", "m", "w", "pending"
            )?;
            write_merged(f, "(own)", &line)?;
        }
        for other in &self.others {
            let pixel = other.pixel.map_or("(none)".into(), |[x, y]| format!("{x},{y}"));
            match other.rejected {
                Some(why) => writeln!(f, "    {pixel:>10} not merged: {why}")?,
                None => write_merged(f, &pixel, other)?,
            }
        }
        self.bsdf_rays.iter().try_for_each(|ray| write!(f, "{ray}"))?;
        self.rays.iter().try_for_each(|ray| write!(f, "{ray}"))?;
        writeln!(f, "  cpu {}", self.cpu)?;
        writeln!(f, "  gpu {}: {}", self.gpu, self.difference)
    }
}

fn write_merged(f: &mut Formatter<'_>, pixel: &str, line: &Neighbor) -> Result {
    let Some(merged) = &line.merged else { return Ok(()) };
    let or_none = |x: Option<f32>| x.map_or(String::new(), number);
    let light = merged.reservoir.light.map_or("none".into(), |light| light.to_string());
    let pending = or_none(line.pending) + if line.asked { " ?" } else { "" };
    writeln!(
        f,
        "  {} {pixel:>10} {light:>8} {:>12} {:>6} {:>12} {:>12} {:>12} {:>12} {:>12} {pending:>10}",
        mark(merged.chosen),
        number(merged.reservoir.contribution_weight),
        merged.reservoir.confidence,
        number(merged.target),
        or_none(line.target_there),
        or_none(line.canonical_there),
        number(merged.mis_weight),
        number(merged.weight),
    )
}

impl Display for BsdfRay {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (origin, direction) = (vector(self.origin), vector(self.direction));
        write!(f, "  BSDF ray: from {origin} along {direction}: ")?;
        match &self.hit {
            None => write!(f, "leaves the scene")?,
            Some(hit) => write!(f, "meets instance '{}', triangle {}", hit.instance, hit.triangle)?,
        }
        match self.light {
            None => write!(f, ", finds no light")?,
            Some(light) => write!(f, ", finds light {light}")?,
        }
        writeln!(f, "{}", if self.gpu_disagrees { "; THE GPU FOUND ANOTHER" } else { "" })
    }
}

impl Display for Ray {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (origin, direction) = (vector(self.origin), vector(self.direction));
        write!(f, "  ray {}: from {origin} along {direction}: ", self.purpose)?;
        match &self.blocker {
            None => write!(f, "visible")?,
            Some(hit) => write!(
                f,
                "hidden at t = {:.6} by instance '{}', material '{}', triangle {}",
                hit.t, hit.instance, hit.material, hit.triangle
            )?,
        }
        writeln!(f, "{}", if self.gpu_disagrees { "; THE GPU SAYS OTHERWISE" } else { "" })
    }
}

impl Display for Survivor {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self.light {
            Some(light) => write!(f, "light {light} ({})", self.kind)?,
            None => write!(f, "no light")?,
        }
        write!(f, ", W {}, M {}", number(self.contribution_weight), self.confidence)
    }
}

impl Display for Difference {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Difference { same_sample: false, .. } => write!(f, "ANOTHER SURVIVOR"),
            Difference { weight_ulps: 0, confidence_ulps: 0, .. } => write!(f, "equal bits"),
            Difference { weight_ulps, confidence_ulps: 0, .. } => write!(f, "W differs by {weight_ulps} ulp"),
            Difference { weight_ulps, confidence_ulps, .. } => {
                write!(f, "W differs by {weight_ulps} ulp, M by {confidence_ulps}")
            }
        }
    }
}

impl Display for Shading {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(f, "shade")?;
        for (lane, &contribution) in self.contributions.iter().enumerate() {
            writeln!(f, "  reservoir {lane}: f Le G W = {} nit", vector(contribution))?;
        }
        self.rays.iter().try_for_each(|ray| write!(f, "{ray}"))?;
        writeln!(f, "  cpu radiance {} nit", vector(self.cpu))
    }
}
