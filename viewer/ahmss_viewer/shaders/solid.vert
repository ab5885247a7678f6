#version 330 core
// Lights a vertex: the picture's cost without a GPU is pixels, so what can be done per vertex is done here.
// Colours are squared on the way in and rooted on the way out: light adds up as light does, nearly as sRGB's curve.
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
layout(location = 2) in vec4 colour;
layout(location = 3) in vec2 texcoord;
#ifdef SKINNED
layout(location = 4) in uvec4 joints;
layout(location = 5) in vec4 weights;
uniform vec4 links[129];  // the upper three rows of each link's matrix
#endif
uniform mat4 T_clip_world;
uniform mat4 T_world_model;
uniform mat4 T_shadows_world;  // to the texture of the sun's shadows
uniform vec3 sun;   // towards it
uniform vec3 fill;  // towards the weak second light
out vec4 shade;  // light without the sun, and how much more the sun adds
out vec3 in_shadows;
#ifdef TEXTURED
out vec2 at;
#endif

void main() {
    vec3 p, n;
#ifdef SKINNED
    vec4 x = vec4(0.0), y = vec4(0.0), z = vec4(0.0);
    for (int i = 0; i < INFLUENCES; i++) {
        int row = 3 * int(joints[i]);
        x += weights[i] * links[row];
        y += weights[i] * links[row + 1];
        z += weights[i] * links[row + 2];
    }
    vec4 bound = vec4(position, 1.0);
    p = vec3(dot(x, bound), dot(y, bound), dot(z, bound));
    n = vec3(dot(x.xyz, normal.xyz), dot(y.xyz, normal.xyz), dot(z.xyz, normal.xyz));
#else
    p = (T_world_model * vec4(position, 1.0)).xyz;
    n = mat3(T_world_model) * normal.xyz;
#endif
    n = normalize(n);
    vec3 albedo = colour.rgb * colour.rgb;
    vec3 sky = mix(vec3(0.25, 0.22, 0.19), vec3(0.46, 0.50, 0.56), 0.5 + 0.5 * n.z);
    vec3 dim = sky + vec3(0.16, 0.15, 0.14) * max(dot(n, fill), 0.0);
    // What is lit from within (colour.a) is as bright as its colour says, in the shade too.
    shade = vec4(albedo * mix(dim, vec3(1.0), colour.a), (1.0 - colour.a) * 0.64 * max(dot(n, sun), 0.0) / dim.g);
    vec4 lifted = vec4(p + 0.012 * n, 1.0);
    in_shadows = (T_shadows_world * lifted).xyz;
#ifdef TEXTURED
    at = texcoord;
#endif
    gl_Position = T_clip_world * vec4(p, 1.0);
}
