//! The text form of STL.

use super::binary::FacetCorners;
use std::io::{BufRead, Read};
use std::ops::Range;

/// Longest line.
const LONGEST_LINE: u64 = 1 << 20;

/// The triangles of the text form. Messages do not repeat the content of the file, which may be a private file and not
/// an STL at all.
pub(super) struct StlText<R> {
    file: R,
    /// The current line, and the position of its next word.
    bytes: Vec<u8>,
    at: usize,
    line: usize,
}

impl<R: BufRead> StlText<R> {
    pub(super) fn new(file: R) -> Self {
        Self {
            file,
            bytes: Vec::new(),
            at: 0,
            line: 0,
        }
    }

    /// The next word, without the titles of solids. `None` at the end.
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
        // Nothing in a text form is that long: the file is something else.
        if count as u64 == LONGEST_LINE {
            return Err(format!(
                "line {} is longer than {LONGEST_LINE} bytes",
                self.line
            ));
        }
        // The title behind `solid` is free text, which may contain any word.
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

    fn expect_words(&mut self, words: &[&str]) -> Result<(), String> {
        for expected in words {
            let word = self
                .word()?
                .ok_or_else(|| format!("it ends where `{expected}` is expected"))?;
            if !self.bytes[word].eq_ignore_ascii_case(expected.as_bytes()) {
                return Err(format!("line {}: `{expected}` is expected", self.line));
            }
        }
        Ok(())
    }

    fn numbers(&mut self) -> Result<[f64; 3], String> {
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            let word = self.word()?.ok_or("it ends where a number is expected")?;
            let word = std::str::from_utf8(&self.bytes[word]).unwrap_or_default();
            let value = word.parse();
            *number = value.map_err(|_| format!("line {}: a number is expected", self.line))?;
        }
        Ok(numbers)
    }

    fn read_triangle(&mut self) -> Result<FacetCorners, String> {
        self.expect_words(&["normal"])?;
        self.numbers()?;
        self.expect_words(&["outer", "loop"])?;
        let mut corners = FacetCorners::default();
        for corner in &mut corners {
            self.expect_words(&["vertex"])?;
            *corner = self.numbers()?;
        }
        self.expect_words(&["endloop", "endfacet"])?;
        Ok(corners)
    }
}

impl<R: BufRead> Iterator for StlText<R> {
    type Item = Result<FacetCorners, String>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.word() {
            Err(error) => Some(Err(error)),
            Ok(None) => None,
            Ok(Some(word)) if self.bytes[word.clone()].eq_ignore_ascii_case(b"facet") => {
                Some(self.read_triangle())
            }
            Ok(Some(_)) => Some(Err(format!("line {}: `facet` is expected", self.line))),
        }
    }
}
