//! Runs the program as its users do, each test in a folder of its own. Holds no expectations.

use std::ffi::OsStr;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

/// Whether tests are as large as they can be: `MECHANIM_FULL=1`. Else they are a part of it.
pub fn is_full() -> bool {
    std::env::var_os("MECHANIM_FULL").is_some()
}

/// What a run left behind.
pub struct Run {
    pub code: i32,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

impl Run {
    pub fn text(&self) -> String {
        String::from_utf8(self.stdout.clone()).unwrap()
    }

    /// Fails with everything that was said unless the exit code is `code`.
    pub fn exits(self, code: i32) -> Self {
        let out = String::from_utf8_lossy(&self.stdout);
        assert_eq!(
            self.code, code,
            "stdout:\n{:.2000}\nstderr:\n{}",
            out, self.stderr
        );
        self
    }

    /// Every one of `parts` must stand in the messages.
    pub fn says(self, parts: &[&str]) -> Self {
        for part in parts {
            assert!(
                self.stderr.contains(part),
                "`{part}` is not in:\n{}",
                self.stderr
            );
        }
        self
    }

    /// Nothing on standard output.
    pub fn prints_nothing(self) -> Self {
        assert!(
            self.stdout.is_empty(),
            "{}",
            String::from_utf8_lossy(&self.stdout)
        );
        self
    }

    /// Nothing on standard error.
    pub fn says_nothing(self) -> Self {
        assert_eq!(self.stderr, "");
        self
    }
}

/// A folder that goes away with the test.
pub struct Workspace {
    folder: tempfile::TempDir,
}

impl Workspace {
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, contents).unwrap();
        path
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// Names of all files, hidden ones too, in order.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let names = entries.map(|e| e.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    /// The program, to be started in this folder, with nothing of the caller's surroundings that changes it.
    pub fn command<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mechanim"));
        command
            .current_dir(self.folder.path())
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        undisturbed(&mut command);
        command
    }

    pub fn run<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Run {
        finish(self.command(arguments).spawn().unwrap())
    }

    /// Runs with so many seconds of processor time, its own and nobody else's, which must not be used up. A clock or the
    /// time of all children would count what other tests do meanwhile.
    pub fn run_within(&self, seconds: u32, arguments: &[&str]) -> Run {
        let run = if cfg!(unix) {
            let mut shell = Command::new("sh");
            shell
                .current_dir(self.folder.path())
                .args(["-c", &format!("ulimit -t {seconds}; exec \"$0\" \"$@\"")])
                .arg(env!("CARGO_BIN_EXE_mechanim"))
                .args(arguments)
                .stdin(Stdio::null())
                .stdout(Stdio::piped())
                .stderr(Stdio::piped());
            undisturbed(&mut shell);
            finish(shell.spawn().unwrap())
        } else {
            self.run(arguments)
        };
        // What the system says where the seconds are used up: SIGKILL or SIGXCPU.
        assert!(
            ![128 + 9, 128 + 24].contains(&run.code),
            "more than {seconds} s of processor time: {arguments:?}\n{}",
            run.stderr
        );
        run
    }

    /// Runs with `input` on standard input.
    pub fn run_with(&self, arguments: &[&str], input: &[u8]) -> Run {
        let mut child = self
            .command(arguments)
            .stdin(Stdio::piped())
            .spawn()
            .unwrap();
        // Small enough for the pipe: no thread is needed.
        assert!(input.len() < 60_000);
        child.stdin.take().unwrap().write_all(input).unwrap();
        finish(child)
    }
}

/// Takes away every variable of the environment that the program reads; a continuous integration sets `CI`, for instance.
pub fn undisturbed(command: &mut Command) {
    for variable in ["CI", "NO_COLOR", "MECHANIM_ADAPTER", "MECHANIM_LIMITS"] {
        command.env_remove(variable);
    }
}

/// Ctrl-C.
#[cfg(unix)]
pub fn interrupt(child: &Child) {
    let id = child.id().to_string();
    let kill = Command::new("kill").args(["-INT", &id]).status();
    assert!(kill.unwrap().success());
}

/// Waits for the end. A signal counts as 128 and its number, as a shell says it.
pub fn finish(child: Child) -> Run {
    let output = child.wait_with_output().unwrap();
    #[cfg(unix)]
    let signal = std::os::unix::process::ExitStatusExt::signal(&output.status).map(|s| 128 + s);
    #[cfg(not(unix))]
    let signal = None;
    Run {
        code: output.status.code().or(signal).unwrap(),
        stdout: output.stdout,
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Processor seconds of all children so far, where the system says it; else those on the clock.
pub fn seconds_of_children(begun: Instant) -> f64 {
    processor_seconds(13).unwrap_or_else(|| begun.elapsed().as_secs_f64())
}

/// Processor seconds of this process so far, its children left out; else those on the clock.
pub fn seconds_of_process(begun: Instant) -> f64 {
    processor_seconds(11).unwrap_or_else(|| begun.elapsed().as_secs_f64())
}

/// Two fields behind the name in brackets, in hundredths of a second: 11 and 12 are the process, 13 and 14 its children.
fn processor_seconds(field: usize) -> Option<f64> {
    let about = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields = about.rsplit(')').next()?;
    let ticks = fields.split_whitespace().skip(field).take(2);
    let ticks: Option<f64> = ticks.map(|n| n.parse::<f64>().ok()).sum();
    Some(ticks? / 100.0)
}

/// Bytes that this process had in memory at most since the last call, where the system says it.
pub fn peak_of_process() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    // Starts anew from what is in memory now.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    peak_bytes(&status)
}

/// What a status of the system calls the most bytes in memory.
pub fn peak_bytes(status: &str) -> f64 {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    1024.0 * kib.unwrap_or(0.0)
}

/// Crank and rod, 40 and 80 mm, at a constant input: closes, and is quick.
pub const STILL: &str = r#"title = "still"
units = { length = "mm" }
[inputs]
phi = 0.3
[loops]
A = "Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)"
[guess]
h = 100
[[bodies]]
name = "crank"
frame = "Rz(phi)"
shapes = [{ capsule = { from = [0, 0, 0], to = [40, 0, 0], radius = 5 } }]
"#;

/// The same with a body that is the mesh of a file.
pub fn with_mesh(file: &str) -> String {
    format!("{STILL}[[bodies]]\nname = \"m\"\nshapes = [{{ stl = {{ file = '{file}' }} }}]\n")
}

/// A crank longer than its rod: closes only where |sin phi| <= 60/80, so up to phi = asin 0.75.
pub const LEAVES: &str = r#"title = "leaves"
duration = 1
units = { length = "mm" }
[inputs]
phi = "1.2*t"
[loops]
A = "Rz(phi) Tx(80) Rz(alpha) Tx(60) Rz(beta) Tx(-h)"
[guess]
h = 140
[[bodies]]
name = "crank"
frame = "Rz(phi)"
shapes = [{ capsule = { from = [0, 0, 0], to = [80, 0, 0], radius = 5 } }]
"#;

/// The crank as long as the rod: at 90 degrees the pose is singular, and the motion goes on.
pub const CHANGES: &str = r#"title = "changes"
duration = 1
units = { length = "mm", angle = "deg" }
[inputs]
phi = "60 + 60*t"
[loops]
A = "Rz(phi) Tx(80) Rz(alpha) Tx(80) Rz(beta) Tx(-h)"
[guess]
h = 140
"#;

/// A slider at the end of a rod, which keeps 1 mm from the crank.
pub const SLIDER: &str = r#"[[bodies]]
name = "slider"
frame = "Tx(h)"
shapes = [{ sphere = { radius = 5 } }]
[clearance]
minimum = 1
"#;

/// The same over half a second, in four frames.
pub fn moving() -> String {
    STILL
        .replace("phi = 0.3", "phi = \"2*t\"")
        .replace("title = \"still\"", "title = \"moving\"\nduration = 0.5")
        + "[view]\nfps = 8\n"
}
