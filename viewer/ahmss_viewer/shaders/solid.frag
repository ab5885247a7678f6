#version 330 core
// Adds the sun where neither what stands still nor what moves hides it.
uniform sampler2DShadow still_map;
uniform sampler2DShadow live_map;
#ifdef TEXTURED
uniform sampler2D image;
in vec2 at;
#endif
in vec3 shade;
in vec3 sunlit;
in vec3 in_still;
uniform vec3 live_scale;  // both maps are seen from the sun: one lies in the other
uniform vec3 live_shift;
out vec4 pixel;

float seen(sampler2DShadow map, vec3 place) {
#ifdef FINE
    float sum = 0.0;
    vec2 step = 1.4 / vec2(textureSize(map, 0));
    for (int i = -1; i <= 1; i++)
        for (int j = -1; j <= 1; j++)
            sum += texture(map, place + vec3(vec2(i, j) * step, 0.0));
    return sum / 9.0;
#else
    return texture(map, place);
#endif
}

void main() {
    vec3 light = shade + sunlit * min(seen(still_map, in_still), seen(live_map, in_still * live_scale + live_shift));
#ifdef TEXTURED
    vec3 texel = texture(image, at).rgb;
    light *= texel * texel;
#endif
    pixel = vec4(sqrt(light), 1.0);
}
