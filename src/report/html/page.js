"use strict";
(() => {
const find = (selector, root = document) => root.querySelector(selector);
const findAll = (selector, root = document) => [...root.querySelectorAll(selector)];

// ---- Unpacking: the other half of pixels.rs ----

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Stored row by row and each row channel by channel; used pixel by pixel.
function eachStored(width, height, use) {
  let from = 0;
  for (let y = 0; y < height; y++)
    for (let channel = 0; channel < 3; channel++)
      for (let x = 0; x < width; x++) use(from++, 3 * (y * width + x) + channel);
}

// Floats of 19 bits, split into planes of bytes. `smooth`: steps from number to number.
async function floats(text, width, height, smooth) {
  const planes = await inflate(text);
  const count = 3 * width * height;
  const bits = new Uint32Array(count);
  let code = 0;
  eachStored(width, height, (from, to) => {
    const stored = (planes[from] << 16) | (planes[count + from] << 8) | planes[2 * count + from];
    code = smooth ? (code + ((stored >>> 1) ^ -(stored & 1))) & 0x7ffff : stored;
    bits[to] = code << 13;
  });
  return new Float32Array(bits.buffer);
}

async function codes(text, width, height) {
  const stored = await inflate(text);
  const codes = new Uint8Array(stored.length);
  eachStored(width, height, (from, to) => { codes[to] = stored[from]; });
  return codes;
}

const toLinear = code => code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4;

// Golden and test as { width, height, values: radiance, codes? }, and maps over both.
async function unpack(stored) {
  const { golden, test, difference, flip, z } = stored;
  const pictures = { ...stored };
  if (golden) {
    const { width, height } = golden;
    pictures.golden = { width, height, values: await floats(golden.floats, width, height, true) };
  }
  if (difference) {
    pictures.difference = await floats(difference, golden.width, golden.height, false);
    pictures.paired = true;
  }
  if (test) {
    const { width, height } = test;
    const image = { width, height };
    if (test.codes) {
      image.codes = await codes(test.codes, width, height);
      const light = Float32Array.from({ length: 256 }, (_, code) => toLinear(code / 255) / 2 ** stored.exposure);
      image.values = Float32Array.from(image.codes, code => light[code]);
    } else if (test.floats) {
      image.values = await floats(test.floats, width, height, true);
    } else {
      image.values = pictures.golden.values.map((value, i) => value + pictures.difference[i]);
    }
    pictures.test = image;
  }
  if (flip) pictures.flip = await inflate(flip);
  if (z) pictures.z = { ...z, values: await floats(z.floats, z.columns, z.rows, false) };
  return pictures;
}

// ---- What is shown, and how ----

const NAMES = { golden: "golden", test: "test", difference: "difference", flip: "FLIP", z: "z-score of block" };
const CHANNELS = ["red", "green", "blue"];
const palettes = JSON.parse(find("#palettes").textContent);
const viewer = find("#viewer");
const figures = findAll("#stage figure");
const canvases = figures.map(figure => find("canvas", figure));

let unpackings = 0;
let pictures = null;      // of the open case
const state = {
  view: "side", exposure: 0, channel: -1, swipe: 0.5, isTest: false,
  scales: { difference: 0, z: Math.log2(10) },   // full scale, as power of two
  zoom: 1, centre: [0.5, 0.5],                   // centre as a share of width and height
  pixel: null,
};

const isPossible = view => !!pictures && ({
  golden: !!pictures.golden, test: !!pictures.test,
  difference: !!pictures.difference, flip: !!pictures.flip, z: !!pictures.z,
  side: !!(pictures.golden && pictures.test), blink: !!pictures.paired, swipe: !!pictures.paired,
})[view];

// The map that says most: of Monte Carlo images single differences are noise.
const bestMap = () => ["z", pictures.test?.codes ? "flip" : "difference", "difference"].find(isPossible);
const panes = () => {
  if (state.view === "side") return ["golden", "test", bestMap()].filter(name => name);
  if (state.view === "blink") return [state.isTest ? "test" : "golden"];
  return [state.view === "swipe" ? "golden" : state.view];
};
const shownMap = () => panes().find(name => ["difference", "flip", "z"].includes(name));
const imageOf = name => name === "test" ? pictures.test : pictures.golden;

function blockOf(x, y) {
  const { columns, rows, side } = pictures.z;
  return Math.min(Math.floor(y / side), rows - 1) * columns + Math.min(Math.floor(x / side), columns - 1);
}

// The chosen channel of three numbers, or the one furthest from 0.
function furthest(values, at) {
  if (state.channel >= 0) return values[at + state.channel];
  let far = values[at];
  for (const value of [values[at + 1], values[at + 2]])
    if (!(Math.abs(value) <= Math.abs(far))) far = value;
  return far;
}

// Codes of linear light, in steps finer than a code.
const STEPS = 1 << 14;
const encoded = Uint8Array.from({ length: STEPS + 1 }, (_, i) => {
  const linear = i / STEPS;
  return Math.round(255 * (linear <= 0.0031308 ? linear * 12.92 : 1.055 * linear ** (1 / 2.4) - 0.055));
});

function paint(name) {
  const { width, height, values } = imageOf(name);
  const data = new ImageData(width, height);
  const light = 2 ** state.exposure * STEPS;
  const full = 2 ** state.scales[name];
  const signed = value => palettes.signed[Math.round(127 + 127 * Math.max(-1, Math.min(1, value / full)))];
  for (let i = 0; i < width * height; i++) {
    const x = i % width, y = Math.floor(i / width);
    let colour;
    if (name === "flip") {
      colour = palettes.magma[pictures.flip[i]];
    } else if (name === "golden" || name === "test") {
      const pixel = [0, 1, 2].map(c => values[3 * i + (state.channel < 0 ? c : state.channel)]);
      if (pixel.every(Number.isFinite)) colour = pixel.map(value => encoded[Math.round(Math.max(0, Math.min(STEPS, value * light)))]);
    } else {
      const value = name === "z" ? furthest(pictures.z.values, 3 * blockOf(x, y)) : furthest(pictures.difference, 3 * i);
      if (Number.isFinite(value)) colour = signed(value);
    }
    // What is no number is chequered.
    colour ||= (x + y) % 2 ? [255, 0, 255] : [0, 0, 0];
    data.data.set([...colour, 255], 4 * i);
  }
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  canvas.getContext("2d").putImageData(data, 0, 0);
  return canvas;
}

let painted = new Map();
function layer(name) {
  const key = [name, state.channel, state.exposure, state.scales[name]].join();
  if (!painted.has(key)) {
    if (painted.size > 8) painted.clear();
    painted.set(key, paint(name));
  }
  return painted.get(key);
}

// Where an image lies in a canvas: `scale` canvas pixels to a pixel, from `left`, `top`.
function place(canvas, image) {
  const scale = state.zoom * Math.min(canvas.width / image.width, canvas.height / image.height);
  return {
    scale,
    left: canvas.width / 2 - state.centre[0] * image.width * scale,
    top: canvas.height / 2 - state.centre[1] * image.height * scale,
  };
}

function draw() {
  if (!pictures || viewer.hidden) return;
  const names = panes();
  figures.forEach((figure, i) => { figure.hidden = i >= names.length; });
  names.forEach((name, i) => drawPane(figures[i], canvases[i], name));
}

function drawPane(figure, canvas, name) {
  const ratio = window.devicePixelRatio || 1;
  const image = imageOf(name);
  const height = Math.min(0.66 * innerHeight, canvas.clientWidth * image.height / image.width);
  canvas.style.height = `${Math.max(120, Math.round(height))}px`;
  canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  const { scale, left, top } = place(canvas, image);
  const context = canvas.getContext("2d");
  context.imageSmoothingEnabled = scale < 1;
  const put = shown => context.drawImage(layer(shown), left, top, image.width * scale, image.height * scale);
  put(name);
  let caption = NAMES[name];
  if (state.view === "swipe") {
    caption = "golden to the left of the line, test to the right";
    const line = state.swipe * canvas.width;
    context.save();
    context.beginPath();
    context.rect(line, 0, canvas.width, canvas.height);
    context.clip();
    put("test");
    context.restore();
    for (const [colour, width] of [["#000", 4], ["#fff", 2]]) {
      context.fillStyle = colour;
      context.fillRect(line - width / 2 * ratio, 0, width * ratio, canvas.height);
    }
  }
  if (state.view === "blink") caption = `now: ${caption}`;
  if (state.pixel) {
    const [x, y] = state.pixel;
    const around = Math.max(scale, 5 * ratio);
    const at = [left + (x + 0.5) * scale - around / 2, top + (y + 0.5) * scale - around / 2];
    for (const [colour, out] of [["#000", 1.5], ["#fff", 0.5]]) {
      context.strokeStyle = colour;
      context.lineWidth = ratio;
      context.strokeRect(at[0] - out * ratio, at[1] - out * ratio, around + 2 * out * ratio, around + 2 * out * ratio);
    }
  }
  find("figcaption", figure).textContent = caption;
  canvas.setAttribute("aria-label", `${caption}, ${image.width} × ${image.height} pixels; arrow keys read pixels`);
}

// Everything but the pixels under the pointer.
function refresh() {
  if (!pictures) return;
  for (const button of findAll("[data-view]")) {
    button.disabled = !isPossible(button.dataset.view);
    button.setAttribute("aria-pressed", button.dataset.view === state.view);
  }
  const map = shownMap();
  const hasScale = map === "difference" || map === "z";
  find("#scale-label").hidden = !hasScale;
  find("#swipe-label").hidden = state.view !== "swipe";
  find("#exposure").value = state.exposure;
  const stops = Number(state.exposure.toFixed(2));
  find("#exposure-value").textContent = `${signedText(stops, 3)} ${Math.abs(stops) === 1 ? "stop" : "stops"}`;
  find("#channel").value = state.channel;
  find("#swipe").value = state.swipe;
  if (hasScale) {
    const middle = map === "z" ? Math.log2(10) : pictures.ownScale;
    Object.assign(find("#scale"), { min: middle - 10, max: middle + 10 }).value = state.scales[map];
    find("#scale-value").textContent = text(2 ** state.scales[map], 3);
  }
  drawLegend(map);
  drawHistogram();
  draw();
  readOut();
}

function drawLegend(map) {
  find("#legend").hidden = !map;
  if (!map) return;
  const palette = palettes[map === "flip" ? "magma" : "signed"];
  const bar = find("#legend-bar");
  bar.width = palette.length;
  const context = bar.getContext("2d");
  palette.forEach((colour, i) => {
    context.fillStyle = `rgb(${colour})`;
    context.fillRect(i, 0, 1, 1);
  });
  const full = map === "flip" ? 1 : 2 ** state.scales[map];
  const unit = map === "z" ? " standard errors" : pictures.test.codes ? " codes" : "";
  find("#legend-low").textContent = map === "flip" ? "0: identical" : `too dark: −${text(full, 3)}`;
  find("#legend-high").textContent = map === "flip" ? "1: maximally different" : `+${text(full, 3)}${unit}: too bright`;
  find("#legend-words").textContent = map === "flip" ? "(FLIP)"
    : `(${NAMES[map]}, ${state.channel < 0 ? "the channel with the largest difference" : CHANNELS[state.channel]})`;
}

// ---- Numbers ----

function text(value, digits = 4) {
  if (Number.isNaN(value)) return "NaN";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  const words = value === 0 || Number.isInteger(value) && size < 1e5 ? String(value)
    : size < 1e-3 || size >= 1e5 ? value.toExponential(digits - 1) : value.toPrecision(digits);
  return words.replace(/-/g, "−");
}
const signedText = (value, digits) => value > 0 ? `+${text(value, digits)}` : text(value, digits);

// The columns of the read-out for one channel of a pixel.
function numbersAt(x, y, channel) {
  const inside = image => image && x < image.width && y < image.height;
  const value = image => inside(image) ? image.values[3 * (y * image.width + x) + channel] : undefined;
  const at = pictures.paired ? 3 * (y * pictures.golden.width + x) + channel : -1;
  const difference = pictures.difference?.[at];
  const light = value(pictures.golden);
  let [golden, test, last] = [light, value(pictures.test), undefined];
  if (pictures.test?.codes) {
    test = inside(pictures.test) ? pictures.test.codes[3 * (y * pictures.test.width + x) + channel] : undefined;
    if (pictures.paired) [golden, last] = [test - difference, light];
  }
  if (pictures.tolerance) {
    const [absolute, relative] = pictures.tolerance;
    last = Math.abs(difference) / (absolute + relative * Math.abs(golden));
  }
  if (pictures.z) last = pictures.z.values[3 * blockOf(x, y) + channel];
  const share = difference === 0 ? 0 : 100 * difference / Math.abs(golden);
  return { golden, test, difference, share, last };
}

function readOut() {
  if (!pictures) return;
  const rows = findAll("#read-out tbody tr");
  const lastWords = pictures.tolerance ? "× tolerance" : pictures.z ? "z-score of block"
    : pictures.test?.codes && pictures.paired ? "golden radiance" : "";
  find("#read-last").textContent = lastWords;
  find("#read-place").textContent = state.pixel ? `pixel (${state.pixel.join(", ")})` : "pixel –";
  rows.forEach((row, channel) => {
    const numbers = state.pixel ? numbersAt(...state.pixel, channel) : {};
    const { golden, test, difference, share, last } = numbers;
    const words = [
      golden, test, difference === undefined ? undefined : signedText(difference),
      difference === undefined || Number.isNaN(share) ? undefined
        : Number.isFinite(share) ? `${share > 0 ? "+" : ""}${share.toFixed(2).replace("-", "−")} %` : "–",
      lastWords ? last : "",
    ].map(word => word === undefined ? "–" : typeof word === "string" ? word : text(word));
    findAll("td", row).forEach((cell, i) => { cell.textContent = words[i]; });
  });
}

const isBroken = i => [0, 1, 2].some(c => [pictures.golden, pictures.test].some(
  image => image && !Number.isFinite(image.values[3 * i + c] ?? 0)));

// How far off pixel `i` is, by what the gate looks at first; NaN is further off than anything.
function badness(i) {
  if (isBroken(i)) return Infinity;
  const { width } = pictures.golden;
  const numbers = [0, 1, 2].map(channel => numbersAt(i % width, Math.floor(i / width), channel));
  const most = part => Math.max(...numbers.map(part));
  const size = most(n => Math.abs(n.difference));
  if (pictures.tolerance) return most(n => n.last);
  if (pictures.z) return most(n => Math.abs(n.last)) + size / (1 + size);
  return pictures.test.codes ? pictures.flip?.[i] ?? size : size;
}

function goToPixel(i, width, height) {
  state.pixel = [i % width, Math.floor(i / width)];
  state.zoom = Math.max(state.zoom, 8);
  state.centre = [(state.pixel[0] + 0.5) / width, (state.pixel[1] + 0.5) / height];
  draw();
  readOut();
}

function goToWorst() {
  if (!pictures?.paired) return;
  const { width, height } = pictures.golden;
  let worst = 0, most = -1;
  for (let i = 0; i < width * height; i++) {
    const here = badness(i);
    if (here > most) [worst, most] = [i, here];
  }
  goToPixel(worst, width, height);
}

function goToBroken() {
  const image = pictures?.test ?? pictures?.golden;
  if (!image) return;
  const { width, height } = image;
  const count = width * height;
  const from = state.pixel ? state.pixel[1] * width + state.pixel[0] + 1 : 0;
  for (let k = 0; k < count; k++)
    if (isBroken((from + k) % count)) return goToPixel((from + k) % count, width, height);
}

function drawHistogram() {
  const canvas = find("#histogram");
  const context = canvas.getContext("2d");
  const style = getComputedStyle(document.documentElement);
  const { width, height } = canvas;
  const floor = height - 16;
  context.clearRect(0, 0, width, height);
  const sets = ["golden", "test"].filter(isPossible).map(name => {
    const { values } = pictures[name];
    const chosen = state.channel < 0 ? values : values.filter((_, i) => i % 3 === state.channel);
    return { name, all: chosen.length, positive: chosen.filter(value => value > 0 && value < Infinity) };
  });
  let high = 0, low = Infinity;
  for (const { positive } of sets) for (const value of positive) {
    high = Math.max(high, value);
    low = Math.min(low, value);
  }
  const left = sets.map(({ name, all, positive }) => `${name} ${all - positive.length} of ${all}`);
  find("#histogram-words").textContent = `Values left out as zero, negative or NaN: ${left.join(", ")}.`;
  if (!(high > 0)) return;
  const top = Math.ceil(Math.log10(high) + 1e-9);
  const bottom = Math.max(Math.floor(Math.log10(low)), top - 8);
  const bins = 105, most = [];
  const columns = sets.map(({ positive }) => {
    const counts = new Array(bins).fill(0);
    for (const value of positive)
      counts[Math.max(0, Math.min(bins - 1, Math.floor((Math.log10(value) - bottom) / (top - bottom) * bins)))]++;
    most.push(...counts);
    return counts;
  });
  const tallest = Math.log1p(Math.max(...most));
  context.fillStyle = context.strokeStyle = style.getPropertyValue("--soft");
  context.font = "11px system-ui, sans-serif";
  context.fillRect(0, floor, width, 1);
  const decades = top - bottom;
  for (let decade = 0; decade <= decades; decade++) {
    const x = decade / decades * width;
    context.fillRect(Math.min(x, width - 1), floor, 1, 4);
    context.textAlign = decade === 0 ? "left" : decade === decades ? "right" : "center";
    context.fillText(`1e${bottom + decade}`, x, height - 2);
  }
  sets.forEach(({ name }, set) => {
    context.strokeStyle = style.getPropertyValue(`--${name}`);
    context.lineWidth = 2;
    context.setLineDash(name === "test" ? [6, 4] : []);
    context.beginPath();
    columns[set].forEach((count, bin) => {
      const y = floor - Math.log1p(count) / tallest * (floor - 3);
      context.lineTo(bin / bins * width, y);
      context.lineTo((bin + 1) / bins * width, y);
    });
    context.stroke();
  });
  context.setLineDash([]);
}

// ---- Changing what is shown ----

let timer = 0;
function setBlinking(on) {
  clearInterval(timer);
  timer = on ? setInterval(() => { state.isTest = !state.isTest; draw(); }, 600) : 0;
}

function setView(view) {
  if (!isPossible(view)) return;
  state.view = view;
  // Who asks for little motion switches with the space bar.
  setBlinking(view === "blink" && !matchMedia("(prefers-reduced-motion: reduce)").matches);
  refresh();
}

function setExposure(stops) {
  const { min, max } = find("#exposure");
  state.exposure = Math.max(Number(min), Math.min(Number(max), stops));
  refresh();
}

function setScale(power) {
  const map = pictures && shownMap();
  if (map !== "difference" && map !== "z") return;
  state.scales[map] = power;
  refresh();
}

const stepScale = step => setScale(state.scales[pictures && shownMap()] + step);

function setChannel(channel) {
  state.channel = channel;
  refresh();
}

function setSwipe(share) {
  state.swipe = Math.max(0, Math.min(1, share));
  find("#swipe").value = state.swipe;
  draw();
}

// Keeps the pixel at canvas position `at` where it is.
function zoomBy(factor, canvas = canvases[0], at = [canvas.width / 2, canvas.height / 2]) {
  if (!pictures) return;
  const image = imageOf(panes()[0]);
  const before = place(canvas, image);
  const most = 96 / (before.scale / state.zoom);
  state.zoom = Math.max(1, Math.min(Math.max(1, most), state.zoom * factor));
  const scale = before.scale && place(canvas, image).scale;
  const share = [(at[0] - before.left) / before.scale, (at[1] - before.top) / before.scale];
  moveCentre([
    (share[0] + (canvas.width / 2 - at[0]) / scale) / image.width,
    (share[1] + (canvas.height / 2 - at[1]) / scale) / image.height,
  ]);
}

function moveCentre(centre) {
  state.centre = state.zoom === 1 ? [0.5, 0.5] : centre.map(share => Math.max(0, Math.min(1, share)));
  draw();
}

function movePixel(dx, dy) {
  const { width, height } = imageOf(panes()[0]);
  const [x, y] = state.pixel ?? [Math.floor(width / 2) - dx, Math.floor(height / 2) - dy];
  state.pixel = [Math.max(0, Math.min(width - 1, x + dx)), Math.max(0, Math.min(height - 1, y + dy))];
  if (state.zoom > 1) state.centre = [(state.pixel[0] + 0.5) / width, (state.pixel[1] + 0.5) / height];
  draw();
  readOut();
}

for (const [i, canvas] of canvases.entries()) {
  const position = event => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) * canvas.width / box.width, (event.clientY - box.top) * canvas.height / box.height];
  };
  let drag = null;
  canvas.addEventListener("pointerdown", event => {
    const [x, y] = position(event);
    const isNearLine = Math.abs(x - state.swipe * canvas.width) < 0.04 * canvas.width;
    drag = { x, y, isSwipe: state.view === "swipe" && (state.zoom === 1 || isNearLine) };
    canvas.setPointerCapture(event.pointerId);
    if (drag.isSwipe) setSwipe(x / canvas.width);
  });
  canvas.addEventListener("pointerup", () => { drag = null; });
  canvas.addEventListener("pointercancel", () => { drag = null; });
  canvas.addEventListener("pointermove", event => {
    const name = pictures && panes()[i];
    if (!name) return;
    const [x, y] = position(event);
    const image = imageOf(name);
    const { scale, left, top } = place(canvas, image);
    if (drag?.isSwipe) {
      setSwipe(x / canvas.width);
    } else if (drag) {
      moveCentre([
        state.centre[0] - (x - drag.x) / scale / image.width,
        state.centre[1] - (y - drag.y) / scale / image.height,
      ]);
      Object.assign(drag, { x, y });
    }
    const [column, row] = [Math.floor((x - left) / scale), Math.floor((y - top) / scale)];
    if (column >= 0 && row >= 0 && column < image.width && row < image.height) state.pixel = [column, row];
    draw();
    readOut();
  });
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    zoomBy(2 ** (-event.deltaY / 240), canvas, position(event));
  }, { passive: false });
}

for (const button of findAll("[data-view]")) button.addEventListener("click", () => setView(button.dataset.view));
find("#exposure").addEventListener("input", event => setExposure(event.target.valueAsNumber));
find("#scale").addEventListener("input", event => setScale(event.target.valueAsNumber));
find("#swipe").addEventListener("input", event => setSwipe(event.target.valueAsNumber));
find("#channel").addEventListener("change", event => setChannel(Number(event.target.value)));
find("#zoom-in").addEventListener("click", () => zoomBy(2));
find("#zoom-out").addEventListener("click", () => zoomBy(0.5));
find("#zoom-fit").addEventListener("click", () => zoomBy(0));
find("#worst").addEventListener("click", goToWorst);
find("#broken").addEventListener("click", goToBroken);
new ResizeObserver(draw).observe(find("#stage"));

// ---- The list of cases ----

const main = find("main");
const items = findAll("#cases li");
const links = items.map(item => find("a", item));
const articles = findAll("article");
let open = -1;

function filterCases() {
  const words = find("#filter").value.toLowerCase().split(/\s+/).filter(word => word);
  const verdict = find(".chip[aria-pressed=true]")?.dataset.verdict;
  const family = find("#family")?.value;
  let shown = 0;
  for (const item of items) {
    const { words: itsWords, verdict: itsVerdict, family: itsFamily } = item.dataset;
    item.hidden = !words.every(word => itsWords.toLowerCase().includes(word))
      || (verdict && itsVerdict !== verdict) || (family && itsFamily !== family);
    shown += !item.hidden;
  }
  find("#shown").textContent = shown === items.length ? "" : `${shown} of ${items.length} shown`;
}

function step(by) {
  const visible = links.filter((_, i) => !items[i].hidden);
  const isHidden = getComputedStyle(find("nav")).display === "none";
  const from = visible.indexOf(isHidden || !links.includes(document.activeElement) ? links[open] : document.activeElement);
  const next = visible[from < 0 ? 0 : Math.max(0, Math.min(visible.length - 1, from + by))];
  if (isHidden) next?.click();
  else next?.focus();
}

// Opens the case at that place of the list, or none for -1.
async function openCase(which) {
  // The first case is open before anybody chooses it: what was read in it stays.
  if (which === open) return;
  open = which;
  pictures = null;
  setBlinking(false);
  viewer.hidden = true;
  main.classList.toggle("reading", which >= 0);
  articles.forEach((article, i) => article.classList.toggle("open", i === which));
  links.forEach((link, i) => i === which ? link.setAttribute("aria-current", "true") : link.removeAttribute("aria-current"));
  if (which < 0) return;
  const article = articles[which];
  if (main.getBoundingClientRect().top < 0 || getComputedStyle(find("nav")).display === "none") main.scrollIntoView();
  const stored = find(".pictures", article);
  if (!stored) return;
  find(".slot", article).append(viewer);
  viewer.hidden = false;
  const message = find("#stage-message");
  message.textContent = "Unpacking the images …";
  // A case that is opened twice is unpacked twice; only the later one may show and say so.
  const mine = ++unpackings;
  try {
    const unpacked = await unpack(JSON.parse(stored.textContent));
    if (mine !== unpackings || open !== which) return;
    showPictures(unpacked);
    message.textContent = "";
  } catch (error) {
    message.textContent = "DecompressionStream" in window
      ? `The images cannot be unpacked: ${error.message}`
      : "This browser is too old to unpack the images: it needs DecompressionStream (Chrome 80, Firefox 113, Safari 16.4).";
  }
}

function showPictures(unpacked) {
  pictures = unpacked;
  painted = new Map();
  pictures.ownScale = Math.log2(usualDifference() || 1);
  Object.assign(state, { exposure: pictures.exposure, zoom: 1, centre: [0.5, 0.5], pixel: null });
  state.scales = { difference: pictures.ownScale, z: Math.log2(10) };
  Object.assign(find("#exposure"), { min: pictures.exposure - 12, max: pictures.exposure + 12 });
  find("#worst").disabled = !pictures.paired;
  const image = pictures.test ?? pictures.golden;
  find("#broken").disabled = !Array.from({ length: image.width * image.height }, (_, i) => i).some(isBroken);
  find("#precision").textContent = pictures.test?.codes
    ? "Precision: codes, from 0 to 255, are exact; radiance is accurate to 0.05 %. Values brighter than white are lost in an 8-bit image."
    : "Precision: golden and test − golden are accurate to 0.05 %, however small; test is their sum. NaN and infinity are kept.";
  const wanted = [state.view, "side", "test", "golden"].find(isPossible);
  setView(wanted);
}

// The difference that all but one value in a thousand stay below.
function usualDifference() {
  if (!pictures.difference) return 0;
  const sizes = pictures.difference.filter(Number.isFinite).map(Math.abs).sort();
  return sizes[Math.floor(0.999 * sizes.length)] || sizes.at(-1);
}

const placeInAddress = () => {
  let name = location.hash.slice(1);
  try { name = decodeURIComponent(name); } catch { /* It is no fragment of this page. */ }
  return articles.findIndex(article => article.id === name);
};
addEventListener("hashchange", () => openCase(placeInAddress()));
findAll(".back").forEach(button => button.addEventListener("click", () => { location.hash = ""; }));
find("#filter").addEventListener("input", filterCases);
find("#family")?.addEventListener("change", filterCases);
const chips = findAll(".chip");
for (const chip of chips) chip.addEventListener("click", () => {
  const was = chip.getAttribute("aria-pressed") === "true";
  chips.forEach(other => other.setAttribute("aria-pressed", !was && other === chip));
  filterCases();
});

for (const button of findAll(".copy")) button.addEventListener("click", () => {
  const range = document.createRange();
  range.selectNodeContents(button.previousElementSibling);
  getSelection().removeAllRanges();
  getSelection().addRange(range);
  // From file:// the newer way, navigator.clipboard, is not open in every browser.
  button.textContent = document.execCommand("copy") ? "copied" : "press Ctrl+C";
});

// ---- Theme, help, keys ----

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  if (pictures) drawHistogram();
}

function toggleTheme() {
  const theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
  setTheme(theme);
  // Browsers may forbid storage to files.
  try { localStorage.setItem("volref-theme", theme); } catch { /* then it is not remembered */ }
}

const help = find("#help");
find("#theme").addEventListener("click", toggleTheme);
find("#help-button").addEventListener("click", () => help.showModal());

const KEYS = {
  j: () => step(1), k: () => step(-1),
  "/": () => find("#filter").focus(),
  1: () => setView("golden"), 2: () => setView("test"), 3: () => setView("difference"),
  4: () => setView("flip"), 5: () => setView("z"), 6: () => setView("side"),
  b: () => setView("blink"),
  s: () => { setView("swipe"); if (state.view === "swipe") find("#swipe").focus(); },
  "+": () => setExposure(state.exposure + 0.5), "=": () => setExposure(state.exposure + 0.5),
  "-": () => setExposure(state.exposure - 0.5),
  "[": () => stepScale(-0.5), "]": () => stepScale(0.5),
  c: () => setChannel(state.channel === 2 ? -1 : state.channel + 1),
  z: () => zoomBy(2), Z: () => zoomBy(0.5), 0: () => zoomBy(0),
  w: goToWorst, n: goToBroken, t: toggleTheme, "?": () => help.showModal(),
};
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

addEventListener("keydown", event => {
  if (help.open || event.ctrlKey || event.altKey || event.metaKey) return;
  const { target, key } = event;
  const isTyping = target.matches("input[type=search]");
  const arrow = ARROWS[key];
  if (key === "Escape" && isTyping) return target.blur();
  if (isTyping && key === "Enter") return links.find((_, i) => !items[i].hidden)?.click();
  if (arrow) {
    if (arrow[0] && state.view === "swipe" && target.matches("body, canvas, button")) setSwipe(state.swipe + 0.02 * arrow[0]);
    else if (target.matches("canvas") && pictures) movePixel(...arrow.map(by => by * (event.shiftKey ? 8 : 1)));
    else if (arrow[1] && (isTyping || target.matches("nav a, body"))) step(arrow[1]);
    else return;
  } else if (key === " " && state.view === "blink" && !target.matches("button, input, select, a")) {
    if (timer) setBlinking(false);
    else if (matchMedia("(prefers-reduced-motion: reduce)").matches) { state.isTest = !state.isTest; draw(); }
    else setBlinking(true);
  } else if (!isTyping && !target.matches("select") && KEYS[key]) {
    if (!pictures && !["j", "k", "/", "t", "?"].includes(key)) return;
    KEYS[key]();
  } else {
    return;
  }
  event.preventDefault();
});

let remembered = null;
try { remembered = localStorage.getItem("volref-theme"); } catch { /* see toggleTheme */ }
setTheme(remembered ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));
const asked = placeInAddress();
// On a narrow screen the list comes first.
if (asked >= 0) openCase(asked);
else if (links.length && matchMedia("(min-width: 801px)").matches) openCase(0);
})();
