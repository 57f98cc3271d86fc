//! Reads STL files, binary and text. Units are not scaled here.

mod binary;
mod error;
mod text;

pub use error::{MAX_STL_TRIANGLES, StlError};

use crate::diag::shown_text;
use crate::model::shape::TriangleSoup;
use crate::weld::{first_equal, number_first, point_bits};
use binary::{
    BINARY_HEADER, BINARY_TRIANGLE, FacetCorners, announced_triangles, binary_size, check_binary,
    of_binary,
};
use error::LARGEST;
use glam::DVec3;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use text::StlText;

/// Most bytes read from one file: the triangle limit in the text form at its usual 270 bytes each.
const MAX_STL_BYTES: u64 = 540_000_000;
/// The byte order mark that some editors write before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads the triangles of an STL file and merges equal corners; coordinates are those of the file.
///
/// The form is recognised by the size that a binary file must have, then by the word `solid`, so that a binary file
/// whose title begins with that word is read correctly. Errors: see [`StlError`].
pub fn read_stl(path: &Path) -> Result<TriangleSoup, StlError> {
    let name = shown_text(&path.display().to_string()).into_owned();
    let read_error = |source| StlError::Read {
        path: name.clone(),
        source,
    };
    // Size and kind are judged before the file is opened.
    let about = std::fs::metadata(path).map_err(read_error)?;
    if !about.is_file() {
        return Err(StlError::NoFile { path: name });
    }
    if about.len() > MAX_STL_BYTES {
        return Err(StlError::TooLarge { path: name });
    }
    let file = std::fs::File::open(path).map_err(read_error)?;
    parse_stl(BufReader::new(file.take(MAX_STL_BYTES)), about.len(), name)
}

/// The triangles of a file of so many bytes; `path` is for messages.
fn parse_stl(mut file: impl BufRead, bytes: u64, path: String) -> Result<TriangleSoup, StlError> {
    let read_error = |source| StlError::Read {
        path: path.clone(),
        source,
    };
    let mut head = Vec::new();
    let mut first = (&mut file).take(BINARY_HEADER as u64);
    first.read_to_end(&mut head).map_err(read_error)?;
    // A binary file announces as many triangles as fit its size, even if its header begins with "solid".
    let announced = announced_triangles(&head);
    let fits = announced.is_some_and(|count| binary_size(count) == Some(bytes));
    let start = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&head);
    let word = start.trim_ascii_start().get(..5);
    // Otherwise "solid" begins a text.
    if word.is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !fits {
        return collect_triangles(StlText::new(start.chain(file)), path);
    }
    if bytes <= BINARY_HEADER as u64 && head.iter().all(u8::is_ascii_whitespace) {
        return Err(StlError::Empty { path });
    }
    let count = check_binary(bytes, announced, &path)?;
    let triangles = (0..count).map(|_| {
        let mut triangle = [0; BINARY_TRIANGLE];
        file.read_exact(&mut triangle).map_err(|e| e.to_string())?;
        Ok(of_binary(&triangle))
    });
    collect_triangles(triangles, path)
}

fn collect_triangles(
    triangles: impl Iterator<Item = Result<FacetCorners, String>>,
    path: String,
) -> Result<TriangleSoup, StlError> {
    let mut corners = Vec::new();
    for triangle in triangles {
        let triangle = match triangle {
            Ok(triangle) => triangle,
            Err(detail) => return Err(StlError::Syntax { path, detail }),
        };
        if corners.len() == 3 * MAX_STL_TRIANGLES {
            return Err(StlError::TooLarge { path });
        }
        // NaN is not smaller.
        if !triangle.iter().flatten().all(|c| c.abs() <= LARGEST) {
            let triangle = corners.len() / 3 + 1;
            return Err(StlError::NotFinite { path, triangle });
        }
        corners.extend(triangle.map(DVec3::from));
    }
    if corners.is_empty() {
        return Err(StlError::Empty { path });
    }
    let mut has_area = corners
        .chunks_exact(3)
        .map(|t| (t[1] - t[0]).cross(t[2] - t[0]));
    if !has_area.any(|area| area.try_normalize().is_some()) {
        return Err(StlError::Flat { path });
    }
    Ok(weld_corners(corners, path))
}

/// Equal corners made one, in the order of their first use.
fn weld_corners(mut corners: Vec<DVec3>, source: String) -> TriangleSoup {
    // The first corner of every group of equal ones is kept, in the order of the file.
    let mut ids = first_equal(corners.len(), |k| point_bits(corners[k]));
    let mut place = 0;
    for (corner, first) in ids.iter().enumerate() {
        if corner == *first as usize {
            corners[place] = corners[corner];
            place += 1;
        }
    }
    corners.truncate(place);
    corners.shrink_to_fit();
    number_first(&mut ids);
    TriangleSoup {
        source,
        vertices: corners,
        triangles: ids.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        is_surface: false,
    }
}

#[cfg(test)]
mod tests;
