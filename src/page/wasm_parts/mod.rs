//! A WebAssembly file with its parts sorted by kind: operations by operations, constants by constants. Packed, they are a
//! seventh smaller than in their order, and nothing is lost. `web/assemble.js` puts them together again; what follows
//! each operation travels with them as a table.
//!
//! Binary format of WebAssembly 2.0, sections 5.4 (instructions) and 5.5 (modules).

mod operands;
mod reader;

use operands::{ADDRESS, Entry, OperandTable, Operands, PREFIXES};
use reader::{WasmReader, push_number};

/// The first byte of a sorted file. A plain one begins with zero.
const SORTED: u8 = 1;

/// Version and magic number come before the sections.
const HEAD: usize = 8;

/// Which section holds the functions' bodies.
const CODE: u8 = 10;

/// An addition, before which constants are mostly offsets.
const ADD: u8 = 0x6a;

/// An integer of so many bytes is most likely an address.
const MANY: usize = 4;

/// Natural alignment of numbers of eight bytes.
const WIDE: u8 = 3;

/// A function has fewer local variables.
const MOST_LOCALS: usize = 50_000;

/// Lists of parts.
const KINDS: usize = 18;

/// The kinds of parts, in the order of their lists.
#[derive(Clone, Copy)]
enum PartKind {
    /// Everything but the bodies of functions.
    Rest,
    /// Types of local variables.
    Declarations,
    Operations,
    Blocks,
    Labels,
    Calls,
    /// How many others were used since the last use of a local variable that is read.
    Reads,
    /// The same of one that is written.
    Writes,
    Globals,
    /// By how much alignment is less than natural, of numbers of up to four bytes.
    Alignments,
    /// The same of longer ones.
    WideAlignments,
    Offsets,
    /// Integers of many bytes, most of them addresses.
    Addresses,
    /// Others to which something is added.
    Addends,
    Integers,
    Longs,
    Floats,
    Others,
}

/// The lists of parts, as they grow.
struct SortedParts {
    lists: [Vec<u8>; KINDS],
    table: OperandTable,
    /// Local variables of the present function, the last used one first. Behind these are all others in their order.
    recent: Vec<usize>,
}

/// The same file with its parts sorted; `None` if it is not as compilers write it.
pub(super) fn sorted_parts(file: &[u8]) -> Option<Vec<u8>> {
    let mut reader = WasmReader {
        bytes: file,
        at: HEAD,
    };
    loop {
        let start = reader.at;
        let section = reader.byte()?;
        let length = reader.number()?;
        let body = reader.take(length)?;
        if section == CODE {
            let rest = [&file[..start], &file[reader.at..]].concat();
            let section = WasmReader { bytes: body, at: 0 };
            return SortedParts::new(rest).sorted([file.len(), start], section);
        }
    }
}

impl SortedParts {
    fn new(rest: Vec<u8>) -> Self {
        let mut lists: [Vec<u8>; KINDS] = Default::default();
        lists[PartKind::Rest as usize] = rest;
        Self {
            lists,
            table: OperandTable::new(),
            recent: Vec::new(),
        }
    }

    /// Of the file's length, and the place where the section begins in it.
    fn sorted(mut self, of_file: [usize; 2], mut section: WasmReader) -> Option<Vec<u8>> {
        let functions = section.number()?;
        for _ in 0..functions {
            let length = section.number()?;
            let bytes = section.take(length)?;
            self.sort_function(&mut WasmReader { bytes, at: 0 })?;
        }
        let mut sorted = vec![SORTED];
        for number in of_file.into_iter().chain([functions]) {
            push_number(&mut sorted, number);
        }
        for list in &self.lists {
            push_number(&mut sorted, list.len());
        }
        sorted.extend(self.table.bytes());
        sorted.extend(self.lists.concat());
        (section.at == section.bytes.len()).then_some(sorted)
    }

    fn list(&mut self, kind: PartKind) -> &mut Vec<u8> {
        &mut self.lists[kind as usize]
    }

    fn move_number(&mut self, kind: PartKind, body: &mut WasmReader) -> Option<()> {
        self.list(kind).extend_from_slice(body.number_bytes()?);
        Some(())
    }

    fn move_bytes(&mut self, kind: PartKind, body: &mut WasmReader, count: usize) -> Option<()> {
        self.list(kind).extend_from_slice(body.take(count)?);
        Some(())
    }

    /// Moves a number of items, and them.
    fn move_list(&mut self, kind: PartKind, body: &mut WasmReader, more: usize) -> Option<()> {
        let count = body.number()?;
        push_number(self.list(kind), count);
        (0..count + more).try_for_each(|_| self.move_number(kind, body))
    }

    fn sort_function(&mut self, body: &mut WasmReader) -> Option<()> {
        self.recent.clear();
        let groups = body.number()?;
        push_number(self.list(PartKind::Declarations), groups);
        for _ in 0..groups {
            self.move_number(PartKind::Declarations, body)?;
            self.move_bytes(PartKind::Declarations, body, 1)?;
        }
        let mut depth = 1;
        while depth > 0 {
            let entry = self.sort_operation(body)?;
            match entry.operands {
                Operands::Block => depth += 1,
                Operands::End => depth -= 1,
                _ => {}
            }
            self.sort_operands(entry, body)?;
        }
        (body.at == body.bytes.len()).then_some(())
    }

    fn sort_operation(&mut self, body: &mut WasmReader) -> Option<Entry> {
        let operation = body.byte()?;
        self.list(PartKind::Operations).push(operation);
        let Some(prefix) = PREFIXES.iter().position(|prefix| *prefix == operation) else {
            return Some(self.table.0[0][usize::from(operation)]);
        };
        let second = body.number()?;
        push_number(self.list(PartKind::Others), second);
        self.table.0[1 + prefix].get(second).copied()
    }

    fn sort_operands(&mut self, entry: Entry, body: &mut WasmReader) -> Option<()> {
        match entry.operands {
            // An operation has no third part.
            Operands::Unknown | Operands::Second | Operands::Address => None,
            Operands::None | Operands::End => Some(()),
            Operands::Block => self.move_number(PartKind::Blocks, body),
            Operands::Label => self.move_number(PartKind::Labels, body),
            Operands::Labels => self.move_list(PartKind::Labels, body, 1),
            Operands::Call => self.move_number(PartKind::Calls, body),
            Operands::Read => self.sort_local(PartKind::Reads, body),
            Operands::Write => self.sort_local(PartKind::Writes, body),
            Operands::Global => self.move_number(PartKind::Globals, body),
            Operands::Memory => self.sort_place(entry, body),
            Operands::MemoryLane => {
                self.sort_place(entry, body)?;
                self.move_bytes(PartKind::Others, body, 1)
            }
            Operands::Integer => self.sort_integer(body),
            Operands::Long => self.move_number(PartKind::Longs, body),
            Operands::Float => self.move_bytes(PartKind::Floats, body, 4),
            Operands::Double => self.move_bytes(PartKind::Floats, body, 8),
            Operands::Vector => self.move_bytes(PartKind::Floats, body, 16),
            Operands::One => self.move_number(PartKind::Others, body),
            Operands::Two => {
                self.move_number(PartKind::Others, body)?;
                self.move_number(PartKind::Others, body)
            }
            Operands::Types => self.move_list(PartKind::Others, body, 0),
            Operands::Lane => self.move_bytes(PartKind::Others, body, 1),
        }
    }

    fn sort_integer(&mut self, body: &mut WasmReader) -> Option<()> {
        let bytes = body.number_bytes()?;
        let is_added = body.bytes.get(body.at) == Some(&ADD);
        let kind = match is_added {
            _ if bytes.len() >= MANY => PartKind::Addresses,
            true => PartKind::Addends,
            false => PartKind::Integers,
        };
        if let (PartKind::Addresses, Some(last)) =
            (kind, self.list(PartKind::Operations).last_mut())
        {
            *last = ADDRESS;
        }
        self.list(kind).extend_from_slice(bytes);
        Some(())
    }

    /// Alignment and offset of a load or store.
    fn sort_place(&mut self, entry: Entry, body: &mut WasmReader) -> Option<()> {
        let alignment = body.byte().filter(|byte| byte & 0x80 == 0)?;
        let less = entry.natural.wrapping_sub(alignment);
        let kind = match entry.natural {
            WIDE.. => PartKind::WideAlignments,
            _ => PartKind::Alignments,
        };
        self.list(kind).push(less);
        self.move_number(PartKind::Offsets, body)
    }

    /// Writes how many others were used more recently.
    fn sort_local(&mut self, kind: PartKind, body: &mut WasmReader) -> Option<()> {
        let local = body.number().filter(|local| *local <= MOST_LOCALS)?;
        while self.recent.len() <= local {
            self.recent.push(self.recent.len());
        }
        let rank = self.recent.iter().position(|other| *other == local)?;
        self.recent[..=rank].rotate_right(1);
        push_number(self.list(kind), rank);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::operands::SECONDS;
    use super::*;

    /// A module with one function of every kind of operands, and some more.
    fn file(body: &[u8]) -> Vec<u8> {
        let mut file = b"\0asm\x01\0\0\0\x01\x04\x01\x60\0\0".to_vec();
        let mut section = vec![2, 2, 0, 0x0b];
        push_number(&mut section, body.len());
        section.extend_from_slice(body);
        file.push(CODE);
        push_number(&mut file, section.len());
        file.extend_from_slice(&section);
        file.extend_from_slice(b"\0\x05\x04name");
        file
    }

    /// Numbers of lists, and the lists.
    fn lists(sorted: &[u8]) -> Vec<Vec<u8>> {
        let mut reader = WasmReader {
            bytes: sorted,
            at: 1,
        };
        let head: Vec<usize> = (0..3 + KINDS).map(|_| reader.number().unwrap()).collect();
        assert_eq!(head[2], 2);
        reader.take(3 * SECONDS).unwrap();
        let lists = head[3..]
            .iter()
            .map(|length| reader.take(*length).unwrap().to_vec());
        let lists = lists.collect();
        assert_eq!(reader.at, sorted.len());
        lists
    }

    #[test]
    fn every_part_goes_to_its_list() {
        // One group of 300 locals of i32; loads, sums and calls of locals 2, 0 and 2 in a block.
        let body = [
            &[1, 0xac, 2, 0x7f, 0x02, 0x40, 0x20, 2, 0x20, 0, 0x21, 2][..],
            &[
                0x28, 2, 0x88, 1, 0x2b, 0, 8, 0x41, 5, 0x6a, 0x41, 0x7f, 0x1a,
            ],
            &[0x41, 0x80, 0x80, 0xc0, 0, 0x6a],
            &[0x42, 9, 0x43, 1, 2, 3, 4, 0x44, 1, 2, 3, 4, 5, 6, 7, 8],
            &[0x0e, 1, 0, 1, 0x10, 1, 0x11, 6, 0, 0x1c, 1, 0x7f, 0x23, 0],
            &[0xfc, 10, 0, 0, 0xfd, 84, 0, 3, 1, 0xfd, 12],
            &[7; 16],
            &[0xfd, 21, 3, 0x0b, 0x0b],
        ]
        .concat();
        let whole = file(&body);
        let lists = lists(&sorted_parts(&whole).unwrap());
        let wanted: [&[u8]; KINDS] = [
            b"\0asm\x01\0\0\0\x01\x04\x01\x60\0\0\0\x05\x04name",
            &[0, 1, 0xac, 2, 0x7f],
            &[
                0x0b, 0x02, 0x20, 0x20, 0x21, 0x28, 0x2b, 0x41, 0x6a, 0x41, 0x1a, 0x06, 0x6a, 0x42,
                0x43, 0x44, 0x0e, 0x10, 0x11, 0x1c, 0x23, 0xfc, 0xfd, 0xfd, 0xfd, 0x0b, 0x0b,
            ],
            &[0x40],
            &[1, 0, 1],
            &[1],
            &[2, 1],
            &[1],
            &[0],
            &[0, 0],
            &[3],
            &[0x88, 1, 8, 3],
            &[0x80, 0x80, 0xc0, 0],
            &[5],
            &[0x7f],
            &[9],
            &[&[1, 2, 3, 4, 1, 2, 3, 4, 5, 6, 7, 8][..], &[7; 16]].concat(),
            &[6, 0, 1, 0x7f, 10, 0, 0, 84, 1, 12, 21, 3],
        ];
        for (list, wanted) in lists.iter().zip(wanted) {
            assert_eq!(list, wanted);
        }
    }

    #[test]
    fn what_is_not_understood_is_left_alone() {
        assert!(sorted_parts(&file(&[0, 0x0b])).is_some());
        // An operation of no version; a body with an end too many, or none; a number of two bytes where one does; nothing.
        for body in [
            &[0, 0xff, 0x0b][..],
            &[0, 0x0b, 0x0b],
            &[0, 0x02, 0x40, 0x0b],
            &[0x80, 0, 0x0b],
        ] {
            assert_eq!(sorted_parts(&file(body)), None);
        }
        assert_eq!(sorted_parts(b"\0asm\x01\0\0\0"), None);
        let whole = file(&[0, 0x0b]);
        for end in 0..whole.len() - 7 {
            assert_eq!(sorted_parts(&whole[..end]), None);
        }
    }
}
