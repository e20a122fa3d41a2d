#version 300 es
in vec3 place;
uniform mat4 camera;
out vec3 back;

void main() {
    back = place;
    gl_Position = camera * vec4(place, 1.0);
}
