#version 330 core
// Adds the sun where nothing hides it.
uniform sampler2DShadow shadows;
#ifdef TEXTURED
uniform sampler2D image;
in vec2 at;
#endif
in vec4 shade;
in vec3 in_shadows;
out vec4 pixel;

float seen(vec3 place) {
#ifdef SOFT
    float sum = 0.0;
    vec2 step = 1.4 / vec2(textureSize(shadows, 0));
    for (int i = -1; i <= 1; i++)
        for (int j = -1; j <= 1; j++)
            sum += texture(shadows, place + vec3(vec2(i, j) * step, 0.0));
    return sum / 9.0;
#else
    return texture(shadows, place);
#endif
}

void main() {
    vec3 light = shade.rgb + shade.rgb * vec3(1.13, 1.0, 0.83) * (shade.a * seen(in_shadows));
#ifdef TEXTURED
    vec3 texel = texture(image, at).rgb;
    light *= texel * texel;
#endif
    pixel = vec4(sqrt(light), 1.0);
}
