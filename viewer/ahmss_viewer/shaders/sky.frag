#version 330 core
in float height;
out vec4 pixel;

void main() {
    pixel = vec4(mix(vec3(0.90, 0.90, 0.885), vec3(0.72, 0.79, 0.86), height), 1.0);
}
