//! The mesh files of a scene: checked for their location, read once each, their triangles counted together.

use super::range::LARGEST;
use crate::geometry::stl::read_stl;
use crate::limits::{Resource, current_limits};
use crate::model::shape::TriangleSoup;
use crate::scene::source::place_below;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Two shapes share their triangles if these agree: file, scale, and whether it is a surface.
type MeshKey = (PathBuf, u64, bool);

/// Reads mesh files for one scene.
pub struct MeshFiles<'f> {
    folder: &'f Path,
    /// Further folders from which files may be read.
    allowed: &'f [PathBuf],
    known: HashMap<MeshKey, Arc<TriangleSoup>>,
    triangles: usize,
}

impl<'f> MeshFiles<'f> {
    /// For a scene in `folder`, which may read files in or below it and the `allowed` folders.
    pub fn new(folder: &'f Path, allowed: &'f [PathBuf]) -> Self {
        Self {
            folder,
            allowed,
            known: HashMap::new(),
            triangles: 0,
        }
    }

    /// The triangles of a file, scaled.
    ///
    /// Errors, as text: those of [`read_stl`], a file outside the folders, too many triangles.
    pub fn read(
        &mut self,
        name: &str,
        scale: f64,
        is_surface: bool,
    ) -> Result<Arc<TriangleSoup>, String> {
        let path = self.folder.join(name);
        let place = place_below(name, (self.folder, "scene's"), self.allowed)?;
        // The same file may be used at several scales, as a surface and as a solid.
        let key = (place, scale.to_bits(), is_surface);
        if let Some(known) = self.known.get(&key) {
            return Ok(Arc::clone(known));
        }
        let mut soup = read_stl(&path).map_err(|e| e.to_string())?;
        // The limit applies to all meshes of a scene together.
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
