//! LZW as used by GIF: the dictionary and the bit stream. [`super::string_search`] chooses the strings.
//!
//! It is our own because choosing among several admissible pixel values needs the dictionary itself, which encoder
//! crates do not expose.

/// Codes a dictionary can hold.
const CODES: usize = 4096;

/// Symbols of at most 8 bits.
const SYMBOLS: usize = 256;

/// No node: the root codes come first, so 0 is never a child.
pub(super) const NONE: u16 = 0;

/// A node's next sibling and its own symbol, together because they are read together.
#[derive(Clone, Copy)]
struct SiblingLink {
    sibling: u16,
    symbol: u8,
}

/// The strings known to the decoder, as a tree. Node numbers are codes.
pub(super) struct Dictionary {
    first_child: Box<[u16; CODES]>,
    links: Box<[SiblingLink; CODES]>,
    parent: Box<[u16; CODES]>,
    /// Children of the one-symbol strings by both symbols: there are too many for a list.
    pairs: Box<[[u16; SYMBOLS]; SYMBOLS]>,
    /// The child for the symbol that continues the longest runs, of every node.
    run_child: Box<[u16; CODES]>,
    /// The strings of the run symbol alone, by length less one.
    runs: Vec<u16>,
    run_symbol: u8,
    root_bits: u8,
    next: u16,
    width: u8,
}

impl Dictionary {
    /// An empty dictionary for symbols of `root_bits` bits (2 to 8).
    pub(super) fn new(root_bits: u8, run_symbol: u8) -> Self {
        let mut dictionary = Self {
            first_child: Box::new([NONE; CODES]),
            links: Box::new(
                [SiblingLink {
                    sibling: NONE,
                    symbol: 0,
                }; CODES],
            ),
            parent: Box::new([0; CODES]),
            pairs: Box::new([[NONE; SYMBOLS]; SYMBOLS]),
            run_child: Box::new([NONE; CODES]),
            runs: Vec::new(),
            run_symbol,
            root_bits,
            next: 0,
            width: 0,
        };
        dictionary.reset();
        dictionary
    }

    /// Removes all strings of more than one symbol.
    pub(super) fn reset(&mut self) {
        let first = usize::from(self.end_code()) + 1;
        for node in first..usize::from(self.next) {
            if self.is_root(self.parent[node]) {
                self.pairs[usize::from(self.parent[node])][usize::from(self.links[node].symbol)] =
                    NONE;
            }
        }
        self.first_child.fill(NONE);
        self.run_child.fill(NONE);
        self.runs.clear();
        self.runs.push(u16::from(self.run_symbol));
        self.next = first as u16;
        self.width = self.root_bits + 1;
    }

    /// Size in bits of the symbols.
    pub(super) fn root_bits(&self) -> u8 {
        self.root_bits
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

    /// Whether the dictionary is full.
    pub(super) fn is_full(&self) -> bool {
        usize::from(self.next) >= CODES
    }

    /// True for a string of one symbol.
    #[inline]
    pub(super) fn is_root(&self, node: u16) -> bool {
        node < self.clear_code()
    }

    /// Adds the string of `parent` followed by `symbol`; does nothing when full. Strings may come twice; either serves.
    #[inline]
    pub(super) fn add(&mut self, parent: u16, symbol: u8) {
        if self.is_full() {
            return;
        }
        let (node, above) = (usize::from(self.next), usize::from(parent) % CODES);
        self.links[node] = SiblingLink {
            sibling: self.first_child[above],
            symbol,
        };
        self.parent[node] = parent;
        self.first_child[above] = self.next;
        if self.is_root(parent) {
            self.pairs[above % SYMBOLS][usize::from(symbol)] = self.next;
        }
        if symbol == self.run_symbol {
            self.run_child[above] = self.next;
            if self.runs.last() == Some(&parent) {
                self.runs.push(self.next);
            }
        }
        // The decoder is one string behind, so the width grows when the number is given, not when it is used.
        if self.next == 1 << self.width {
            self.width += 1;
        }
        self.next += 1;
    }

    /// First child of `node`, or `NONE`.
    #[inline]
    pub(super) fn first_child(&self, node: u16) -> u16 {
        self.first_child[usize::from(node) % CODES]
    }

    /// The child after `node` of the same parent, or `NONE`, and the symbol of `node`.
    #[inline]
    pub(super) fn sibling(&self, node: u16) -> (u16, u8) {
        let link = self.links[usize::from(node) % CODES];
        (link.sibling, link.symbol)
    }

    /// The child of `node` for the run symbol, or `NONE`.
    #[inline]
    pub(super) fn run_child(&self, node: u16) -> u16 {
        self.run_child[usize::from(node) % CODES]
    }

    /// True when `node` is `length` times the run symbol.
    #[inline]
    pub(super) fn is_run(&self, node: u16, length: usize) -> bool {
        self.runs.get(length.wrapping_sub(1)) == Some(&node)
    }

    /// The longest string of the run symbol alone with at most `length` of it, and how many it has; `length` is 1
    /// or more.
    #[inline]
    pub(super) fn run(&self, length: usize) -> (u16, usize) {
        let length = length.clamp(1, self.runs.len());
        (self.runs[length - 1], length)
    }

    /// The child of the root `node` for `symbol`, or `NONE`.
    #[inline]
    pub(super) fn pair(&self, node: u16, symbol: u8) -> u16 {
        self.pairs[usize::from(node) % SYMBOLS][usize::from(symbol)]
    }

    /// Writes the symbols of the string `node` to the end of `symbols`, last symbol last.
    pub(super) fn spell_string(&self, mut node: u16, symbols: &mut [u8]) {
        for symbol in symbols.iter_mut().rev() {
            if self.is_root(node) {
                *symbol = node as u8;
                return;
            }
            *symbol = self.links[usize::from(node) % CODES].symbol;
            node = self.parent[usize::from(node) % CODES];
        }
    }
}

/// Codes of varying width, least significant bit first.
pub(super) struct BitWriter<'a> {
    out: &'a mut Vec<u8>,
    bits: u64,
    filled: u32,
}

impl<'a> BitWriter<'a> {
    /// Starts a stream at the end of `out`.
    pub(super) fn new(out: &'a mut Vec<u8>) -> Self {
        Self {
            out,
            bits: 0,
            filled: 0,
        }
    }

    /// Appends the lowest `width` bits of `code`.
    #[inline]
    pub(super) fn put(&mut self, code: u16, width: u8) {
        self.bits |= u64::from(code) << self.filled;
        self.filled += u32::from(width);
        while self.filled >= 8 {
            self.push_byte();
        }
    }

    #[inline]
    fn push_byte(&mut self) {
        self.out.push(self.bits as u8);
        self.bits >>= 8;
        self.filled = self.filled.saturating_sub(8);
    }

    /// Flushes the last bits.
    pub(super) fn finish(mut self) {
        if self.filled > 0 {
            self.push_byte();
        }
    }
}
