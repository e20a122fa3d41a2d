// vtk.js: a volume with its mapper, as its examples have it.

import '@kitware/vtk.js/Rendering/Profiles/Volume';
import vtkDataArray from '@kitware/vtk.js/Common/Core/DataArray';
import vtkImageData from '@kitware/vtk.js/Common/DataModel/ImageData';
import vtkPiecewiseFunction from '@kitware/vtk.js/Common/DataModel/PiecewiseFunction';
import vtkColorTransferFunction from '@kitware/vtk.js/Rendering/Core/ColorTransferFunction';
import vtkLight from '@kitware/vtk.js/Rendering/Core/Light';
import vtkRenderer from '@kitware/vtk.js/Rendering/Core/Renderer';
import vtkRenderWindow from '@kitware/vtk.js/Rendering/Core/RenderWindow';
import vtkRenderWindowInteractor from '@kitware/vtk.js/Rendering/Core/RenderWindowInteractor';
import vtkVolume from '@kitware/vtk.js/Rendering/Core/Volume';
import vtkVolumeMapper from '@kitware/vtk.js/Rendering/Core/VolumeMapper';
import vtkOpenGLRenderWindow from '@kitware/vtk.js/Rendering/OpenGL/RenderWindow';

const INTENSITIES = { maximum: 'MaximumIntensity', minimum: 'MinimumIntensity', mean: 'AverageIntensity' };

function actorOf(bundle, step) {
  const { grid, phong, transfer_function: transfer } = bundle.panel;
  const image = vtkImageData.newInstance({ spacing: grid.spacing, origin: grid.first_node });
  image.setDimensions(...grid.nodes);
  image.getPointData().setScalars(vtkDataArray.newInstance({ values: bundle.values, numberOfComponents: 1 }));
  const mapper = vtkVolumeMapper.newInstance({ maximumSamplesPerRay: 100000 });
  mapper.setInputData(image);
  mapper.setAutoAdjustSampleDistances(false);
  mapper.setSampleDistance(step);
  mapper[`setBlendModeTo${INTENSITIES[bundle.mode] ?? 'Composite'}`]();
  const opacity = vtkPiecewiseFunction.newInstance({ allowDuplicateScalars: true });
  const colour = vtkColorTransferFunction.newInstance({ allowDuplicateScalars: true });
  for (const point of bundle.points()) {
    opacity.addPoint(point.value, point.opacity);
    colour.addRGBPoint(point.value, ...point.colour);
  }
  const actor = vtkVolume.newInstance();
  actor.setMapper(mapper);
  actor.setUserMatrix(bundle.volume.matrix);
  const look = actor.getProperty();
  look.setScalarOpacity(0, opacity);
  if (transfer) look.setScalarOpacityUnitDistance(0, transfer.reference_length);
  look.setRGBTransferFunction(0, colour);
  look.setShade(Boolean(phong));
  const { ambient, diffuse, specular, shininess: specularPower } = phong ?? {};
  if (phong) look.set({ ambient, diffuse, specular, specularPower });
  if (bundle.volume.isNearest) look.setInterpolationTypeToNearest();
  else look.setInterpolationTypeToLinear();
  return actor;
}

function setCamera(camera, bundle) {
  camera.setPosition(...bundle.eye);
  camera.setFocalPoint(...bundle.eye.map((e, axis) => e + bundle.forward[axis]));
  camera.setViewUp(...bundle.up);
  camera.setParallelProjection(bundle.isParallel);
  if (bundle.isParallel) camera.setParallelScale(bundle.parallelHeight / 2);
  else camera.setViewAngle(bundle.fieldOfView);
  camera.setClippingRange(1e-3 * bundle.farthest, 2 * bundle.farthest);
}

export function render(element, bundle, step) {
  bundle.allow('parallel', 'placed', 'sheared', 'nearest', 'formula', 'shading', ...Object.keys(INTENSITIES));
  const { background, panel, width, height } = bundle;
  const renderer = vtkRenderer.newInstance({ background, automaticLightCreation: false, twoSidedLighting: false });
  renderer.addVolume(actorOf(bundle, step));
  setCamera(renderer.getActiveCamera(), bundle);
  const lamp = { lightType: 'SceneLight', positional: true, coneAngle: 180, position: panel.light?.position };
  if (panel.light) renderer.addLight(vtkLight.newInstance(lamp));
  const window = vtkRenderWindow.newInstance();
  window.addRenderer(renderer);
  const view = vtkOpenGLRenderWindow.newInstance();
  view.setContainer(element);
  view.setSize(width, height);
  window.addView(view);
  const interactor = vtkRenderWindowInteractor.newInstance();
  interactor.setView(view);
  interactor.initialize();
  window.render();
  return view.getCanvas();
}
