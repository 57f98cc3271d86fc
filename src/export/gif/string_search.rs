//! Chooses LZW strings when a pixel may take several values.
//!
//! A pixel may stay as it is (the transparent index) or take any palette colour, at the cost of the squared sRGB error
//! added over its nearest colour. All matching dictionary strings are followed at once; a longer string wins if its
//! added error is worth the pixels it covers. Unchanged pixels stay as they are shown, so that nothing static ever
//! flickers.

use super::colour_costs::{Costs, Loss, NEVER, Pixel, PixelChange};
use super::lzw::{BitWriter, Dictionary, NONE};

/// Strings followed at once. Compared with two, four make the file 2 % smaller at the same quality and take longer; one
/// makes it a tenth larger.
const BEAM: usize = 2;

/// A string of the dictionary that can represent the pixels read so far.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    node: u16,
    first: u8,
    error: i32,
}

impl Candidate {
    const NONE: Self = Self {
        node: 0,
        first: 0,
        error: NEVER,
    };

    fn is_some(&self) -> bool {
        self.error != NEVER
    }
}

/// The cheapest candidates, cheapest first; of equals, those that came first.
struct Beam {
    items: [Candidate; BEAM],
}

impl Beam {
    const EMPTY: Self = Self {
        items: [Candidate::NONE; BEAM],
    };

    #[inline]
    fn clear(&mut self) {
        self.items = Self::EMPTY.items;
    }

    #[inline]
    fn is_empty(&self) -> bool {
        !self.items[0].is_some()
    }

    #[inline]
    fn items(&self) -> impl Iterator<Item = &Candidate> {
        self.items.iter().take_while(|item| item.is_some())
    }

    #[inline]
    fn push(&mut self, candidate: Candidate) {
        if self.items[BEAM - 1].error <= candidate.error {
            return;
        }
        // The last one leaves.
        let mut place = BEAM - 1;
        while place > 0 && self.items[place - 1].error > candidate.error {
            self.items[place] = self.items[place - 1];
            place -= 1;
        }
        self.items[place] = candidate;
    }
}

/// Encoder of one palette, with scratch memory.
pub(super) struct Matcher {
    dictionary: Dictionary,
    costs: Costs,
    transparent: u8,
    price: i32,
    beams: [Beam; 2],
}

impl Matcher {
    /// An encoder for indices of `root_bits` bits (2 to 8) into `colours`; `transparent` leaves a pixel as it is.
    pub(super) fn new(colours: &[[u8; 3]], transparent: u8, root_bits: u8, loss: Loss) -> Self {
        Self {
            dictionary: Dictionary::new(root_bits, transparent),
            costs: Costs::new(colours, transparent, loss.limit),
            transparent,
            price: loss.price,
            beams: [Beam::EMPTY; 2],
        }
    }

    /// Appends to `out` the size of the symbols in bits and the LZW stream of `pixels`; `chosen` receives the index sent for each.
    pub(super) fn encode(&mut self, pixels: &[Pixel], chosen: &mut Vec<u8>, out: &mut Vec<u8>) {
        out.push(self.dictionary.root_bits());
        chosen.clear();
        chosen.resize(pixels.len(), self.transparent);
        let mut bits = BitWriter::new(out);
        self.dictionary.reset();
        bits.put(self.dictionary.clear_code(), self.dictionary.width());
        let mut at = 0;
        let mut last = None;
        while at < pixels.len() {
            let (found, length) = self.best_string(pixels, at, last);
            if let Some(last) = last {
                self.dictionary.add(last, found.first);
            }
            bits.put(found.node, self.dictionary.width());
            if !self.dictionary.is_run(found.node, length) {
                self.dictionary
                    .spell_string(found.node, &mut chosen[at..at + length]);
            }
            at += length;
            last = Some(found.node);
            // Keeping a full dictionary, by whatever rule, was always larger: pictures change too much downwards.
            if self.dictionary.is_full() {
                bits.put(self.dictionary.clear_code(), self.dictionary.width());
                self.dictionary.reset();
                last = None;
            }
        }
        if let Some(last) = last {
            // The decoder adds a string here as well, which may widen the end code.
            self.dictionary.add(last, 0);
        }
        bits.put(self.dictionary.end_code(), self.dictionary.width());
        bits.finish();
    }

    /// The string to send for the pixels from number `at` on, and its length; `last` is the string sent before.
    fn best_string(
        &mut self,
        pixels: &[Pixel],
        at: usize,
        last: Option<u16>,
    ) -> (Candidate, usize) {
        let Self {
            dictionary,
            costs,
            beams: [front, back],
            ..
        } = self;
        let (mut front, mut back) = (front, back);
        // Beam search: the cheapest strings that stand for the pixels read so far, one pixel longer at a time.
        let step = BeamStep {
            dictionary,
            costs,
            transparent: self.transparent,
            last,
        };
        let mut covered = step.start(pixels, at, front);
        let mut best = (front.items[0], covered);
        while let Some(pixel) = pixels.get(at + covered) {
            let followed = match pixel.change {
                PixelChange::Stretch => step.follow_run(front, pixel.run_end() - at - covered),
                _ => 0,
            };
            covered += followed;
            if followed == 0 {
                back.clear();
                // All continuations that the dictionary has and the pixel allows.
                match pixel.change {
                    PixelChange::Stretch => step.stretch_strings(front, back),
                    _ if covered == 1 => step.second_pixel(pixel, front, back),
                    PixelChange::Same => step.unchanged_pixel(pixel.shown, front, back),
                    PixelChange::Changed => step.changed_pixel(pixel, front, back),
                }
                if back.is_empty() {
                    break;
                }
                std::mem::swap(&mut front, &mut back);
                covered += 1;
            }
            // A longer string is taken if its further error is worth the pixels that it covers.
            let candidate = front.items[0];
            let gain = (covered - best.1) as i32;
            if candidate.error - best.0.error <= self.price.saturating_mul(gain) {
                best = (candidate, covered);
            }
        }
        best
    }
}

/// Extends the strings of one beam by one pixel into another.
struct BeamStep<'a> {
    dictionary: &'a Dictionary,
    costs: &'a Costs,
    transparent: u8,
    last: Option<u16>,
}

impl BeamStep<'_> {
    /// Puts the initial strings into `front`, at least one, and returns how many pixels they cover.
    fn start(&self, pixels: &[Pixel], at: usize, front: &mut Beam) -> usize {
        front.clear();
        let Some(pixel) = pixels.get(at) else {
            return 0;
        };
        if pixel.change == PixelChange::Stretch {
            // Only the transparent index fits: as many as the dictionary has in one string.
            let (node, length) = self.dictionary.run(pixel.run_end() - at);
            front.push(Candidate {
                node,
                first: self.transparent,
                error: 0,
            });
            return length;
        }
        self.costs.for_each(pixel, |first, error| {
            front.push(Candidate {
                node: u16::from(first),
                first,
                error,
            });
        });
        1
    }

    /// The second pixel: the strings so far have hundreds of continuations, so the few that fit are looked up.
    fn second_pixel(&self, pixel: &Pixel, front: &Beam, back: &mut Beam) {
        self.costs.for_each(pixel, |index, error| {
            for item in front.items() {
                let child = self.dictionary.pair(item.node, index);
                if child != NONE {
                    push_candidate(back, item, child, error);
                } else if index == item.first {
                    self.unsaid(item, back, error);
                }
            }
        });
    }

    /// Extends all strings by pixels of a run, `most` at most, as long as the dictionary has each of them; returns by how
    /// many. The errors are as before: which string is taken need be decided only at the end.
    #[inline]
    fn follow_run(&self, front: &mut Beam, most: usize) -> usize {
        let mut followed = 0;
        while followed < most {
            let next = front.items.map(|item| self.dictionary.run_child(item.node));
            let mut ends = front.items.iter().zip(next);
            if ends.any(|(item, next)| item.is_some() && next == NONE) {
                break;
            }
            for (item, next) in front.items.iter_mut().zip(next) {
                item.node = next;
            }
            followed += 1;
        }
        followed
    }

    /// A pixel in a run: the transparent index.
    #[inline]
    fn stretch_strings(&self, front: &Beam, back: &mut Beam) {
        for item in front.items() {
            let child = self.dictionary.run_child(item.node);
            if child != NONE {
                push_candidate(back, item, child, 0);
            } else if item.first == self.transparent {
                self.unsaid(item, back, 0);
            }
        }
    }

    /// An unchanged pixel: the transparent index or the one shown.
    #[inline]
    fn unchanged_pixel(&self, shown: u8, front: &Beam, back: &mut Beam) {
        let fits = |index| index == self.transparent || index == shown;
        for item in front.items() {
            let mut child = self.dictionary.first_child(item.node);
            while child != NONE {
                let (next, index) = self.dictionary.sibling(child);
                if fits(index) {
                    push_candidate(back, item, child, 0);
                }
                child = next;
            }
            if fits(item.first) {
                self.unsaid(item, back, 0);
            }
        }
    }

    /// A changed pixel: any index that is near enough.
    #[inline]
    fn changed_pixel(&self, pixel: &Pixel, front: &Beam, back: &mut Beam) {
        let wish = self.costs.wish(pixel);
        for item in front.items() {
            let mut child = self.dictionary.first_child(item.node);
            while child != NONE {
                let (next, index) = self.dictionary.sibling(child);
                let error = self.costs.added(&wish, index);
                if error != NEVER {
                    push_candidate(back, item, child, error);
                }
                child = next;
            }
            if self.last == Some(item.node) {
                let error = self.costs.added(&wish, item.first);
                if error != NEVER {
                    self.unsaid(item, back, error);
                }
            }
        }
    }

    /// The string about to be added, last + first, can already be sent: the decoder knows its continuation.
    #[inline]
    fn unsaid(&self, item: &Candidate, back: &mut Beam, error: i32) {
        if self.last == Some(item.node) && !self.dictionary.is_full() {
            push_candidate(back, item, self.dictionary.next_code(), error);
        }
    }
}

/// Adds the continuation of `item` that ends in `node`.
#[inline]
fn push_candidate(back: &mut Beam, item: &Candidate, node: u16, error: i32) {
    let error = item.error.saturating_add(error);
    back.push(Candidate {
        node,
        first: item.first,
        error,
    });
}
