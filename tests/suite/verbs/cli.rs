//! The command line as its users meet it: exit codes, what goes to which stream, and that nothing half-done stays.

use crate::program::{CHANGES, LEAVES, STILL, Workspace, finish, interrupt, moving};

/// Links of 50, 60 and 30 do not reach over 150: 10 are always missing.
const NEVER: &str = r#"units = { length = "mm" }
[inputs]
phi = 0
[loops]
frame = "Rz(phi) Tx(50) Rz(a) Tx(60) Rz(b) Tx(30) Rz(c) Tx(-150)"
"#;

const FREE: &str = r#"[inputs]
phi = "pi/2"
[loops]
A = "Rz(phi) Tx(2) Rz(a) Tx(3) Rz(b) Tx(3) Rz(c) Tx(2) Rz(d) Tx(-4)"
"#;

fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("still.toml", STILL);
    workspace.write("moving.toml", moving());
    workspace
}

#[test]
fn scenes_are_listed_and_printed_exactly() {
    let w = workspace();
    let list = w.run(&["scenes"]).exits(0).says_nothing().text();
    assert!(list.contains("slider-crank"), "{list}");
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/slider-crank.toml");
    let printed = w.run(&["scenes", "slider-crank"]).exits(0).says_nothing();
    assert_eq!(printed.stdout, std::fs::read(file).unwrap());
    let unknown = w.run(&["scenes", "slidercrank"]).exits(2).prints_nothing();
    unknown.says(&[
        "no built-in scene `slidercrank`",
        "did you mean `slider-crank`?",
    ]);
}

#[test]
fn an_unknown_scene_is_refused_with_the_nearest_name() {
    let w = workspace();
    for verb in [
        &["check", "slidrcrank"][..],
        &["solve", "slidrcrank", "--out", "-"],
    ] {
        let run = w.run(verb).exits(2).prints_nothing();
        run.says(&[
            "there is no scene `slidrcrank`",
            "did you mean `slider-crank`?",
        ]);
    }
    let run = w.run(&["check", "none/at/all.toml"]).exits(2);
    run.says(&["cannot read none/at/all.toml"]);
}

#[test]
fn info_is_readable_by_people_and_machines() {
    let w = workspace();
    assert!(
        w.run(&["info"])
            .exits(0)
            .text()
            .contains(env!("CARGO_PKG_VERSION"))
    );
    let json = w.run(&["info", "--json", "-"]).exits(0).text();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["version"], env!("CARGO_PKG_VERSION"));
    assert!(json["adapters"].is_array());
}

#[test]
fn every_shell_gets_its_completions() {
    let w = workspace();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = w
            .run(&["completions", shell])
            .exits(0)
            .says_nothing()
            .text();
        assert!(
            script.contains("mechanim") && script.contains("solve"),
            "{shell}"
        );
    }
    w.run(&["completions", "csh"]).exits(2).prints_nothing();
}

#[test]
fn help_and_version_are_no_errors_and_bad_usage_is() {
    let w = workspace();
    let help = w.run(&["--help"]).exits(0).says_nothing().text();
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        help.contains("Exit codes: 0 done; 1 a check failed or could not prove")
            && help.contains("4 the motion does not reach its end"),
        "{help}"
    );
    w.run(&["--version"]).exits(0).says_nothing();
    for wrong in [
        &["rendr"][..],
        &[],
        &["solve"],
        &["solve", "still.toml"],
        &["check", "--no"],
    ] {
        w.run(wrong).exits(2).prints_nothing();
    }
}

#[test]
fn tables_are_written_where_asked_and_nothing_else_is() {
    let w = workspace();
    w.run(&["solve", "moving.toml", "--out", "a.csv"])
        .exits(0)
        .prints_nothing();
    w.run(&["solve", "moving.toml", "--out", "a.json"])
        .exits(0)
        .prints_nothing();
    let csv = String::from_utf8(w.read("a.csv")).unwrap();
    assert!(csv.starts_with("time,phi,alpha,beta,h,"), "{csv}");
    assert_eq!(csv.lines().count(), 1 + 5);
    let json: serde_json::Value = serde_json::from_slice(&w.read("a.json")).unwrap();
    assert_eq!(json["samples"].as_array().unwrap().len(), 5);
    let streamed = w
        .run(&["solve", "moving.toml", "--out", "-"])
        .exits(0)
        .says_nothing();
    assert_eq!(streamed.text(), csv);
    let piped = w
        .run_with(&["solve", "-", "--out", "-"], moving().as_bytes())
        .exits(0);
    assert_eq!(piped.text(), csv);
    assert_eq!(w.files(), ["a.csv", "a.json", "moving.toml", "still.toml"]);
}

#[test]
fn checks_answer_in_text_in_json_and_by_the_exit_code() {
    let w = workspace();
    let text = w
        .run(&["check", "moving.toml"])
        .exits(0)
        .says_nothing()
        .text();
    assert!(text.contains("passed"), "{text}");
    let json = w
        .run(&["check", "moving.toml", "--json", "-"])
        .exits(0)
        .text();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["result"], "passed");
    w.run(&["check", "moving.toml", "--closure", "1e-30"])
        .exits(1);
    let pose = "alpha=2.8837,beta=-0.2421,h=42.5642";
    let run = w.run(&[
        "check",
        "slider-crank",
        "--input",
        "phi=0.5",
        "--pose",
        pose,
    ]);
    assert!(run.exits(1).text().contains("half-turn"));
    let run = w
        .run(&["check", "still.toml", "--pose", "alpha=1,gamma=2"])
        .exits(2);
    run.prints_nothing().says(&["no unknown `gamma`"]);
    w.run(&["check", "still.toml", "--pose", "alpha=1"])
        .exits(2)
        .says(&["lacks beta, h"]);
}

#[test]
fn pictures_have_the_size_and_number_asked_for() {
    let w = workspace();
    let size = ["--size", "64x48", "--renderer", "cpu"];
    let draw = |out: &str, more: &[&str]| {
        let run = [&["render", "moving.toml", "--out", out], &size[..], more].concat();
        w.run(&run).exits(0).prints_nothing()
    };
    draw("a.png", &["--at", "0.25"]).says(&["a.png: 1 frame of 64x48"]);
    let still = image::open(w.path("a.png")).unwrap();
    assert_eq!((still.width(), still.height()), (64, 48));
    draw("f-%02d.png", &["--frames", "3"]);
    for k in 0..3 {
        assert!(w.path(&format!("f-0{k}.png")).exists());
    }
    assert!(!w.path("f-03.png").exists());
    draw("a.gif", &["--frames", "3"]);
    let file = std::fs::File::open(w.path("a.gif")).unwrap();
    let mut gif = gif::DecodeOptions::new().read_info(file).unwrap();
    assert_eq!((gif.width(), gif.height()), (64, 48));
    let mut frames = 0;
    while gif.read_next_frame().unwrap().is_some() {
        frames += 1;
    }
    assert_eq!(frames, 3);
    let run = [
        &["render", "moving.toml", "--out", "-", "--frames", "3"],
        &size[..],
    ]
    .concat();
    let streamed = w.run(&run).exits(0).says_nothing();
    assert_eq!(streamed.stdout, w.read("a.gif"));
}

#[test]
fn overrides_with_mistakes_are_refused_by_name() {
    let w = workspace();
    w.write(
        "p.toml",
        STILL.replace("[inputs]", "[parameters]\nlength = 1\n[inputs]"),
    );
    for (arguments, says) in [
        (
            &["--param", "lenght=2"][..],
            ["no parameter or chain `lenght`", "did you mean `length`?"],
        ),
        (
            &["--input", "fhi=2"],
            ["no input `fhi`", "did you mean `phi`?"],
        ),
        (
            &["--param", "length=2", "--param", "length=3"],
            ["`length` is replaced twice", "by `2` and by `3`"],
        ),
        (
            &["--guess", "aplha=2"],
            ["`aplha`", "did you mean `alpha`?"],
        ),
        (
            &["--param", "length=2*"],
            ["which is not from the file", "found the end"],
        ),
        (
            &["--param", "length=1/0"],
            ["this formula has no value", "finite"],
        ),
        (&["--param", "length"], ["NAME=VALUE", "--param"]),
        (&["--input", "phi=nan"], ["not a finite number", "nan"]),
    ] {
        let run = [&["check", "p.toml"], arguments].concat();
        w.run(&run).exits(2).prints_nothing().says(&says);
    }
    w.run(&[
        "check", "p.toml", "--param", "length=2", "--input", "phi=0.2",
    ])
    .exits(0);
}

#[test]
fn tables_of_inputs_with_mistakes_are_refused_with_the_line() {
    let w = workspace();
    for (table, says) in [
        ("", ["in.csv is empty", "names the columns"]),
        ("time,Phi\n0,1\n", ["no column for the input `phi`", "Phi"]),
        (
            "phi\n0.1\n\n0.2\nx\n",
            ["in.csv:5:1: `x` is not a value for `phi`", "a number"],
        ),
        ("phi\nnan\n", ["in.csv:2:1:", "`nan` is not a value"]),
        (
            "a,phi\n1\n",
            [
                "in.csv:2:2: 1 cell where the header has 2",
                "decimal commas",
            ],
        ),
        (
            "phi,\n0.1,2\n",
            [
                "in.csv:2:5: 2 cells where the header has 1",
                "decimal commas",
            ],
        ),
        ("phi\n", ["in.csv", "no rows"]),
    ] {
        w.write("in.csv", table);
        let run = w.run(&["solve", "still.toml", "--inputs", "in.csv", "--out", "-"]);
        run.exits(2).prints_nothing().says(&says);
    }
    w.write("in.csv", "a,phi\n9,0.1\n9,0.2\n9,0.3\n");
    let run = w.run(&["solve", "still.toml", "--inputs", "in.csv", "--out", "-"]);
    assert_eq!(run.exits(0).text().lines().count(), 4);
}

#[test]
fn numbers_out_of_range_are_refused_with_the_range() {
    let w = workspace();
    for (arguments, says) in [
        (["--at", "7"], "0.5"),
        (["--at", "-1"], "outside"),
        (["--at", "nan"], "outside"),
        (["--frame", "99"], "frames 0 to 4, 99 is outside"),
        (["--frames", "0"], "between 1 and 1000000"),
        (["--frames", "1000000000"], "between 1 and 1000000"),
        (["--frames", "1e9"], "between 1 and 1000000"),
        (["--fps", "0"], "between 0.01 and 1000"),
        (["--fps", "nan"], "between 0.01 and 1000"),
        (["--supersample", "3"], "1, 2, 4, 8 or 16"),
        (["--threads", "0"], "between 1 and 256"),
        (["--quality", "0"], "between 1 and 100"),
        (["--quality", "101"], "between 1 and 100"),
        (["--size", "0x10"], "at least one pixel"),
        (["--size", "640"], "640x480"),
        (["--size", "100000x100000"], "at most 15360 pixels a side"),
        (["--size", "15360x15360"], "64 million in all"),
        (["--size", "4294967296x1"], "WIDTHxHEIGHT"),
        (["--renderer", "magic"], "possible values: auto, gpu, cpu"),
    ] {
        let run = [&["render", "moving.toml", "--out", "x.gif"], &arguments[..]].concat();
        w.run(&run).exits(2).prints_nothing().says(&[says]);
    }
    assert_eq!(w.files(), ["moving.toml", "still.toml"]);
}

/// Under 600 MB of addresses a picture of 1e10 pixels can only be refused without being made.
#[test]
#[cfg(target_os = "linux")]
fn a_huge_picture_is_refused_without_memory() {
    let w = workspace();
    let mut shell = w.command::<&str>(&[]);
    let program = shell.get_program().to_owned();
    for size in ["100000x100000", "15360x15360"] {
        let line = "ulimit -v 600000; exec \"$0\" render moving.toml --out x.gif --size \"$1\"";
        let mut command = std::process::Command::new("sh");
        command.args(["-c", line]).arg(&program).arg(size);
        command
            .current_dir(w.path(""))
            .stderr(std::process::Stdio::piped());
        finish(command.spawn().unwrap())
            .exits(2)
            .says(&["15360 pixels a side"]);
    }
    shell.arg("--version").status().unwrap();
}

#[test]
fn places_that_cannot_be_written_are_named_and_left_alone() {
    let w = workspace();
    std::fs::create_dir(w.path("folder")).unwrap();
    let draw = |out: &str| w.run(&["render", "moving.toml", "--size", "64x48", "--out", out]);
    draw("none/x.gif")
        .exits(2)
        .says(&["none/x.gif", "the folder none does not exist"]);
    draw("x.avi")
        .exits(2)
        .says(&["x.avi", "unknown extension .avi", ".gif, .png"]);
    draw("x").exits(2).says(&["no extension"]);
    w.run(&["solve", "moving.toml", "--out", "x.xls"])
        .exits(2)
        .says(&[".csv and .json"]);
    w.run(&["solve", "moving.toml", "--out", "none/x.csv"])
        .exits(2)
        .says(&["the folder none"]);
    let run = w.run(&["solve", "moving.toml", "--format", "csv", "--out", "folder"]);
    run.exits(2).says(&["folder", "it is a folder"]);
    let run = w
        .run(&["check", "moving.toml", "--json", "none/x.json"])
        .exits(2);
    run.says(&["the folder none does not exist"]);
    assert_eq!(w.files(), ["folder", "moving.toml", "still.toml"]);
}

#[test]
fn the_scene_itself_is_never_written_over() {
    let w = workspace();
    std::fs::copy(w.path("moving.toml"), w.path("scene.csv")).unwrap();
    std::fs::copy(w.path("moving.toml"), w.path("scene.gif")).unwrap();
    for arguments in [
        ["solve", "scene.csv", "--out", "./scene.csv"],
        ["render", "scene.gif", "--out", "scene.gif"],
        ["check", "moving.toml", "--json", "moving.toml"],
    ] {
        w.run(&arguments)
            .exits(2)
            .says(&["is an input of this command"]);
    }
    for file in ["scene.csv", "scene.gif", "moving.toml"] {
        assert_eq!(w.read(file), moving().as_bytes(), "{file}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_folder_without_the_right_to_write_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let w = workspace();
    std::fs::create_dir(w.path("shut")).unwrap();
    std::fs::set_permissions(w.path("shut"), PermissionsExt::from_mode(0o555)).unwrap();
    // The administrator may write there all the same, but not even he makes files in `/proc`.
    let is_admin = std::fs::write(w.path("shut/probe"), "").is_ok();
    for folder in ["shut", "/proc"].into_iter().skip(usize::from(is_admin)) {
        let place = format!("{folder}/x.csv");
        let run = w.run(&["solve", "moving.toml", "--out", &place]).exits(2);
        run.prints_nothing()
            .says(&[&format!("cannot write {place}")]);
    }
}

#[test]
fn a_gif_too_fast_for_viewers_is_written_slower_and_said() {
    let w = workspace();
    let gif = [
        "render",
        "moving.toml",
        "--size",
        "64x48",
        "--out",
        "x.gif",
        "--fps",
    ];
    w.run(&[&gif[..], &["60"]].concat())
        .exits(0)
        .says(&["at most 50 frames a second"]);
    let slow = w.run(&[&gif[..], &["50"]].concat()).exits(0);
    assert!(!slow.stderr.contains("at most 50"), "{}", slow.stderr);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_said() {
    let w = workspace();
    std::os::unix::fs::symlink("/dev/full", w.path("x.csv")).unwrap();
    std::os::unix::fs::symlink("/dev/full", w.path("x.gif")).unwrap();
    let run = w.run(&["solve", "moving.toml", "--out", "x.csv"]).exits(2);
    run.says(&["writing x.csv failed", "No space left"]);
    let run = w
        .run(&["render", "moving.toml", "--size", "64x48", "--out", "x.gif"])
        .exits(2);
    run.says(&["writing x.gif failed", "No space left"]);
    let full = std::fs::File::create("/dev/full").unwrap();
    let mut command = w.command(&["check", "moving.toml"]);
    let run = finish(command.stdout(full).spawn().unwrap()).exits(2);
    run.says(&["standard output", "No space left"]);
}

#[test]
fn a_reader_that_goes_away_ends_the_run_in_silence() {
    let w = workspace();
    for arguments in [
        &["scenes"][..],
        &["scenes", "gearshift"],
        &["completions", "bash"],
        &["check", "moving.toml"],
        &["solve", "moving.toml", "--out", "-", "--samples", "2000"],
        &["render", "moving.toml", "--out", "-", "--size", "64x48"],
    ] {
        let mut child = w.command(arguments).spawn().unwrap();
        drop(child.stdout.take());
        finish(child).exits(0).says_nothing();
    }
}

#[test]
#[cfg(unix)]
fn ctrl_c_leaves_nothing_behind() {
    let w = workspace();
    for out in ["x.gif", "f-%04d.png"] {
        let long = [
            "--frames",
            "5000",
            "--size",
            "640x480",
            "--progress",
            "plain",
        ];
        let run = [
            &["render", "moving.toml", "--renderer", "cpu", "--out", out],
            &long[..],
        ]
        .concat();
        let child = w.command(&run).spawn().unwrap();
        // Wait until the temporary file is there: the run is in its middle then.
        while w.files().len() < 3 {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        interrupt(&child);
        finish(child).exits(130).says(&["interrupted"]);
        assert_eq!(w.files(), ["moving.toml", "still.toml"], "{out}");
    }
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_a_solve_in_its_middle() {
    let w = workspace();
    // Few samples, and as many turns between them as are followed.
    w.write("long.toml", moving().replace("2*t", "1e6*t"));
    for (scene, samples) in [("moving.toml", "1000000"), ("long.toml", "3")] {
        let run = ["solve", scene, "--samples", samples, "--out", "x.csv"];
        let child = w.command(&run).spawn().unwrap();
        while w.files().len() < 4 {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        std::thread::sleep(std::time::Duration::from_millis(300));
        interrupt(&child);
        finish(child).exits(130).says(&["interrupted"]);
        assert_eq!(w.files(), ["long.toml", "moving.toml", "still.toml"]);
    }
}

/// A step in a formula, and a start whose angles are too large: poses may exist where none is found.
#[test]
fn a_motion_that_is_given_up_is_neither_done_nor_impossible() {
    let w = workspace();
    let step = "duration = 4\n[inputs]\nphi = \"t\"\n[equations]\ne = \"x - floor(phi)\"\n";
    w.write("step.toml", step);
    let large = "units = { length = \"mm\" }\n[inputs]\nphi = 0.3\n[loops]\n\
                 A = \"Rz(phi) Tx(40) Rz(1.7*alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 120\nalpha = 3e13\n";
    w.write("large.toml", large);
    for (scene, words) in [
        ("step.toml", ["broken between", "a formula of `e` jumps"]),
        ("large.toml", ["undecided", "too large"]),
    ] {
        for verb in [
            vec!["solve", scene, "--out", "x.json"],
            vec!["check", scene],
        ] {
            w.run(&verb).exits(1).says(&words);
        }
    }
}

/// A zero of higher order at which an input passes zero, at every count of samples.
#[test]
fn solve_and_check_end_where_an_input_passes_zero() {
    let w = workspace();
    let zero = "duration = 4\n[inputs]\nphi = \"t - 2\"\n[equations]\ne = \"x*abs(x) - phi\"\n[guess]\nx = -1.4\n";
    w.write("zero.toml", zero);
    for samples in 3..=11 {
        let samples = samples.to_string();
        w.run(&[
            "solve",
            "zero.toml",
            "--samples",
            &samples,
            "--out",
            "x.csv",
        ])
        .exits(0);
        // The pose at zero is singular, and has no certificate.
        let check = [
            "check",
            "zero.toml",
            "--samples",
            &samples,
            "--certify",
            "none",
        ];
        w.run(&check).exits(0);
    }
}

#[test]
fn a_motion_that_leaves_its_range_is_written_as_far_as_it_goes() {
    let w = workspace();
    w.write("leaves.toml", LEAVES);
    let run = w
        .run(&["solve", "leaves.toml", "--out", "x.csv"])
        .exits(4)
        .prints_nothing();
    run.says(&[
        "the motion has no pose beyond",
        "it ends at a fold (proved)",
        "phi = 0.848062",
        "samples have no pose",
    ]);
    let csv = String::from_utf8(w.read("x.csv")).unwrap().to_lowercase();
    let rows: Vec<&str> = csv.lines().skip(1).collect();
    for row in &rows {
        let phi: f64 = row.split(',').nth(1).unwrap().parse().unwrap();
        let status = if phi.sin() <= 0.75 { ",ok" } else { ",no-pose" };
        assert!(row.ends_with(status), "{row}");
        assert!(!row.contains("nan") && !row.contains("inf"), "{row}");
    }
    assert!(rows.iter().any(|row| row.ends_with("no-pose")));
    let draw = [
        "render",
        "leaves.toml",
        "--size",
        "64x48",
        "--frames",
        "4",
        "--out",
        "x.gif",
    ];
    w.run(&draw).exits(4).says(&["no pose"]);
    assert!(w.path("x.gif").exists());
    let json = w
        .run(&["solve", "leaves.toml", "--out", "-", "--format", "json"])
        .exits(4)
        .text();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let event = &json["events"][0];
    assert_eq!(event["kind"], "motion-ends");
    let phi = event["inputs"]["phi"].as_f64().unwrap();
    assert!((phi - 0.75f64.asin()).abs() < 1e-6, "{phi}");
    w.run(&["check", "leaves.toml"]).exits(4);
}

#[test]
fn a_loop_that_never_closes_is_named_with_its_gap() {
    let w = workspace();
    w.write("never.toml", NEVER);
    for arguments in [
        &["check", "never.toml"][..],
        &["solve", "never.toml", "--out", "x.csv"],
        &["render", "never.toml", "--out", "x.gif"],
    ] {
        let run = w.run(arguments).exits(4).prints_nothing();
        run.says(&["loop `frame` does not close", "leaves 10.000", "phi = 0"]);
    }
    assert_eq!(w.files(), ["moving.toml", "never.toml", "still.toml"]);
}

#[test]
fn a_mechanism_with_a_freedom_too_many_names_it() {
    let w = workspace();
    w.write("free.toml", FREE);
    let run = w
        .run(&["solve", "free.toml", "--out", "x.csv"])
        .exits(2)
        .prints_nothing();
    run.says(&["free", "a, b, c, d", "hint"]);
    assert!(!w.path("x.csv").exists());
}

/// No driver can be found through these: the same as on a machine without graphics.
#[test]
#[cfg(all(target_os = "linux", feature = "gpu"))]
fn without_an_adapter_gpu_says_so_and_auto_draws_all_the_same() {
    let w = workspace();
    let run = |renderer: &str| {
        let size = ["--size", "64x48", "--at", "0", "--renderer", renderer];
        let draw = [&["render", "moving.toml", "--out", "x.png"], &size[..]].concat();
        let mut command = w.command(&draw);
        for name in [
            "VK_ICD_FILENAMES",
            "VK_DRIVER_FILES",
            "__EGL_VENDOR_LIBRARY_FILENAMES",
            "LIBGL_DRIVERS_PATH",
            "GBM_BACKENDS_PATH",
        ] {
            command.env(name, "/nonexistent");
        }
        finish(command.spawn().unwrap())
    };
    let refused = run("gpu").exits(3).prints_nothing();
    refused.says(&["no usable graphics adapter", "--renderer cpu"]);
    assert!(!w.path("x.png").exists());
    run("auto").exits(0);
    assert!(w.path("x.png").exists());
}

#[test]
fn colour_quiet_and_progress_do_as_they_are_told() {
    let w = workspace();
    let escape = "\x1b[";
    let plain = w.run(&["check", "none.toml"]).exits(2);
    assert!(!plain.stderr.contains(escape));
    w.run(&["check", "none.toml", "--colour", "always"])
        .exits(2)
        .says(&[escape]);
    let mut command = w.command(&["check", "none.toml"]);
    let run = finish(command.env("NO_COLOR", "1").spawn().unwrap()).exits(2);
    assert!(!run.stderr.contains(escape));
    let draw = ["render", "moving.toml", "--size", "64x48", "--out", "x.gif"];
    w.run(&[&draw[..], &["--quiet"]].concat())
        .exits(0)
        .says_nothing();
    let run = w
        .run(&[&draw[..], &["--progress", "plain"]].concat())
        .exits(0);
    assert!(!run.stderr.contains('\r'));
    run.says(&["5/5 frames"]);
    w.run(&["check", "none.toml", "--quiet"])
        .exits(2)
        .says(&["none.toml"]);
}

/// Reports are said, and quiet says nothing; files and what is asked for on standard output are written all the same.
#[test]
fn quiet_verbs_print_no_report() {
    let w = workspace();
    for verb in [
        &["check", "moving.toml"][..],
        &["modes", "still.toml"],
        &["sensitivity", "gearshift"],
        &[
            "tolerance",
            "gearshift",
            "--tolerance",
            "0.5",
            "--pieces",
            "10",
        ],
    ] {
        let loud = w.run(verb);
        assert!(!loud.stdout.is_empty(), "{verb:?}");
        let quiet = w.run(&[verb, &["-q"]].concat()).exits(loud.code);
        quiet.prints_nothing().says_nothing();
    }
    let json = w
        .run(&["modes", "still.toml", "-q", "--json", "-"])
        .exits(0);
    assert!(json.text().contains("mechanim-modes/1"));
    let streams = [
        &["--json", "-"][..],
        &["--junit", "-"],
        &["--certify", "none", "--junit", "-"],
    ];
    for stream in streams {
        let text = w.run(&[&["check", "moving.toml"], stream].concat()).text();
        assert!(!text.contains("  result  "), "{stream:?}: {text}");
    }
}

/// Columns of numbers hold numbers: what does not exist is an empty cell and null, and units are named.
#[test]
fn tables_hold_numbers_or_nothing() {
    let w = workspace();
    let outputs = "[outputs]\nnone = \"phi/phi\"\nfar = \"1/phi\"\n";
    let still = STILL.replace("phi = 0.3", "phi = 0");
    w.write(
        "none.toml",
        still.replace("[[bodies]]", &format!("{outputs}[[bodies]]")),
    );
    // Nothing is solved: neither a singular value nor a radius.
    w.write(
        "arm.toml",
        "[inputs]\nq = 0.3\n[[bodies]]\nname = \"a\"\nframe = \"Rz(q)\"\n",
    );
    for (scene, empty) in [
        ("none.toml", &["none", "far"][..]),
        ("arm.toml", &["sigma_min", "unique_radius"]),
    ] {
        let solve = |format: &str| {
            let run = w.run(&["solve", scene, "--out", "-", "--format", format]);
            run.exits(0).text()
        };
        let csv = solve("csv");
        let rows: Vec<Vec<&str>> = csv.lines().map(|l| l.split(',').collect()).collect();
        let json: serde_json::Value = serde_json::from_str(&solve("json")).unwrap();
        for (name, cell) in rows[0].iter().zip(&rows[1]) {
            assert!(
                !cell.contains("inf") && !cell.contains("NaN"),
                "{name}: {cell}"
            );
            assert_ne!(json["samples"][0][name], "inf", "{name}");
        }
        for name in empty {
            assert!(json["samples"][0][name].is_null(), "{name}");
        }
    }
    let rates = [
        "solve",
        "four-bar",
        "--samples",
        "2",
        "--order",
        "2",
        "--out",
        "-",
        "--format",
        "json",
    ];
    let units = |more: &[&str]| -> serde_json::Value {
        let text = w.run(&[&rates[..], more].concat()).exits(0).text();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["column_units"].clone()
    };
    let by_angle = units(&["--per", "phi"]);
    assert_eq!(by_angle["d2(psi)/d(phi)2"], "deg/deg^2");
    assert_eq!(by_angle["d2(K.x)/d(phi)2"], "mm/deg^2");
    let by_time = units(&[]);
    assert_eq!(
        (&by_time["d(psi)/dt"], &by_time["d2(K.x)/dt2"]),
        (&"deg/s".into(), &"mm/s^2".into())
    );
    assert_eq!(
        (&by_time["time"], &by_time["phi"]),
        (&"s".into(), &"deg".into())
    );
    assert!(by_time["sigma_min"].is_null());
    w.run(&[&rates[..], &["--per", "phi"]].concat())
        .says(&["per deg^n"]);
}

/// A column of rates is empty only if that is said, and the outputs named are those with empty columns.
#[test]
fn outputs_without_rates_are_named() {
    let w = Workspace::new();
    w.write(
        "scene.toml",
        "units = { length = \"mm\", angle = \"rad\" }\nduration = 1\n[inputs]\nu = \"0.3 + t\"\n[outputs]\na = \"u^3\"\n\
         b = \"d(a, u)\"\nc = \"a + 2*b\"\ne = { distance = [\"A\", \"B\"] }\nf = \"e + a\"\ng = \"d(a, t)\"\n\
         [[bodies]]\nname = \"A\"\nframe = \"Tx(5 + u)\"\nshapes = [{ sphere = { radius = 1 } }]\n\
         [[bodies]]\nname = \"B\"\nshapes = [{ sphere = { radius = 1 } }]\n",
    );
    for (order, first, second) in [
        ("1", "rates of `b`, `c`, `g` stay empty", ""),
        (
            "2",
            "rates of `b`, `c`, `g` stay empty",
            "second and higher rates of `e`, `f` stay empty",
        ),
    ] {
        let run = w.run(&[
            "solve",
            "scene.toml",
            "--samples",
            "2",
            "--order",
            order,
            "--out",
            "-",
        ]);
        let run = run.exits(0).says(&[first, second]);
        assert_eq!(
            run.stderr.contains("second"),
            !second.is_empty(),
            "{}",
            run.stderr
        );
        let table = run.text();
        let mut rows = table
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let (names, cells) = (rows.next().unwrap(), rows.next().unwrap());
        for (name, cell) in names
            .iter()
            .zip(&cells)
            .filter(|(name, _)| name.starts_with('d'))
        {
            let output = name.split(['(', ')']).nth(1).unwrap();
            let is_second = name.starts_with("d2");
            let is_told = "bcg".contains(output) || is_second && "ef".contains(output);
            assert_eq!(cell.is_empty(), is_told, "{name}: {cell}");
        }
    }
    let asked = "solve four-bar --samples 2 --order 2 --out -";
    let run = w.run(&asked.split(' ').collect::<Vec<_>>()).exits(0);
    assert!(!run.stderr.contains("empty"), "{}", run.stderr);
}

#[test]
fn iterates_are_traced_as_a_table_and_as_polygons() {
    let workspace = Workspace::new();
    let feeder = [
        "solve",
        "feeder",
        "--input",
        "psi12=60deg",
        "--trace-iterations",
        "--out",
    ];
    let table = workspace
        .run(&[&feeder[..], &["-"]].concat())
        .exits(0)
        .text();
    let lines: Vec<&str> = table.lines().collect();
    assert!(
        lines[0].starts_with("block,iteration,psi13,p14,correction(psi13),correction(p14),A.gap.x")
    );
    assert!(lines[1].starts_with("0,0,-0.6,200,"), "{}", lines[1]);
    workspace.run(&[&feeder[..], &["i.json"]].concat()).exits(0);
    let text = std::fs::read_to_string(workspace.path("i.json")).unwrap();
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["closed"], true);
    assert_eq!(
        document["iterates"][0]["polygons"]["A"]
            .as_array()
            .unwrap()
            .len(),
        5
    );
    // A start from which plain Newton cannot close says so.
    let far = [
        "solve",
        "slider-crank",
        "--param",
        "L=30",
        "--input",
        "phi=1.5",
        "--trace-iterations",
        "--out",
        "-",
    ];
    workspace.run(&far).exits(1);
}

#[test]
fn measures_are_printed_and_their_limits_enforced() {
    let workspace = Workspace::new();
    let optimised = workspace
        .run(&["check", "gearshift-optimised"])
        .exits(0)
        .text();
    let line = optimised
        .lines()
        .find(|l| l.trim_start().starts_with("F "))
        .unwrap();
    assert_eq!(line.split_whitespace().nth(1), Some("0.00006509978899"));
    let longer = [
        "check",
        "rope-drum",
        "--input",
        "x=R+6*v*t",
        "--json",
        "r.json",
    ];
    let run = workspace.run(&longer).exits(1);
    assert!(
        run.text()
            .contains("is below the limit 0: the rope is shorter than its tangent")
    );
    let text = std::fs::read_to_string(workspace.path("r.json")).unwrap();
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["measures"][0]["holds"], false);
    assert_eq!(document["measures"][0]["min"], 0.0);
}

#[test]
fn motion_is_proved_on_request() {
    let w = workspace();
    w.write("changes.toml", CHANGES);
    let check = |scene: &str, code: i32, more: &[&str]| {
        let run = [
            &["check", scene, "--samples", "45", "--certify", "motion"],
            more,
        ]
        .concat();
        w.run(&run).exits(code).text()
    };
    let text = check("dyads", 0, &[]);
    assert!(
        text.contains("45 of 45 intervals certified in 45 tubes"),
        "{text}"
    );
    assert!(text.contains("assumed"), "{text}");
    let text = check("changes.toml", 1, &[]);
    assert!(text.contains("refused first after t = 0.5"), "{text}");
    assert!(text.contains("near-singular"), "{text}");
    let json = check("changes.toml", 1, &["--json", "-"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["motion"]["intervals"], 44);
    assert_eq!(json["motion"]["certified"], 42);
    let refused = json["motion"]["refused"].as_array().unwrap();
    assert_eq!(refused[0]["after_sample"], 21);
    assert_eq!(refused[0]["because"], "near-singular");

    let solve = |out: &str, certify: &str, scene: &str| {
        let run = [
            "solve",
            scene,
            "--samples",
            "5",
            "--certify",
            certify,
            "--out",
            out,
        ];
        // What was asked to be proved, and is not, is no success.
        w.run(&run).exits(i32::from(scene == "changes.toml"))
    };
    let csv = solve("-", "motion", "dyads").says_nothing().text();
    let cell = |line: usize, name: &str| {
        let column = csv
            .lines()
            .next()
            .unwrap()
            .split(',')
            .position(|c| c == name);
        let row = csv.lines().nth(line).unwrap();
        row.split(',').nth(column.unwrap()).unwrap().to_owned()
    };
    // The drive is a whole turn: the last interval leads to its end.
    for line in 1..=5 {
        assert_eq!(cell(line, "motion_status"), "certified");
        assert!(cell(line, "motion_tubes").parse::<usize>().unwrap() > 1);
        assert!(cell(line, "motion_radius").parse::<f64>().unwrap() < 1.0);
    }
    solve("a.json", "motion", "changes.toml").says(&["motion: 2 of 4 intervals certified"]);
    let json: serde_json::Value = serde_json::from_slice(&w.read("a.json")).unwrap();
    assert_eq!(json["samples"][1]["motion_status"], "near-singular");
    assert_eq!(json["samples"][3]["motion_status"], "certified");
    assert!(json["samples"][4]["motion_status"].is_null());

    let bare = solve("-", "none", "dyads").says_nothing().text();
    assert!(
        !bare.contains("motion_status"),
        "only where it was asked for"
    );
    let text = w
        .run(&["check", "dyads", "--certify", "none"])
        .exits(0)
        .text();
    assert!(text.contains("not requested"), "{text}");
    w.run(&[
        "solve",
        "dyads",
        "--at",
        "1",
        "--certify",
        "motion",
        "--out",
        "-",
    ])
    .exits(2)
    .says(&["no motion to certify"]);
}

/// A column that may have been meant as the time is not ignored in silence.
#[test]
fn tables_without_a_time_say_what_they_ignore() {
    let w = Workspace::new();
    w.write(
        "crank.toml",
        "duration = 1\n[inputs]\nphi = \"t\"\n[loops]\nA = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 100\n",
    );
    let rows = [
        ("phi\n0\n1\n", ""),
        ("time,phi\n0,0\n9,1\n", ""),
        ("time;note;phi\n0;1;0\n9;2;1\n", ""),
        (
            "zeit,phi\n0,0\n9,1\n",
            "no column `time`: row k is at k seconds, column `zeit` is ignored",
        ),
        (
            "zeit;phi;h\n0;0;1\n9;1;1\n",
            "columns `zeit`, `h` are ignored",
        ),
        // Spreadsheets write an empty last column.
        ("phi,\n0,\n1,\n", ""),
        ("phi\n0,\n1,\n", ""),
        ("phi,\n0\n1\n", ""),
        ("time [s],phi\n0,0\n9,1\n", ""),
        ("zeit,phi,t\n0,0,0\n9,1,1\n", ""),
    ];
    for (table, told) in rows {
        w.write("t.csv", table);
        for verb in [&["solve", "--out", "s.csv"][..], &["check"]] {
            let args = [verb, &["crank.toml", "--input-table", "t.csv"]].concat();
            let run = w.run(&args).exits(0);
            let is_told = run.stderr.contains("ignored");
            assert_eq!(is_told, !told.is_empty(), "{args:?} {table}");
            assert!(run.stderr.contains(told), "{args:?} {table}");
        }
    }
}

/// The share of a motion is one of time, however close together samples, keys and rows of a table stand.
#[test]
fn positive_shares_are_those_of_time() {
    let w = Workspace::new();
    let scene = |drive: &str| {
        format!(
            "duration = 10\n[inputs]\nu = {drive}\n[outputs]\nv = \"u\"\n[measures]\nshare = {{ of = \"v\", take = \"positive\" }}\n"
        )
    };
    let keys = "{ keys = [[0, 1], [0.01, 1], [0.02, 1], [0.03, 1], [0.04, 1], [0.05, 1], [1, 1], [3, -1], [10, -1]] }";
    w.write("keys.toml", scene(keys));
    w.write("table.toml", scene("\"t\""));
    w.write(
        "t.csv",
        "time,u\n0,1\n0.1,1\n0.2,1\n0.3,1\n0.4,1\n1,1\n3,-1\n10,-1\n",
    );
    let share = |arguments: &[&str]| {
        w.run(&[arguments, &["--json", "r.json"]].concat()).exits(0);
        let report: serde_json::Value = serde_json::from_slice(&w.read("r.json")).unwrap();
        report["measures"][0]["value"].as_f64().unwrap()
    };
    // Straight lines between keys: positive until 2 of 10 seconds, located to within a step beside kinks.
    for samples in ["11", "101", "501"] {
        let found = share(&["check", "keys.toml", "--samples", samples]);
        let step = 2.0 / samples.parse::<f64>().unwrap();
        assert!((found - 0.2).abs() < step, "{samples}: {found}");
    }
    let found = share(&["check", "table.toml", "--input-table", "t.csv"]);
    assert!((found - 0.2).abs() < 0.05, "{found}");
}
