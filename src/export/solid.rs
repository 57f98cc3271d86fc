//! Triangles of one pose: binary STL and Wavefront OBJ, in the world frame and the scene's unit.

use super::ExportSummary;
use super::error::ExportError;
use super::model::{ExportModel, ModelPart};
use super::target::Output;
use crate::math::narrow_vector;
use crate::numbers::decimal::trimmed;
use std::collections::BTreeSet;
use std::io::{self, BufWriter, Write};

/// Writes the first key of `model` as binary STL and returns what was written. Colours and bodies are lost.
///
/// Errors: no triangles, a failed write.
pub fn write_stl(
    model: &ExportModel,
    output: Box<dyn Output>,
) -> Result<ExportSummary, ExportError> {
    let mut triangles = Vec::new();
    for (_, part, pose) in model.placed_parts() {
        let corner = |index: u32| pose.transform_point(part.mesh.positions[index as usize]);
        for triangle in &part.mesh.triangles {
            let [a, b, c] = triangle.map(corner);
            // Triangles without area have no normal; the format wants zeros then.
            let normal = (b - a).cross(c - a).normalize_or_zero();
            triangles.push(stl_io::Triangle {
                normal: stl_io::Normal::new(narrow_vector(normal)),
                vertices: [a, b, c].map(|v| stl_io::Vertex::new(narrow_vector(v))),
            });
        }
    }
    finish_file(output, "an STL", triangles.len(), |mut file| {
        stl_io::write_stl(&mut file, triangles.iter())
    })
}

/// A material file, and its name as the OBJ refers to it.
pub type Library = (String, Box<dyn Output>);

/// Writes the first key of `model` as OBJ, one object a body, colours at the vertices (`v x y z r g b`, 0 to 1) and, if
/// there is a file for them, as materials in the library.
///
/// Errors: no triangles, a failed write.
pub fn write_obj(
    model: &ExportModel,
    output: Box<dyn Output>,
    library: Option<Library>,
) -> Result<ExportSummary, ExportError> {
    let parts = model.placed_parts();
    let triangles = parts.map(|(_, part, _)| part.mesh.triangles.len()).sum();
    let name = library.as_ref().map(|(name, _)| name.as_str());
    let mut summary = finish_file(output, "an OBJ", triangles, |file| {
        obj_lines(model, name, file)
    })?;
    if let Some((_, output)) = library {
        let materials = finish_file(output, "an MTL", triangles, |file| write_mtl(model, file))?;
        summary.bytes += materials.bytes;
    }
    Ok(summary)
}

/// Name of a part's material: its colour, and its opacity in percent if it is translucent.
fn material_name(part: &ModelPart) -> String {
    let [r, g, b] = part.colour;
    match part.opacity {
        opacity if opacity < 1.0 => format!("{r:02x}{g:02x}{b:02x}-{:.0}", 100.0 * opacity),
        _ => format!("{r:02x}{g:02x}{b:02x}"),
    }
}

/// Every material once. `Kd` is the colour in sRGB codes, as most readers take it.
fn write_mtl(model: &ExportModel, file: &mut dyn Write) -> io::Result<()> {
    let mut known = BTreeSet::new();
    for (_, part, _) in model.placed_parts() {
        let name = material_name(part);
        if known.insert(name.clone()) {
            let [r, g, b] = part.colour.map(|c| f32::from(c) / 255.0);
            writeln!(file, "newmtl {name}")?;
            writeln!(file, "Kd {r:.4} {g:.4} {b:.4}\nKs 0.2 0.2 0.2\nNs 60")?;
            writeln!(file, "d {:.4}\nillum 2", part.opacity)?;
        }
    }
    Ok(())
}

fn obj_lines(model: &ExportModel, library: Option<&str>, file: &mut dyn Write) -> io::Result<()> {
    writeln!(file, "# {}", one_line(&model.title))?;
    if let Some(library) = library {
        writeln!(file, "mtllib {library}")?;
    }
    let decimals = model.decimals();
    // Corners are counted from 1 over the whole file.
    let mut base = 1;
    let mut object = None;
    for (body, part, pose) in model.placed_parts() {
        if object != Some(&body.name) {
            writeln!(file, "o {}", one_line(&body.name).replace(' ', "_"))?;
            object = Some(&body.name);
        }
        let [r, g, b] = part.colour.map(|c| f32::from(c) / 255.0);
        for point in &part.mesh.positions {
            let point = pose.transform_point(*point).to_array();
            let [x, y, z] = point.map(|coordinate| trimmed(coordinate, decimals));
            writeln!(file, "v {x} {y} {z} {r:.4} {g:.4} {b:.4}")?;
        }
        for normal in &part.mesh.normals {
            let [x, y, z] = narrow_vector(pose.transform_vector(*normal));
            writeln!(file, "vn {x:.6} {y:.6} {z:.6}")?;
        }
        if library.is_some() {
            writeln!(file, "usemtl {}", material_name(part))?;
        }
        for triangle in &part.mesh.triangles {
            let [a, b, c] = triangle.map(|i| base + i as usize);
            writeln!(file, "f {a}//{a} {b}//{b} {c}//{c}")?;
        }
        base += part.mesh.positions.len();
    }
    Ok(())
}

fn one_line(text: &str) -> String {
    text.replace(|c: char| c.is_control(), " ")
}

/// Writes through a buffer, counts, and commits.
fn finish_file(
    output: Box<dyn Output>,
    format: &'static str,
    triangles: usize,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<ExportSummary, ExportError> {
    if triangles == 0 {
        return Err(ExportError::NoTriangles { format });
    }
    let name = output.name().to_owned();
    let mut file = BufWriter::new(Counted { output, bytes: 0 });
    let written = write(&mut file).and_then(|()| file.flush());
    written.map_err(|e| ExportError::write(&name, e))?;
    let counted = file.into_inner();
    let Counted { output, bytes } =
        counted.map_err(|e| ExportError::write(&name, e.into_error()))?;
    output.commit()?;
    Ok(ExportSummary {
        frames: 1,
        bytes,
        seconds: 0.0,
    })
}

struct Counted {
    output: Box<dyn Output>,
    bytes: u64,
}

impl Write for Counted {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = self.output.write(bytes)?;
        self.bytes += taken as u64;
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}
