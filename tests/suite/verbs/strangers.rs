//! Scenes that others wrote: nothing of them acts on a terminal or a spreadsheet, reads other files, or takes more than it
//! may.

use crate::program;
use crate::program::{Run, STILL, Workspace, moving, with_mesh};

/// Commands of CI logs, escapes, a bell, C1, bidi, and what ends texts of HTML, XML, Markdown, LaTeX and CSV.
const HOSTILE: &str = "::error::##[error]##vso[task.complete]\u{1b}[32mpassed\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}\u{2066}\
    <script>alert(1)</script><img src=x onerror=alert(1)>]]>--><!--&\"'`|[a](b)\\input{x}$%\n=1+1";

/// The same as a TOML text.
fn quoted(text: &str) -> String {
    let escape = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_ascii_graphic() || c == ' ' => c.to_string(),
        c => format!("\\U{:08x}", u32::from(c)),
    };
    format!("\"{}\"", text.chars().map(escape).collect::<String>())
}

/// Two bodies with hostile names, a rule, a measure and a plot.
fn hostile_scene() -> String {
    let text = quoted(HOSTILE);
    moving()
        .replace("title = \"moving\"", &format!("title = {text}"))
        .replace("Tx(40)", "Tx(r)")
        .replace("length = \"mm\"", &format!("length = {text}"))
        + &format!(
            "[[bodies]]\nname = {text}\nframe = \"Rz(phi) Tx(40) Rz(alpha)\"\n\
             shapes = [{{ sphere = {{ center = [80, 0, 0], radius = 3 }} }}]\n\
             [[bodies]]\nname = \"=cmd|' /C calc'!A0\"\nframe = \"Tx(h) Ty(300)\"\n\
             shapes = [{{ sphere = {{ center = [0, 0, 0], radius = 3 }} }}]\n\
             [clearance]\nminimum = 0.1\n[[plots]]\ntitle = {text}\ny = [\"h\"]\n\
             [measures.far]\nof = \"h\"\ntake = \"max\"\nmax = 900\nwhy = {text}\n\
             [parameters]\nr = 40\n[[labels]]\ntext = {text}\nbody = \"crank\"\n"
        )
}

/// Nothing in `text` but what is seen, ends of lines and tabs.
fn assert_harmless(text: &str, of: &str) {
    let acts = |c: &char| {
        (c.is_control() && !matches!(c, '\n' | '\t'))
            || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    assert_eq!(text.chars().find(acts), None, "{of}:\n{text:?}");
    // An excerpt shows a scene's own text as it stands there, behind a number and a bar.
    let is_excerpt = |line: &str| line.contains(" │ ");
    let commands = |line: &str| {
        line.trim_start().starts_with("::") || (line.contains("##vso[") && !is_excerpt(line))
    };
    assert_eq!(text.lines().find(|line| commands(line)), None, "{of}");
}

#[test]
fn nothing_of_a_scene_acts_on_who_shows_it() {
    let w = Workspace::new();
    w.write("s.toml", hostile_scene());
    w.write(
        "wrong.toml",
        hostile_scene().replace("radius = 3", &format!("radius = {}", quoted(HOSTILE))),
    );
    w.write("\u{1b}[31m.toml", "x = 1\u{9b}");
    for arguments in [
        &[
            "check",
            "s.toml",
            "--csv",
            "c.csv",
            "--json",
            "c.json",
            "--junit",
            "c.xml",
            "--plot",
            "c.svg",
            "--sarif",
            "c.sarif.json",
            "--summary",
            "c.md",
            "--matrix",
            "x.svg",
        ][..],
        &["report", "s.toml", "--out", "r.html"],
        &["compare", "s.toml", "s.toml", "--out", "k.html"],
        &["site", "s.toml", "--out", "site"],
        &["draw", "s.toml", "--out", "d.svg"],
        &["show", "s.toml"],
        &["show", "s.toml", "--out", "s.tex"],
        &["show", "s.toml", "--out", "s.html"],
        &[
            "sensitivity",
            "s.toml",
            "--vary",
            "r",
            "--out",
            "n.csv",
            "--plot",
            "n.svg",
        ],
        &[
            "enclose",
            "s.toml",
            "--vary",
            "r",
            "--tolerance",
            "0.1",
            "--out",
            "e.csv",
        ],
        &[
            "tolerance",
            "s.toml",
            "--vary",
            "r",
            "--tolerance",
            "0.1",
            "--pieces",
            "9",
            "--csv",
            "t.csv",
            "--json",
            "t.json",
        ],
        &[
            "sweep",
            "s.toml",
            "--design",
            "grid:r=39..40:2",
            "--out",
            "w.csv",
            "--plot",
            "w.svg",
        ],
        &["modes", "s.toml", "--json", "m.json"],
        &["check", "s.toml"],
        &["check", "wrong.toml"],
        &["check", "\u{1b}[31m.toml"],
        &["check", "\u{1b}[31mmissing.toml"],
        &["check", "s.toml", "--pose", "\u{1b}[31m=1"],
        &["check", "s.toml", "--\u{1b}[31m"],
        &["solve", "s.toml", "--out", "s.json"],
        &["solve", "s.toml", "--out", "-"],
        &["plot", "s.toml", "--out", "p.svg"],
        &["modes", "s.toml"],
        &[
            "render", "s.toml", "--at", "0", "--size", "32x32", "--out", "p.png",
        ],
        &["render", "s.toml", "--at", "0", "--out", "p.obj"],
    ] {
        let run = w.run(arguments);
        assert!(
            [0, 1, 2].contains(&run.code),
            "{arguments:?}: {}\n{}",
            run.code,
            run.stderr
        );
        assert_harmless(&run.stderr, &format!("{arguments:?}"));
        assert_harmless(
            &String::from_utf8_lossy(&run.stdout),
            &format!("{arguments:?}"),
        );
    }
    for file in [
        "c.csv",
        "c.json",
        "c.xml",
        "c.svg",
        "s.json",
        "p.svg",
        "p.obj",
        "c.sarif.json",
        "c.md",
        "x.svg",
        "r.html",
        "k.html",
        "site/index.html",
        "site/s.html",
        "d.svg",
        "s.tex",
        "s.html",
        "n.csv",
        "n.svg",
        "e.csv",
        "t.csv",
        "t.json",
        "w.csv",
        "w.svg",
        "m.json",
    ] {
        let text = String::from_utf8(w.read(file)).unwrap();
        assert_harmless(&text, file);
        // A page has scripts of its own.
        assert!(
            !text.contains("<script>alert") || file.ends_with(".json") || is_plain(file),
            "{file}"
        );
        assert!(
            !text.contains("<img src=x") || file.ends_with(".json") || is_plain(file),
            "{file}"
        );
        if file.ends_with(".tex") {
            let mut bare = text.lines().filter(|line| !line.starts_with('%'));
            assert!(!bare.any(|line| line.contains("\\input")), "{text}");
        }
        if file.ends_with(".svg") || file.ends_with(".xml") {
            xml::EventReader::from_str(&text)
                .into_iter()
                .for_each(|event| drop(event.expect(file)));
        }
        if file.ends_with(".json") {
            let _: serde_json::Value = serde_json::from_str(&text).expect(file);
        }
        if file.ends_with(".csv") {
            let cells = text.split(['\n', ',']).map(|cell| cell.trim_matches('"'));
            let runs =
                |cell: &str| cell.starts_with(['=', '+', '-', '@']) && cell.parse::<f64>().is_err();
            assert_eq!(cells.clone().find(|cell| runs(cell)), None, "{text}");
            // One form of numbers in all tables, and nothing for those that do not exist.
            let is_odd = |cell: &str| {
                let number = cell.parse::<f64>();
                number.is_ok_and(|v| !v.is_finite() || cell.ends_with(".0") || cell.ends_with("e0"))
            };
            assert_eq!(cells.clone().find(|cell| is_odd(cell)), None, "{text}");
        }
    }
}

/// Whether texts mean nothing but themselves in such a file.
fn is_plain(file: &str) -> bool {
    [".obj", ".csv", ".tex"]
        .iter()
        .any(|end| file.ends_with(end))
}

/// Ghosts cost a picture each: as many as a scene may ask for, and poses that there are.
#[test]
fn ghosts_are_few_and_within_the_motion() {
    let w = Workspace::new();
    w.write("s.toml", moving());
    let many = vec!["0.1"; 61].join(",");
    let still = [
        "render",
        "s.toml",
        "--at",
        "0",
        "--size",
        "32x24",
        "--out",
        "o.png",
        "--ghost-times",
    ];
    for (times, says) in [
        (many.as_str(), "at most 60"),
        ("0.1,1e300", "1e300"),
        ("0.7", "0.5 s"),
    ] {
        let run = w.run(&[&still[..], &[times]].concat());
        run.exits(2).says(&[says]);
    }
    w.run(&[&still[..], &["0,0.1,0.5"]].concat()).exits(0);
}

/// One line of so many shapes with the same mistake.
fn mistakes(count: usize) -> String {
    let shape = "{ sphere = { center = [0, 0, 0], radius = -1 } }";
    let shapes = vec![shape; count].join(", ");
    format!("{STILL}[[bodies]]\nname = \"b\"\nshapes = [{shapes}]\n")
}

#[test]
fn many_mistakes_on_one_line_are_counted_and_said_at_once() {
    let w = Workspace::new();
    w.write("s.toml", mistakes(1000));
    // Takes some hundredths of a second; took a minute with a system call a character.
    let run = w
        .run_within(5, &["check", "s.toml"])
        .exits(2)
        .says(&["and 980 more errors of 1 kind"]);
    assert_eq!(run.stderr.matches("error: ").count(), 20);
    assert!(run.stderr.len() < 20_000, "{}", run.stderr.len());
    let first = run
        .stderr
        .lines()
        .find(|line| line.contains("s.toml:"))
        .unwrap();
    let column: usize = first.rsplit(':').next().unwrap().trim().parse().unwrap();
    let text = mistakes(1);
    let line = text.lines().last().unwrap();
    assert_eq!(column, line.find("-1").unwrap() + 1, "{first}");
}

#[test]
fn excerpts_show_what_is_pointed_at_and_little_more() {
    let w = Workspace::new();
    let long = "x".repeat(100_000);
    for (scene, place) in [
        (format!("# {long}\ntitle = 3 # {long}\n"), "s.toml:2:9"),
        (format!("junk_{long} = 1\n"), "s.toml:1:1"),
        (
            format!("title = \"{long}\"\nunits = {{ length = 1, angle = \"{long}\" }}\n"),
            "s.toml:2:20",
        ),
    ] {
        w.write("s.toml", scene);
        let run = w.run(&["check", "s.toml"]).exits(2).says(&[place, "…"]);
        assert!(run.stderr.len() < 6_000, "{}", run.stderr);
    }
}

/// Messages have a size, too: what does not fit is counted.
#[test]
fn messages_end_where_they_may() {
    let w = Workspace::new();
    w.write("s.toml", mistakes(30));
    let run = w
        .run(&["check", "s.toml", "--limits", "message=1K"])
        .exits(2);
    assert!(
        run.stderr.len() < 1100 && run.stderr.contains("more errors of 1 kind"),
        "{}",
        run.stderr
    );
}

/// A tetrahedron with one corner at the origin.
fn stl() -> Vec<u8> {
    let corners = [
        [0f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let mut bytes = vec![0; 80];
    bytes.extend(4u32.to_le_bytes());
    for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]] {
        bytes.extend([0; 12]);
        bytes.extend(
            face.iter()
                .flat_map(|k: &usize| corners[*k])
                .flat_map(f32::to_le_bytes),
        );
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn meshes_stand_below_the_scene_or_where_they_are_allowed() {
    let w = Workspace::new();
    std::fs::create_dir_all(w.path("in/parts")).unwrap();
    std::fs::create_dir_all(w.path("out")).unwrap();
    for place in ["in/a.stl", "in/parts/b.stl", "out/c.stl"] {
        w.write(place, stl());
    }
    let outside = w.path("out/c.stl").display().to_string();
    let mut cases = vec![
        ("a.stl", true, false),
        ("parts/../a.stl", true, false),
        ("./parts/b.stl", true, false),
        ("../out/c.stl", false, true),
        (outside.as_str(), false, true),
        ("../out/none.stl", false, false),
        ("/etc/hostname", false, false),
        ("/dev/zero", false, false),
        ("/no/such/file", false, false),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(w.path("out/c.stl"), w.path("in/link.stl")).unwrap();
        cases.push(("link.stl", false, true));
    }
    for (file, alone, allowed) in cases {
        w.write("in/s.toml", with_mesh(file));
        for (options, is_read) in [
            (&[][..], alone),
            (&["--allow-files", "out"][..], alone || allowed),
        ] {
            let run = w.run(&[&["check", "in/s.toml"], options].concat());
            assert_eq!(
                run.code,
                if is_read { 0 } else { 2 },
                "{file} {options:?}: {}",
                run.stderr
            );
            if !is_read {
                run.says(&["is not in or below the scene's folder"]);
            }
        }
    }
    // What is no regular file is not waited for.
    w.write("in/s.toml", with_mesh("parts"));
    w.run(&["check", "in/s.toml"])
        .exits(2)
        .says(&["not a regular file"]);
    w.write("in/s.toml", with_mesh("/dev/zero"));
    w.run(&["check", "in/s.toml", "--allow-files", "/dev"])
        .exits(2)
        .says(&["not a regular file"]);
}

/// A list of pictures names scenes as a scene names meshes: none elsewhere is read, nor shown in a message.
#[test]
fn scenes_of_a_list_stand_below_it_or_where_they_are_allowed() {
    let w = Workspace::new();
    for folder in ["golden/in", "out"] {
        std::fs::create_dir_all(w.path(folder)).unwrap();
    }
    for place in ["golden/a.toml", "golden/in/b.toml", "out/c.toml"] {
        w.write(place, moving());
    }
    w.write("out/secret.toml", "secret words of somebody");
    for (scene, options, code) in [
        ("a.toml", &[][..], 0),
        ("in/b.toml", &[], 0),
        ("../out/c.toml", &[], 2),
        ("../out/c.toml", &["--allow-files", "out"], 0),
        ("../out/secret.toml", &[], 2),
        ("/etc/passwd", &[], 2),
        ("/dev/zero", &[], 2),
        ("/dev/zero", &["--allow-files", "/dev"], 2),
        ("in/none.toml", &[], 2),
    ] {
        let _ = std::fs::remove_file(w.path("golden/a.png"));
        let list = format!(
            "[[picture]]\nfile = \"a.png\"\nscene = \"{scene}\"\ntime = 0.1\nsize = [32, 24]\n"
        );
        w.write("golden/snapshots.toml", list);
        let run = w.run(&[&["snapshot", "golden", "--update=new"], options].concat());
        assert_eq!(run.code, code, "{scene} {options:?}: {}", run.stderr);
        for words in ["secret words", "root:"] {
            assert!(!run.stderr.contains(words), "{scene}: {}", run.stderr);
        }
    }
}

/// Runs with limits, by option and by variable; both must refuse alike.
fn limited(w: &Workspace, limits: &str, arguments: &[&str]) -> Run {
    let by_option = w.run(&[arguments, &["--limits", limits]].concat());
    let by_variable = program::finish(
        w.command(arguments)
            .env("MECHANIM_LIMITS", limits)
            .spawn()
            .unwrap(),
    );
    assert_eq!(
        by_option.code, by_variable.code,
        "{limits}: {}\n{}",
        by_option.stderr, by_variable.stderr
    );
    by_option
}

#[test]
fn what_takes_more_than_it_may_is_refused_by_name() {
    let w = Workspace::new();
    w.write("s.toml", moving());
    w.write("m.stl", stl());
    w.write(
        "m.toml",
        with_mesh("m.stl")
            .replace("phi = 0.3", "phi = \"2*t\"")
            .replace("title", "duration = 1\ntitle"),
    );
    w.write("c.toml", hostile_scene());
    std::fs::create_dir(w.path("golden")).unwrap();
    let list =
        "[[picture]]\nfile = \"a.png\"\nscene = \"gearshift\"\ntime = 0.5\nsize = [32, 24]\n";
    w.write("golden/snapshots.toml", list);
    w.write("t.csv", format!("phi\n{}", "0.1\n".repeat(2000)));
    w.run(&[
        "render", "s.toml", "--at", "0", "--size", "64x64", "--out", "p.png",
    ])
    .exits(0);
    for (limits, arguments, who) in [
        (
            "samples=100",
            &["solve", "s.toml", "--samples", "5000", "--out", "-"][..],
            "a motion of 5000 samples",
        ),
        (
            "samples=100",
            &["check", "s.toml", "--samples", "5000"],
            "a motion of",
        ),
        (
            "samples=100",
            &["plot", "s.toml", "--out", "p.svg"],
            "a motion of 361 samples",
        ),
        (
            "samples=100",
            &["render", "s.toml", "--frames", "5000", "--out", "p.gif"],
            "a motion of 5000 samples",
        ),
        (
            "samples=1000",
            &["solve", "s.toml", "--inputs", "t.csv", "--out", "-"],
            "t.csv",
        ),
        ("triangles=3", &["check", "m.toml"], "the scene with m.stl"),
        ("pairs=2", &["check", "c.toml"], "[clearance] of 3 bodies"),
        (
            "pixels=1000",
            &["render", "s.toml", "--size", "64x64", "--out", "p.gif"],
            "a picture",
        ),
        ("pixels=1000", &["diff", "p.png", "p.png"], "p.png"),
        (
            "pixels=1000",
            &["plot", "s.toml", "--size", "64x64", "--out", "p.png"],
            "a plot",
        ),
        (
            "pixels=1000",
            &[
                "render", "s.toml", "--at", "0", "--size", "64x64", "--out", "p.png",
            ],
            "a picture",
        ),
        ("pixels=100", &["snapshot", "golden"], "a.png"),
        ("samples=10", &["snapshot", "golden"], "a motion of"),
        (
            "memory=1M",
            &["check", "s.toml", "--samples", "300"],
            "this run",
        ),
        (
            "time=1ms",
            &["check", "s.toml", "--samples", "100000"],
            "this run",
        ),
    ] {
        let name = limits.split('=').next().unwrap();
        let run = limited(&w, limits, arguments);
        let run = match name {
            // These are found out while the run goes on.
            "memory" => run.exits(2).says(&["the limit `memory` is 1 MiB"]),
            _ => run.exits(2).says(&[&format!("the limit `{name}` is"), who]),
        };
        run.says(&[&format!("--limits {name}=")]);
        assert!(
            w.files().iter().all(|file| !file.ends_with(".part")),
            "{arguments:?}"
        );
    }
    limited(&w, "time=60s,memory=4G,samples=1M", &["check", "s.toml"]).exits(0);
    w.run(&["check", "s.toml", "--limits", "sapmles=1"])
        .exits(2)
        .says(&["there is no limit `sapmles`"]);
    let mut both = w.command(&["check", "s.toml", "--limits", "samples=1G"]);
    program::finish(both.env("MECHANIM_LIMITS", "samples=10").spawn().unwrap())
        .exits(2)
        .says(&["is 10,"]);
}

#[test]
fn tables_of_spreadsheets_are_read() {
    let w = Workspace::new();
    w.write("s.toml", moving());
    let rows = |table: &str| {
        w.write("t.csv", table);
        let run = w
            .run(&["solve", "s.toml", "--inputs", "t.csv", "--out", "-"])
            .exits(0);
        let text = run.text();
        let cells = text
            .lines()
            .skip(1)
            .map(|l| l.split(',').take(2).map(str::to_owned).collect::<Vec<_>>());
        cells.collect::<Vec<_>>()
    };
    let plain = rows("phi\n0.25\n0.5\n");
    assert_eq!(plain, [["0", "0.25"], ["1", "0.5"]]);
    for table in [
        "\u{feff}phi\r\n0.25\r\n0.5\r\n",
        "\"phi\"\n\"0.25\"\n\"0.5\"\n",
        "# from the lab\nphi;note\n0,25;first\n0,5;\n",
        "note\tphi\na\t0.25\n\"b\"\t0.5\n",
        "sep=;\nphi;note\n0,25;x\n0,5;y\n",
        "time,phi\n0,0.25\n1,0.5\n",
    ] {
        assert_eq!(rows(table), plain, "{table:?}");
    }
    assert_eq!(
        rows("phi,t\n0.25,0.5\n0.5,0.75\n"),
        [["0.5", "0.25"], ["0.75", "0.5"]]
    );
    let run = w.run_with(
        &["solve", "s.toml", "--inputs", "-", "--out", "-"],
        b"phi\n0.25\n0.5\n",
    );
    assert_eq!(run.exits(0).text().lines().count(), 3);
    for (table, says) in [
        ("phi;phi\n1;2\n", "t.csv:1:5: there are two columns `phi`"),
        ("time,phi\n1,0\n1,0.1\n", "times start at 0 or later"),
        ("time,phi\n-1,0\n", "times start at 0 or later"),
        ("phi,x\n0,25,1\n", "decimal commas need `;`"),
        ("phi;x\n0,25;1\n0.5;1\n", "decimal separator"),
        ("phi\npi/2\n", "without formula"),
        ("phi\r0.25\r0.5\r", "carriage returns"),
    ] {
        w.write("t.csv", table);
        w.run(&["solve", "s.toml", "--inputs", "t.csv", "--out", "-"])
            .exits(2)
            .says(&["t.csv:", says]);
    }
    w.run_with(&["solve", "-", "--inputs", "-", "--out", "-"], b"")
        .exits(2)
        .says(&["not both"]);
    #[cfg(unix)]
    w.run(&["solve", "s.toml", "--inputs", "/dev/zero", "--out", "-"])
        .exits(2)
        .says(&["longer than"]);
}

/// An open file of the process is written where it is: a pipe, and a file behind what others have written into it.
#[cfg(target_os = "linux")]
#[test]
fn open_files_are_written_directly() {
    let w = Workspace::new();
    let program = env!("CARGO_BIN_EXE_mechanim");
    let words = "solve four-bar --samples 2 --format csv --out";
    for (what, lines) in [
        (format!("{program} {words} /dev/stdout | cat > o.csv"), 3),
        (
            format!("(echo head; {program} {words} /dev/stdout) > o.csv"),
            4,
        ),
        (format!("{program} {words} /dev/fd/7 7> o.csv"), 3),
        (
            format!("{program} {words} /dev/stderr 2>&1 | cat > o.csv"),
            3,
        ),
    ] {
        let mut shell = std::process::Command::new("sh");
        let ended = shell.args(["-c", &what]).current_dir(w.path("")).status();
        assert!(ended.unwrap().success(), "{what}");
        let text = String::from_utf8(w.read("o.csv")).unwrap();
        assert_eq!(text.lines().count(), lines, "{what}: {text}");
    }
}

/// Two names of one file that is not there yet are one target.
#[cfg(unix)]
#[test]
fn targets_behind_dangling_links_are_compared() {
    let w = Workspace::new();
    std::os::unix::fs::symlink("a.out", w.path("b.out")).unwrap();
    let check = ["check", "gearshift", "--json", "a.out", "--csv", "b.out"];
    w.run(&check).exits(2);
    assert!(!w.path("a.out").exists());
}

/// A folder of golden pictures may hold links: an update writes nothing behind them, whether something is there or not.
#[test]
fn golden_pictures_are_not_written_through_links() {
    let w = Workspace::new();
    let list = |name: &str| {
        format!("[[picture]]\nfile = \"{name}\"\nscene = \"s.toml\"\ntime = 0.1\nsize = [32, 24]\n")
    };
    std::fs::create_dir(w.path("golden")).unwrap();
    w.write("golden/s.toml", moving());
    w.write("golden/snapshots.toml", list("a.png") + &list("b.png"));
    w.write("precious", "old");
    for (link, to) in [("a.png", "../precious"), ("b.png", "../nothing")] {
        std::os::unix::fs::symlink(to, w.path("golden").join(link)).unwrap();
    }
    w.run(&["snapshot", "golden", "--update=all"]).exits(0);
    assert_eq!(w.read("precious"), b"old");
    assert!(!w.path("nothing").exists());
    for name in ["golden/a.png", "golden/b.png"] {
        assert!(!w.path(name).is_symlink(), "{name}");
        assert!(w.read(name).starts_with(b"\x89PNG"), "{name}");
    }
}
