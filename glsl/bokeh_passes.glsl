// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.glsl, GLSL. Version 0.2.0.
// A program is: your #version line, one BOKEH_PASS define, bokeh.glsl, for the layers
// bokeh_layers.glsl, this file.
//
//   #define BOKEH_PASS ...      reads                             writes
//   BOKEH_LINEAR_DEPTH          DepthSamp (any convention)        depth in metres, to R32F
//   BOKEH_COC_MAP               ColorSamp, DepthSamp              colour, CoC: paper, naive
//   BOKEH_SIGNED_COC_MAP        ColorSamp, DepthSamp              colour, signed CoC: exact
//   BOKEH_CONSTANT_COC          ColorSamp                         colour, the same CoC everywhere
//   BOKEH_DEPTH_OF_FIELD        ColorSamp, DepthSamp              one line of the filter
//   BOKEH_DEPTH_OF_FIELD_FINAL  ColorSamp, DepthSamp, ColorSampB  the same, min or max with B
//   BOKEH_ADAPTIVE              ColorSamp, DepthSamp              a line of any length and place
//   BOKEH_ADAPTIVE_FINAL        ColorSamp, DepthSamp, ColorSampB  the same, min or max with B
//   BOKEH_NAIVE_GATHER          ColorSamp, DepthSamp, KernelSamp  a table of offsets
//   BOKEH_NAIVE_GRID            ColorSamp, DepthSamp              a grid of samples
//   BOKEH_SQUARE_FIRST          ColorSamp                         exact, first pass: 1 target
//   BOKEH_SQUARE_SECOND         ColorSamp                         exact, second pass: finished
//   BOKEH_HEXAGON_FIRST         ColorSamp                         2 targets
//   BOKEH_HEXAGON_SECOND        ColorSamp, ColorSampB             the targets in their order
//   BOKEH_OCTAGON_FIRST         ColorSamp                         3 targets
//   BOKEH_OCTAGON_SECOND        ColorSamp, ColorSampB .. C
//   BOKEH_DECAGON_FIRST         ColorSamp                         4 targets
//   BOKEH_DECAGON_SECOND        ColorSamp, ColorSampB .. D
//   BOKEH_EXACT_EDGE            ColorSamp                         one target of the first pass
//   BOKEH_LATERAL_COLOR         ColorSamp (finished)              red larger, blue smaller
//   BOKEH_DEBUG                 ColorSamp (with CoC), DepthSamp   debug view
//   BOKEH_FULL_SCREEN           -                                 (vertex shader) one triangle
//
//   Layers, with bokeh_layers.glsl: its table says what each reads, in the order of the slots; the
//   second pass over a layer has sizes in ColorSampE. BokehLayer: 0 near, 1 far.
//   BOKEH_TILE_MAX              ColorSamp                         largest CoC of 8 x 8 pixels
//   BOKEH_TILE_DILATE           ColorSamp                         twice: BokehAxis 0, 1
//   BOKEH_PREFILTER             ColorSamp, ColorSampB             4 targets
//   BOKEH_KERNEL_REDUCE         ColorSamp, ColorSampB             2 targets
//   BOKEH_KERNEL_ROWS           ColorSamp, ColorSampB .. C        2 targets
//   BOKEH_KERNEL_COLUMNS        ColorSamp, ColorSampB .. C        2 targets
//   BOKEH_HOLE_DOWNSAMPLE       ColorSamp, ColorSampB             3 targets
//   BOKEH_HOLE_FILL             ColorSamp, ColorSampB .. D        2 targets
//   BOKEH_SQUARE_LAYER_FIRST    ColorSamp, ColorSampB             1 target, as SquareFirst
//   BOKEH_SQUARE_LAYER_SECOND   ColorSamp, ColorSampE             a layer, finished
//   BOKEH_HEXAGON_LAYER_FIRST   ColorSamp, ColorSampB             2 targets
//   BOKEH_HEXAGON_LAYER_SECOND  ColorSamp, ColorSampB, E
//   BOKEH_OCTAGON_LAYER_FIRST   ColorSamp, ColorSampB             3 targets
//   BOKEH_OCTAGON_LAYER_SECOND  ColorSamp, ColorSampB .. C, E
//   BOKEH_DECAGON_LAYER_FIRST   ColorSamp, ColorSampB             4 targets
//   BOKEH_DECAGON_LAYER_SECOND  ColorSamp, ColorSampB .. E
//   BOKEH_COMPOSITE             ColorSamp, ColorSampB .. F        the picture
//   BOKEH_PREFILTER_ONE         ColorSamp, ColorSampB             one target of Prefilter
//   BOKEH_KERNEL_REDUCE_ONE     ColorSamp, ColorSampB             of KernelReduce
//   BOKEH_KERNEL_ROWS_ONE       ColorSamp, ColorSampB .. C        of KernelRows
//   BOKEH_KERNEL_COLUMNS_ONE    ColorSamp, ColorSampB .. C        of KernelColumns
//   BOKEH_HOLE_DOWNSAMPLE_ONE   ColorSamp, ColorSampB             of HoleDownsample
//   BOKEH_HOLE_FILL_ONE         ColorSamp, ColorSampB .. D        of HoleFill
//   BOKEH_LAYER_EDGE            ColorSamp, ColorSampB             of the first pass over a layer
//
//   Parameters: single uniforms in OpenGL; under Vulkan one uniform block in the order below
//   (docs/parameters.md has the table with units and offsets, and the block as a struct for C++,
//   C#, Rust and JavaScript). Set 0: the block at binding 0, the textures ColorSamp, DepthSamp,
//   ColorSampB to D, KernelSamp at 1 to 6, ColorSampE and F at 8 and 9.
//   Unused slots: a pass samples only what its row names. OpenGL needs nothing for the rest; under
//   Vulkan their descriptors may be left out of the layout, or left unwritten.

#define BOKEH_LINEAR_DEPTH 1
#define BOKEH_COC_MAP 2
#define BOKEH_SIGNED_COC_MAP 3
#define BOKEH_CONSTANT_COC 4
#define BOKEH_DEPTH_OF_FIELD 5
#define BOKEH_DEPTH_OF_FIELD_FINAL 6
#define BOKEH_ADAPTIVE 7
#define BOKEH_ADAPTIVE_FINAL 8
#define BOKEH_NAIVE_GATHER 9
#define BOKEH_NAIVE_GRID 10
#define BOKEH_SQUARE_FIRST 11
#define BOKEH_SQUARE_SECOND 12
#define BOKEH_HEXAGON_FIRST 13
#define BOKEH_HEXAGON_SECOND 14
#define BOKEH_OCTAGON_FIRST 15
#define BOKEH_OCTAGON_SECOND 16
#define BOKEH_DECAGON_FIRST 17
#define BOKEH_DECAGON_SECOND 18
#define BOKEH_EXACT_EDGE 19
#define BOKEH_LATERAL_COLOR 20
#define BOKEH_DEBUG 21
#define BOKEH_TILE_MAX 22
#define BOKEH_TILE_DILATE 23
#define BOKEH_PREFILTER 24
#define BOKEH_KERNEL_REDUCE 25
#define BOKEH_KERNEL_ROWS 26
#define BOKEH_KERNEL_COLUMNS 27
#define BOKEH_HOLE_DOWNSAMPLE 28
#define BOKEH_HOLE_FILL 29
#define BOKEH_SQUARE_LAYER_FIRST 30
#define BOKEH_SQUARE_LAYER_SECOND 31
#define BOKEH_HEXAGON_LAYER_FIRST 32
#define BOKEH_HEXAGON_LAYER_SECOND 33
#define BOKEH_OCTAGON_LAYER_FIRST 34
#define BOKEH_OCTAGON_LAYER_SECOND 35
#define BOKEH_DECAGON_LAYER_FIRST 36
#define BOKEH_DECAGON_LAYER_SECOND 37
#define BOKEH_COMPOSITE 38
#define BOKEH_PREFILTER_ONE 39
#define BOKEH_KERNEL_REDUCE_ONE 40
#define BOKEH_KERNEL_ROWS_ONE 41
#define BOKEH_KERNEL_COLUMNS_ONE 42
#define BOKEH_HOLE_DOWNSAMPLE_ONE 43
#define BOKEH_HOLE_FILL_ONE 44
#define BOKEH_LAYER_EDGE 45
#define BOKEH_FULL_SCREEN 46

// ..._ONE and ..._EDGE: the target that is written, 0 ..
#ifndef BOKEH_TARGET_INDEX
#define BOKEH_TARGET_INDEX 0
#endif

#ifndef BOKEH_PASS
#error define BOKEH_PASS before this file, for example as BOKEH_DEPTH_OF_FIELD
#elif BOKEH_PASS < BOKEH_LINEAR_DEPTH || BOKEH_PASS > BOKEH_FULL_SCREEN
#error BOKEH_PASS is none of the names in the table at the top of this file
#elif BOKEH_PASS >= BOKEH_TILE_MAX && BOKEH_PASS <= BOKEH_LAYER_EDGE && !defined(BOKEH_LAYERS)
#error put bokeh_layers.glsl before this file
#endif

#if BOKEH_PASS == BOKEH_FULL_SCREEN

// -------------------------------------------------------------------------------------------------
// vertex shader
// -------------------------------------------------------------------------------------------------

#ifdef VULKAN
#define BOKEH_VERTEX_ID gl_VertexIndex
layout(location = 0) out vec2 BokehUV;
#else
#define BOKEH_VERTEX_ID gl_VertexID
out vec2 BokehUV;
#endif

// Three vertices without a buffer. Clip y = -1 is the first row in memory, in OpenGL and in Vulkan:
// v runs with y.
void main()
{
    BokehUV = vec2(BOKEH_VERTEX_ID == 1 ? 2.0 : 0.0, BOKEH_VERTEX_ID == 2 ? 2.0 : 0.0);
    gl_Position = vec4(BokehUV * 2.0 - 1.0, 0.0, 1.0);
}

#else

// -------------------------------------------------------------------------------------------------
// bindings
// -------------------------------------------------------------------------------------------------

#ifdef VULKAN

layout(set = 0, binding = 1) uniform sampler2D BokehColorSamp;
layout(set = 0, binding = 2) uniform sampler2D BokehDepthSamp;
layout(set = 0, binding = 3) uniform sampler2D BokehColorSampB;
layout(set = 0, binding = 4) uniform sampler2D BokehColorSampC;
layout(set = 0, binding = 5) uniform sampler2D BokehColorSampD;
layout(set = 0, binding = 6) uniform sampler2D BokehKernelSamp;
layout(set = 0, binding = 8) uniform sampler2D BokehColorSampE;
layout(set = 0, binding = 9) uniform sampler2D BokehColorSampF;
layout(location = 0) in vec2 BokehUV;

#define BOKEH_PARAMETER(type, name) type name;

layout(set = 0, binding = 0, std140) uniform BokehParameters
{

#else

uniform sampler2D BokehColorSamp;
uniform sampler2D BokehDepthSamp;
uniform sampler2D BokehColorSampB;
uniform sampler2D BokehColorSampC;
uniform sampler2D BokehColorSampD;
uniform sampler2D BokehKernelSamp;
uniform sampler2D BokehColorSampE;
uniform sampler2D BokehColorSampF;
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
BOKEH_PARAMETER(float, BokehAxis)
BOKEH_PARAMETER(float, BokehLayer)
BOKEH_PARAMETER(float, BokehCatsEye)
BOKEH_PARAMETER(float, BokehRoundness)
BOKEH_PARAMETER(float, BokehLateral)
BOKEH_PARAMETER(float, BokehAxialRed)
BOKEH_PARAMETER(float, BokehAxialBlue)

#ifdef VULKAN
};
#endif

// what a pass writes: one target, or as many as the table says
#if BOKEH_PASS == BOKEH_HEXAGON_FIRST || BOKEH_PASS == BOKEH_HEXAGON_LAYER_FIRST
#define BOKEH_TARGETS 2
#elif BOKEH_PASS == BOKEH_KERNEL_REDUCE || BOKEH_PASS == BOKEH_KERNEL_ROWS
#define BOKEH_TARGETS 2
#elif BOKEH_PASS == BOKEH_KERNEL_COLUMNS || BOKEH_PASS == BOKEH_HOLE_FILL
#define BOKEH_TARGETS 2
#elif BOKEH_PASS == BOKEH_OCTAGON_FIRST || BOKEH_PASS == BOKEH_OCTAGON_LAYER_FIRST
#define BOKEH_TARGETS 3
#elif BOKEH_PASS == BOKEH_HOLE_DOWNSAMPLE
#define BOKEH_TARGETS 3
#elif BOKEH_PASS == BOKEH_DECAGON_FIRST || BOKEH_PASS == BOKEH_DECAGON_LAYER_FIRST
#define BOKEH_TARGETS 4
#elif BOKEH_PASS == BOKEH_PREFILTER
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
// -------------------------------------------------------------------------------------------------

// what a pass without a filter begins with
void BokehUseViewport()
{
    vec4 viewport = vec4(BokehViewportX, BokehViewportY, BokehImageWidth, BokehImageHeight);
    BokehSetViewport(viewport, vec2(BokehTextureWidth, BokehTextureHeight));
}

// what a filter pass begins with: the viewport set, and its settings; passIndex as in BokehNoise
BokehFilter BokehBegin(vec2 uv, float passIndex)
{
    BokehUseViewport();
    vec2 imageSize = vec2(BokehImageWidth, BokehImageHeight);
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
vec4 BokehAdaptiveLine(vec2 uv)
{
    BokehFilter settings = BokehBegin(uv, BokehPassIndex);
    vec2 lineCenter = vec2(BokehLineCenterX, BokehLineCenterY);
    vec4 segment = BokehSegment(BokehAngle, BokehLineLength, lineCenter, BokehSqueeze);
    return BokehDepthOfFieldAdaptive(BokehColorSamp, BokehDepthSamp, uv, segment, settings,
        BokehBlurCoC > 0.5);
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
BokehPolygon BokehAperture(vec2 uv, int sides)
{
    BokehPolygon polygon = BokehMakePolygon(sides, BokehAngle, BokehSqueeze);
    if (BOKEH_CHARACTER > 0)
    {
        vec2 imageSize = vec2(BokehImageWidth, BokehImageHeight);
        polygon.roundness = BokehRoundness;
        BokehPolygon cut = BokehWithCatsEye(polygon, uv, imageSize, BokehCatsEye);
        polygon.lengths = cut.lengths;
        polygon.fifth = cut.fifth;
        polygon.axial = vec2(BokehAxialRed, BokehAxialBlue);
    }
    return polygon;
}

// exact, first pass
BokehTargets BokehFirst(vec2 uv, int sides)
{
    BokehFilter settings = BokehBegin(uv, 0.0);
    BokehPolygon polygon = BokehAperture(uv, sides);
    return BokehExactFirst(BokehColorSamp, uv, polygon, settings);
}

// exact, second pass
vec4 BokehSecond(sampler2D Edge2Samp, sampler2D Edge3Samp, sampler2D Edge4Samp, sampler2D Edge5Samp,
    vec2 uv, int sides)
{
    BokehFilter settings = BokehBegin(uv, 1.0);
    BokehPolygon polygon = BokehAperture(uv, sides);
    return BokehExactSecond(Edge2Samp, Edge3Samp, Edge4Samp, Edge5Samp, uv, polygon, settings);
}

// target BOKEH_TARGET_INDEX of several, where a pass can write only one
vec4 BokehPickTarget(vec4 first, vec4 second, vec4 third, vec4 fourth)
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

#ifdef BOKEH_LAYERS

// what a pass of the layers begins with: the viewport set, and its settings
//   sides         4, 6, 8 or 10
//   scale         of its target
BokehLayers BokehBeginLayers(vec2 uv, int sides, float scale, float passIndex)
{
    BokehUseViewport();
    vec2 imageSize = vec2(BokehImageWidth, BokehImageHeight);
    BokehPolygon polygon = BokehAperture(uv, clamp(sides, 4, 10));
    BokehLayers layers = BokehMakeLayers(imageSize, polygon, BokehMaxCoC);
    layers.full = BokehMakeGrid(vec4(BokehViewportX, BokehViewportY, imageSize),
        vec2(BokehTextureWidth, BokehTextureHeight));
    float noise = BokehNoise(uv, ceil(imageSize / scale), BokehFrame, passIndex);
    layers.jitter = BokehJitter * noise * float(BOKEH_ADAPTIVE_SAMPLES);
    return layers;
}

// the same for a pass without samples of its own
BokehLayers BokehBeginTiles(vec2 uv)
{
    return BokehBeginLayers(uv, 6, 1.0, 0.0);
}

// the polygon of a layer, first pass
BokehTargets BokehLayerPolygon(vec2 uv, int sides)
{
    BokehLayers layers = BokehBeginLayers(uv, sides, 2.0, 0.0);
    return BokehLayerFirst(BokehColorSamp, BokehColorSampB, uv, BokehLayer > 0.5, layers);
}

#endif

#if BOKEH_PASS == BOKEH_LINEAR_DEPTH

void main()
{
    BokehUseViewport();
    float depth = BokehFetchNearest(BokehDepthSamp, BokehUV).r;
    float S2 = BokehLinearDepth(depth, int(BokehDepthKind + 0.5), BokehNear, BokehFar);
    BokehResult = vec4(S2, S2, S2, 1.0);
}

#elif BOKEH_PASS == BOKEH_COC_MAP

void main()
{
    BokehUseViewport();
    BokehResult = BokehCoCMap(BokehColorSamp, BokehDepthSamp, BokehUV, BokehApertureDiameter,
        BokehFocalLength, BokehFocusDistance, BokehSensorHeight, BokehMaxCoC);
}

#elif BOKEH_PASS == BOKEH_SIGNED_COC_MAP

void main()
{
    BokehUseViewport();
    BokehResult = BokehSignedCoCMap(BokehColorSamp, BokehDepthSamp, BokehUV, BokehApertureDiameter,
        BokehFocalLength, BokehFocusDistance, BokehSensorHeight, BokehMaxCoC);
}

#elif BOKEH_PASS == BOKEH_CONSTANT_COC

void main()
{
    BokehUseViewport();
    vec4 color = BokehFetchNearest(BokehColorSamp, BokehUV);
    BokehResult = BokehPackCoC(color, clamp(BokehConstantCoC, 0.0, BokehMaxCoC));
}

#elif BOKEH_PASS == BOKEH_DEPTH_OF_FIELD

void main()
{
    BokehFilter settings = BokehBegin(BokehUV, 0.0);
    vec2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehDepthOfField(BokehColorSamp, BokehDepthSamp, BokehUV, lineEnd, settings,
        BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_DEPTH_OF_FIELD_FINAL

void main()
{
    BokehFilter settings = BokehBegin(BokehUV, 0.0);
    vec2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehDepthOfFieldFinal(BokehColorSamp, BokehDepthSamp, BokehColorSampB, BokehUV,
        lineEnd, settings, BokehBlurCoC > 0.5, BokehUseMax > 0.5);
}

#elif BOKEH_PASS == BOKEH_ADAPTIVE

void main()
{
    BokehResult = BokehAdaptiveLine(BokehUV);
}

#elif BOKEH_PASS == BOKEH_ADAPTIVE_FINAL

void main()
{
    vec4 a = BokehAdaptiveLine(BokehUV);
    BokehResult = BokehCombine(a, BokehFetch(BokehColorSampB, BokehUV), BokehUseMax > 0.5);
}

#elif BOKEH_PASS == BOKEH_NAIVE_GATHER

void main()
{
    BokehFilter settings = BokehBegin(BokehUV, 0.0);
    settings.aspectRatio = BokehAspectRatio / BokehSqueeze;
    BokehResult = BokehNaiveGather(BokehColorSamp, BokehDepthSamp, BokehKernelSamp, BokehUV,
        settings, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_NAIVE_GRID

void main()
{
    BokehFilter settings = BokehBegin(BokehUV, 0.0);
    vec2 lineEndU = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    vec2 lineEndV = BokehLineEnd(BokehAngleB, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehNaiveGrid(BokehColorSamp, BokehDepthSamp, BokehUV, lineEndU, lineEndV,
        settings, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_SQUARE_FIRST

void main()
{
    BokehResult = BokehFirst(BokehUV, 4).edge2;
}

#elif BOKEH_PASS == BOKEH_SQUARE_SECOND

void main()
{
    BokehResult = BokehSecond(BokehColorSamp, BokehColorSamp, BokehColorSamp, BokehColorSamp,
        BokehUV, 4);
}

#elif BOKEH_PASS == BOKEH_HEXAGON_FIRST

void main()
{
    BokehTargets targets = BokehFirst(BokehUV, 6);
    BokehResult = targets.edge2;
    BokehResultB = targets.edge3;
}

#elif BOKEH_PASS == BOKEH_HEXAGON_SECOND

void main()
{
    BokehResult = BokehSecond(BokehColorSamp, BokehColorSampB, BokehColorSampB, BokehColorSampB,
        BokehUV, 6);
}

#elif BOKEH_PASS == BOKEH_OCTAGON_FIRST

void main()
{
    BokehTargets targets = BokehFirst(BokehUV, 8);
    BokehResult = targets.edge2;
    BokehResultB = targets.edge3;
    BokehResultC = targets.edge4;
}

#elif BOKEH_PASS == BOKEH_OCTAGON_SECOND

void main()
{
    BokehResult = BokehSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampC,
        BokehUV, 8);
}

#elif BOKEH_PASS == BOKEH_DECAGON_FIRST

void main()
{
    BokehTargets targets = BokehFirst(BokehUV, 10);
    BokehResult = targets.edge2;
    BokehResultB = targets.edge3;
    BokehResultC = targets.edge4;
    BokehResultD = targets.edge5;
}

#elif BOKEH_PASS == BOKEH_DECAGON_SECOND

void main()
{
    BokehResult = BokehSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        BokehUV, 10);
}

#elif BOKEH_PASS == BOKEH_EXACT_EDGE

void main()
{
    BokehFilter settings = BokehBegin(BokehUV, 0.0);
    BokehPolygon polygon = BokehAperture(BokehUV, BokehSidesOrSix());
    BokehResult = BokehExactEdge(BokehColorSamp, BokehUV, BOKEH_TARGET_INDEX + 2, polygon,
        settings);
}

#elif BOKEH_PASS == BOKEH_LATERAL_COLOR

// the last pass
void main()
{
    BokehUseViewport();
    BokehResult = BokehLateralColor(BokehColorSamp, BokehUV, BokehLateral);
}

#elif BOKEH_PASS == BOKEH_DEBUG

// BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
void main()
{
    BokehUseViewport();
    vec4 result = BokehFetch(BokehColorSamp, BokehUV);
    float S2 = BokehSafeDepth(BokehFetchNearest(BokehDepthSamp, BokehUV).r);
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
    BokehResult = result;
}

#elif BOKEH_PASS == BOKEH_TILE_MAX

void main()
{
    BokehResult = BokehTileMax(BokehColorSamp, BokehUV, BokehBeginTiles(BokehUV));
}

#elif BOKEH_PASS == BOKEH_TILE_DILATE

void main()
{
    vec2 axis = vec2(1.0 - BokehAxis, BokehAxis);
    BokehResult = BokehTileDilate(BokehColorSamp, BokehUV, axis, BokehBeginTiles(BokehUV));
}

#elif BOKEH_PASS == BOKEH_PREFILTER

void main()
{
    BokehPrefiltered targets = BokehPrefilter(BokehColorSamp, BokehColorSampB, BokehUV,
        BokehBeginTiles(BokehUV));
    BokehResult = targets.nearLayer;
    BokehResultB = targets.farLayer;
    BokehResultC = targets.kernelSums;
    BokehResultD = targets.leftovers;
}

#elif BOKEH_PASS == BOKEH_KERNEL_REDUCE

void main()
{
    BokehKernels targets = BokehKernelReduce(BokehColorSamp, BokehColorSampB, BokehUV,
        BokehBeginTiles(BokehUV));
    BokehResult = targets.leftovers;
    BokehResultB = targets.sums;
}

#elif BOKEH_PASS == BOKEH_KERNEL_ROWS

void main()
{
    BokehKernels targets = BokehKernelRows(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehUV, BokehBeginTiles(BokehUV));
    BokehResult = targets.leftovers;
    BokehResultB = targets.sums;
}

#elif BOKEH_PASS == BOKEH_KERNEL_COLUMNS

void main()
{
    BokehSizes targets = BokehKernelColumns(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehUV, BokehBeginTiles(BokehUV));
    BokehResult = targets.reach;
    BokehResultB = targets.sizes;
}

#elif BOKEH_PASS == BOKEH_HOLE_DOWNSAMPLE

void main()
{
    BokehHoles targets = BokehHoleDownsample(BokehColorSamp, BokehColorSampB, BokehUV,
        BokehBeginTiles(BokehUV));
    BokehResult = targets.middle;
    BokehResultB = targets.far;
    BokehResultC = targets.shares;
}

#elif BOKEH_PASS == BOKEH_HOLE_FILL

void main()
{
    BokehLayers layers = BokehBeginLayers(BokehUV, BokehSidesOrSix(), 4.0, 0.0);
    BokehFilled targets = BokehHoleFill(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehUV, layers);
    BokehResult = targets.middle;
    BokehResultB = targets.back;
}

#elif BOKEH_PASS == BOKEH_SQUARE_LAYER_FIRST

void main()
{
    BokehResult = BokehLayerPolygon(BokehUV, 4).edge2;
}

#elif BOKEH_PASS == BOKEH_SQUARE_LAYER_SECOND

void main()
{
    BokehLayers layers = BokehBeginLayers(BokehUV, 4, 2.0, 1.0);
    BokehResult = BokehLayerSecond(BokehColorSamp, BokehColorSamp, BokehColorSamp,
        BokehColorSamp, BokehColorSampE, BokehUV, BokehLayer > 0.5, layers);
}

#elif BOKEH_PASS == BOKEH_HEXAGON_LAYER_FIRST

void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, 6);
    BokehResult = targets.edge2;
    BokehResultB = targets.edge3;
}

#elif BOKEH_PASS == BOKEH_HEXAGON_LAYER_SECOND

void main()
{
    BokehLayers layers = BokehBeginLayers(BokehUV, 6, 2.0, 1.0);
    BokehResult = BokehLayerSecond(BokehColorSamp, BokehColorSampB, BokehColorSampB,
        BokehColorSampB, BokehColorSampE, BokehUV, BokehLayer > 0.5, layers);
}

#elif BOKEH_PASS == BOKEH_OCTAGON_LAYER_FIRST

void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, 8);
    BokehResult = targets.edge2;
    BokehResultB = targets.edge3;
    BokehResultC = targets.edge4;
}

#elif BOKEH_PASS == BOKEH_OCTAGON_LAYER_SECOND

void main()
{
    BokehLayers layers = BokehBeginLayers(BokehUV, 8, 2.0, 1.0);
    BokehResult = BokehLayerSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampC, BokehColorSampE, BokehUV, BokehLayer > 0.5, layers);
}

#elif BOKEH_PASS == BOKEH_DECAGON_LAYER_FIRST

void main()
{
    BokehTargets targets = BokehLayerPolygon(BokehUV, 10);
    BokehResult = targets.edge2;
    BokehResultB = targets.edge3;
    BokehResultC = targets.edge4;
    BokehResultD = targets.edge5;
}

#elif BOKEH_PASS == BOKEH_DECAGON_LAYER_SECOND

void main()
{
    BokehLayers layers = BokehBeginLayers(BokehUV, 10, 2.0, 1.0);
    BokehResult = BokehLayerSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, BokehUV, BokehLayer > 0.5, layers);
}

#elif BOKEH_PASS == BOKEH_COMPOSITE

void main()
{
    BokehLayers layers = BokehBeginLayers(BokehUV, BokehSidesOrSix(), 1.0, 2.0);
    BokehResult = BokehComposite(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        BokehColorSampE, BokehColorSampF, BokehUV, layers);
}

#elif BOKEH_PASS == BOKEH_PREFILTER_ONE

void main()
{
    BokehPrefiltered targets = BokehPrefilter(BokehColorSamp, BokehColorSampB, BokehUV,
        BokehBeginTiles(BokehUV));
    BokehResult = BokehPickTarget(targets.nearLayer, targets.farLayer, targets.kernelSums,
        targets.leftovers);
}

#elif BOKEH_PASS == BOKEH_KERNEL_REDUCE_ONE

void main()
{
    BokehKernels targets = BokehKernelReduce(BokehColorSamp, BokehColorSampB, BokehUV,
        BokehBeginTiles(BokehUV));
    BokehResult = BokehPickTarget(targets.leftovers, targets.sums, targets.sums, targets.sums);
}

#elif BOKEH_PASS == BOKEH_KERNEL_ROWS_ONE

void main()
{
    BokehKernels targets = BokehKernelRows(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehUV, BokehBeginTiles(BokehUV));
    BokehResult = BokehPickTarget(targets.leftovers, targets.sums, targets.sums, targets.sums);
}

#elif BOKEH_PASS == BOKEH_KERNEL_COLUMNS_ONE

void main()
{
    BokehSizes targets = BokehKernelColumns(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehUV, BokehBeginTiles(BokehUV));
    BokehResult = BokehPickTarget(targets.reach, targets.sizes, targets.sizes, targets.sizes);
}

#elif BOKEH_PASS == BOKEH_HOLE_DOWNSAMPLE_ONE

void main()
{
    BokehHoles targets = BokehHoleDownsample(BokehColorSamp, BokehColorSampB, BokehUV,
        BokehBeginTiles(BokehUV));
    BokehResult = BokehPickTarget(targets.middle, targets.far, targets.shares, targets.shares);
}

#elif BOKEH_PASS == BOKEH_HOLE_FILL_ONE

void main()
{
    BokehLayers layers = BokehBeginLayers(BokehUV, BokehSidesOrSix(), 4.0, 0.0);
    BokehFilled targets = BokehHoleFill(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehUV, layers);
    BokehResult = BokehPickTarget(targets.middle, targets.back, targets.back, targets.back);
}

#elif BOKEH_PASS == BOKEH_LAYER_EDGE

void main()
{
    BokehLayers layers = BokehBeginLayers(BokehUV, BokehSidesOrSix(), 2.0, 0.0);
    BokehResult = BokehLayerEdge(BokehColorSamp, BokehColorSampB, BokehUV, BokehLayer > 0.5,
        BOKEH_TARGET_INDEX + 2, layers);
}

#endif
#endif
