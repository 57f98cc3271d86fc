//! Scenes as large as a scene may be, of one thing over and over: read, or refused with all its mistakes counted, in a time
//! that grows with the text and not with its square.

use crate::program::{Run, STILL, Workspace};

/// Bytes of a text: just below the largest that is read.
const SIZE: usize = 4_000_000;

/// Processor seconds that one may take. Half a second to one here; minutes or hours where every name is compared with
/// every other one.
const MOST: u32 = 4;

/// `STILL` with as many entries behind it as a scene has room for, separated by `between`.
fn filled(before: &str, entry: impl Fn(usize) -> String, between: &str, after: &str) -> String {
    let mut text = format!("{STILL}{before}");
    for k in 0.. {
        let next = entry(k);
        if text.len() + next.len() + between.len() + after.len() > SIZE {
            break;
        }
        text.push_str(&next);
        text.push_str(between);
    }
    text + after
}

fn checked(w: &Workspace, what: &str, text: &str) -> Run {
    w.write("s.toml", text);
    let run = w.run_within(MOST, &["check", "s.toml", "--samples", "3"]);
    println!(
        "{what}: exit {}, {} bytes of messages",
        run.code,
        run.stderr.len()
    );
    run
}

#[test]
fn a_file_of_nothing_but_mistakes_is_answered_at_once() {
    let w = Workspace::new();
    let shape = |_| "{ sphere = { radius = -1 } }".to_owned();
    for (what, text) in [
        (
            "shapes on one line",
            filled("[[bodies]]\nname = \"b\"\nshapes = [", shape, ", ", "]\n"),
        ),
        (
            "bodies without a name",
            filled(
                "",
                |k| format!("[[bodies]]\nframe = \"Rz(phi Tx({k})\""),
                "\n",
                "",
            ),
        ),
        (
            "unknown names in outputs",
            filled(
                "[outputs]\n",
                |k| format!("o{k} = \"q{k}*q{}\"", k + 1),
                "\n",
                "",
            ),
        ),
        (
            "broken parameters",
            filled(
                "[parameters]\n",
                |k| format!("p{k} = \"nope{k}+\""),
                "\n",
                "",
            ),
        ),
        (
            "undefined parameters",
            filled("[parameters]\n", |k| format!("p{k} = \"q{k}\""), "\n", ""),
        ),
        (
            "bodies of one name",
            filled("", |_| "[[bodies]]\nname = \"b\"".to_owned(), "\n", ""),
        ),
        (
            "start values of nothing",
            STILL.replace(
                "[guess]\n",
                &filled("[guess]\n", |k| format!("g{k} = 1"), "\n", "").split_off(STILL.len()),
            ),
        ),
    ] {
        let run = checked(&w, what, &text).exits(2);
        assert!(
            run.stderr.contains("more errors of"),
            "{what}:\n{}",
            run.stderr
        );
        assert!(run.stderr.len() < 30_000, "{what}: {}", run.stderr.len());
    }
}

#[test]
fn many_names_are_looked_up_at_once() {
    let w = Workspace::new();
    for (what, text) in [
        (
            "parameters of parameters",
            filled(
                "[parameters]\np0 = 1\n",
                |k| format!("p{} = \"p{k}/2 + 1\"", k + 1),
                "\n",
                "",
            ),
        ),
        (
            "outputs of outputs",
            filled(
                "[outputs]\no0 = \"h\"\n",
                |k| format!("o{} = \"o{k}/2 + 1\"", k + 1),
                "\n",
                "",
            ),
        ),
    ] {
        // Outputs are printed; a tenth shows as well how the time grows.
        let end = text[..SIZE / 10].rfind('\n').unwrap();
        checked(&w, what, &text[..end]).exits(0);
    }
}

#[test]
fn a_mistake_is_said_once() {
    let w = Workspace::new();
    w.write(
        "s.toml",
        "[inputs]\nphi = 0.3\n[chains]\na = \"Rz(s) Tx(80) Rz(b) Tx(-s)\"\n\
         [loops]\nA = \"Rz(phi) Tx(40) a\"\nB = \"Rz(phi) Tx(30) a\"\n",
    );
    let run = w.run(&["check", "s.toml"]).exits(2);
    assert_eq!(
        run.stderr.matches("is used both as").count(),
        1,
        "{}",
        run.stderr
    );
}

/// Names of files are bytes.
#[cfg(unix)]
#[test]
fn scenes_are_found_by_names_that_are_no_text() {
    use std::os::unix::ffi::OsStrExt;
    let w = Workspace::new();
    let name = std::ffi::OsStr::from_bytes(b"s\xff\x1b.toml");
    std::fs::write(w.path("").join(name), STILL).unwrap();
    let check = [std::ffi::OsStr::new("check"), name];
    w.run(&check).exits(0).says_nothing();
    std::fs::write(w.path("").join(name), "x = 1\n").unwrap();
    w.run(&check).exits(2).says(&["s\u{fffd}\\u{1b}.toml"]);
}

#[test]
fn options_have_ends() {
    let w = Workspace::new();
    for (arguments, says) in [
        (
            &["tolerance", "gearshift", "--tolerance", "1e300"][..],
            "at most",
        ),
        (&["tolerance", "gearshift", "--enlarge", "1e300"], "at most"),
        (
            &["optimise", "gearshift", "--convergence", "1e300"],
            "at most 1",
        ),
        (
            &["optimise", "gearshift", "--within", "1e300%"],
            "at most 1000",
        ),
        (
            &[
                "synthesise",
                "torus-torus",
                "--time",
                "1e300",
                "--starts",
                "0",
            ],
            "from 1",
        ),
    ] {
        w.run(arguments).exits(2).says(&[says]);
    }
}
