#!/usr/bin/env node
// Holds an implementation to the vectors: node run.js [MISTAKE]. Put your own functions in place of these.
// MISTAKE is one of order, correction, backward, shifted, gamma: what each runner must find.
"use strict";
const fs = require("fs");
const path = require("path");
const mistake = process.argv[2];

const functions = {
  composite(x, premultiplied = false) {
    const samples = [];
    for (let i = 0; i < x[0]; i++) samples.push(x.slice(1 + 4 * i, 5 + 4 * i));
    if (mistake === "order") samples.reverse();
    let colour = [0, 0, 0], opacity = 0;
    for (const [r, g, b, a] of samples) {
      const weight = (1 - opacity) * (premultiplied ? 1 : a);
      colour = [colour[0] + weight * r, colour[1] + weight * g, colour[2] + weight * b];
      opacity += (1 - opacity) * a;
    }
    return [...colour, opacity];
  },
  composite_premultiplied: x => functions.composite(x, true),

  opacity_over_step([a, h, h0]) {
    if (a === 1 || mistake === "correction") return [a];
    return [-Math.expm1(h / h0 * Math.log1p(-a))];
  },

  trilinear(x) {
    const nodes = x.slice(0, 3), spacing = x.slice(3, 6);
    const count = nodes[0] * nodes[1] * nodes[2];
    const values = x.slice(6, 6 + count);
    const at = x.slice(6 + count).map((p, axis) => p / spacing[axis] - (mistake === "shifted" ? 0.5 : 0));
    const base = at.map((p, axis) => Math.min(Math.max(Math.floor(p), 0), nodes[axis] - 2));
    let sum = 0;
    for (let corner = 0; corner < 8; corner++) {
      const offset = [0, 1, 2].map(axis => corner >> axis & 1);
      const weight = at.map((p, axis) => offset[axis] ? p - base[axis] : 1 - (p - base[axis]));
      const [i, j, k] = base.map((b, axis) => b + offset[axis]);
      sum += weight[0] * weight[1] * weight[2] * values[i + nodes[0] * (j + nodes[1] * k)];
    }
    return [sum];
  },

  box_span(x) {
    let near = 0, far = Infinity;
    for (let axis = 0; axis < 3; axis++) {
      const [o, d, low, high] = [x[axis], x[axis + 3], x[axis + 6], x[axis + 9]];
      if (d === 0 && (o < low || o > high)) return [];
      if (d === 0) continue;
      const [t, u] = [(low - o) / d, (high - o) / d];
      near = Math.max(near, Math.min(t, u));
      far = Math.min(far, Math.max(t, u));
    }
    return near < far ? [near, far] : [];
  },

  value([g, cos]) {
    if (mistake === "backward") g = -g;
    return [(1 - g * g) / (4 * Math.PI * (1 + g * g - 2 * g * cos) ** 1.5)];
  },

  transmittance: ([sigma, length]) => [Math.exp(-sigma * length)],

  srgb_code([x]) {
    x = Math.min(Math.max(x, 0), 1);
    if (mistake === "gamma") return [Math.round(255 * x ** (1 / 2.2))];
    return [Math.floor(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055) + 0.5)];
  },
};

let passed = 0, failed = 0, without = 0;
for (const file of fs.readdirSync(__dirname).filter(name => name.endsWith(".json")).sort()) {
  const { entries } = JSON.parse(fs.readFileSync(path.join(__dirname, file), "utf8"));
  for (const { function: name, inputs, expected, absolute, relative } of entries ?? []) {
    if (!functions[name]) { without++; continue; }
    const found = functions[name](inputs);
    const close = (e, i) => Math.abs(found[i] - e) <= absolute + relative * Math.abs(e);
    if (found.length === expected.length && expected.every(close)) { passed++; continue; }
    failed++;
    console.log(`${file}: ${name}(${inputs}) is ${expected}, not ${found}`);
  }
}
console.log(`${passed} passed, ${failed} failed, ${without} of functions that this runner does not have`);
process.exit(failed > 0 ? 1 : 0);
