//! What is read from STL files, and how the others are refused.
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
    // A count of four thousand million must not be trusted.
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

/// A path may point to any file of the user: nothing of its content is shown.
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
