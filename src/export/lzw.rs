//! LZW as GIF wants it: the dictionary, the bit stream, and the plain encoder.
//!
//! Written here because choosing among several admissible pixel values (see [`super::matching`]) needs the
//! dictionary itself, which encoder crates keep to themselves.

/// Codes a dictionary can hold.
const CODES: usize = 4096;

/// No node: the root codes come first, so 0 is never a child.
pub(super) const NONE: u16 = 0;

/// The strings an encoder has told its decoder about, as a tree. Node numbers are codes.
pub(super) struct Dictionary {
    first_child: Box<[u16; CODES]>,
    sibling: Box<[u16; CODES]>,
    symbol: Box<[u8; CODES]>,
    root_bits: u8,
    next: u16,
    width: u8,
}

impl Dictionary {
    pub(super) fn new() -> Self {
        Self {
            first_child: Box::new([NONE; CODES]),
            sibling: Box::new([NONE; CODES]),
            symbol: Box::new([0; CODES]),
            root_bits: 8,
            next: 0,
            width: 0,
        }
    }

    /// Empties the dictionary down to the symbols of `root_bits` bits.
    pub(super) fn reset(&mut self, root_bits: u8) {
        self.first_child.fill(NONE);
        self.root_bits = root_bits;
        self.next = (1 << root_bits) + 2;
        self.width = root_bits + 1;
    }

    /// The code that empties the dictionary.
    pub(super) fn clear_code(&self) -> u16 {
        1 << self.root_bits
    }

    /// The code that ends the stream.
    pub(super) fn end_code(&self) -> u16 {
        self.clear_code() + 1
    }

    /// Bits of the next code.
    pub(super) fn width(&self) -> u8 {
        self.width
    }

    /// Number the next string will get; 4096 when the dictionary is full.
    pub(super) fn next_code(&self) -> u16 {
        self.next
    }

    pub(super) fn is_full(&self) -> bool {
        usize::from(self.next) >= CODES
    }

    /// Adds the string of `parent` followed by `symbol`; does nothing when full.
    #[inline]
    pub(super) fn add(&mut self, parent: u16, symbol: u8) {
        if self.is_full() {
            return;
        }
        let node = usize::from(self.next);
        self.symbol[node] = symbol;
        self.sibling[node] = self.first_child[usize::from(parent) % CODES];
        self.first_child[usize::from(parent) % CODES] = self.next;
        if self.next == 1 << self.width {
            self.width += 1;
        }
        self.next += 1;
    }

    /// First child of `node`, or `NONE`.
    #[inline]
    pub(super) fn children(&self, node: u16) -> u16 {
        self.first_child[usize::from(node) % CODES]
    }

    /// The child after `node` of the same parent, or `NONE`, and the symbol of `node`.
    #[inline]
    pub(super) fn sibling(&self, node: u16) -> (u16, u8) {
        let node = usize::from(node) % CODES;
        (self.sibling[node], self.symbol[node])
    }

    /// The child of `node` for `symbol`, or `NONE`.
    #[inline]
    pub(super) fn child(&self, node: u16, symbol: u8) -> u16 {
        let mut child = self.children(node);
        while child != NONE {
            let (next, found) = self.sibling(child);
            if found == symbol {
                break;
            }
            child = next;
        }
        child
    }
}

/// Codes of varying width, least significant bit first, in GIF's sub-blocks of up to 255 bytes.
pub(super) struct BitWriter<'a> {
    out: &'a mut Vec<u8>,
    bits: u64,
    filled: u32,
    /// Where the length byte of the open sub-block stands.
    block: usize,
}

impl<'a> BitWriter<'a> {
    /// Starts a stream at the end of `out`.
    pub(super) fn new(out: &'a mut Vec<u8>) -> Self {
        let block = out.len();
        out.push(0);
        Self {
            out,
            bits: 0,
            filled: 0,
            block,
        }
    }

    /// Appends the lowest `width` bits of `code`.
    #[inline]
    pub(super) fn put(&mut self, code: u16, width: u8) {
        self.bits |= u64::from(code) << self.filled;
        self.filled += u32::from(width);
        while self.filled >= 8 {
            self.byte();
        }
    }

    #[inline]
    fn byte(&mut self) {
        self.out.push(self.bits as u8);
        self.bits >>= 8;
        self.filled = self.filled.saturating_sub(8);
        if self.out.len() - self.block > 255 {
            self.out[self.block] = 255;
            self.block = self.out.len();
            self.out.push(0);
        }
    }

    /// Flushes the last bits and ends the chain of sub-blocks.
    pub(super) fn finish(mut self) {
        if self.filled > 0 {
            self.byte();
        }
        let length = self.out.len() - self.block - 1;
        self.out[self.block] = length as u8;
        if length > 0 {
            self.out.push(0);
        }
    }
}

/// Appends to `out` the LZW code size byte and the coded `pixels`, all of them below `2^root_bits`.
pub(super) fn encode(dictionary: &mut Dictionary, root_bits: u8, pixels: &[u8], out: &mut Vec<u8>) {
    out.push(root_bits);
    let mut bits = BitWriter::new(out);
    dictionary.reset(root_bits);
    bits.put(dictionary.clear_code(), dictionary.width());
    let mut pixels = pixels.iter().copied();
    if let Some(first) = pixels.next() {
        let mut node = u16::from(first);
        for pixel in pixels {
            let child = dictionary.child(node, pixel);
            if child != NONE {
                node = child;
                continue;
            }
            bits.put(node, dictionary.width());
            if dictionary.is_full() {
                bits.put(dictionary.clear_code(), dictionary.width());
                dictionary.reset(root_bits);
            } else {
                dictionary.add(node, pixel);
            }
            node = u16::from(pixel);
        }
        bits.put(node, dictionary.width());
        // The decoder adds an entry here as well, which may widen the end code.
        dictionary.add(node, 0);
    }
    bits.put(dictionary.end_code(), dictionary.width());
    bits.finish();
}
