// Holds the engine, so that the page never waits for it: questions go in as JSON, answers come out as JSON or as bytes.

const TEXT = "{".charCodeAt(0);
let engine = null;

/** The answer to one question: an object, or a Uint8Array. */
function answerTo(question) {
  const asked = new TextEncoder().encode(JSON.stringify(question));
  const place = engine.reserve(asked.length) >>> 0;
  new Uint8Array(engine.memory.buffer).set(asked, place);
  const length = engine.ask() >>> 0;
  // Memory may have grown, and with it moved.
  const answer = new Uint8Array(engine.memory.buffer, engine.answer() >>> 0, length);
  return answer[0] === TEXT ? JSON.parse(new TextDecoder().decode(answer)) : answer.slice(1);
}

self.onmessage = async ({ data }) => {
  try {
    if (data.packed) {
      self.postMessage({ id: data.id, answer: await WebAssembly.compile(assembled(unpacked(bytesOf(data.packed)))) });
      return;
    }
    if (data.engine) {
      engine = (await WebAssembly.instantiate(data.engine, {})).exports;
      self.postMessage({ id: data.id, answer: { memory: engine.memory.buffer.byteLength } });
      return;
    }
    const begun = performance.now();
    const answer = answerTo(data.question);
    const transferred = answer instanceof Uint8Array ? [answer.buffer] : [];
    const milliseconds = performance.now() - begun;
    self.postMessage({ id: data.id, answer, milliseconds, memory: engine.memory.buffer.byteLength }, transferred);
  } catch (error) {
    // An instance that has failed is not asked again.
    self.postMessage({ id: data.id, fault: String(error) });
  }
};
