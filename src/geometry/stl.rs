//! Reading STL files, binary and text, with clear refusals. Holds no meshes and no scaling of units.

use crate::model::shape::TriangleSoup;
use glam::DVec3;
use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

/// Most triangles read from one file: more cannot be told apart in a picture and would fill the memory.
pub const MAX_STL_TRIANGLES: usize = 2_000_000;
/// Most bytes read from one file: the triangle limit in the text form at its usual 270 bytes each.
const MAX_STL_BYTES: u64 = 540_000_000;
/// Bytes before the triangles of a binary file: title and count.
const BINARY_HEADER: usize = 84;
/// Bytes of a triangle in a binary file.
const BINARY_TRIANGLE: usize = 50;

/// The three corners of a triangle.
type Corners = [[f64; 3]; 3];

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
    #[error("{path} is cut short: it announces {announced} triangles and ends after {found}")]
    Truncated {
        /// The file.
        path: String,
        /// Triangles by the file's header.
        announced: usize,
        /// Whole triangles present.
        found: usize,
    },
    /// More than [`MAX_STL_TRIANGLES`].
    #[error("{path} holds more than {MAX_STL_TRIANGLES} triangles; reduce it first")]
    TooLarge {
        /// The file.
        path: String,
    },
    /// A coordinate that is infinite or not a number.
    #[error("triangle {triangle} of {path} has a corner that is not a finite number")]
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
    let name = path.display().to_string();
    let read_error = |source| StlError::Read {
        path: name.clone(),
        source,
    };
    let file = std::fs::File::open(path).map_err(read_error)?;
    let mut bytes = Vec::new();
    file.take(MAX_STL_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(read_error)?;
    if bytes.len() as u64 > MAX_STL_BYTES {
        return Err(StlError::TooLarge { path: name });
    }
    parse(bytes, name)
}

/// The triangles of a file's bytes; `path` is for messages.
fn parse(bytes: Vec<u8>, path: String) -> Result<TriangleSoup, StlError> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(StlError::Empty { path });
    }
    let first = bytes.trim_ascii_start().get(..5);
    let text_like = first.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let announced = announced(&bytes);
    let fits = announced.is_some_and(|count| binary_size(count) == Some(bytes.len()));
    if text_like && !fits {
        let text = String::from_utf8_lossy(&bytes);
        return collect(Text::new(&text), path);
    }
    let count = check_binary(&bytes, announced, &path)?;
    let triangles = bytes[BINARY_HEADER..].chunks_exact(BINARY_TRIANGLE);
    collect(triangles.take(count).map(|t| Ok(of_binary(t))), path)
}

/// Corners of a triangle of a binary file, behind its normal.
fn of_binary(bytes: &[u8]) -> Corners {
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

/// The triangles of the text form.
struct Text<'t> {
    lines: std::iter::Enumerate<std::str::Lines<'t>>,
    words: std::str::SplitWhitespace<'t>,
    line: usize,
}

impl<'t> Text<'t> {
    fn new(text: &'t str) -> Self {
        Self {
            lines: text.lines().enumerate(),
            words: "".split_whitespace(),
            line: 0,
        }
    }

    /// The next word; the titles of solids are left out.
    fn word(&mut self) -> Option<&'t str> {
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            let (line, text) = self.lines.next()?;
            self.line = line + 1;
            let mut words = text.split_whitespace();
            let first = words.next().map(str::to_ascii_lowercase);
            let is_title = matches!(first.as_deref(), Some("solid" | "endsolid"));
            self.words = if is_title { "" } else { text }.split_whitespace();
        }
    }

    fn expect(&mut self, words: &[&str]) -> Result<(), String> {
        for expected in words {
            match self.word() {
                Some(word) if word.eq_ignore_ascii_case(expected) => {}
                Some(word) => {
                    let line = self.line;
                    return Err(format!(
                        "line {line} has `{word}` where `{expected}` stands"
                    ));
                }
                None => return Err(format!("it ends where `{expected}` stands")),
            }
        }
        Ok(())
    }

    fn numbers(&mut self) -> Result<[f64; 3], String> {
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            let word = self.word().ok_or("it ends where a number stands")?;
            let line = self.line;
            *number = word
                .parse()
                .map_err(|_| format!("line {line} has `{word}` where a number stands"))?;
        }
        Ok(numbers)
    }

    fn triangle(&mut self) -> Result<Corners, String> {
        self.expect(&["normal"])?;
        self.numbers()?;
        self.expect(&["outer", "loop"])?;
        let mut corners = Corners::default();
        for corner in &mut corners {
            self.expect(&["vertex"])?;
            *corner = self.numbers()?;
        }
        self.expect(&["endloop", "endfacet"])?;
        Ok(corners)
    }
}

impl Iterator for Text<'_> {
    type Item = Result<Corners, String>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.word()? {
            word if word.eq_ignore_ascii_case("facet") => Some(self.triangle()),
            word => Some(Err(format!(
                "line {} has `{word}` where `facet` stands",
                self.line
            ))),
        }
    }
}

fn announced(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(BINARY_HEADER - 4..BINARY_HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

fn binary_size(count: usize) -> Option<usize> {
    count
        .checked_mul(BINARY_TRIANGLE)?
        .checked_add(BINARY_HEADER)
}

/// The number of triangles of a binary file.
fn check_binary(bytes: &[u8], announced: Option<usize>, path: &str) -> Result<usize, StlError> {
    let path = path.to_owned();
    let Some(announced) = announced else {
        let detail = "too short for the header of the binary form, and no text form".to_owned();
        return Err(StlError::Syntax { path, detail });
    };
    let found = (bytes.len() - BINARY_HEADER) / BINARY_TRIANGLE;
    match found {
        _ if announced == 0 => Err(StlError::Empty { path }),
        _ if found < announced => Err(StlError::Truncated {
            path,
            announced,
            found,
        }),
        _ if announced > MAX_STL_TRIANGLES => Err(StlError::TooLarge { path }),
        _ => Ok(announced),
    }
}

fn collect(
    triangles: impl Iterator<Item = Result<Corners, String>>,
    path: String,
) -> Result<TriangleSoup, StlError> {
    let mut soup = TriangleSoup {
        source: path.clone(),
        vertices: Vec::new(),
        triangles: Vec::new(),
        is_surface: false,
    };
    let mut index_of: HashMap<[u64; 3], u32> = HashMap::new();
    for triangle in triangles {
        let corners = triangle.map_err(|detail| StlError::Syntax {
            path: path.clone(),
            detail,
        })?;
        if soup.triangles.len() == MAX_STL_TRIANGLES {
            return Err(StlError::TooLarge { path });
        }
        if corners.iter().flatten().any(|c| !c.is_finite()) {
            let triangle = soup.triangles.len() + 1;
            return Err(StlError::NotFinite { path, triangle });
        }
        soup.triangles.push(corners.map(|corner| {
            // Adding zero makes -0 into 0.
            *index_of
                .entry(corner.map(|c| (c + 0.0).to_bits()))
                .or_insert_with(|| {
                    soup.vertices.push(DVec3::from(corner));
                    (soup.vertices.len() - 1) as u32
                })
        }));
    }
    if soup.triangles.is_empty() {
        return Err(StlError::Empty { path });
    }
    Ok(soup)
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
            Err(StlError::Truncated {
                announced: 0xffff_ffff,
                found: 1,
                ..
            })
        ));
        let mut nan = ONE;
        nan[1][2] = f32::NAN;
        assert!(matches!(
            read(&binary(b"", 2, &[ONE, nan])),
            Err(StlError::NotFinite { triangle: 2, .. })
        ));
    }
}
