#version 330 core
// A flat picture at a place of the screen; box is left, bottom, right, top in -1..1.
uniform vec4 box;
out vec2 at;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    at = vec2(corner.x, 1.0 - corner.y);
    gl_Position = vec4(mix(box.xy, box.zw, corner), 0.0, 1.0);
}
