// K3D-jupyter: its Volume, unlit, in perspective. The page shows through where nothing is drawn, so its colours come with
// opacities.

import { pixels, refuse } from 'volref/bundle';

const TABLE = 256;

// Its bundle is a module of AMD.
let library;
globalThis.define = (...words) => (library = words.pop()());
await import('k3d/dist/standalone.js');
const { K3D, ThreeJsProvider } = library;

const floats = (data, ...shape) => ({ data: Float32Array.from(data), shape });

function volumeOf({ volume }, step) {
  const { spacing, nodes, first_node: first } = volume.part.grid;
  // Its values are those of cells: the faces of its box lie half a voxel beyond the nodes.
  const sides = spacing.map((voxel, axis) => voxel * nodes[axis]);
  const [x, y, z] = first.map((at, axis) => at + (spacing[axis] * (nodes[axis] - 1)) / 2);
  // Steps and opacities are those of its box as a unit cube.
  const longest = Math.max(...sides);
  const points = volume.points(TABLE);
  const [least, most] = [points[0].value, points.at(-1).value];
  // It keeps one of two points at one value.
  const isJump = (index) => points[index - 1]?.value === points[index].value;
  const place = (index) => (points[index].value - least) / (most - least) + (isJump(index) ? 1e-6 : 0);
  const colours = points.flatMap(({ colour }, index) => [place(index), ...colour]);
  const opacities = points.flatMap(({ opacity }, index) => [place(index), opacity]);
  return {
    type: 'Volume',
    visible: true,
    id: 1,
    volume: { data: volume.values, shape: [...nodes].reverse() },
    color_map: floats(colours, points.length, 4),
    opacity_function: floats(opacities, 2 * points.length),
    color_range: [least, most],
    samples: longest / step,
    alpha_coef: longest / volume.part.transfer_function.reference_length,
    interpolation: !volume.isNearest,
    shadow: 'off',
    mask: { data: [], shape: [0] },
    mask_opacities: { data: [], shape: [0] },
    model_matrix: floats([sides[0], 0, 0, x, 0, sides[1], 0, y, 0, 0, sides[2], z, 0, 0, 0, 1], 4, 4),
  };
}

export async function render(element, bundle, step) {
  bundle.allow();
  if (bundle.isParallel) refuse('parallel rays');
  const plot = K3D(ThreeJsProvider, element, {
    menuVisibility: false,
    gridVisible: false,
    axesHelper: 0,
    antialias: 0,
    lighting: 0,
    cameraAutoFit: false,
    cameraFov: bundle.fieldOfView,
  });
  await plot.load({ objects: [volumeOf(bundle, step)] });
  const target = bundle.eye.map((at, axis) => at + bundle.forward[axis]);
  plot.setCamera([...bundle.eye, ...target, ...bundle.up]);
  // Its screenshot fails where a plot is smaller than its helper of axes: pixels are read where they are drawn.
  const gl = plot.getWorld().renderer.getContext();
  const drawn = new Promise((resolve) => {
    plot.on(plot.events.RENDERED, () => {
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      resolve(Float32Array.from(pixels(gl), (code) => code / 255));
    });
  });
  plot.render(true);
  return drawn;
}
