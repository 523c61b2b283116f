//! The driver's statistics of compiled pipelines: registers, spills, instructions
//! (VK_KHR_pipeline_executable_properties).

use super::Check;
use super::pipeline::Pipeline;
use crate::error::Result;
use ash::vk;
use serde::Serialize;
use std::ffi::CStr;

/// One program of a pipeline, in the driver's words.
#[derive(Clone, Debug, Serialize)]
pub struct Executable {
    /// Of the executable.
    pub name: String,
    /// Shader stages that it has.
    pub stages: String,
    /// Lanes that run together; 0: the driver does not say.
    pub subgroup_size: u32,
    /// (name, value)
    pub statistics: Vec<(String, String)>,
}

impl Pipeline {
    /// Nothing where the device was not made to say it, see [`super::DeviceOptions::pipeline_statistics`].
    pub fn executables(&self) -> Result<Vec<Executable>> {
        let Some(loader) = self.device().executables() else { return Ok(Vec::new()) };
        let info = vk::PipelineInfoKHR::default().pipeline(self.handle);
        // SAFETY: the pipeline is alive, and the device has the extension and its feature.
        let found = unsafe { loader.get_pipeline_executable_properties(&info) }.check("list executables")?;
        let executable = |(index, properties): (usize, &vk::PipelineExecutablePropertiesKHR)| {
            let info =
                vk::PipelineExecutableInfoKHR::default().pipeline(self.handle).executable_index(index as u32);
            // SAFETY: as above; the pipeline was made to capture statistics and has an executable of this index.
            let statistics = unsafe { loader.get_pipeline_executable_statistics(&info) };
            Ok(Executable {
                name: text(properties.name_as_c_str()),
                stages: format!("{:?}", properties.stages),
                subgroup_size: properties.subgroup_size,
                statistics: statistics
                    .check("read statistics of an executable")?
                    .iter()
                    .map(statistic)
                    .collect(),
            })
        };
        found.iter().enumerate().map(executable).collect()
    }
}

fn statistic(s: &vk::PipelineExecutableStatisticKHR) -> (String, String) {
    use vk::PipelineExecutableStatisticFormatKHR as Format;
    // SAFETY: the format says which field of the union the driver has filled.
    let value = unsafe {
        match s.format {
            Format::BOOL32 => (s.value.b32 != vk::FALSE).to_string(),
            Format::INT64 => s.value.i64.to_string(),
            Format::UINT64 => s.value.u64.to_string(),
            Format::FLOAT64 => s.value.f64.to_string(),
            other => format!("{other:?}"),
        }
    };
    (text(s.name_as_c_str()), value)
}

fn text<E>(name: std::result::Result<&CStr, E>) -> String {
    name.map_or(String::new(), |name| name.to_string_lossy().into_owned())
}
