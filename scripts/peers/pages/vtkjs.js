// vtk.js: a volume with its mapper, as its examples have it.

import '@kitware/vtk.js/Rendering/Profiles/Volume';
import vtkDataArray from '@kitware/vtk.js/Common/Core/DataArray';
import vtkImageData from '@kitware/vtk.js/Common/DataModel/ImageData';
import vtkPiecewiseFunction from '@kitware/vtk.js/Common/DataModel/PiecewiseFunction';
import vtkColorTransferFunction from '@kitware/vtk.js/Rendering/Core/ColorTransferFunction';
import vtkRenderer from '@kitware/vtk.js/Rendering/Core/Renderer';
import vtkRenderWindow from '@kitware/vtk.js/Rendering/Core/RenderWindow';
import vtkRenderWindowInteractor from '@kitware/vtk.js/Rendering/Core/RenderWindowInteractor';
import vtkVolume from '@kitware/vtk.js/Rendering/Core/Volume';
import vtkVolumeMapper from '@kitware/vtk.js/Rendering/Core/VolumeMapper';
import vtkOpenGLRenderWindow from '@kitware/vtk.js/Rendering/OpenGL/RenderWindow';
import { farthest, length, points } from './bundle.js';

const FORMULA = 1024;

function volume({ grid, interpolation, transfer_function: transfer }, values, step) {
  const image = vtkImageData.newInstance();
  image.setDimensions(...grid.nodes);
  image.setSpacing(...grid.spacing);
  image.setOrigin(...grid.first_node);
  image.getPointData().setScalars(vtkDataArray.newInstance({ values, numberOfComponents: 1 }));
  const mapper = vtkVolumeMapper.newInstance();
  mapper.setInputData(image);
  mapper.setAutoAdjustSampleDistances(false);
  mapper.setSampleDistance(step);
  mapper.setMaximumSamplesPerRay(100000);
  const opacity = vtkPiecewiseFunction.newInstance({ allowDuplicateScalars: true });
  const colour = vtkColorTransferFunction.newInstance({ allowDuplicateScalars: true });
  for (const point of points(transfer, FORMULA)) {
    opacity.addPoint(point.value, point.opacity);
    colour.addRGBPoint(point.value, ...point.colour);
  }
  const actor = vtkVolume.newInstance();
  actor.setMapper(mapper);
  const look = actor.getProperty();
  look.setScalarOpacity(0, opacity);
  look.setScalarOpacityUnitDistance(0, transfer.reference_length);
  look.setRGBTransferFunction(0, colour);
  look.setShade(false);
  if (interpolation.method === 'nearest') look.setInterpolationTypeToNearest();
  else look.setInterpolationTypeToLinear();
  return actor;
}

function setCamera(camera, panel) {
  const { eye, forward, half_up: up, orthographic_height: height } = panel.ray;
  camera.setPosition(...eye);
  camera.setFocalPoint(...eye.map((e, axis) => e + forward[axis]));
  camera.setViewUp(...up);
  if (height) {
    camera.setParallelProjection(true);
    camera.setParallelScale(height / 2);
  } else {
    camera.setViewAngle((2 * Math.atan(length(up)) * 180) / Math.PI);
  }
  camera.setClippingRange(1e-3 * farthest(panel), 2 * farthest(panel));
}

export async function render(element, panel, values, step) {
  const renderer = vtkRenderer.newInstance({ background: panel.background });
  renderer.addVolume(volume(panel, values, step));
  setCamera(renderer.getActiveCamera(), panel);
  const window = vtkRenderWindow.newInstance();
  window.addRenderer(renderer);
  const view = vtkOpenGLRenderWindow.newInstance();
  view.setContainer(element);
  view.setSize(panel.width, panel.height);
  window.addView(view);
  const interactor = vtkRenderWindowInteractor.newInstance();
  interactor.setView(view);
  interactor.initialize();
  const capture = view.captureNextImage('image/png');
  window.render();
  const image = new Image();
  image.src = await capture;
  await image.decode();
  const canvas = new OffscreenCanvas(panel.width, panel.height).getContext('2d');
  canvas.drawImage(image, 0, 0);
  return canvas.getImageData(0, 0, panel.width, panel.height).data;
}
