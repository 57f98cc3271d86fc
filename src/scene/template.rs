//! A new scene from a built-in one: with another title, and a comment above every section.

use super::keys::tables::SCENE;
use crate::diag::shown_text;

/// Keys of the built-in scenes that state their origin, not their content.
const LEFT_OUT: [&str; 2] = ["source", "description"];

/// The text of a scene with another title. A comment above the first line of every section explains it, in the words of
/// the scene format.
pub fn titled_template(text: &str, title: &str, head: &str) -> String {
    let mut out = String::new();
    for line in head.lines() {
        out.push_str(&format!("# {line}\n"));
    }
    let mut told: Vec<&str> = Vec::new();
    for line in text.lines() {
        let key = line.split('=').next().unwrap_or_default().trim();
        let is_top = told.is_empty();
        match is_top && line.contains('=') {
            true if LEFT_OUT.contains(&key) => continue,
            true if key == "title" => {
                let title = shown_text(title).replace('\\', "\\\\").replace('"', "\\\"");
                out.push_str(&format!("title = \"{title}\"\n"));
                continue;
            }
            _ => {}
        }
        if let Some(says) = section_of(line)
            .filter(|name| !told.contains(name))
            .and_then(|name| {
                told.push(name);
                let key = SCENE.list.iter().find(|key| key.name == name)?;
                Some(key.says)
            })
        {
            out.push_str(&format!("# {says}\n"));
        }
        out.push_str(line);
        out.push('\n');
    }
    out
}

/// The section that a line opens: `[parameters]`, `[[bodies]]`, `[inputs.phi]`.
fn section_of(line: &str) -> Option<&str> {
    let inside = line.strip_prefix('[')?.split(']').next()?;
    // `[contacts.wheel]` opens `contacts`, if nothing else did.
    inside.trim_start_matches('[').split('.').next()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::scene::builtin::{ALL, find_builtin};
    use crate::scene::{Overrides, load_scene};

    #[test]
    fn every_built_in_scene_is_a_template() {
        for scene in ALL {
            let mut source = find_builtin(scene.name).unwrap();
            let before = load_scene(&source, &Overrides::default()).unwrap();
            source.text = titled_template(&source.text, "my \"own\" one", "first\nsecond");
            assert!(
                source.text.starts_with("# first\n# second\n"),
                "{}",
                scene.name
            );
            let after = load_scene(&source, &Overrides::default()).unwrap();
            assert_eq!(after.mechanism.title, "my \"own\" one", "{}", scene.name);
            assert_eq!(
                after.mechanism.bodies, before.mechanism.bodies,
                "{}",
                scene.name
            );
            assert_eq!(
                after.mechanism.loops, before.mechanism.loops,
                "{}",
                scene.name
            );
            let told = source
                .text
                .matches("# what `mechanim plot` draws\n")
                .count();
            assert_eq!(
                told,
                usize::from(scene.text.contains("[[plots]]")),
                "{}",
                scene.name
            );
        }
    }
}
