//! Bytes as text of a page, as few characters as is practical: LZMA, which takes a quarter less than what browsers unpack
//! themselves, in characters. `web/unpack.js` reads it.

use lzma_rust2::{LzmaOptions, LzmaWriter};
use std::io::{self, Write};

/// Eleven bytes are a number of thirteen digits below this base. It is the base whose digits take a byte each in UTF-8: the
/// first 94 are the printable characters of ASCII but `<`, which ends scripts; each of the others makes one character of two
/// bytes with the digit that follows. Base64 would take 15 bytes.
const BASE: u128 = 111;

/// Digits that are characters of their own.
const SINGLE: u32 = 94;

/// The characters of two bytes begin here: 17 times 111 of them are used, up to the last one of two bytes.
const FIRST_PAIR: u32 = 0xa0;

/// Digits of a number.
const DIGITS: usize = 13;

/// Bytes of a number.
const BYTES: usize = 11;

/// The smallest window of the format. Larger ones hold everything, as the page does.
const LEAST_WINDOW: usize = 1 << 12;

/// The text of packed bytes.
///
/// Errors: more bytes than the format's window, 4 GiB.
pub(super) fn packed_text(bytes: &[u8]) -> io::Result<String> {
    Ok(printable(&compressed(bytes)?))
}

/// A .lzma file with its length. Alignment says nothing about numbers of any width, and the
/// byte before little.
fn compressed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let window = u32::try_from(bytes.len().max(LEAST_WINDOW)).map_err(io::Error::other)?;
    let mut options = LzmaOptions::with_preset(9);
    (options.lc, options.lp, options.pb) = (2, 0, 0);
    (options.dict_size, options.nice_len) = (window, LzmaOptions::NICE_LEN_MAX);
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(bytes.len() as u64))?;
    writer.write_all(bytes)?;
    writer.finish()
}

/// Thirteen digits for every eleven bytes, the first of them highest; zeros fill the last eleven.
fn printable(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(BYTES) * DIGITS);
    let mut opened = None;
    for block in bytes.chunks(BYTES) {
        for digit in digits_of(block) {
            let code = match opened.take() {
                Some(first) => FIRST_PAIR + (first - SINGLE) * BASE as u32 + digit,
                None if digit < SINGLE => single(digit),
                None => {
                    opened = Some(digit);
                    continue;
                }
            };
            text.extend(char::from_u32(code));
        }
    }
    if let Some(first) = opened {
        text.extend(char::from_u32(FIRST_PAIR + (first - SINGLE) * BASE as u32));
    }
    text
}

/// The character of a digit that needs no other.
fn single(digit: u32) -> u32 {
    let code = u32::from(b' ') + digit;
    code + u32::from(code >= u32::from(b'<'))
}

fn digits_of(block: &[u8]) -> [u32; DIGITS] {
    let byte = |k: usize| u128::from(block.get(k).copied().unwrap_or(0));
    let mut number = (0..BYTES).fold(0, |number, k| number << 8 | byte(k));
    let mut digits = [0; DIGITS];
    for digit in digits.iter_mut().rev() {
        *digit = (number % BASE) as u32;
        number /= BASE;
    }
    digits
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use std::io::Read;

    /// The bytes that a text of digits stands for, with the zeros that fill the last number.
    fn bytes_of(text: &str) -> Vec<u8> {
        let digits: Vec<u128> = text
            .chars()
            .flat_map(|character| match u32::from(character) {
                code if code >= FIRST_PAIR => {
                    let pair = u128::from(code - FIRST_PAIR);
                    vec![u128::from(SINGLE) + pair / BASE, pair % BASE]
                }
                code => vec![u128::from(code - if code > 60 { 33 } else { 32 })],
            })
            .collect();
        let blocks = digits.chunks_exact(DIGITS);
        let numbers = blocks.map(|block| block.iter().fold(0, |n, digit| n * BASE + digit));
        numbers
            .flat_map(|n: u128| n.to_be_bytes()[16 - BYTES..].to_vec())
            .collect()
    }

    #[test]
    fn what_is_packed_is_read_again() {
        let noise = |k: u32| (k.wrapping_mul(2_654_435_761) >> 13) as u8;
        let long: Vec<u8> = (0..50_000).map(noise).chain([7; 10_000]).collect();
        for bytes in [&b""[..], b"a", b"exactly 11.", &[255; 100], &[0; 27], &long] {
            let text = packed_text(bytes).unwrap();
            let is_fit = |c: char| {
                (' '..='~').contains(&c) && c != '<' || ('\u{a0}'..='\u{7ff}').contains(&c)
            };
            assert!(text.chars().all(is_fit));
            let numbers = printable(bytes);
            assert!(numbers.len() <= bytes.len().div_ceil(BYTES) * DIGITS + 1);
            let packed = bytes_of(&text);
            let mut reader =
                lzma_rust2::LzmaReader::new_mem_limit(&packed[..], u32::MAX, None).unwrap();
            let mut read = Vec::new();
            reader.read_to_end(&mut read).unwrap();
            assert_eq!(read, bytes);
        }
    }
}
