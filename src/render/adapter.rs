//! The requested graphics adapter, and the properties of the adapters found. Plain data, present without the `gpu`
//! feature too, so that the command line is the same in every build.

/// The adapter a GPU renderer is asked to use.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// A hardware adapter: discrete before integrated before virtual.
    #[default]
    Hardware,
    /// A hardware adapter, or a software adapter if there is none.
    Any,
    /// A software adapter, for reproducible pictures on a machine with hardware.
    Software,
    /// The first adapter whose description contains this text, ignoring case.
    Name(String),
}

/// One adapter of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterInfo {
    /// Name of the device.
    pub name: String,
    /// Driver and its version; may be empty.
    pub driver: String,
    /// Interface: Vulkan, Metal or Dx12.
    pub backend: String,
    /// Kind of device.
    pub device_type: DeviceKind,
}

/// Kind of an adapter's device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeviceKind {
    /// A graphics card.
    Discrete,
    /// Graphics in the processor's package.
    Integrated,
    /// A share of hardware given to a virtual machine.
    Virtual,
    /// Hardware of a kind that the driver does not report.
    Unknown,
    /// A driver that computes on the processor.
    Software,
}

impl std::fmt::Display for DeviceKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Discrete => "discrete",
            Self::Integrated => "integrated",
            Self::Virtual => "virtual",
            Self::Unknown => "hardware",
            Self::Software => "software",
        })
    }
}

impl std::fmt::Display for AdapterInfo {
    /// `name (backend, driver, kind)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}", self.name, self.backend)?;
        if !self.driver.is_empty() {
            write!(f, ", {}", self.driver)?;
        }
        write!(f, ", {})", self.device_type)
    }
}

impl AdapterChoice {
    /// Whether an adapter matches the request.
    pub fn accepts(&self, adapter: &AdapterInfo) -> bool {
        match self {
            Self::Hardware => adapter.device_type != DeviceKind::Software,
            Self::Any => true,
            Self::Software => adapter.device_type == DeviceKind::Software,
            Self::Name(part) => {
                let description = adapter.to_string().to_lowercase();
                description.contains(&part.to_lowercase())
            }
        }
    }

    /// The request in words, for a message: `no <this> was found`.
    pub fn wanted(&self) -> String {
        match self {
            Self::Hardware => "hardware adapter".to_owned(),
            Self::Any => "adapter".to_owned(),
            Self::Software => "software adapter".to_owned(),
            Self::Name(part) => format!("adapter whose description contains `{part}`"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(device_type: DeviceKind) -> AdapterInfo {
        AdapterInfo {
            name: "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned(),
            driver: "Mesa 22.3.6".to_owned(),
            backend: "Vulkan".to_owned(),
            device_type,
        }
    }

    #[test]
    fn choices_accept_what_they_say() {
        let (soft, hard) = (adapter(DeviceKind::Software), adapter(DeviceKind::Discrete));
        let accepted = |c: AdapterChoice| [c.accepts(&soft), c.accepts(&hard)];
        assert_eq!(accepted(AdapterChoice::Hardware), [false, true]);
        assert_eq!(accepted(AdapterChoice::Any), [true, true]);
        assert_eq!(accepted(AdapterChoice::Software), [true, false]);
        assert_eq!(
            accepted(AdapterChoice::Name("VULKAN, mesa".to_owned())),
            [true, true]
        );
        assert_eq!(
            accepted(AdapterChoice::Name("radeon".to_owned())),
            [false, false]
        );
    }

    #[test]
    fn a_description_names_everything() {
        assert_eq!(
            adapter(DeviceKind::Software).to_string(),
            "llvmpipe (LLVM 15.0.6, 256 bits) (Vulkan, Mesa 22.3.6, software)"
        );
    }
}
