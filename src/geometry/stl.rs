//! Reading STL files, binary and text, with clear refusals. Holds no meshes and no scaling of units.

use super::weld::{first_equal, number_first, point_bits};
use crate::diag::shown_text;
use crate::model::shape::TriangleSoup;
use glam::DVec3;
use std::io::{BufRead, BufReader, Read};
use std::ops::Range;
use std::path::Path;

/// Most triangles read from one file: more cannot be told apart in a picture and would fill the memory.
pub const MAX_STL_TRIANGLES: usize = 2_000_000;
/// Most bytes read from one file: the triangle limit in the text form at its usual 270 bytes each.
const MAX_STL_BYTES: u64 = 540_000_000;
/// Largest coordinate: pictures count in single precision, and squares of lengths must fit there.
const LARGEST: f64 = 1e18;
/// Longest line of the text form.
const LONGEST_LINE: u64 = 1 << 20;
/// What some editors put before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// Bytes before the triangles of a binary file: title and count.
const BINARY_HEADER: usize = 84;
/// Bytes of a triangle in a binary file.
const BINARY_TRIANGLE: usize = 50;

/// The three corners of a triangle.
type CornerReader = [[f64; 3]; 3];

/// Why an STL file could not be used.
#[derive(Debug, thiserror::Error)]
pub enum StlError {
    /// Missing, not readable, a folder.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// No triangles at all.
    #[error("{path} holds no triangles")]
    Empty {
        /// The file.
        path: String,
    },
    /// The file ends before the triangles it announces.
    #[error("{path} is cut short, or no STL file: it has no room for the triangles it announces")]
    Truncated {
        /// The file.
        path: String,
    },
    /// A folder, a device, a pipe.
    #[error("cannot read {path}: it is no regular file")]
    NoFile {
        /// The file.
        path: String,
    },
    /// All triangles are points or lines.
    #[error("{path} holds no triangle with an area")]
    Flat {
        /// The file.
        path: String,
    },
    /// More than [`MAX_STL_TRIANGLES`].
    #[error("{path} holds more than {MAX_STL_TRIANGLES} triangles; reduce it first")]
    TooLarge {
        /// The file.
        path: String,
    },
    /// A coordinate that is infinite, not a number, or beyond `LARGEST`.
    #[error(
        "triangle {triangle} of {path} has a corner that is not a finite number, or beyond {LARGEST:e}"
    )]
    NotFinite {
        /// The file.
        path: String,
        /// Its number, from 1.
        triangle: usize,
    },
    /// Neither form of STL.
    #[error("{path} is not an STL file: {detail}")]
    Syntax {
        /// The file.
        path: String,
        /// What the reader says.
        detail: String,
    },
}

/// Reads the triangles of an STL file, equal corners made one; coordinates as they stand in the file.
///
/// The form is recognised by the size that a binary file must have, then by the word `solid`, so that a
/// binary file whose title begins with that word is read rightly. Errors: see [`StlError`].
pub fn read_stl(path: &Path) -> Result<TriangleSoup, StlError> {
    let name = shown_text(&path.display().to_string()).into_owned();
    let read_error = |source| StlError::Read {
        path: name.clone(),
        source,
    };
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
    let announced = announced_triangles(&head);
    let fits = announced.is_some_and(|count| binary_size(count) == Some(bytes));
    let start = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&head);
    let word = start.trim_ascii_start().get(..5);
    if word.is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !fits {
        return collect_triangles(Text::new(start.chain(file)), path);
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

/// Corners of a triangle of a binary file, behind its normal.
fn of_binary(bytes: &[u8]) -> CornerReader {
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

/// The triangles of the text form. What stands in the file is not repeated in messages: it may be another file than an
/// STL, and none of the reader's business.
struct Text<R> {
    file: R,
    /// The line that is read, and where its next word is looked for.
    bytes: Vec<u8>,
    at: usize,
    line: usize,
}

impl<R: BufRead> Text<R> {
    fn new(file: R) -> Self {
        Self {
            file,
            bytes: Vec::new(),
            at: 0,
            line: 0,
        }
    }

    /// The next word; the titles of solids are left out. `None` at the end.
    fn word(&mut self) -> Result<Option<Range<usize>>, String> {
        loop {
            let rest = &self.bytes[self.at..];
            if let Some(start) = rest.iter().position(|b| !b.is_ascii_whitespace()) {
                let start = self.at + start;
                let rest = &self.bytes[start..];
                let end = rest.iter().position(u8::is_ascii_whitespace);
                self.at = end.map_or(self.bytes.len(), |end| start + end);
                return Ok(Some(start..self.at));
            }
            if !self.next_line()? {
                return Ok(None);
            }
        }
    }

    fn next_line(&mut self) -> Result<bool, String> {
        self.bytes.clear();
        self.at = 0;
        let mut line = (&mut self.file).take(LONGEST_LINE);
        let count = line
            .read_until(b'\n', &mut self.bytes)
            .map_err(|e| e.to_string())?;
        self.line += 1;
        if count as u64 == LONGEST_LINE {
            return Err(format!(
                "line {} is longer than {LONGEST_LINE} bytes",
                self.line
            ));
        }
        let mut words = self
            .bytes
            .split(u8::is_ascii_whitespace)
            .filter(|w| !w.is_empty());
        let is_title = words.next().is_some_and(|first| {
            [&b"solid"[..], b"endsolid"]
                .iter()
                .any(|word| first.eq_ignore_ascii_case(word))
        });
        if is_title {
            self.at = self.bytes.len();
        }
        Ok(count > 0)
    }

    fn expect(&mut self, words: &[&str]) -> Result<(), String> {
        for expected in words {
            let word = self
                .word()?
                .ok_or_else(|| format!("it ends where `{expected}` stands"))?;
            if !self.bytes[word].eq_ignore_ascii_case(expected.as_bytes()) {
                return Err(format!(
                    "line {} has no `{expected}` where one stands",
                    self.line
                ));
            }
        }
        Ok(())
    }

    fn numbers(&mut self) -> Result<[f64; 3], String> {
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            let word = self.word()?.ok_or("it ends where a number stands")?;
            let word = std::str::from_utf8(&self.bytes[word]).unwrap_or_default();
            let value = word.parse();
            *number =
                value.map_err(|_| format!("line {} has no number where one stands", self.line))?;
        }
        Ok(numbers)
    }

    fn triangle(&mut self) -> Result<CornerReader, String> {
        self.expect(&["normal"])?;
        self.numbers()?;
        self.expect(&["outer", "loop"])?;
        let mut corners = CornerReader::default();
        for corner in &mut corners {
            self.expect(&["vertex"])?;
            *corner = self.numbers()?;
        }
        self.expect(&["endloop", "endfacet"])?;
        Ok(corners)
    }
}

impl<R: BufRead> Iterator for Text<R> {
    type Item = Result<CornerReader, String>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.word() {
            Err(error) => Some(Err(error)),
            Ok(None) => None,
            Ok(Some(word)) if self.bytes[word.clone()].eq_ignore_ascii_case(b"facet") => {
                Some(self.triangle())
            }
            Ok(Some(_)) => Some(Err(format!(
                "line {} has no `facet` where one stands",
                self.line
            ))),
        }
    }
}

fn announced_triangles(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(BINARY_HEADER - 4..BINARY_HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

fn binary_size(count: usize) -> Option<u64> {
    let bytes = (count as u64).checked_mul(BINARY_TRIANGLE as u64)?;
    bytes.checked_add(BINARY_HEADER as u64)
}

/// The number of triangles of a binary file.
fn check_binary(bytes: u64, announced: Option<usize>, path: &str) -> Result<usize, StlError> {
    let path = path.to_owned();
    let Some(announced) = announced else {
        let detail = "too short for the header of the binary form, and no text form".to_owned();
        return Err(StlError::Syntax { path, detail });
    };
    let found = (bytes.saturating_sub(BINARY_HEADER as u64) / BINARY_TRIANGLE as u64) as usize;
    match found {
        _ if announced == 0 => Err(StlError::Empty { path }),
        _ if found < announced => Err(StlError::Truncated { path }),
        _ if announced > MAX_STL_TRIANGLES => Err(StlError::TooLarge { path }),
        _ => Ok(announced),
    }
}

fn collect_triangles(
    triangles: impl Iterator<Item = Result<CornerReader, String>>,
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
        // Not a number is not smaller.
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
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    fn read(bytes: &[u8]) -> Result<TriangleSoup, StlError> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        std::io::Write::write_all(&mut file, bytes).unwrap();
        read_stl(file.path())
    }

    fn binary(title: &[u8], announced: u32, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = vec![0; BINARY_HEADER];
        bytes[..title.len()].copy_from_slice(title);
        bytes[80..].copy_from_slice(&announced.to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            bytes.extend(triangle.iter().flatten().flat_map(|c| c.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const ONE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    const TWO: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-1.0, 0.0, 0.5]];
    const TEXT: &str = "facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n \
                        vertex 0 2 0\n endloop\nendfacet\nendsolid";

    #[test]
    fn both_forms_and_misleading_titles_are_read() {
        for title in ["", "made by hand", "solid lies"] {
            let soup = read(&binary(title.as_bytes(), 2, &[ONE, TWO])).unwrap();
            assert_eq!((soup.vertices.len(), soup.triangles.len()), (4, 2));
            assert_eq!(soup.vertices[3], DVec3::new(-1.0, 0.0, 0.5));
        }
        for first in ["solid", "solid lever", "\n solid  lever arm \r"] {
            let soup = read(format!("{first}\n{TEXT}\n").as_bytes()).unwrap();
            assert_eq!(soup.triangles, [[0, 1, 2]]);
            assert_eq!(soup.vertices[2], DVec3::new(0.0, 2.0, 0.0));
        }
    }

    #[test]
    fn numbers_are_taken_as_they_stand() {
        let text = TEXT.replace("vertex 1 0 0", "vertex 0.1234567890123 0 1e-30");
        let soup = read(format!("solid\n{text}").as_bytes()).unwrap();
        assert_eq!(
            soup.vertices[1],
            DVec3::new(0.123_456_789_012_3, 0.0, 1e-30)
        );
        let soup = read(format!("SOLID a\n{}", TEXT.to_uppercase()).as_bytes()).unwrap();
        assert_eq!(soup.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn what_cannot_be_used_is_refused_by_kind() {
        let missing = read_stl(Path::new("/no/such/file.stl"));
        assert!(matches!(missing, Err(StlError::Read { .. })));
        assert!(matches!(read(b""), Err(StlError::Empty { .. })));
        assert!(matches!(read(b" \n"), Err(StlError::Empty { .. })));
        assert!(matches!(
            read(&binary(b"", 0, &[])),
            Err(StlError::Empty { .. })
        ));
        assert!(matches!(
            read(b"solid a\nendsolid a\n"),
            Err(StlError::Empty { .. })
        ));
        assert!(matches!(read(b"hello"), Err(StlError::Syntax { .. })));
        assert!(matches!(
            read(b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0"),
            Err(StlError::Syntax { .. })
        ));
        // A count of four thousand million must not be believed.
        assert!(matches!(
            read(&binary(b"", u32::MAX, &[ONE])),
            Err(StlError::Truncated { .. })
        ));
        for wrong in [f32::NAN, f32::INFINITY, -3e38] {
            let mut triangle = ONE;
            triangle[1][2] = wrong;
            assert!(matches!(
                read(&binary(b"", 2, &[ONE, triangle])),
                Err(StlError::NotFinite { triangle: 2, .. })
            ));
        }
        let line = [ONE[0], ONE[1], ONE[0]];
        assert!(matches!(
            read(&binary(b"", 1, &[line])),
            Err(StlError::Flat { .. })
        ));
        assert!(matches!(
            read_stl(Path::new("/dev/null")),
            Err(StlError::NoFile { .. })
        ));
    }

    /// A path may lead to any file of its reader: nothing of it is told.
    #[test]
    fn no_content_stands_in_a_message() {
        let secret = "topsecret";
        for text in [
            format!("solid a\n{secret} normal"),
            format!("solid a\nfacet normal {secret}"),
            format!("solid a\nfacet normal 0 0 1\nouter {secret}"),
            format!("{secret}{}", "x".repeat(200)),
        ] {
            let error = read(text.as_bytes()).unwrap_err().to_string();
            assert!(
                !error.contains(secret) && !error.contains("2021161080"),
                "{error}"
            );
        }
    }

    #[test]
    fn a_byte_order_mark_and_long_lines_do_no_harm() {
        let soup = read(format!("\u{feff}solid\n{TEXT}").as_bytes()).unwrap();
        assert_eq!(soup.triangles, [[0, 1, 2]]);
        let long = format!("solid\n{}{TEXT}", " ".repeat(2 << 20));
        assert!(matches!(
            read(long.as_bytes()),
            Err(StlError::Syntax { .. })
        ));
    }
}
