// Words of bundles that renderers of pages share.

/** Length of a vector. */
export const length = (vector) => Math.hypot(...vector);

/** Distance from the eye to the farthest corner of the box. */
export function farthest({ grid, ray }) {
  const reach = (e, axis) => Math.max(Math.abs(grid.box_min[axis] - e), Math.abs(grid.box_max[axis] - e));
  return length(ray.eye.map(reach));
}

/** Points of a transfer function, opacities over the reference length; of a formula `count` of them. */
export function points(transfer, count) {
  if (transfer.points) return transfer.points;
  const { colours, floor } = transfer;
  return Array.from({ length: count }, (_, index) => {
    const value = index / (count - 1);
    const clear = (Math.exp(-(value ** 2)) - floor) / (1 - floor);
    const place = value * (colours.length - 1);
    const before = Math.max(0, Math.min(Math.floor(place), colours.length - 2));
    const next = colours[before + 1] ?? colours[before];
    const colour = colours[before].map((c, k) => (c + (next[k] - c) * (place - before)) * value ** 2);
    return { value, colour, opacity: 1 - Math.min(1, Math.max(0, clear)) };
  });
}

/** A table of `count` bytes a channel, red, green, blue and opacity over `step`, from the first point to the last. */
export function table(transfer, count, step) {
  const known = points(transfer, count);
  const least = known[0].value;
  const most = known.at(-1).value;
  const bytes = new Uint8Array(4 * count);
  for (let index = 0; index < count; index++) {
    const value = least + ((most - least) * index) / (count - 1);
    const after = known.findIndex((point) => point.value > value);
    const q = known[after < 0 ? known.length - 1 : Math.max(after, 1)];
    const p = known[known.indexOf(q) - 1];
    const share = Math.min(1, (value - p.value) / (q.value - p.value));
    const between = (a, b) => a + (b - a) * share;
    const opacity = 1 - (1 - between(p.opacity, q.opacity)) ** (step / transfer.reference_length);
    const look = [...p.colour.map((c, k) => between(c, q.colour[k])), opacity];
    look.forEach((part, k) => (bytes[4 * index + k] = Math.round(255 * part)));
  }
  return { bytes, least, most };
}

/** The codes of a WebGL context's frame buffer, top row first. */
export function pixels(gl, width, height) {
  const bottomUp = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bottomUp);
  const row = (y) => bottomUp.subarray(4 * width * y, 4 * width * (y + 1));
  return Array.from({ length: height }, (_, y) => [...row(height - 1 - y)]).flat();
}
