// The WebGL 2 ray marcher of courses: the back faces of a cube, a ray in texture coordinates, a fixed step, a table of
// 256 RGBA bytes with the opacities of a step.

import { columns, determinant, invert, length, multiply, transform } from 'volref/bundle';
import fragment from './tutorial.frag.glsl';
import vertex from './tutorial.vert.glsl';

function program(gl) {
  const linked = gl.createProgram();
  for (const [stage, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(stage);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    const log = gl.getShaderInfoLog(shader);
    if (log) throw new Error(log);
    gl.attachShader(linked, shader);
  }
  gl.linkProgram(linked);
  gl.useProgram(linked);
  return linked;
}

function texture(gl, unit, target, filter) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(target, gl.createTexture());
  for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(target, key, filter);
  for (const axis of 'STR') gl.texParameteri(target, gl[`TEXTURE_WRAP_${axis}`], gl.CLAMP_TO_EDGE);
}

/** Triangles of the unit cube. */
function cube() {
  const corners = [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]];
  const turned = (axis, point) => [0, 1, 2].map((k) => point[(k - axis + 3) % 3]);
  const face = (axis, side) => corners.map(([a, b]) => turned(axis, side ? [1, a, b] : [0, b, a]));
  return [0, 1, 2].flatMap((axis) => [0, 1].flatMap((side) => face(axis, side))).flat();
}

export function render(element, bundle, step) {
  bundle.allow('parallel', 'placed', 'sheared', 'nearest', 'formula');
  const { width, height, volume } = bundle;
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [width, height];
  element.append(canvas);
  const gl = canvas.getContext('webgl2', { antialias: false });
  gl.getExtension('OES_texture_float_linear');
  const shader = program(gl);
  const set = (name, kind, ...values) => gl[`uniform${kind}`](gl.getUniformLocation(shader, name), ...values);

  texture(gl, 0, gl.TEXTURE_3D, volume.isNearest ? gl.NEAREST : gl.LINEAR);
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.R32F, ...volume.nodes, 0, gl.RED, gl.FLOAT, volume.values);
  texture(gl, 1, gl.TEXTURE_2D, gl.LINEAR);
  const { bytes, least, most } = bundle.table(256, { per: 'step', step });
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);

  const box = volume.boxToWorld;
  const toBox = invert(box);
  set('transfer', '1i', 1);
  set('range', '2f', least, most);
  set('step', '1f', step / Math.max(...columns(box).map(length)));
  set('camera', 'Matrix4fv', false, multiply(bundle.projection, multiply(bundle.view, box)));
  set('eye', '3fv', transform(toBox, bundle.eye));
  set('forward', '3fv', transform(toBox, bundle.forward, 0));
  set('isParallel', '1i', bundle.isParallel ? 1 : 0);

  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(cube()), gl.STATIC_DRAW);
  const place = gl.getAttribLocation(shader, 'place');
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
  gl.viewport(0, 0, width, height);
  gl.clearColor(...bundle.background, 1);
  gl.clear(gl.COLOR_BUFFER_BIT);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  gl.enable(gl.CULL_FACE);
  gl.cullFace(determinant(box) > 0 ? gl.FRONT : gl.BACK);
  gl.drawArrays(gl.TRIANGLES, 0, 36);
  return canvas;
}
