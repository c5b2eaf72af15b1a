"use strict";
// A lobe of scattered light as a surface that turns: lobeView(canvas, labels, onPick) draws it by WebGL 2, and is null without it.
const LOBE_DECADES = 4;
// Viridis of nine steps: equal steps appear equally large, also in grey and to the colour-blind.
const LOBE_RAMP = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];

function lobeColour(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}
const LOBE_RAMP_RGB = LOBE_RAMP.map(lobeColour);

function lobeRamp(t) {
  const x = Math.min(Math.max(t, 0), 1) * (LOBE_RAMP.length - 1);
  const i = Math.min(Math.floor(x), LOBE_RAMP.length - 2);
  return LOBE_RAMP_RGB[i].map((a, k) => a + (x - i) * (LOBE_RAMP_RGB[i + 1][k] - a));
}

// Values of an array in 1/sr, from 16-bit logarithms.
function lobeValues(array) {
  const text = atob(array.codes);
  const values = new Float64Array(text.length / 2);
  for (let i = 0; i < values.length; i++) {
    const code = text.charCodeAt(2 * i) + 256 * text.charCodeAt(2 * i + 1);
    values[i] = code === 65535 ? 0 : array.max * 2 ** (-code / 2048);
  }
  return values;
}

// Radius of a value: linear, or over four decades.
function lobeRadius(value, max, isLog) {
  if (!(value > 0)) return 0;
  return isLog ? Math.max(0, 1 + Math.log10(value / max) / LOBE_DECADES) : value / max;
}

function lobeDirection(theta, phi) {
  const [t, p] = [theta, phi].map((angle) => (angle * Math.PI) / 180);
  return [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
}

// Rows of vertices from the pole to the horizon: [{theta, phi, value, index}], rings closed over the azimuth.
function lobeRows(side, values) {
  const middles = (edges) => edges.slice(1).map((edge, i) => (edge + edges[i]) / 2);
  const [theta, phi] = [middles(side.theta), middles(side.phi)];
  const rings = theta.map((t, i) => phi.map((p, j) => {
    const index = i * phi.length + j;
    return { theta: t, phi: p, value: values[index], index };
  }));
  if (side.side === "transmitted") rings.reverse();
  const pole = rings[0].reduce((sum, vertex) => sum + vertex.value, 0) / phi.length;
  const end = side.side === "transmitted" ? 180 : 0;
  rings.unshift(phi.map((p, j) => ({ theta: end, phi: p, value: pole, index: rings[0][j].index })));
  return rings;
}

function lobeView(canvas, labels, onPick) {
  const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: true });
  if (!gl) return null;
  const shader = (kind, source) => {
    const compiled = gl.createShader(kind);
    gl.shaderSource(compiled, source);
    gl.compileShader(compiled);
    return compiled;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `#version 300 es
    in vec3 place; in vec3 normal; in vec3 colour; uniform mat3 turn; uniform vec2 zoom; out vec3 tint;
    void main() {
      vec3 seen = turn * place;
      vec3 facing = turn * normal;
      float light = dot(normal, normal) > 0.0 ? 0.45 + 0.55 * abs(dot(normalize(facing), normalize(vec3(-0.35, 0.5, 0.8)))) : 1.0;
      tint = colour * light;
      gl_Position = vec4(seen.xy * zoom, -0.3 * seen.z, 1.0);
    }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `#version 300 es
    precision mediump float; in vec3 tint; uniform float opacity; out vec4 pixel;
    void main() { pixel = vec4(tint, opacity); }`));
  gl.linkProgram(program);
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
  const uniform = (name) => gl.getUniformLocation(program, name);
  const [turnAt, zoomAt, opacityAt] = [uniform("turn"), uniform("zoom"), uniform("opacity")];
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  ["place", "normal", "colour"].forEach((name, i) => {
    const at = gl.getAttribLocation(program, name);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 36, 12 * i);
  });

  const home = { yaw: 115, pitch: 22, zoom: 1 };
  const view = { ...home };
  let triangles = 0;
  let wireLines = 0;
  let lines = 0;
  let points = [];
  let marks = [];

  // Rows of the matrix that turns x, y, z into right, up and towards the viewer.
  function basis() {
    const [yaw, pitch] = [view.yaw, view.pitch].map((angle) => (angle * Math.PI) / 180);
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    return [[-sy, cy, 0], [-sp * cy, -sp * sy, cp], [cp * cy, cp * sy, sp]];
  }

  function zoom() {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const size = 0.8 * view.zoom * Math.min(width, height);
    return [size / width, size / height];
  }

  function project(place) {
    const rows = basis();
    const [x, y, z] = rows.map((row) => row[0] * place[0] + row[1] * place[1] + row[2] * place[2]);
    const [zx, zy] = zoom();
    return [(0.5 + 0.5 * x * zx) * canvas.clientWidth, (0.5 - 0.5 * y * zy) * canvas.clientHeight, z];
  }

  function draw() {
    const dense = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((length) => Math.max(1, Math.round(length * dense)));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    const paper = lobeColour(getComputedStyle(document.documentElement).getPropertyValue("--card").trim());
    gl.clearColor(...paper, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix3fv(turnAt, true, new Float32Array(basis().flat()));
    gl.uniform2fv(zoomAt, zoom());
    gl.uniform1f(opacityAt, 1);
    gl.drawArrays(gl.TRIANGLES, 0, triangles);
    // Wires within a lobe shine through.
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.uniform1f(opacityAt, 0.35);
    gl.drawArrays(gl.LINES, triangles, wireLines);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.uniform1f(opacityAt, 1);
    gl.drawArrays(gl.LINES, triangles, lines);
    labels.replaceChildren(...marks.map(({ place, text }) => {
      const span = document.createElement("span");
      const [x, y] = project(place);
      span.textContent = text;
      span.style.left = `${x}px`;
      span.style.top = `${y}px`;
      return span;
    }));
  }

  // Shows lobes: [{side, rows, max, errors}], wires: [{rows, max, colour}], and the direction of the light.
  function show({ lobes, wires, light, isLog, ink }) {
    const data = [];
    const push = (place, normal, colour) => data.push(...place, ...normal, ...colour);
    const placed = (vertex, max) => {
      const radius = lobeRadius(vertex.value, max, isLog);
      return lobeDirection(vertex.theta, vertex.phi).map((x) => radius * x);
    };
    points = [];
    for (const lobe of lobes) {
      const places = lobe.rows.map((row) => row.map((vertex) => placed(vertex, lobe.max)));
      const normals = places.map((row) => row.map(() => [0, 0, 0]));
      const faces = [];
      for (let i = 0; i + 1 < places.length; i++) {
        const n = places[i].length;
        for (let j = 0; j < n; j++) {
          const k = (j + 1) % n;
          faces.push([[i, j], [i + 1, j], [i + 1, k]], [[i, j], [i + 1, k], [i, k]]);
        }
      }
      for (const face of faces) {
        const [a, b, c] = face.map(([i, j]) => places[i][j]);
        const [u, v] = [b, c].map((p) => p.map((x, k) => x - a[k]));
        const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for (const [i, j] of face) normals[i][j] = normals[i][j].map((x, k) => x + cross[k]);
      }
      for (const face of faces) {
        for (const [i, j] of face) {
          const radius = lobeRadius(lobe.rows[i][j].value, lobe.max, isLog);
          push(places[i][j], normals[i][j], lobeRamp(radius));
        }
      }
      lobe.rows.slice(1).forEach((row, i) => row.forEach((vertex, j) => {
        points.push({ place: places[i + 1][j], vertex, side: lobe.side, error: lobe.errors ? lobe.errors[vertex.index] : NaN });
      }));
    }
    triangles = data.length / 9;
    const line = (from, to, colour) => { push(from, [0, 0, 0], colour); push(to, [0, 0, 0], colour); };
    const path = (places, colour) => places.slice(1).forEach((place, i) => line(places[i], place, colour));
    for (const wire of wires) {
      const places = wire.rows.map((row) => row.map((vertex) => placed(vertex, wire.max)));
      places.slice(1).forEach((row) => path([...row, row[0]], wire.colour));
      places[0].forEach((_, j) => path(places.map((row) => row[j]), wire.colour));
    }
    wireLines = data.length / 9 - triangles;
    const circle = (radius) => Array.from({ length: 73 }, (_, i) => lobeDirection(90, 5 * i).map((x) => radius * x));
    [0.25, 0.5, 0.75, 1].forEach((radius) => path(circle(radius), ink));
    [0, 90].forEach((phi) => line(lobeDirection(90, phi), lobeDirection(90, phi + 180), ink));
    line([0, 0, 0], [0, 0, 1.1], ink);
    const from = lobeDirection(light.theta, light.phi).map((x) => 1.15 * x);
    const tip = from.map((x) => 0.8 * x);
    line(from, tip, light.colour);
    const aside = lobeDirection(light.theta + 90, light.phi);
    [-0.04, 0.04].forEach((way) => line(tip, tip.map((x, i) => 1.12 * x + way * aside[i]), light.colour));
    marks = [{ place: from.map((x) => 1.07 * x), text: light.text }, { place: [0, 0, 1.2], text: light.theta < 15 ? "" : "normal" }];
    lines = data.length / 9 - triangles;
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.STATIC_DRAW);
    draw();
  }

  function pick(x, y) {
    let best = null;
    for (const point of points) {
      const [px, py, depth] = project(point.place);
      const distance = Math.hypot(px - x, py - y);
      if (distance < 14 && (!best || depth > best.depth + 0.02 || (depth > best.depth - 0.02 && distance < best.distance))) best = { depth, distance, point };
    }
    onPick(best && best.point);
  }

  function turn(yaw, pitch) {
    view.yaw += yaw;
    view.pitch = Math.min(90, Math.max(-90, view.pitch + pitch));
    draw();
  }
  function grow(factor) {
    view.zoom = Math.min(8, Math.max(0.5, view.zoom * factor));
    draw();
  }
  let held = null;
  const pickAt = (event) => {
    const box = canvas.getBoundingClientRect();
    pick(event.clientX - box.left, event.clientY - box.top);
  };
  canvas.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); pickAt(event); });
  canvas.addEventListener("pointerup", () => { held = null; });
  canvas.addEventListener("pointercancel", () => { held = null; });
  canvas.addEventListener("pointermove", (event) => {
    if (held) {
      turn(-0.4 * (event.clientX - held[0]), 0.4 * (event.clientY - held[1]));
      held = [event.clientX, event.clientY];
    } else pickAt(event);
  });
  canvas.addEventListener("wheel", (event) => { if (document.activeElement === canvas || event.ctrlKey) { event.preventDefault(); grow(Math.exp(-0.001 * event.deltaY)); } }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const keys = {
      ArrowLeft: () => turn(6, 0), ArrowRight: () => turn(-6, 0), ArrowUp: () => turn(0, 6), ArrowDown: () => turn(0, -6),
      "+": () => grow(1.15), "=": () => grow(1.15), "-": () => grow(1 / 1.15), Home: () => { Object.assign(view, home); draw(); },
      Enter: () => { if (points.length) onPick(points.reduce((a, b) => (b.vertex.value > a.vertex.value ? b : a))); },
    };
    if (keys[event.key]) { event.preventDefault(); keys[event.key](); }
  });
  new ResizeObserver(draw).observe(canvas);
  const clear = () => {
    [triangles, wireLines, lines, points, marks] = [0, 0, 0, [], []];
    draw();
  };
  return { show, clear };
}
