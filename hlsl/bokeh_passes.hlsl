// SPDX-License-Identifier: MIT
//
// Ready-made passes, HLSL. Version 0.3.0.
// Entries for every pass. Put this file after bokeh.hlsl and the files that the passes need:
// bokeh_paper.hlsl, bokeh_layers.hlsl, bokeh_lens.hlsl, or none.
//
//   pass                        reads                             writes
//   BokehLinearDepth_PS         DepthSamp                         depth in metres, to R32F
//   BokehSignedCoCMap_PS        ColorSamp, DepthSamp              colour, signed CoC
//   BokehConstantCoC_PS         ColorSamp                         colour, one CoC for all pixels
//   BokehSquareFirst_PS         ColorSamp                         1 target
//   BokehSquareSecond_PS        ColorSamp                         the result, from that target
//   BokehHexagonFirst_PS        ColorSamp                         2 targets
//   BokehHexagonSecond_PS       ColorSamp, ColorSampB             the result, from those
//   BokehOctagonFirst_PS        ColorSamp                         3 targets
//   BokehOctagonSecond_PS       ColorSamp, ColorSampB .. C        the result
//   BokehDecagonFirst_PS        ColorSamp                         4 targets
//   BokehDecagonSecond_PS       ColorSamp, ColorSampB .. D        the result
//   BokehExactEdge_PS           ColorSamp                         one target of these first passes
//   BokehDebug_PS               ColorSamp (with CoC), DepthSamp   debug view
//   BokehFullScreen_VS          -                                 one triangle (SM3: a quad)
//
//   With bokeh_paper; DepthSamp has metres:
//   BokehCoCMap_PS              ColorSamp, DepthSamp              colour, CoC
//   BokehDepthOfField_PS        ColorSamp, DepthSamp              blur along a line
//   BokehDepthOfFieldFinal_PS   ColorSamp, DepthSamp, ColorSampB  ... then min or max with B
//   BokehAdaptive_PS            ColorSamp, DepthSamp              blur along any line
//   BokehAdaptiveFinal_PS       ColorSamp, DepthSamp, ColorSampB  ... then min or max with B
//   BokehNaiveGather_PS         ColorSamp, DepthSamp, KernelSamp  gather, from a table
//   BokehNaiveGrid_PS           ColorSamp, DepthSamp              gather, over a grid
//
//   With bokeh_lens. BOKEH_LENS_SHAPE 1 also gives apertures curved blades and a cat's eye:
//   BokehStableMap_PS           ColorSamp (map), ColorSampB .. C  steadier; B: history, C: velocity
//   BokehLateralColor_PS        ColorSamp (finished)              lateral colour
//
//   With bokeh_layers: the table of that file lists what each pass reads, in the order of the
//   slots, and what it writes. In addition:
//   * Square and hexagon blur both layers at once. Their first pass reads nearLayer, nearQuarter,
//     farLayer, farQuarter, layerCoC, and writes strip 2 of near and far, then strip 3 of both.
//   * Octagon and decagon have passes of their own for each layer, such as OctagonNearFirst.
//   * Second passes read layerCoC from ColorSampE.
//   * TileDilate has two passes, TileDilateRows, then TileDilateColumns.
//   * A pass whose name ends in One or Edge writes only target BOKEH_TARGET_INDEX.
//
//   Parameters: number i of the list below is register c(i) in SM3 and byte offset 4 i of the
//   buffer in SM4 and up; the buffer has 192 bytes (docs/reference/parameters.md has units, and the
//   buffer as a struct for C++, C#, Rust and JavaScript).
//   Unused slots: a pass reads only what its row names; bind nothing for the rest, or anything.

// the target that ..One and ..Edge write, 0 ..; whether BokehJitter acts, the aperture
// has the shape of a lens, the CoC map takes all parameters
#ifndef BOKEH_TARGET_INDEX
#define BOKEH_TARGET_INDEX 0
#endif
#ifndef BOKEH_JITTER
#define BOKEH_JITTER 0
#endif
#ifndef BOKEH_LENS_SHAPE
#define BOKEH_LENS_SHAPE 0
#endif
#ifndef BOKEH_FOCUS_CONTROLS
#define BOKEH_FOCUS_CONTROLS 0
#endif
#if BOKEH_LENS_SHAPE + BOKEH_FOCUS_CONTROLS > 0 && !defined(BOKEH_LENS)
#error BOKEH_LENS_SHAPE 1 and BOKEH_FOCUS_CONTROLS 1 need bokeh_lens.hlsl before this file
#endif

// -------------------------------------------------------------------------------------------------
// bindings

#if BOKEH_HLSL_SM == 3
// BokehCoCMap_PS, BokehSignedCoCMap_PS, BokehConstantCoC_PS, BokehStableMap_PS read texel by texel:
// set a nearest filter on s0 for them, for the last one also on s3, and always on s1 and s5
#define BOKEH_SLOT(type, name, index) type name : register(s##index);
#define BOKEH_PARAMETER(type, name, index) type name : register(c##index);
#define BOKEH_INPUT float2 uv : TEXCOORD0
#define BOKEH_OUTPUT COLOR
#define BOKEH_TARGET(i) COLOR##i
#else
SamplerState BokehLinearClamp : register(s0);
#define BOKEH_SLOT(type, name, index) type name : register(t##index);
#define BOKEH_PARAMETER(type, name, index) type name;
#define BOKEH_INPUT float4 position : SV_Position, float2 uv : TEXCOORD0
#define BOKEH_OUTPUT SV_Target
#define BOKEH_TARGET(i) SV_Target##i
#endif

// holds the result of a pass with 2 targets
struct BokehTargets2
{
    float4 target0 : BOKEH_TARGET(0);
    float4 target1 : BOKEH_TARGET(1);
};

// holds the result of a pass with 3 targets
struct BokehTargets3
{
    float4 target0 : BOKEH_TARGET(0);
    float4 target1 : BOKEH_TARGET(1);
    float4 target2 : BOKEH_TARGET(2);
};

// holds the result of a pass with 4 targets
struct BokehTargets4
{
    float4 target0 : BOKEH_TARGET(0);
    float4 target1 : BOKEH_TARGET(1);
    float4 target2 : BOKEH_TARGET(2);
    float4 target3 : BOKEH_TARGET(3);
};

BOKEH_SLOT(BOKEH_TEXTURE, BokehColorSamp, 0)
BOKEH_SLOT(BOKEH_DEPTH_TEXTURE, BokehDepthSamp, 1)
BOKEH_SLOT(BOKEH_TEXTURE, BokehColorSampB, 2)
BOKEH_SLOT(BOKEH_TEXTURE, BokehColorSampC, 3)
BOKEH_SLOT(BOKEH_TEXTURE, BokehColorSampD, 4)
BOKEH_SLOT(BOKEH_TEXTURE, BokehKernelSamp, 5)
BOKEH_SLOT(BOKEH_TEXTURE, BokehColorSampE, 6)
BOKEH_SLOT(BOKEH_TEXTURE, BokehColorSampF, 7)

#if BOKEH_HLSL_SM > 3
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
BOKEH_PARAMETER(float, BokehCatsEye, 32)
BOKEH_PARAMETER(float, BokehRoundness, 33)
BOKEH_PARAMETER(float, BokehLateral, 34)
BOKEH_PARAMETER(float, BokehFrontRange, 35)
BOKEH_PARAMETER(float, BokehBackRange, 36)
BOKEH_PARAMETER(float, BokehNearScale, 37)
BOKEH_PARAMETER(float, BokehFarScale, 38)
BOKEH_PARAMETER(float, BokehNearMaxCoC, 39)
BOKEH_PARAMETER(float, BokehFarMaxCoC, 40)
BOKEH_PARAMETER(float, BokehDepthX, 41)
BOKEH_PARAMETER(float, BokehDepthY, 42)
BOKEH_PARAMETER(float, BokehDepthWidth, 43)
BOKEH_PARAMETER(float, BokehDepthHeight, 44)
BOKEH_PARAMETER(float, BokehStableBlend, 45)

#if BOKEH_HLSL_SM > 3
}
#endif

// -------------------------------------------------------------------------------------------------
// vertex shader

#if BOKEH_HLSL_SM == 3

// xy = 1 / width and 1 / height of the viewport; register c20 of the vertex shader's constants
float4 BokehTexelSize : register(c20);

// draws a quad over the whole target
//   Direct3D 9 has pixel centres at whole numbers: the quad moves half a pixel left and up, so that
//   uv hits texels.
void BokehFullScreen_VS(float4 corner : POSITION, float2 cornerUV : TEXCOORD0, out float4 position :
    POSITION, out float2 uv : TEXCOORD0)
{
    position = float4(corner.xy + BokehTexelSize.xy * float2(-1.0, 1.0), 0.0, 1.0);
    uv = cornerUV;
}

#else

struct BokehVertex
{
    float4 position : SV_Position;
    float2 uv : TEXCOORD0;
};

// draws a triangle over the whole target: three vertices, without a buffer
//   Clip space has +y up and v = 0 is the first row: v runs against y.
BokehVertex BokehFullScreen_VS(uint id : SV_VertexID)
{
    BokehVertex result;
    result.uv = float2(id == 1 ? 2.0 : 0.0, id == 2 ? 2.0 : 0.0);
    result.position = float4(result.uv.x * 2.0 - 1.0, 1.0 - result.uv.y * 2.0, 0.0, 1.0);
    return result;
}

#endif

// -------------------------------------------------------------------------------------------------
// pixel shaders

// sets the viewport, for passes without a filter
void BokehUseViewport()
{
    float4 viewport = float4(BokehViewportX, BokehViewportY, BokehImageWidth, BokehImageHeight);
    BokehSetViewport(viewport, float2(BokehTextureWidth, BokehTextureHeight));
}

// returns interleaved gradient noise (Jimenez 2014) for a pixel, frame and pass, -0.5 .. 0.5
//   In pass p each frame adds (8 p + 1) 33 / 64. Over 64 frames every pass takes 64 evenly spaced
//   values in each pixel, no two passes in the same order, so the mean of the frames converges.
//   passIndex     0, 1 ..; a pass needs another index than the pass that it reads
float BokehNoise(float2 uv, float2 imageSize, float frame, float passIndex)
{
    float number = (8.0 * passIndex + 1.0) * (frame - 64.0 * floor(frame / 64.0)) + passIndex;
    float seed = dot(floor(uv * imageSize), float2(0.06711056, 0.00583715));
    float value = 52.9829189 * (seed - floor(seed)) + 0.515625 * number;
    return value - floor(value) - 0.5;
}

// returns the noise times BokehJitter; 0 without BOKEH_JITTER 1
float BokehPassJitter(float2 uv, float2 imageSize, float passIndex)
{
    float jitter = 0.0;
    if (BOKEH_JITTER > 0)
    {
        jitter = BokehJitter * BokehNoise(uv, imageSize, BokehFrame, passIndex);
    }
    return jitter;
}

// sets the viewport and returns the settings of a filter pass; passIndex as in BokehNoise
BokehSamplingSettings BokehBegin(float2 uv, float passIndex)
{
    BokehUseViewport();
    BokehSamplingSettings settings;
    settings.aspectRatio = BokehAspectRatio;
    settings.imageHeight = BokehImageHeight;
    settings.spacing = BokehSpacing;
    if (BokehSpacing <= 0.0)
    {
        settings.spacing = BOKEH_SPACING;
    }
    settings.jitter = BokehPassJitter(uv, float2(BokehImageWidth, BokehImageHeight), passIndex);
    settings.bleedingBias = BokehBleedingBias;
    settings.bleedingMult = BokehBleedingMult;
    return settings;
}

// makes the aperture; with BOKEH_LENS_SHAPE 1 as the lens shows it at this pixel
BokehPolygon BokehAperture(float2 uv, int sides)
{
    BokehPolygon polygon = BokehMakePolygon(sides, BokehAngle, BokehSqueeze);
#ifdef BOKEH_LENS
    if (BOKEH_LENS_SHAPE > 0)
    {
        polygon = BokehWithCatsEye(BokehWithRoundness(polygon, BokehRoundness), uv,
            float2(BokehImageWidth, BokehImageHeight), BokehCatsEye);
    }
#endif
    return polygon;
}

// makes the aperture with BOKEH_SIDES or else BokehSides sides; a hexagon if neither is set
BokehPolygon BokehAnyAperture(float2 uv)
{
    int sides = int(BokehSides + 0.5);
    if (BOKEH_SIDES > 0)
    {
        sides = BOKEH_SIDES;
    }
    if (sides == 0)
    {
        sides = 6;
    }
    return BokehAperture(uv, clamp(sides, 4, 10));
}

// returns the lens that the parameters describe
BokehLens BokehPassLens()
{
    BokehLens lens = BokehMakeLens(BokehApertureDiameter, BokehFocalLength, BokehFocusDistance);
    lens.sensorHeight = BokehSensorHeight;
    lens.maxCoC = BokehMaxCoC;
    return lens;
}

// returns the signed CoC of a depth; with BOKEH_FOCUS_CONTROLS 1 as artists have bent the focus
float BokehPassCoC(float depth)
{
    float CoC = BokehSignedCoC(depth, BokehPassLens());
#ifdef BOKEH_LENS
    if (BOKEH_FOCUS_CONTROLS > 0)
    {
        BokehFocus focus;
        focus.sharpRange = float2(BokehFrontRange, BokehBackRange);
        focus.sideScale = float2(BokehNearScale, BokehFarScale);
        focus.sideMaxCoC = float2(BokehNearMaxCoC, BokehFarMaxCoC);
        CoC = BokehFocusedCoC(depth, BokehPassLens(), focus);
    }
#endif
    return CoC;
}

// returns the depth of this pixel in metres
float BokehPassDepth(float2 depthUV)
{
    float2 stored = BokehFetchDepth(BokehDepthSamp, depthUV);
    return BokehLinearDepth(stored, int(BokehDepthKind + 0.5), BokehNear, BokehFar);
}

// converts image uv to uv of the depth buffer, of which the image may fill a rectangle
float2 BokehDepthUV(float2 uv)
{
    float2 depthUV = BokehToTexture(uv);
    if (BOKEH_FOCUS_CONTROLS > 0)
    {
        depthUV = float2(BokehDepthX, BokehDepthY) + uv * float2(BokehDepthWidth, BokehDepthHeight);
    }
    return depthUV;
}

// selects target BOKEH_TARGET_INDEX, for passes that can write only one
float4 BokehSelectTarget(float4 first, float4 second, float4 third, float4 fourth)
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

#ifdef BOKEH_PAPER

// blurs along one line of any length and position, with as many samples as the CoC needs
float4 BokehAdaptiveLine(float2 uv)
{
    BokehSamplingSettings settings = BokehBegin(uv, BokehPassIndex);
    float2 lineCenter = float2(BokehLineCenterX, BokehLineCenterY);
    float4 segment = BokehSegment(BokehAngle, BokehLineLength, lineCenter, BokehSqueeze);
    return BokehDepthOfFieldAdaptive(BokehColorSamp, BokehDepthSamp, uv, segment, settings,
        BokehBlurCoC > 0.5 BOKEH_LINEAR);
}

#endif

#ifdef BOKEH_LAYERS

// sets the viewport and returns the context of a pass of `layered`
//   scale         size of the image / size of the target: 1, 2, 4 or 8
BokehLayerContext BokehBeginLayers(float2 uv, float scale, float passIndex)
{
    BokehUseViewport();
    float2 imageSize = float2(BokehImageWidth, BokehImageHeight);
    BokehLayerContext layers = BokehMakeLayerContext(uv, imageSize, BokehMaxCoC);
    if (BOKEH_VIEWPORT > 0)
    {
        layers.origin = float2(BokehViewportX, BokehViewportY);
        layers.texel = 1.0 / float2(BokehTextureWidth, BokehTextureHeight);
    }
    layers.jitter = BokehPassJitter(uv, ceil(imageSize / scale), passIndex);
    return layers;
}

// does the same for a pass in which jitter has no effect
BokehLayerContext BokehBeginTiles(float2 uv)
{
    return BokehBeginLayers(uv, 1.0, 0.0);
}

// blurs one layer, first pass
//   last          as in BokehExactFirst
BokehTargets BokehLayerPolygon(float2 uv, bool isFar, int last, BokehPolygon polygon)
{
    BokehLayerContext layers = BokehBeginLayers(uv, float(BOKEH_LAYER_SCALE), 0.0);
    return BokehLayerFirst(BokehColorSamp, BokehColorSampB, BokehLayerCoC(BokehColorSampC,
        layers BOKEH_LINEAR), isFar, last, polygon, layers BOKEH_LINEAR);
}

// blurs one layer, second pass
float4 BokehLayerResult(float2 uv, bool isFar, BOKEH_TEXTURE Strip5Samp, BokehPolygon polygon)
{
    BokehLayerContext layers = BokehBeginLayers(uv, float(BOKEH_LAYER_SCALE), 1.0);
    return BokehLayerSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, Strip5Samp,
        BokehLayerCoC(BokehColorSampE, layers BOKEH_LINEAR), isFar, polygon, layers BOKEH_LINEAR);
}

// blurs both layers, first pass of a square or a hexagon
BokehLayersTargets BokehBothPolygons(float2 uv, int sides)
{
    BokehLayerContext layers = BokehBeginLayers(uv, float(BOKEH_LAYER_SCALE), 0.0);
    return BokehLayersFirst(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        BokehLayerCoC(BokehColorSampE, layers BOKEH_LINEAR), BokehAperture(uv, sides),
        layers BOKEH_LINEAR);
}

// blurs both layers, second pass
BokehBlurred BokehBothResults(float2 uv, BOKEH_TEXTURE NearStrip3Samp, BOKEH_TEXTURE FarStrip3Samp,
    int sides)
{
    BokehLayerContext layers = BokehBeginLayers(uv, float(BOKEH_LAYER_SCALE), 1.0);
    return BokehLayersSecond(BokehColorSamp, BokehColorSampB, NearStrip3Samp, FarStrip3Samp,
        BokehLayerCoC(BokehColorSampE, layers BOKEH_LINEAR), BokehAperture(uv, sides),
        layers BOKEH_LINEAR);
}

#endif

// -------------------------------------------------------------------------------------------------
// entry points
//
//   An entry point sets up the parameters and calls the function that has its name. The comment of
//   that function says what the pass reads, what it writes and why it exists. An entry point has a
//   comment here if it does more than this, or if no function has its name:
//   * Square, Hexagon, Octagon and Decagon are the polygon.
//   * First and Second are the two blur passes of `exact`. First blurs along all edges of one half
//     of the outline but the last, Second along all but the first.
//   * LayerFirst and LayerSecond are the two blur passes of `layered`. For a square and a hexagon
//     they call BokehLayersFirst and BokehLayersSecond, for an octagon and a decagon
//     BokehLayerFirst and BokehLayerSecond.
//   * One and Edge are for GPUs and engines that can write only one target in a pass.

// writes depth in metres, which the passes of `paper` read instead of the depth buffer
float4 BokehLinearDepth_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float depth = BokehPassDepth(BokehToTexture(uv));
    return float4(depth, depth, depth, 1.0);
}

// writes colour and signed CoC for `exact` and `layered`
//   It does the work of BokehSignedCoCMap, and also takes the parameters of BOKEH_FOCUS_CONTROLS. A
//   pixel beside a light may take the CoC of the light, see BokehLightCoC.
float4 BokehSignedCoCMap_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float2 imageSize = float2(BokehImageWidth, BokehImageHeight);
    float CoC = BokehPassCoC(BokehPassDepth(BokehDepthUV(uv)));
    float4 neighbor = BokehBrightNeighbor(BokehColorSamp, uv, imageSize);
    if (max(neighbor.z, neighbor.w) > 0.0)
    {
        float2 lightUV = BokehDepthUV(uv + neighbor.xy);
        CoC = BokehLightCoC(CoC, BokehPassCoC(BokehPassDepth(lightUV)), neighbor.zw, imageSize.y);
    }
    return BokehPackCoC(BokehFetchTexel(BokehColorSamp, BokehToTexture(uv)), CoC);
}

// writes colour and the same CoC for all pixels: use it to look at the polygon without depth
float4 BokehConstantCoC_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float4 color = BokehFetchTexel(BokehColorSamp, BokehToTexture(uv));
    return BokehPackCoC(color, clamp(BokehConstantCoC, 0.0, BokehMaxCoC));
}

float4 BokehSquareFirst_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehSquareFirst(BokehColorSamp, uv, BokehAperture(uv, 4),
        BokehBegin(uv, 0.0) BOKEH_LINEAR).strip2;
}

float4 BokehSquareSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehSquareSecond(BokehColorSamp, uv, BokehAperture(uv, 4),
        BokehBegin(uv, 1.0) BOKEH_LINEAR);
}

BokehTargets2 BokehHexagonFirst_PS(BOKEH_INPUT)
{
    BokehTargets targets = BokehHexagonFirst(BokehColorSamp, uv, BokehAperture(uv, 6),
        BokehBegin(uv, 0.0) BOKEH_LINEAR);
    BokehTargets2 result;
    result.target0 = targets.strip2;
    result.target1 = targets.strip3;
    return result;
}

float4 BokehHexagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehHexagonSecond(BokehColorSamp, BokehColorSampB, uv, BokehAperture(uv, 6),
        BokehBegin(uv, 1.0) BOKEH_LINEAR);
}

BokehTargets3 BokehOctagonFirst_PS(BOKEH_INPUT)
{
    BokehTargets targets = BokehOctagonFirst(BokehColorSamp, uv, BokehAperture(uv, 8),
        BokehBegin(uv, 0.0) BOKEH_LINEAR);
    BokehTargets3 result;
    result.target0 = targets.strip2;
    result.target1 = targets.strip3;
    result.target2 = targets.strip4;
    return result;
}

float4 BokehOctagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehOctagonSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, uv,
        BokehAperture(uv, 8), BokehBegin(uv, 1.0) BOKEH_LINEAR);
}

BokehTargets4 BokehDecagonFirst_PS(BOKEH_INPUT)
{
    BokehTargets targets = BokehDecagonFirst(BokehColorSamp, uv, BokehAperture(uv, 10),
        BokehBegin(uv, 0.0) BOKEH_LINEAR);
    BokehTargets4 result;
    result.target0 = targets.strip2;
    result.target1 = targets.strip3;
    result.target2 = targets.strip4;
    result.target3 = targets.strip5;
    return result;
}

float4 BokehDecagonSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehDecagonSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD, uv,
        BokehAperture(uv, 10), BokehBegin(uv, 1.0) BOKEH_LINEAR);
}

// writes one target of the first pass of any polygon of `exact`
float4 BokehExactEdge_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehTargets targets = BokehExactFirst(BokehColorSamp, uv, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(uv), BokehBegin(uv, 0.0) BOKEH_LINEAR);
    return BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

// shows what the effect reads, by BokehDebugMode
//   0             colour
//   1             depth: black at the camera, 0.5 at the focus distance, white far away
//   2             CoC: black in focus, white at BokehMaxCoC
//   3             near field orange, far field blue, in focus black; brighter as the CoC grows
float4 BokehDebug_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    float4 result = BokehFetch(BokehColorSamp, uv BOKEH_LINEAR);
    float depth = BokehPassDepth(BokehToTexture(uv));
    float grey = clamp(abs(result.a) / max(BokehMaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    float3 weights = float3(1.0, 1.0, 1.0);
    if (BokehDebugMode > 2.5)
    {
        weights = float3(0.1, 0.4, 1.0);
        if (depth < BokehFocusDistance)
        {
            weights = float3(1.0, 0.5, 0.0);
        }
    }
    else if (BokehDebugMode < 1.5)
    {
        grey = depth / (depth + BokehFocusDistance);
    }
    if (BokehDebugMode > 0.5)
    {
        result = float4(weights * grey, 1.0);
    }
    return result;
}

#ifdef BOKEH_PAPER

float4 BokehCoCMap_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehCoCMap(BokehColorSamp, BokehDepthSamp, uv, BokehPassLens());
}

float4 BokehDepthOfField_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    return BokehDepthOfField(BokehColorSamp, BokehDepthSamp, uv, lineEnd, BokehBegin(uv, 0.0),
        BokehBlurCoC > 0.5 BOKEH_LINEAR);
}

float4 BokehDepthOfFieldFinal_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    return BokehDepthOfFieldFinal(BokehColorSamp, BokehDepthSamp, BokehColorSampB, uv, lineEnd,
        BokehBegin(uv, 0.0), BokehBlurCoC > 0.5, BokehUseMax > 0.5 BOKEH_LINEAR);
}

// blurs along one line, whose angle, length and centre are parameters: a star has several lines
float4 BokehAdaptive_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehAdaptiveLine(uv);
}

// blurs along one line, then combines the result with that of an earlier pass
//   It takes the maximum of both if BokehUseMax is 1, otherwise the minimum.
float4 BokehAdaptiveFinal_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float4 a = BokehAdaptiveLine(uv);
    return BokehCombine(a, BokehFetch(BokehColorSampB, uv BOKEH_LINEAR), BokehUseMax > 0.5);
}

float4 BokehNaiveGather_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehSamplingSettings settings = BokehBegin(uv, 0.0);
    settings.aspectRatio = BokehAspectRatio / BokehSqueeze;
    return BokehNaiveGather(BokehColorSamp, BokehDepthSamp, BokehKernelSamp, uv, settings,
        BokehBlurCoC > 0.5 BOKEH_LINEAR);
}

float4 BokehNaiveGrid_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float2 lineEndU = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    float2 lineEndV = BokehLineEnd(BokehAngleB, BokehAspectRatio / BokehSqueeze);
    return BokehNaiveGrid(BokehColorSamp, BokehDepthSamp, uv, lineEndU, lineEndV,
        BokehBegin(uv, 0.0), BokehBlurCoC > 0.5 BOKEH_LINEAR);
}

#endif

#ifdef BOKEH_LENS

float4 BokehStableMap_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehStableMap(BokehColorSamp, BokehColorSampB, BokehColorSampC, uv,
        float2(BokehImageWidth, BokehImageHeight), BokehStableBlend BOKEH_LINEAR);
}

float4 BokehLateralColor_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehUseViewport();
    return BokehLateralColor(BokehColorSamp, uv, BokehLateral BOKEH_LINEAR);
}

#endif

#ifdef BOKEH_LAYERS

float4 BokehTileMax_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehTileMax(BokehColorSamp, BokehBeginTiles(uv));
}

float4 BokehTileDilateRows_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehTileDilate(BokehColorSamp, float2(1.0, 0.0), BokehBeginTiles(uv) BOKEH_LINEAR);
}

float4 BokehTileDilateColumns_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehTileDilate(BokehColorSamp, float2(0.0, 1.0), BokehBeginTiles(uv) BOKEH_LINEAR);
}

BokehTargets4 BokehPrefilter_PS(BOKEH_INPUT)
{
    BokehPrefiltered targets = BokehPrefilter(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(uv) BOKEH_LINEAR);
    BokehTargets4 result;
    result.target0 = targets.nearLayer;
    result.target1 = targets.farLayer;
    result.target2 = targets.layerCoCSums;
    result.target3 = targets.gatherCoC;
    return result;
}

BokehTargets2 BokehLayerCoCReduce_PS(BOKEH_INPUT)
{
    BokehTileSums targets = BokehLayerCoCReduce(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(uv));
    BokehTargets2 result;
    result.target0 = targets.gatherCoC;
    result.target1 = targets.sums;
    return result;
}

BokehTargets2 BokehLayerCoCRows_PS(BOKEH_INPUT)
{
    BokehTileSums targets = BokehLayerCoCRows(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehBeginTiles(uv) BOKEH_LINEAR);
    BokehTargets2 result;
    result.target0 = targets.gatherCoC;
    result.target1 = targets.sums;
    return result;
}

BokehTargets2 BokehLayerCoCColumns_PS(BOKEH_INPUT)
{
    BokehLayerCoCTargets targets = BokehLayerCoCColumns(BokehColorSamp, BokehColorSampB,
        BokehColorSampC, BokehBeginTiles(uv) BOKEH_LINEAR);
    BokehTargets2 result;
    result.target0 = targets.gatherTiles;
    result.target1 = targets.layerCoC;
    return result;
}

BokehTargets4 BokehDownsample_PS(BOKEH_INPUT)
{
    BokehDownsampled targets = BokehDownsample(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, BokehAnyAperture(uv), BokehBeginTiles(uv) BOKEH_LINEAR);
    BokehTargets4 result;
    result.target0 = targets.midWithHoles;
    result.target1 = targets.farWithHoles;
    result.target2 = targets.nearQuarter;
    result.target3 = targets.farQuarter;
    return result;
}

BokehTargets2 BokehHoleFill_PS(BOKEH_INPUT)
{
    BokehFilled targets = BokehHoleFill(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehAnyAperture(uv), BokehBeginLayers(uv, 4.0, 0.0) BOKEH_LINEAR);
    BokehTargets2 result;
    result.target0 = targets.midFill;
    result.target1 = targets.farFill;
    return result;
}

BokehTargets2 BokehSquareLayerFirst_PS(BOKEH_INPUT)
{
    BokehLayersTargets targets = BokehBothPolygons(uv, 4);
    BokehTargets2 result;
    result.target0 = targets.nearStrip2;
    result.target1 = targets.farStrip2;
    return result;
}

BokehTargets2 BokehSquareLayerSecond_PS(BOKEH_INPUT)
{
    BokehBlurred targets = BokehBothResults(uv, BokehColorSamp, BokehColorSampB, 4);
    BokehTargets2 result;
    result.target0 = targets.nearLayer;
    result.target1 = targets.farLayer;
    return result;
}

BokehTargets4 BokehHexagonLayerFirst_PS(BOKEH_INPUT)
{
    BokehLayersTargets targets = BokehBothPolygons(uv, 6);
    BokehTargets4 result;
    result.target0 = targets.nearStrip2;
    result.target1 = targets.farStrip2;
    result.target2 = targets.nearStrip3;
    result.target3 = targets.farStrip3;
    return result;
}

BokehTargets2 BokehHexagonLayerSecond_PS(BOKEH_INPUT)
{
    BokehBlurred targets = BokehBothResults(uv, BokehColorSampC, BokehColorSampD, 6);
    BokehTargets2 result;
    result.target0 = targets.nearLayer;
    result.target1 = targets.farLayer;
    return result;
}

BokehTargets3 BokehOctagonNearFirst_PS(BOKEH_INPUT)
{
    BokehTargets targets = BokehLayerPolygon(uv, false, 4, BokehAperture(uv, 8));
    BokehTargets3 result;
    result.target0 = targets.strip2;
    result.target1 = targets.strip3;
    result.target2 = targets.strip4;
    return result;
}

float4 BokehOctagonNearSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehLayerResult(uv, false, BokehColorSampC, BokehAperture(uv, 8));
}

BokehTargets3 BokehOctagonFarFirst_PS(BOKEH_INPUT)
{
    BokehTargets targets = BokehLayerPolygon(uv, true, 4, BokehAperture(uv, 8));
    BokehTargets3 result;
    result.target0 = targets.strip2;
    result.target1 = targets.strip3;
    result.target2 = targets.strip4;
    return result;
}

float4 BokehOctagonFarSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehLayerResult(uv, true, BokehColorSampC, BokehAperture(uv, 8));
}

BokehTargets4 BokehDecagonNearFirst_PS(BOKEH_INPUT)
{
    BokehTargets targets = BokehLayerPolygon(uv, false, 5, BokehAperture(uv, 10));
    BokehTargets4 result;
    result.target0 = targets.strip2;
    result.target1 = targets.strip3;
    result.target2 = targets.strip4;
    result.target3 = targets.strip5;
    return result;
}

float4 BokehDecagonNearSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehLayerResult(uv, false, BokehColorSampD, BokehAperture(uv, 10));
}

BokehTargets4 BokehDecagonFarFirst_PS(BOKEH_INPUT)
{
    BokehTargets targets = BokehLayerPolygon(uv, true, 5, BokehAperture(uv, 10));
    BokehTargets4 result;
    result.target0 = targets.strip2;
    result.target1 = targets.strip3;
    result.target2 = targets.strip4;
    result.target3 = targets.strip5;
    return result;
}

float4 BokehDecagonFarSecond_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehLayerResult(uv, true, BokehColorSampD, BokehAperture(uv, 10));
}

float4 BokehComposite_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehComposite(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        BokehColorSampE, BokehColorSampF, BokehAnyAperture(uv), BokehBeginLayers(uv, 1.0,
        2.0) BOKEH_LINEAR);
}

// writes one target of BokehPrefilter; the entry points below do so for other passes
float4 BokehPrefilterOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehPrefiltered targets = BokehPrefilter(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(uv) BOKEH_LINEAR);
    return BokehSelectTarget(targets.nearLayer, targets.farLayer, targets.layerCoCSums,
        targets.gatherCoC);
}

float4 BokehLayerCoCReduceOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehTileSums targets = BokehLayerCoCReduce(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(uv));
    return BokehSelectTarget(targets.gatherCoC, targets.sums, targets.sums, targets.sums);
}

float4 BokehLayerCoCRowsOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehTileSums targets = BokehLayerCoCRows(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehBeginTiles(uv) BOKEH_LINEAR);
    return BokehSelectTarget(targets.gatherCoC, targets.sums, targets.sums, targets.sums);
}

float4 BokehLayerCoCColumnsOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehLayerCoCTargets targets = BokehLayerCoCColumns(BokehColorSamp, BokehColorSampB,
        BokehColorSampC, BokehBeginTiles(uv) BOKEH_LINEAR);
    return BokehSelectTarget(targets.gatherTiles, targets.layerCoC, targets.layerCoC,
        targets.layerCoC);
}

float4 BokehDownsampleOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehDownsampled targets = BokehDownsample(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, BokehAnyAperture(uv), BokehBeginTiles(uv) BOKEH_LINEAR);
    return BokehSelectTarget(targets.midWithHoles, targets.farWithHoles, targets.nearQuarter,
        targets.farQuarter);
}

float4 BokehHoleFillOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehFilled targets = BokehHoleFill(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehAnyAperture(uv), BokehBeginLayers(uv, 4.0, 0.0) BOKEH_LINEAR);
    return BokehSelectTarget(targets.midFill, targets.farFill, targets.farFill, targets.farFill);
}

// writes one target of the first blur pass of one layer, for any polygon
float4 BokehNearEdge_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehTargets targets = BokehLayerPolygon(uv, false, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(uv));
    return BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

float4 BokehFarEdge_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    BokehTargets targets = BokehLayerPolygon(uv, true, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(uv));
    return BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

// writes one blurred layer, for any polygon: the second blur pass
float4 BokehNearSecondOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehLayerResult(uv, false, BokehColorSampD, BokehAnyAperture(uv));
}

float4 BokehFarSecondOne_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    return BokehLayerResult(uv, true, BokehColorSampD, BokehAnyAperture(uv));
}

#endif
