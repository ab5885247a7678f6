#version 330 core
// What the sun sees: places only.
layout(location = 0) in vec3 position;
#ifdef SKINNED
layout(location = 4) in uvec4 joints;
layout(location = 5) in vec4 weights;
uniform vec4 links[129];
#endif
uniform mat4 T_clip_world;
uniform mat4 T_world_model;

void main() {
#ifdef SKINNED
    vec4 x = vec4(0.0), y = vec4(0.0), z = vec4(0.0);
    for (int i = 0; i < INFLUENCES; i++) {
        int row = 3 * int(joints[i]);
        x += weights[i] * links[row];
        y += weights[i] * links[row + 1];
        z += weights[i] * links[row + 2];
    }
    vec4 bound = vec4(position, 1.0);
    vec3 p = vec3(dot(x, bound), dot(y, bound), dot(z, bound));
#else
    vec3 p = (T_world_model * vec4(position, 1.0)).xyz;
#endif
    gl_Position = T_clip_world * vec4(p, 1.0);
}
