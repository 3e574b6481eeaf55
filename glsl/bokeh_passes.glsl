// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.glsl, GLSL. Version 0.1.0.
// A program is: your #version line, one BOKEH_PASS define, bokeh.glsl, this file.
//
//   #define BOKEH_PASS ...       reads                                  writes
//   BOKEH_LINEAR_DEPTH           DepthSamp (any convention)             depth in metres, to an R32F target
//   BOKEH_COC_MAP                ColorSamp, DepthSamp                   colour, CoC in alpha
//   BOKEH_CONSTANT_COC           ColorSamp                              colour, the same CoC everywhere
//   BOKEH_DEPTH_OF_FIELD         ColorSamp, DepthSamp                   one line of the filter
//   BOKEH_DEPTH_OF_FIELD_FINAL   ColorSamp, DepthSamp, ColorSampB       the same, min or max with ColorSampB
//   BOKEH_ADAPTIVE               ColorSamp, DepthSamp                   a line of any length and place, adaptive
//   BOKEH_ADAPTIVE_FINAL         ColorSamp, DepthSamp, ColorSampB       the same, min or max with ColorSampB
//   BOKEH_NAIVE_GATHER           ColorSamp, DepthSamp, KernelSamp       a table of BOKEH_NUM_SAMPLES offsets
//   BOKEH_NAIVE_GRID             ColorSamp, DepthSamp                   BOKEH_NUM_SAMPLES x BOKEH_NUM_SAMPLES grid
//   BOKEH_SQUARE_FIRST           ColorSamp, DepthSamp                   exact, first pass: 1 target
//   BOKEH_SQUARE_SECOND          ColorSamp, DepthSamp                   exact, second pass: the finished square
//   BOKEH_HEXAGON_FIRST          ColorSamp, DepthSamp                   2 targets
//   BOKEH_HEXAGON_SECOND         ColorSamp, DepthSamp, ColorSampB       ColorSamp and so on: the targets in their order
//   BOKEH_OCTAGON_FIRST          ColorSamp, DepthSamp                   3 targets
//   BOKEH_OCTAGON_SECOND         ColorSamp, DepthSamp, ColorSampB .. C
//   BOKEH_DECAGON_FIRST          ColorSamp, DepthSamp                   4 targets
//   BOKEH_DECAGON_SECOND         ColorSamp, DepthSamp, ColorSampB .. D
//   BOKEH_EXACT_EDGE             ColorSamp, DepthSamp, ColorSampB .. C  one target of the first pass, without MRT;
//                                                                       B, C: the target before, the one before that
//   BOKEH_DEBUG                  ColorSamp (with CoC), DepthSamp        debug view
//   BOKEH_FULL_SCREEN            -                                      (vertex shader) one triangle over the target
//
//   Parameters: single uniforms in OpenGL; under Vulkan one uniform block in the order below (docs/inputs.md has the
//   table with units and offsets). Set 0: the block at binding 0, the six textures in their order at 1 to 6.

#define BOKEH_LINEAR_DEPTH 1
#define BOKEH_COC_MAP 2
#define BOKEH_CONSTANT_COC 3
#define BOKEH_DEPTH_OF_FIELD 4
#define BOKEH_DEPTH_OF_FIELD_FINAL 5
#define BOKEH_ADAPTIVE 6
#define BOKEH_ADAPTIVE_FINAL 7
#define BOKEH_NAIVE_GATHER 8
#define BOKEH_NAIVE_GRID 9
#define BOKEH_SQUARE_FIRST 10
#define BOKEH_SQUARE_SECOND 11
#define BOKEH_HEXAGON_FIRST 12
#define BOKEH_HEXAGON_SECOND 13
#define BOKEH_OCTAGON_FIRST 14
#define BOKEH_OCTAGON_SECOND 15
#define BOKEH_DECAGON_FIRST 16
#define BOKEH_DECAGON_SECOND 17
#define BOKEH_EXACT_EDGE 18
#define BOKEH_DEBUG 19
#define BOKEH_FULL_SCREEN 20

#ifndef BOKEH_PASS
#error define BOKEH_PASS before this file, for example as BOKEH_DEPTH_OF_FIELD
#elif BOKEH_PASS < BOKEH_LINEAR_DEPTH || BOKEH_PASS > BOKEH_FULL_SCREEN
#error BOKEH_PASS is none of the names in the table at the top of this file
#endif

#if BOKEH_PASS == BOKEH_FULL_SCREEN

// ---------------------------------------------------------------------------------------------------------------------
// vertex shader
// ---------------------------------------------------------------------------------------------------------------------

#ifdef VULKAN
#define BOKEH_VERTEX_ID gl_VertexIndex
layout(location = 0) out vec2 BokehUV;
#else
#define BOKEH_VERTEX_ID gl_VertexID
out vec2 BokehUV;
#endif

// Three vertices without a buffer. Clip y = -1 is the first row in memory, in OpenGL and in Vulkan: v runs with y.
void main()
{
    BokehUV = vec2(BOKEH_VERTEX_ID == 1 ? 2.0 : 0.0, BOKEH_VERTEX_ID == 2 ? 2.0 : 0.0);
    gl_Position = vec4(BokehUV * 2.0 - 1.0, 0.0, 1.0);
}

#else

// ---------------------------------------------------------------------------------------------------------------------
// bindings
// ---------------------------------------------------------------------------------------------------------------------

#ifdef VULKAN

layout(set = 0, binding = 1) uniform sampler2D BokehColorSamp;
layout(set = 0, binding = 2) uniform sampler2D BokehDepthSamp;
layout(set = 0, binding = 3) uniform sampler2D BokehColorSampB;
layout(set = 0, binding = 4) uniform sampler2D BokehColorSampC;
layout(set = 0, binding = 5) uniform sampler2D BokehColorSampD;
layout(set = 0, binding = 6) uniform sampler2D BokehKernelSamp;
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
BOKEH_PARAMETER(float, BokehEdge)
BOKEH_PARAMETER(float, BokehDepthKind)
BOKEH_PARAMETER(float, BokehNear)
BOKEH_PARAMETER(float, BokehFar)
BOKEH_PARAMETER(float, BokehViewportX)
BOKEH_PARAMETER(float, BokehViewportY)
BOKEH_PARAMETER(float, BokehTextureWidth)
BOKEH_PARAMETER(float, BokehTextureHeight)

#ifdef VULKAN
};
#endif

// what a pass writes: one target, or as many as the table says
layout(location = 0) out vec4 BokehResult;
#if BOKEH_PASS == BOKEH_HEXAGON_FIRST || BOKEH_PASS == BOKEH_OCTAGON_FIRST || BOKEH_PASS == BOKEH_DECAGON_FIRST
layout(location = 1) out vec4 BokehResultB;
#endif
#if BOKEH_PASS == BOKEH_OCTAGON_FIRST || BOKEH_PASS == BOKEH_DECAGON_FIRST
layout(location = 2) out vec4 BokehResultC;
#endif
#if BOKEH_PASS == BOKEH_DECAGON_FIRST
layout(location = 3) out vec4 BokehResultD;
#endif

// ---------------------------------------------------------------------------------------------------------------------
// fragment shaders
// ---------------------------------------------------------------------------------------------------------------------

// what every pass begins with
void BokehUseViewport()
{
    vec4 viewport = vec4(BokehViewportX, BokehViewportY, BokehImageWidth, BokehImageHeight);
    BokehSetViewport(viewport, vec2(BokehTextureWidth, BokehTextureHeight));
}

#if BOKEH_PASS == BOKEH_LINEAR_DEPTH

void main()
{
    BokehUseViewport();
    float depth = BokehFetchNearest(BokehDepthSamp, BokehUV).r;
    float S2 = BokehLinearDepth(depth, BokehDepthKind, BokehNear, BokehFar);
    BokehResult = vec4(S2, S2, S2, 1.0);
}

#elif BOKEH_PASS == BOKEH_COC_MAP

void main()
{
    BokehUseViewport();
    BokehResult = BokehCoCMap(BokehColorSamp, BokehDepthSamp, BokehUV, BokehApertureDiameter, BokehFocalLength,
        BokehFocusDistance, BokehSensorHeight, BokehMaxCoC);
}

#elif BOKEH_PASS == BOKEH_CONSTANT_COC

void main()
{
    BokehUseViewport();
    BokehResult = BokehPackCoC(BokehFetch(BokehColorSamp, BokehUV), clamp(BokehConstantCoC, 0.0, BokehMaxCoC));
}

#elif BOKEH_PASS == BOKEH_DEPTH_OF_FIELD

void main()
{
    BokehUseViewport();
    vec2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehDepthOfField(BokehColorSamp, BokehDepthSamp, BokehUV, lineEnd, BOKEH_NUM_SAMPLES,
        BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_DEPTH_OF_FIELD_FINAL

void main()
{
    BokehUseViewport();
    vec2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehDepthOfFieldFinal(BokehColorSamp, BokehDepthSamp, BokehUV, lineEnd, BOKEH_NUM_SAMPLES,
        BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5, BokehColorSampB, BokehUseMax > 0.5);
}

#elif BOKEH_PASS == BOKEH_ADAPTIVE

void main()
{
    BokehUseViewport();
    vec2 lineCenter = vec2(BokehLineCenterX, BokehLineCenterY);
    vec4 segment = BokehSegment(BokehAngle, BokehLineLength, lineCenter, BokehSqueeze);
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    BokehResult = BokehDepthOfFieldAdaptive(BokehColorSamp, BokehDepthSamp, BokehUV, segment, BokehAspectRatio,
        BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC >
        0.5);
}

#elif BOKEH_PASS == BOKEH_ADAPTIVE_FINAL

void main()
{
    BokehUseViewport();
    vec2 lineCenter = vec2(BokehLineCenterX, BokehLineCenterY);
    vec4 segment = BokehSegment(BokehAngle, BokehLineLength, lineCenter, BokehSqueeze);
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    vec4 a = BokehDepthOfFieldAdaptive(BokehColorSamp, BokehDepthSamp, BokehUV, segment, BokehAspectRatio,
        BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC >
        0.5);
    BokehResult = BokehCombine(a, BokehFetch(BokehColorSampB, BokehUV), BokehUseMax > 0.5);
}

#elif BOKEH_PASS == BOKEH_NAIVE_GATHER

void main()
{
    BokehUseViewport();
    BokehResult = BokehNaiveGather(BokehColorSamp, BokehDepthSamp, BokehKernelSamp, BokehUV,
        BokehAspectRatio / BokehSqueeze, BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_NAIVE_GRID

void main()
{
    BokehUseViewport();
    vec2 lineEndU = BokehLineEnd(BokehAngle, BokehAspectRatio / BokehSqueeze);
    vec2 lineEndV = BokehLineEnd(BokehAngleB, BokehAspectRatio / BokehSqueeze);
    BokehResult = BokehNaiveGrid(BokehColorSamp, BokehDepthSamp, BokehUV, lineEndU, lineEndV, BOKEH_NUM_SAMPLES,
        BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_SQUARE_FIRST

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    mat4 T = BokehExactFirst(BokehColorSamp, BokehDepthSamp, BokehUV, 4.0, BokehAngle, BokehSqueeze, BokehAspectRatio,
        BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias, BokehBleedingMult);
    BokehResult = T[0];
}

#elif BOKEH_PASS == BOKEH_SQUARE_SECOND

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    BokehResult = BokehExactSecond(BokehColorSamp, BokehColorSamp, BokehColorSamp, BokehColorSamp, BokehDepthSamp,
        BokehUV, 4.0, BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES,
        jitter, BokehBleedingBias, BokehBleedingMult);
}

#elif BOKEH_PASS == BOKEH_HEXAGON_FIRST

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    mat4 T = BokehExactFirst(BokehColorSamp, BokehDepthSamp, BokehUV, 6.0, BokehAngle, BokehSqueeze, BokehAspectRatio,
        BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias, BokehBleedingMult);
    BokehResult = T[0];
    BokehResultB = T[1];
}

#elif BOKEH_PASS == BOKEH_HEXAGON_SECOND

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    BokehResult = BokehExactSecond(BokehColorSamp, BokehColorSampB, BokehColorSampB, BokehColorSampB, BokehDepthSamp,
        BokehUV, 6.0, BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES,
        jitter, BokehBleedingBias, BokehBleedingMult);
}

#elif BOKEH_PASS == BOKEH_OCTAGON_FIRST

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    mat4 T = BokehExactFirst(BokehColorSamp, BokehDepthSamp, BokehUV, 8.0, BokehAngle, BokehSqueeze, BokehAspectRatio,
        BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias, BokehBleedingMult);
    BokehResult = T[0];
    BokehResultB = T[1];
    BokehResultC = T[2];
}

#elif BOKEH_PASS == BOKEH_OCTAGON_SECOND

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    BokehResult = BokehExactSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampC, BokehDepthSamp,
        BokehUV, 8.0, BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES,
        jitter, BokehBleedingBias, BokehBleedingMult);
}

#elif BOKEH_PASS == BOKEH_DECAGON_FIRST

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    mat4 T = BokehExactFirst(BokehColorSamp, BokehDepthSamp, BokehUV, 10.0, BokehAngle, BokehSqueeze, BokehAspectRatio,
        BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter, BokehBleedingBias, BokehBleedingMult);
    BokehResult = T[0];
    BokehResultB = T[1];
    BokehResultC = T[2];
    BokehResultD = T[3];
}

#elif BOKEH_PASS == BOKEH_DECAGON_SECOND

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    BokehResult = BokehExactSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD, BokehDepthSamp,
        BokehUV, 10.0, BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES,
        jitter, BokehBleedingBias, BokehBleedingMult);
}

#elif BOKEH_PASS == BOKEH_EXACT_EDGE

void main()
{
    BokehUseViewport();
    float spacing = BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    float random = BokehNoise(BokehUV, BokehImageWidth, BokehImageHeight, BokehFrame);
    float jitter = BokehJitter * BOKEH_ADAPTIVE_SAMPLES * random;
    BokehResult = BokehExactEdge(BokehColorSamp, BokehDepthSamp, BokehColorSampB, BokehColorSampC, BokehUV, BokehEdge,
        BokehSides, BokehAngle, BokehSqueeze, BokehAspectRatio, BokehImageHeight, spacing, BOKEH_NUM_SAMPLES,
        jitter, BokehBleedingBias, BokehBleedingMult);
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

#endif
#endif
