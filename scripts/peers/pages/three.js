// three.js: the volume shader of its examples, which projects the maximum.

import * as three from 'three';
import { refuse } from 'volref/bundle';
import { VolumeRenderShader1 as shader } from 'three/addons/shaders/VolumeShader.js';

function place(object, matrix) {
  object.matrixAutoUpdate = false;
  object.matrix.fromArray(matrix);
  object.matrixWorldNeedsUpdate = true;
}

export function render(element, bundle) {
  bundle.allow('parallel', 'placed', 'sheared', 'nearest', 'formula', 'maximum');
  if (bundle.mode === 'composited') refuse('composited samples');
  const { width, height, nodes, volume } = bundle;
  const renderer = new three.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
  renderer.setSize(width, height);
  // Colours are linear, as they are computed.
  renderer.outputColorSpace = three.LinearSRGBColorSpace;
  element.append(renderer.domElement);

  const texture = new three.Data3DTexture(volume.values, ...nodes);
  texture.format = three.RedFormat;
  texture.type = three.FloatType;
  texture.minFilter = texture.magFilter = volume.isNearest ? three.NearestFilter : three.LinearFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  const { bytes, least, most } = bundle.table(256);
  const colours = new three.DataTexture(bytes, 256, 1);
  colours.minFilter = colours.magFilter = three.LinearFilter;
  colours.needsUpdate = true;

  const uniforms = three.UniformsUtils.clone(shader.uniforms);
  uniforms.u_data.value = texture;
  uniforms.u_size.value.set(...nodes);
  uniforms.u_clim.value.set(least, most);
  uniforms.u_renderstyle.value = 0;
  uniforms.u_cmdata.value = colours;
  const { vertexShader, fragmentShader } = shader;
  const material = new three.ShaderMaterial({ uniforms, vertexShader, fragmentShader, side: three.BackSide });
  const box = new three.BoxGeometry(...nodes).translate(...nodes.map((n) => n / 2 - 0.5));
  const mesh = new three.Mesh(box, material);
  // Coordinates of the box are numbers of nodes.
  place(mesh, volume.affine);

  const { near, far, parallelHeight: tall } = bundle;
  const wide = (tall * width) / height;
  const camera = bundle.isParallel
    ? new three.OrthographicCamera(-wide / 2, wide / 2, tall / 2, -tall / 2, near, far)
    : new three.PerspectiveCamera(bundle.fieldOfView, width / height, near, far);
  place(camera, bundle.cameraToWorld);
  const scene = new three.Scene();
  scene.background = new three.Color().setRGB(...bundle.background, three.LinearSRGBColorSpace);
  scene.add(mesh);
  renderer.render(scene, camera);
  return renderer.domElement;
}
