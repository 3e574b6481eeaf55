// SPDX-License-Identifier: MIT
//
// Reads both eyes from one texture array. Put this file in front of bokeh.hlsl (docs/inputs.md).
// Functions that filter have the sampler as their last parameter.

#define BOKEH_CUSTOM_FETCH 1
#define BOKEH_TEXTURE Texture2DArray
#define BOKEH_DEPTH_TEXTURE Texture2DArray
#define BOKEH_SAMPLER , SamplerState BokehLinearClamp
#define BOKEH_LINEAR , BokehLinearClamp
static float BokehEye = 0.0; // 0: left eye, 1: right eye; set it from SV_ViewID or a uniform
float4 BokehFetchTexture(Texture2DArray tex, float2 coords, SamplerState BokehLinearClamp)
{
    return tex.SampleLevel(BokehLinearClamp, float3(coords, BokehEye), 0.0);
}
float4 BokehFetchTexel(Texture2DArray tex, float2 coords)
{
    uint width, height, eyes;
    tex.GetDimensions(width, height, eyes);
    int2 size = int2(width, height);
    int2 texel = min(int2(saturate(coords) * float2(size)), size - int2(1, 1));
    return tex.Load(int4(texel, int(BokehEye), 0));
}
float2 BokehFetchDepth(Texture2DArray tex, float2 coords)
{
    return BokehFetchTexel(tex, coords).rg;
}
