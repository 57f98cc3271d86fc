"use strict";
// The moving parts of a report: one time slider for the 3-D view, the table of values and the playheads of all curves.
// Without this script the page is complete, but stands still.

const SVG = "http://www.w3.org/2000/svg";

/** Radians that an arrow key turns the view by. */
const KEY_TURN = 0.12;

/** The last frame at or before a time; the first where there is none. */
function frameAt(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}

/** The frame whose place is nearest to `x`; null where none has a place. */
function frameNearest(places, x) {
  let best = null;
  places.forEach((place, frame) => {
    if (place === null) return;
    if (best === null || Math.abs(place - x) < Math.abs(places[best] - x)) best = frame;
  });
  return best;
}

/** A value in six digits, so that its width hardly changes while it moves. */
function shown(value) {
  if (value === null) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e7)) return value.toExponential(3);
  return value.toFixed(Math.max(0, Math.min(6, 5 - Math.floor(Math.log10(Math.max(size, 1))))));
}

/** One mechanism on the page. */
class Report {
  constructor(root, data) {
    this.root = root;
    this.data = data;
    this.frame = 0;
    this.mark = null;
    this.viewer = null;
    this.playing = 0;
    if (data.times.length === 0) return;
    this.find();
    this.listen();
    this.showControls();
    this.watchView();
    this.show(0);
  }

  find() {
    const part = (name) => this.root.querySelector(`[data-part="${name}"]`);
    this.slider = part("slider");
    this.play = part("play");
    this.clock = part("clock");
    this.canvas = part("canvas");
    this.still = part("still");
    this.note = part("note");
    this.caption = part("caption");
    this.cells = [...this.root.querySelectorAll("[data-value]")];
    this.heads = this.data.charts.map((chart) => new Playheads(document.getElementById(chart.id), chart));
  }

  showControls() {
    for (const part of this.root.querySelectorAll("[data-live]")) part.hidden = false;
    this.slider.max = String(this.data.times.length - 1);
  }

  listen() {
    this.slider.addEventListener("input", () => {
      this.stop();
      this.show(Number(this.slider.value));
    });
    this.play.addEventListener("click", () => this.toggle());
    for (const button of this.root.querySelectorAll("[data-frame]")) {
      button.addEventListener("click", () => this.jump(button));
    }
    this.heads.forEach((head) => head.listen((frame) => {
      this.stop();
      this.show(frame);
    }));
    this.root.querySelector('[data-part="reset"]').addEventListener("click", () => {
      this.viewer?.orbit.reset();
      this.draw();
    });
    if (this.canvas) this.listenToCanvas();
  }

  /** A "show" button: the frame it names, with the two points of its pair. */
  jump(button) {
    this.stop();
    const mark = button.dataset.mark;
    this.show(Number(button.dataset.frame), mark === undefined ? null : this.data.marks[Number(mark)]);
    const stage = this.root.querySelector(".stage");
    stage.scrollIntoView({ block: "nearest" });
    this.slider.focus({ preventScroll: true });
  }

  listenToCanvas() {
    const fingers = new Map();
    const spread = () => {
      const [a, b] = [...fingers.values()];
      return Math.hypot(a[0] - b[0], a[1] - b[1]);
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const name of ["pointerup", "pointercancel"]) {
      this.canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
    }
    this.canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before || !this.viewer) return;
      const moved = [event.clientX - before[0], event.clientY - before[1]];
      const width = fingers.size > 1 ? spread() : 1;
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      if (fingers.size > 1) this.viewer.orbit.approach(spread() / (width || 1));
      this.drag(moved, fingers.size > 1 || event.shiftKey || event.buttons === 2);
    });
    this.canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    this.canvas.addEventListener("wheel", (event) => {
      // The page scrolls where the reader does not hold a key: a report is read from top to bottom.
      if (!this.viewer || !(event.ctrlKey || event.altKey)) return;
      event.preventDefault();
      this.viewer.orbit.approach(Math.exp(-event.deltaY / 500));
      this.draw();
    }, { passive: false });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("webglcontextlost", () => this.closeView());
  }

  drag([right, down], isShift) {
    const height = this.canvas.clientHeight || 1;
    if (isShift) this.viewer.orbit.shift(-right / height, down / height);
    else this.viewer.orbit.turn((-4 * right) / height, (4 * down) / height);
    this.draw();
  }

  key(event) {
    const orbit = this.viewer?.orbit;
    if (!orbit) return;
    const actions = {
      ArrowLeft: () => orbit.turn(-KEY_TURN, 0),
      ArrowRight: () => orbit.turn(KEY_TURN, 0),
      ArrowUp: () => orbit.turn(0, KEY_TURN),
      ArrowDown: () => orbit.turn(0, -KEY_TURN),
      "+": () => orbit.approach(1.2),
      "-": () => orbit.approach(1 / 1.2),
      Home: () => orbit.reset(),
      " ": () => this.toggle(),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
    this.draw();
  }

  /** Opens the view while it is on the screen and closes it when it has left. */
  watchView() {
    if (!this.canvas || !this.data.model) return;
    const watch = new IntersectionObserver((entries) => {
      const isSeen = entries[entries.length - 1].isIntersecting;
      if (isSeen && !this.viewer) this.openView();
      else if (!isSeen && this.viewer && document.querySelectorAll("article").length > 1) this.closeView();
    }, { rootMargin: "200px" });
    watch.observe(this.root.querySelector(".stage"));
    new ResizeObserver(() => this.draw()).observe(this.root.querySelector(".stage"));
  }

  openView() {
    // A canvas whose context was given back cannot be used again.
    const fresh = this.canvas.cloneNode();
    this.canvas.replaceWith(fresh);
    this.canvas = fresh;
    this.listenToCanvas();
    try {
      fresh.hidden = false;
      this.viewer = new Viewer(fresh, this.data.model);
      this.still.hidden = true;
      this.note.hidden = true;
      this.draw();
    } catch (error) {
      this.viewer = null;
      fresh.hidden = true;
      this.still.hidden = false;
      this.note.hidden = false;
      this.note.textContent = `The picture stands still: this browser shows no 3-D here (${error.message}).`;
      for (const part of this.root.querySelectorAll('[data-part="reset"], [data-part="hint"]')) part.hidden = true;
    }
  }

  closeView() {
    const viewer = this.viewer;
    this.viewer = null;
    this.still.hidden = false;
    this.canvas.hidden = true;
    viewer?.close();
  }

  toggle() {
    if (this.playing) return this.stop();
    const { times } = this.data;
    if (this.frame === times.length - 1) this.show(0);
    let last = null;
    let time = times[this.frame];
    const step = (now) => {
      if (last !== null) time += (now - last) / 1000;
      last = now;
      if (time > times[times.length - 1]) time = times[0];
      this.show(frameAt(times, time));
      this.playing = requestAnimationFrame(step);
    };
    this.playing = requestAnimationFrame(step);
    this.play.textContent = "Pause";
    return undefined;
  }

  stop() {
    if (!this.playing) return;
    cancelAnimationFrame(this.playing);
    this.playing = 0;
    this.play.textContent = "Play";
  }

  /** Shows a frame everywhere. */
  show(frame, mark = null) {
    this.frame = Math.max(0, Math.min(this.data.times.length - 1, frame));
    this.mark = mark;
    const time = `${shown(this.data.times[this.frame])} s`;
    this.slider.value = String(this.frame);
    this.slider.setAttribute("aria-valuetext", time);
    this.clock.textContent = `t = ${time}`;
    this.caption.textContent = mark ? mark.text : "";
    for (const cell of this.cells) {
      cell.textContent = shown(this.data.values[Number(cell.dataset.value)].at[this.frame]);
    }
    this.heads.forEach((head) => head.show(this.frame));
    this.draw();
  }

  draw() {
    this.viewer?.draw(this.frame, this.mark && this.mark.points);
  }
}

/** The line and dots on the curves of one chart that say where the slider stands. */
class Playheads {
  constructor(svg, chart) {
    this.svg = svg;
    this.panels = chart.panels;
    this.parts = chart.panels.map((panel) => this.draw(panel));
  }

  draw(panel) {
    const add = (name, attributes) => {
      const element = document.createElementNS(SVG, name);
      for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
      this.svg.append(element);
      return element;
    };
    const [, top, , bottom] = panel.box;
    const line = panel.equal ? null : add("line", { y1: top, y2: bottom, class: "playhead" });
    const dots = panel.y.map((_, k) => add("circle", { r: 4.2, class: `dot s${k % 8}` }));
    return { line, dots };
  }

  show(frame) {
    this.panels.forEach((panel, k) => {
      const { line, dots } = this.parts[k];
      const x = panel.x[frame];
      if (line) this.put(line, { x1: x, x2: x }, x !== null);
      dots.forEach((dot, curve) => {
        const point = panel.y[curve][frame];
        this.put(dot, point ? { cx: point[0], cy: point[1] } : {}, point !== null);
      });
    });
  }

  put(element, attributes, isThere) {
    element.setAttribute("visibility", isThere ? "visible" : "hidden");
    if (!isThere) return;
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  }

  /** A click or a drag in a panel chooses the frame below it. */
  listen(choose) {
    const at = (event) => {
      if (event.type === "pointermove" && event.buttons === 0) return;
      const matrix = this.svg.getScreenCTM();
      if (!matrix) return;
      const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
      const panel = this.panels.find(({ box, equal }) => !equal && place.x >= box[0] && place.x <= box[2]
        && place.y >= box[1] && place.y <= box[3]);
      const frame = panel ? frameNearest(panel.x, place.x) : null;
      if (frame !== null) choose(frame);
    };
    this.svg.addEventListener("pointerdown", at);
    this.svg.addEventListener("pointermove", at);
  }
}

if (typeof document !== "undefined") {
  const all = JSON.parse(document.getElementById("data").textContent);
  window.reports = all.map((data, k) => new Report(document.getElementById(`scene-${k + 1}`), data));
}

if (typeof module !== "undefined") module.exports = { frameAt, frameNearest, shown };
