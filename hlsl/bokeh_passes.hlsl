// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.hlsl, HLSL. Version 0.1.0.
// Put this file after bokeh.hlsl, or define BOKEH_INCLUDE to have it included.
//
//   pass                       reads                                    writes
//   BokehCoCMap_PS             ColorSamp, DepthSamp                     colour, CoC in alpha
//   BokehConstantCoC_PS        ColorSamp                                colour, the same CoC everywhere
//   BokehDepthOfField_PS       ColorSamp, DepthSamp                     one line of the filter
//   BokehDepthOfFieldFinal_PS  ColorSamp, DepthSamp, ColorSampB         the same, min or max with ColorSampB
//   BokehNaiveGather_PS        ColorSamp, DepthSamp, KernelSamp         a table of BOKEH_NUM_SAMPLES offsets
//   BokehNaiveGrid_PS          ColorSamp, DepthSamp                     BOKEH_NUM_SAMPLES x BOKEH_NUM_SAMPLES grid
//   BokehDebug_PS              ColorSamp (with CoC), DepthSamp          debug view
//   BokehFullScreen_VS         -                                        one triangle over the target (SM3: a quad)
//
//   Parameters: number i of the list below is register c(i) in SM3 and byte offset 4 i of the buffer in SM4 and up.
//   docs/inputs.md has the table with units.

#ifdef BOKEH_INCLUDE
#include "bokeh.hlsl"
#endif

// ---------------------------------------------------------------------------------------------------------------------
// bindings
// ---------------------------------------------------------------------------------------------------------------------

#if BOKEH_HLSL_SM == 3

sampler2D BokehColorSamp : register(s0);
sampler2D BokehDepthSamp : register(s1);
sampler2D BokehColorSampB : register(s2);
sampler2D BokehKernelSamp : register(s3);

// the first pass copies colour texel by texel: set a nearest filter on s0 for it
#define BOKEH_NEAREST(name) name

#define BOKEH_PARAMETER(type, name, index) type name : register(c##index);

#else

Texture2D BokehColorSamp : register(t0);
Texture2D BokehDepthSamp : register(t1);
Texture2D BokehColorSampB : register(t2);
Texture2D BokehKernelSamp : register(t3);
SamplerState BokehLinearClamp : register(s0);
SamplerState BokehNearestClamp : register(s1);

// each texture with its sampler, under the names that BOKEH_ARGUMENT forms
#define BokehColorSampSampler BokehLinearClamp
#define BokehDepthSampSampler BokehNearestClamp
#define BokehColorSampBSampler BokehLinearClamp
#define BokehKernelSampSampler BokehNearestClamp

// the first pass copies colour texel by texel
#define BOKEH_NEAREST(name) name, BokehNearestClamp

#define BOKEH_PARAMETER(type, name, index) type name;

cbuffer BokehParameters : register(b0)
{
#endif

BOKEH_PARAMETER(float, BokehApertureDiameter, 0)
BOKEH_PARAMETER(float, BokehFocalLength, 1)
BOKEH_PARAMETER(float, BokehFocusDistance, 2)
BOKEH_PARAMETER(float, BokehSensorHeight, 3)
BOKEH_PARAMETER(float, BokehMaxCoC, 4)
BOKEH_PARAMETER(float, BokehConstantCoC, 5)
BOKEH_PARAMETER(float, BokehAspectRatio, 6)
BOKEH_PARAMETER(float, BokehAngle, 7)
BOKEH_PARAMETER(float, BokehAngleB, 8)
BOKEH_PARAMETER(float, BokehBleedingBias, 9)
BOKEH_PARAMETER(float, BokehBleedingMult, 10)
BOKEH_PARAMETER(float, BokehBlurCoC, 11)
BOKEH_PARAMETER(float, BokehUseMax, 12)
BOKEH_PARAMETER(float, BokehDebugMode, 13)

#if BOKEH_HLSL_SM == 3

// what a pixel shader gets and gives
#define BOKEH_INPUT float2 uv : TEXCOORD0
#define BOKEH_OUTPUT COLOR

#else
}

#define BOKEH_INPUT float4 position : SV_Position, float2 uv : TEXCOORD0
#define BOKEH_OUTPUT SV_Target

#endif

// ---------------------------------------------------------------------------------------------------------------------
// vertex shader
// ---------------------------------------------------------------------------------------------------------------------

#if BOKEH_HLSL_SM == 3

// xy = 1 / width and 1 / height of the render target; register c20 of the vertex shader's constants
float4 BokehTexelSize : register(c20);

// Direct3D 9 has pixel centres at whole numbers: the quad moves half a pixel left and up, so that uv hits texels.
void BokehFullScreen_VS(float4 corner : POSITION, float2 cornerUV : TEXCOORD0, out float4 position : POSITION,
    out float2 uv : TEXCOORD0)
{
    position = float4(corner.xy + BokehTexelSize.xy * float2(-1.0, 1.0), 0.0, 1.0);
    uv = cornerUV;
}

#else

// Three vertices without a buffer. Clip space has +y up and v = 0 is the first row: v runs against y.
void BokehFullScreen_VS(uint id : SV_VertexID, out float4 position : SV_Position, out float2 uv : TEXCOORD0)
{
    uv = float2(id == 1 ? 2.0 : 0.0, id == 2 ? 2.0 : 0.0);
    position = float4(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0);
}

#endif

// ---------------------------------------------------------------------------------------------------------------------
// pixel shaders
// ---------------------------------------------------------------------------------------------------------------------

float4 BokehCoCMap_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehCoCMap(BOKEH_NEAREST(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, BokehApertureDiameter,
        BokehFocalLength, BokehFocusDistance, BokehSensorHeight, BokehMaxCoC);
}

float4 BokehConstantCoC_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehPackCoC(BokehFetch(BOKEH_NEAREST(BokehColorSamp), uv), clamp(BokehConstantCoC, 0.0, BokehMaxCoC));
}

float4 BokehDepthOfField_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio);
    return BokehDepthOfField(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, lineEnd,
        BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

float4 BokehDepthOfFieldFinal_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio);
    return BokehDepthOfFieldFinal(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, lineEnd,
        BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5, BOKEH_ARGUMENT(BokehColorSampB),
        BokehUseMax > 0.5);
}

float4 BokehNaiveGather_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehNaiveGather(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp),
        BOKEH_ARGUMENT(BokehKernelSamp), uv, BokehAspectRatio, BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult,
        BokehBlurCoC > 0.5);
}

float4 BokehNaiveGrid_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float2 lineEndU = BokehLineEnd(BokehAngle, BokehAspectRatio);
    float2 lineEndV = BokehLineEnd(BokehAngleB, BokehAspectRatio);
    return BokehNaiveGrid(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, lineEndU, lineEndV,
        BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

// BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
float4 BokehDebug_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float4 result = BokehFetch(BOKEH_ARGUMENT(BokehColorSamp), uv);
    float S2 = BokehSafeDepth(BokehFetchNearest(BOKEH_ARGUMENT(BokehDepthSamp), uv).r);
    if (BokehDebugMode > 2.5)
    {
        result = BokehDebugFocus(S2, BokehFocusDistance, result.a, BokehMaxCoC);
    }
    else if (BokehDebugMode > 1.5)
    {
        result = BokehDebugCoC(result.a, BokehMaxCoC);
    }
    else if (BokehDebugMode > 0.5)
    {
        result = BokehDebugDepth(S2, BokehFocusDistance);
    }
    return result;
}
