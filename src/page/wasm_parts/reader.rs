//! Numbers and bytes of a WebAssembly file, one after the other.

/// A file read from its beginning.
pub(super) struct WasmReader<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
}

impl<'a> WasmReader<'a> {
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.bytes.get(self.at..self.at.checked_add(count)?)?;
        self.at += count;
        Some(taken)
    }

    pub fn byte(&mut self) -> Option<u8> {
        self.take(1).map(|taken| taken[0])
    }

    /// The bytes of a number.
    pub fn number_bytes(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..)?;
        let last = rest.iter().position(|byte| byte & 0x80 == 0)?;
        self.take(last + 1)
    }

    /// A number without a sign; none if it could be written in fewer bytes.
    pub fn number(&mut self) -> Option<usize> {
        let bytes = self.number_bytes()?;
        let digits = bytes.iter().rev().map(|byte| usize::from(byte & 0x7f));
        let number = digits.fold(0, |sum, digit| sum << 7 | digit);
        let mut written = Vec::new();
        push_number(&mut written, number);
        (written == bytes).then_some(number)
    }
}

pub(super) fn push_number(list: &mut Vec<u8>, mut number: usize) {
    while number > 0x7f {
        list.push(0x80 | (number & 0x7f) as u8);
        number >>= 7;
    }
    list.push(number as u8);
}
