// SPDX-License-Identifier: MIT
//
// Reads both eyes from one texture array. Put this file in front of bokeh.glsl (docs/inputs.md).

#define BOKEH_CUSTOM_FETCH 1
#define BOKEH_TEXTURE sampler2DArray
#define BOKEH_DEPTH_TEXTURE sampler2DArray
uniform float BokehEye; // 0: left eye, 1: right eye; with multiview, use gl_ViewID_OVR
vec4 BokehFetchTexture(sampler2DArray tex, vec2 coords)
{
    return textureLod(tex, vec3(coords, BokehEye), 0.0);
}
vec4 BokehFetchTexel(sampler2DArray tex, vec2 coords)
{
    ivec2 size = textureSize(tex, 0).xy;
    ivec2 texel = min(ivec2(clamp(coords, 0.0, 1.0) * vec2(size)), size - ivec2(1, 1));
    return texelFetch(tex, ivec3(texel, int(BokehEye)), 0);
}
vec2 BokehFetchDepth(sampler2DArray tex, vec2 coords)
{
    return BokehFetchTexel(tex, coords).rg;
}
