// Numbers of bundles, held to the formulas that bundles state.

import assert from 'node:assert';
import { test } from 'node:test';
import { exportBundle } from 'volref';
import { Bundle, Refusal, determinant, invert, multiply, transform } from 'volref/bundle';

const CASES = [
  'sampled/perspective-z-up',
  'sampled/parallel-z-up',
  'sampled/from-within',
  'sampled/column',
  'scenes/sheared',
  'scenes/off-centre',
];

const near = (a, b, tolerance = 1e-9) => {
  for (const [k, value] of a.entries()) assert.ok(Math.abs(value - b[k]) <= tolerance, `${a} is not ${b}`);
};

/** The point at t on the ray of a pixel, by the words of the bundle. */
function onRay({ panel }, x, y, t) {
  const { eye, forward, half_right: right, half_up: up, orthographic_height: isParallel } = panel.ray;
  const { width, height } = panel;
  const aside = (k) => (right[k] * (2 * x + 1 - width)) / height - (up[k] * (2 * y + 1 - height)) / height;
  const along = forward.map((f, k) => (isParallel ? f : f + aside(k)));
  const size = Math.hypot(...along);
  return eye.map((e, k) => e + (isParallel ? aside(k) : 0) + (t * along[k]) / size);
}

for (const name of CASES) {
  test(`a point of a ray comes back to its pixel: ${name}`, () => {
    const bundle = exportBundle(name);
    const clip = multiply(bundle.projection, bundle.view);
    for (const [x, y] of [
      [0, 0],
      [bundle.width - 1, 0],
      [0, bundle.height - 1],
      [17, 31],
    ]) {
      for (const t of [bundle.near, 0.5 * (bundle.near + bundle.far), bundle.far]) {
        const [right, up] = transform(clip, onRay(bundle, x, y, t));
        near([((right + 1) * bundle.width - 1) / 2, ((1 - up) * bundle.height - 1) / 2], [x, y], 1e-6);
      }
    }
    near(multiply(bundle.view, bundle.cameraToWorld), [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    assert.ok(Math.abs(determinant(bundle.cameraToWorld) - 1) < 1e-9, 'the camera is right-handed');
    const depths = bundle.corners.map((corner) => transform(clip, corner)[2]);
    const isWithin = name === 'sampled/from-within';
    assert.ok(isWithin || depths.every((depth) => depth < 1 && depth > -1), `${depths}`);
  });

  test(`nodes and box stand where the bundle says: ${name}`, () => {
    const bundle = exportBundle(name);
    const { grid } = bundle.panel;
    const placed = (q) =>
      grid.matrix ? grid.matrix.map((row) => row[3] + q.reduce((sum, v, k) => sum + row[k] * v, 0)) : q;
    const node = [1, 0, 2];
    near(transform(bundle.affine, node), placed(grid.first_node.map((first, k) => first + node[k] * grid.spacing[k])));
    near(bundle.corners[0], placed(grid.box_min));
    near(bundle.corners[7], placed(grid.box_max));
    near(transform(invert(bundle.volume.boxToWorld), placed(grid.box_max)), [1, 1, 1]);
    assert.strictEqual(
      bundle.values.length,
      bundle.nodes.reduce((product, n) => product * n, 1),
    );
  });
}

/** A bundle of one volume with that transfer function. */
function withTransfer(transfer, changes = {}) {
  const { description, files } = exportBundle('sampled/two-point-ramp');
  const [panel] = description.panels;
  return new Bundle({ ...description, panels: [{ ...panel, transfer_function: transfer, ...changes }] }, files);
}

test('a table is the closed form of its points', () => {
  const points = [
    { value: -1, colour: [0, 0.2, 1], opacity: 0.1 },
    { value: 3, colour: [1, 0.4, 0], opacity: 0.9 },
  ];
  const bundle = withTransfer({ kind: 'table', reference_length: 0.2, points });
  const lengths = { length: 0.2, step: 0.05, voxel: Math.min(...bundle.panel.grid.spacing) };
  for (const [per, length] of Object.entries(lengths)) {
    const { floats, bytes, least, most } = bundle.table(5, { per, step: 0.05 });
    assert.deepStrictEqual([least, most], [-1, 3]);
    for (let k = 0; k < 5; k++) {
      const opacity = 1 - (1 - (0.1 + 0.2 * k)) ** (length / 0.2);
      const right = [k / 4, 0.2 + 0.05 * k, 1 - k / 4, opacity];
      near([...floats.subarray(4 * k, 4 * k + 4)], right, 1e-6);
      assert.deepStrictEqual(
        [...bytes.subarray(4 * k, 4 * k + 4)],
        right.map((part) => Math.round(255 * part)),
      );
    }
  }
});

test('of two points at one value the later holds, at either end, too', () => {
  const point = (value, opacity) => ({ value, colour: [opacity, 0, 0], opacity });
  const jumps = [point(0, 0.1), point(0, 0.2), point(1, 0.3), point(1, 0.5), point(2, 0.6), point(2, 0.7)];
  const { floats } = withTransfer({ kind: 'table', reference_length: 1, points: jumps }).table(5);
  near(
    [0, 1, 2, 3, 4].map((k) => floats[4 * k]),
    [0.2, 0.25, 0.5, 0.55, 0.7],
    1e-6,
  );
});

test('a formula is computed', () => {
  const bundle = exportBundle('sampled/formula');
  const { floor, colours, reference_length: reference } = bundle.panel.transfer_function;
  const { floats, least, most } = bundle.table(101, { per: 'step', step: 2 * reference });
  assert.deepStrictEqual([least, most], [0, 1]);
  for (const k of [0, 30, 100]) {
    const d = k / 100;
    const clear = Math.min(1, Math.max(0, (Math.exp(-d * d) - floor) / (1 - floor)));
    const place = Math.min(d * (colours.length - 1), colours.length - 1 - 1e-12);
    const [before, share] = [Math.floor(place), place % 1];
    const colour = colours[before].map((c, axis) => (c + (colours[before + 1][axis] - c) * share) * d * d);
    near([...floats.subarray(4 * k, 4 * k + 4)], [...colour, 1 - clear ** 2], 1e-6);
  }
});

test('a formula is tabled up to the largest value', () => {
  const { description, files } = exportBundle('sampled/formula');
  const [name] = Object.keys(files);
  const values = new Float32Array(files[name].length / 4).fill(2);
  const bundle = new Bundle(description, { [name]: values });
  const { most, floats } = bundle.table(3);
  assert.strictEqual(most, 2);
  // Colours are the last from 1 on, times the square of the value.
  const last = bundle.panel.transfer_function.colours.at(-1);
  near(
    [...floats.subarray(8, 11)],
    last.map((part) => 4 * part),
    1e-6,
  );
});

test('a projection shows colours without opacity', () => {
  const window = exportBundle('scenes/maximum');
  const { low, high } = window.panel.mode;
  assert.deepStrictEqual(
    window.points().map(({ value, opacity }) => [value, opacity]),
    [
      [low, 1],
      [high, 1],
    ],
  );
  const exact = exportBundle('scenes/maximum-exact');
  assert.ok(exact.points().every((point) => point.opacity === 1));
  assert.strictEqual(exact.step, exact.panel.sampling.step / 16);
  assert.throws(() => exportBundle('scenes/isosurfaces').points(), Refusal);
});

test('what a renderer has no words for is refused by name', () => {
  const refused = (name, ...known) => {
    const bundle = exportBundle(name);
    assert.throws(() => bundle.allow(...known), Refusal);
    try {
      bundle.allow(...known);
    } catch (error) {
      return error.message;
    }
  };
  assert.strictEqual(refused('scenes/maximum', 'mean', 'shading'), 'mode = "maximum"');
  assert.match(
    refused('scenes/three-in-shadow', 'maximum'),
    /3 volumes; a volume placed by a matrix; .*shading; a shadow/,
  );
  assert.match(refused('scenes/ball-in-rings', 'maximum'), /surfaces/);
  assert.match(refused('figures/figure-5'), /more than one panel/);
  assert.ok(Object.keys(exportBundle('figures/figure-2').files).length > 0);
  assert.match(refused('sampled/nearest-blocks'), /values of the nearest node/);
  assert.match(refused('sampled/parallel-z-up', 'nearest'), /parallel rays/);
  assert.match(refused('sampled/formula', 'parallel'), /a transfer function by formulas/);
  assert.strictEqual(refused('scenes/sheared', 'placed', 'shading', 'formula'), 'a volume that is sheared');
  exportBundle('scenes/shadowed').allow('placed', 'sheared', 'shading', 'shadow');
  assert.throws(
    () => exportBundle('sampled/thin').allow('orthographic'),
    /orthographic is no feature: give several, parallel/,
  );
  assert.throws(() => exportBundle('sampled/thin').table(1), /2 entries or more/);
  assert.throws(() => exportBundle('sampled/thin').table(8, { per: 'metre' }), /give one of length, step, voxel/);
  assert.throws(() => exportBundle('smoke/cornell').panel);
});

test('several volumes are read one by one', () => {
  const { volumes } = exportBundle('scenes/three-in-shadow');
  assert.strictEqual(volumes.length, 3);
  for (const volume of volumes) assert.ok(volume.table(16).floats.every(Number.isFinite));
  assert.throws(() => exportBundle('scenes/three-in-shadow').values, Refusal);
});

test('a bundle that is damaged is rejected', () => {
  const { description, files } = exportBundle('sampled/thin');
  const [file] = Object.keys(files);
  assert.throws(() => new Bundle({ ...description, schema: 'volref/bundle/99' }, files), /bundle\/99/);
  assert.throws(() => new Bundle(null, files), /schema/);
  assert.throws(() => new Bundle(description, {}).values, /lacks its file/);
  assert.throws(
    () => new Bundle(description, { [file]: files[file].subarray(4) }).values,
    /21951 values, and not 21952/,
  );
});
