//! Which LZW strings to send when a pixel may take several values.
//!
//! A pixel may be left as it is shown (the transparent index) or take any palette colour, at the price of the
//! squared sRGB error this adds over its nearest colour. All dictionary strings that fit so far are followed at
//! once; a longer string wins if the error it adds is worth the pixels it covers. Pixels that did not change stay
//! as they are shown, whatever that is: nothing still ever flickers.

use super::lzw::{BitWriter, Dictionary, NONE};

/// Strings followed at once. Twice as many make the file 0.5 % smaller and take half again as long.
const BEAM: usize = 6;

/// Colours considered in place of the nearest one.
const NEIGHBOURS: usize = 12;

/// Marks an index that may not be used for a pixel.
const NEVER: i32 = i32::MAX;

/// How much error may be spent on size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Loss {
    /// Squared sRGB error that covering one more pixel with a code is worth.
    pub(super) price: i32,
    /// Most squared sRGB error that may be added to one pixel.
    pub(super) limit: i32,
}

impl Loss {
    /// Every pixel shows its nearest colour.
    pub(super) const NONE: Self = Self { price: 0, limit: 0 };
}

/// How a pixel relates to the frame before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// Its colour changed, or there is no frame before.
    Changed,
    /// Its colour is the same.
    Same,
    /// As `Same`, inside a long stretch of such pixels, where only the transparent index is tried.
    Stretch,
}

/// One pixel to code.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixel {
    /// Red, green, blue, and the index of the nearest palette colour.
    pub(super) wanted: [u8; 4],
    /// Index now shown there; the transparent index if nothing is.
    pub(super) shown: u8,
    /// Relation to the frame before.
    pub(super) change: Change,
}

/// A string of the dictionary that can stand for the pixels read so far.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    node: u16,
    first: u8,
    error: i32,
}

/// What the indices cost at one pixel.
struct Offer {
    colour: [i32; 3],
    /// Squared error of the nearest colour.
    least: i32,
    nearest: u8,
    /// Added error of leaving the pixel, or `NEVER`.
    leave: i32,
    /// The only index but the transparent one, if the pixel must not change.
    fixed: Option<u8>,
    is_stretch: bool,
}

/// Encoder of one palette, with scratch memory.
pub(super) struct Matcher {
    dictionary: Dictionary,
    colours: Vec<[i32; 3]>,
    /// The nearest other colours of each colour with their squared distances, itself first.
    neighbours: Vec<Vec<(u8, i32)>>,
    transparent: u8,
    loss: Loss,
    front: Vec<Candidate>,
    back: Vec<Candidate>,
}

impl Matcher {
    /// An encoder for indices of `root_bits` bits (2 to 8) into `colours`; `transparent` leaves a pixel as it is.
    pub(super) fn new(colours: &[[u8; 3]], transparent: u8, root_bits: u8, loss: Loss) -> Self {
        let colours: Vec<[i32; 3]> = colours.iter().map(|c| c.map(i32::from)).collect();
        let count = if loss.limit > 0 { NEIGHBOURS } else { 1 };
        Self {
            dictionary: Dictionary::new(root_bits, transparent),
            neighbours: colours
                .iter()
                .map(|&c| neighbours(c, &colours, count))
                .collect(),
            colours,
            transparent,
            loss,
            front: Vec::new(),
            back: Vec::new(),
        }
    }

    /// Appends to `out` the LZW code size byte and the coded `pixels`; `chosen` receives the index sent for each.
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
            let (found, length) = self.best_string(&pixels[at..], last);
            if let Some(last) = last {
                self.dictionary.add(last, found.first);
            }
            bits.put(found.node, self.dictionary.width());
            self.dictionary
                .spell(found.node, &mut chosen[at..at + length]);
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

    /// The string to send for the start of `pixels`, and its length; `last` is the string sent before.
    fn best_string(&mut self, pixels: &[Pixel], last: Option<u16>) -> (Candidate, usize) {
        let offer = self.offer(&pixels[0]);
        self.start(&offer);
        let mut best = (cheapest(&self.front), 1);
        for (covered, pixel) in pixels.iter().enumerate().skip(1) {
            if pixel.change == Change::Stretch {
                self.advance_stretch(last);
            } else {
                let offer = self.offer(pixel);
                self.advance(&offer, last);
            }
            if self.back.is_empty() {
                break;
            }
            std::mem::swap(&mut self.front, &mut self.back);
            let candidate = cheapest(&self.front);
            let gain = (covered + 1 - best.1) as i32;
            if candidate.error - best.0.error <= self.loss.price.saturating_mul(gain) {
                best = (candidate, covered + 1);
            }
        }
        best
    }

    fn offer(&self, pixel: &Pixel) -> Offer {
        let [r, g, b, nearest] = pixel.wanted;
        let colour = [r, g, b].map(i32::from);
        let least = self.squared_error(colour, nearest);
        let is_same = pixel.change != Change::Changed;
        let leave = if is_same {
            0
        } else if pixel.shown == self.transparent {
            NEVER
        } else {
            let added = self.squared_error(colour, pixel.shown) - least;
            if added <= self.loss.limit {
                added
            } else {
                NEVER
            }
        };
        Offer {
            colour,
            least,
            nearest,
            leave,
            fixed: is_same.then_some(pixel.shown),
            is_stretch: pixel.change == Change::Stretch,
        }
    }

    #[inline]
    fn squared_error(&self, colour: [i32; 3], index: u8) -> i32 {
        let shown = self
            .colours
            .get(usize::from(index))
            .copied()
            .unwrap_or(colour);
        squared_distance(colour, shown)
    }

    /// Added error of sending `index`, or `NEVER`.
    #[inline]
    fn added_error(&self, offer: &Offer, index: u8) -> i32 {
        if index == self.transparent {
            return offer.leave;
        }
        match offer.fixed {
            Some(shown) if shown == index => 0,
            Some(_) => NEVER,
            None => {
                let added = self.squared_error(offer.colour, index) - offer.least;
                if added <= self.loss.limit {
                    added
                } else {
                    NEVER
                }
            }
        }
    }

    /// Puts the one-symbol strings that fit into `front`, cheapest first, at least one.
    fn start(&mut self, offer: &Offer) {
        let mut front = std::mem::take(&mut self.front);
        front.clear();
        let mut push = |first: u8, error: i32| {
            front.push(Candidate {
                node: u16::from(first),
                first,
                error,
            });
        };
        if offer.leave != NEVER {
            push(self.transparent, offer.leave);
        }
        match offer.fixed {
            Some(_) if offer.is_stretch => {}
            Some(shown) => push(shown, 0),
            None => self
                .indices(offer)
                .for_each(|(index, error)| push(index, error)),
        }
        trim(&mut front);
        self.front = front;
    }

    /// Palette indices that may stand for a changed pixel with their added errors.
    fn indices(&self, offer: &Offer) -> impl Iterator<Item = (u8, i32)> {
        let (colour, least, limit) = (offer.colour, offer.least, self.loss.limit);
        // An index within reach of the wanted colour is within twice that reach of its nearest colour.
        let reach = 4 * (least + limit);
        let near = self
            .neighbours
            .get(usize::from(offer.nearest))
            .map_or(&[][..], Vec::as_slice);
        let near = near.iter().take_while(move |n| n.1 <= reach);
        near.map(move |&(index, _)| (index, self.squared_error(colour, index) - least))
            .filter(move |&(_, added)| added <= limit)
    }

    /// Extends the strings of `front` by the transparent index into `back`.
    fn advance_stretch(&mut self, last: Option<u16>) {
        self.back.clear();
        for item in &self.front {
            let child = self.dictionary.run_child(item.node);
            if child != NONE {
                self.back.push(Candidate {
                    node: child,
                    ..*item
                });
            } else if last == Some(item.node)
                && item.first == self.transparent
                && !self.dictionary.is_full()
            {
                self.back.push(Candidate {
                    node: self.dictionary.next_code(),
                    ..*item
                });
            }
        }
    }

    /// Extends the strings of `front` by every index that fits into `back`.
    fn advance(&mut self, offer: &Offer, last: Option<u16>) {
        let mut back = std::mem::take(&mut self.back);
        back.clear();
        for item in &self.front {
            let mut push = |node: u16, error: i32| {
                let error = item.error.saturating_add(error);
                back.push(Candidate {
                    node,
                    first: item.first,
                    error,
                });
            };
            if self.dictionary.is_root(item.node) {
                self.extend_root(item.node, offer, &mut push);
            } else {
                self.extend_list(item.node, offer, &mut push);
            }
            // The string about to be added, last + first, can already be sent: the decoder knows how it goes on.
            if last == Some(item.node) && !self.dictionary.is_full() {
                let error = self.added_error(offer, item.first);
                if error != NEVER {
                    push(self.dictionary.next_code(), error);
                }
            }
        }
        trim(&mut back);
        self.back = back;
    }

    /// Children of a one-symbol string: there may be hundreds, so the few indices that fit are looked up.
    #[inline]
    fn extend_root(&self, node: u16, offer: &Offer, push: &mut impl FnMut(u16, i32)) {
        let mut look_up = |index: u8, error: i32| {
            let child = self.dictionary.pair(node, index);
            if child != NONE {
                push(child, error);
            }
        };
        if offer.leave != NEVER {
            look_up(self.transparent, offer.leave);
        }
        match offer.fixed {
            Some(shown) => look_up(shown, 0),
            None => self
                .indices(offer)
                .for_each(|(index, error)| look_up(index, error)),
        }
    }

    /// Children of a longer string: a short list, gone through.
    #[inline]
    fn extend_list(&self, node: u16, offer: &Offer, push: &mut impl FnMut(u16, i32)) {
        let mut child = self.dictionary.children(node);
        while child != NONE {
            let (next, index) = self.dictionary.sibling(child);
            let error = self.added_error(offer, index);
            if error != NEVER {
                push(child, error);
            }
            child = next;
        }
    }
}

/// Up to `count` of `colours` nearest to `colour`, with squared distances, nearest first.
fn neighbours(colour: [i32; 3], colours: &[[i32; 3]], count: usize) -> Vec<(u8, i32)> {
    let all = colours.iter().take(256).enumerate();
    let mut all: Vec<(u8, i32)> = all
        .map(|(i, &c)| (i as u8, squared_distance(colour, c)))
        .collect();
    all.sort_by_key(|n| n.1);
    all.truncate(count);
    all
}

#[inline]
fn squared_distance(a: [i32; 3], b: [i32; 3]) -> i32 {
    let d: [i32; 3] = std::array::from_fn(|i| a[i] - b[i]);
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}

/// Keeps the cheapest `BEAM`. The sort is stable: the outcome does not depend on its implementation.
#[inline]
fn trim(candidates: &mut Vec<Candidate>) {
    if candidates.len() > BEAM {
        candidates.sort_by_key(|c| c.error);
        candidates.truncate(BEAM);
    }
}

/// The cheapest, the first of equals.
#[inline]
fn cheapest(candidates: &[Candidate]) -> Candidate {
    let none = Candidate {
        node: 0,
        first: 0,
        error: NEVER,
    };
    candidates
        .iter()
        .fold(none, |best, c| if c.error < best.error { *c } else { best })
}
