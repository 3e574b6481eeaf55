// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.hlsl, HLSL. Version 0.1.0.
// Put this file after bokeh.hlsl, or define BOKEH_INCLUDE to have it included.
//
//   pass                       reads                                    writes
//   BokehLinearDepth_PS        DepthSamp (any convention)               depth in metres, to an R32F target
//   BokehCoCMap_PS             ColorSamp, DepthSamp                     colour, CoC in alpha
//   BokehConstantCoC_PS        ColorSamp                                colour, the same CoC everywhere
//   BokehDepthOfField_PS       ColorSamp, DepthSamp                     one line of the filter
//   BokehDepthOfFieldFinal_PS  ColorSamp, DepthSamp, ColorSampB         the same, min or max with ColorSampB
//   BokehAdaptive_PS           ColorSamp, DepthSamp                     a line of any length and place, adaptive
//   BokehAdaptiveFinal_PS      ColorSamp, DepthSamp, ColorSampB         the same, min or max with ColorSampB
//   BokehNaiveGather_PS        ColorSamp, DepthSamp, KernelSamp         a table of BOKEH_NUM_SAMPLES offsets
//   BokehNaiveGrid_PS          ColorSamp, DepthSamp                     BOKEH_NUM_SAMPLES x BOKEH_NUM_SAMPLES grid
//   BokehSquareFirst_PS        ColorSamp, DepthSamp                     exact, first pass: 1 target
//   BokehSquareSecond_PS       ColorSamp, DepthSamp                     exact, second pass: the finished square
//   BokehHexagonFirst_PS       ColorSamp, DepthSamp                     2 targets
//   BokehHexagonSecond_PS      ColorSamp, DepthSamp, ColorSampB         ColorSamp and so on: the targets in their order
//   BokehOctagonFirst_PS       ColorSamp, DepthSamp                     3 targets
//   BokehOctagonSecond_PS      ColorSamp, DepthSamp, ColorSampB .. C
//   BokehDecagonFirst_PS       ColorSamp, DepthSamp                     4 targets
//   BokehDecagonSecond_PS      ColorSamp, DepthSamp, ColorSampB .. D
//   BokehExactEdge_PS          ColorSamp, DepthSamp, ColorSampB .. C    one target of the first pass, without MRT;
//                                                                       B, C: the target before, the one before that
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
sampler2D BokehColorSampC : register(s3);
sampler2D BokehColorSampD : register(s4);
sampler2D BokehKernelSamp : register(s5);

// the first pass copies colour texel by texel: set a nearest filter on s0 for it
#define BOKEH_NEAREST(name) name

#define BOKEH_PARAMETER(type, name, index) type name : register(c##index);

#else

Texture2D BokehColorSamp : register(t0);
Texture2D BokehDepthSamp : register(t1);
Texture2D BokehColorSampB : register(t2);
Texture2D BokehColorSampC : register(t3);
Texture2D BokehColorSampD : register(t4);
Texture2D BokehKernelSamp : register(t5);
SamplerState BokehLinearClamp : register(s0);
SamplerState BokehNearestClamp : register(s1);

// each texture with its sampler, under the names that BOKEH_ARGUMENT forms
#define BokehColorSampSampler BokehLinearClamp
#define BokehDepthSampSampler BokehNearestClamp
#define BokehColorSampBSampler BokehLinearClamp
#define BokehColorSampCSampler BokehLinearClamp
#define BokehColorSampDSampler BokehLinearClamp
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
BOKEH_PARAMETER(float, BokehLineLength, 14)
BOKEH_PARAMETER(float, BokehLineCenterX, 15)
BOKEH_PARAMETER(float, BokehLineCenterY, 16)
BOKEH_PARAMETER(float, BokehSqueeze, 17)
BOKEH_PARAMETER(float, BokehSpacing, 18)
BOKEH_PARAMETER(float, BokehImageWidth, 19)
BOKEH_PARAMETER(float, BokehImageHeight, 20)
BOKEH_PARAMETER(float, BokehJitter, 21)
BOKEH_PARAMETER(float, BokehFrame, 22)
BOKEH_PARAMETER(float, BokehSides, 23)
BOKEH_PARAMETER(float, BokehEdge, 24)
BOKEH_PARAMETER(float, BokehDepthKind, 25)
BOKEH_PARAMETER(float, BokehNear, 26)
BOKEH_PARAMETER(float, BokehFar, 27)
BOKEH_PARAMETER(float, BokehViewportX, 28)
BOKEH_PARAMETER(float, BokehViewportY, 29)
BOKEH_PARAMETER(float, BokehTextureWidth, 30)
BOKEH_PARAMETER(float, BokehTextureHeight, 31)

#if BOKEH_HLSL_SM == 3

// what a pixel shader gets and gives
#define BOKEH_INPUT float2 uv : TEXCOORD0
#define BOKEH_OUTPUT COLOR
#define BOKEH_TARGET(i) COLOR##i

#else
}

#define BOKEH_INPUT float4 position : SV_Position, float2 uv : TEXCOORD0
#define BOKEH_OUTPUT SV_Target
#define BOKEH_TARGET(i) SV_Target##i

#endif

// ---------------------------------------------------------------------------------------------------------------------
// vertex shader
// ---------------------------------------------------------------------------------------------------------------------

#if BOKEH_HLSL_SM == 3

// xy = 1 / width and 1 / height of the viewport; register c20 of the vertex shader's constants
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

// what every pass begins with
void BokehUseViewport()
{
    float4 viewport = float4(BokehViewportX, BokehViewportY, BokehImageWidth, BokehImageHeight);
    BokehSetViewport(viewport, float2(BokehTextureWidth, BokehTextureHeight));
}

float4 BokehLinearDepth_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float depth = BokehFetchNearest(BOKEH_ARGUMENT(BokehDepthSamp), uv).r;
    float S2 = BokehLinearDepth(depth, BokehDepthKind, BokehNear, BokehFar);
    return float4(S2, S2, S2, 1.0);
}

float4 BokehCoCMap_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehCoCMap(BOKEH_NEAREST(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, BokehApertureDiameter,
        BokehFocalLength, BokehFocusDistance, BokehSensorHeight, BokehMaxCoC);
}

float4 BokehConstantCoC_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehPackCoC(BokehFetch(BOKEH_NEAREST(BokehColorSamp), uv), clamp(BokehConstantCoC, 0.0, BokehMaxCoC));
}

float4 BokehDepthOfField_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    return BokehDepthOfField(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, lineEnd,
        BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

float4 BokehDepthOfFieldFinal_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    return BokehDepthOfFieldFinal(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, lineEnd,
        BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5, BOKEH_ARGUMENT(BokehColorSampB),
        BokehUseMax > 0.5);
}

float4 BokehAdaptive_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float2 lineCenter = float2(BokehLineCenterX, BokehLineCenterY);
    float4 segment = BokehSegment(BokehAngle, BokehLineLength, lineCenter, BokehSqueeze);
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    return BokehDepthOfFieldAdaptive(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, segment,
        BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias,
        BokehBleedingMult, BokehBlurCoC > 0.5);
}

float4 BokehAdaptiveFinal_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float2 lineCenter = float2(BokehLineCenterX, BokehLineCenterY);
    float4 segment = BokehSegment(BokehAngle, BokehLineLength, lineCenter, BokehSqueeze);
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    float4 a = BokehDepthOfFieldAdaptive(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, segment,
        BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias,
        BokehBleedingMult, BokehBlurCoC > 0.5);
    return BokehCombine(a, BokehFetch(BOKEH_ARGUMENT(BokehColorSampB), uv), BokehUseMax > 0.5);
}

float4 BokehNaiveGather_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehNaiveGather(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp),
        BOKEH_ARGUMENT(BokehKernelSamp), uv, BokehAspectRatio / BokehSqueeze, BOKEH_NUM_SAMPLES, BokehBleedingBias,
        BokehBleedingMult, BokehBlurCoC > 0.5);
}

float4 BokehNaiveGrid_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float2 lineEndU = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    float2 lineEndV = BokehLineEnd(BokehAngleB, BokehAspectRatio / BokehSqueeze);
    return BokehNaiveGrid(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, lineEndU, lineEndV,
        BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

void BokehSquareFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0))
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    float4x4 T = BokehExactFirst(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, 4.0, BokehAngle,
        BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias,
        BokehBleedingMult);
    target0 = T[0];
}

float4 BokehSquareSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    return BokehExactSecond(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehColorSamp),
        BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, 4.0,
        BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        BokehBleedingBias, BokehBleedingMult);
}

void BokehHexagonFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0), out float4 target1 : BOKEH_TARGET(1))
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    float4x4 T = BokehExactFirst(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, 6.0, BokehAngle,
        BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias,
        BokehBleedingMult);
    target0 = T[0];
    target1 = T[1];
}

float4 BokehHexagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    return BokehExactSecond(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehColorSampB),
        BOKEH_ARGUMENT(BokehColorSampB), BOKEH_ARGUMENT(BokehColorSampB), BOKEH_ARGUMENT(BokehDepthSamp), uv, 6.0,
        BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        BokehBleedingBias, BokehBleedingMult);
}

void BokehOctagonFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0), out float4 target1 : BOKEH_TARGET(1),
    out float4 target2 : BOKEH_TARGET(2))
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    float4x4 T = BokehExactFirst(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, 8.0, BokehAngle,
        BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias,
        BokehBleedingMult);
    target0 = T[0];
    target1 = T[1];
    target2 = T[2];
}

float4 BokehOctagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    return BokehExactSecond(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehColorSampB),
        BOKEH_ARGUMENT(BokehColorSampC), BOKEH_ARGUMENT(BokehColorSampC), BOKEH_ARGUMENT(BokehDepthSamp), uv, 8.0,
        BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        BokehBleedingBias, BokehBleedingMult);
}

void BokehDecagonFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0), out float4 target1 : BOKEH_TARGET(1),
    out float4 target2 : BOKEH_TARGET(2), out float4 target3 : BOKEH_TARGET(3))
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    float4x4 T = BokehExactFirst(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp), uv, 10.0, BokehAngle,
        BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias,
        BokehBleedingMult);
    target0 = T[0];
    target1 = T[1];
    target2 = T[2];
    target3 = T[3];
}

float4 BokehDecagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    return BokehExactSecond(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehColorSampB),
        BOKEH_ARGUMENT(BokehColorSampC), BOKEH_ARGUMENT(BokehColorSampD), BOKEH_ARGUMENT(BokehDepthSamp), uv, 10.0,
        BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        BokehBleedingBias, BokehBleedingMult);
}

float4 BokehExactEdge_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(uv, BokehImageWidth, BokehImageHeight, BokehFrame);
    return BokehExactEdge(BOKEH_ARGUMENT(BokehColorSamp), BOKEH_ARGUMENT(BokehDepthSamp),
        BOKEH_ARGUMENT(BokehColorSampB), BOKEH_ARGUMENT(BokehColorSampC), uv, BokehEdge, BokehSides, BokehAngle,
        BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias,
        BokehBleedingMult);
}

// BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
float4 BokehDebug_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
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
