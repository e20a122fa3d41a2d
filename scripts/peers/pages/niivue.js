// niivue: its volume rendering, without a clip plane. It has parallel rays around the centre with z up, and steps of
// one voxel; volumes with y up are turned.

import { NVImage, Niivue, SLICE_TYPE } from '@niivue/niivue';
import { refuse, transform } from 'volref/bundle';

const MILLIMETRES = 100; // to a unit of the scene
const FLOAT32 = 16; // datatype of NIfTI

export async function render(element, bundle) {
  // An integral asks for no step.
  const isSampled = bundle.panel.compositing?.method !== 'continuous';
  bundle.allow('parallel', 'formula');
  if (!bundle.isParallel) refuse('rays from one point');
  const { voxel, affine } = bundle.volume;
  if (isSampled && Math.abs(bundle.step - voxel) > 1e-6 * voxel) refuse('steps other than one voxel');
  const { bytes, least, most } = bundle.table(256, { per: 'voxel' });
  const channel = (k) => Array.from({ length: 256 }, (_, index) => bytes[4 * index + k]);

  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [bundle.width, bundle.height];
  [canvas.style.width, canvas.style.height] = [`${bundle.width}px`, `${bundle.height}px`];
  element.append(canvas);
  const niivue = new Niivue({
    backColor: [...bundle.background, 1],
    show3Dcrosshair: false,
    isOrientationTextVisible: false,
    forceDevicePixelRatio: 1,
    logLevel: 'error',
  });
  await niivue.attachToCanvas(canvas);
  const indices = Array.from({ length: 256 }, (_, index) => index);
  niivue.addColormap('table', { R: channel(0), G: channel(1), B: channel(2), A: channel(3), I: indices });

  const isZUp = Math.abs(bundle.right[2]) < 1e-9 && bundle.up[2] > 1e-9;
  const turn = ([x, y, z]) => (isZUp ? [x, y, z] : [x, -z, y]);
  const columns = [0, 1, 2].map((axis) => turn(affine.slice(4 * axis, 4 * axis + 3)));
  const origin = turn(transform(affine, [0, 0, 0]));
  const row = (k) => [...columns.map((column) => column[k]), origin[k]].map((value) => value * MILLIMETRES);
  const rows = [...row(0), ...row(1), ...row(2), 0, 0, 0, 1];
  const spacing = bundle.panel.grid.spacing.map((value) => value * MILLIMETRES);
  const nifti = NVImage.createNiftiArray(bundle.nodes, spacing, rows, FLOAT32, bundle.values);
  const url = URL.createObjectURL(new Blob([nifti]));
  await niivue.loadVolumes([{ url, name: 'volume.nii', colormap: 'table', cal_min: least, cal_max: most }]);
  const [volume] = niivue.volumes;
  [volume.cal_min, volume.cal_max] = [least, most];
  niivue.updateGLVolume();

  niivue.setSliceType(SLICE_TYPE.RENDER);
  const [x, y, z] = turn(bundle.forward);
  const degrees = 180 / Math.PI;
  niivue.setRenderAzimuthElevation(180 + Math.atan2(-x, -y) * degrees, Math.asin(-z) * degrees);
  niivue.setScale((0.8 * niivue.furthestFromPivot) / ((bundle.parallelHeight / 2) * MILLIMETRES));
  niivue.drawScene();
  return canvas;
}
