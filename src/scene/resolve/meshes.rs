//! The mesh files of a scene: where they may stand, each read once, their triangles counted together.

use super::range::LARGEST;
use crate::geometry::stl::read_stl;
use crate::limits::{Resource, current_limits};
use crate::model::shape::TriangleSoup;
use crate::scene::source::place_below;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
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
        let place = place_below(name, (self.folder, "scene's"), self.allowed)?;
        let key = (place, scale.to_bits(), is_surface);
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
        let farthest = soup.vertices.iter().map(|v| v.abs().max_element());
        let farthest = farthest.fold(0.0, f64::max);
        if farthest > LARGEST {
            return Err(format!(
                "{} has a coordinate of {farthest:e} with its `scale`: at most {LARGEST:e}",
                soup.source
            ));
        }
        soup.is_surface = is_surface;
        let soup = Arc::new(soup);
        self.known.insert(key, Arc::clone(&soup));
        Ok(soup)
    }
}
