//! The scripts of `study submit --dry-run` are read by the programs they are for.

use super::run;
use crate::program::Workspace;
use std::process::Command;

fn script(engine: &str, name: &str) -> (Workspace, String) {
    let space = Workspace::new();
    let plan = "study plan sweep four-bar --design grid:crank=30..35:6 --outputs K.x --units 3";
    run(&space, &format!("{plan} --out it's")).exits(0);
    let line = format!("study submit it's --to {engine} --workers 4 --cores 2 --dry-run");
    let printed = run(&space, &line).exits(0).text();
    // Nothing in the folder says that the study was submitted.
    let path = format!("it's/{name}");
    assert!(!space.path(&path).exists());
    space.write(&path, &printed);
    (space, printed)
}

#[cfg(unix)]
#[test]
fn scripts_of_shells_are_scripts() {
    for (engine, name, variable, array) in [
        (
            "slurm",
            "submit-slurm.sh",
            "SLURM_ARRAY_TASK_ID",
            "#SBATCH --array=0-3\n",
        ),
        ("hq", "submit-hq.sh", "HQ_TASK_ID", "--array 0-3 "),
    ] {
        let (space, text) = script(engine, name);
        assert!(text.contains(array) && text.contains(variable), "{text}");
        let path = space.path(&format!("it's/{name}"));
        assert!(
            Command::new("bash")
                .arg("-n")
                .arg(&path)
                .status()
                .unwrap()
                .success()
        );
    }
    // What the array would run does the study, as worker 3 of 4.
    let (space, _) = script("slurm", "submit-slurm.sh");
    let mut job = Command::new("bash");
    let job = job
        .arg(space.path("it's/submit-slurm.sh"))
        .env("SLURM_ARRAY_TASK_ID", "2");
    assert!(job.output().unwrap().status.success());
    run(&space, "study merge it's --out rows.csv").exits(0);
}

#[test]
fn the_driver_of_ray_is_python() {
    let (space, text) = script("ray", "submit-ray.py");
    assert!(text.contains("WORKERS = 4\n") && text.contains("THREADS = 2\n"));
    let path = space.path("it's/submit-ray.py");
    let compile = "import ast, sys; ast.parse(open(sys.argv[1]).read())";
    let python = Command::new("python3")
        .args(["-c", compile])
        .arg(path)
        .status();
    // Where there is no Python the text is all that can be looked at.
    assert!(python.map_or(true, |status| status.success()));
}

#[test]
fn the_job_of_kubernetes_is_indexed() {
    let (_space, text) = script("kubernetes", "submit-kubernetes.yaml");
    for part in [
        "completionMode: Indexed",
        "completions: 4",
        "JOB_COMPLETION_INDEX + 1))/4",
    ] {
        assert!(text.contains(part), "{part}");
    }
}

#[test]
fn a_study_is_submitted_once() {
    let space = Workspace::new();
    let plan = "study plan sweep four-bar --design grid:crank=30..35:6 --outputs K.x --units 3";
    run(&space, &format!("{plan} --out study")).exits(0);
    space.write("study/submit-slurm.sh", "submitted");
    run(&space, "study submit study --to slurm")
        .exits(2)
        .says(&["was submitted"]);
    assert_eq!(space.read("study/submit-slurm.sh"), b"submitted");
}
