//! What the lock file says of the libraries.

use std::path::Path;

/// Which version of glam each of `packages` speaks: the entries of its dependency list in a lock file.
fn glam_of(lock: &str, packages: &[&str]) -> Vec<String> {
    let entries = lock.split("[[package]]");
    let wanted = entries.filter(|entry| {
        let name = entry.lines().find_map(|l| l.strip_prefix("name = "));
        name.is_some_and(|name| packages.contains(&name.trim_matches('"')))
    });
    let lines = wanted
        .flat_map(str::lines)
        .map(|l| l.trim().trim_matches(['"', ',']));
    let mut list: Vec<String> = lines
        .filter(|l| *l == "glam" || l.starts_with("glam "))
        .map(str::to_owned)
        .collect();
    list.sort();
    list
}

#[test]
fn one_glam_is_spoken() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.lock");
    let lock = std::fs::read_to_string(path).unwrap();
    let mut spoken = glam_of(&lock, &["mechanim", "parry3d-f64", "glamx"]);
    assert!(
        spoken.len() > 1,
        "the lock file is not understood: {spoken:?}"
    );
    spoken.dedup();
    assert_eq!(spoken.len(), 1, "{spoken:?}");
    let two =
        "[[package]]\nname = \"a\"\n \"glam 0.1\",\n[[package]]\nname = \"b\"\n \"glam 0.2\",\n";
    assert_eq!(glam_of(two, &["a", "b"]), ["glam 0.1", "glam 0.2"]);
}
