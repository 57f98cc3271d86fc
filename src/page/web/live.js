"use strict";
// The live parts of a report: sliders for dimensions and inputs, the proof beside them, the scene's text. All of it is computed
// by the program itself, which the page holds as WebAssembly and runs in a worker; the page only asks and shows.

/** Milliseconds without a move after which the whole article is made anew, clearances included. */
const REST = 250;

/** Milliseconds after which a reader may stop what is computed. */
const PATIENCE = 3000;

/** Bytes of an engine's memory above which it is replaced once it has answered. */
const MOST_MEMORY = 2 ** 28;

/** Why an engine is replaced whose answer nobody waits for any more. */
const MOVED_ON = "the mechanism has moved on";

/** Steps of a slider, about. */
const STEPS = 200;

/** The picture of the program's own renderer, as wide and high as the page's still. */
const PICTURE = [640, 480];

/** A step of one, two or five times a power of ten, about a part of a range. */
function niceStep(span, steps) {
  const rough = span / steps;
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= rough * 0.999);
}

/** A multiple of a step without the noise of its division. */
function multiple(step, count) {
  const digits = Math.max(0, -Math.floor(Math.log10(step)));
  return Number((step * count).toFixed(Math.min(20, digits)));
}

/** A worker that has no engine yet. */
function newWorker() {
  const texts = ["unpack", "worker"].map((id) => document.getElementById(id).textContent);
  const address = URL.createObjectURL(new Blob(texts, { type: "text/javascript" }));
  const worker = new Worker(address);
  URL.revokeObjectURL(address);
  return worker;
}

/** The engine that the page holds, unpacked and compiled in a worker of its own. */
function compiledEngine() {
  const worker = newWorker();
  const compiled = new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => (data.fault === undefined ? resolve(data.answer) : reject(new Error(data.fault)));
    worker.onerror = (event) => reject(new Error(event.message || "the worker ended"));
  });
  worker.postMessage({ packed: document.getElementById("engine").textContent });
  return compiled.finally(() => worker.terminate());
}

/** An engine in its worker. One that fails is replaced, and whoever asked it is told. */
class Engine {
  constructor(module) {
    this.module = module;
    this.waiting = new Map();
    this.count = 0;
    this.restarts = 0;
    this.milliseconds = 0;
    this.start();
  }

  start() {
    this.memory = 0;
    this.worker = newWorker();
    this.worker.onmessage = ({ data }) => this.hear(data);
    this.worker.onerror = (event) => this.fail(event.message || "the worker ended");
    this.ready = this.send({ engine: this.module });
    // Whoever asks hears of it.
    this.ready.catch(() => {});
  }

  send(message) {
    this.count += 1;
    const id = this.count;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, ...message });
    });
  }

  /** The answer to a question; an Error if the engine fails on it. */
  ask(question) {
    return this.send({ question });
  }

  hear({ id, answer, fault, memory, milliseconds }) {
    if (fault !== undefined) return this.fail(fault);
    const waiting = this.waiting.get(id);
    this.waiting.delete(id);
    if (memory) this.memory = memory;
    if (milliseconds) this.milliseconds = milliseconds;
    return waiting?.resolve(answer);
  }

  /** Begins anew: everything that was asked is answered with the fault. */
  fail(fault) {
    this.worker.terminate();
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    this.restarts += 1;
    this.start();
    waiting.forEach(({ reject }) => reject(new Error(fault)));
  }
}

/** A row of a slider with its number. */
class Slider {
  constructor({ name, unit, value, low, high }, id, moved) {
    this.name = name;
    this.value = value;
    const step = niceStep(high - low, STEPS);
    const ends = [Math.floor(low / step), Math.ceil(high / step)].map((count) => String(multiple(step, count)));
    this.range = made("input", { type: "range", id, min: ends[0], max: ends[1], step: String(step) });
    this.number = made("input", { type: "number", step: "any", "aria-label": `${name}, as a number` });
    this.row = made("div", { className: "slider" }, made("label", { htmlFor: id }, made("bdi", {}, name)), this.range,
      this.number, made("span", { className: "faint" }, unit));
    this.put(value);
    this.range.addEventListener("input", () => {
      this.isHeld = true;
      moved(this, multiple(step, Math.round(Number(this.range.value) / step)));
    });
    this.range.addEventListener("change", () => {
      this.isHeld = false;
      if (!this.isAsked) this.put(this.value);
    });
    this.number.addEventListener("change", () => {
      this.isHeld = false;
      const typed = Number(this.number.value);
      if (this.number.value.trim() !== "" && Number.isFinite(typed)) moved(this, typed);
      else this.put(this.value);
    });
  }

  /** What became of the last wish: where the mechanism stands now. A slider that is held stays in the hand. */
  answer(value, isStopped) {
    this.row.classList.toggle("stopped", isStopped);
    this.value = value;
    this.number.value = String(value);
    if (!this.isHeld) this.put(value);
  }

  /** Shows the value at which the mechanism stands. */
  put(value) {
    this.value = value;
    this.range.value = String(value);
    this.number.value = String(value);
    this.range.setAttribute("aria-valuetext", String(value));
  }
}

/** One mechanism of the page, alive. */
class Live {
  /** `engine` answers while sliders move; `judge` makes the article anew meanwhile. */
  constructor(report, { engine, judge }) {
    this.report = report;
    this.engine = engine;
    this.judge = judge;
    this.source = report.data.live;
    this.number = report.number;
    this.place = report.root.querySelector('[data-part="bench"]');
    this.sections = report.root.querySelector('[data-part="sections"]');
    this.verdict = report.root.querySelector('[data-part="verdict"]');
    this.parameters = new Map(this.source.parameters);
    this.guess = this.source.guess;
    this.text = this.source.text;
    this.sliders = [];
    this.hand = [];
    this.wanted = null;
    this.isBusy = false;
    this.resting = 0;
    this.build();
    this.opened = this.open(true);
  }

  build() {
    const button = (text, act) => {
      const element = made("button", { type: "button" }, text);
      element.addEventListener("click", act);
      return element;
    };
    this.proof = made("p", { className: "verdict", role: "status" }, "Starting the engine …");
    this.clearance = made("p", { className: "verdict", hidden: true });
    this.told = made("p", { className: "stop", role: "alert", hidden: true });
    this.events = made("ul", { className: "faint" });
    this.force = button("Assemble there anew", () => this.assembleThere());
    this.halt = button("Stop computing", () => (this.isJudging ? this.judge : this.engine).fail("stopped"));
    this.isJudged = true;
    [this.force, this.halt].forEach((element) => { element.hidden = true; });
    this.dimensions = made("div");
    this.hands = made("div");
    this.counted = made("p", { className: "faint", role: "status" });
    this.assemblies = made("select", { hidden: true, "aria-label": "Assembly" });
    this.assemblies.addEventListener("change", () => this.choose());
    this.release = button("Back to the drive", () => this.enqueue({ ask: "release" }));
    this.release.hidden = true;
    this.editor = made("textarea", { value: this.text, rows: 18, spellcheck: false, wrap: "off", "aria-label": "Text of the scene" });
    this.mistakes = made("ol", { className: "mistakes", role: "alert" });
    this.saved = made("span", { className: "faint", role: "status" });
    const save = (kind, type) => button(`Save ${kind.toUpperCase()}`, () => this.save(kind, type));
    this.place.append(
      this.proof, this.clearance, this.told, made("div", { className: "controls" }, this.force, this.halt), this.events,
      made("h3", {}, "Assemblies"), this.counted,
      made("div", { className: "controls" }, button("Find the assemblies", () => this.findAssemblies()), this.assemblies),
      made("h3", {}, "Dimensions"), this.dimensions,
      made("div", { className: "controls" }, button("Values of the file", () => this.reset()),
        button("Assemble anew", () => this.enqueue({ ask: "assemble" }))),
      made("h3", {}, "Inputs by hand"), this.hands, this.release,
      made("details", {}, made("summary", {}, "Text of the scene"), this.editor, this.mistakes,
        made("div", { className: "controls" }, button("Read the text", () => this.read()))),
      made("div", { className: "controls" }, button("Copy as TOML", () => this.copy()), save("toml", "application/toml"),
        save("csv", "text/csv"), save("png", "image/png"), save("gif", "image/gif"), this.saved),
    );
    this.place.hidden = false;
  }

  /** What opens the scene as it is now. */
  question() {
    const { source, asked } = this.source;
    return { ask: "open", source, asked, text: this.text, parameters: [...this.parameters], guess: this.guess };
  }

  async open(shapes) {
    const state = await this.ask({ ...this.question(), shapes });
    if (!state) return;
    if (!this.tell(state)) return;
    this.showSliders(state.sliders);
    this.forgetAssemblies();
    this.take(state, true);
    this.rest();
  }

  /** What is computed about the values before is not waited for. */
  moveOn() {
    this.isJudged = false;
    if (this.isJudging) this.judge.fail(MOVED_ON);
  }

  /** Once nothing is moved for a while, everything is made anew. */
  rest() {
    this.moveOn();
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.settle(), REST);
  }

  /** Asks about this mechanism; null after a fault. A new engine is told first what was open. */
  async ask(question) {
    const late = setTimeout(() => { this.halt.hidden = false; }, PATIENCE);
    const asked = (what) => this.engine.ask({ number: this.number, depth: this.report.depth, ...what });
    try {
      if (question.ask !== "open" && this.generation !== this.engine.restarts) await asked(this.question());
      this.generation = this.engine.restarts;
      return await asked(question);
    } catch (error) {
      this.proof.className = "verdict open";
      this.proof.textContent = `The engine was started anew: ${error.message}. The last pose stays.`;
      return null;
    } finally {
      clearTimeout(late);
      this.halt.hidden = true;
    }
  }

  showSliders({ title, dimensions, inputs }) {
    this.report.root.querySelector('[data-part="title"]').textContent = title;
    const rows = (list, kind, moved) => list.map((one, k) => new Slider(one, `${kind}-${this.number}-${k}`, moved));
    this.sliders = rows(dimensions, "dimension", (slider, value) => this.move(slider, value));
    this.hand = rows(inputs, "input", (slider, value) => this.drive(slider, value));
    const place = (where, sliders, none) => {
      where.replaceChildren(...sliders.map((slider) => slider.row));
      if (sliders.length === 0) where.append(made("p", { className: "faint" }, none));
    };
    place(this.dimensions, this.sliders, "The scene gives no length and no angle as a number.");
    place(this.hands, this.hand, "Nothing is driven.");
  }

  /** The sliders of the inputs stand where the picture does. */
  showInputs() {
    const { values } = this.report.data;
    for (const slider of this.hand) {
      const value = values.find(({ name }) => name === slider.name)?.at[this.report.frame];
      if (typeof value === "number" && !slider.isHeld && !slider.isAsked) slider.put(value);
    }
  }

  move(slider, value) {
    this.enqueue({ ask: "move", name: slider.name, value: String(value) }, slider, value);
  }

  drive(slider, value) {
    this.report.stop();
    this.enqueue({ ask: "drive", time: this.report.time, inputs: [[slider.name, value]] }, slider, value);
  }

  /** A point of a body is pulled towards a line of sight. */
  pull({ body, point, sight }) {
    this.report.stop();
    this.enqueue({ ask: "pull", time: this.report.time, body, point, to: sight.from, along: sight.along });
  }

  /** Lists the assemblies of the present values; another value has others. */
  async findAssemblies() {
    this.counted.textContent = "Searching …";
    const found = await this.ask({ ask: "assemblies" });
    this.forgetAssemblies();
    if (!found) return;
    if (found.mistakes) this.tell(found);
    else this.showAssemblies(found);
  }

  showAssemblies({ headline, assemblies }) {
    this.counted.textContent = `${headline}: a count, not a proof.`;
    this.guesses = assemblies.map(({ guess }) => guess);
    const options = assemblies.map(({ label }, k) => made("option", { value: String(k) }, label));
    this.assemblies.replaceChildren(...options);
    this.assemblies.value = String(assemblies.findIndex(({ now }) => now));
    this.assemblies.hidden = assemblies.length === 0;
  }

  forgetAssemblies() {
    this.counted.textContent = "";
    this.assemblies.hidden = true;
  }

  choose() {
    const guess = this.guesses[Number(this.assemblies.value)];
    this.enqueue({ ask: "choose", guess });
  }

  /** Asks for the latest wish only: sliders move faster than any mechanism is solved. */
  async enqueue(question, slider = null, value = 0) {
    this.wanted = { question, slider, value };
    if (slider) slider.isAsked = true;
    if (this.isBusy) return;
    this.isBusy = true;
    clearTimeout(this.resting);
    this.moveOn();
    try {
      while (this.wanted) {
        const wish = this.wanted;
        this.wanted = null;
        const state = await this.ask(wish.question);
        if (state) this.answered(wish, state);
      }
    } finally {
      this.isBusy = false;
    }
    this.rest();
  }

  answered({ question, slider, value }, state) {
    for (const other of [...this.sliders, ...this.hand]) other.row.classList.remove("stopped");
    const { stopped } = state;
    const isRead = this.tell(state);
    if (slider) slider.isAsked = this.wanted?.slider === slider;
    slider?.answer(isRead && !stopped ? value : slider.value, !isRead || Boolean(stopped));
    if (!isRead) return;
    this.told.hidden = !stopped;
    this.told.textContent = stopped ? `${stopped.why}. The last pose stays.` : "";
    this.force.hidden = !(stopped && question.ask === "move");
    this.forced = question;
    if (["move", "assemble"].includes(question.ask)) this.forgetAssemblies();
    this.take(state);
  }

  /** Shows mistakes; whether there are none. */
  tell({ mistakes = [] }) {
    this.mistakes.replaceChildren(...mistakes.map((mistake) => this.mistake(mistake)));
    this.told.hidden = mistakes.length === 0;
    this.told.textContent = mistakes.length ? `${mistakes[0].message}. The last pose stays.` : "";
    return mistakes.length === 0;
  }

  mistake({ place, message, label, hints }) {
    const item = made("li", {});
    if (place) {
      const jump = made("button", { type: "button" }, `line ${place.line}, column ${place.column}`);
      jump.addEventListener("click", () => {
        this.editor.focus();
        this.editor.setSelectionRange(place.from, place.to);
      });
      item.append(jump, " ");
    }
    item.append([message, label].filter(Boolean).join(": "));
    for (const hint of hints) item.append(made("div", { className: "faint" }, hint));
    return item;
  }

  /** Shows a motion at once; curves and tables below wait until the slider rests. */
  take(state, isOther = false) {
    this.showProof(state.proof);
    this.clearance.classList.add("stale");
    this.parameters = new Map(Object.entries(state.parameters));
    this.guess = state.guess;
    this.release.hidden = !state.held;
    this.sections.classList.add("stale");
    this.sections.inert = true;
    this.report.takeMotion(state, isOther);
  }

  /** Closure and certificates of the poses, and what happens on the way. */
  showProof({ class: state, head, text, events }) {
    this.proof.className = `verdict ${state}`;
    this.proof.replaceChildren(made("strong", {}, head), made("div", {}, text));
    this.events.replaceChildren(...events.map((event) => made("li", {}, event)));
  }

  /** The clearances first, then the whole article. */
  async settle() {
    if (this.isBusy || this.isJudging || !this.release.hidden) return;
    this.isJudging = true;
    const late = setTimeout(() => { this.halt.hidden = false; }, PATIENCE);
    const asked = (question) => this.judge.ask({ number: this.number, depth: this.report.depth, ...question });
    try {
      await asked(this.question());
      this.showClearance(await asked({ ask: "clearance" }));
      this.showArticle(await asked({ ask: "settle" }));
      this.isJudged = true;
    } catch (error) {
      this.isJudged = error.message !== MOVED_ON;
      this.told.hidden = !this.isJudged;
      this.told.textContent = `The answers below are those of an earlier motion: ${error.message}.`;
    }
    clearTimeout(late);
    this.isJudging = false;
    this.halt.hidden = true;
    if (this.judge.memory > MOST_MEMORY) this.judge.fail(MOVED_ON);
    // Another mechanism of the page may have stopped it.
    if (!this.isJudged && !this.isBusy) this.rest();
  }

  showClearance({ mistakes, clearance, proof }) {
    if (mistakes || this.isBusy) return;
    this.showProof(proof);
    this.clearance.hidden = !clearance;
    this.clearance.className = `verdict ${clearance?.class}`;
    this.clearance.replaceChildren(made("strong", {}, "Clearance: "), clearance?.text ?? "");
  }

  showArticle(settled) {
    if (settled.mistakes || this.isBusy) return;
    this.verdict.className = `verdict ${settled.class}`;
    this.verdict.textContent = settled.result;
    // Markup of the program: every text of a scene in it is escaped, and the policy lets no script in it run.
    this.sections.innerHTML = settled.sections;
    this.sections.classList.remove("stale");
    this.sections.inert = false;
    this.report.takeArticle(settled.data);
    this.report.root.dispatchEvent(new CustomEvent("settled"));
  }

  async assembleThere() {
    const { name, value } = this.forced;
    const slider = this.sliders.find((one) => one.name === name);
    await this.enqueue({ ask: "assemble", name, value }, slider, Number(value));
    slider?.put(slider.value);
  }

  async reset() {
    this.parameters = new Map(this.source.parameters);
    this.guess = this.source.guess;
    await this.open(true);
  }

  /** Reads the edited text in place of the one before; with mistakes everything stays as it was. */
  async read() {
    const before = [this.text, this.parameters, this.guess];
    [this.text, this.parameters, this.guess] = [this.editor.value, new Map(), []];
    const state = await this.ask({ ...this.question(), shapes: true });
    if (!state || !this.tell(state)) {
      [this.text, this.parameters, this.guess] = before;
      return;
    }
    this.showSliders(state.sliders);
    this.forgetAssemblies();
    this.take(state, true);
    this.rest();
  }

  async toml() {
    const { text } = (await this.ask({ ask: "toml" })) ?? {};
    if (!text) this.saved.textContent = "The values cannot be put into this text.";
    return text;
  }

  async copy() {
    const text = await this.toml();
    if (!text) return;
    this.editor.value = text;
    try {
      await navigator.clipboard.writeText(text);
      this.saved.textContent = "Copied.";
    } catch {
      this.editor.closest("details").open = true;
      this.editor.select();
      this.saved.textContent = "Selected: copy it with the keys of your system.";
    }
  }

  async save(kind, type) {
    this.saved.textContent = "…";
    const { time } = this.report;
    const file = kind === "toml" ? await this.toml() : await this.ask({ ask: kind, time });
    if (!file || file.mistakes) return;
    const address = URL.createObjectURL(new Blob([file], { type }));
    const link = made("a", { href: address, download: `${this.source.file}.${kind}` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 10000);
    this.saved.textContent = `${this.source.file}.${kind}: ${file.length} ${kind === "toml" ? "characters" : "bytes"}`;
  }

  /** Draws by the program's own renderer, where the browser has no WebGL. */
  async draw(canvas, time) {
    const [width, height] = PICTURE;
    const pixels = await this.ask({ ask: "picture", time, size: PICTURE });
    if (!pixels || pixels.mistakes) return;
    Object.assign(canvas, { width, height });
    canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), width, height), 0, 0);
  }
}

/** Starts the engine once, and a mechanism as soon as it is on the screen. */
async function enliven(reports) {
  const parts = reports.filter((report) => report.data.live);
  try {
    const module = await compiledEngine();
    const engines = { engine: new Engine(module), judge: new Engine(module) };
    await engines.engine.ready;
    for (const report of parts) {
      const watch = new IntersectionObserver((entries) => {
        if (!entries[entries.length - 1].isIntersecting) return;
        watch.disconnect();
        report.live = new Live(report, engines);
        report.draw();
      }, { rootMargin: "200px" });
      watch.observe(report.root.querySelector(".stage") ?? report.root);
    }
  } catch (error) {
    for (const report of parts) {
      const place = report.root.querySelector('[data-part="bench"]');
      place.replaceChildren(made("p", { className: "verdict open" }, `The sliders stay away: the engine did not start (${error.message}). Everything else is here.`));
      place.hidden = false;
    }
  }
}

if (typeof document !== "undefined") enliven(window.reports);

if (typeof module !== "undefined") module.exports = { niceStep, multiple };
