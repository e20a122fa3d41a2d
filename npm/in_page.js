// The part of the runner that runs in the page.

import { Bundle, pixels } from './bundle.js';

/** The image that the module renders of the bundle: its type and values, or why it cannot. */
export async function run(step) {
  const place = new URL('..', import.meta.url);
  repeatRandomNumbers();
  const { description, files } = await (await fetch(`${place}bundle.json`)).json();
  const read = async (name, index) => [name, await (await fetch(`${place}files/${index}`)).arrayBuffer()];
  const bundle = new Bundle(description, Object.fromEntries(await Promise.all(files.map(read))));
  try {
    const { render } = await import(`${place}module`);
    if (typeof render !== 'function')
      throw new TypeError('the module exports no function render(element, bundle, step)');
    const image = await render(document.querySelector('div'), bundle, step ?? bundle.step);
    const { data, alpha } = values(image, bundle);
    return { ...packed(checked(data, bundle)), alpha };
  } catch (error) {
    if (error?.name === 'Refusal') return { cannot: error.message };
    throw error;
  }
}

/** Each image has the same random numbers. */
function repeatRandomNumbers() {
  let state = 1;
  Math.random = () => (state = (state * 1664525 + 1013904223) % 2 ** 32) / 2 ** 32;
}

function values(image, { width, height }) {
  if (image instanceof HTMLCanvasElement || image instanceof OffscreenCanvas) {
    if (image.width !== width || image.height !== height) {
      throw new RangeError(`the canvas has ${image.width} × ${image.height} pixels, and not ${width} × ${height}`);
    }
    return codes(image);
  }
  return image instanceof ImageData ? { data: image.data, alpha: 'straight' } : { data: image };
}

/** The codes of a canvas, and how its colours go with its opacity. */
function codes(canvas) {
  const gl = canvas.getContext('webgl2') ?? canvas.getContext('webgl');
  if (gl) {
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    // Divided by their opacity, codes of faint pixels would lose digits.
    return { data: pixels(gl), alpha: gl.getContextAttributes().premultipliedAlpha ? 'premultiplied' : 'straight' };
  }
  const { width, height } = canvas;
  const drawn = canvas.getContext('2d') ?? new OffscreenCanvas(width, height).getContext('2d');
  if (drawn.canvas !== canvas) drawn.drawImage(canvas, 0, 0);
  return { data: drawn.getImageData(0, 0, width, height).data, alpha: 'straight' };
}

function checked(values, { width, height }) {
  const isFloat = values instanceof Float32Array;
  if (!isFloat && !(values instanceof Uint8Array) && !(values instanceof Uint8ClampedArray)) {
    throw new TypeError(
      'render returns a canvas, an ImageData, a Uint8Array of RGBA codes or a Float32Array of radiance',
    );
  }
  if (![3, 4].includes(values.length / (width * height))) {
    throw new RangeError(
      `render returned ${values.length} values, which are not ${width} × ${height} pixels of 3 or 4`,
    );
  }
  return values;
}

function packed(values) {
  const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
  let text = '';
  for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
  return { type: values instanceof Float32Array ? 'float' : 'code', base64: btoa(text) };
}
