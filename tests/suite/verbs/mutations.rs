//! Damaged files of every kind: each is read or refused, none makes the program panic, none takes more than it may.
//!
//! Short by default. `MECHANIM_MUTATIONS=1000000` reads so many scenes, and as many of the other kinds together;
//! `MECHANIM_RUNS=100000` sends so many mutated scenes through check, solve, render and plot, each run a process, and
//! `MECHANIM_INSIDE=100000` without processes of their own; both print the figures that docs/strangers.md has. A mutation depends on its number only; `MECHANIM_FIRST` is the number to begin with.

use crate::program;
use crate::program::{Workspace, finish, peak_of_process, seconds_of_children, seconds_of_process};
use mechanim::cli::interrupt::CANCEL;
use mechanim::diag::Source;
use mechanim::import::{FilmFrame, FilmReader, ImportError};
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use mechanim::snapshot::Manifest;
use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// Reading one file may take so long: mutations of a few kilobytes take milliseconds.
const LONGEST: Duration = Duration::from_secs(10);

/// How often it is looked at.
const LOOK: Duration = Duration::from_millis(100);

/// What a run of a mutated scene may use.
const LIMITS: &str = "time=60s,memory=1G";

/// Processor seconds beyond which a run counts as slow.
const SLOW: f64 = 20.0;

/// Bytes of a process from which on a run that takes more than all before it is named.
const ENOUGH: f64 = 200e6;

fn asked(variable: &str, usual: u64) -> u64 {
    let text = std::env::var(variable).ok();
    text.map_or(usual, |text| text.parse().expect(variable))
}

/// Numbers that look random and are the same everywhere (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

/// What stands in scenes, formulas and tables, and what breaks them.
const WORDS: [&str; 44] = [
    "Rx(",
    "Ry(",
    "Rz(",
    "Tx(",
    "Ty(",
    "Tz(",
    "Rot(",
    "inv(",
    "floor(",
    "atan2(",
    "sqrt(",
    "acos(",
    "exp(",
    "abs(",
    "min(",
    ")",
    "(",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    "\n",
    ",",
    ";",
    "=",
    "^",
    "/",
    "*",
    "t",
    "pi",
    "0",
    "-1",
    "1e300",
    "1e-300",
    "nan",
    "inf",
    "3.5",
    "\u{1b}[31m",
    "ä",
    "\u{202e}",
    "\0",
    "[[bodies]]\nname = \"x\"\n",
];

fn mutated(seeds: &[Vec<u8>], number: u64) -> Vec<u8> {
    let mut random = Random(number.wrapping_mul(0x2545_f491_4f6c_dd1d));
    let mut bytes = seeds[random.below(seeds.len())].clone();
    // Mostly mild: what is refused at once finds little.
    for _ in 0..1 + random.below(3) {
        let at = random.below(bytes.len() + 1);
        let length = random.below(24).min(bytes.len() - at);
        let other = &seeds[random.below(seeds.len())];
        match random.below(14) {
            0 => drop(bytes.drain(at..at + length)),
            1 => {
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(at..at, word.bytes());
            }
            2 => {
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(at..at + length, word.bytes());
            }
            3 => {
                let from = random.below(other.len());
                let part = other[from..(from + 40).min(other.len())].to_vec();
                bytes.splice(at..at, part);
            }
            4 | 8.. => {
                // A number becomes another one.
                let place = (at..bytes.len()).find(|k| bytes[*k].is_ascii_digit());
                if let Some(place) = place {
                    let text = ["0", "1", "7", "-3", "1e9", "1e-9", "90", "0.5"][random.below(8)];
                    bytes.splice(place..place + 1, text.bytes());
                }
            }
            5 if !bytes.is_empty() => {
                let at = at.min(bytes.len() - 1);
                bytes[at] ^= 1 << random.below(8);
            }
            6 => bytes.truncate(at.max(bytes.len() / 2)),
            _ => {
                let part = bytes[at..at + length].to_vec();
                bytes.splice(at..at, part.repeat(1 + random.below(8)));
            }
        }
    }
    bytes
}

/// Tries `count` mutations; says which number makes `read` panic or wait.
fn survive(kind: &str, seeds: &[Vec<u8>], count: u64, mut read: impl FnMut(&[u8])) {
    let first = asked("MECHANIM_FIRST", 0);
    for number in first..first + count {
        let bytes = mutated(seeds, number);
        let begun = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| read(&bytes)));
        assert!(
            outcome.is_ok(),
            "{kind}: mutation {number} panics:\n{}",
            String::from_utf8_lossy(&bytes)
        );
        assert!(
            begun.elapsed() < LONGEST,
            "{kind}: mutation {number} takes {:?}",
            begun.elapsed()
        );
    }
}

fn scene_seeds() -> Vec<Vec<u8>> {
    let mut seeds: Vec<Vec<u8>> = builtin::ALL
        .iter()
        .map(|s| s.text.as_bytes().to_vec())
        .collect();
    // Most of the corpus is usable, some of it is wrong in every way that has a message.
    seeds = vec![seeds; 4].concat();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bad");
    let mut bad: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    bad.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    bad.sort();
    seeds.extend(bad.iter().map(|path| std::fs::read(path).unwrap()));
    seeds
}

fn read_scene(bytes: &[u8]) -> Option<Scene> {
    let text = String::from_utf8_lossy(bytes).into_owned();
    let name = "mutated".to_owned();
    load_scene(&Source { name, text }, &Overrides::default()).ok()
}

#[test]
fn scenes_are_read_or_refused() {
    let mut usable = 0;
    survive(
        "scene",
        &scene_seeds(),
        asked("MECHANIM_MUTATIONS", 1500),
        |bytes| {
            usable += u64::from(read_scene(bytes).is_some());
        },
    );
    println!("{usable} of the scenes are usable");
}

#[test]
fn formulas_are_read_or_refused() {
    let seeds = [
        "2*t + sin(t)^2",
        "atan2(x, y)/(1 + exp(-t))",
        "floor(3*t) - abs(t)",
        "if(t, 1, 2)",
    ];
    let seeds = seeds.map(|s| s.as_bytes().to_vec());
    let scene = program::moving();
    survive(
        "formula",
        &seeds,
        asked("MECHANIM_MUTATIONS", 4000) / 4,
        |bytes| {
            let formula = String::from_utf8_lossy(bytes).replace(['"', '\\', '\n', '\r'], "");
            read_scene(scene.replace("2*t", &formula).as_bytes());
        },
    );
}

fn stl_seeds() -> Vec<Vec<u8>> {
    let mut binary = vec![0; 80];
    binary.extend(2u32.to_le_bytes());
    for k in 0..2u8 {
        binary.extend([0; 12]);
        binary.extend((0..9u8).flat_map(|n| f32::from(n * n + k).to_le_bytes()));
        binary.extend([0; 2]);
    }
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\nendloop\nendfacet\nendsolid a\n";
    vec![binary, text.repeat(2).into_bytes()]
}

#[test]
fn meshes_are_read_or_refused() {
    let w = Workspace::new();
    survive(
        "STL",
        &stl_seeds(),
        asked("MECHANIM_MUTATIONS", 4000) / 8,
        |bytes| {
            let path = w.write("m.stl", bytes);
            if let Ok(soup) = mechanim::geometry::read_stl(&path) {
                mechanim::geometry::mesh_of_triangles(&soup.vertices, &soup.triangles).is_closed();
            }
        },
    );
}

#[test]
fn pictures_are_read_or_refused() {
    let w = Workspace::new();
    w.write("s.toml", program::moving());
    let seeds = ["a.png", "a.apng", "a.gif"].map(|name| {
        let frames = if name == "a.png" { "1" } else { "3" };
        w.run(&[
            "render", "s.toml", "--size", "24x16", "--frames", frames, "--out", name,
        ])
        .exits(0);
        w.read(name)
    });
    survive(
        "picture",
        &seeds,
        asked("MECHANIM_MUTATIONS", 4000) / 8,
        |bytes| {
            let path = w.write("mutated", bytes);
            if let Ok(film) = FilmReader::open(&path) {
                let read = |frame: FilmFrame| {
                    let mut rows = frame.picture.rows()?;
                    while rows.next_row()?.is_some() {}
                    Ok::<_, ImportError>(())
                };
                let _ = film.take(50).try_for_each(|frame| frame.and_then(read));
            }
        },
    );
}

#[test]
fn tables_are_read_or_refused() {
    let w = Workspace::new();
    let seeds = [
        "phi,h\n0.1,2\n0.2,3\n",
        "\u{feff}\"phi\";\"time\"\r\n0,1;0\r\n0,2;1\r\n",
        "# lab\ntime\tphi\n0\t0.5\n1\t0.6\n",
    ];
    let seeds = seeds.map(|s| s.as_bytes().to_vec());
    let scene = read_scene(program::moving().as_bytes()).unwrap();
    survive(
        "table",
        &seeds,
        asked("MECHANIM_MUTATIONS", 8000) / 8,
        |bytes| {
            let path = w.write("t.csv", bytes);
            let mut actuation = scene.actuation.clone();
            let read = mechanim::cli::open::inputs_table::apply_inputs(
                &scene.mechanism,
                &mut actuation,
                &path,
            );
            assert!(read.is_err() || actuation.duration > 0.0);
        },
    );
}

#[test]
fn manifests_are_read_or_refused() {
    let seed = "[[picture]]\nfile = \"a.png\"\nscene = \"gearshift\"\ntime = 0.5\nsize = [32, 24]\ntolerance = 2\n";
    survive(
        "manifest",
        &[seed.as_bytes().to_vec()],
        asked("MECHANIM_MUTATIONS", 4000) / 8,
        |bytes| {
            let text = String::from_utf8_lossy(bytes).into_owned();
            let name = "snapshots.toml".to_owned();
            let _ = Manifest::read(&Source { name, text });
        },
    );
}

/// What mutated scenes go through.
const VERBS: [&[&str]; 4] = [
    &["check", "s.toml", "--samples", "3"],
    &["solve", "s.toml", "--samples", "3", "--out", "o.csv"],
    &[
        "render", "s.toml", "--frames", "3", "--size", "32x24", "--out", "o.gif",
    ],
    &["plot", "s.toml", "--samples", "3", "--out", "o.svg"],
];

/// Exit codes that are promised for a scene, whatever stands in it.
const CODES: [i32; 4] = [0, 1, 2, 4];

/// Sends usable mutated scenes through every verb of [`VERBS`], so many runs as the variable says; how many there were. A scene
/// stands in `s.toml`.
fn each_run(
    w: &Workspace,
    variable: &str,
    mut run: impl FnMut(&'static [&'static str], &dyn Fn(&str) -> String),
) -> u64 {
    let seeds = scene_seeds();
    let (first, count) = (asked("MECHANIM_FIRST", 0), asked(variable, 24));
    let mut runs = 0;
    for number in first.. {
        if runs >= count {
            break;
        }
        let bytes = mutated(&seeds, number);
        if read_scene(&bytes).is_none() {
            continue;
        }
        w.write("s.toml", &bytes);
        for verb in VERBS {
            runs += 1;
            run(verb, &|what| {
                let scene = String::from_utf8_lossy(&bytes);
                format!("mutation {number} {verb:?}: {what}\n{scene}")
            });
        }
    }
    runs
}

/// Whole runs in this process, which starts none and so makes many: `MECHANIM_INSIDE=20000`. Those that take long are told
/// to end and named. What each takes is that of the process, so a run of the suite for figures has this test alone.
#[test]
fn runs_inside_end_as_promised() {
    let w = Workspace::new();
    let (mut slow, mut failed, start) = (Vec::new(), Vec::new(), Instant::now());
    let (mut longest, mut largest) = (0.0f64, 0.0f64);
    let runs = each_run(&w, "MECHANIM_INSIDE", |verb, say| {
        let before = seconds_of_process(start);
        peak_of_process();
        let (outcome, is_slow) = unless_slow(|| run_inside(&w, verb));
        let (seconds, bytes) = (seconds_of_process(start) - before, peak_of_process());
        longest = longest.max(seconds);
        if is_slow || bytes > largest.max(ENOUGH) {
            let what = format!("{seconds:.1} CPU s, {:.0} MB", bytes / 1e6);
            let named = say(&what).lines().next().map(str::to_owned);
            println!("{}", named.as_deref().unwrap_or_default());
            slow.extend(named.filter(|_| is_slow));
        }
        largest = largest.max(bytes);
        let code = outcome.unwrap_or(70);
        if !is_slow && !CODES.contains(&code) {
            let what = say(&format!("exit {code}"));
            println!("{what}");
            failed.push(what);
        }
    });
    println!(
        "{runs} runs of mutated scenes from {} on: {} failed, {:.1} ms each, the longest {longest:.1} CPU s, the largest {:.0} MB, \
         above {SLOW} CPU s: {slow:#?}",
        asked("MECHANIM_FIRST", 0),
        failed.len(),
        start.elapsed().as_secs_f64() / runs as f64 * 1e3,
        largest / 1e6,
    );
    assert!(failed.is_empty(), "{}", failed[0]);
}

/// The verb in this process; its files stand in the workspace.
fn run_inside(w: &Workspace, verb: &[&str]) -> i32 {
    let placed = verb.iter().map(|word| match word.contains('.') {
        true => w.path(word).into_os_string(),
        false => (*word).into(),
    });
    let all = ["mechanim".into(), "-q".into()].into_iter().chain(placed);
    mechanim::cli::run(all.collect::<Vec<OsString>>())
}

/// What `work` gives, `None` where it panics; told to end by a Ctrl-C of our own where it takes more processor time than
/// [`SLOW`].
fn unless_slow<T>(work: impl FnOnce() -> T) -> (Option<T>, bool) {
    let (done, told) = mpsc::channel::<()>();
    let start = Instant::now();
    let before = seconds_of_process(start);
    std::thread::scope(|scope| {
        let watch = scope.spawn(move || {
            while told.recv_timeout(LOOK) == Err(mpsc::RecvTimeoutError::Timeout) {
                if seconds_of_process(start) - before > SLOW {
                    CANCEL.store(true, Ordering::Relaxed);
                    return true;
                }
            }
            false
        });
        let outcome = catch_unwind(AssertUnwindSafe(work));
        drop(done);
        let is_slow = watch.join().unwrap();
        if is_slow {
            CANCEL.store(false, Ordering::Relaxed);
        }
        (outcome.ok(), is_slow)
    })
}

/// Whole runs, each a process of its own with limits: exit codes are those that are promised.
#[test]
fn runs_end_as_promised() {
    let w = Workspace::new();
    let (mut limited, mut slow) = ([0u64; 2], Vec::new());
    let (start, mut longest) = (Instant::now(), 0.0f64);
    let runs = each_run(&w, "MECHANIM_RUNS", |verb, say| {
        let before = seconds_of_children(start);
        let mut command = w.command(&[verb, &["--limits", LIMITS]].concat());
        let run = finish(command.spawn().unwrap());
        let is_known = CODES.contains(&run.code) && !run.stderr.contains("panicked");
        let what = format!("exit {}\n{}", run.code, run.stderr);
        assert!(is_known, "{}", say(&what));
        limited[0] += u64::from(run.stderr.contains("the limit `memory`"));
        limited[1] += u64::from(run.stderr.contains("the limit `time`"));
        let seconds = seconds_of_children(start) - before;
        longest = longest.max(seconds);
        if seconds > SLOW {
            slow.extend(say("is slow").lines().next().map(str::to_owned));
        }
    });
    println!(
        "{runs} runs of mutated scenes: 0 panics, {} above 1 GiB, {} above 60 s, {} above {SLOW} CPU s {slow:#?}, \
         the longest {longest:.1} CPU s",
        limited[0],
        limited[1],
        slow.len()
    );
}
