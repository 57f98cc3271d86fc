//! The mesh files of a scene: where they may stand, each read once, their triangles counted together.

use crate::diag::shown_text;
use crate::geometry::stl::read_stl;
use crate::limits::{Resource, current_limits};
use crate::model::shape::TriangleSoup;
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// What decides whether two shapes share their triangles: file, scale, whether it is a surface.
type MeshKey = (PathBuf, u64, bool);

/// Reads mesh files for one scene.
pub struct MeshFiles<'f> {
    folder: &'f Path,
    /// Folders beside the scene's own that files may stand in.
    allowed: &'f [PathBuf],
    known: HashMap<MeshKey, Arc<TriangleSoup>>,
    triangles: usize,
}

impl<'f> MeshFiles<'f> {
    /// For a scene in `folder`, which may read below it and below `allowed`.
    pub fn new(folder: &'f Path, allowed: &'f [PathBuf]) -> Self {
        Self {
            folder,
            allowed,
            known: HashMap::new(),
            triangles: 0,
        }
    }

    /// The triangles of a file, scaled. Errors in words: what [`read_stl`] refuses, a file elsewhere, too many triangles.
    pub fn read(
        &mut self,
        name: &str,
        scale: f64,
        is_surface: bool,
    ) -> Result<Arc<TriangleSoup>, String> {
        let path = self.folder.join(name);
        let key = (self.place(name, &path)?, scale.to_bits(), is_surface);
        if let Some(known) = self.known.get(&key) {
            return Ok(Arc::clone(known));
        }
        let mut soup = read_stl(&path).map_err(|e| e.to_string())?;
        self.triangles += soup.triangles.len();
        let all = current_limits().allow(
            Resource::Triangles,
            self.triangles as f64,
            &format!("the scene with {}", soup.source),
        );
        all.map_err(|e| e.to_string())?;
        soup.vertices.iter_mut().for_each(|v| *v *= scale);
        soup.is_surface = is_surface;
        let soup = Arc::new(soup);
        self.known.insert(key, Arc::clone(&soup));
        Ok(soup)
    }

    /// Where a file really stands, if it may stand there. What is elsewhere is not even said to exist.
    fn place(&self, name: &str, path: &Path) -> Result<PathBuf, String> {
        let own = match self.folder.as_os_str().is_empty() {
            true => Path::new("."),
            false => self.folder,
        };
        let mut folders = [own]
            .into_iter()
            .chain(self.allowed.iter().map(PathBuf::as_path));
        let refused = || {
            format!(
                "{} does not stand below the scene's folder; --allow-files DIR lets scenes read other folders",
                shown_text(name)
            )
        };
        let Ok(place) = path.canonicalize() else {
            let inside = Path::new(name)
                .components()
                .all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
            // Reading it says why it cannot be read.
            return if inside {
                Ok(path.to_owned())
            } else {
                Err(refused())
            };
        };
        let is_below = |folder: &Path| folder.canonicalize().is_ok_and(|f| place.starts_with(f));
        if folders.any(is_below) {
            return Ok(place);
        }
        Err(refused())
    }
}
