// The WebGL 2 ray marcher of courses: the back faces of a cube, a ray in texture coordinates, a fixed step, a table of
// 256 RGBA bytes with the opacities of a step.

import { length, pixels, table } from './bundle.js';
import fragment from './tutorial.frag.glsl';
import vertex from './tutorial.vert.glsl';

function program(gl) {
  const linked = gl.createProgram();
  const stages = [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ];
  for (const [stage, source] of stages) {
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
  for (const key of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) {
    gl.texParameteri(target, key, gl.CLAMP_TO_EDGE);
  }
}

/** Matrix from the world to clip space, by columns. */
function camera({ ray, width, height }) {
  const size = length(ray.half_up);
  const axes = [ray.half_right.map((v) => v / size), ray.half_up.map((v) => v / size), ray.forward];
  const along = axes.map((axis) => [...axis, -axis.reduce((sum, v, k) => sum + v * ray.eye[k], 0)]);
  const [near, far] = [0.001, 20];
  const parallel = ray.orthographic_height;
  const scale = parallel ? ray.orthographic_height / 2 : size;
  const depth = parallel ? [2 / (far - near), -(far + near) / (far - near)] : [(far + near) / (far - near), (-2 * far * near) / (far - near)];
  const one = [0, 0, 0, 1];
  const rows = [
    along[0].map((v) => (v * height) / (width * scale)),
    along[1].map((v) => v / scale),
    along[2].map((v, k) => v * depth[0] + one[k] * depth[1]),
    parallel ? one : along[2],
  ];
  return [0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column]));
}

/** Triangles of the unit cube. */
function cube() {
  const corners = [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]];
  return [0, 1, 2].flatMap((axis) =>
    [0, 1].flatMap((side) =>
      corners.flatMap(([a, b]) => {
        const point = [];
        point[axis] = side;
        point[(axis + 1) % 3] = side ? a : b;
        point[(axis + 2) % 3] = side ? b : a;
        return point;
      }),
    ),
  );
}

export function render(element, panel, values, step) {
  const { grid, ray, width, height } = panel;
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [width, height];
  element.append(canvas);
  const gl = canvas.getContext('webgl2', { antialias: false });
  gl.getExtension('OES_texture_float_linear');
  const shader = program(gl);
  const uniform = (name) => gl.getUniformLocation(shader, name);

  texture(gl, 0, gl.TEXTURE_3D, panel.interpolation.method === 'nearest' ? gl.NEAREST : gl.LINEAR);
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.R32F, ...grid.nodes, 0, gl.RED, gl.FLOAT, values);
  texture(gl, 1, gl.TEXTURE_2D, gl.LINEAR);
  const { bytes, least, most } = table(panel.transfer_function, 256, step);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);

  const size = grid.box_max.map((most, axis) => most - grid.box_min[axis]);
  gl.uniform1i(uniform('volume'), 0);
  gl.uniform1i(uniform('transfer'), 1);
  gl.uniform2f(uniform('range'), least, most);
  gl.uniform1f(uniform('step'), step / Math.max(...size));
  gl.uniformMatrix4fv(uniform('camera'), false, camera(panel));
  gl.uniform3fv(uniform('corner'), grid.box_min);
  gl.uniform3fv(uniform('size'), size);
  gl.uniform3fv(uniform('eye'), ray.eye.map((e, axis) => (e - grid.box_min[axis]) / size[axis]));
  gl.uniform3fv(uniform('forward'), ray.forward.map((f, axis) => f / size[axis]));
  gl.uniform1i(uniform('isParallel'), ray.orthographic_height ? 1 : 0);

  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(cube()), gl.STATIC_DRAW);
  const place = gl.getAttribLocation(shader, 'place');
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
  gl.viewport(0, 0, width, height);
  gl.clearColor(...panel.background, 1);
  gl.clear(gl.COLOR_BUFFER_BIT);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  gl.enable(gl.CULL_FACE);
  gl.cullFace(gl.FRONT);
  gl.drawArrays(gl.TRIANGLES, 0, 36);
  return pixels(gl, width, height);
}
