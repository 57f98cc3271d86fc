//! The binary form of STL.

use super::error::{MAX_STL_TRIANGLES, StlError};

/// The three corners of a triangle.
pub(super) type FacetCorners = [[f64; 3]; 3];

/// Bytes before the triangles of a binary file: title and count.
pub(super) const BINARY_HEADER: usize = 84;
/// Bytes of a triangle in a binary file.
pub(super) const BINARY_TRIANGLE: usize = 50;

/// Corners of a triangle of a binary file, behind its normal.
pub(super) fn of_binary(bytes: &[u8]) -> FacetCorners {
    let number = |k: usize| {
        let at = 12 + 4 * k;
        f64::from(f32::from_le_bytes([
            bytes[at],
            bytes[at + 1],
            bytes[at + 2],
            bytes[at + 3],
        ]))
    };
    [0, 3, 6].map(|k| [number(k), number(k + 1), number(k + 2)])
}

/// The number of triangles announced by the header of a binary file.
pub(super) fn announced_triangles(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(BINARY_HEADER - 4..BINARY_HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

/// Bytes of a binary file of so many triangles.
pub(super) fn binary_size(count: usize) -> Option<u64> {
    let bytes = (count as u64).checked_mul(BINARY_TRIANGLE as u64)?;
    bytes.checked_add(BINARY_HEADER as u64)
}

/// The number of triangles of a binary file.
pub(super) fn check_binary(
    bytes: u64,
    announced: Option<usize>,
    path: &str,
) -> Result<usize, StlError> {
    let path = path.to_owned();
    let Some(announced) = announced else {
        let detail = "too short for the header of the binary form, and no text form".to_owned();
        return Err(StlError::Syntax { path, detail });
    };
    let found = (bytes.saturating_sub(BINARY_HEADER as u64) / BINARY_TRIANGLE as u64) as usize;
    // Bytes behind the announced triangles are ignored, missing ones are an error.
    match found {
        _ if announced == 0 => Err(StlError::Empty { path }),
        _ if found < announced => Err(StlError::Truncated { path }),
        _ if announced > MAX_STL_TRIANGLES => Err(StlError::TooLarge { path }),
        _ => Ok(announced),
    }
}
