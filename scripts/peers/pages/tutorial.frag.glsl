#version 300 es
precision highp float;
precision highp sampler3D;
in vec3 back;
out vec4 colour;
uniform sampler3D volume;
uniform sampler2D transfer;
uniform vec2 range;
uniform vec3 eye;
uniform vec3 forward;
uniform bool isParallel;
uniform float step;

// Distances at which a ray enters and leaves the unit cube.
vec2 span(vec3 origin, vec3 direction) {
    vec3 a = -origin / direction;
    vec3 b = (1.0 - origin) / direction;
    vec3 near = min(a, b);
    vec3 far = max(a, b);
    return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

void main() {
    vec3 direction = normalize(isParallel ? forward : back - eye);
    vec3 origin = isParallel ? back - 4.0 * direction : eye;
    vec2 hit = span(origin, direction);
    hit.x = max(hit.x, 0.0);
    if (hit.x > hit.y) discard;
    vec3 p = origin + hit.x * direction;
    colour = vec4(0.0);
    for (float t = hit.x; t <= hit.y; t += step) {
        float value = (texture(volume, p).r - range.x) / (range.y - range.x);
        vec4 look = texture(transfer, vec2(value, 0.5));
        colour.rgb += (1.0 - colour.a) * look.a * look.rgb;
        colour.a += (1.0 - colour.a) * look.a;
        if (colour.a > 0.95) break;
        p += direction * step;
    }
}
