//! Files made to be expensive: small ones that ask for much, deep ones, endless ones, pipes that nobody writes into. Each is
//! refused or answered in little time and memory.

use crate::program::{Run, STILL, Workspace, moving};
use mechanim::scene::builtin;

/// What a run may use here, and the processor seconds it may take: most take a tenth of one.
const LIMITS: &str = "time=300s,memory=1G";
const MOST: u32 = 20;

/// Runs within the limits, ended by neither time nor memory.
fn bounded(w: &Workspace, what: &str, arguments: &[&str]) -> Run {
    bounded_by(w, what, arguments, LIMITS)
}

/// The same within others.
fn bounded_by(w: &Workspace, what: &str, arguments: &[&str], limits: &str) -> Run {
    println!("{what}: {}", arguments.join(" "));
    let run = w.run_within(MOST, &[arguments, &["--limits", limits]].concat());
    assert!(
        [0, 1, 2, 4].contains(&run.code),
        "{what}: exit {}\n{}",
        run.code,
        run.stderr
    );
    for limit in ["`memory`", "`time`"] {
        let ended = format!("the limit {limit}");
        assert!(!run.stderr.contains(&ended), "{what}: {}", run.stderr);
    }
    assert!(run.stderr.len() < 30_000, "{what}: {}", run.stderr.len());
    run
}

/// `moving` with `phi` driven by another formula.
fn driven_by(formula: &str) -> String {
    let scene = moving().replace("2*t", formula);
    assert!(scene.contains(formula));
    scene
}

fn nested(open: &str, inside: &str, close: &str, depth: usize) -> String {
    [&open.repeat(depth), inside, &close.repeat(depth)].concat()
}

#[test]
fn deep_and_long_texts_are_answered() {
    let w = Workspace::new();
    let count = 15_000;
    let many = |head: &str, line: &dyn Fn(usize) -> String| {
        let lines: String = (0..count).map(line).collect();
        format!("{}{head}\n{lines}", moving())
    };
    let formulas = [
        ("49000 parentheses", "(", ")", 49_000, ""),
        ("1e4 functions", "sin(", ")", 10_000, ""),
        ("99000 signs", "-", "", 99_000, ""),
        ("49000 powers", "2^", "", 49_000, ""),
        ("a sum of 1e6 terms", "t+", "", 1_000_000, "longer than"),
        ("a sum of 49000 terms", "t+", "", 49_000, ""),
    ];
    let formulas = formulas.map(|(what, open, close, depth, says)| {
        (what, driven_by(&nested(open, "t", close, depth)), says)
    });
    let long_chain = |factor: &str, count: usize| {
        format!("{}[chains]\nc = \"{}\"\n", moving(), factor.repeat(count))
    };
    let labels = |count: usize| {
        let label = |k| format!("[[labels]]\nbody = \"crank\"\ntext = \"{k}\"\n");
        moving() + &(0..count).map(label).collect::<String>()
    };
    let others = [
        (
            "a chain of 1e5 factors",
            long_chain("Tx(1) ", 100_000),
            "longer than",
        ),
        ("a chain of 16000 factors", long_chain("Tx(1) ", 16_000), ""),
        (
            "a chain of 24000 motions",
            long_chain("T(1,1,1) ", 8_000),
            "transforms",
        ),
        (
            "a chain of 9000 angles",
            moving().replace("Rz(phi)", &["Rz(phi)", &" Rx(alpha)".repeat(9000)].concat()),
            "not fixed",
        ),
        ("5000 labels", labels(5000), "at most 200 labels"),
        ("200 labels", labels(200), ""),
        (
            "a chain inverted 1e4 times",
            format!(
                "{}[chains]\nc = \"{}\"\n",
                moving(),
                nested("inv(", "Tx(1)", ")", 10_000)
            ),
            "",
        ),
        (
            "chains of chains",
            many("[chains]\nc0 = \"Tx(1)\"", &|k| {
                format!("c{} = \"c{k} Tx(1)\"\n", k + 1)
            }),
            "1000 deep",
        ),
        (
            "bodies on a long chain",
            format!(
                "{}[chains]\nc = \"{}\"\n{}",
                moving(),
                "Tx(1) ".repeat(16_000),
                (0..2000)
                    .map(|k| format!("[[bodies]]\nname = \"b{k}\"\nframe = \"c\"\n"))
                    .collect::<String>()
            ),
            "transforms together",
        ),
        (
            "2000 loops",
            format!(
                "title = \"l\"\nduration = 1\n[inputs]\nphi = \"t\"\n[loops]\n{}[guess]\n{}",
                (0..2000)
                    .map(|k| format!(
                        "L{k} = \"Rz(phi) Tx(40) Rz(a{k}) Tx(80) Rz(b{k}) Tx(-h{k})\"\n"
                    ))
                    .collect::<String>(),
                (0..2000)
                    .map(|k| format!("h{k} = 100\n"))
                    .collect::<String>()
            ),
            "",
        ),
        (
            "2000 four-bars, each driven by the one before",
            format!(
                "duration = 1\n[inputs]\nphi = \"0.3*t\"\n[loops]\n{}",
                (0..2000)
                    .map(|k| {
                        let drive = if k == 0 { "phi".to_owned() } else { format!("c{}", k - 1) };
                        format!("L{k} = \"Rz({drive}) Tx(40) Rz(a{k}) Tx(80) Rz(b{k}) Tx(50) Rz(c{k}) Tx(-90)\"\n")
                    })
                    .collect::<String>()
            ),
            "",
        ),
        (
            "1000 bodies on each other",
            format!(
                "{}{}",
                moving(),
                (0..1000)
                    .map(|k| format!(
                        "[[bodies]]\nname = \"b{k}\"\nframe = \"{}\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n",
                        format!("Tx({k}) Rz({k}*phi) ").repeat(1 + k % 50)
                    ))
                    .collect::<String>()
            ),
            "",
        ),
        (
            "a name of 1 MB",
            format!("{}[outputs]\n{} = \"h\"\n", moving(), "n".repeat(1_000_000)),
            "",
        ),
        (
            "a title of 1 MB",
            moving().replace("\"moving\"", &format!("\"{}\"", "W".repeat(1_000_000))),
            "",
        ),
        (
            "outputs",
            many("[outputs]", &|k| format!("o{k} = \"h + {k}\"\n")),
            "",
        ),
        (
            "bodies",
            many("", &|k| {
                format!(
                    "[[bodies]]\nname = \"b{k}\"\nshapes = [{{ sphere = {{ center = [{k}, 0, 0], radius = 1 }} }}]\n"
                )
            }),
            "",
        ),
    ];
    for (what, scene, says) in formulas.into_iter().chain(others) {
        w.write("s.toml", scene);
        let run = bounded(&w, what, &["check", "s.toml", "--samples", "3"]);
        assert!(run.stderr.contains(says), "{what}: {}", run.stderr);
        let still = [
            "render", "s.toml", "--at", "0", "--size", "64x48", "--out", "o.png",
        ];
        bounded(&w, what, &still);
    }
}

/// So many equations that none can be solved without all others.
fn coupled(count: usize) -> String {
    let equation = |k: usize| {
        let next = (k + 1) % count;
        format!("e{k} = \"x{k}^3 + x{k} + 0.1*x{next} - phi - 1\"\n")
    };
    let equations: String = (0..count).map(equation).collect();
    format!("duration = 1\n[inputs]\nphi = \"t\"\n[equations]\n{equations}")
}

#[test]
fn more_coupled_equations_than_fit_are_refused_before() {
    let w = Workspace::new();
    w.write("s.toml", coupled(10_000));
    for arguments in [
        &["check", "s.toml"][..],
        &["solve", "s.toml", "--out", "o.csv"],
        &["modes", "s.toml"],
        &["render", "s.toml", "--out", "o.gif"],
    ] {
        let run = w.run(&[arguments, &["--limits", "memory=1G"]].concat());
        run.exits(2).says(&[
            "the limit `memory` is 1 GiB",
            "solving and proving 10000 coupled equations together needs",
        ]);
    }
    w.write("s.toml", coupled(300));
    bounded(
        &w,
        "300 coupled equations",
        &["check", "s.toml", "--samples", "3"],
    )
    .exits(0);
}

/// A binary STL file that announces `count` triangles and holds these.
fn stl(count: u32, triangles: &[[f32; 9]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(count.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn meshes_made_to_be_expensive_are_refused_or_drawn() {
    const ONE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let turn = |k: usize, n: usize| std::f32::consts::TAU * k as f32 / n as f32;
    let fan = (0..50_000).map(|k| {
        let (a, b) = (turn(k, 50_000), turn(k + 1, 50_000));
        [0.0, 0.0, 1.0, a.cos(), a.sin(), 0.0, b.cos(), b.sin(), 0.0]
    });
    let around_an_edge = (0..200_000).map(|k| {
        let a = turn(k, 200_000);
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, a.cos(), a.sin(), a]
    });
    // Twenty thousand tetrahedra, every other one inside out.
    let tetrahedra: Vec<[f32; 9]> = (0..20_000)
        .flat_map(|k| {
            let at = |corner: usize| {
                let mut p = [k % 30, k / 30 % 30, k / 900].map(|n| 3.0 * n as f32);
                if let Some(c) = corner.checked_sub(1) {
                    p[c] += 2.0;
                }
                p
            };
            let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
            faces.map(|[a, b, c]| {
                let face = if k % 2 == 0 { [a, b, c] } else { [a, c, b] };
                let mut all = [0.0; 9];
                let corners = face.into_iter().flat_map(at);
                all.iter_mut().zip(corners).for_each(|(own, v)| *own = v);
                all
            })
        })
        .collect();
    let text = |inside: &str| format!("solid a\nfacet normal 0 0 1\n{inside}").into_bytes();
    let w = Workspace::new();
    let scene = format!(
        "{STILL}[[bodies]]\nname = \"m\"\nshapes = [{{ stl = {{ file = \"m.stl\" }} }}]\n\
         [[bodies]]\nname = \"n\"\nshapes = [{{ sphere = {{ center = [0, 900, 0], radius = 3 }} }}]\n\
         [clearance]\nminimum = 0.1\n"
    );
    w.write("s.toml", scene);
    for (what, mesh, says) in [
        ("4e9 announced", stl(u32::MAX, &[ONE]), "truncated"),
        (
            "not a number",
            stl(2, &[ONE, [f32::NAN; 9]]),
            "not a finite number",
        ),
        (
            "infinite",
            stl(1, &[[f32::INFINITY; 9]]),
            "not a finite number",
        ),
        (
            "beyond single squares",
            stl(1, &[ONE.map(|c| 1e38 * c)]),
            "beyond",
        ),
        (
            "without area",
            stl(3, &[[1.0; 9]; 3]),
            "no triangle with an area",
        ),
        ("without a size", stl(1, &[ONE.map(|c| 1e-40 * c)]), ""),
        (
            "one endless line",
            text(&"x".repeat(5_000_000)),
            "longer than",
        ),
        (
            "blanks without end",
            text(&" ".repeat(5_000_000)),
            "longer than",
        ),
        (
            "empty lines without end",
            text(&"\n".repeat(20_000_000)),
            "ends where",
        ),
        (
            "a number of a million digits",
            text(&format!("outer loop\nvertex {} 0 0", "1".repeat(1_000_000))),
            "",
        ),
        ("a fan", stl(50_000, &fan.collect::<Vec<_>>()), ""),
        (
            "all at one edge",
            stl(200_000, &around_an_edge.collect::<Vec<_>>()),
            "",
        ),
        (
            "shells inside out",
            stl(tetrahedra.len() as u32, &tetrahedra),
            "",
        ),
        ("all equal", stl(50_000, &vec![ONE; 50_000]), ""),
    ] {
        w.write("m.stl", mesh);
        let run = bounded(&w, what, &["check", "s.toml"]);
        assert!(run.stderr.contains(says), "{what}: {}", run.stderr);
        assert!(
            says.is_empty() || run.code == 2,
            "{what}: exit {}",
            run.code
        );
        let still = [
            "render", "s.toml", "--at", "0", "--size", "64x48", "--out", "o.png",
        ];
        bounded(&w, what, &still);
    }
}

/// A chunk of a PNG file; the sum at its end is only looked at once its contents were.
fn chunk(kind: &[u8], contents: &[u8]) -> Vec<u8> {
    let length = (contents.len() as u32).to_be_bytes();
    [&length[..], kind, contents, &[0; 4]].concat()
}

#[test]
fn pictures_made_to_be_expensive_are_refused() {
    let png = |width: u32, height: u32| {
        let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
        let head = chunk(b"IHDR", &[&size[..], &[8, 6, 0, 0, 0]].concat());
        [
            b"\x89PNG\r\n\x1a\n",
            &head[..],
            &chunk(b"IDAT", &[]),
            &chunk(b"IEND", &[]),
        ]
        .concat()
    };
    let gif = [
        &b"GIF89a\xff\xff\xff\xff\0\0\0,\0\0\0\0\xff\xff\xff\xff\0"[..],
        b"\x02\x02\x4c\x01\0;",
    ];
    let w = Workspace::new();
    for (what, bytes) in [
        (
            "a PNG of the largest size",
            png(i32::MAX as u32, i32::MAX as u32),
        ),
        ("a PNG of one line", png(i32::MAX as u32, 1)),
        ("a PNG of 268 megapixels", png(16384, 16384)),
        ("a GIF of the largest size", gif.concat()),
    ] {
        w.write("a", bytes);
        for arguments in [&["diff", "a", "a"][..], &["encode", "a", "--out", "o.gif"]] {
            bounded(&w, what, arguments)
                .exits(2)
                .says(&["the limit `pixels`"]);
        }
    }
}

/// A GIF of `count` frames of one pixel on a canvas.
fn gif(canvas: [u16; 2], frame: [u16; 2], count: usize, pixels: &[u8]) -> Vec<u8> {
    let [[w, h], [fw, fh]] = [canvas, frame].map(|size| size.map(u16::to_le_bytes));
    let table = [0x80, 0, 0, 0, 0, 0, 255, 255, 255];
    let control = [0x21, 0xf9, 4, 4, 1, 0, 0, 0, 0x2c, 0, 0, 0, 0];
    let one = [&control[..], &fw, &fh, &[0], pixels].concat();
    [b"GIF89a", &w[..], &h, &table, &one.repeat(count), b";"].concat()
}

/// One pixel: the codes clear, 0, end in blocks of a length and bytes.
const PIXEL: [u8; 5] = [2, 2, 0x44, 1, 0];

#[test]
fn films_made_to_be_expensive_are_read_or_refused() {
    let endless = [
        &[2][..],
        &[&[255][..], &[0x24; 255]].concat().repeat(40_000),
        &[0],
    ]
    .concat();
    let film = "the limit `film` is 400000000";
    let w = Workspace::new();
    for (what, bytes, says, code) in [
        ("200000 frames", gif([1, 1], [1, 1], 200_000, &PIXEL), "", 0),
        (
            "frames of a large canvas",
            gif([4000; 2], [1, 1], 10_000, &PIXEL),
            film,
            2,
        ),
        (
            "frames that are cut short",
            gif([4000; 2], [4000; 2], 500, &PIXEL),
            "truncated",
            2,
        ),
        (
            "frames beyond the canvas",
            gif([10; 2], [u16::MAX; 2], 20, &PIXEL),
            "limit",
            2,
        ),
        (
            "codes behind the end of a frame",
            gif([9; 2], [9; 2], 1, &endless),
            "",
            0,
        ),
        (
            "the largest canvas",
            gif([7000; 2], [1, 1], 1, &PIXEL),
            "",
            0,
        ),
    ] {
        w.write("a", bytes);
        let limits = "time=300s,memory=1G,film=400M";
        let run = bounded_by(&w, what, &["diff", "a", "a"], limits);
        assert!(run.stderr.contains(says), "{what}: {}", run.stderr);
        run.exits(code);
        if code == 2 {
            let encoded = ["encode", "a", "--out", "o.gif"];
            bounded_by(&w, what, &encoded, limits).exits(code);
        }
    }
}

#[test]
fn tables_without_end_are_refused() {
    let w = Workspace::new();
    w.write("s.toml", moving());
    for (what, table) in [
        (
            "a million columns",
            format!("phi{}\n", ",c".repeat(1_000_000)),
        ),
        ("one quote", "\"".repeat(3_000_000)),
    ] {
        w.write("t.csv", table);
        bounded(
            &w,
            what,
            &["solve", "s.toml", "--inputs", "t.csv", "--out", "-"],
        )
        .exits(2)
        .says(&["longer than"]);
    }
}

/// What is named on the command line may be a pipe; one that nobody writes into is not waited for without end. What a scene
/// names may not.
#[cfg(unix)]
#[test]
fn pipes_are_not_waited_for() {
    let w = Workspace::new();
    let pipe = |name: &str| {
        let made = std::process::Command::new("mkfifo")
            .arg(w.path(name))
            .status();
        assert!(made.unwrap().success());
    };
    for name in ["scene.toml", "table.csv", "a.png", "m.stl"] {
        pipe(name);
    }
    w.write("s.toml", moving());
    let mesh = "[[bodies]]\nname = \"m\"\nshapes = [{ stl = { file = \"m.stl\" } }]\n";
    w.write("m.toml", format!("{STILL}{mesh}"));
    for (arguments, says) in [
        (&["check", "scene.toml"][..], "nothing was written"),
        (
            &["solve", "s.toml", "--inputs", "table.csv", "--out", "-"],
            "nothing was written",
        ),
        (&["diff", "a.png", "a.png"], "not a regular file"),
        (&["encode", "a.png", "--out", "o.gif"], "not a regular file"),
        (&["check", "m.toml"], "not a regular file"),
    ] {
        bounded(&w, arguments[0], arguments).exits(2).says(&[says]);
    }
    // One that is written to is read.
    let text = moving();
    std::thread::scope(|scope| {
        scope.spawn(|| std::fs::write(w.path("scene.toml"), text));
        bounded(&w, "a pipe with a writer", &["check", "scene.toml"]).exits(0);
    });
}

/// Diagrams of many loops: labels look for places among all that is drawn.
#[test]
fn diagrams_of_a_thousand_loops_are_drawn() {
    let w = Workspace::new();
    let loops: String = (0..1000)
        .map(|k| {
            let drive = if k == 0 {
                "phi".to_owned()
            } else {
                format!("c{}", k - 1)
            };
            format!(
                "L{k} = \"Rz({drive}) Tx(40) Rz(a{k}) Tx(80) Rz(b{k}) Tx(50) Rz(c{k}) Tx(-90)\"\n"
            )
        })
        .collect();
    w.write(
        "s.toml",
        format!("duration = 1\n[inputs]\nphi = \"0.3*t\"\n[loops]\n{loops}"),
    );
    let draw = ["draw", "s.toml", "--out", "o.svg"];
    bounded(&w, "a diagram of 1000 loops", &draw).exits(0);
}

/// A PNG of one colour, RGB, whose rows are written one by one.
fn plain_picture(side: u32, level: u8) -> Vec<u8> {
    use std::io::Write as _;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side, side);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    let mut rows = writer.stream_writer().unwrap();
    let row = vec![level; 3 * side as usize];
    (0..side).for_each(|_| rows.write_all(&row).unwrap());
    rows.finish().unwrap();
    writer.finish().unwrap();
    bytes
}

/// Two stills of 64 megapixels, and what they differ by, in the memory of their rows.
#[test]
fn large_stills_are_compared_row_by_row() {
    let w = Workspace::new();
    w.write("a.png", plain_picture(8000, 10));
    w.write("b.png", plain_picture(8000, 13));
    let diff = ["diff", "a.png", "b.png", "--out", "d.png"];
    let run = bounded_by(&w, "large stills", &diff, "time=300s,memory=60M");
    run.exits(1);
}

/// A mesh within the range of its file, and far beyond that of a scene once it is scaled.
#[test]
fn meshes_scaled_beyond_the_range_are_refused() {
    const ONE: [f32; 9] = [0.0, 0.0, 0.0, 1e17, 0.0, 0.0, 0.0, 1e17, 0.0];
    let w = Workspace::new();
    w.write("m.stl", stl(1, &[ONE]));
    for (scale, code) in [("1e42", 0), ("1e50", 2), ("1e59", 2)] {
        let mesh = format!("stl = {{ file = \"m.stl\", scale = {scale}, surface = true }}");
        let body = format!("[[bodies]]\nname = \"m\"\nshapes = [{{ {mesh} }}]\n");
        w.write("s.toml", format!("{STILL}{body}"));
        let run = bounded(&w, scale, &["solve", "s.toml", "--out", "o.csv"]);
        assert_eq!(run.code, code, "{scale}: {}", run.stderr);
        let says = "at most 1e60";
        assert_eq!(run.stderr.contains(says), code == 2, "{}", run.stderr);
    }
}

/// A body so large that its poses are rounded by more than the mechanism's size: no bound can pass, and none is searched for long.
/// Where squares of squares overflow, it is refused.
#[test]
fn solids_too_large_for_a_proof_are_left_undecided() {
    let w = Workspace::new();
    let scene = builtin::find_builtin("twin-steer").unwrap().text;
    for (size, code) in [
        ("1e16", 1),
        ("1e30", 1),
        ("1e59", 1),
        ("1e94", 2),
        ("1e300", 2),
    ] {
        let grown = scene.replace("\"YP-24\"", &format!("\"YP-{size}\""));
        assert_ne!(grown, scene);
        w.write("large.toml", grown.as_bytes());
        let run = bounded(
            &w,
            &format!("`check` with a cylinder of {size} mm"),
            &["check", "large.toml", "--samples", "3"],
        );
        assert_eq!(run.code, code, "{size}: {}", run.stderr);
    }
}

/// Four megabytes of nothing but mistakes of grammar, each of which a reader that recovers would keep.
#[test]
fn files_of_mistakes_take_little_memory() {
    let w = Workspace::new();
    for line in [".", "\r", "\r\n=", "= \n", "a=\n"] {
        let text = line.repeat((4 << 20) / line.len());
        w.write("s.toml", text.clone());
        w.write("snapshots.toml", text);
        for arguments in [&["check", "s.toml"], &["snapshot", "snapshots.toml"]] {
            let run = bounded_by(&w, &format!("{line:?}"), arguments, "time=60s,memory=600M");
            assert_eq!(run.code, 2, "{line:?}: {}", run.stderr);
            assert!(run.stderr.contains("toml:"), "{line:?}: {}", run.stderr);
        }
    }
}

/// The first mistake is said under any limit of messages, and the limit that cut the list is named.
#[test]
fn the_first_mistake_is_always_said() {
    let w = Workspace::new();
    w.write(
        "s.toml",
        moving().replace("2*t", "2*no") + "[chains]\nc = \"Tx(nope(1))\"\n",
    );
    for limit in ["message=1", "message=10", "message=200"] {
        let run = w.run(&["check", "s.toml", "--limits", limit]);
        assert_eq!(run.code, 2);
        assert!(run.stderr.contains("error"), "{limit}: {}", run.stderr);
        assert!(run.stderr.contains("message"), "{limit}: {}", run.stderr);
    }
}

/// The picture of a check has the limit of every picture.
#[test]
fn pictures_of_checks_are_limited() {
    let w = Workspace::new();
    let check = [
        "check",
        "gearshift",
        "--render",
        "w.png",
        "--limits",
        "pixels=1000",
    ];
    let run = w.run(&check);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("`pixels`"), "{}", run.stderr);
    assert!(!w.path("w.png").exists());
}

/// A drive that jumps a hundred thousand times is given up, since its leaps take from the steps of the motion.
#[test]
fn leaps_take_from_the_steps_of_a_motion() {
    let w = Workspace::new();
    w.write("s.toml", driven_by("floor(floor(t*1e5)*1e5)"));
    // Without a bound it takes hours; with it some seconds.
    let check = ["check", "s.toml", "--samples", "3", "--limits", "time=300s"];
    w.run(&check).exits(1).says(&["no pose was found"]);
}

/// Blocks and bodies that do not depend on each other take what they take one by one.
#[test]
fn independent_entries_take_what_they_take_alone() {
    let w = Workspace::new();
    let entries = |count: usize, of: &dyn Fn(usize) -> String| (0..count).map(of).collect();
    let bar = |k| format!("k{k} = {{ from = [\"x{k}\", 0], to = [0, 0], length = 3 }}\n");
    let bars: String = entries(4000, &bar);
    let body = |k| format!("[[bodies]]\nname = \"b{k}\"\n");
    let bodies: String = entries(140_000, &body);
    let of_bars = ["check", "s.toml", "--samples", "3"];
    let of_bodies = ["draw", "s.toml", "--out", "o.svg"];
    for (what, more, arguments) in [
        ("4000 bars", format!("[bars]\n{bars}"), &of_bars[..]),
        ("140000 bodies", bodies, &of_bodies[..]),
    ] {
        w.write("s.toml", moving() + &more);
        bounded(&w, what, arguments);
    }
}
