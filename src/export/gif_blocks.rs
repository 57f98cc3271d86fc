//! The byte layout of a GIF around the compressed pixels. Source: GIF89a specification, CompuServe 1990.

use super::delta::Area;

/// Last byte of the file.
pub(super) const TRAILER: [u8; 1] = [0x3b];

/// Signature, screen of `size` pixels, global table of 2^`bits` colours (1 to 8), and, to play without end, the
/// loop extension that every viewer knows by Netscape's name.
pub(super) fn header(size: [u16; 2], colours: &[[u8; 3]], bits: u8, repeat: bool) -> Vec<u8> {
    let mut bytes = b"GIF89a".to_vec();
    bytes.extend(size.iter().flat_map(|s| s.to_le_bytes()));
    // Global table present, 8 bits a channel in the source; background colour 0, pixels square.
    bytes.extend([0b1111_0000 | (bits - 1), 0, 0]);
    bytes.extend(colours.iter().flatten());
    let unused = (1usize << bits).saturating_sub(colours.len());
    bytes.resize(bytes.len() + 3 * unused, 0);
    if repeat {
        bytes.extend(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\0\0\0");
    }
    bytes
}

/// Graphic control: leave the picture in place afterwards, `delay` hundredths, one transparent index.
pub(super) fn control(delay: u16, transparent: u8) -> [u8; 8] {
    let [low, high] = delay.to_le_bytes();
    [0x21, 0xf9, 4, 0b0000_0101, low, high, transparent, 0]
}

/// Image descriptor: where the pixels that follow go; no table of its own.
pub(super) fn descriptor(area: &Area) -> [u8; 10] {
    let mut bytes = [0x2c, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    let values = [area.left, area.top, area.width, area.height];
    for (place, value) in bytes[1..9].chunks_exact_mut(2).zip(values) {
        place.copy_from_slice(&(value as u16).to_le_bytes());
    }
    bytes
}
