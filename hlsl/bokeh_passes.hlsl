// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.hlsl, HLSL. Version 0.2.0.
// Put this file after bokeh.hlsl, for the layers after bokeh_layers.hlsl too; or define
// BOKEH_INCLUDE to have the one included, and BOKEH_INCLUDE_LAYERS for the other.
//
//   pass                        reads                             writes
//   BokehLinearDepth_PS         DepthSamp (any convention)        depth in metres, to R32F
//   BokehCoCMap_PS              ColorSamp, DepthSamp              colour, CoC: paper, naive
//   BokehSignedCoCMap_PS        ColorSamp, DepthSamp              colour, signed CoC: exact
//   BokehConstantCoC_PS         ColorSamp                         colour, the same CoC everywhere
//   BokehDepthOfField_PS        ColorSamp, DepthSamp              one line of the filter
//   BokehDepthOfFieldFinal_PS   ColorSamp, DepthSamp, ColorSampB  the same, min or max with B
//   BokehAdaptive_PS            ColorSamp, DepthSamp              a line of any length and place
//   BokehAdaptiveFinal_PS       ColorSamp, DepthSamp, ColorSampB  the same, min or max with B
//   BokehNaiveGather_PS         ColorSamp, DepthSamp, KernelSamp  a table of offsets
//   BokehNaiveGrid_PS           ColorSamp, DepthSamp              a grid of samples
//   BokehSquareFirst_PS         ColorSamp                         exact, first pass: 1 target
//   BokehSquareSecond_PS        ColorSamp                         exact, second pass: finished
//   BokehHexagonFirst_PS        ColorSamp                         2 targets
//   BokehHexagonSecond_PS       ColorSamp, ColorSampB             the targets in their order
//   BokehOctagonFirst_PS        ColorSamp                         3 targets
//   BokehOctagonSecond_PS       ColorSamp, ColorSampB .. C
//   BokehDecagonFirst_PS        ColorSamp                         4 targets
//   BokehDecagonSecond_PS       ColorSamp, ColorSampB .. D
//   BokehExactEdge_PS           ColorSamp                         one target of the first pass
//   BokehLateralColor_PS        ColorSamp (finished)              red larger, blue smaller
//   BokehDebug_PS               ColorSamp (with CoC), DepthSamp   debug view
//   BokehFullScreen_VS          -                                 one triangle (SM3: a quad)
//
//   Layers, with bokeh_layers.hlsl: its table says what each reads, in the order of the slots; the
//   second pass over a layer has sizes in ColorSampE. BokehLayer: 0 near, 1 far.
//   BokehTileMax_PS             ColorSamp                         largest CoC of 8 x 8 pixels
//   BokehTileDilate_PS          ColorSamp                         twice: BokehAxis 0, 1
//   BokehPrefilter_PS           ColorSamp, ColorSampB             4 targets
//   BokehKernelReduce_PS        ColorSamp, ColorSampB             2 targets
//   BokehKernelRows_PS          ColorSamp, ColorSampB .. C        2 targets
//   BokehKernelColumns_PS       ColorSamp, ColorSampB .. C        2 targets
//   BokehHoleDownsample_PS      ColorSamp, ColorSampB             3 targets
//   BokehHoleFill_PS            ColorSamp, ColorSampB .. D        2 targets
//   BokehSquareLayerFirst_PS    ColorSamp, ColorSampB             1 target, as SquareFirst
//   BokehSquareLayerSecond_PS   ColorSamp, ColorSampE             a layer, finished
//   BokehHexagonLayerFirst_PS   ColorSamp, ColorSampB             2 targets
//   BokehHexagonLayerSecond_PS  ColorSamp, ColorSampB, E
//   BokehOctagonLayerFirst_PS   ColorSamp, ColorSampB             3 targets
//   BokehOctagonLayerSecond_PS  ColorSamp, ColorSampB .. C, E
//   BokehDecagonLayerFirst_PS   ColorSamp, ColorSampB             4 targets
//   BokehDecagonLayerSecond_PS  ColorSamp, ColorSampB .. E
//   BokehComposite_PS           ColorSamp, ColorSampB .. F        the picture
//   BokehPrefilterOne_PS        ColorSamp, ColorSampB             one target of Prefilter
//   BokehKernelReduceOne_PS     ColorSamp, ColorSampB             of KernelReduce
//   BokehKernelRowsOne_PS       ColorSamp, ColorSampB .. C        of KernelRows
//   BokehKernelColumnsOne_PS    ColorSamp, ColorSampB .. C        of KernelColumns
//   BokehHoleDownsampleOne_PS   ColorSamp, ColorSampB             of HoleDownsample
//   BokehHoleFillOne_PS         ColorSamp, ColorSampB .. D        of HoleFill
//   BokehLayerEdge_PS           ColorSamp, ColorSampB             of the first pass over a layer
//
//   Parameters: number i of the list below is register c(i) in SM3 and byte offset 4 i of the
//   buffer in SM4 and up; the buffer has 160 bytes (docs/parameters.md has the table with units,
//   and the buffer as a struct for C++, C#, Rust and JavaScript).
//   Unused slots: a pass reads only what its row names; bind nothing for the rest, or anything.

#ifdef BOKEH_INCLUDE
#include "bokeh.hlsl"
#endif
#ifdef BOKEH_INCLUDE_LAYERS
#include "bokeh_layers.hlsl"
#endif

// ...One and ...Edge: the target that is written, 0 ..
#ifndef BOKEH_TARGET_INDEX
#define BOKEH_TARGET_INDEX 0
#endif

// -------------------------------------------------------------------------------------------------
// bindings
// -------------------------------------------------------------------------------------------------

#if BOKEH_HLSL_SM == 3

sampler2D BokehColorSamp : register(s0);
sampler2D BokehDepthSamp : register(s1);
sampler2D BokehColorSampB : register(s2);
sampler2D BokehColorSampC : register(s3);
sampler2D BokehColorSampD : register(s4);
sampler2D BokehKernelSamp : register(s5);
sampler2D BokehColorSampE : register(s6);
sampler2D BokehColorSampF : register(s7);

// BokehCoCMap_PS, BokehSignedCoCMap_PS and BokehConstantCoC_PS read colour texel by texel: set a
// nearest filter on s0 for them, and always on s1 and s5
#define BOKEH_PARAMETER(type, name, index) type name : register(c##index);

#else

Texture2D BokehColorSamp : register(t0);
Texture2D BokehDepthSamp : register(t1);
Texture2D BokehColorSampB : register(t2);
Texture2D BokehColorSampC : register(t3);
Texture2D BokehColorSampD : register(t4);
Texture2D BokehKernelSamp : register(t5);
Texture2D BokehColorSampE : register(t6);
Texture2D BokehColorSampF : register(t7);
SamplerState BokehLinearClamp : register(s0);

// each texture with its sampler, under the names that BOKEH_ARGUMENT forms
#define BokehColorSampSampler BokehLinearClamp
#define BokehColorSampBSampler BokehLinearClamp

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
BOKEH_PARAMETER(float, BokehDepthKind, 24)
BOKEH_PARAMETER(float, BokehNear, 25)
BOKEH_PARAMETER(float, BokehFar, 26)
BOKEH_PARAMETER(float, BokehViewportX, 27)
BOKEH_PARAMETER(float, BokehViewportY, 28)
BOKEH_PARAMETER(float, BokehTextureWidth, 29)
BOKEH_PARAMETER(float, BokehTextureHeight, 30)
BOKEH_PARAMETER(float, BokehPassIndex, 31)
BOKEH_PARAMETER(float, BokehAxis, 32)
BOKEH_PARAMETER(float, BokehLayer, 33)
BOKEH_PARAMETER(float, BokehCatsEye, 34)
BOKEH_PARAMETER(float, BokehRoundness, 35)
BOKEH_PARAMETER(float, BokehLateral, 36)
BOKEH_PARAMETER(float, BokehAxialRed, 37)
BOKEH_PARAMETER(float, BokehAxialBlue, 38)

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

// -------------------------------------------------------------------------------------------------
// vertex shader
// -------------------------------------------------------------------------------------------------

#if BOKEH_HLSL_SM == 3

// xy = 1 / width and 1 / height of the viewport; register c20 of the vertex shader's constants
float4 BokehTexelSize : register(c20);

// Direct3D 9 has pixel centres at whole numbers: the quad moves half a pixel left and up, so that
// uv hits texels.
void BokehFullScreen_VS(float4 corner : POSITION, float2 cornerUV : TEXCOORD0, out float4 position :
    POSITION, out float2 uv : TEXCOORD0)
{
    position = float4(corner.xy + BokehTexelSize.xy * float2(-1.0, 1.0), 0.0, 1.0);
    uv = cornerUV;
}

#else

// Three vertices without a buffer. Clip space has +y up and v = 0 is the first row: v runs against
// y.
void BokehFullScreen_VS(uint id : SV_VertexID, out float4 position : SV_Position, out float2 uv :
    TEXCOORD0)
{
    uv = float2(id == 1 ? 2.0 : 0.0, id == 2 ? 2.0 : 0.0);
    position = float4(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0);
}

#endif

// -------------------------------------------------------------------------------------------------
// pixel shaders
// -------------------------------------------------------------------------------------------------

// what a pass without a filter begins with
void BokehUseViewport()
{
    float4 viewport = float4(BokehViewportX, BokehViewportY, BokehImageWidth, BokehImageHeight);
    BokehSetViewport(viewport, float2(BokehTextureWidth, BokehTextureHeight));
}

// what a filter pass begins with: the viewport set, and its settings; passIndex as in BokehNoise
BokehFilter BokehBegin(float2 uv, float passIndex)
{
    BokehUseViewport();
    float2 imageSize = float2(BokehImageWidth, BokehImageHeight);
    float noise = BokehNoise(uv, imageSize, BokehFrame, passIndex);
    BokehFilter settings;
    settings.aspectRatio = BokehAspectRatio;
    settings.imageHeight = BokehImageHeight;
    settings.spacing = BokehSpacing;
    settings.jitter = BokehJitter * noise * float(BOKEH_ADAPTIVE_SAMPLES);
    settings.bleedingBias = BokehBleedingBias;
    settings.bleedingMult = BokehBleedingMult;
    return settings;
}

// one line of the filter, adaptive
float4 BokehAdaptiveLine(float2 uv)
{
    BokehFilter settings = BokehBegin(uv, BokehPassIndex);
    float2 lineCenter = float2(BokehLineCenterX, BokehLineCenterY);
    float4 segment = BokehSegment(BokehAngle, BokehLineLength, lineCenter, BokehSqueeze);
    return BokehDepthOfFieldAdaptive(BOKEH_ARGUMENT(BokehColorSamp), BokehDepthSamp, uv, segment,
        settings, BokehBlurCoC > 0.5);
}

// BokehSides; a parameter that nobody has set is a hexagon
int BokehSidesOrSix()
{
    int sides = int(BokehSides + 0.5);
    if (sides == 0)
    {
        sides = 6;
    }
    return sides;
}

// the aperture; with BOKEH_CHARACTER 1 as the lens shows it at this pixel
BokehPolygon BokehAperture(float2 uv, int sides)
{
    BokehPolygon polygon = BokehMakePolygon(sides, BokehAngle, BokehSqueeze);
    if (BOKEH_CHARACTER > 0)
    {
        float2 imageSize = float2(BokehImageWidth, BokehImageHeight);
        polygon.roundness = BokehRoundness;
        BokehPolygon cut = BokehWithCatsEye(polygon, uv, imageSize, BokehCatsEye);
        polygon.lengths = cut.lengths;
        polygon.fifth = cut.fifth;
        polygon.axial = float2(BokehAxialRed, BokehAxialBlue);
    }
    return polygon;
}

// exact, first pass
BokehTargets BokehFirst(float2 uv, int sides)
{
    BokehFilter settings = BokehBegin(uv, 0.0);
    BokehPolygon polygon = BokehAperture(uv, sides);
    return BokehExactFirst(BOKEH_ARGUMENT(BokehColorSamp), uv, polygon, settings);
}

// exact, second pass
float4 BokehSecond(BOKEH_TEXTURE(Edge2Samp), BOKEH_TEXELS(Edge3Samp), BOKEH_TEXELS(Edge4Samp),
    BOKEH_TEXELS(Edge5Samp), float2 uv, int sides)
{
    BokehFilter settings = BokehBegin(uv, 1.0);
    BokehPolygon polygon = BokehAperture(uv, sides);
    return BokehExactSecond(BOKEH_ARGUMENT(Edge2Samp), Edge3Samp, Edge4Samp, Edge5Samp, uv, polygon,
        settings);
}

// target BOKEH_TARGET_INDEX of several, where a pass can write only one
float4 BokehPickTarget(float4 first, float4 second, float4 third, float4 fourth)
{
    float4 picked = first;
    if (BOKEH_TARGET_INDEX == 1)
    {
        picked = second;
    }
    else if (BOKEH_TARGET_INDEX == 2)
    {
        picked = third;
    }
    else if (BOKEH_TARGET_INDEX == 3)
    {
        picked = fourth;
    }
    return picked;
}

#ifdef BOKEH_LAYERS

// what a pass of the layers begins with: the viewport set, and its settings
//   sides         4, 6, 8 or 10
//   scale         of its target
BokehLayers BokehBeginLayers(float2 uv, int sides, float scale, float passIndex)
{
    BokehUseViewport();
    float2 imageSize = float2(BokehImageWidth, BokehImageHeight);
    BokehPolygon polygon = BokehAperture(uv, clamp(sides, 4, 10));
    BokehLayers layers = BokehMakeLayers(imageSize, polygon, BokehMaxCoC);
    layers.full = BokehMakeGrid(float4(BokehViewportX, BokehViewportY, imageSize),
        float2(BokehTextureWidth, BokehTextureHeight));
    float noise = BokehNoise(uv, ceil(imageSize / scale), BokehFrame, passIndex);
    layers.jitter = BokehJitter * noise * float(BOKEH_ADAPTIVE_SAMPLES);
    return layers;
}

// the same for a pass without samples of its own
BokehLayers BokehBeginTiles(float2 uv)
{
    return BokehBeginLayers(uv, 6, 1.0, 0.0);
}

// the polygon of a layer, first pass
BokehTargets BokehLayerPolygon(float2 uv, int sides)
{
    BokehLayers layers = BokehBeginLayers(uv, sides, 2.0, 0.0);
    return BokehLayerFirst(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, uv, BokehLayer > 0.5,
        layers);
}

#endif

float4 BokehLinearDepth_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float depth = BokehFetchNearest(BokehDepthSamp, uv).r;
    float S2 = BokehLinearDepth(depth, int(BokehDepthKind + 0.5), BokehNear, BokehFar);
    return float4(S2, S2, S2, 1.0);
}

float4 BokehCoCMap_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehCoCMap(BokehColorSamp, BokehDepthSamp, uv, BokehApertureDiameter,
        BokehFocalLength, BokehFocusDistance, BokehSensorHeight, BokehMaxCoC);
}

float4 BokehSignedCoCMap_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehSignedCoCMap(BokehColorSamp, BokehDepthSamp, uv, BokehApertureDiameter,
        BokehFocalLength, BokehFocusDistance, BokehSensorHeight, BokehMaxCoC);
}

float4 BokehConstantCoC_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float4 color = BokehFetchNearest(BokehColorSamp, uv);
    return BokehPackCoC(color, clamp(BokehConstantCoC, 0.0, BokehMaxCoC));
}

float4 BokehDepthOfField_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehFilter settings = BokehBegin(uv, 0.0);
    float2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    return BokehDepthOfField(BOKEH_ARGUMENT(BokehColorSamp), BokehDepthSamp, uv, lineEnd, settings,
        BokehBlurCoC > 0.5);
}

float4 BokehDepthOfFieldFinal_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehFilter settings = BokehBegin(uv, 0.0);
    float2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    return BokehDepthOfFieldFinal(BOKEH_ARGUMENT(BokehColorSamp), BokehDepthSamp, BokehColorSampB,
        uv, lineEnd, settings, BokehBlurCoC > 0.5, BokehUseMax > 0.5);
}

float4 BokehAdaptive_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehAdaptiveLine(uv);
}

float4 BokehAdaptiveFinal_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float4 a = BokehAdaptiveLine(uv);
    return BokehCombine(a, BokehFetch(BOKEH_ARGUMENT(BokehColorSampB), uv), BokehUseMax > 0.5);
}

float4 BokehNaiveGather_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehFilter settings = BokehBegin(uv, 0.0);
    settings.aspectRatio = BokehAspectRatio / BokehSqueeze;
    return BokehNaiveGather(BOKEH_ARGUMENT(BokehColorSamp), BokehDepthSamp, BokehKernelSamp, uv,
        settings, BokehBlurCoC > 0.5);
}

float4 BokehNaiveGrid_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehFilter settings = BokehBegin(uv, 0.0);
    float2 lineEndU = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    float2 lineEndV = BokehLineEnd(BokehAngleB, BokehAspectRatio / BokehSqueeze);
    return BokehNaiveGrid(BOKEH_ARGUMENT(BokehColorSamp), BokehDepthSamp, uv, lineEndU, lineEndV,
        settings, BokehBlurCoC > 0.5);
}

void BokehSquareFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0))
{
    target0 = BokehFirst(uv, 4).edge2;
}

float4 BokehSquareSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehSecond(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSamp, BokehColorSamp,
        BokehColorSamp, uv, 4);
}

void BokehHexagonFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1))
{
    BokehTargets targets = BokehFirst(uv, 6);
    target0 = targets.edge2;
    target1 = targets.edge3;
}

float4 BokehHexagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehSecond(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, BokehColorSampB,
        BokehColorSampB, uv, 6);
}

void BokehOctagonFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1), out float4 target2 : BOKEH_TARGET(2))
{
    BokehTargets targets = BokehFirst(uv, 8);
    target0 = targets.edge2;
    target1 = targets.edge3;
    target2 = targets.edge4;
}

float4 BokehOctagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehSecond(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, BokehColorSampC,
        BokehColorSampC, uv, 8);
}

void BokehDecagonFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1), out float4 target2 : BOKEH_TARGET(2),
    out float4 target3 : BOKEH_TARGET(3))
{
    BokehTargets targets = BokehFirst(uv, 10);
    target0 = targets.edge2;
    target1 = targets.edge3;
    target2 = targets.edge4;
    target3 = targets.edge5;
}

float4 BokehDecagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehSecond(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, BokehColorSampC,
        BokehColorSampD, uv, 10);
}

float4 BokehExactEdge_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehFilter settings = BokehBegin(uv, 0.0);
    BokehPolygon polygon = BokehAperture(uv, BokehSidesOrSix());
    return BokehExactEdge(BOKEH_ARGUMENT(BokehColorSamp), uv, BOKEH_TARGET_INDEX + 2, polygon,
        settings);
}

// the last pass
float4 BokehLateralColor_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehLateralColor(BOKEH_ARGUMENT(BokehColorSamp), uv, BokehLateral);
}

// BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
float4 BokehDebug_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float4 result = BokehFetch(BOKEH_ARGUMENT(BokehColorSamp), uv);
    float S2 = BokehSafeDepth(BokehFetchNearest(BokehDepthSamp, uv).r);
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

#ifdef BOKEH_LAYERS

float4 BokehTileMax_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehTileMax(BOKEH_ARGUMENT(BokehColorSamp), uv, BokehBeginTiles(uv));
}

float4 BokehTileDilate_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float2 axis = float2(1.0 - BokehAxis, BokehAxis);
    return BokehTileDilate(BOKEH_ARGUMENT(BokehColorSamp), uv, axis, BokehBeginTiles(uv));
}

void BokehPrefilter_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1), out float4 target2 : BOKEH_TARGET(2),
    out float4 target3 : BOKEH_TARGET(3))
{
    BokehPrefiltered targets = BokehPrefilter(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, uv,
        BokehBeginTiles(uv));
    target0 = targets.nearLayer;
    target1 = targets.farLayer;
    target2 = targets.kernelSums;
    target3 = targets.leftovers;
}

void BokehKernelReduce_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1))
{
    BokehKernels targets = BokehKernelReduce(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, uv,
        BokehBeginTiles(uv));
    target0 = targets.leftovers;
    target1 = targets.sums;
}

void BokehKernelRows_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1))
{
    BokehKernels targets = BokehKernelRows(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB,
        BokehColorSampC, uv, BokehBeginTiles(uv));
    target0 = targets.leftovers;
    target1 = targets.sums;
}

void BokehKernelColumns_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1))
{
    BokehSizes targets = BokehKernelColumns(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB,
        BokehColorSampC, uv, BokehBeginTiles(uv));
    target0 = targets.reach;
    target1 = targets.sizes;
}

void BokehHoleDownsample_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1), out float4 target2 : BOKEH_TARGET(2))
{
    BokehHoles targets = BokehHoleDownsample(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, uv,
        BokehBeginTiles(uv));
    target0 = targets.middle;
    target1 = targets.far;
    target2 = targets.shares;
}

void BokehHoleFill_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1))
{
    BokehLayers layers = BokehBeginLayers(uv, BokehSidesOrSix(), 4.0, 0.0);
    BokehFilled targets = BokehHoleFill(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB,
        BokehColorSampC, BokehColorSampD, uv, layers);
    target0 = targets.middle;
    target1 = targets.back;
}

void BokehSquareLayerFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0))
{
    target0 = BokehLayerPolygon(uv, 4).edge2;
}

float4 BokehSquareLayerSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehLayers layers = BokehBeginLayers(uv, 4, 2.0, 1.0);
    return BokehLayerSecond(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSamp, BokehColorSamp,
        BokehColorSamp, BokehColorSampE, uv, BokehLayer > 0.5, layers);
}

void BokehHexagonLayerFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1))
{
    BokehTargets targets = BokehLayerPolygon(uv, 6);
    target0 = targets.edge2;
    target1 = targets.edge3;
}

float4 BokehHexagonLayerSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehLayers layers = BokehBeginLayers(uv, 6, 2.0, 1.0);
    return BokehLayerSecond(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, BokehColorSampB,
        BokehColorSampB, BokehColorSampE, uv, BokehLayer > 0.5, layers);
}

void BokehOctagonLayerFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1), out float4 target2 : BOKEH_TARGET(2))
{
    BokehTargets targets = BokehLayerPolygon(uv, 8);
    target0 = targets.edge2;
    target1 = targets.edge3;
    target2 = targets.edge4;
}

float4 BokehOctagonLayerSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehLayers layers = BokehBeginLayers(uv, 8, 2.0, 1.0);
    return BokehLayerSecond(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, BokehColorSampC,
        BokehColorSampC, BokehColorSampE, uv, BokehLayer > 0.5, layers);
}

void BokehDecagonLayerFirst_PS(BOKEH_INPUT, out float4 target0 : BOKEH_TARGET(0),
    out float4 target1 : BOKEH_TARGET(1), out float4 target2 : BOKEH_TARGET(2),
    out float4 target3 : BOKEH_TARGET(3))
{
    BokehTargets targets = BokehLayerPolygon(uv, 10);
    target0 = targets.edge2;
    target1 = targets.edge3;
    target2 = targets.edge4;
    target3 = targets.edge5;
}

float4 BokehDecagonLayerSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehLayers layers = BokehBeginLayers(uv, 10, 2.0, 1.0);
    return BokehLayerSecond(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, uv, BokehLayer > 0.5, layers);
}

float4 BokehComposite_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehLayers layers = BokehBeginLayers(uv, BokehSidesOrSix(), 1.0, 2.0);
    return BokehComposite(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, BokehColorSampF, uv, layers);
}

float4 BokehPrefilterOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehPrefiltered targets = BokehPrefilter(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, uv,
        BokehBeginTiles(uv));
    return BokehPickTarget(targets.nearLayer, targets.farLayer, targets.kernelSums,
        targets.leftovers);
}

float4 BokehKernelReduceOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehKernels targets = BokehKernelReduce(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, uv,
        BokehBeginTiles(uv));
    return BokehPickTarget(targets.leftovers, targets.sums, targets.sums, targets.sums);
}

float4 BokehKernelRowsOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehKernels targets = BokehKernelRows(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB,
        BokehColorSampC, uv, BokehBeginTiles(uv));
    return BokehPickTarget(targets.leftovers, targets.sums, targets.sums, targets.sums);
}

float4 BokehKernelColumnsOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehSizes targets = BokehKernelColumns(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB,
        BokehColorSampC, uv, BokehBeginTiles(uv));
    return BokehPickTarget(targets.reach, targets.sizes, targets.sizes, targets.sizes);
}

float4 BokehHoleDownsampleOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehHoles targets = BokehHoleDownsample(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, uv,
        BokehBeginTiles(uv));
    return BokehPickTarget(targets.middle, targets.far, targets.shares, targets.shares);
}

float4 BokehHoleFillOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehLayers layers = BokehBeginLayers(uv, BokehSidesOrSix(), 4.0, 0.0);
    BokehFilled targets = BokehHoleFill(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB,
        BokehColorSampC, BokehColorSampD, uv, layers);
    return BokehPickTarget(targets.middle, targets.back, targets.back, targets.back);
}

float4 BokehLayerEdge_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehLayers layers = BokehBeginLayers(uv, BokehSidesOrSix(), 2.0, 0.0);
    return BokehLayerEdge(BOKEH_ARGUMENT(BokehColorSamp), BokehColorSampB, uv, BokehLayer > 0.5,
        BOKEH_TARGET_INDEX + 2, layers);
}

#endif
