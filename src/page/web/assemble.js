// Puts the engine together again from its parts, which `page/wasm_parts.rs` has sorted by kind.

/** The lists of parts, in their order. */
const KINDS = [
  "rest", "declarations", "operations", "blocks", "labels", "calls", "reads", "writes", "globals",
  "alignments", "wide", "offsets", "addresses", "addends", "integers", "longs", "floats", "others",
];

/** The section of functions' bodies, and operations: the second one stands for the first where the integer has many bytes. */
const [CODE, INTEGER, ADDRESS, ADD] = [10, 0x41, 0x06, 0x6a];

/** What follows operations, by its number in the table: the beginning and the end of a block, and the second part. */
const [BLOCK, END, SECOND] = [2, 3, 21];

/** Bytes that are read one after the other. */
class Parts {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  byte() {
    this.at += 1;
    return this.bytes[this.at - 1];
  }

  /** A number without a sign, seven bits a byte, the lowest first. */
  number() {
    for (let [value, weight] = [0, 1]; ; weight *= 128) {
      const byte = this.byte();
      value += (byte & 127) * weight;
      if (byte < 128) return value;
    }
  }

  take(count) {
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }
}

/** Bytes that are written one after the other, up to so many. */
class Written {
  constructor(most) {
    this.bytes = new Uint8Array(most);
    this.count = 0;
  }

  byte(byte) {
    this.bytes[this.count] = byte;
    this.count += 1;
  }

  number(value) {
    for (; value > 127; value >>>= 7) this.byte((value & 127) | 128);
    this.byte(value);
  }

  append(bytes) {
    this.bytes.set(bytes, this.count);
    this.count += bytes.length;
  }

  /** Moves the bytes of a number. */
  moveNumber(from) {
    for (let more = true; more; ) {
      const byte = from.byte();
      this.byte(byte);
      more = byte > 127;
    }
  }

  /** Moves a number of items, and one number for each, and `more`. */
  moveList(from, more) {
    const count = from.number();
    this.number(count);
    for (let k = 0; k < count + more; k += 1) this.moveNumber(from);
  }

  filled() {
    return this.bytes.subarray(0, this.count);
  }
}

/** The bodies of functions, one after the other. */
class Functions {
  constructor(lists, table, most) {
    this.lists = lists;
    this.table = table;
    this.body = new Written(most);
    // Local variables, the last used one first.
    this.recent = [];
  }

  /** The next body. */
  next() {
    const { body, lists } = this;
    body.count = 0;
    this.recent = [];
    const groups = lists.declarations.number();
    body.number(groups);
    for (let k = 0; k < groups; k += 1) {
      body.moveNumber(lists.declarations);
      body.byte(lists.declarations.byte());
    }
    for (let depth = 1; depth > 0; ) {
      const entry = this.operation(lists.operations.byte());
      const operands = entry & 31;
      if (operands === BLOCK) depth += 1;
      if (operands === END) depth -= 1;
      OPERANDS[operands](this, body, lists, entry >> 5);
    }
    return body.filled();
  }

  /** Writes an operation; the entry of what follows it. */
  operation(code) {
    this.body.byte(code === ADDRESS ? INTEGER : code);
    if (this.table[code] !== SECOND) return this.table[code];
    const second = this.lists.others.number();
    this.body.number(second);
    return this.table[256 * (code - 0xfb) + second];
  }

  /** A local variable by the number of others that were used since its last use. */
  local(rank) {
    const { recent } = this;
    while (recent.length <= rank) recent.push(recent.length);
    const local = recent[rank];
    recent.copyWithin(1, 0, rank);
    recent[0] = local;
    return local;
  }
}

/** How operands are written, by their number in the table. */
const OPERANDS = [
  () => {
    throw new Error("the engine in this page is damaged");
  },
  () => {},
  (_, body, lists) => body.moveNumber(lists.blocks),
  () => {},
  (_, body, lists) => body.moveNumber(lists.labels),
  (_, body, lists) => body.moveList(lists.labels, 1),
  (_, body, lists) => body.moveNumber(lists.calls),
  (functions, body, lists) => body.number(functions.local(lists.reads.number())),
  (functions, body, lists) => body.number(functions.local(lists.writes.number())),
  (_, body, lists) => body.moveNumber(lists.globals),
  (_, body, lists, natural) => {
    body.byte((natural - (natural < 3 ? lists.alignments : lists.wide).byte()) & 255);
    body.moveNumber(lists.offsets);
  },
  (_, body, lists, natural) => {
    body.byte((natural - (natural < 3 ? lists.alignments : lists.wide).byte()) & 255);
    body.moveNumber(lists.offsets);
    body.byte(lists.others.byte());
  },
  (_, body, { operations, addends, integers }) =>
    body.moveNumber(operations.bytes[operations.at] === ADD ? addends : integers),
  (_, body, lists) => body.moveNumber(lists.longs),
  (_, body, lists) => body.append(lists.floats.take(4)),
  (_, body, lists) => body.append(lists.floats.take(8)),
  (_, body, lists) => body.append(lists.floats.take(16)),
  (_, body, lists) => body.moveNumber(lists.others),
  (_, body, lists) => {
    body.moveNumber(lists.others);
    body.moveNumber(lists.others);
  },
  (_, body, lists) => body.moveList(lists.others, 0),
  (_, body, lists) => body.byte(lists.others.byte()),
  () => {},
  (_, body, lists) => body.moveNumber(lists.addresses),
];

/** The file whose parts are given; any other as it is. */
function assembled(sorted) {
  if (sorted[0] !== 1) return sorted;
  const head = new Parts(sorted);
  head.at = 1;
  const [length, place, count] = [0, 1, 2].map(() => head.number());
  const lengths = KINDS.map(() => head.number());
  const table = head.take(3 * 256);
  const lists = Object.fromEntries(KINDS.map((kind, k) => [kind, new Parts(head.take(lengths[k]))]));
  const functions = new Functions(lists, table, length);
  const section = new Written(length);
  section.number(count);
  for (let k = 0; k < count; k += 1) {
    const body = functions.next();
    section.number(body.length);
    section.append(body);
  }
  const file = new Written(length);
  file.append(lists.rest.take(place));
  file.byte(CODE);
  file.number(section.count);
  file.append(section.filled());
  file.append(lists.rest.take(lengths[0] - place));
  return file.filled();
}

if (typeof module !== "undefined") module.exports = { assembled };
