//! Whatever a stranger may hand in: pictures and meshes by their first bytes, all else as a scene, a list of pictures and a
//! table of inputs. Everything is read or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mechanim::cli::open::inputs_table::apply_inputs;
use mechanim::diag::Source;
use mechanim::geometry::{mesh_of_triangles, read_stl};
use mechanim::import::{FilmFrame, FilmReader, ImportError};
use mechanim::scene::{Overrides, builtin, load_scene};
use mechanim::snapshot::Manifest;
use std::path::PathBuf;

/// Frames that are read of a film.
const FRAMES: usize = 20;

fuzz_target!(|bytes: &[u8]| {
    let is_picture = bytes.starts_with(b"\x89PNG") || bytes.starts_with(b"GIF8");
    let is_mesh = bytes.starts_with(b"solid") || bytes.starts_with(&[0; 80]);
    match (is_picture, is_mesh) {
        (true, _) => {
            if let Ok(film) = FilmReader::open(&written(bytes)) {
                let read = |frame: FilmFrame| {
                    let mut rows = frame.picture.rows()?;
                    while rows.next_row()?.is_some() {}
                    Ok::<_, ImportError>(())
                };
                let _ = film.take(FRAMES).try_for_each(|frame| frame.and_then(read));
            }
        }
        (_, true) => {
            if let Ok(soup) = read_stl(&written(bytes)) {
                mesh_of_triangles(&soup.vertices, &soup.triangles).is_closed();
            }
        }
        _ => read_text(bytes),
    }
});

fn read_text(bytes: &[u8]) {
    let source = Source {
        name: "fuzzed".to_owned(),
        text: String::from_utf8_lossy(bytes).into_owned(),
    };
    let _ = load_scene(&source, &Overrides::default());
    let _ = Manifest::read(&source);
    let crank = builtin::find_builtin("slider-crank").expect("a built-in scene");
    let mut crank = load_scene(&crank, &Overrides::default()).expect("a sound scene");
    let _ = apply_inputs(&crank.mechanism, &mut crank.actuation, &written(bytes));
}

/// A file with these bytes.
fn written(bytes: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("mechanim-fuzz-{}", std::process::id()));
    std::fs::write(&path, bytes).expect("room for a file");
    path
}
