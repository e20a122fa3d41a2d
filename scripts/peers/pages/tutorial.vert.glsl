#version 300 es
in vec3 place;
uniform mat4 camera;
uniform vec3 corner;
uniform vec3 size;
out vec3 back;

void main() {
    back = place;
    gl_Position = camera * vec4(corner + place * size, 1.0);
}
