//! Finding an adapter: all that wgpu knows on this machine, in order of preference.

use crate::render::RenderError;
use crate::render::adapter::{AdapterChoice, AdapterInfo, DeviceKind};
use crate::sorting::sort_by_key;

/// The adapters of this machine, best first. Empty where no driver is installed.
pub fn list_adapters() -> Vec<AdapterInfo> {
    found_adapters().iter().map(describe_adapter).collect()
}

/// The best adapter that `choice` accepts.
pub fn choose_adapter(choice: &AdapterChoice) -> Result<(wgpu::Adapter, AdapterInfo), RenderError> {
    let adapters = if *choice == AdapterChoice::Hardware && !may_have_hardware() {
        Vec::new()
    } else {
        found_adapters()
    };
    let known: Vec<AdapterInfo> = adapters.iter().map(describe_adapter).collect();
    let best = adapters
        .into_iter()
        .zip(known.iter().cloned())
        .find(|(_, info)| choice.accepts(info));
    best.ok_or_else(|| RenderError::NoAdapter(explain_choice(choice, &known, &backend_names())))
}

/// False only if the device files show that there is no graphics hardware. This avoids starting all drivers, which
/// takes most of a tenth of a second on a machine without any.
fn may_have_hardware() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    // Kernel drivers: DRM, NVIDIA's own, Windows' under Linux, and three that mobile chips use.
    let devices = [
        "dri",
        "nvidiactl",
        "nvidia0",
        "dxg",
        "mali0",
        "kgsl-3d0",
        "pvr_sync",
    ];
    devices
        .iter()
        .any(|name| std::path::Path::new("/dev").join(name).exists())
}

fn found_adapters() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    // Hardware before software; the sort is stable and keeps the driver's order.
    sort_by_key(&mut adapters, |adapter| {
        describe_adapter(adapter).device_type
    });
    adapters.retain(|adapter| {
        describe_adapter(adapter).device_type != DeviceKind::Software || trusts_software_vulkan()
    });
    adapters
}

/// Mesa's software Vulkan has crashed with 128-bit vectors, which it takes on processors without AVX.
fn trusts_software_vulkan() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx");
    #[cfg(not(target_arch = "x86_64"))]
    return true;
}

fn describe_adapter(adapter: &wgpu::Adapter) -> AdapterInfo {
    let info = adapter.get_info();
    let driver = match (info.driver.is_empty(), info.driver_info.is_empty()) {
        (_, true) => info.driver,
        (true, false) => info.driver_info,
        (false, false) if info.driver_info.contains(&info.driver) => info.driver_info,
        (false, false) => format!("{} {}", info.driver, info.driver_info),
    };
    AdapterInfo {
        name: info.name,
        driver,
        backend: format!("{:?}", info.backend),
        device_type: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => DeviceKind::Discrete,
            wgpu::DeviceType::IntegratedGpu => DeviceKind::Integrated,
            wgpu::DeviceType::VirtualGpu => DeviceKind::Virtual,
            wgpu::DeviceType::Other => DeviceKind::Unknown,
            wgpu::DeviceType::Cpu => DeviceKind::Software,
        },
    }
}

/// Names of the interfaces this build can try.
fn backend_names() -> Vec<String> {
    let compiled = wgpu::Instance::enabled_backend_features();
    compiled
        .iter_names()
        .map(|(name, _)| name.to_owned())
        .collect()
}

/// What was tried, what was found, and how to fix it.
fn explain_choice(choice: &AdapterChoice, known: &[AdapterInfo], tried: &[String]) -> String {
    let found = if known.is_empty() {
        "none were found".to_owned()
    } else {
        let names: Vec<String> = known.iter().map(ToString::to_string).collect();
        format!("found: {}", names.join("; "))
    };
    format!(
        "no {} among the backends {} ({found}). Install the driver of the graphics card; a software adapter comes \
         with the package `mesa-vulkan-drivers` (Debian, Ubuntu) and is taken by `--renderer gpu`; \
         `--renderer cpu` needs no driver",
        choice.wanted(),
        tried.join(", "),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(device_type: DeviceKind, backend: &str) -> AdapterInfo {
        AdapterInfo {
            name: "x".to_owned(),
            driver: String::new(),
            backend: backend.to_owned(),
            device_type,
        }
    }

    #[test]
    fn the_explanation_names_backends_findings_and_package() {
        let known = [info(DeviceKind::Software, "Vulkan")];
        let text = explain_choice(&AdapterChoice::Hardware, &known, &["VULKAN".to_owned()]);
        for part in [
            "hardware adapter",
            "VULKAN",
            "x (Vulkan, software)",
            "mesa-vulkan-drivers",
        ] {
            assert!(text.contains(part), "{text}");
        }
    }
}
