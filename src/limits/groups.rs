//! The memory limits of Linux control groups for a process: the lowest limit from its group upwards, in both versions.

use std::path::{Component, Path, PathBuf};

/// Bytes allowed by the groups of the process; infinite without limits. The files of the system are below `root`, which
/// is `/` except in tests.
pub(super) fn group_memory(root: &Path) -> f64 {
    let read = |name: &str| std::fs::read_to_string(root.join(name)).unwrap_or_default();
    let groups = read("proc/self/cgroup");
    let mounts = read("proc/self/mountinfo");
    let mounts = mounts.lines().filter_map(GroupMount::of_line);
    mounts
        .map(|mount| mount.least(root, &groups))
        .fold(f64::INFINITY, f64::min)
}

/// Mount point of the groups that limit memory.
struct GroupMount {
    /// The group at the root of this mount.
    group: PathBuf,
    place: PathBuf,
    /// What a line of `/proc/self/cgroup` has between its colons: nothing in version 2.
    controller: &'static str,
    /// The file that holds the limit.
    file: &'static str,
}

impl GroupMount {
    /// Of a line of `/proc/self/mountinfo`: two numbers, a device, what is mounted, where, options, `-`, kind, source,
    /// options of the kind.
    fn of_line(line: &str) -> Option<Self> {
        let (mount, kind) = line.split_once(" - ")?;
        let mut mount = mount.split(' ').skip(3);
        let (group, place) = (unescaped(mount.next()?), unescaped(mount.next()?));
        let mut kind = kind.split(' ');
        let (name, options) = (kind.next()?, kind.nth(1).unwrap_or_default());
        let (controller, file) = match name {
            "cgroup2" => ("", "memory.max"),
            "cgroup" if options.split(',').any(|o| o == "memory") => {
                ("memory", "memory.limit_in_bytes")
            }
            _ => return None,
        };
        Some(Self {
            group,
            place,
            controller,
            file,
        })
    }

    /// The lowest limit from the group of the process up to the mounted one.
    fn least(&self, root: &Path, groups: &str) -> f64 {
        let of_line = |line: &str| {
            let mut parts = line.splitn(3, ':').skip(1);
            let mut controllers = parts.next()?.split(',');
            let path = parts.next()?;
            controllers
                .any(|c| c == self.controller)
                .then(|| PathBuf::from(path))
        };
        let own = groups.lines().find_map(of_line).unwrap_or_default();
        // A group that is not below the mounted one, as in a container that sees only its own, is the mounted one
        // itself.
        let below = own.strip_prefix(&self.group).unwrap_or(Path::new(""));
        let is_plain = below
            .components()
            .all(|c| matches!(c, Component::Normal(_)));
        let below = if is_plain { below } else { Path::new("") };
        let place = root.join(self.place.strip_prefix("/").unwrap_or(&self.place));
        below
            .ancestors()
            .filter_map(|group| {
                let text = std::fs::read_to_string(place.join(group).join(self.file)).ok()?;
                // `max` is not a number.
                text.trim().parse::<f64>().ok()
            })
            .fold(f64::INFINITY, f64::min)
    }
}

/// A path with `\040` and the like for characters that would end it.
fn unescaped(text: &str) -> PathBuf {
    let mut bytes = Vec::new();
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let digits = after.get(..3).filter(|_| *first == b'\\');
        let digits = digits.and_then(|d| std::str::from_utf8(d).ok());
        match digits.and_then(|d| u8::from_str_radix(d, 8).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[3..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    PathBuf::from(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A simulated file system.
    struct MadeUp(PathBuf);

    impl MadeUp {
        fn new(name: &str, files: &[(&str, &str)]) -> Self {
            let name = format!("mechanim-groups-{}-{name}", std::process::id());
            let root = std::env::temp_dir().join(name);
            for (path, text) in files {
                let path = root.join(path);
                std::fs::create_dir_all(path.parent().unwrap()).unwrap();
                std::fs::write(path, text).unwrap();
            }
            Self(root)
        }
    }

    impl Drop for MadeUp {
        fn drop(&mut self) {
            std::fs::remove_dir_all(&self.0).ok();
        }
    }

    const MOUNTS: &str = "proc/self/mountinfo";
    const GROUPS: &str = "proc/self/cgroup";
    const SECOND: &str = "22 1 0:5 / /proc rw - proc proc rw\n30 23 0:26 / /sys/fs/cgroup rw,nosuid shared:4 - cgroup2 cgroup2 rw,nsdelegate\n";

    #[test]
    fn the_least_limit_on_the_way_up_holds() {
        let first = "35 30 0:31 / /sys/fs/cgroup/memory rw shared:11 - cgroup cgroup rw,memory\n\
                     36 30 0:32 / /sys/fs/cgroup/cpu rw shared:12 - cgroup cgroup rw,cpu,cpuacct\n";
        let none = f64::INFINITY;
        type Files<'a> = [(&'a str, &'a str)];
        let cases: &[(&str, &Files<'_>, f64)] = &[
            ("nothing", &[], none),
            (
                "no limit",
                &[
                    (MOUNTS, SECOND),
                    (GROUPS, "0::/a/b\n"),
                    ("sys/fs/cgroup/a/b/memory.max", "max\n"),
                ],
                none,
            ),
            (
                "own",
                &[
                    (MOUNTS, SECOND),
                    (GROUPS, "0::/a/b\n"),
                    ("sys/fs/cgroup/a/b/memory.max", "1000\n"),
                    ("sys/fs/cgroup/a/memory.max", "2000\n"),
                ],
                1000.0,
            ),
            (
                "parent",
                &[
                    (MOUNTS, SECOND),
                    (GROUPS, "0::/a/b\n"),
                    ("sys/fs/cgroup/a/b/memory.max", "max\n"),
                    ("sys/fs/cgroup/a/memory.max", "2000\n"),
                ],
                2000.0,
            ),
            (
                "grandparent",
                &[
                    (MOUNTS, SECOND),
                    (GROUPS, "0::/a/b/c\n"),
                    ("sys/fs/cgroup/a/b/c/memory.max", "5000\n"),
                    ("sys/fs/cgroup/a/memory.max", "700\n"),
                ],
                700.0,
            ),
            (
                "not another's",
                &[
                    (MOUNTS, SECOND),
                    (GROUPS, "0::/a\n"),
                    ("sys/fs/cgroup/a/b/memory.max", "10\n"),
                    ("sys/fs/cgroup/c/memory.max", "10\n"),
                ],
                none,
            ),
            (
                "a container",
                &[
                    (MOUNTS, SECOND),
                    (GROUPS, "0::/\n"),
                    ("sys/fs/cgroup/memory.max", "3000\n"),
                ],
                3000.0,
            ),
            (
                "above a container",
                &[
                    (MOUNTS, SECOND),
                    (GROUPS, "0::/../../x\n"),
                    ("sys/fs/cgroup/memory.max", "3000\n"),
                    ("x/memory.max", "1"),
                ],
                3000.0,
            ),
            (
                "the first version",
                &[
                    (MOUNTS, first),
                    (GROUPS, "3:cpu,cpuacct:/q\n2:memory:/a/b\n"),
                    (
                        "sys/fs/cgroup/memory/a/b/memory.limit_in_bytes",
                        "9223372036854771712\n",
                    ),
                    ("sys/fs/cgroup/memory/a/memory.limit_in_bytes", "4000\n"),
                    ("sys/fs/cgroup/cpu/memory.limit_in_bytes", "1\n"),
                ],
                4000.0,
            ),
            (
                "a group mounted",
                &[
                    (
                        MOUNTS,
                        "35 30 0:31 /docker/abc /sys/fs/cgroup/memory ro - cgroup cgroup rw,memory",
                    ),
                    (GROUPS, "2:memory:/docker/abc/in\n"),
                    ("sys/fs/cgroup/memory/in/memory.limit_in_bytes", "6000"),
                    ("sys/fs/cgroup/memory/memory.limit_in_bytes", "9000"),
                ],
                6000.0,
            ),
            (
                "a blank in a name",
                &[
                    (MOUNTS, "30 23 0:26 / /my\\040groups rw - cgroup2 none rw"),
                    (GROUPS, "0::/a:b c\n"),
                    ("my groups/a:b c/memory.max", "800\n"),
                ],
                800.0,
            ),
            (
                "both",
                &[
                    (MOUNTS, &[SECOND, first].concat()),
                    (GROUPS, "2:memory:/v\n0::/w\n"),
                    ("sys/fs/cgroup/memory/v/memory.limit_in_bytes", "50"),
                    ("sys/fs/cgroup/w/memory.max", "60"),
                ],
                50.0,
            ),
        ];
        for (what, files, least) in cases {
            let system = MadeUp::new(&what.replace(' ', "-"), files);
            assert_eq!(group_memory(&system.0), *least, "{what}");
        }
    }
}
