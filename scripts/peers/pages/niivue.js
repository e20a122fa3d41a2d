// niivue: its volume rendering, without a clip plane. It has parallel rays around the centre with z up, and steps of
// one voxel; volumes with y up are turned.

import { NVImage, Niivue, SLICE_TYPE } from '@niivue/niivue';
import { pixels, table } from './bundle.js';

const MILLIMETRES = 100; // to a unit of the scene
const FLOAT32 = 16; // datatype of NIfTI

export async function render(element, panel, values, step) {
  const { grid, ray, transfer_function: transfer, width, height } = panel;
  if (!ray.orthographic_height) throw new Error('refused: niivue has parallel rays only');
  if (panel.interpolation.method === 'nearest') throw new Error('refused: niivue interpolates');
  const voxel = Math.min(...grid.spacing);
  // An integral asks for no step.
  const isSampled = panel.compositing.method !== 'continuous';
  if (isSampled && Math.abs(panel.sampling.step - voxel) > 1e-6 * voxel) {
    throw new Error('refused: niivue has steps of one voxel');
  }
  const { bytes, least, most } = table(transfer, 256, voxel);
  const channel = (k) => Array.from({ length: 256 }, (_, index) => bytes[4 * index + k]);

  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [width, height];
  [canvas.style.width, canvas.style.height] = [`${width}px`, `${height}px`];
  element.append(canvas);
  const niivue = new Niivue({
    backColor: [...panel.background, 1],
    show3Dcrosshair: false,
    isOrientationTextVisible: false,
    forceDevicePixelRatio: 1,
    logLevel: 'error',
  });
  await niivue.attachToCanvas(canvas);
  const indices = Array.from({ length: 256 }, (_, index) => index);
  niivue.addColormap('table', { R: channel(0), G: channel(1), B: channel(2), A: channel(3), I: indices });

  const isZUp = Math.abs(ray.half_right[2]) < 1e-9 && ray.half_up[2] > 1e-9;
  const turn = ([x, y, z]) => (isZUp ? [x, y, z] : [x, -z, y]);
  const columns = [0, 1, 2].map((axis) => turn([0, 1, 2].map((k) => (k === axis ? grid.spacing[axis] : 0))));
  const origin = turn(grid.first_node);
  const row = (k) => [...columns.map((column) => column[k]), origin[k]].map((value) => value * MILLIMETRES);
  const affine = [...row(0), ...row(1), ...row(2), 0, 0, 0, 1];
  const spacing = grid.spacing.map((value) => value * MILLIMETRES);
  const nifti = NVImage.createNiftiArray(grid.nodes, spacing, affine, FLOAT32, values);
  const url = URL.createObjectURL(new Blob([nifti]));
  await niivue.loadVolumes([{ url, name: 'volume.nii', colormap: 'table', cal_min: least, cal_max: most }]);
  const [volume] = niivue.volumes;
  [volume.cal_min, volume.cal_max] = [least, most];
  niivue.updateGLVolume();

  niivue.setSliceType(SLICE_TYPE.RENDER);
  const [x, y, z] = turn(ray.forward);
  const degrees = 180 / Math.PI;
  niivue.setRenderAzimuthElevation(180 + Math.atan2(-x, -y) * degrees, Math.asin(-z) * degrees);
  niivue.setScale((0.8 * niivue.furthestFromPivot) / ((ray.orthographic_height / 2) * MILLIMETRES));
  niivue.drawScene();
  return pixels(niivue.gl, width, height);
}
