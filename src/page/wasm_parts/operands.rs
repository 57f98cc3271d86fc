//! What follows each operation of WebAssembly.

/// An integer of many bytes is written as this operation, which no file has.
pub(super) const ADDRESS: u8 = 0x06;

/// Operations of two parts: those on blocks of memory, and those on four lanes.
pub(super) const PREFIXES: [u8; 2] = [0xfc, 0xfd];

/// Operations whose second part is below this number.
pub(super) const SECONDS: usize = 256;

/// What follows an operation. The numbers are known to the page.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Operands {
    Unknown,
    None,
    Block,
    End,
    Label,
    /// A number of labels, they, and one more.
    Labels,
    Call,
    Read,
    Write,
    Global,
    /// Alignment and offset.
    Memory,
    /// The same and a lane.
    MemoryLane,
    Integer,
    Long,
    Float,
    Double,
    Vector,
    /// Other numbers, so many.
    One,
    Two,
    /// A number of types, and they.
    Types,
    Lane,
    /// The operation's second part.
    Second,
    /// An integer of many bytes.
    Address,
}

/// Operands of the operations from one number to another, both included.
const PLAIN: &[(u8, u8, Operands)] = &[
    (0x00, 0x01, Operands::None),
    (0x02, 0x04, Operands::Block),
    (0x05, 0x05, Operands::None),
    (ADDRESS, ADDRESS, Operands::Address),
    (0x0b, 0x0b, Operands::End),
    (0x0c, 0x0d, Operands::Label),
    (0x0e, 0x0e, Operands::Labels),
    (0x0f, 0x0f, Operands::None),
    (0x10, 0x10, Operands::Call),
    (0x11, 0x11, Operands::Two),
    (0x1a, 0x1b, Operands::None),
    (0x1c, 0x1c, Operands::Types),
    (0x20, 0x20, Operands::Read),
    (0x21, 0x22, Operands::Write),
    (0x23, 0x24, Operands::Global),
    (0x25, 0x26, Operands::One),
    (0x28, 0x3e, Operands::Memory),
    (0x3f, 0x40, Operands::One),
    (0x41, 0x41, Operands::Integer),
    (0x42, 0x42, Operands::Long),
    (0x43, 0x43, Operands::Float),
    (0x44, 0x44, Operands::Double),
    (0x45, 0xc4, Operands::None),
    (0xd0, 0xd0, Operands::One),
    (0xd1, 0xd1, Operands::None),
    (0xd2, 0xd2, Operands::One),
    (0xfc, 0xfd, Operands::Second),
];

/// The same behind the prefixes.
const SECOND: [&[(u8, u8, Operands)]; 2] = [
    &[
        (0, 7, Operands::None),
        (8, 8, Operands::Two),
        (9, 9, Operands::One),
        (10, 10, Operands::Two),
        (11, 11, Operands::One),
        (12, 12, Operands::Two),
        (13, 13, Operands::One),
        (14, 14, Operands::Two),
        (15, 17, Operands::One),
    ],
    &[
        (0, 11, Operands::Memory),
        (12, 13, Operands::Vector),
        (14, 20, Operands::None),
        (21, 34, Operands::Lane),
        (35, 83, Operands::None),
        (84, 91, Operands::MemoryLane),
        (92, 93, Operands::Memory),
        (94, 255, Operands::None),
    ],
];

/// The first plain load.
const FIRST_LOAD: usize = 0x28;

/// Natural alignment of plain loads and stores, as powers of two.
const NATURAL: [u8; 23] = [
    2, 3, 2, 3, 0, 0, 1, 1, 0, 0, 1, 1, 2, 2, 2, 3, 2, 3, 0, 1, 0, 1, 2,
];

/// Natural alignment is written this many bits above the operands.
const ABOVE: u32 = 5;

/// What follows an operation, and its natural alignment.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    pub operands: Operands,
    pub natural: u8,
}

/// Entries of all operations: plain ones, then those behind each prefix.
pub(super) struct OperandTable(pub [[Entry; SECONDS]; 3]);

impl OperandTable {
    pub fn new() -> Self {
        let unknown = Entry {
            operands: Operands::Unknown,
            natural: 0,
        };
        let mut table = [[unknown; SECONDS]; 3];
        for (row, ranges) in table.iter_mut().zip([PLAIN, SECOND[0], SECOND[1]]) {
            for (first, last, operands) in ranges {
                let entries = &mut row[usize::from(*first)..=usize::from(*last)];
                entries.iter_mut().for_each(|e| e.operands = *operands);
            }
        }
        for (entry, natural) in table[0][FIRST_LOAD..].iter_mut().zip(NATURAL) {
            entry.natural = natural;
        }
        Self(table)
    }

    /// A byte for each.
    pub fn bytes(&self) -> impl Iterator<Item = u8> + '_ {
        let entries = self.0.as_flattened().iter();
        entries.map(|entry| entry.operands as u8 | entry.natural << ABOVE)
    }
}
