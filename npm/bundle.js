// Bundles of volref, in browsers and in Node: a scene as numbers, with its values, tables and matrices.
//
// Matrices are arrays of 16 numbers, column by column, as WebGL takes them.

import { readNpy } from './files.js';

export { npy, png, readNpy } from './files.js';

const SCHEMA = 'volref/bundle/1';
const LENGTHS = ['length', 'step', 'voxel'];
const MODES = ['maximum', 'minimum', 'mean', 'sum', 'attenuated-maximum', 'isosurface'];
const FEATURES = [
  ...['several', 'parallel', 'placed', 'sheared', 'nearest', 'formula'],
  ...['shading', 'shadow', 'clips', 'surfaces', 'modulation'],
];

/** Something in the scene for which the renderer has no words: `volref validate` counts the image as missing. */
export class Refusal extends Error {
  name = 'Refusal';
}

/** Says that the renderer has no words for the scene. */
export function refuse(reason) {
  throw new Refusal(reason);
}

/** Length of a vector. */
export const length = (vector) => Math.hypot(...vector);

/** Product of two matrices: `b` first. */
export function multiply(a, b) {
  return Array.from({ length: 16 }, (_, index) => {
    const [row, column] = [index % 4, index - (index % 4)];
    return [0, 1, 2, 3].reduce((sum, k) => sum + a[row + 4 * k] * b[column + k], 0);
  });
}

/** The place of a point, divided by its fourth coordinate; with `w = 0`, of a direction. */
export function transform(matrix, [x, y, z], w = 1) {
  const [px, py, pz, pw] = [0, 1, 2, 3].map(
    (row) => matrix[row] * x + matrix[row + 4] * y + matrix[row + 8] * z + matrix[row + 12] * w,
  );
  return w === 0 ? [px, py, pz] : [px / pw, py / pw, pz / pw];
}

/** Determinant of the first three rows and columns: negative for a matrix that mirrors. */
export function determinant(matrix) {
  const [a, b, c] = columns(matrix);
  return dot(a, cross(b, c));
}

/** Inverse of a matrix that keeps the fourth coordinate of points: of all but projections. */
export function invert(matrix) {
  const [a, b, c] = columns(matrix);
  const rows = [cross(b, c), cross(c, a), cross(a, b)];
  const volume = determinant(matrix);
  if (!Number.isFinite(1 / volume)) throw new RangeError('a matrix without an inverse');
  const inverse = rows.map((row) => row.map((value) => value / volume));
  const at = inverse.map((row) => -dot(row, matrix.slice(12, 15)));
  return ofColumns(...[0, 1, 2].map((k) => inverse.map((row) => row[k])), at);
}

/** A bundle: what `volref export --to bundle` wrote. */
export class Bundle {
  #volumes;

  /** `description`: the JSON; `files`: for each file that it names, its bytes. */
  constructor(description, files) {
    if (description?.schema !== SCHEMA) {
      throw new TypeError(`the bundle has the schema ${JSON.stringify(description?.schema)}, and not "${SCHEMA}"`);
    }
    this.description = description;
    this.files = files;
  }

  get name() {
    return this.description.name;
  }

  get width() {
    return this.description.image.width;
  }

  get height() {
    return this.description.image.height;
  }

  /** The panel, where there is one only: what is computed, as the JSON says it. */
  get panel() {
    const [panel, ...others] = this.description.panels;
    if (others.length > 0) refuse('more than one panel');
    if (!['volume', 'volumes'].includes(panel.shows)) refuse(`a panel that shows ${panel.shows}, not volumes`);
    return panel;
  }

  /** The volumes of the panel. */
  get volumes() {
    this.#volumes ??= (this.panel.volumes ?? [this.panel]).map((part) => new Volume(part, this));
    return this.#volumes;
  }

  /** The volume, where there is one only. */
  get volume() {
    const [volume, ...others] = this.volumes;
    if (others.length > 0) refuse(this.asks.several);
    return volume;
  }

  get values() {
    return this.volume.values;
  }

  get nodes() {
    return this.volume.nodes;
  }

  get affine() {
    return this.volume.affine;
  }

  /** Distance between samples, world units; of an exact projection or isosurface, a sixteenth of the one to begin with. */
  get step() {
    const step = Math.min(...this.volumes.map((volume) => volume.step));
    return this.panel.mode?.exact ? step / 16 : step;
  }

  get background() {
    return this.panel.background;
  }

  /** The mode: `composited`, or that of a projection or of isosurfaces. */
  get mode() {
    return this.panel.mode?.name ?? 'composited';
  }

  /** Features that the picture takes beside one volume along the axes, seen from one point, interpolated between the points
   * of a table and composited, each with the words for it. */
  get asks() {
    return this.panel.asks;
  }

  /** Refuses the scene if the picture takes features beside these. */
  allow(...features) {
    const all = [...FEATURES, ...MODES];
    const unknown = features.find((name) => !all.includes(name));
    if (unknown !== undefined) throw new TypeError(`${unknown} is no feature: give ${all.join(', ')}`);
    const beside = Object.entries(this.asks).filter(([name]) => !features.includes(name));
    if (beside.length > 0) refuse(beside.map(([, words]) => words).join('; '));
  }

  /** Points of the transfer function: see `Volume`. */
  points(count) {
    return this.volume.points(count);
  }

  /** The table of a transfer function: see `Volume`. */
  table(count, options) {
    return this.volume.table(count, options);
  }

  get isParallel() {
    return this.panel.ray.orthographic_height !== undefined;
  }

  get eye() {
    return this.panel.ray.eye;
  }

  /** Direction of the line of sight, perpendicular to the image, of length 1, as are `right` and `up`. */
  get forward() {
    return this.panel.ray.axis ?? this.panel.ray.forward;
  }

  get right() {
    return unit(this.panel.ray.half_right);
  }

  get up() {
    return unit(this.panel.ray.half_up);
  }

  /** Vertical field of view in degrees, of rays from one point. Refuses a camera of which it does not say where they go:
   * `projection` does. */
  get fieldOfView() {
    if (this.panel.ray.axis) refuse('a camera whose image lies beside its axis, or whose pixels are not square');
    return (2 * Math.atan(length(this.panel.ray.half_up)) * 180) / Math.PI;
  }

  /** Height of the image in world units, of parallel rays. */
  get parallelHeight() {
    return this.panel.ray.orthographic_height;
  }

  /** Corners of the boxes of all volumes, in the world. */
  get corners() {
    return this.volumes.flatMap((volume) => volume.corners);
  }

  /** Distance from the eye to the farthest corner. */
  get farthest() {
    return Math.max(...this.corners.map((corner) => length(minus(corner, this.eye))));
  }

  /** Depth of the far plane: twice that of the farthest corner. */
  get far() {
    const deepest = Math.max(...this.#depths());
    return 2 * (deepest > 0 ? deepest : this.farthest);
  }

  /** Depth of the near plane: half that of the nearest corner, for many renderers draw boxes half a voxel larger. */
  get near() {
    return Math.max(0.5 * Math.min(...this.#depths()), 1e-4 * this.far);
  }

  #depths() {
    return this.corners.map((corner) => dot(minus(corner, this.eye), this.forward));
  }

  /** Matrix from the camera, which looks along -z with y up, to the world. */
  get cameraToWorld() {
    return ofColumns(
      this.right,
      this.up,
      this.forward.map((value) => -value),
      this.eye,
    );
  }

  /** Matrix from the world to the camera. */
  get view() {
    return invert(this.cameraToWorld);
  }

  /** Matrix from the camera to clip space, OpenGL's. */
  get projection() {
    const { near, far, width, height } = this;
    const depth = 1 / (near - far);
    const scale = this.isParallel ? 2 / this.parallelHeight : 1 / length(this.panel.ray.half_up);
    const [x, y] = [(scale * height) / width, scale];
    const { axis, forward, half_right, half_up } = this.panel.ray;
    if (axis) {
      const ratios = [width / height, 1];
      const [[right, across], [up, along]] = [half_right, half_up].map((half, k) => [
        dot(forward, axis) / length(half) / ratios[k],
        dot(forward, half) / length(half) ** 2 / ratios[k],
      ]);
      return [right, 0, 0, 0, 0, up, 0, 0, across, along, (far + near) * depth, -1, 0, 0, 2 * far * near * depth, 0];
    }
    if (this.isParallel) return [x, 0, 0, 0, 0, y, 0, 0, 0, 0, 2 * depth, 0, 0, 0, (far + near) * depth, 1];
    return [x, 0, 0, 0, 0, y, 0, 0, 0, 0, (far + near) * depth, -1, 0, 0, 2 * far * near * depth, 0];
  }
}

/** A volume of a bundle. */
export class Volume {
  #bundle;
  #values;

  constructor(part, bundle) {
    this.part = part;
    this.#bundle = bundle;
  }

  /** Numbers of nodes along x, y and z. */
  get nodes() {
    return this.part.grid.nodes;
  }

  /** The values, x fastest. */
  get values() {
    this.#values ??= this.#read();
    return this.#values;
  }

  #read() {
    const { file, nodes } = this.part.grid;
    const bytes = this.#bundle.files[file];
    if (!bytes) throw new TypeError(`the bundle lacks its file ${file}`);
    const values = file.endsWith('.npy') ? readNpy(bytes).values : floats(bytes);
    const count = nodes.reduce((product, n) => product * n, 1);
    if (values.length !== count) throw new TypeError(`${file} holds ${values.length} values, and not ${count}`);
    return values;
  }

  get step() {
    return this.part.sampling.step;
  }

  get isNearest() {
    return this.part.interpolation.method === 'nearest';
  }

  /** Length of the shortest edge of a cell in the world. */
  get voxel() {
    return Math.min(...columns(this.affine).map(length));
  }

  /** Matrix from numbers of nodes (i, j, k) to the world. */
  get affine() {
    const { spacing, first_node: first } = this.part.grid;
    return multiply(this.matrix, scaled(spacing, first));
  }

  /** Matrix from the unit cube, which the box of the volume is in texture coordinates, to the world. */
  get boxToWorld() {
    const { box_min: min, box_max: max } = this.part.grid;
    return multiply(this.matrix, scaled(minus(max, min), min));
  }

  /** Matrix from the coordinates of the grid to the world: the unit matrix where the volume is not placed. */
  get matrix() {
    const rows = this.part.grid.matrix ?? [
      [1, 0, 0, 0],
      [0, 1, 0, 0],
      [0, 0, 1, 0],
    ];
    return ofColumns(...[0, 1, 2, 3].map((column) => rows.map((row) => row[column])));
  }

  /** Corners of the box in the world. */
  get corners() {
    const box = this.boxToWorld;
    return Array.from({ length: 8 }, (_, k) => transform(box, [k & 1, (k >> 1) & 1, k >> 2]));
  }

  /**
   * Points of the transfer function: value, linear colour and opacity over the reference length; of a formula, `count`
   * of them. For a projection, the colours that it shows, with opacity 1.
   */
  points(count = 1024) {
    const { mode, transfer_function: transfer } = this.part;
    if (mode && 'low' in mode) {
      return [0, 1].map((grey) => ({ value: [mode.low, mode.high][grey], colour: [grey, grey, grey], opacity: 1 }));
    }
    if (!transfer) refuse(`mode = "${mode?.name}" as a transfer function`);
    const known = transfer.points ?? ofFormula(transfer, count, this.#most());
    return mode ? known.map((point) => ({ ...point, opacity: 1 })) : known;
  }

  /** The largest value, or 1. */
  #most() {
    return this.values.reduce((most, value) => Math.max(most, value), 1);
  }

  /**
   * A table of `count` entries: red, green, blue, and opacity over a length, evenly from the value `least` of the first
   * point to `most`, that of the last; as `floats`, and as `bytes`. `per`: `length`, the reference length; `step`, that
   * of `step` or of the scene; or `voxel`.
   */
  table(count = 256, { per = 'length', step = this.#bundle.step } = {}) {
    if (!LENGTHS.includes(per)) throw new TypeError(`per is ${JSON.stringify(per)}: give one of ${LENGTHS.join(', ')}`);
    if (!(Number.isInteger(count) && count > 1)) throw new TypeError(`a table has 2 entries or more, not ${count}`);
    const points = this.points(count);
    const [least, most] = [points[0].value, points.at(-1).value];
    const reference = this.part.transfer_function?.reference_length ?? 1;
    const exponent = { length: reference, step, voxel: this.voxel }[per] / reference;
    const entries = Array.from({ length: count }, (_, index) => {
      const { colour, opacity } = between(points, least + ((most - least) * index) / (count - 1));
      return [...colour, 1 - (1 - opacity) ** exponent];
    }).flat();
    const bytes = Uint8Array.from(entries, (value) => Math.round(255 * Math.min(1, Math.max(0, value))));
    return { floats: Float32Array.from(entries), bytes, least, most };
  }
}

/** The codes of a WebGL context's frame buffer, top row first. */
export function pixels(gl, width = gl.drawingBufferWidth, height = gl.drawingBufferHeight) {
  const [bottomUp, codes] = [new Uint8Array(4 * width * height), new Uint8Array(4 * width * height)];
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bottomUp);
  for (let y = 0; y < height; y++) {
    codes.set(bottomUp.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
  }
  return codes;
}

/** Colour and opacity at a value: of two points at one value, the later holds there. */
function between(points, value) {
  const after = points.findIndex((point) => point.value > value);
  if (after === 0) return points[0];
  const q = points.at(after);
  if (after < 0) return q;
  const p = points[after - 1];
  const share = (value - p.value) / (q.value - p.value);
  const mixed = (a, b) => a + (b - a) * share;
  return { colour: p.colour.map((c, k) => mixed(c, q.colour[k])), opacity: mixed(p.opacity, q.opacity) };
}

/** Evenly spaced points of a formula, from 0 to `most`: colours are multiplied by the square of the value. */
function ofFormula({ colours, floor }, count, most) {
  return Array.from({ length: count }, (_, index) => {
    const value = (most * index) / (count - 1);
    const clear = (Math.exp(-(value ** 2)) - floor) / (1 - floor);
    const place = Math.min(value, 1) * (colours.length - 1);
    const before = Math.max(0, Math.min(Math.floor(place), colours.length - 2));
    const next = colours[before + 1] ?? colours[before];
    const colour = colours[before].map((c, k) => (c + (next[k] - c) * (place - before)) * value ** 2);
    return { value, colour, opacity: 1 - Math.min(1, Math.max(0, clear)) };
  });
}

function floats(bytes) {
  const view = ArrayBuffer.isView(bytes) ? bytes : new Uint8Array(bytes);
  // A copy, for the bytes may begin anywhere.
  return new Float32Array(view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength));
}

/** The first three columns, and their first three rows. */
export const columns = (matrix) => [0, 4, 8].map((first) => matrix.slice(first, first + 3));

const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const minus = (a, b) => a.map((value, k) => value - b[k]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (vector) => vector.map((value) => value / length(vector));
const ofColumns = (a, b, c, at) => [...a, 0, ...b, 0, ...c, 0, ...at, 1];
const scaled = ([x, y, z], at) => ofColumns([x, 0, 0], [0, y, 0], [0, 0, z], at);
