//! Bytes as text of a page, as few characters as is practical: LZMA, which takes a quarter less than what browsers unpack
//! themselves, in printable characters. `web/unpack.js` reads it.

use lzma_rust2::{LzmaOptions, LzmaWriter};
use std::io::{self, Write};

/// Nine bytes are one number below 94^11: so many printable characters, all but `<`, which ends scripts. Base64 would take twelve.
const CHARACTERS: usize = 11;

/// Bytes of a number.
const BYTES: usize = 9;

/// The smallest window of the format. Larger ones hold everything, as the page does.
const LEAST_WINDOW: usize = 1 << 12;

/// The text of packed bytes.
///
/// Errors: more bytes than the format's window, 4 GiB.
pub(super) fn packed_text(bytes: &[u8]) -> io::Result<String> {
    Ok(printable(&compressed(bytes)?))
}

/// A .lzma file with its length. Context is worth more than alignment in code and in numbers of any width.
fn compressed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let window = u32::try_from(bytes.len().max(LEAST_WINDOW)).map_err(io::Error::other)?;
    let mut options = LzmaOptions::with_preset(9);
    (options.lc, options.lp, options.pb) = (4, 0, 0);
    (options.dict_size, options.nice_len) = (window, LzmaOptions::NICE_LEN_MAX);
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(bytes.len() as u64))?;
    writer.write_all(bytes)?;
    writer.finish()
}

/// Eleven characters for every nine bytes, the first of them highest; zeros fill the last nine.
fn printable(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(BYTES) * CHARACTERS);
    for block in bytes.chunks(BYTES) {
        let byte = |k: usize| u128::from(block.get(k).copied().unwrap_or(0));
        let mut number = (0..BYTES).fold(0, |number, k| number << 8 | byte(k));
        let mut characters = [' '; CHARACTERS];
        for character in characters.iter_mut().rev() {
            let code = b' ' + (number % 94) as u8;
            *character = char::from(code + u8::from(code >= b'<'));
            number /= 94;
        }
        text.extend(characters);
    }
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use std::io::Read;

    /// The bytes that a text of printable characters stands for, with the zeros that fill the last number.
    fn bytes_of(text: &str) -> Vec<u8> {
        let digit = |code: &u8| u128::from(code - if *code > b'<' { 33 } else { 32 });
        let blocks = text.as_bytes().chunks(CHARACTERS);
        let numbers = blocks.map(|block| block.iter().fold(0, |n, code| n * 94 + digit(code)));
        numbers
            .flat_map(|n: u128| n.to_be_bytes()[16 - BYTES..].to_vec())
            .collect()
    }

    #[test]
    fn what_is_packed_is_read_again() {
        let noise = |k: u32| (k.wrapping_mul(2_654_435_761) >> 13) as u8;
        let long: Vec<u8> = (0..50_000).map(noise).chain([7; 10_000]).collect();
        for bytes in [&b""[..], b"a", b"exactly 9", &[255; 100], &[0; 27], &long] {
            let text = packed_text(bytes).unwrap();
            let is_fit = |c: char| (' '..='~').contains(&c) && c != '<';
            assert!(text.chars().all(is_fit));
            let packed = bytes_of(&text);
            let mut reader =
                lzma_rust2::LzmaReader::new_mem_limit(&packed[..], u32::MAX, None).unwrap();
            let mut read = Vec::new();
            reader.read_to_end(&mut read).unwrap();
            assert_eq!(read, bytes);
        }
    }
}
