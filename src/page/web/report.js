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

/** An element with properties and children; texts never become markup. */
function made(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in element) element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

/** The bodies of a model, each part with its mesh; those of bodies that are not replaced stay. */
function joinedModel(known, news) {
  if (!news) return known;
  const { meshes, parts, replaced, ...others } = news;
  const stay = replaced && known ? known.parts.filter(({ body }) => !replaced.includes(body)) : [];
  const fresh = parts.map((part) => ({ ...part, mesh: meshes[part.mesh] }));
  return { ...known, ...others, parts: [...stay, ...fresh].sort((a, b) => a.body - b.body) };
}

/** One mechanism on the page. */
class Report {
  constructor(root, data, number) {
    this.root = root;
    this.number = number;
    this.depth = document.querySelectorAll("article").length > 1 ? 3 : 2;
    this.data = { ...data, model: joinedModel(data.model, data.model) };
    this.orbit = null;
    this.live = null;
    /** Reports that show the same time from the same side: another version of the mechanism. */
    this.peers = [];
    /** The time that is shown, also while the inputs are led by hand. */
    this.time = 0;
    this.isHeld = false;
    this.frame = 0;
    this.mark = null;
    /** The point of a body that a reader pulls, and the line of sight that it is pulled to. */
    this.pulled = null;
    this.viewer = null;
    this.playing = 0;
    if (data.times.length === 0) return;
    this.find();
    this.listen();
    this.listenToSections();
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
    this.findHeads();
  }

  findHeads() {
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
    this.root.querySelector('[data-part="reset"]').addEventListener("click", () => {
      this.viewer?.orbit.reset();
      this.drawAll();
    });
    if (this.canvas) this.listenToCanvas();
  }

  listenToSections() {
    for (const button of this.root.querySelectorAll("[data-frame]")) {
      button.addEventListener("click", () => this.jump(button));
    }
    this.heads.forEach((head) => head.listen((frame) => {
      this.stop();
      this.show(frame);
    }));
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
      this.letGo();
      if (fingers.size === 1 && event.button === 0 && !event.shiftKey) this.pulled = this.linkBelow(event);
    });
    for (const name of ["pointerup", "pointercancel"]) {
      this.canvas.addEventListener(name, (event) => {
        fingers.delete(event.pointerId);
        this.letGo();
      });
    }
    this.canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!this.viewer) return;
      if (!before) this.canvas.classList.toggle("link", this.linkBelow(event) !== null);
      if (this.pulled) this.pullTo(this.viewer.sightBelow(event));
      if (!before || this.pulled) return;
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
      this.drawAll();
    }, { passive: false });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("webglcontextlost", () => this.closeView());
  }

  /** The moving body below a pointer and the point of it there, on a page that can move it. */
  linkBelow(event) {
    if (!this.live || !this.viewer) return null;
    return this.viewer.bodyOn(this.viewer.sightBelow(event), this.frame);
  }

  pullTo(sight) {
    this.pulled.sight = sight;
    this.live.pull(this.pulled);
    this.draw();
  }

  letGo() {
    if (!this.pulled) return;
    this.pulled = null;
    this.draw();
  }

  /** The line from a pulled point to where it is pulled. */
  pullMark() {
    if (!this.pulled?.sight) return null;
    const { body, point, sight } = this.pulled;
    const place = this.viewer.placeOf(body, this.frame, point);
    const there = sum(sight.from, sight.along, dot(sum(place, sight.from, -1), sight.along));
    return [place, there];
  }

  drag([right, down], isShift) {
    const height = this.canvas.clientHeight || 1;
    if (isShift) this.viewer.orbit.shift(-right / height, down / height);
    else this.viewer.orbit.turn((-4 * right) / height, (4 * down) / height);
    this.drawAll();
  }

  /** Draws, and lets the others look from the same side. */
  drawAll() {
    this.draw();
    for (const peer of this.peers) {
      peer.viewer?.orbit.follow(this.viewer.orbit);
      peer.draw();
    }
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
    this.drawAll();
  }

  /** Opens the view while it is on the screen and closes it when it has left. */
  watchView() {
    if (!this.canvas || !this.data.model || this.isWatched) return;
    this.isWatched = true;
    const watch = new IntersectionObserver((entries) => {
      const isSeen = entries[entries.length - 1].isIntersecting;
      if (isSeen && !this.viewer && this.data.model) this.openView();
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
      this.viewer = new Viewer(fresh, this.data.model, this.orbit);
      this.orbit = this.viewer.orbit;
      this.drawing?.remove();
      this.still.hidden = true;
      this.note.hidden = true;
      this.draw();
    } catch (error) {
      this.viewer = null;
      fresh.hidden = true;
      this.still.hidden = false;
      this.note.hidden = false;
      this.note.textContent = `The picture does not move: this browser shows no 3-D here (${error.message}).`;
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
  show(frame, mark = null, isEcho = false) {
    this.frame = Math.max(0, Math.min(this.data.times.length - 1, frame));
    this.mark = mark;
    if (!this.isHeld) this.time = this.data.times[this.frame] ?? 0;
    const time = this.isHeld ? "by hand" : `${shown(this.time)} s`;
    this.slider.value = String(this.frame);
    this.slider.setAttribute("aria-valuetext", time);
    this.clock.textContent = this.isHeld ? time : `t = ${time}`;
    this.caption.textContent = mark ? mark.text : "";
    for (const cell of this.cells) {
      const value = this.data.values[Number(cell.dataset.value)];
      cell.textContent = value ? shown(value.at[this.frame] ?? null) : "–";
    }
    this.heads.forEach((head) => head.show(this.frame));
    this.live?.showInputs();
    this.draw();
    if (!isEcho) this.peers.forEach((peer) => peer.showTime(this.data.times[this.frame]));
  }

  /** Shows the frame at a time, because another report does. */
  showTime(time) {
    this.show(frameAt(this.data.times, time + 1e-9), null, true);
  }

  draw() {
    if (!this.viewer) this.drawStill();
    else this.viewer.draw(this.frame, this.pullMark() ?? this.mark?.points);
  }

  /** Where there is no 3-D view, the program itself draws the pose, as soon as it has time. */
  async drawStill() {
    if (!this.live || this.isDrawing || !this.still || !this.data.times.length) return;
    this.isDrawing = true;
    this.drawing ??= made("canvas", { className: "drawn", "aria-label": this.still.alt, role: "img" });
    let frame = null;
    while (frame !== this.frame && !this.viewer) {
      frame = this.frame;
      await this.live.draw(this.drawing, this.data.times[frame]);
    }
    if (!this.viewer && !this.drawing.isConnected) this.still.after(this.drawing);
    this.still.hidden = true;
    this.note.textContent = this.data.model
      ? "Drawn by the program itself: this browser shows no 3-D here."
      : "Drawn by the program itself.";
    this.isDrawing = false;
  }

  /** Takes another motion over, and with it other shapes; the time stays as near as it can. What is shown of another scene
      (`isOther`) is forgotten. */
  takeMotion({ times, values, motion, model, held = false }, isOther = false) {
    if (isOther && !model) this.forgetModel();
    const known = this.data.model;
    this.data = { ...this.data, times, values };
    if (known || model) this.data.model = { ...joinedModel(known, model), ...motion };
    if (model?.camera) this.orbit = null;
    if (model) this.viewer?.takeShapes(this.data.model);
    if (model?.camera && this.viewer) this.orbit = this.viewer.orbit;
    this.viewer?.takeMotion(this.data.model);
    this.showValues();
    this.slider.max = String(Math.max(0, times.length - 1));
    this.heads = [];
    this.isHeld = held;
    if (isOther && model && this.isWatched && !this.viewer) this.openView();
    this.watchView();
    this.show(frameAt(times, this.time + 1e-9));
  }

  /** The view of a scene without bodies that can be turned: the program draws it. */
  forgetModel() {
    this.data.model = null;
    this.orbit = null;
    if (this.viewer) this.closeView();
  }

  /** Takes over an article made anew: its frames, curves and buttons. */
  takeArticle(data) {
    this.data.charts = data.charts;
    this.data.marks = data.marks;
    this.findHeads();
    this.listenToSections();
    for (const part of this.root.querySelectorAll('[data-part="sections"] [data-live]')) part.hidden = false;
    if (data.times.length) this.takeFrames(data);
  }

  takeFrames({ times, values, model }) {
    const { heads } = this;
    this.takeMotion({ times, values, motion: model ?? {}, model: null });
    this.heads = heads;
    this.show(this.frame);
  }

  /** The table of values that follow the slider: another text of a scene has others. */
  showValues() {
    const names = this.data.values.map((value) => value.name).join("\n");
    if (names === this.names || !this.cells.length) return;
    this.names = names;
    const body = this.cells[0].closest("tbody");
    this.cells = this.data.values.map((_, k) => made("td", { className: "number", "data-value": String(k) }));
    body.replaceChildren(...this.data.values.map(({ name, unit }, k) => (
      made("tr", {}, made("td", {}, name), this.cells[k], made("td", {}, unit)))));
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
  window.reports = all.map((data, k) => new Report(document.getElementById(`scene-${k + 1}`), data, k + 1));
  if (document.querySelector("[data-linked]")) {
    const moving = window.reports.filter((report) => report.data.times.length);
    for (const report of moving) report.peers = moving.filter((other) => other !== report);
  }
}

if (typeof module !== "undefined") module.exports = { joinedModel, frameAt, frameNearest, shown };
