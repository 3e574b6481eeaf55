// SPDX-License-Identifier: MIT
//
// Ready-made passes, GLSL. Version 0.3.0.
// Programs for every pass. Each is one text: your #version line, #define BOKEH_PASS with a name of
// the table, bokeh.glsl, the files that the pass needs (bokeh_paper.glsl, bokeh_layers.glsl,
// bokeh_lens.glsl, or none), and this file.
//
//   #define BOKEH_PASS ...      reads                             writes
//   BOKEH_LINEAR_DEPTH          DepthSamp                         depth in metres, to R32F
//   BOKEH_SIGNED_COC_MAP        ColorSamp, DepthSamp              colour, signed CoC
//   BOKEH_CONSTANT_COC          ColorSamp                         colour, one CoC for all pixels
//   BOKEH_SQUARE_FIRST          ColorSamp                         1 target
//   BOKEH_SQUARE_SECOND         ColorSamp                         the result, from that target
//   BOKEH_HEXAGON_FIRST         ColorSamp                         2 targets
//   BOKEH_HEXAGON_SECOND        ColorSamp, ColorSampB             the result, from those
//   BOKEH_OCTAGON_FIRST         ColorSamp                         3 targets
//   BOKEH_OCTAGON_SECOND        ColorSamp, ColorSampB .. C        the result
//   BOKEH_DECAGON_FIRST         ColorSamp                         4 targets
//   BOKEH_DECAGON_SECOND        ColorSamp, ColorSampB .. D        the result
//   BOKEH_EXACT_EDGE            ColorSamp                         one target of these first passes
//   BOKEH_DEBUG                 ColorSamp (with CoC), DepthSamp   debug view
//   BOKEH_FULL_SCREEN           -                                 (vertex shader) one triangle
//
//   With bokeh_paper; DepthSamp has metres:
//   BOKEH_COC_MAP               ColorSamp, DepthSamp              colour, CoC
//   BOKEH_DEPTH_OF_FIELD        ColorSamp, DepthSamp              blur along a line
//   BOKEH_DEPTH_OF_FIELD_FINAL  ColorSamp, DepthSamp, ColorSampB  ... then min or max with B
//   BOKEH_ADAPTIVE              ColorSamp, DepthSamp              blur along any line
//   BOKEH_ADAPTIVE_FINAL        ColorSamp, DepthSamp, ColorSampB  ... then min or max with B
//   BOKEH_NAIVE_GATHER          ColorSamp, DepthSamp, KernelSamp  gather, from a table
//   BOKEH_NAIVE_GRID            ColorSamp, DepthSamp              gather, over a grid
//
//   With bokeh_lens. BOKEH_LENS_SHAPE 1 also gives apertures curved blades and a cat's eye:
//   BOKEH_STABLE_MAP            ColorSamp (map), ColorSampB .. C  steadier; B: history, C: velocity
//   BOKEH_LATERAL_COLOR         ColorSamp (finished)              lateral colour
//
//   With bokeh_layers: the table of that file lists what each pass reads, in the order of the
//   slots, and what it writes. In addition:
//   * Square and hexagon blur both layers at once. Their first pass reads nearLayer, nearQuarter,
//     farLayer, farQuarter, layerCoC, and writes strip 2 of near and far, then strip 3 of both.
//   * Octagon and decagon have passes of their own for each layer, such as OCTAGON_NEAR_FIRST.
//   * Second passes read layerCoC from ColorSampE.
//   * TileDilate has two passes, TILE_DILATE_ROWS, then TILE_DILATE_COLUMNS.
//   * A pass whose name ends in One or Edge writes only target BOKEH_TARGET_INDEX.
//
//   Parameters: single uniforms in OpenGL; under Vulkan one uniform block in the order below
//   (docs/reference/parameters.md has units and offsets, and the block as a struct for C++,
//   C#, Rust and JavaScript). Set 0: the block at binding 0, the textures ColorSamp, DepthSamp,
//   ColorSampB to D, KernelSamp at 1 to 6, ColorSampE and F at 8 and 9.
//   Unused slots: a pass samples only what its row names. OpenGL needs nothing for the rest; under
//   Vulkan their descriptors may be left out of the layout, or left unwritten.

#define BOKEH_LINEAR_DEPTH 1
#define BOKEH_SIGNED_COC_MAP 2
#define BOKEH_CONSTANT_COC 3
#define BOKEH_SQUARE_FIRST 4
#define BOKEH_SQUARE_SECOND 5
#define BOKEH_HEXAGON_FIRST 6
#define BOKEH_HEXAGON_SECOND 7
#define BOKEH_OCTAGON_FIRST 8
#define BOKEH_OCTAGON_SECOND 9
#define BOKEH_DECAGON_FIRST 10
#define BOKEH_DECAGON_SECOND 11
#define BOKEH_EXACT_EDGE 12
#define BOKEH_DEBUG 13
#define BOKEH_COC_MAP 14
#define BOKEH_DEPTH_OF_FIELD 15
#define BOKEH_DEPTH_OF_FIELD_FINAL 16
#define BOKEH_ADAPTIVE 17
#define BOKEH_ADAPTIVE_FINAL 18
#define BOKEH_NAIVE_GATHER 19
#define BOKEH_NAIVE_GRID 20
#define BOKEH_STABLE_MAP 21
#define BOKEH_LATERAL_COLOR 22
#define BOKEH_TILE_MAX 23
#define BOKEH_TILE_DILATE_ROWS 24
#define BOKEH_TILE_DILATE_COLUMNS 25
#define BOKEH_PREFILTER 26
#define BOKEH_LAYER_COC_REDUCE 27
#define BOKEH_LAYER_COC_ROWS 28
#define BOKEH_LAYER_COC_COLUMNS 29
#define BOKEH_DOWNSAMPLE 30
#define BOKEH_HOLE_FILL 31
#define BOKEH_SQUARE_LAYER_FIRST 32
#define BOKEH_SQUARE_LAYER_SECOND 33
#define BOKEH_HEXAGON_LAYER_FIRST 34
#define BOKEH_HEXAGON_LAYER_SECOND 35
#define BOKEH_OCTAGON_NEAR_FIRST 36
#define BOKEH_OCTAGON_NEAR_SECOND 37
#define BOKEH_OCTAGON_FAR_FIRST 38
#define BOKEH_OCTAGON_FAR_SECOND 39
#define BOKEH_DECAGON_NEAR_FIRST 40
#define BOKEH_DECAGON_NEAR_SECOND 41
#define BOKEH_DECAGON_FAR_FIRST 42
#define BOKEH_DECAGON_FAR_SECOND 43
#define BOKEH_COMPOSITE 44
#define BOKEH_PREFILTER_ONE 45
#define BOKEH_LAYER_COC_REDUCE_ONE 46
#define BOKEH_LAYER_COC_ROWS_ONE 47
#define BOKEH_LAYER_COC_COLUMNS_ONE 48
#define BOKEH_DOWNSAMPLE_ONE 49
#define BOKEH_HOLE_FILL_ONE 50
#define BOKEH_NEAR_EDGE 51
#define BOKEH_FAR_EDGE 52
#define BOKEH_NEAR_SECOND_ONE 53
#define BOKEH_FAR_SECOND_ONE 54
#define BOKEH_FULL_SCREEN 55

// the target that _ONE and _EDGE write, 0 ..; whether BokehJitter acts, the aperture
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
#error BOKEH_LENS_SHAPE 1 and BOKEH_FOCUS_CONTROLS 1 need bokeh_lens.glsl before this file
#endif

#ifndef BOKEH_PASS
#error define BOKEH_PASS before this file, for example as BOKEH_DEPTH_OF_FIELD
#elif BOKEH_PASS < BOKEH_LINEAR_DEPTH || BOKEH_PASS > BOKEH_FULL_SCREEN
#error BOKEH_PASS is none of the names in the table at the top of this file
#elif BOKEH_PASS >= BOKEH_COC_MAP && BOKEH_PASS <= BOKEH_NAIVE_GRID && !defined(BOKEH_PAPER)
#error put bokeh_paper.glsl before this file
#elif BOKEH_PASS >= BOKEH_STABLE_MAP && BOKEH_PASS <= BOKEH_LATERAL_COLOR && !defined(BOKEH_LENS)
#error put bokeh_lens.glsl before this file
#elif BOKEH_PASS >= BOKEH_TILE_MAX && BOKEH_PASS <= BOKEH_FAR_SECOND_ONE && !defined(BOKEH_LAYERS)
#error put bokeh_layers.glsl before this file
#endif

#if BOKEH_PASS == BOKEH_FULL_SCREEN

// -------------------------------------------------------------------------------------------------
// vertex shader

#ifdef VULKAN
#define BOKEH_VERTEX_ID gl_VertexIndex
layout(location = 0) out vec2 BokehUV;
#else
#define BOKEH_VERTEX_ID gl_VertexID
out vec2 BokehUV;
#endif

// draws a triangle over the whole target: three vertices, without a buffer
//   Clip y = -1 is the first row in memory, in OpenGL and in Vulkan: v runs with y.
void main()
{
    BokehUV = vec2(BOKEH_VERTEX_ID == 1 ? 2.0 : 0.0, BOKEH_VERTEX_ID == 2 ? 2.0 : 0.0);
    gl_Position = vec4(BokehUV * 2.0 - 1.0, 0.0, 1.0);
}

#else

// -------------------------------------------------------------------------------------------------
// bindings

#ifdef VULKAN

layout(set = 0, binding = 1) uniform BOKEH_TEXTURE BokehColorSamp;
layout(set = 0, binding = 2) uniform BOKEH_DEPTH_TEXTURE BokehDepthSamp;
layout(set = 0, binding = 3) uniform BOKEH_TEXTURE BokehColorSampB;
layout(set = 0, binding = 4) uniform BOKEH_TEXTURE BokehColorSampC;
layout(set = 0, binding = 5) uniform BOKEH_TEXTURE BokehColorSampD;
layout(set = 0, binding = 6) uniform BOKEH_TEXTURE BokehKernelSamp;
layout(set = 0, binding = 8) uniform BOKEH_TEXTURE BokehColorSampE;
layout(set = 0, binding = 9) uniform BOKEH_TEXTURE BokehColorSampF;
layout(location = 0) in vec2 BokehUV;

#define BOKEH_PARAMETER(type, name) type name;

layout(set = 0, binding = 0, std140) uniform BokehParameters
{

#else

uniform BOKEH_TEXTURE BokehColorSamp;
uniform BOKEH_DEPTH_TEXTURE BokehDepthSamp;
uniform BOKEH_TEXTURE BokehColorSampB;
uniform BOKEH_TEXTURE BokehColorSampC;
uniform BOKEH_TEXTURE BokehColorSampD;
uniform BOKEH_TEXTURE BokehKernelSamp;
uniform BOKEH_TEXTURE BokehColorSampE;
uniform BOKEH_TEXTURE BokehColorSampF;
in vec2 BokehUV;

#define BOKEH_PARAMETER(type, name) uniform type name;

#endif

BOKEH_PARAMETER(float, BokehApertureDiameter)
BOKEH_PARAMETER(float, BokehFocalLength)
BOKEH_PARAMETER(float, BokehFocusDistance)
BOKEH_PARAMETER(float, BokehSensorHeight)
BOKEH_PARAMETER(float, BokehMaxCoC)
BOKEH_PARAMETER(float, BokehConstantCoC)
BOKEH_PARAMETER(float, BokehAspectRatio)
BOKEH_PARAMETER(float, BokehAngle)
BOKEH_PARAMETER(float, BokehAngleB)
BOKEH_PARAMETER(float, BokehBleedingBias)
BOKEH_PARAMETER(float, BokehBleedingMult)
BOKEH_PARAMETER(float, BokehBlurCoC)
BOKEH_PARAMETER(float, BokehUseMax)
BOKEH_PARAMETER(float, BokehDebugMode)
BOKEH_PARAMETER(float, BokehLineLength)
BOKEH_PARAMETER(float, BokehLineCenterX)
BOKEH_PARAMETER(float, BokehLineCenterY)
BOKEH_PARAMETER(float, BokehSqueeze)
BOKEH_PARAMETER(float, BokehSpacing)
BOKEH_PARAMETER(float, BokehImageWidth)
BOKEH_PARAMETER(float, BokehImageHeight)
BOKEH_PARAMETER(float, BokehJitter)
BOKEH_PARAMETER(float, BokehFrame)
BOKEH_PARAMETER(float, BokehSides)
BOKEH_PARAMETER(float, BokehDepthKind)
BOKEH_PARAMETER(float, BokehNear)
BOKEH_PARAMETER(float, BokehFar)
BOKEH_PARAMETER(float, BokehViewportX)
BOKEH_PARAMETER(float, BokehViewportY)
BOKEH_PARAMETER(float, BokehTextureWidth)
BOKEH_PARAMETER(float, BokehTextureHeight)
BOKEH_PARAMETER(float, BokehPassIndex)
BOKEH_PARAMETER(float, BokehCatsEye)
BOKEH_PARAMETER(float, BokehRoundness)
BOKEH_PARAMETER(float, BokehLateral)
BOKEH_PARAMETER(float, BokehFrontRange)
BOKEH_PARAMETER(float, BokehBackRange)
BOKEH_PARAMETER(float, BokehNearScale)
BOKEH_PARAMETER(float, BokehFarScale)
BOKEH_PARAMETER(float, BokehNearMaxCoC)
BOKEH_PARAMETER(float, BokehFarMaxCoC)
BOKEH_PARAMETER(float, BokehDepthX)
BOKEH_PARAMETER(float, BokehDepthY)
BOKEH_PARAMETER(float, BokehDepthWidth)
BOKEH_PARAMETER(float, BokehDepthHeight)
BOKEH_PARAMETER(float, BokehStableBlend)

#ifdef VULKAN
};
#endif

// the targets that a pass writes: one, or as many as the table says
#if BOKEH_PASS == BOKEH_HEXAGON_FIRST || BOKEH_PASS == BOKEH_HEXAGON_LAYER_SECOND
#define BOKEH_TARGETS 2
#elif BOKEH_PASS == BOKEH_SQUARE_LAYER_FIRST || BOKEH_PASS == BOKEH_SQUARE_LAYER_SECOND
#define BOKEH_TARGETS 2
#elif BOKEH_PASS == BOKEH_LAYER_COC_REDUCE || BOKEH_PASS == BOKEH_LAYER_COC_ROWS
#define BOKEH_TARGETS 2
#elif BOKEH_PASS == BOKEH_LAYER_COC_COLUMNS || BOKEH_PASS == BOKEH_HOLE_FILL
#define BOKEH_TARGETS 2
#elif BOKEH_PASS == BOKEH_OCTAGON_NEAR_FIRST || BOKEH_PASS == BOKEH_OCTAGON_FAR_FIRST
#define BOKEH_TARGETS 3
#elif BOKEH_PASS == BOKEH_OCTAGON_FIRST
#define BOKEH_TARGETS 3
#elif BOKEH_PASS == BOKEH_DECAGON_NEAR_FIRST || BOKEH_PASS == BOKEH_DECAGON_FAR_FIRST
#define BOKEH_TARGETS 4
#elif BOKEH_PASS == BOKEH_PREFILTER || BOKEH_PASS == BOKEH_DOWNSAMPLE
#define BOKEH_TARGETS 4
#elif BOKEH_PASS == BOKEH_DECAGON_FIRST || BOKEH_PASS == BOKEH_HEXAGON_LAYER_FIRST
#define BOKEH_TARGETS 4
#else
#define BOKEH_TARGETS 1
#endif
layout(location = 0) out vec4 BokehResult;
#if BOKEH_TARGETS > 1
layout(location = 1) out vec4 BokehResultB;
#endif
#if BOKEH_TARGETS > 2
layout(location = 2) out vec4 BokehResultC;
#endif
#if BOKEH_TARGETS > 3
layout(location = 3) out vec4 BokehResultD;
#endif

// -------------------------------------------------------------------------------------------------
// fragment shaders

// sets the viewport, for passes without a filter
void BokehUseViewport()
{
    vec4 viewport = vec4(BokehViewportX, BokehViewportY, BokehImageWidth, BokehImageHeight);
    BokehSetViewport(viewport, vec2(BokehTextureWidth, BokehTextureHeight));
}

// returns interleaved gradient noise (Jimenez 2014) for a pixel, frame and pass, -0.5 .. 0.5
//   In pass p each frame adds (8 p + 1) 33 / 64. Over 64 frames every pass takes 64 evenly spaced
//   values in each pixel, no two passes in the same order, so the mean of the frames converges.
//   passIndex     0, 1 ..; a pass needs another index than the pass that it reads
float BokehNoise(vec2 uv, vec2 imageSize, float frame, float passIndex)
{
    float number = (8.0 * passIndex + 1.0) * (frame - 64.0 * floor(frame / 64.0)) + passIndex;
    float seed = dot(floor(uv * imageSize), vec2(0.06711056, 0.00583715));
    float value = 52.9829189 * (seed - floor(seed)) + 0.515625 * number;
    return value - floor(value) - 0.5;
}

// returns the noise times BokehJitter; 0 without BOKEH_JITTER 1
float BokehPassJitter(vec2 uv, vec2 imageSize, float passIndex)
{
    float jitter = 0.0;
    if (BOKEH_JITTER > 0)
    {
        jitter = BokehJitter * BokehNoise(uv, imageSize, BokehFrame, passIndex);
    }
    return jitter;
}

// sets the viewport and returns the settings of a filter pass; passIndex as in BokehNoise
BokehSamplingSettings BokehBegin(vec2 uv, float passIndex)
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
    settings.jitter = BokehPassJitter(uv, vec2(BokehImageWidth, BokehImageHeight), passIndex);
    settings.bleedingBias = BokehBleedingBias;
    settings.bleedingMult = BokehBleedingMult;
    return settings;
}

// makes the aperture; with BOKEH_LENS_SHAPE 1 as the lens shows it at this pixel
BokehPolygon BokehAperture(vec2 uv, int sides)
{
    BokehPolygon polygon = BokehMakePolygon(sides, BokehAngle, BokehSqueeze);
#ifdef BOKEH_LENS
    if (BOKEH_LENS_SHAPE > 0)
    {
        polygon = BokehWithCatsEye(BokehWithRoundness(polygon, BokehRoundness), uv,
            vec2(BokehImageWidth, BokehImageHeight), BokehCatsEye);
    }
#endif
    return polygon;
}

// makes the aperture with BOKEH_SIDES or else BokehSides sides; a hexagon if neither is set
BokehPolygon BokehAnyAperture(vec2 uv)
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
        focus.sharpRange = vec2(BokehFrontRange, BokehBackRange);
        focus.sideScale = vec2(BokehNearScale, BokehFarScale);
        focus.sideMaxCoC = vec2(BokehNearMaxCoC, BokehFarMaxCoC);
        CoC = BokehFocusedCoC(depth, BokehPassLens(), focus);
    }
#endif
    return CoC;
}

// returns the depth of this pixel in metres
float BokehPassDepth(vec2 depthUV)
{
    vec2 stored = BokehFetchDepth(BokehDepthSamp, depthUV);
    return BokehLinearDepth(stored, int(BokehDepthKind + 0.5), BokehNear, BokehFar);
}

// converts image uv to uv of the depth buffer, of which the image may fill a rectangle
vec2 BokehDepthUV(vec2 uv)
{
    vec2 depthUV = BokehToTexture(uv);
    if (BOKEH_FOCUS_CONTROLS > 0)
    {
        depthUV = vec2(BokehDepthX, BokehDepthY) + uv * vec2(BokehDepthWidth, BokehDepthHeight);
    }
    return depthUV;
}

// selects target BOKEH_TARGET_INDEX, for passes that can write only one
vec4 BokehSelectTarget(vec4 first, vec4 second, vec4 third, vec4 fourth)
{
    vec4 picked = first;
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
vec4 BokehAdaptiveLine(vec2 uv)
{
    BokehSamplingSettings settings = BokehBegin(uv, BokehPassIndex);
    vec2 lineCenter = vec2(BokehLineCenterX, BokehLineCenterY);
    vec4 segment = BokehSegment(BokehAngle, BokehLineLength, lineCenter, BokehSqueeze);
    return BokehDepthOfFieldAdaptive(BokehColorSamp, BokehDepthSamp, uv, segment, settings,
        BokehBlurCoC > 0.5);
}

#endif

#ifdef BOKEH_LAYERS

// sets the viewport and returns the context of a pass of `layered`
//   scale         size of the image / size of the target: 1, 2, 4 or 8
BokehLayerContext BokehBeginLayers(vec2 uv, float scale, float passIndex)
{
    BokehUseViewport();
    vec2 imageSize = vec2(BokehImageWidth, BokehImageHeight);
    BokehLayerContext layers = BokehMakeLayerContext(uv, imageSize, BokehMaxCoC);
    if (BOKEH_VIEWPORT > 0)
    {
        layers.origin = vec2(BokehViewportX, BokehViewportY);
        layers.texel = 1.0 / vec2(BokehTextureWidth, BokehTextureHeight);
    }
    layers.jitter = BokehPassJitter(uv, ceil(imageSize / scale), passIndex);
    return layers;
}

// does the same for a pass in which jitter has no effect
BokehLayerContext BokehBeginTiles(vec2 uv)
{
    return BokehBeginLayers(uv, 1.0, 0.0);
}

// blurs one layer, first pass
//   last          as in BokehExactFirst
BokehTargets BokehLayerPolygon(vec2 uv, bool isFar, int last, BokehPolygon polygon)
{
    BokehLayerContext layers = BokehBeginLayers(uv, float(BOKEH_LAYER_SCALE), 0.0);
    return BokehLayerFirst(BokehColorSamp, BokehColorSampB, BokehLayerCoC(BokehColorSampC,
        layers), isFar, last, polygon, layers);
}

// blurs one layer, second pass
vec4 BokehLayerResult(vec2 uv, bool isFar, BOKEH_TEXTURE Strip5Samp, BokehPolygon polygon)
{
    BokehLayerContext layers = BokehBeginLayers(uv, float(BOKEH_LAYER_SCALE), 1.0);
    return BokehLayerSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, Strip5Samp,
        BokehLayerCoC(BokehColorSampE, layers), isFar, polygon, layers);
}

// blurs both layers, first pass of a square or a hexagon
BokehLayersTargets BokehBothPolygons(vec2 uv, int sides)
{
    BokehLayerContext layers = BokehBeginLayers(uv, float(BOKEH_LAYER_SCALE), 0.0);
    return BokehLayersFirst(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        BokehLayerCoC(BokehColorSampE, layers), BokehAperture(uv, sides), layers);
}

// blurs both layers, second pass
BokehBlurred BokehBothResults(vec2 uv, BOKEH_TEXTURE NearStrip3Samp, BOKEH_TEXTURE FarStrip3Samp,
    int sides)
{
    BokehLayerContext layers = BokehBeginLayers(uv, float(BOKEH_LAYER_SCALE), 1.0);
    return BokehLayersSecond(BokehColorSamp, BokehColorSampB, NearStrip3Samp, FarStrip3Samp,
        BokehLayerCoC(BokehColorSampE, layers), BokehAperture(uv, sides), layers);
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

#if BOKEH_PASS == BOKEH_LINEAR_DEPTH

// writes depth in metres, which the passes of `paper` read instead of the depth buffer
void main()
{
    BokehUseViewport();
    float depth = BokehPassDepth(BokehToTexture(BokehUV));
    BokehResult = vec4(depth, depth, depth, 1.0);
}

#elif BOKEH_PASS == BOKEH_SIGNED_COC_MAP

// writes colour and signed CoC for `exact` and `layered`
//   It does the work of BokehSignedCoCMap, and also takes the parameters of BOKEH_FOCUS_CONTROLS. A
//   pixel beside a light may take the CoC of the light, see BokehLightCoC.
void main()
{
    BokehUseViewport();
    vec2 imageSize = vec2(BokehImageWidth, BokehImageHeight);
    float CoC = BokehPassCoC(BokehPassDepth(BokehDepthUV(BokehUV)));
    vec4 neighbor = BokehBrightNeighbor(BokehColorSamp, BokehUV, imageSize);
    if (max(neighbor.z, neighbor.w) > 0.0)
    {
        vec2 lightUV = BokehDepthUV(BokehUV + neighbor.xy);
        CoC = BokehLightCoC(CoC, BokehPassCoC(BokehPassDepth(lightUV)), neighbor.zw, imageSize.y);
    }
    BokehResult = BokehPackCoC(BokehFetchTexel(BokehColorSamp, BokehToTexture(BokehUV)), CoC);
}

#elif BOKEH_PASS == BOKEH_CONSTANT_COC

// writes colour and the same CoC for all pixels: use it to look at the polygon without depth
void main()
{
    BokehUseViewport();
    vec4 color = BokehFetchTexel(BokehColorSamp, BokehToTexture(BokehUV));
    BokehResult = BokehPackCoC(color, clamp(BokehConstantCoC, 0.0, BokehMaxCoC));
}

#elif BOKEH_PASS == BOKEH_SQUARE_FIRST

void main()
{
    BokehResult = BokehSquareFirst(BokehColorSamp, BokehUV, BokehAperture(BokehUV, 4),
        BokehBegin(BokehUV, 0.0)).strip2;
}

#elif BOKEH_PASS == BOKEH_SQUARE_SECOND

void main()
{
    BokehResult = BokehSquareSecond(BokehColorSamp, BokehUV, BokehAperture(BokehUV, 4),
        BokehBegin(BokehUV, 1.0));
}

#elif BOKEH_PASS == BOKEH_HEXAGON_FIRST

void main()
{
    BokehTargets targets = BokehHexagonFirst(BokehColorSamp, BokehUV, BokehAperture(BokehUV, 6),
        BokehBegin(BokehUV, 0.0));
    BokehResult = targets.strip2;
    BokehResultB = targets.strip3;
}

#elif BOKEH_PASS == BOKEH_HEXAGON_SECOND

void main()
{
    BokehResult = BokehHexagonSecond(BokehColorSamp, BokehColorSampB, BokehUV,
        BokehAperture(BokehUV, 6), BokehBegin(BokehUV, 1.0));
}

#elif BOKEH_PASS == BOKEH_OCTAGON_FIRST

void main()
{
    BokehTargets targets = BokehOctagonFirst(BokehColorSamp, BokehUV, BokehAperture(BokehUV, 8),
        BokehBegin(BokehUV, 0.0));
    BokehResult = targets.strip2;
    BokehResultB = targets.strip3;
    BokehResultC = targets.strip4;
}

#elif BOKEH_PASS == BOKEH_OCTAGON_SECOND

void main()
{
    BokehResult = BokehOctagonSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehUV,
        BokehAperture(BokehUV, 8), BokehBegin(BokehUV, 1.0));
}

#elif BOKEH_PASS == BOKEH_DECAGON_FIRST

void main()
{
    BokehTargets targets = BokehDecagonFirst(BokehColorSamp, BokehUV, BokehAperture(BokehUV, 10),
        BokehBegin(BokehUV, 0.0));
    BokehResult = targets.strip2;
    BokehResultB = targets.strip3;
    BokehResultC = targets.strip4;
    BokehResultD = targets.strip5;
}

#elif BOKEH_PASS == BOKEH_DECAGON_SECOND

void main()
{
    BokehResult = BokehDecagonSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehUV, BokehAperture(BokehUV, 10), BokehBegin(BokehUV, 1.0));
}

#elif BOKEH_PASS == BOKEH_EXACT_EDGE

// writes one target of the first pass of any polygon of `exact`
void main()
{
    BokehTargets targets = BokehExactFirst(BokehColorSamp, BokehUV, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(BokehUV), BokehBegin(BokehUV, 0.0));
    BokehResult = BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

#elif BOKEH_PASS == BOKEH_DEBUG

// shows what the effect reads, by BokehDebugMode
//   0             colour
//   1             depth: black at the camera, 0.5 at the focus distance, white far away
//   2             CoC: black in focus, white at BokehMaxCoC
//   3             near field orange, far field blue, in focus black; brighter as the CoC grows
void main()
{
    BokehUseViewport();
    vec4 result = BokehFetch(BokehColorSamp, BokehUV);
    float depth = BokehPassDepth(BokehToTexture(BokehUV));
    float grey = clamp(abs(result.a) / max(BokehMaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    vec3 weights = vec3(1.0, 1.0, 1.0);
    if (BokehDebugMode > 2.5)
    {
        weights = vec3(0.1, 0.4, 1.0);
        if (depth < BokehFocusDistance)
        {
            weights = vec3(1.0, 0.5, 0.0);
        }
    }
    else if (BokehDebugMode < 1.5)
    {
        grey = depth / (depth + BokehFocusDistance);
    }
    if (BokehDebugMode > 0.5)
    {
        result = vec4(weights * grey, 1.0);
    }
    BokehResult = result;
}

#elif BOKEH_PASS == BOKEH_COC_MAP

void main()
{
    BokehUseViewport();
    BokehResult = BokehCoCMap(BokehColorSamp, BokehDepthSamp, BokehUV, BokehPassLens());
}

#elif BOKEH_PASS == BOKEH_DEPTH_OF_FIELD

void main()
{
    vec2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehDepthOfField(BokehColorSamp, BokehDepthSamp, BokehUV, lineEnd,
        BokehBegin(BokehUV, 0.0), BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_DEPTH_OF_FIELD_FINAL

void main()
{
    vec2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehDepthOfFieldFinal(BokehColorSamp, BokehDepthSamp, BokehColorSampB, BokehUV,
        lineEnd, BokehBegin(BokehUV, 0.0), BokehBlurCoC > 0.5, BokehUseMax > 0.5);
}

#elif BOKEH_PASS == BOKEH_ADAPTIVE

// blurs along one line, whose angle, length and centre are parameters: a star has several lines
void main()
{
    BokehResult = BokehAdaptiveLine(BokehUV);
}

#elif BOKEH_PASS == BOKEH_ADAPTIVE_FINAL

// blurs along one line, then combines the result with that of an earlier pass
//   It takes the maximum of both if BokehUseMax is 1, otherwise the minimum.
void main()
{
    vec4 a = BokehAdaptiveLine(BokehUV);
    BokehResult = BokehCombine(a, BokehFetch(BokehColorSampB, BokehUV), BokehUseMax > 0.5);
}

#elif BOKEH_PASS == BOKEH_NAIVE_GATHER

void main()
{
    BokehSamplingSettings settings = BokehBegin(BokehUV, 0.0);
    settings.aspectRatio = BokehAspectRatio / BokehSqueeze;
    BokehResult = BokehNaiveGather(BokehColorSamp, BokehDepthSamp, BokehKernelSamp, BokehUV,
        settings, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_NAIVE_GRID

void main()
{
    vec2 lineEndU = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    vec2 lineEndV = BokehLineEnd(BokehAngleB, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehNaiveGrid(BokehColorSamp, BokehDepthSamp, BokehUV, lineEndU, lineEndV,
        BokehBegin(BokehUV, 0.0), BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_STABLE_MAP

void main()
{
    BokehUseViewport();
    BokehResult = BokehStableMap(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehUV,
        vec2(BokehImageWidth, BokehImageHeight), BokehStableBlend);
}

#elif BOKEH_PASS == BOKEH_LATERAL_COLOR

void main()
{
    BokehUseViewport();
    BokehResult = BokehLateralColor(BokehColorSamp, BokehUV, BokehLateral);
}

#elif BOKEH_PASS == BOKEH_TILE_MAX

void main()
{
    BokehResult = BokehTileMax(BokehColorSamp, BokehBeginTiles(BokehUV));
}

#elif BOKEH_PASS == BOKEH_TILE_DILATE_ROWS

void main()
{
    BokehResult = BokehTileDilate(BokehColorSamp, vec2(1.0, 0.0), BokehBeginTiles(BokehUV));
}

#elif BOKEH_PASS == BOKEH_TILE_DILATE_COLUMNS

void main()
{
    BokehResult = BokehTileDilate(BokehColorSamp, vec2(0.0, 1.0), BokehBeginTiles(BokehUV));
}

#elif BOKEH_PASS == BOKEH_PREFILTER

void main()
{
    BokehPrefiltered targets = BokehPrefilter(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(BokehUV));
    BokehResult = targets.nearLayer;
    BokehResultB = targets.farLayer;
    BokehResultC = targets.layerCoCSums;
    BokehResultD = targets.gatherCoC;
}

#elif BOKEH_PASS == BOKEH_LAYER_COC_REDUCE

void main()
{
    BokehTileSums targets = BokehLayerCoCReduce(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(BokehUV));
    BokehResult = targets.gatherCoC;
    BokehResultB = targets.sums;
}

#elif BOKEH_PASS == BOKEH_LAYER_COC_ROWS

void main()
{
    BokehTileSums targets = BokehLayerCoCRows(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehBeginTiles(BokehUV));
    BokehResult = targets.gatherCoC;
    BokehResultB = targets.sums;
}

#elif BOKEH_PASS == BOKEH_LAYER_COC_COLUMNS

void main()
{
    BokehLayerCoCTargets targets = BokehLayerCoCColumns(BokehColorSamp, BokehColorSampB,
        BokehColorSampC, BokehBeginTiles(BokehUV));
    BokehResult = targets.gatherTiles;
    BokehResultB = targets.layerCoC;
}

#elif BOKEH_PASS == BOKEH_DOWNSAMPLE

void main()
{
    BokehDownsampled targets = BokehDownsample(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, BokehAnyAperture(BokehUV), BokehBeginTiles(BokehUV));
    BokehResult = targets.midWithHoles;
    BokehResultB = targets.farWithHoles;
    BokehResultC = targets.nearQuarter;
    BokehResultD = targets.farQuarter;
}

#elif BOKEH_PASS == BOKEH_HOLE_FILL

void main()
{
    BokehFilled targets = BokehHoleFill(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehAnyAperture(BokehUV), BokehBeginLayers(BokehUV, 4.0, 0.0));
    BokehResult = targets.midFill;
    BokehResultB = targets.farFill;
}

#elif BOKEH_PASS == BOKEH_SQUARE_LAYER_FIRST

void main()
{
    BokehLayersTargets targets = BokehBothPolygons(BokehUV, 4);
    BokehResult = targets.nearStrip2;
    BokehResultB = targets.farStrip2;
}

#elif BOKEH_PASS == BOKEH_SQUARE_LAYER_SECOND

void main()
{
    BokehBlurred targets = BokehBothResults(BokehUV, BokehColorSamp, BokehColorSampB, 4);
    BokehResult = targets.nearLayer;
    BokehResultB = targets.farLayer;
}

#elif BOKEH_PASS == BOKEH_HEXAGON_LAYER_FIRST

void main()
{
    BokehLayersTargets targets = BokehBothPolygons(BokehUV, 6);
    BokehResult = targets.nearStrip2;
    BokehResultB = targets.farStrip2;
    BokehResultC = targets.nearStrip3;
    BokehResultD = targets.farStrip3;
}

#elif BOKEH_PASS == BOKEH_HEXAGON_LAYER_SECOND

void main()
{
    BokehBlurred targets = BokehBothResults(BokehUV, BokehColorSampC, BokehColorSampD, 6);
    BokehResult = targets.nearLayer;
    BokehResultB = targets.farLayer;
}

#elif BOKEH_PASS == BOKEH_OCTAGON_NEAR_FIRST

void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, false, 4, BokehAperture(BokehUV, 8));
    BokehResult = targets.strip2;
    BokehResultB = targets.strip3;
    BokehResultC = targets.strip4;
}

#elif BOKEH_PASS == BOKEH_OCTAGON_NEAR_SECOND

void main()
{
    BokehResult = BokehLayerResult(BokehUV, false, BokehColorSampC, BokehAperture(BokehUV, 8));
}

#elif BOKEH_PASS == BOKEH_OCTAGON_FAR_FIRST

void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, true, 4, BokehAperture(BokehUV, 8));
    BokehResult = targets.strip2;
    BokehResultB = targets.strip3;
    BokehResultC = targets.strip4;
}

#elif BOKEH_PASS == BOKEH_OCTAGON_FAR_SECOND

void main()
{
    BokehResult = BokehLayerResult(BokehUV, true, BokehColorSampC, BokehAperture(BokehUV, 8));
}

#elif BOKEH_PASS == BOKEH_DECAGON_NEAR_FIRST

void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, false, 5, BokehAperture(BokehUV, 10));
    BokehResult = targets.strip2;
    BokehResultB = targets.strip3;
    BokehResultC = targets.strip4;
    BokehResultD = targets.strip5;
}

#elif BOKEH_PASS == BOKEH_DECAGON_NEAR_SECOND

void main()
{
    BokehResult = BokehLayerResult(BokehUV, false, BokehColorSampD, BokehAperture(BokehUV, 10));
}

#elif BOKEH_PASS == BOKEH_DECAGON_FAR_FIRST

void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, true, 5, BokehAperture(BokehUV, 10));
    BokehResult = targets.strip2;
    BokehResultB = targets.strip3;
    BokehResultC = targets.strip4;
    BokehResultD = targets.strip5;
}

#elif BOKEH_PASS == BOKEH_DECAGON_FAR_SECOND

void main()
{
    BokehResult = BokehLayerResult(BokehUV, true, BokehColorSampD, BokehAperture(BokehUV, 10));
}

#elif BOKEH_PASS == BOKEH_COMPOSITE

void main()
{
    BokehResult = BokehComposite(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        BokehColorSampE, BokehColorSampF, BokehAnyAperture(BokehUV), BokehBeginLayers(BokehUV, 1.0,
        2.0));
}

#elif BOKEH_PASS == BOKEH_PREFILTER_ONE

// writes one target of BokehPrefilter; the entry points below do so for other passes
void main()
{
    BokehPrefiltered targets = BokehPrefilter(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(BokehUV));
    BokehResult = BokehSelectTarget(targets.nearLayer, targets.farLayer, targets.layerCoCSums,
        targets.gatherCoC);
}

#elif BOKEH_PASS == BOKEH_LAYER_COC_REDUCE_ONE

void main()
{
    BokehTileSums targets = BokehLayerCoCReduce(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(BokehUV));
    BokehResult = BokehSelectTarget(targets.gatherCoC, targets.sums, targets.sums, targets.sums);
}

#elif BOKEH_PASS == BOKEH_LAYER_COC_ROWS_ONE

void main()
{
    BokehTileSums targets = BokehLayerCoCRows(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehBeginTiles(BokehUV));
    BokehResult = BokehSelectTarget(targets.gatherCoC, targets.sums, targets.sums, targets.sums);
}

#elif BOKEH_PASS == BOKEH_LAYER_COC_COLUMNS_ONE

void main()
{
    BokehLayerCoCTargets targets = BokehLayerCoCColumns(BokehColorSamp, BokehColorSampB,
        BokehColorSampC, BokehBeginTiles(BokehUV));
    BokehResult = BokehSelectTarget(targets.gatherTiles, targets.layerCoC, targets.layerCoC,
        targets.layerCoC);
}

#elif BOKEH_PASS == BOKEH_DOWNSAMPLE_ONE

void main()
{
    BokehDownsampled targets = BokehDownsample(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, BokehAnyAperture(BokehUV), BokehBeginTiles(BokehUV));
    BokehResult = BokehSelectTarget(targets.midWithHoles, targets.farWithHoles, targets.nearQuarter,
        targets.farQuarter);
}

#elif BOKEH_PASS == BOKEH_HOLE_FILL_ONE

void main()
{
    BokehFilled targets = BokehHoleFill(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehAnyAperture(BokehUV), BokehBeginLayers(BokehUV, 4.0, 0.0));
    BokehResult = BokehSelectTarget(targets.midFill, targets.farFill, targets.farFill,
        targets.farFill);
}

#elif BOKEH_PASS == BOKEH_NEAR_EDGE

// writes one target of the first blur pass of one layer, for any polygon
void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, false, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(BokehUV));
    BokehResult = BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

#elif BOKEH_PASS == BOKEH_FAR_EDGE

void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, true, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(BokehUV));
    BokehResult = BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

#elif BOKEH_PASS == BOKEH_NEAR_SECOND_ONE

// writes one blurred layer, for any polygon: the second blur pass
void main()
{
    BokehResult = BokehLayerResult(BokehUV, false, BokehColorSampD, BokehAnyAperture(BokehUV));
}

#elif BOKEH_PASS == BOKEH_FAR_SECOND_ONE

void main()
{
    BokehResult = BokehLayerResult(BokehUV, true, BokehColorSampD, BokehAnyAperture(BokehUV));
}

#endif
#endif
