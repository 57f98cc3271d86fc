//! Limits of a run: time, memory, and the sizes of everything that is made from files. Set once for the process and checked
//! where memory is allocated. Never ends the process itself.

mod deadline;
mod groups;

pub use deadline::{Deadline, run_began};

use std::fmt;
use std::path::Path;
use std::sync::OnceLock;

/// When searches end, so that what they have found is reported within the time of the run.
pub fn search_deadline() -> Deadline {
    Deadline::of_run(current_limits().most(Resource::Time))
}

/// Something a run may use up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resource {
    /// Seconds from the start of the run.
    Time,
    /// Bytes of memory.
    Memory,
    /// Numbers stored for a motion: samples times the numbers per sample.
    Samples,
    /// Pairs of bodies whose clearance is checked.
    Pairs,
    /// Triangles of all mesh files of a scene.
    Triangles,
    /// Pixels of one picture, read or drawn.
    Pixels,
    /// Pixels of one picture that is drawn and written in strips; never in memory as a whole.
    Poster,
    /// Pixels of all frames of a film that is read.
    Film,
    /// Bytes of messages about one file.
    Message,
}

/// The unit of an amount.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Unit {
    Seconds,
    Bytes,
    Count,
}

impl Resource {
    /// All of them, in the order of help texts.
    pub const ALL: [Self; 9] = [
        Self::Time,
        Self::Memory,
        Self::Samples,
        Self::Pairs,
        Self::Triangles,
        Self::Pixels,
        Self::Poster,
        Self::Film,
        Self::Message,
    ];

    /// Its name in `--limits`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Memory => "memory",
            Self::Samples => "samples",
            Self::Pairs => "pairs",
            Self::Triangles => "triangles",
            Self::Pixels => "pixels",
            Self::Poster => "poster",
            Self::Film => "film",
            Self::Message => "message",
        }
    }

    const fn unit(self) -> Unit {
        match self {
            Self::Time => Unit::Seconds,
            Self::Memory | Self::Message => Unit::Bytes,
            _ => Unit::Count,
        }
    }

    /// Default limits: more than any example needs, less than would fill a usual machine.
    const fn usual(self) -> f64 {
        match self {
            Self::Time | Self::Memory => f64::INFINITY,
            // Ten thousand poses of ten thousand numbers, or a million of a hundred.
            Self::Samples => 1e8,
            // Of two thousand bodies.
            Self::Pairs => 2e6,
            Self::Triangles => 4e6,
            // 8K video has 33 million.
            Self::Pixels => 64e6,
            // A0 at 300 dots per inch has 139 million, and the longest sides that can be drawn 236 million.
            Self::Poster => 240e6,
            // Ten thousand frames of 720 x 540, a minute or two.
            Self::Film => 4e9,
            Self::Message => 1048576.0,
        }
    }

    /// An amount in words.
    pub fn shown(self, amount: f64) -> String {
        const STEPS: [(f64, &str); 3] = [
            (1073741824.0, " GiB"),
            (1048576.0, " MiB"),
            (1024.0, " KiB"),
        ];
        match self.unit() {
            _ if amount.is_infinite() => "any".to_owned(),
            Unit::Seconds => format!("{amount} s"),
            Unit::Bytes => {
                let step = STEPS.iter().find(|(size, _)| amount >= *size);
                let (size, word) = step.copied().unwrap_or((1.0, " bytes"));
                format!("{}{word}", (amount / size * 10.0).round() / 10.0)
            }
            Unit::Count => format!("{amount:.0}"),
        }
    }
}

/// A request exceeds a limit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the limit `{}` is {}, and {who} {needs} {} (--limits {}=…)",
    .resource.name(), .resource.shown(*.most), .resource.shown(*.wanted), .resource.name())]
pub struct LimitExceeded {
    /// The resource.
    pub resource: Resource,
    /// The limit.
    pub most: f64,
    /// The requested amount.
    pub wanted: f64,
    /// The purpose of the request.
    pub who: String,
    /// Whether the amount would be needed or is already in use.
    pub needs: &'static str,
}

/// The limit of every resource.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits([f64; Resource::ALL.len()]);

impl Default for Limits {
    fn default() -> Self {
        Self(Resource::ALL.map(Resource::usual))
    }
}

impl Limits {
    /// The limits of a text such as `time=10s,memory=512M`; others keep their defaults. A limit of pixels is also that of
    /// posters, unless those have their own.
    ///
    /// Errors, as text: an invalid name or amount.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut limits = Self::default();
        let (mut pixels, mut own) = (None, false);
        for part in text.split(',').filter(|part| !part.trim().is_empty()) {
            let (name, amount) = part.split_once('=').ok_or("write NAME=AMOUNT,…")?;
            let known = Resource::ALL.into_iter().find(|r| r.name() == name.trim());
            let Some(resource) = known else {
                let names = Resource::ALL.map(Resource::name).join(", ");
                return Err(format!("there is no limit `{}`: {names}", name.trim()));
            };
            let read = amount_of(resource.unit(), amount.trim()).ok_or_else(|| {
                format!("`{}` is not an amount for `{}`", amount.trim(), name.trim())
            })?;
            limits.0[resource as usize] = read;
            match resource {
                Resource::Poster => own = true,
                Resource::Pixels => pixels = Some(read),
                _ => {}
            }
        }
        if let Some(most) = pixels.filter(|_| !own) {
            limits.0[Resource::Poster as usize] = most;
        }
        Ok(limits)
    }

    /// The smaller of both, one by one: options can only tighten the limits of the environment.
    pub fn and(self, other: Self) -> Self {
        Self(Resource::ALL.map(|r| self.most(r).min(other.most(r))))
    }

    /// The limit of a resource.
    pub fn most(&self, resource: Resource) -> f64 {
        self.0[resource as usize]
    }

    /// Rejects a request for more than is allowed.
    pub fn allow(
        &self,
        resource: Resource,
        wanted: f64,
        who: &dyn fmt::Display,
    ) -> Result<(), LimitExceeded> {
        match self.most(resource) {
            most if wanted > most => Err(LimitExceeded {
                resource,
                most,
                wanted,
                who: who.to_string(),
                needs: "needs",
            }),
            _ => Ok(()),
        }
    }
}

/// `512M`, `10s`, `2_000_000`.
fn amount_of(unit: Unit, text: &str) -> Option<f64> {
    let digits = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '_')));
    let (number, suffix) = text.split_at(digits.unwrap_or(text.len()));
    let number: f64 = number.replace('_', "").parse().ok()?;
    let factor = match (unit, suffix.to_ascii_lowercase().as_str()) {
        (_, "") | (Unit::Seconds, "s") | (Unit::Bytes, "b") => 1.0,
        (Unit::Seconds, "ms") => 1e-3,
        (Unit::Seconds, "m" | "min") => 60.0,
        (Unit::Seconds, "h") => 3600.0,
        (Unit::Bytes, "k" | "kb" | "kib") => 1024.0,
        (Unit::Bytes, "m" | "mb" | "mib") => 1048576.0,
        (Unit::Bytes, "g" | "gb" | "gib") => 1073741824.0,
        (Unit::Count, "k") => 1e3,
        (Unit::Count, "m") => 1e6,
        (Unit::Count, "g") => 1e9,
        _ => return None,
    };
    let amount = number * factor;
    (amount > 0.0 && amount.is_finite()).then_some(amount)
}

/// Set by the program before anything else; libraries use the defaults.
static OF_PROCESS: OnceLock<Limits> = OnceLock::new();

/// Sets the limits of the process; only the first call counts.
pub fn set_limits(limits: Limits) {
    let _ = OF_PROCESS.set(limits);
}

/// The limits of the process.
pub fn current_limits() -> Limits {
    OF_PROCESS.get().copied().unwrap_or_default()
}

/// Fraction of the memory allowed by the system that a run may use: the rest is a reserve.
const SHARE: f64 = 0.9;

/// The memory that the process uses, and the system's limit, as far as Linux reports them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Memory {
    /// Bytes in memory.
    pub resident: f64,
    /// Bytes of addresses.
    pub addresses: f64,
}

impl Memory {
    /// The present memory of the process; `None` where the system does not report it.
    pub fn used() -> Self {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let bytes = |key: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(key));
            let number = line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok());
            1024.0 * number.unwrap_or(0.0)
        };
        Self {
            resident: bytes("VmRSS:"),
            addresses: bytes("VmSize:"),
        }
    }

    /// The lowest limit, by `--limits` and by the system: control groups, the machine, `ulimit -v`.
    fn allowed() -> &'static Self {
        static ALLOWED: OnceLock<Memory> = OnceLock::new();
        ALLOWED.get_or_init(|| {
            let machine = line_of("/proc/meminfo", "MemTotal:").map(|kib| 1024.0 * kib);
            let least = machine
                .unwrap_or(f64::INFINITY)
                .min(groups::group_memory(Path::new("/")));
            let addresses = line_of("/proc/self/limits", "Max address space");
            Memory {
                resident: current_limits().most(Resource::Memory).min(SHARE * least),
                addresses: SHARE * addresses.unwrap_or(f64::INFINITY),
            }
        })
    }

    /// Refuses `more` bytes in addition to those in use.
    fn allow(
        self,
        more: f64,
        who: &dyn fmt::Display,
        needs: &'static str,
    ) -> Result<(), LimitExceeded> {
        let most = Self::allowed();
        let uses = [
            (self.resident, most.resident),
            (self.addresses, most.addresses),
        ];
        let over = uses.into_iter().find(|(used, most)| used + more > *most);
        over.map_or(Ok(()), |(used, most)| {
            Err(LimitExceeded {
                resource: Resource::Memory,
                most,
                wanted: used + more,
                who: who.to_string(),
                needs,
            })
        })
    }
}

/// The first number after `key` in a file of the system.
fn line_of(path: &str, key: &str) -> Option<f64> {
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Smaller requests are not checked: reading the memory in use takes as long as a pose.
const FEW: f64 = 65536.0;

/// Refuses to allocate this many more bytes than the process, or the system, permits.
pub fn allow_memory(bytes: f64, who: &dyn fmt::Display) -> Result<(), LimitExceeded> {
    if bytes < FEW {
        return Ok(());
    }
    Memory::used().allow(bytes, who, "needs")
}

/// Refuses to draw a picture with more pixels than permitted, or than fit into memory with the given bytes per pixel.
pub fn allow_picture(
    [width, height]: [u32; 2],
    bytes_a_pixel: f64,
    name: &str,
) -> Result<(), LimitExceeded> {
    let pixels = f64::from(width) * f64::from(height);
    let who = format!("{name}, {width} x {height} pixels,");
    current_limits().allow(Resource::Pixels, pixels, &who)?;
    allow_memory(pixels * bytes_a_pixel, &who)
}

/// Refuses to draw a picture in strips with more pixels than permitted, or with strips that do not fit into memory.
pub fn allow_poster(
    [width, height]: [u32; 2],
    bytes_of_strips: f64,
    name: &str,
) -> Result<(), LimitExceeded> {
    let pixels = f64::from(width) * f64::from(height);
    let who = format!("{name}, {width} x {height} pixels,");
    current_limits().allow(Resource::Poster, pixels, &who)?;
    allow_memory(bytes_of_strips, &who)
}

/// Whether the process now uses more memory than permitted.
pub fn memory_exceeded() -> Option<LimitExceeded> {
    Memory::used().allow(0.0, &"this run", "uses").err()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn amounts_are_read_with_their_units() {
        let limits = Limits::parse("time=500ms, memory=512M,samples=2_000_000,pairs=10k").unwrap();
        for (resource, most) in [
            (Resource::Time, 0.5),
            (Resource::Memory, 512.0 * 1048576.0),
            (Resource::Samples, 2e6),
            (Resource::Pairs, 1e4),
            (Resource::Pixels, Resource::Pixels.usual()),
        ] {
            assert_eq!(limits.most(resource), most, "{resource:?}");
        }
        assert_eq!(Limits::parse(""), Ok(Limits::default()));
        for wrong in [
            "time",
            "time=",
            "time=-1",
            "time=ten",
            "tim=3",
            "memory=1s",
            "pairs=1e400",
            "pairs=0",
        ] {
            assert!(Limits::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_limit_of_pixels_holds_for_posters_without_their_own() {
        for (text, most) in [
            ("", Resource::Poster.usual()),
            ("pixels=4M", 4e6),
            ("poster=7M,pixels=4M", 7e6),
            ("pixels=4M,poster=7M", 7e6),
            ("poster=7M", 7e6),
        ] {
            let limits = Limits::parse(text).unwrap();
            assert_eq!(limits.most(Resource::Poster), most, "{text}");
        }
    }

    #[test]
    fn the_smaller_limit_holds() {
        let [a, b] = ["time=5,pixels=10", "time=3,pairs=7"].map(|t| Limits::parse(t).unwrap());
        let both = a.and(b);
        assert_eq!(both.most(Resource::Time), 3.0);
        assert_eq!(both.most(Resource::Pixels), 10.0);
        assert_eq!(both.most(Resource::Pairs), 7.0);
    }

    #[test]
    fn a_refusal_names_limit_amount_and_who() {
        let limits = Limits::parse("triangles=10,message=2M").unwrap();
        assert_eq!(limits.allow(Resource::Triangles, 10.0, &"a"), Ok(()));
        let refused = limits
            .allow(Resource::Triangles, 12.0, &"m.stl")
            .unwrap_err();
        let said = "the limit `triangles` is 10, and m.stl needs 12 (--limits triangles=…)";
        assert_eq!(refused.to_string(), said);
        let refused = limits.allow(Resource::Message, 3e6, &"it").unwrap_err();
        assert!(
            refused
                .to_string()
                .contains("is 2 MiB, and it needs 2.9 MiB"),
            "{refused}"
        );
    }

    #[test]
    fn memory_is_measured_and_refused() {
        if Memory::used().resident > 0.0 {
            assert!(allow_memory(1e18, &"a picture").is_err());
            assert_eq!(allow_memory(1e3, &"a picture"), Ok(()));
        }
    }
}
