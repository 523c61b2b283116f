//! `candela info --pipelines`: the driver's statistics of each compiled pass.

use candela::error::Result;
use candela::frame::pipelines::Pipelines;
use candela::gpu_scene::GpuScene;
use candela::vulkan::Device;
use candela::vulkan::executables::Executable;
use shared::passes::{Pass, variant};

/// Of all passes, specialised for `scene`, in frame order: in the variant that a frame of the default settings has.
pub fn executables(device: &Device, scene: &GpuScene) -> Result<Vec<(&'static str, Vec<Executable>)>> {
    let mut pipelines = Pipelines::new(device, scene.set().layout(), scene.features())?;
    let passes = || Pass::ALL.iter().map(|&pass| (pass, variant::UNBIASED));
    pipelines.prepare(passes())?;
    let of = |(pass, variant): (Pass, u32)| {
        let pipeline = pipelines.get(pass, variant).map(|made| made.pipeline().executables());
        Ok((pass.stem(), pipeline.transpose()?.unwrap_or_default()))
    };
    passes().map(of).collect()
}

/// One table in Markdown: an executable a row, a number a column.
pub fn print(pass: &str, executables: &[Executable]) {
    print!("{}", table(pass, executables));
}

fn table(pass: &str, executables: &[Executable]) -> String {
    let mut columns: Vec<&str> = Vec::new();
    for (name, _) in executables.iter().flat_map(|e| &e.statistics) {
        if !columns.contains(&name.as_str()) {
            columns.push(name);
        }
    }
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let mut text = String::from("\n") + &line([&[pass, "stages", "subgroup"][..], &columns].concat());
    text += &format!("|{}\n", "---|".repeat(3 + columns.len()));
    for e in executables {
        let subgroup = e.subgroup_size.to_string();
        let value = |column: &&str| {
            e.statistics.iter().find(|(name, _)| name == column).map_or("", |(_, value)| value.as_str())
        };
        let values: Vec<&str> = columns.iter().map(value).collect();
        text += &line([&[e.name.as_str(), &e.stages, &subgroup][..], &values].concat());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_stands_under_its_name() {
        let executable = |name: &str, statistics: &[(&str, &str)]| Executable {
            name: name.into(),
            stages: "RAYGEN".into(),
            subgroup_size: 32,
            statistics: statistics.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect(),
        };
        let list = [
            executable("a", &[("Registers", "64")]),
            executable("b", &[("Spills", "3"), ("Registers", "9")]),
        ];
        let expected = "\n| shade | stages | subgroup | Registers | Spills |\n|---|---|---|---|---|\n\
                        | a | RAYGEN | 32 | 64 |  |\n| b | RAYGEN | 32 | 9 | 3 |\n";
        assert_eq!(table("shade", &list), expected);
    }
}
