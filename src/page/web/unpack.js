"use strict";
// What a live page holds packed: the engine, the models and the other scripts. Bytes in the format of .lzma files, which browsers do not unpack
// themselves, written as printable characters. LZMA is described in Pavlov's `lzma-specification.txt`.

/** Thirteen digits of this base are eleven bytes. */
const BASE = 111;

/** The digits of a text: one for a printable character of ASCII, all but "<", and two for any other. */
function digitsOf(text) {
  const digits = new Uint8Array(2 * text.length);
  let count = 0;
  for (let k = 0; k < text.length; k += 1) {
    const code = text.charCodeAt(k);
    if (code < 0xa0) {
      digits[count++] = code - (code > 60 ? 33 : 32);
    } else {
      digits[count++] = 94 + Math.floor((code - 0xa0) / BASE);
      digits[count++] = (code - 0xa0) % BASE;
    }
  }
  return digits.subarray(0, count);
}

/** The bytes that were written as characters; up to ten zeros follow them. */
function bytesOf(text) {
  const digits = digitsOf(text);
  const count = Math.floor(digits.length / 13);
  const bytes = new Uint8Array(11 * count);
  for (let block = 0; block < count; block += 1) {
    // Three bytes in each part of the number, two in the highest.
    const parts = [0, 0, 0, 0];
    for (let k = 13 * block; k < 13 * (block + 1); k += 1) {
      let carry = digits[k];
      for (let part = 3; part >= 0; part -= 1) {
        carry += BASE * parts[part];
        parts[part] = carry & 0xffffff;
        carry >>>= 24;
      }
    }
    for (let k = 1; k < 12; k += 1) bytes[11 * block + k - 1] = parts[Math.floor(k / 3)] >> (16 - 8 * (k % 3));
  }
  return bytes;
}

/** Reads bits whose probabilities adapt to them. */
class RangeDecoder {
  constructor(bytes, place) {
    this.bytes = bytes;
    this.place = place + 5;
    this.range = 0xffffffff;
    this.code = new DataView(bytes.buffer, place + 1).getUint32(0);
  }

  /** Keeps at least three bytes of the range. */
  fill() {
    if (this.range < 0x1000000) {
      this.range = (this.range << 8) >>> 0;
      this.code = ((this.code << 8) | this.bytes[this.place]) >>> 0;
      this.place += 1;
    }
  }

  bit(chances, at) {
    const chance = chances[at];
    const bound = (this.range >>> 11) * chance;
    if (this.code < bound) {
      this.range = bound;
      chances[at] = chance + ((2048 - chance) >> 5);
      this.fill();
      return 0;
    }
    this.range -= bound;
    this.code -= bound;
    chances[at] = chance - (chance >> 5);
    this.fill();
    return 1;
  }

  /** Bits of even chances, the first one highest. */
  even(count) {
    let value = 0;
    for (let k = 0; k < count; k += 1) {
      this.range >>>= 1;
      const bit = this.code >= this.range ? 1 : 0;
      if (bit) this.code -= this.range;
      value = (value << 1) | bit;
      this.fill();
    }
    return value;
  }

  /** A number whose bits have chances that depend on those above them. */
  number(chances, at, count) {
    let node = 1;
    for (let k = 0; k < count; k += 1) node = (node << 1) | this.bit(chances, at + node);
    return node - (1 << count);
  }

  /** The same with the lowest bit first. */
  backwards(chances, at, count) {
    let [node, value] = [1, 0];
    for (let k = 0; k < count; k += 1) {
      const bit = this.bit(chances, at + node);
      node = (node << 1) | bit;
      value |= bit << k;
    }
    return value;
  }
}

/** Chances that are even at first. */
const chances = (count) => new Uint16Array(count).fill(1024);

/** Lengths of copies, from two: short ones by the place in the text, long ones by themselves. */
class Lengths {
  constructor() {
    [this.choice, this.short, this.middle, this.long] = [2, 128, 128, 256].map(chances);
  }

  read(decoder, slot) {
    if (!decoder.bit(this.choice, 0)) return 2 + decoder.number(this.short, 8 * slot, 3);
    if (!decoder.bit(this.choice, 1)) return 10 + decoder.number(this.middle, 8 * slot, 3);
    return 18 + decoder.number(this.long, 0, 8);
  }
}

/** How far back a copy of a length begins, less one. */
class Distances {
  constructor() {
    [this.slots, this.low, this.ends] = [256, 128, 16].map(chances);
  }

  read(decoder, length) {
    const slot = decoder.number(this.slots, 64 * Math.min(length - 2, 3), 6);
    if (slot < 4) return slot;
    const count = (slot >> 1) - 1;
    const high = (2 | (slot & 1)) << count;
    if (slot < 14) return high + decoder.backwards(this.low, high - slot, count);
    return high + (decoder.even(count - 4) << 4) + decoder.backwards(this.ends, 0, 4);
  }
}

/** The content of a .lzma file. */
function unpacked(bytes) {
  const head = new DataView(bytes.buffer);
  const properties = bytes[0];
  const contextBits = properties % 9;
  const lowBits = Math.floor(properties / 9) % 5;
  const placeMask = (1 << Math.floor(properties / 45)) - 1;
  const out = new Uint8Array(head.getUint32(5, true));
  const decoder = new RangeDecoder(bytes, 13);
  const [isCopy, isOld, isOlder, isThird, isFourth, isLonger] = [192, 12, 12, 12, 12, 192].map(chances);
  const literals = chances(0x300 << (contextBits + lowBits));
  const [lengths, oldLengths, distances] = [new Lengths(), new Lengths(), new Distances()];
  let old = [0, 0, 0, 0];
  let [place, state] = [0, 0];

  /** A byte; after a copy, with the chances that the byte which would have followed gives. */
  const literal = () => {
    const before = place ? out[place - 1] >> (8 - contextBits) : 0;
    const base = 0x300 * (((place & ((1 << lowBits) - 1)) << contextBits) + before);
    let node = 1;
    if (state >= 7) {
      let other = out[place - old[0] - 1];
      while (node < 0x100) {
        const expected = (other >> 7) & 1;
        other <<= 1;
        const bit = decoder.bit(literals, base + ((1 + expected) << 8) + node);
        node = (node << 1) | bit;
        if (bit !== expected) break;
      }
    }
    while (node < 0x100) node = (node << 1) | decoder.bit(literals, base + node);
    out[place] = node & 0xff;
    place += 1;
    state = state < 4 ? 0 : state - (state < 10 ? 3 : 6);
  };

  /** Takes the distance of one of the last four copies to the front. */
  const again = () => {
    let which = 0;
    if (decoder.bit(isOlder, state)) which = decoder.bit(isThird, state) ? 2 + decoder.bit(isFourth, state) : 1;
    const [distance] = old.splice(which, 1);
    old.unshift(distance);
    return which;
  };

  while (place < out.length) {
    const slot = place & placeMask;
    if (!decoder.bit(isCopy, 16 * state + slot)) {
      literal();
      continue;
    }
    let length = 1;
    if (!decoder.bit(isOld, state)) {
      length = lengths.read(decoder, slot);
      old = [distances.read(decoder, length), ...old.slice(0, 3)];
      state = state < 7 ? 7 : 10;
    } else if (again() > 0 || decoder.bit(isLonger, 16 * state + slot)) {
      length = oldLengths.read(decoder, slot);
      state = state < 7 ? 8 : 11;
    } else {
      state = state < 7 ? 9 : 11;
    }
    for (const end = Math.min(place + length, out.length); place < end; place += 1) out[place] = out[place - old[0] - 1];
  }
  return out;
}

/** Makes what is packed elements of the page; scripts run at once, in their order. */
function unfold(packed) {
  for (const { text, ...attributes } of JSON.parse(new TextDecoder().decode(unpacked(bytesOf(packed.textContent))))) {
    const element = Object.assign(document.createElement("script"), attributes);
    element.textContent = text;
    document.body.append(element);
  }
}

if (typeof document !== "undefined") unfold(document.getElementById("packed"));

if (typeof module !== "undefined") module.exports = { bytesOf, unpacked };
