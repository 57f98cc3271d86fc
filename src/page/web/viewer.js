"use strict";
// The 3-D view of a report: bodies as the program meshed them, at the poses that it solved. Plain WebGL2, no library.
//
// Everything that arrives is numbers: meshes whose corners are 16-bit shares of their box, normals folded into two
// bytes, and for every body one quaternion and one place a frame, as 32-bit floats.

/** The bytes of a base64 text, as the given kind of array. */
function numbersOf(base64, Kind) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k += 1) bytes[k] = text.charCodeAt(k);
  return new Kind(bytes.buffer);
}

// Vectors are arrays of three numbers.
const sum = (a, b, share = 1) => a.map((v, k) => v + share * b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a, factor) => a.map((v) => v * factor);
const unit = (a) => scaled(a, 1 / (Math.hypot(...a) || 1));

/** The columns of a unit quaternion's rotation matrix (x, y, z, w). */
function turnOf(x, y, z, w) {
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w),
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y),
  ];
}

/** Highest angle above the horizon: straight down, no direction would be "up" in the picture. */
const STEEPEST = 1.55;

/** A camera that looks at a target and is led around it by two angles about the direction that is up. */
class Orbit {
  /** `camera` has target, back (towards the eye), up, distance, extent, and fov (radians) or height. */
  constructor(camera) {
    this.start = camera;
    this.up = unit(camera.up);
    const other = Math.abs(this.up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
    this.east = unit(cross(other, this.up));
    this.north = cross(this.up, this.east);
    this.reset();
  }

  reset() {
    const back = unit(this.start.back);
    this.azimuth = Math.atan2(dot(back, this.north), dot(back, this.east));
    this.elevation = Math.asin(Math.max(-1, Math.min(1, dot(back, this.up))));
    this.target = this.start.target;
    this.zoom = 1;
  }

  /** Turns by angles in radians. */
  turn(sideways, upwards) {
    this.azimuth += sideways;
    this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, this.elevation + upwards));
  }

  /** Looks from where another one does; each keeps its own distance. */
  follow({ azimuth, elevation, zoom, target }) {
    Object.assign(this, { azimuth, elevation, zoom, target });
  }

  /** Comes nearer by a factor above one. */
  approach(factor) {
    this.zoom = Math.max(0.1, Math.min(40, this.zoom * factor));
  }

  /** The camera's axes in the world: right, up and back. */
  axes() {
    const [sinA, cosA] = [Math.sin(this.azimuth), Math.cos(this.azimuth)];
    const [sinE, cosE] = [Math.sin(this.elevation), Math.cos(this.elevation)];
    const flat = sum(scaled(this.east, cosA), this.north, sinA);
    const right = sum(scaled(this.east, -sinA), this.north, cosA);
    const back = sum(scaled(flat, cosE), this.up, sinE);
    return [right, cross(back, right), back];
  }

  /** Height of what is seen at the target. */
  span() {
    const { fov, height, distance } = this.start;
    return (fov === null ? height : 2 * distance * Math.tan(fov / 2)) / this.zoom;
  }

  /** Moves the target by shares of the picture's height. */
  shift(rightwards, upwards) {
    const [right, up] = this.axes();
    this.target = sum(sum(this.target, right, rightwards * this.span()), up, upwards * this.span());
  }

  /** The matrix from the world to the picture, column by column, for a picture `aspect` times as wide as high. */
  matrix(aspect) {
    const { fov, distance, extent } = this.start;
    const [right, up, back] = this.axes();
    // A picture narrower than the program's holds the same width.
    const narrow = Math.min(1, aspect / this.start.aspect);
    const far = distance / this.zoom;
    const eye = sum(this.target, back, far);
    const view = [right, up, back].map((axis) => [...axis, -dot(axis, eye)]);
    const [near, end] = [far - 1.5 * extent, far + 1.5 * extent];
    const rows = fov === null
      ? this.parallel(view, narrow, aspect, [near, end])
      : this.perspective(view, narrow, aspect, [Math.max(near, 0.01 * far), end]);
    return [0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column]));
  }

  /** The line of sight through a place of the picture, both entries from -1 to 1: a point of it and its direction. */
  sight(aspect, [across, upwards]) {
    const { fov, distance } = this.start;
    const [right, up, back] = this.axes();
    const narrow = Math.min(1, aspect / this.start.aspect);
    const eye = sum(this.target, back, distance / this.zoom);
    const half = (fov === null ? this.span() / 2 : Math.tan(fov / 2)) / narrow;
    const aside = sum(scaled(right, across * aspect * half), up, upwards * half);
    return fov === null
      ? { from: sum(eye, aside), along: scaled(back, -1) }
      : { from: eye, along: unit(sum(aside, back, -1)) };
  }

  perspective(view, narrow, aspect, [near, far]) {
    const f = narrow / Math.tan(this.start.fov / 2);
    const [a, b] = [(far + near) / (near - far), (2 * far * near) / (near - far)];
    const depth = scaled(view[2], a);
    depth[3] += b;
    return [scaled(view[0], f / aspect), scaled(view[1], f), depth, scaled(view[2], -1)];
  }

  parallel(view, narrow, aspect, [near, far]) {
    const f = (2 * narrow) / this.span();
    const depth = scaled(view[2], 2 / (near - far));
    depth[3] += (far + near) / (near - far);
    return [scaled(view[0], f / aspect), scaled(view[1], f), depth, [0, 0, 0, 1]];
  }
}

const SOLID_VERTEX = `#version 300 es
in vec3 aPosition;   // share of the mesh's box
in vec2 aNormal;     // folded octahedron
uniform mat4 uCamera;
uniform mat3 uTurn;
uniform vec3 uPlace, uLow, uSize;
out vec3 vNormal;
void main() {
  vec3 n = vec3(aNormal, 1.0 - abs(aNormal.x) - abs(aNormal.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  vNormal = uTurn * n;
  gl_Position = uCamera * vec4(uTurn * (uLow + aPosition * uSize) + uPlace, 1.0);
}`;

// A light from behind the viewer's shoulder, one from above, and what the surroundings give.
const SOLID_FRAGMENT = `#version 300 es
precision mediump float;
in vec3 vNormal;
uniform vec4 uColour;
uniform vec3 uKey, uUp;
out vec4 colour;
void main() {
  vec3 n = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
  float key = max(dot(n, uKey), 0.0);
  float sky = 0.5 + 0.5 * dot(n, uUp);
  float shine = pow(key, 24.0) * 0.16;
  colour = vec4(uColour.rgb * (0.36 + 0.52 * key + 0.2 * sky) + shine, uColour.a);
}`;

// A line as wide as asked, in pixels: a quad between two points, square to it on the screen.
const LINE_VERTEX = `#version 300 es
in vec3 aFrom, aTo;
uniform mat4 uCamera;
uniform vec2 uPixels;
uniform float uWidth;
void main() {
  vec4 a = uCamera * vec4(aFrom, 1.0), b = uCamera * vec4(aTo, 1.0);
  vec2 along = (b.xy / b.w - a.xy / a.w) * uPixels;
  vec2 side = length(along) > 1e-6 ? normalize(vec2(-along.y, along.x)) : vec2(0.0, 1.0);
  vec4 end = (gl_VertexID & 1) == 0 ? a : b;
  float hand = gl_VertexID < 2 ? -1.0 : 1.0;
  end.xy += hand * side * uWidth / uPixels * end.w;
  end.z -= 2e-4 * end.w;
  gl_Position = end;
}`;

const LINE_FRAGMENT = `#version 300 es
precision mediump float;
uniform vec4 uColour;
out vec4 colour;
void main() { colour = uColour; }`;

/** Colour of the line between the two nearest points of a pair. */
const MARK = [0.85, 0.1, 0.1, 1];

/** Milliseconds of a picture above which edges are left rough while something moves, ... */
const MOST_MILLISECONDS = 6;

/** ... and after which nothing moves any more. */
const SETTLED = 150;

/** Samples of a pixel on smooth edges. */
const SAMPLES = 4;

/** A picture with several samples a pixel, beside that of the canvas. */
class SmoothTarget {
  constructor(gl) {
    this.gl = gl;
    this.size = [0, 0];
    this.frame = gl.createFramebuffer();
    const kinds = [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]];
    this.layers = kinds.map(([kind, place]) => ({ kind, place, buffer: gl.createRenderbuffer() }));
    this.samples = Math.min(SAMPLES, gl.getParameter(gl.MAX_SAMPLES));
  }

  /** What is drawn from now on is drawn here. */
  begin(width, height) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    if (this.size[0] === width && this.size[1] === height) return;
    this.size = [width, height];
    for (const { kind, place, buffer } of this.layers) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, this.samples, kind, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
    }
  }

  /** Shows it on the canvas. */
  end() {
    const { gl, size: [width, height] } = this;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.frame);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }
}

/** Draws one mechanism into one canvas. */
class Viewer {
  /** Throws where the browser has no WebGL2. */
  constructor(canvas, model, orbit = null) {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: true, premultipliedAlpha: false });
    if (!gl) throw new Error("no WebGL2");
    this.canvas = canvas;
    this.gl = gl;
    this.smooth = new SmoothTarget(gl);
    /** How long a smooth picture takes, once it is known. */
    this.milliseconds = null;
    this.isPrepared = false;
    this.model = model;
    this.orbit = orbit ?? new Orbit(model.camera);
    this.solid = program(gl, SOLID_VERTEX, SOLID_FRAGMENT, ["aPosition", "aNormal"]);
    this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT, ["aFrom", "aTo"]);
    /** What the graphics memory holds, by mesh. */
    this.meshes = new Map();
    this.traces = [];
    this.takeShapes(model);
    this.takeMotion(model);
    this.markLine = this.lineArray(new Float32Array(6));
  }

  /** Other shapes, and with a camera another place to look from. Meshes that stay are kept. */
  takeShapes(model) {
    this.model = model;
    const before = this.meshes;
    this.meshes = new Map();
    for (const { mesh } of model.parts) {
      if (!this.meshes.has(mesh)) this.meshes.set(mesh, before.get(mesh) ?? this.upload(mesh));
      before.delete(mesh);
    }
    this.forget(before.values());
    if (model.camera && model.camera !== this.orbit.start) this.orbit = new Orbit(model.camera);
  }

  /** Other poses and paths. */
  takeMotion({ bodies, traces }) {
    this.forget(this.traces);
    this.poses = bodies.map((body) => numbersOf(body.poses, Float32Array));
    // A single pose does not tell which bodies move.
    const moves = this.poses.map((poses) => poses.length > 7);
    if (moves.includes(true) || !this.moves) this.moves = moves;
    this.traces = traces.map((trace) => this.uploadTrace(trace));
  }

  /** Gives memory back: a slider moves thousands of times. */
  forget(arrays) {
    for (const { array, buffers } of arrays) {
      this.gl.deleteVertexArray(array);
      buffers.forEach((buffer) => this.gl.deleteBuffer(buffer));
    }
  }

  upload(mesh) {
    const gl = this.gl;
    const buffers = [];
    const buffer = () => {
      buffers.push(gl.createBuffer());
      return buffers[buffers.length - 1];
    };
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const attribute = (place, size, kind, numbers) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer());
      gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, kind, true, 0, 0);
    };
    const positions = numbersOf(mesh.positions, Uint16Array);
    attribute(0, 3, gl.UNSIGNED_SHORT, positions);
    attribute(1, 2, gl.BYTE, numbersOf(mesh.normals, Int8Array));
    const corners = numbersOf(mesh.triangles, mesh.wide ? Uint32Array : Uint16Array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    const kind = mesh.wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;
    return { array, buffers, count: corners.length, kind, low: mesh.low, size: mesh.size, positions, corners };
  }

  uploadTrace(trace) {
    return { ...this.lineArray(numbersOf(trace.points, Float32Array)), runs: trace.runs, colour: trace.colour };
  }

  lineArray(points) {
    const gl = this.gl;
    const [array, buffer] = [gl.createVertexArray(), gl.createBuffer()];
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, points, gl.DYNAMIC_DRAW);
    for (const place of [0, 1]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribDivisor(place, 1);
    }
    return { array, buffer, buffers: [buffer] };
  }

  /** One quad for each pair of neighbouring points, `count` points from number `first` on. */
  strokes({ array, buffer }, first, count) {
    const gl = this.gl;
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    for (const place of [0, 1]) {
      gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 12, 12 * (first + place));
    }
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count - 1);
  }

  /** Draws a frame; `mark` is a pair of points to be joined by a line, or null. Where that takes long, edges are smooth only
      once nothing moves. */
  draw(frame, mark) {
    clearTimeout(this.settling);
    if (this.milliseconds > MOST_MILLISECONDS) {
      this.drawEdged(frame, mark, false);
      this.settling = setTimeout(() => this.drawTimed(frame, mark), SETTLED);
    } else if (this.milliseconds === null) {
      this.drawTimed(frame, mark);
    } else {
      this.drawEdged(frame, mark, true);
    }
  }

  /** Draws a frame smoothly, waits for it, and notes how long that took; not of the first one, which also prepares. */
  drawTimed(frame, mark) {
    const begun = performance.now();
    this.drawEdged(frame, mark, true);
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
    if (this.isPrepared) this.milliseconds = performance.now() - begun;
    this.isPrepared = true;
  }

  drawEdged(frame, mark, isSmooth) {
    const { gl, canvas } = this;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((v) => Math.max(1, Math.round(v * ratio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    if (isSmooth) this.smooth.begin(width, height);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const camera = this.orbit.matrix(width / height);
    this.drawSolids(frame, camera);
    this.drawLines(camera, [width, height], ratio, mark);
    if (isSmooth) this.smooth.end();
  }

  drawSolids(frame, camera) {
    const { gl, solid, model } = this;
    const [right, up, back] = this.orbit.axes();
    gl.useProgram(solid.program);
    gl.uniformMatrix4fv(solid.at("uCamera"), false, camera);
    gl.uniform3fv(solid.at("uKey"), unit(sum(sum(back, up, 0.45), right, -0.35)));
    gl.uniform3fv(solid.at("uUp"), this.orbit.up);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    // What can be seen through is drawn over what cannot.
    for (const isClear of [false, true]) {
      gl.depthMask(!isClear);
      for (const part of model.parts) {
        if (part.opacity < 1 === isClear) this.drawPart(part, frame);
      }
    }
    gl.depthMask(true);
  }

  drawPart(part, frame) {
    const { gl, solid } = this;
    if (!this.hasPose(part.body)) return;
    const { turn, place } = this.poseOf(part.body, frame);
    const mesh = this.meshes.get(part.mesh);
    gl.uniformMatrix3fv(solid.at("uTurn"), false, turn);
    gl.uniform3fv(solid.at("uPlace"), place);
    gl.uniform3fv(solid.at("uLow"), mesh.low);
    gl.uniform3fv(solid.at("uSize"), mesh.size);
    gl.uniform4fv(solid.at("uColour"), [...part.colour.map((v) => v / 255), part.opacity]);
    gl.bindVertexArray(mesh.array);
    gl.drawElements(gl.TRIANGLES, mesh.count, mesh.kind, 0);
  }

  /** Whether a body is anywhere: a motion without poses has no places. */
  hasPose(body) {
    return (this.poses[body]?.length ?? 0) > 0;
  }

  /** The columns of a body's rotation matrix, and its place. */
  poseOf(body, frame) {
    const poses = this.poses[body];
    // A body that stands still has one pose.
    const at = 7 * Math.min(frame, poses.length / 7 - 1);
    return { turn: turnOf(...poses.subarray(at, at + 4)), place: [...poses.subarray(at + 4, at + 7)] };
  }

  /** Where a point of a body is in the world. */
  placeOf(body, frame, point) {
    const { turn, place } = this.poseOf(body, frame);
    return place.map((v, row) => v + turn[row] * point[0] + turn[row + 3] * point[1] + turn[row + 6] * point[2]);
  }

  /** The line of sight below a pointer, which is at pixels of the window. */
  sightBelow({ clientX, clientY }) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    return this.orbit.sight(width / height, [(2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height]);
  }

  /** The nearest moving body on a line of sight, and the point of it in the body's frame; null if none is there. */
  bodyOn({ from, along }, frame) {
    let nearest = { depth: Infinity, body: -1, point: null };
    for (const part of this.model.parts.filter(({ body }) => this.hasPose(body))) {
      const { turn, place } = this.poseOf(part.body, frame);
      const inside = (v) => [0, 3, 6].map((k) => dot(turn.slice(k, k + 3), v));
      const [start, way] = [inside(sum(from, place, -1)), inside(along)];
      const depth = depthOfMesh(this.meshes.get(part.mesh), start, way);
      if (depth < nearest.depth) nearest = { depth, body: part.body, point: sum(start, way, depth) };
    }
    return nearest.point && this.moves[nearest.body] ? nearest : null;
  }

  drawLines(camera, pixels, ratio, mark) {
    const { gl, line } = this;
    gl.useProgram(line.program);
    gl.uniformMatrix4fv(line.at("uCamera"), false, camera);
    gl.uniform2fv(line.at("uPixels"), pixels);
    gl.uniform1f(line.at("uWidth"), 1.6 * ratio);
    for (const trace of this.traces) {
      gl.uniform4fv(line.at("uColour"), [...trace.colour.map((v) => v / 255), 1]);
      let first = 0;
      for (const count of trace.runs) {
        this.strokes(trace, first, count);
        first += count;
      }
    }
    if (!mark) return;
    gl.disable(gl.DEPTH_TEST);
    gl.uniform4fv(line.at("uColour"), MARK);
    gl.uniform1f(line.at("uWidth"), 3 * ratio);
    // A distance may be too short to be seen: a ring on the screen says where it is.
    const points = [...mark, ...this.ringAround(scaled(sum(...mark), 0.5))];
    gl.bindBuffer(gl.ARRAY_BUFFER, this.markLine.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points.flat()), gl.DYNAMIC_DRAW);
    this.strokes(this.markLine, 0, 2);
    gl.uniform1f(line.at("uWidth"), 1.5 * ratio);
    this.strokes(this.markLine, 2, points.length - 2);
  }

  /** A circle in the plane of the picture. */
  ringAround(middle) {
    const [right, up] = this.orbit.axes();
    const radius = 0.022 * this.orbit.span();
    return Array.from({ length: 33 }, (_, k) => {
      const angle = (k * Math.PI) / 16;
      return sum(sum(middle, right, radius * Math.cos(angle)), up, radius * Math.sin(angle));
    });
  }

  /** Gives the browser's memory back: a page may show many mechanisms, a browser few views at a time. */
  close() {
    clearTimeout(this.settling);
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}

/** Levels of a mesh's corners within its box. */
const LEVELS = 65535;

/** Whether a line crosses the box of a mesh, in the levels of its corners. */
function crossesBox(start, way) {
  let [near, far] = [0, Infinity];
  for (let k = 0; k < 3; k += 1) {
    if (way[k] === 0 && (start[k] < 0 || start[k] > LEVELS)) return false;
    if (way[k] === 0) continue;
    const [a, b] = [-start[k] / way[k], (LEVELS - start[k]) / way[k]];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  return near <= far;
}

/** How far a line goes to a mesh's first triangle; infinite if it passes by (Moller and Trumbore, 1997). */
function depthOfMesh({ positions, corners, low, size }, start, way) {
  // Shares of the line's length are the same in levels.
  const levels = size.map((length) => LEVELS / (length || 1));
  const o = start.map((v, k) => (v - low[k]) * levels[k]);
  const d = way.map((v, k) => v * levels[k]);
  let nearest = Infinity;
  if (!crossesBox(o, d)) return nearest;
  const [ab, ac, t] = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  for (let k = 0; k < corners.length; k += 3) {
    const [a, b, c] = [3 * corners[k], 3 * corners[k + 1], 3 * corners[k + 2]];
    for (let axis = 0; axis < 3; axis += 1) {
      const at = positions[a + axis];
      ab[axis] = positions[b + axis] - at;
      ac[axis] = positions[c + axis] - at;
      t[axis] = o[axis] - at;
    }
    const p = cross(d, ac);
    const area = dot(ab, p);
    const u = dot(t, p) / area;
    if (!(u >= 0 && u <= 1)) continue;
    const q = cross(t, ab);
    const v = dot(d, q) / area;
    const depth = dot(ac, q) / area;
    if (v >= 0 && u + v <= 1 && depth > 0 && depth < nearest) nearest = depth;
  }
  return nearest;
}

/** Compiles a program; throws what the browser says against it. */
function program(gl, vertex, fragment, attributes) {
  const built = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(built, shader);
  }
  attributes.forEach((name, place) => gl.bindAttribLocation(built, place, name));
  gl.linkProgram(built);
  if (!gl.getProgramParameter(built, gl.LINK_STATUS)) {
    throw new Error(gl.getProgramInfoLog(built) || "the view cannot be drawn");
  }
  const places = new Map();
  const at = (name) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(built, name));
    return places.get(name);
  };
  return { program: built, at };
}

if (typeof module !== "undefined") module.exports = { numbersOf, turnOf, depthOfMesh, Orbit };
